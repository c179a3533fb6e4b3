/* Motion along conic sections, against Kepler's equation solved in long double. */
#include "plugins/common/orbits/kepler.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Places and velocities on the orbit of pericentre 1, in a plane that is tilted, at the time t after it: ellipses
 * by E - e sin E, hyperbolas by e sinh H - H, the parabola by Barker's D + D^3/3. */
typedef struct conic {
  long double e, a, mu; /* a: the half axis, positive; that of the parabola is not used */
} conic;

static conic with(long double e, long double mu) { return (conic){e, e == 1 ? 0 : 1 / fabsl(1 - e), mu}; }

static long double root(const conic *k, long double mean) {
  long double low = -800, high = 800;
  if (k->e < 1) low = mean - 1, high = mean + 1;
  for (int i = 0; i < 200 && low < high; i++) {
    long double middle = (low + high) / 2, value;
    if (k->e < 1)
      value = middle - k->e * sinl(middle);
    else
      value = k->e > 1 ? k->e * sinhl(middle) - middle : middle + middle * middle * middle / 3;
    *(value < mean ? &low : &high) = middle;
  }
  return (low + high) / 2;
}

static void at(const conic *k, long double t, double x[3], double v[3]) {
  long double e = k->e, a = k->a, mu = k->mu, rate = e == 1 ? sqrtl(mu / 2) : sqrtl(mu / (a * a * a)),
              q = root(k, rate * t);
  long double p[2], u[2], r;
  if (e < 1) {
    long double b = a * sqrtl(1 - e * e);
    r = a * (1 - e * cosl(q)), p[0] = a * (cosl(q) - e), p[1] = b * sinl(q);
    u[0] = -a * sinl(q), u[1] = b * cosl(q);
  } else if (e > 1) {
    long double b = a * sqrtl(e * e - 1);
    r = a * (e * coshl(q) - 1), p[0] = a * (e - coshl(q)), p[1] = b * sinhl(q);
    u[0] = -a * sinhl(q), u[1] = b * coshl(q);
  } else {
    r = 1 + q * q, p[0] = 1 - q * q, p[1] = 2 * q;
    u[0] = -2 * q, u[1] = 2;
  }
  long double speed = e == 1 ? rate / r : rate * a / r; /* of the angle */
  long double cosine = 0.36L, sine = sqrtl(1 - cosine * cosine);
  x[0] = (double)p[0], x[1] = (double)(cosine * p[1]), x[2] = (double)(sine * p[1]);
  v[0] = (double)(speed * u[0]), v[1] = (double)(cosine * speed * u[1]), v[2] = (double)(sine * speed * u[1]);
}

static double length(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

static double apart(const double a[3], const double b[3]) {
  return length((const double[]){a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

/* How far from the conic section a move from t to t + h ends, in roundings: of a rounding of each number at the start,
 * carried along by what the end depends on the start, and of the time and the end. */
static double roundings(const conic *k, double t, double h) {
  double start[6], x[3], v[3], right_x[3], right_v[3], mu = (double)k->mu;
  at(k, t, start, start + 3);
  at(k, (long double)t + h, right_x, right_v);
  memcpy(x, start, sizeof x);
  memcpy(v, start + 3, sizeof v);
  if (!hk_kepler_move(mu, h, x, v)) return INFINITY;
  double r = length(right_x), slack = DBL_EPSILON * (r + fabs(h) * length(right_v));
  double slack_v = DBL_EPSILON * (length(right_v) + fabs(h) * mu / (r * r));
  for (int c = 0; c < 6; c++) {
    double from[6];
    memcpy(from, start, sizeof from);
    from[c] += 8 * DBL_EPSILON * length(start + c / 3 * 3);
    if (!hk_kepler_move(mu, h, from, from + 3)) return INFINITY;
    slack += apart(from, x) / 8, slack_v += apart(from + 3, v) / 8;
  }
  return fmax(apart(x, right_x) / slack, apart(v, right_v) / slack_v);
}

/* Circles to ellipses of 0.9999, the parabola (whose energy is a rounding of either sign), hyperbolas; steps of a ten
 * millionth of the time at the pericentre to 300 times it, either way. */
static void ends_lie_on_the_conic_section(void **state) {
  static const double e[] = {0, 0.01, 0.3, 0.9, 0.99, 0.9999, 1, 1.0001, 1.3, 5, 40};
  static const double start[] = {0, -30, -0.7, 0.2, 3, 80}, step[] = {1e-7, 0.01, 0.3, 2, 25, 300};
  (void)state;
  for (size_t k = 0; k < sizeof e / sizeof *e; k++) {
    conic orbit = with(e[k], 1.7L);
    double worst = 0;
    for (size_t i = 0; i < 6; i++)
      for (size_t j = 0; j < 12; j++) {
        double off = roundings(&orbit, start[i], j % 2 ? -step[j / 2] : step[j / 2]);
        if (!(off < 4)) fail_msg("e = %.10g, from %g by %g: %g roundings off", e[k], start[i], step[j / 2], off);
        worst = fmax(worst, off);
      }
    print_message("e = %.10g: %.2g roundings\n", e[k], worst);
  }
}

/* From a hundred thousand times the pericentre's time before it to as far behind, where terms of the time that are 1e10
 * of it cancel. A rounding of the place at the start turns the way out by an angle of r/q roundings. */
static void flybys_from_afar_are_right(void **state) {
  static const double e[] = {1.0001, 1.3, 5, 40};
  (void)state;
  for (size_t k = 0; k < 8; k++) {
    conic orbit = with(e[k / 2], 1.7L);
    double x[3], v[3], right[3], right_v[3], t = k % 2 ? 1e5 : -1e5, h = -2.1 * t;
    at(&orbit, t, x, v);
    at(&orbit, (long double)t + h, right, right_v);
    double natural = DBL_EPSILON * length(x) * length(right);
    assert_true(hk_kepler_move(1.7, h, x, v));
    double off = apart(x, right) / natural;
    print_message("e = %.10g: %.2g\n", e[k / 2], off);
    if (!(off < 2)) fail_msg("e = %.10g, from %g by %g: %g of what a rounding does", e[k / 2], t, h, off);
  }
}

/* A thousand and a half periods; the phase is off by a rounding of the time, and by one of the period a thousand times.
 */
static void many_periods_are_one_step(void **state) {
  (void)state;
  double x[3] = {0.4, 0, 0}, v[3] = {0, 2, 0}, period = 2 * acos(-1);
  assert_true(hk_kepler_move(1, 1000.5 * period, x, v));
  assert_true(fabs(x[0] + 1.6) < 1e-11 && fabs(x[1]) < 1e-11 && fabs(v[1] + 0.5) < 1e-11);
}

/* Reversible, and the area in (x, v) is kept: the determinant of the linear map from (x, v) is 1, by differences of its
 * angular momentum. A thousand steps of golden lengths lose no more than a random walk of roundings. */
static void angular_momentum_and_energy_are_kept(void **state) {
  (void)state;
  double x[3] = {0.4, 0, 0}, v[3] = {0, 2, 0};
  for (int k = 0; k < 1000; k++) assert_true(hk_kepler_move(1, fmod(0.6180339887 * k, 1) * 3 - 1, x, v));
  double momentum = x[0] * v[1] - x[1] * v[0], r = length(x), speed = length(v);
  assert_true(fabs(momentum / 0.8 - 1) < 2e-14 && fabs((speed * speed / 2 - 1 / r) / -0.5 - 1) < 1e-13);
}

static void without_a_mass_the_motion_is_straight(void **state) {
  (void)state;
  double x[3] = {1, 2, 3}, v[3] = {-1, 0.5, 0.25};
  assert_true(hk_kepler_move(0, 2, x, v));
  assert_true(x[0] == -1 && x[1] == 3 && x[2] == 3.5 && v[0] == -1 && v[1] == 0.5 && v[2] == 0.25);
}

static void what_has_no_orbit_stays_as_it_was(void **state) {
  (void)state;
  double x[3] = {0, 0, 0}, v[3] = {1, 2, 3};
  assert_false(hk_kepler_move(1, 0.1, x, v));
  assert_true(v[0] == 1 && x[0] == 0);
  x[1] = NAN;
  assert_false(hk_kepler_move(1, 0.1, x, v));
  x[1] = 1, v[2] = INFINITY;
  assert_false(hk_kepler_move(1, 0.1, x, v));
  assert_true(x[1] == 1 && v[0] == 1);
}

/* c_0 = cos, c_1 = sin/sqrt(z), and by z c_(k+2) = 1/k! - c_k; hyperbolic for negative z. */
static void functions_of_stumpff_are_those_of_angles(void **state) {
  (void)state;
  static const double z[] = {-200, -30, -1, -0.09, -1e-5, 0, 1e-9, 0.0999, 0.11, 1, 7, 39, 400};
  for (size_t k = 0; k < sizeof z / sizeof *z; k++) {
    double c[4];
    long double w = sqrtl(fabsl((long double)z[k])), right[4] = {1, 1, 0.5L, 1 / 6.0L};
    if (z[k] != 0) {
      right[0] = z[k] > 0 ? cosl(w) : coshl(w), right[1] = (z[k] > 0 ? sinl(w) : sinhl(w)) / w;
      if (fabs(z[k]) > 1e-3) right[2] = (1 - right[0]) / z[k], right[3] = (1 - right[1]) / z[k];
    }
    hk_stumpff(z[k], c);
    for (int i = 0; i < 4; i++) {
      long double size = fmaxl(fabsl(right[i]), z[k] > 0 ? 1 / (1 + (long double)z[k]) : 0);
      double most = fabs(z[k]) > 1e-3 ? 1e-13 : 1e-5; /* the limits differ by z/12 */
      if (!(fabsl(c[i] - right[i]) <= most * size)) fail_msg("c_%d(%g) = %.17g, not %.17Lg", i, z[k], c[i], right[i]);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ends_lie_on_the_conic_section),
      cmocka_unit_test(flybys_from_afar_are_right),
      cmocka_unit_test(many_periods_are_one_step),
      cmocka_unit_test(angular_momentum_and_energy_are_kept),
      cmocka_unit_test(without_a_mass_the_motion_is_straight),
      cmocka_unit_test(what_has_no_orbit_stays_as_it_was),
      cmocka_unit_test(functions_of_stumpff_are_those_of_angles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
