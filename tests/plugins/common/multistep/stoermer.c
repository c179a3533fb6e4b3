/* Stoermer's methods: that a step is the formula in differences, and that the range of stable steps is the one that
 * their headers state. (Orders and growth factors of every integrator: orders.c, growth.c.) */
#include "tests/support/fake_system.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>

enum { METHODS = 6, TERMS = 8, N = 7, STEPS = 12 };

/* Stable while (h w)^2 + drag h g <= square, which is where the root -1 is reached. */
static const struct family {
  const char *name;
  int terms;
  double sigma[TERMS], gamma[TERMS], square, drag;
} families[METHODS] = {
    {"stoermer", 4, {1, 0, 1.0 / 12, 1.0 / 12}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8}, 2, 20.0 / 3},
    {"stoermer5", 5, {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720}, NAN, NAN},
    {"stoermer8",
     8,
     {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240, 3.0 / 40, 863.0 / 12096, 275.0 / 4032},
     {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720, 95.0 / 288, 19087.0 / 60480, 5257.0 / 17280},
     NAN,
     NAN},
    {"stoermer_wide2", 4, {1, 0, 0, 0}, {1, 1.0 / 2, -0.62, 0.146}, 4, 1.376},
    {"stoermer_wide3",
     5,
     {1, 0, 1.0 / 12, 0, -0.01},
     {1, 1.0 / 2, 5.0 / 12, -0.66, 0.17},
     4 / (1 + 1.0 / 3 - 0.16),
     2 * (2 + 5.0 / 3 - 8 * 0.66 + 16 * 0.17) / (1 + 1.0 / 3 - 0.16)},
    {"stoermer_wide4",
     6,
     {1, 0, 1.0 / 12, 1.0 / 12, -0.004, -0.015},
     {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, -0.67, 0.18},
     4 / (2 - 16 * 0.004 - 32 * 0.015),
     2 * (5 + 5.0 / 3 - 16 * 0.67 + 32 * 0.18) / (2 - 16 * 0.004 - 32 * 0.015)},
};

static void swing(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  (void)context, (void)y;
  for (size_t e = 0; e < 3 * N; e++) a[e] = cos(t + (double)e) - sin(x[e]) - 0.3 * v[e] * fabs(v[(e + 1) % (3 * N)]);
  dy[0] = x[0] * v[1];
}

/* Differences of the last values, newest first, in place: D^j of the newest to the j-th place. */
static void differences(double *list, int count) {
  for (int j = 1; j < count; j++)
    for (int i = count - 1; i >= j; i--) list[i] = list[i - 1] - list[i];
}

static void near(const char *name, double got, double expected, double tolerance) {
  if (!(fabs(got - expected) <= tolerance)) fail_msg("%s: %.17g, expected %.17g", name, got, expected);
}

/* x'' and the work by the plain recurrence: x' - 2x + x_before = h^2 sum sigma_j D^j a, v' - v = h sum gamma_j D^j a
 * would need the first v of the sum, so v is held to (x' - x)/h + h sum (gamma_j - sigma_j) D^(j-1) a. The tolerance:
 * rounding of x of size 3, divided by h where x' - x is, with some 30 operations. */
static void step_is_the_formula_in_differences(void **state) {
  (void)state;
  const double h = 0.125;
  for (const struct family *m = families; m < families + METHODS; m++) {
    static double x[STEPS + 1][3 * N], a[STEPS][3 * N], work[STEPS];
    fake_system *f = fake_system_create(&(fake_problem){N, 0, HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, swing, NULL});
    fake_method method = fake_method_open(m->name, f);
    double *X = f->system.X;
    for (size_t e = 0; e < 6 * N; e++) X[e] = sin((double)(e * e));
    for (int s = 0; s < STEPS; s++) {
      memcpy(x[s], X, sizeof x[s]);
      swing(NULL, f->system.t, X, X + 3 * N, NULL, a[s], &work[s]);
      double before = X[6 * N];
      assert_int_equal(fake_method_step(&method, h, NULL), HK_OK);
      if (s < m->terms - 1) continue;
      for (size_t e = 0; e <= 3 * N; e++) {
        double D[TERMS], change = 0, lead = 0, rate = 0;
        for (int j = 0; j < m->terms; j++) D[j] = e < 3 * N ? a[s - j][e] : work[s - j];
        differences(D, m->terms);
        for (int j = 0; j < m->terms; j++) {
          change += h * h * m->sigma[j] * D[j];
          rate += h * m->gamma[j] * D[j];
          if (j > 0) lead += h * (m->gamma[j] - m->sigma[j]) * D[j - 1];
        }
        if (e == 3 * N) {
          near(m->name, X[6 * N], before + rate, 100 * DBL_EPSILON);
          continue;
        }
        near(m->name, X[e], 2 * x[s][e] - x[s - 1][e] + change, 100 * DBL_EPSILON);
        near(m->name, X[3 * N + e], (X[e] - x[s][e]) / h + lead, 100 * DBL_EPSILON / h);
      }
    }
    fake_method_close(&method);
    fake_system_destroy(f);
  }
}

/* h w at the damping ratio, by the closed form. */
static double stated(const struct family *m, double ratio) {
  return sqrt(m->drag * m->drag * ratio * ratio + m->square) - m->drag * ratio;
}

static double growth(const fake_method *m, double hw, double ratio) {
  return fake_method_growth(m, hw, 2 * ratio * hw, 0);
}

/* Up to a tenth of a percent below the limit no step grows, a tenth of a percent above it the root -1 does. 1e-9 is the
 * rounding of the roots where two of them meet, at w = 0 (see growth.c). */
static void steps_are_stable_to_where_it_is_stated(void **state) {
  (void)state;
  static const double ratios[] = {0, 0.01, 0.03, 0.1, 0.3, 1};
  for (const struct family *m = families; m < families + METHODS; m++) {
    if (isnan(m->square)) continue; /* orders 5 and 8 have no closed form */
    fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, swing, NULL});
    fake_method method = fake_method_open(m->name, f);
    for (size_t r = 0; r < sizeof ratios / sizeof *ratios; r++) {
      double limit = stated(m, ratios[r]);
      for (int k = 1; k <= 50; k++) {
        double hw = 0.999 * limit * k / 50;
        if (growth(&method, hw, ratios[r]) > 1 + 1e-9)
          fail_msg("%s: grows by %.3g a step at h w = %.3g, damping ratio %g", m->name,
                   growth(&method, hw, ratios[r]) - 1, hw, ratios[r]);
      }
      assert_true(growth(&method, 1.001 * limit, ratios[r]) > 1 + 1e-4);
    }
    fake_method_close(&method);
    fake_system_destroy(f);
  }
}

/* sum over i of sigma_i 2/(j - i + 2) H_(j - i + 1) = 1, sum over i of gamma_i/(j - i + 1) = 1, H_n = 1 + ... + 1/n:
 * the series of the method and of Adams and Bashforth's (Hairer, Norsett and Wanner, Solving ODEs I, III.1 and III.10).
 */
static void coefficients_up_to_the_order_are_those_of_the_series(void **state) {
  (void)state;
  for (const struct family *m = families; m < families + METHODS; m++) {
    fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, swing, NULL});
    fake_method method = fake_method_open(m->name, f);
    for (int j = 0; j < method.plugin->integrator->order; j++) {
      double sigma = 0, gamma = 0, harmonic = 0;
      for (int i = j; i >= 0; i--) {
        harmonic += 1.0 / (j - i + 1);
        sigma += m->sigma[i] * harmonic * 2 / (j - i + 2);
        gamma += m->gamma[i] / (j - i + 1);
      }
      near(m->name, sigma, 1, 10 * DBL_EPSILON);
      near(m->name, gamma, 1, 10 * DBL_EPSILON);
    }
    fake_method_close(&method);
    fake_system_destroy(f);
  }
}

static void circle(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y;
  for (size_t e = 0; e < 3; e++) a[e] = -x[e];
  dy[0] = x[0] * v[0];
}

/* The angle by which the oscillator x'' = -x is ahead after five turns of `steps` each, and what its radius has become.
 */
static double ahead(const char *name, int steps, double *radius) {
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, circle, NULL});
  fake_method m = fake_method_open(name, f);
  double *X = f->system.X, h = 2 * M_PI / steps;
  X[0] = 1;
  for (int s = 0; s < 5 * steps; s++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  double angle = atan2(-X[3], X[0]);
  *radius = hypot(X[0], X[3]);
  fake_method_close(&m);
  fake_system_destroy(f);
  return angle;
}

/* The term of the series that is left out first, sigma_8 D^8 a with sigma_8 = 33953/518400, changes the frequency by
 * sigma_8/2 (h w)^8 of itself; the terms after it by an amount that falls with h w, which is 0.13 to 0.08 here. */
static void order_8_has_the_error_of_its_series(void **state) {
  (void)state;
  for (int steps = 48; steps <= 80; steps += 16) {
    double radius, h = 2 * M_PI / steps, expected = 33953.0 / 518400 / 2 * pow(h, 8) * 10 * M_PI;
    double angle = ahead("stoermer8", steps, &radius);
    print_message("%d steps a turn: %.3g ahead, expected %.3g, radius off by %.1e\n", steps, angle, expected,
                  radius - 1);
    if (!(fabs(fabs(angle) / expected - 1) < 2.5 * h)) fail_msg("%d steps: %g, expected %g", steps, angle, expected);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(step_is_the_formula_in_differences),
      cmocka_unit_test(steps_are_stable_to_where_it_is_stated),
      cmocka_unit_test(coefficients_up_to_the_order_are_those_of_the_series),
      cmocka_unit_test(order_8_has_the_error_of_its_series),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
