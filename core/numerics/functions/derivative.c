/* Derivatives of a function of time by Ridders' method (Ridders 1982, "Accurate computation of F'(x) and F'(x)F''(x)",
 * Adv. Eng. Softw. 4:75): differences over h, 2h and 4h are extrapolated to h = 0, and how little the last
 * extrapolation changed is the estimate of the error, to which the rounding of the function's values and of its
 * argument is added.
 *
 * The step h does not depend on t. Where the error is not small at the step that is given, smaller and larger steps are
 * tried, and the least estimate decides. The same values give the derivatives from the left and from the right, which
 * are better than the central one where a corner or a jump lies within the differences: there the result is the
 * derivative on the side of t that is smooth, so a jump gives no speed. At a corner itself it is the mean of the two
 * sides. */
#include "core/numerics/functions/functions.h"

#include <float.h>
#include <string.h>

/* The steps are 79/128 2^k s: t +- h is exact while h is above 128 roundings of t, and h is in phase with no vibration
 * whose frequency is a round number, which would look at rest. */
static const double mantissa = 79.0 / 128, exact_steps = 128;
/* Steps are tried up to 2^-20 and 2^20 times the given one, two further ones after the last that was better. */
enum { LEVELS = 43, MIDDLE = 20, HIGHEST = LEVELS - 3, PATIENCE = 2, CALIBRATIONS = 16 };
static const double good_enough = 1e-8, /* of the derivative: far below what the steps of a run resolve */
    usual_times = 64,                   /* usual errors that are still usual: some times are worse than others */
    ladder_middle = 1.0 / 256,          /* s: steps from 2^-28 s, for vibrations of MHz, to an hour are tried */
    resolves = 0.01,                    /* of the derivative */
    usual_step = 7.62939453125e-6,      /* s, 2^-17: good from vibrations of 1 kHz to motions of hours */
    usual_step_second = 9.765625e-4,    /* s, 2^-10: second differences divide roundings by h^2 */
    longest_step = 1.0 / 4096;          /* of the run, so that vibrations between the calibrations are no rest */

typedef struct table {
  const hk_function *f;
  int order;
  size_t column;
  double t, unit;   /* s */
  double usual;     /* error of the derivative by roundings, with the step `unit` */
  const double *at; /* the three numbers at t */
  bool known[LEVELS];
  double side[2][LEVELS][HK_COLUMNS]; /* the numbers at t - h and t + h; NAN: the function fails there */
} table;

static double step_of(const table *d, int level) { return ldexp(d->unit, level - MIDDLE); }

static double length(const double v[HK_COLUMNS]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static void sample(table *d, int level) {
  double h = step_of(d, level);
  if (d->known[level]) return;
  d->known[level] = true;
  for (int side = 0; side < 2; side++) {
    hk_error ignored = {0};
    double when = side ? d->t + h : d->t - h, out[HK_RESULTS];
    size_t got = 0;
    bool fine = d->f->call(d->f, NULL, &when, 1, out, HK_RESULTS, &got, &ignored) == HK_OK;
    for (size_t c = 0; c < HK_COLUMNS; c++)
      d->side[side][level][c] = fine && got >= d->column + HK_COLUMNS ? out[d->column + c] : NAN;
  }
}

/* The central difference over 2h. */
static double symmetric(const table *d, int level, int c) {
  double h = step_of(d, level), before = d->side[0][level][c], after = d->side[1][level][c];
  return d->order == 1 ? (after - before) / (2 * h) : (after - 2 * d->at[c] + before) / (h * h);
}

/* The difference over h, or over h and 2h, on one side. */
static double one_sided(const table *d, int side, int level, int c) {
  double h = side ? step_of(d, level) : -step_of(d, level), at = d->at[c], next = d->side[side][level][c];
  return d->order == 1 ? (next - at) / h : (at - 2 * next + d->side[side][level + 1][c]) / (h * h);
}

/* What the roundings of the values and of t, of which the script makes its argument, do to the differences. */
static double rounding(const table *d, int level) {
  double h = step_of(d, level), size = length(d->at), move = 0;
  for (int side = 0; side < 2; side++) {
    double step[HK_COLUMNS];
    for (int c = 0; c < HK_COLUMNS; c++) step[c] = d->side[side][level][c] - d->at[c];
    if (!isnan(length(step))) move = fmax(move, length(step));
  }
  double noise = DBL_EPSILON * (size + fabs(d->t) * move / h), own = d->usual * pow(d->unit / h, d->order);
  return own + (d->order == 1 ? noise / h : 4 * noise / (h * h));
}

/* Takes `value` as the derivative at this step where its error is below that of the others. `change` is that by the
 * last extrapolation. */
static void take_better(const table *d, hk_derivative *best, int level, const double value[HK_COLUMNS],
                        const double change[HK_COLUMNS]) {
  double error = length(change) + rounding(d, level);
  if (!(error < best->error)) return;
  memcpy(best->value, value, sizeof best->value);
  best->error = error;
  best->step = step_of(d, level);
}

/* Errors of central differences are a series in h^2, so that the weights are 1/3 and 1/15. */
static void try_symmetric(const table *d, int level, hk_derivative *best) {
  double value[HK_COLUMNS], change[HK_COLUMNS];
  for (int c = 0; c < HK_COLUMNS; c++) {
    double a = symmetric(d, level, c), b = symmetric(d, level + 1, c), e = symmetric(d, level + 2, c);
    double ab = a + (a - b) / 3, be = b + (b - e) / 3;
    change[c] = (ab - be) / 15;
    value[c] = ab + change[c];
  }
  take_better(d, best, level, value, change);
}

/* Errors of one-sided differences are a series in h; second differences take two values, so one extrapolation less. */
static void try_side(const table *d, int side, int level, hk_derivative *best) {
  double value[HK_COLUMNS], change[HK_COLUMNS];
  for (int c = 0; c < HK_COLUMNS; c++) {
    double a = one_sided(d, side, level, c), b = one_sided(d, side, level + 1, c), ab = 2 * a - b;
    double be = d->order == 1 ? 2 * b - one_sided(d, side, level + 2, c) : ab;
    change[c] = d->order == 1 ? (ab - be) / 3 : ab - a;
    value[c] = ab + (ab - be) / 3;
  }
  take_better(d, best, level, value, change);
}

static bool is_good(const table *d, const hk_derivative *best) {
  return best->error <= fmax(good_enough * length(best->value), usual_times * d->usual);
}

/* Only roundings are left, which a smaller step makes worse. */
static bool is_rounding(const table *d, int level, const hk_derivative *found) {
  return found->error <= 2 * rounding(d, level);
}

static hk_derivative try_step(table *d, int level) {
  hk_derivative found = {.error = INFINITY};
  for (int k = 0; k < 3; k++) sample(d, level + k);
  try_symmetric(d, level, &found);
  if (!is_good(d, &found) && !is_rounding(d, level, &found))
    for (int side = 1; side >= 0; side--) try_side(d, side, level, &found);
  return found;
}

/* Whether the two differ by more than their errors: then the larger step is too long for the function, and its estimate
 * is worth nothing. */
static bool contradict(const hk_derivative *a, const hk_derivative *b) {
  double apart[HK_COLUMNS];
  for (int c = 0; c < HK_COLUMNS; c++) apart[c] = a->value[c] - b->value[c];
  return length(apart) > 3 * (a->error + b->error);
}

/* Differences that do not resolve a vibration are small and have small estimates: only when the estimate is also small
 * beside the derivative, or nothing but rounding, the steps need not become smaller. */
static void walk_down(table *d, hk_derivative *best) {
  bool resolved = false;
  for (int level = MIDDLE - 1, tired = 0; level >= 0 && tired < PATIENCE && !is_good(d, best); level--) {
    if (step_of(d, level) < exact_steps * DBL_EPSILON * fabs(d->t)) return;
    hk_derivative found = try_step(d, level);
    if (found.error < best->error || contradict(&found, best)) {
      *best = found;
      tired = 0;
      resolved = found.error < resolves * length(found.value) || is_rounding(d, level, &found);
    } else if (resolved)
      tired++;
  }
}

static void walk_up(table *d, int level, hk_derivative *best) {
  for (int tired = 0; level <= HIGHEST && tired < PATIENCE; level++) {
    hk_derivative found = try_step(d, level);
    if (contradict(&found, best)) return;
    tired = found.error < best->error ? 0 : tired + 1;
    if (!tired) *best = found;
  }
}

static hk_derivative search(table *d) {
  hk_derivative best = try_step(d, MIDDLE);
  if (is_good(d, &best) || is_rounding(d, MIDDLE, &best)) return best;
  walk_down(d, &best);
  if (!is_good(d, &best)) walk_up(d, MIDDLE + 1, &best);
  return best;
}

static table table_of(const hk_function *f, int order, size_t column, const hk_differences *by, double t,
                      const double *at) {
  double least = exact_steps * DBL_EPSILON * fabs(t);
  double unit = ldexp(mantissa, (int)ceil(log2(fmax(by->step, least) / mantissa) - 1e-9));
  return (table){.f = f, .order = order, .column = column, .t = t, .unit = unit, .usual = by->usual, .at = at + column};
}

hk_status hk_derivative_find(const hk_function *f, int order, size_t column, const hk_differences *by, double t,
                             const double at[HK_RESULTS], hk_derivative *found, hk_error *error) {
  table d = table_of(f, order, column, by, t, at);
  *found = search(&d);
  if (isfinite(found->error)) return HK_OK;
  *found = (hk_derivative){.error = NAN};
  double when = t + by->step, out[HK_RESULTS]; /* once more, for the error's cause */
  size_t got = 0;
  hk_status status = f->call(f, NULL, &when, 1, out, HK_RESULTS, &got, error);
  return status != HK_OK ? status
                         : hk_error_set(error, HK_SCRIPT,
                                        "a function of time has no derivative at t = %g s: it fails beside it", t);
}

/* ---- the step that is best at most times ---- */

/* Sums over some times, per step: of the derivative, and of its change by the next larger step. */
typedef struct calibration {
  double size[LEVELS], change[LEVELS];
  size_t times[LEVELS];
} calibration;

static void extrapolate(const table *d, int level, double value[HK_COLUMNS]) {
  for (int c = 0; c < HK_COLUMNS; c++) {
    double a = symmetric(d, level, c), b = symmetric(d, level + 1, c), e = symmetric(d, level + 2, c);
    double ab = a + (a - b) / 3, be = b + (b - e) / 3;
    value[c] = ab + (ab - be) / 15;
  }
}

static void calibrate_at(calibration *sum, table *d, double most) {
  double last[HK_COLUMNS], value[HK_COLUMNS], change[HK_COLUMNS];
  bool any = false;
  for (int level = HIGHEST; level >= 0; level--) {
    double h = step_of(d, level);
    if (h > most) continue;
    if (h < exact_steps * DBL_EPSILON * fabs(d->t)) return;
    for (int k = 0; k < 3; k++) sample(d, level + k);
    extrapolate(d, level, value);
    if (isnan(length(value))) return;
    for (int c = 0; c < HK_COLUMNS; c++) change[c] = any ? value[c] - last[c] : value[c];
    sum->size[level] += length(value);
    sum->change[level] += fmin(length(change), 2 * length(value)); /* a jump is not all there is */
    sum->times[level]++;
    memcpy(last, value, sizeof last);
    any = true;
  }
}

/* The step at which the derivative changes least from that with the double step, relative to its size: with a shorter
 * one the function's own roundings are amplified, and a longer one does not resolve it (of a vibration that is not
 * resolved the differences become half as large with the double step, which is a change as large as they are). */
hk_differences hk_derivative_prepare(const hk_function *f, int order, size_t column, double begin, double end) {
  calibration sum = {.size = {0}};
  hk_differences by = {.step = order == 1 ? usual_step : usual_step_second};
  hk_differences ladder = {.step = ladder_middle};
  double best = 1, most = fmax(longest_step * (end - begin), by.step);
  uint64_t random[4];
  hk_random_seed(random, (uint64_t)order);
  for (int k = 0; k < CALIBRATIONS; k++) {
    double t = begin + (end - begin) * ((double)k + hk_random_uniform(random)) / CALIBRATIONS, at[HK_RESULTS];
    size_t got = 0;
    hk_error ignored = {0};
    if (f->call(f, NULL, &t, 1, at, HK_RESULTS, &got, &ignored) != HK_OK || got < column + HK_COLUMNS) continue;
    table d = table_of(f, order, column, &ladder, t, at);
    calibrate_at(&sum, &d, most);
  }
  table steps = {.unit = ldexp(mantissa, (int)ceil(log2(ladder_middle / mantissa) - 1e-9))};
  for (int level = 0; level <= HIGHEST; level++) {
    double ratio = sum.change[level] / sum.size[level];
    if (sum.times[level] < CALIBRATIONS / 2 || !(ratio < best)) continue;
    best = ratio;
    by.step = step_of(&steps, level);
    by.usual = sum.change[level] / (double)sum.times[level];
  }
  return by;
}
