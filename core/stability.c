/* The largest step at which no mode of the scene grows, from the method's amplification factor and the scene's bounds.
 *
 * The modes are (w, g) with 0 <= w <= w_max and floor(w) <= g <= g_max (spectrum.h), and (0, k) for the channels. They
 * are looked at on a grid, the corners included, because stability domains need not be convex and because the slow
 * modes may be those without damping. h runs up from 1e-4 of the fastest rate in steps of 3 % to the first h at which
 * one mode grows; bisection follows. The first, not the last: beyond a gap of instability a step is of no use.
 *
 * "Grows" means an amplification above 1 + 1e-10, the rounding of double roots of a step matrix. Methods without any
 * stable step on the imaginary axis (euler, 1 + z^2/2; Heun and midpoint, 1 + z^4/8, z = h w) would so be granted a
 * step near zero. A limit below z = 0.01 (order 1) or 0.05 (order 2 and above) therefore counts as none, and that z is
 * taken instead, for accuracy: the fastest mode then grows by 3 % or 0.01 % per period. */
#include "core/stability.h"

static const double tolerance = 1e-10, least = 1e-4, most = 1e6;
/* Below h w = 1e-6 the roots of a mode cannot be told from a double root at 1, where rounding grows to its root. */
static const double distinct = 1e-6;

enum { W_POINTS = 13, G_POINTS = 6, POINTS = (W_POINTS + 1) * G_POINTS };

typedef struct mode {
  double w, g;
} mode;

typedef struct mode_grid {
  const hk_integrator *method;
  int count;
  mode point[POINTS];
} mode_grid;

static void add_modes(mode_grid *grid, double w, double low, double high) {
  static const double part[G_POINTS] = {0, 0.03, 0.12, 0.3, 0.6, 1};
  for (int i = 0; i < G_POINTS; i++) {
    grid->point[grid->count++] = (mode){w, low + part[i] * (high - low)};
    if (!(high > low)) return;
  }
}

static mode_grid modes_of(const hk_integrator *method, const hk_spectrum *s) {
  static const double part[W_POINTS - 1] = {1, 0.96, 0.9, 0.82, 0.72, 0.6, 0.45, 0.3, 0.15, 0.05, 0.01, 1e-3};
  mode_grid grid = {.method = method, .count = 0};
  for (int i = 0; i < W_POINTS - 1 && s->w_max > 0; i++) {
    double w = part[i] * s->w_max;
    add_modes(&grid, w, fmin(hk_spectrum_floor(s, w), s->g_max), s->g_max);
  }
  if (s->w_free > 0 && s->w_free < s->w_max) add_modes(&grid, s->w_free, fmin(s->g_floor, s->g_max), s->g_max);
  double still = fmax(s->g_max, s->channel_rate); /* w = 0 */
  if (still > 0) add_modes(&grid, 0, 0.01 * still, still);
  return grid;
}

/* The excess that rounding explains: a step matrix has numbers up to z^2. */
static double rounding(double z) { return tolerance + 1e-16 * z * z; }

/* Whether a mode grows at h; *worst: the first that does. */
static bool grows(const mode_grid *grid, double h, mode *worst) {
  for (int i = 0; i < grid->count; i++) {
    double hw = h * grid->point[i].w, hg = h * grid->point[i].g;
    if (hw < distinct && hg < distinct) continue;
    if (grid->method->amplification(hw, hg) <= 1 + rounding(fmax(hw, hg))) continue; /* NAN grows */
    *worst = grid->point[i];
    return true;
  }
  return false;
}

double hk_step_growth(const hk_integrator *method, const hk_spectrum *spectrum, double h) {
  mode_grid grid = modes_of(method, spectrum);
  double growth = 1;
  for (int i = 0; i < grid.count; i++)
    growth = fmax(growth, method->amplification(h * grid.point[i].w, h * grid.point[i].g));
  return growth;
}

/* The largest h below `high` found stable, `low` being stable. */
static double bisect(const mode_grid *grid, double low, double high, mode *worst) {
  for (int i = 0; i < 50 && high - low > 1e-12 * high; i++) {
    double middle = low + (high - low) / 2;
    if (grows(grid, middle, worst))
      high = middle;
    else
      low = middle;
  }
  return low;
}

static double first_limit(const mode_grid *grid, double rate, mode *worst) {
  double low = least / rate;
  if (grows(grid, low, worst)) return 0;
  while (low * rate < most) {
    double high = low * (low * rate < 100 ? 1.03 : 1.5);
    if (grows(grid, high, worst)) return bisect(grid, low, high, worst);
    low = high;
  }
  return INFINITY;
}

static const char *reason(const hk_spectrum *s, const mode *worst) {
  if (worst->w > 0) return worst->g > 2 * worst->w ? "damping of the stiffest springs" : "fastest oscillation";
  return s->channel_rate > s->g_max ? "fastest channel" : "strongest damping";
}

static hk_step_choice for_accuracy(const hk_integrator *method, const hk_spectrum *s, double rate, double limit) {
  hk_step_choice choice = {.limit = limit, .why = "accuracy: no useful step is stable"};
  choice.h = (method->order < 2 ? 0.01 : 0.05) / rate;
  choice.growth_rate = log(hk_step_growth(method, s, choice.h)) / choice.h;
  return choice;
}

hk_step_choice hk_stable_step(const hk_integrator *method, const hk_spectrum *s) {
  hk_step_choice any = {INFINITY, true, true, 0, INFINITY, 0, 0, "nothing limits the step"};
  double rate = fmax(s->w_max, fmax(s->g_max, s->channel_rate));
  if (!method->amplification)
    return (hk_step_choice){.h = NAN, .limit = NAN, .why = "the method's growth is not known"};
  if (!(rate > 0)) return any;
  mode_grid grid = modes_of(method, s);
  mode worst = {0, 0};
  double limit = first_limit(&grid, rate, &worst);
  if (!isfinite(limit)) return any;
  hk_step_choice choice = {limit, true, false, 0, limit, worst.w, worst.g, reason(s, &worst)};
  if (limit * rate < (method->order < 2 ? 0.01 : 0.05)) {
    choice = for_accuracy(method, s, rate, limit);
    choice.w = worst.w;
    choice.g = worst.g;
  }
  return choice;
}
