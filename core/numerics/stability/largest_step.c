/* The largest step at which no mode of the scene grows, from the method's growth factor and the scene's bounds.
 *
 * The modes are (w, g, b) with 0 <= w <= w_max, floor(w) <= g <= ceiling(w) and 0 <= b <= b_max (stability.h; -b grows
 * as b does), and (0, k, 0) for the channels.
 * The corners of that set are tested first: h increases in steps of 2 % up to the first h at which a corner grows, and
 * bisection refines it (the first such h, since a stable interval beyond an unstable one is of no use). Then a grid
 * over the whole set is tested at that h and at fractions of it, since stability domains need not be convex and the
 * slow modes may be undamped. A grid mode that grows joins the corners, and the search is repeated until none grows.
 * This takes some 1000 growth factors, a few milliseconds at most.
 *
 * Symmetric methods of high order grow in narrow bands of h w far below the end of their domain, near multiples of pi,
 * where the trace of their matrix just passes 2: Kahan and Li's of order 8, whose domain ends at 5.85, from 3.096 to
 * 3.140 by up to 2.3 % a step, and Blanes and Moan's, which ends at 5.03, from 3.1635 to 3.1685 by up to 0.24 %. A
 * fastest mode that is damped passes such a band unharmed, slower ones, damped less, do not. So every h w at which the
 * undamped oscillator grows is followed through all steps, with the damping that the mode of that frequency has at
 * least (below_bands). Where the modes of a scene lie is not known, and moves with it: no step is granted that a band
 * could spoil. (A chain of 2,000 links in 7,000 steps of 0.9 of 5.03: its energy grows by 10^13.)
 *
 * "Grows" is by more than 2e-7 a step: less cannot be told from rounding and from defective matrices, whose spectral
 * radius plugins/kit/integrate/growth_factor.h gives to 7e-8. Methods that are stable nowhere on the imaginary axis
 * (euler, 1 + z^2/2; Heun and midpoint, 1 + z^4/8; z = h w) would so be granted a small step. A limit below z = 0.01
 * (order 1) or 0.05 (order 2 and above) therefore counts as none, and that z is taken instead, for accuracy: the
 * fastest mode then grows by 3 % or 0.01 % a period.
 *
 * Where a force sets in and ceases (HK_STIFFENS) the modes of either state tell half of it: every change between the
 * two gives or takes energy, about (h w)^2/4 of it, and a symplectic or reversible method, which damps no mode, loses
 * none of what it gains. By experiment (chains of links that only pull, two symplectic methods of order 1 and 2, 10^4
 * steps) the energy grows from h w = 0.96 on where h w = 2 is the limit of what always pulls; methods that damp fast
 * modes hold to their limit. Those that damp nothing are therefore granted a part of it that is below that. */
#include "core/engine/contract/contract.h"
#include "core/numerics/stability/stability.h"

/* Bands are looked for at h w from this one on, in steps of a third of the narrowest that is known. */
static const double band_from = 1, band_step = 1.0005;
static const double tolerance = 2e-7, most = 1e6, safety = 0.9, precision = 1e-7, switching_part = 0.45;
/* Below h w = 1e-6 the roots of a mode cannot be told from a double root at 1. */
static const double distinct = 1e-6;

enum { W_POINTS = 13, G_POINTS = 6, B_POINTS = 6, LINE_POINTS = 24, JOINING = 8 };
enum { POINTS = (W_POINTS + 2) * G_POINTS * B_POINTS + 2 * (LINE_POINTS + HK_DAMPED_LINES + 1) };

typedef struct mode {
  double w, g, b;
} mode;

typedef struct mode_set {
  const hk_integrator *method;
  const void *parameters;
  int count;
  mode point[POINTS];
} mode_set;

static void add_mode(mode_set *set, double w, double g, double b) { set->point[set->count++] = (mode){w, g, b}; }

static double floor_of(const hk_spectrum *s, double w) { return fmin(hk_spectrum_floor(s, w), s->g_max); }

/* The lowest frequency at which a damping rate of g_max is possible. */
static double overdamped_from(const hk_spectrum *s) {
  return s->damping_slope > 0 ? sqrt(fmax(0, s->g_max - s->damping_offset) / s->damping_slope) : 0;
}

/* A corner as it is and with the largest turning rate. */
static void add_corner(mode_set *set, double w, double g, double b) {
  add_mode(set, w, g, 0);
  if (b > 0) add_mode(set, w, g, b);
}

/* The frequency from which a line says that modes are damped; 0: it says nothing, or of all modes. */
static double damped_from(const hk_spectrum *s, int line) {
  double slope = s->damped[line].slope, offset = s->damped[line].offset;
  return slope > 0 ? fmin(s->w_max, sqrt(fmax(0, offset) / slope)) : 0;
}

/* Adds the least damped modes between the first frequency that a line says to be damped and the highest, closely, as
 * either end may do where those between do not. */
static void add_least_damped(mode_set *set, const hk_spectrum *s) {
  double from = s->w_max;
  for (int k = 0; k < HK_DAMPED_LINES; k++)
    if (s->damped[k].slope > 0) from = fmin(from, damped_from(s, k));
  for (int i = 0; i <= LINE_POINTS && from < s->w_max; i++) {
    double w = from + (s->w_max - from) * i / LINE_POINTS;
    add_corner(set, w, floor_of(s, w), s->b_max);
  }
}

/* Adds modes with damping rates from low to high at one frequency, each with turning rates up to b. */
static void add_rates(mode_set *set, double w, double low, double high, double b) {
  static const double part[G_POINTS] = {0, 0.03, 0.12, 0.3, 0.6, 1}, turn[B_POINTS] = {0, 1, 0.7, 0.4, 0.15, 0.02};
  for (int i = 0; i < (high > low ? G_POINTS : 1); i++)
    for (int k = 0; k < (b > 0 ? B_POINTS : 1); k++) add_mode(set, w, low + part[i] * (high - low), turn[k] * b);
}

static mode_set corners_of(const hk_integrator *method, const void *parameters, const hk_spectrum *s) {
  mode_set set = {.method = method, .parameters = parameters, .count = 0};
  double g_at_zero = hk_spectrum_ceiling(s, 0), lowest = overdamped_from(s), b = s->b_max;
  if (s->w_max > 0) add_corner(&set, s->w_max, floor_of(s, s->w_max), b);
  if (s->w_max > 0 && s->g_max > floor_of(s, s->w_max)) add_corner(&set, s->w_max, s->g_max, b);
  if (lowest > 0 && lowest < s->w_max) add_corner(&set, lowest, s->g_max, b);
  if (s->w_undamped > 0) add_corner(&set, fmin(s->w_undamped, s->w_max), floor_of(s, 0), b);
  for (int k = 0; k < HK_DAMPED_LINES; k++)
    if (damped_from(s, k) > 0) add_corner(&set, damped_from(s, k), floor_of(s, damped_from(s, k)), b);
  if (b > 0) add_mode(&set, 0, floor_of(s, 0), b);
  if (g_at_zero > 0) add_corner(&set, 0, g_at_zero, b);
  if (s->channel_rate > 0) add_mode(&set, 0, s->channel_rate, 0);
  return set;
}

static mode_set grid_of(const hk_integrator *method, const void *parameters, const hk_spectrum *s) {
  static const double part[W_POINTS] = {1, 0.96, 0.9, 0.82, 0.72, 0.6, 0.45, 0.3, 0.15, 0.05, 0.01, 1e-3, 1e-4};
  mode_set set = {.method = method, .parameters = parameters, .count = 0};
  for (int i = 0; i < W_POINTS && s->w_max > 0; i++)
    add_rates(&set, part[i] * s->w_max, floor_of(s, part[i] * s->w_max), hk_spectrum_ceiling(s, part[i] * s->w_max),
              s->b_max);
  add_least_damped(&set, s);
  double g_at_zero = hk_spectrum_ceiling(s, 0), least = s->b_max > 0 ? floor_of(s, 0) : 0.01 * g_at_zero;
  if (g_at_zero > 0 || s->b_max > 0) add_rates(&set, 0, least, g_at_zero, s->b_max);
  if (s->channel_rate > 0) add_rates(&set, 0, 0.01 * s->channel_rate, s->channel_rate, 0);
  return set;
}

/* The growth factor of a step h. */
static double growth_of(const hk_integrator *method, const void *parameters, mode m, double h) {
  const hk_split_facet *split = &hk_integrator_tables_of(method)->split;
  if (split->coupled_growth) return split->coupled_growth(parameters, h, m.w, m.g, m.b);
  return method->growth(parameters, method->method, h * m.w, h * m.g, h * m.b);
}

static bool mode_grows(const hk_integrator *method, const void *parameters, mode m, double h) {
  double z = h * fmax(m.w, fmax(m.g, m.b));
  if (z < distinct) return false;
  return !(growth_of(method, parameters, m, h) <=
           1 + tolerance + 1e-16 * z * z); /* rounding of a matrix with entries of size z^2 */
}

/* *which: the first mode that grows at h. */
static bool grows(const mode_set *set, double h, mode *which) {
  for (int i = 0; i < set->count; i++)
    if (mode_grows(set->method, set->parameters, set->point[i], h)) {
      *which = set->point[i];
      return true;
    }
  return false;
}

static double bisect(const mode_set *set, double low, double high, mode *which) {
  while (high - low > precision * high) {
    double middle = low + (high - low) / 2;
    if (grows(set, middle, which))
      high = middle;
    else
      low = middle;
  }
  return low;
}

/* The largest h from `begin` on up to which no mode of the set grows; 0 when one grows at `begin`. */
static double first_limit(const mode_set *set, double begin, double rate, mode *which) {
  double low = begin;
  if (grows(set, low, which)) return 0;
  while (low * rate < most) {
    double high = low * (low * rate < 100 ? 1.02 : 2);
    if (grows(set, high, which)) return bisect(set, low, high, which);
    low = high;
  }
  return INFINITY;
}

/* Whether a mode of the grid grows at `limit` or at a fraction of it down to `begin`. */
static bool grows_below(const mode_set *grid, double begin, double limit, double rate, mode *which) {
  static const double part[] = {1, 0.8, 0.5, 0.2};
  if (!isfinite(limit)) limit = 100 / rate;
  for (size_t k = 0; k < sizeof part / sizeof *part; k++)
    if (grows(grid, fmax(begin, part[k] * limit), which)) return true;
  return grows(grid, begin, which);
}

static double limit_of(const hk_integrator *method, const void *parameters, const hk_spectrum *s, double begin,
                       double rate, mode *which) {
  mode_set set = corners_of(method, parameters, s), grid = grid_of(method, parameters, s);
  double limit = first_limit(&set, begin, rate, which);
  mode slow = {0, 0, 0};
  for (int k = 0; k < JOINING && limit > 0 && grows_below(&grid, begin, limit, rate, &slow); k++) {
    add_mode(&set, slow.w, slow.g, slow.b);
    limit = first_limit(&set, begin, rate, which);
  }
  return limit;
}

/* A step up to `limit` below which no mode of this h w grows, within 2 % of the first at which one does. */
static double below_band(const hk_integrator *method, const void *parameters, const hk_spectrum *s, double hw,
                         double limit, mode *which) {
  double low = hw / s->w_max; /* no mode is faster */
  for (double h = low; h < limit; low = h, h *= 1.02) {
    mode m = {hw / h, floor_of(s, hw / h), 0};
    if (!mode_grows(method, parameters, m, h)) continue;
    while (mode_grows(method, parameters, m, low)) low /= band_step;
    *which = m;
    return low;
  }
  return limit;
}

static double below_bands(const hk_integrator *method, const void *parameters, const hk_spectrum *s, double limit,
                          mode *which) {
  if (hk_integrator_tables_of(method)->split.coupled_growth || !(s->w_max > 0) || !isfinite(limit)) return limit;
  for (double hw = band_from; hw < limit * s->w_max; hw *= band_step)
    if (mode_grows(method, parameters, (mode){hw, 0, 0}, 1))
      limit = below_band(method, parameters, s, hw, limit, which);
  return limit;
}

double hk_stable_growth(const hk_integrator *method, const void *parameters, const hk_spectrum *spectrum, double h) {
  mode_set grid = grid_of(method, parameters, spectrum);
  double growth = 1;
  for (int i = 0; i < grid.count; i++) growth = fmax(growth, growth_of(method, parameters, grid.point[i], h));
  return growth;
}

static const char *limiting_rate(const hk_spectrum *s, mode m) {
  if (m.b > fmax(m.w, m.g)) return "the fastest turn of velocities";
  if (m.w > 0) return m.g > 2 * m.w ? "the strongest damping" : "the fastest oscillation";
  return s->channel_rate > s->g_max ? "the fastest channel" : "the strongest damping";
}

/* Lowers `limit` to what forces that set in and cease allow. */
static double with_switching(const hk_integrator *method, const void *parameters, const hk_spectrum *s, double begin,
                             double limit, mode *which) {
  hk_spectrum taut = {.w_max = s->w_switching};
  mode own = {0, 0, 0};
  if (!(s->w_switching > 0) || !(method->flags & (HK_SYMPLECTIC | HK_REVERSIBLE))) return limit;
  double most_of = switching_part * limit_of(method, parameters, &taut, begin, s->w_switching, &own);
  if (!(most_of > 0 && most_of < limit)) return limit;
  *which = own;
  return most_of;
}

/* A step of which no more is known than that it resolves the fastest rate. */
static hk_stable accurate(double begin) {
  return (hk_stable){NAN, begin, 0, 0, 0, 0, "accuracy, as the method does not state its growth where velocities turn"};
}

hk_stable hk_stable_step(const hk_integrator *method, const void *parameters, const hk_spectrum *s) {
  double rate = fmax(fmax(s->w_max, s->b_max), fmax(s->g_max, s->channel_rate));
  if (!method->growth) return (hk_stable){NAN, NAN, 0, 0, 0, 0, "the method does not state its growth"};
  if (!(rate > 0)) return (hk_stable){INFINITY, INFINITY, 0, 0, 0, 0, "the scene has no rate of its own"};
  mode m = {0, 0, 0};
  double begin = (method->order < 2 ? 0.01 : 0.05) / rate;
  if (s->b_max > 0 && isnan(method->growth(parameters, method->method, 0, 0, begin * s->b_max))) return accurate(begin);
  double limit = limit_of(method, parameters, s, begin, rate, &m);
  limit = below_bands(method, parameters, s, limit, &m);
  limit = with_switching(method, parameters, s, begin, limit, &m);
  if (!isfinite(limit)) return (hk_stable){INFINITY, INFINITY, 0, 0, 0, 0, "the method is stable at any step"};
  if (limit > 0) return (hk_stable){limit, safety * limit, 0, m.w, m.g, m.b, limiting_rate(s, m)};
  double growth = log(hk_stable_growth(method, parameters, s, begin)) / begin;
  return (hk_stable){0, begin, growth, m.w, m.g, m.b, "accuracy, as no useful step is stable"};
}
