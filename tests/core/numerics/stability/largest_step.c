/* The chosen step against limits in closed form, and against the growth of matrices of whole scenes. */
#include "core/engine/contract/contract.h"
#include "core/numerics/stability/stability.h"
#include "tests/support/network.h"

#include <complex.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Limits are bisected to 1e-7; where a mode's growth sets in with its square, the 2e-7 a step that count as none add
 * 1e-6 to them. */
static const double near = 1e-5;

static double polynomial(int order, double hw, double hg) {
  double largest = 0;
  for (int sign = -1; sign < 2; sign += 2) {
    double complex z = (-hg + sign * csqrt(hg * hg - 4 * hw * hw)) / 2, term = 1, sum = 1;
    for (int k = 1; k <= order; k++) sum += term *= z / k;
    largest = fmax(largest, cabs(sum));
  }
  return largest;
}

/* The methods' parameter is the order, of those whose growth is a polynomial's. */
static double taylor(const void *self, const void *method, double hw, double hg, double hb) {
  (void)method;
  return hb == 0 ? polynomial(*(const int *)self, hw, hg) : NAN;
}

/* Largest root of l^2 - trace l + determinant. */
static double radius(double trace, double determinant) {
  double d = trace * trace / 4 - determinant;
  return d < 0 ? sqrt(determinant) : fabs(trace / 2) + sqrt(d);
}

static double symplectic_euler(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hb;
  return hw == 0 ? fmax(1, fabs(1 - hg)) : radius(2 - hg - hw * hw, 1 - hg);
}

static double backward_euler(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hb;
  double d = 1 + hg + hw * hw;
  return radius((2 + hg) / d, 1 / d);
}

static double midpoint_rule(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hb;
  double z = hw * hw / 4, d = 1 + hg / 2 + z;
  return radius(2 * (1 - z) / d, (1 - hg / 2 + z) / d);
}

static const hk_integrator_tables methods[] = {
    {.own = {.size = sizeof(hk_integrator), .order = 1, .growth = taylor}},
    {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = taylor}},
    {.own = {.size = sizeof(hk_integrator), .order = 4, .growth = taylor}},
    {.own = {.size = sizeof(hk_integrator), .order = 1, .growth = symplectic_euler}},
    {.own = {.size = sizeof(hk_integrator), .order = 1, .growth = backward_euler}},
    {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = midpoint_rule}},
    {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = NULL}},
};
enum { EULER, HEUN, RK4, SYMPLECTIC, BACKWARD, MIDPOINT, UNKNOWN };

static hk_stable stable(int method, hk_spectrum s) {
  return hk_stable_step(&methods[method].own, &methods[method].own.order, &s);
}

static void assert_near(double value, double expected) {
  print_message("%.9g, expected %.9g\n", value, expected);
  assert_true(fabs(value - expected) <= near * expected);
}

static void undamped_limits_are_those_of_the_imaginary_axis(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 50, .w_reached = 50};
  assert_near(stable(RK4, s).limit * 50, 2 * sqrt(2));
  assert_near(stable(SYMPLECTIC, s).limit * 50, 2);
  assert_near(stable(SYMPLECTIC, s).suggestion * 50, 1.8);
  assert_true(stable(SYMPLECTIC, s).growth_rate == 0);
}

static void rates_are_limited_on_the_real_axis(void **state) {
  (void)state;
  hk_spectrum damped = {.g_max = 20, .alpha = 20}, channel = {.channel_rate = 20};
  assert_near(stable(EULER, damped).limit * 20, 2);
  assert_near(stable(HEUN, damped).limit * 20, 2);
  assert_near(stable(RK4, damped).limit * 20, 2.785293563405282); /* the root of z^3 - 4 z^2 + 12 z = 24 */
  assert_near(stable(RK4, channel).limit * 20, 2.785293563405282);
  assert_string_equal(stable(RK4, channel).why, "the fastest channel");
}

/* h w = 2 (sqrt(1 + x^2) - x), x = g/2w, for the method that takes the drag at the step's start. */
static void damping_shortens_the_symplectic_step(void **state) {
  (void)state;
  for (double x = 0.01; x < 100; x *= 3) {
    hk_spectrum s = {.w_max = 50, .g_max = 100 * x};
    assert_near(stable(SYMPLECTIC, s).limit * 50, 2 * (sqrt(1 + x * x) - x));
  }
}

/* Euler is stable for h <= g/w^2 (and 2/g when overdamped): with damping everywhere in proportion to stiffness, beta.
 */
static void damping_makes_euler_possible(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 100, .g_max = 20, .beta = 2e-3};
  assert_near(stable(EULER, s).limit, 2e-3);
  s = (hk_spectrum){.w_max = 100, .g_max = 30, .alpha = 30};
  assert_near(stable(EULER, s).limit, 3e-3);
  s = (hk_spectrum){.w_max = 100, .g_max = 2e3, .beta = 0.2};
  assert_near(stable(EULER, s).limit, 1e-3);
  s = (hk_spectrum){.w_max = 100, .g_max = 20, .beta = 2e-3, .w_undamped = 10}; /* modes of 10/s without damping */
  assert_true(stable(EULER, s).limit == 0);
}

/* The same from g >= 2e-3 w^2 - offset: with an offset of 0.2/s modes of 10/s may have no damping. Of two lines the
 * higher one counts. */
static void damping_from_below_makes_euler_possible(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 100, .g_max = 20, .damped = {{2e-3, 0}}};
  assert_near(stable(EULER, s).limit, 2e-3);
  s.damped[0].offset = 0.2;
  assert_true(stable(EULER, s).limit == 0);
  s.damped[1].slope = 1e-3;
  /* the second line, up to 14.1/s; as these modes are slow, 2e-7 a step allow a quarter of a percent */
  assert_true(fabs(stable(EULER, s).limit - 1e-3) < 5e-6);
}

/* With damping in proportion to stiffness, g = 4e-3 w^2, only the fastest mode is damped critically: its two rates are
 * 500/s, and 2/500 s is euler's limit. Were slow modes damped as much, one would have a rate of 1000/s. */
static void damping_that_rises_with_frequency_leaves_slow_modes_alone(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 500, .g_max = 1000, .damping_slope = 4e-3, .beta = 4e-3},
              box = {.w_max = 500, .g_max = 1000};
  assert_near(stable(EULER, s).limit, 2.0 / 500);
  assert_near(stable(EULER, box).limit, 0);
  box.alpha = 1000; /* a strong drag: w = 0 is damped as much */
  assert_near(stable(EULER, box).limit, 2.0 / 1000);
}

static void methods_without_a_stable_step_get_an_accurate_one(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 40};
  hk_stable e = stable(EULER, s), h = stable(HEUN, s);
  assert_true(e.limit == 0 && h.limit == 0);
  assert_near(e.suggestion * 40, 0.01);
  assert_near(h.suggestion * 40, 0.05);
  assert_near(e.growth_rate, log(sqrt(1 + 1e-4)) / (0.01 / 40));
  assert_near(h.growth_rate, log(sqrt(1 + pow(0.05, 4) / 4)) / (0.05 / 40));
}

static void nothing_limits_implicit_methods_and_free_flight(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 1e5, .g_max = 1e4, .beta = 1e-6}, free = {0};
  assert_true(stable(BACKWARD, s).limit == INFINITY && stable(MIDPOINT, s).limit == INFINITY);
  for (int k = EULER; k <= MIDPOINT; k++) assert_true(stable(k, free).suggestion == INFINITY);
  assert_true(isnan(stable(UNKNOWN, s).limit));
}

static double taylor_turning(const void *self, const void *method, double hw, double hg, double hb) {
  (void)method;
  double complex d = hg + hb * I, root = csqrt(d * d - 4 * hw * hw);
  double largest = 0;
  for (int sign = -1; sign < 2; sign += 2) {
    double complex z = (-d + sign * root) / 2, term = 1, sum = 1;
    for (int k = 1; k <= *(const int *)self; k++) sum += term *= z / k;
    largest = fmax(largest, cabs(sum));
  }
  return largest;
}

/* v' = i b v: on the imaginary axis, and with a spring at i (b + sqrt(b^2 + 4 w^2))/2. */
static void turning_limits_the_step(void **state) {
  (void)state;
  hk_integrator_tables method = {.own = {.size = sizeof(hk_integrator), .order = 4, .growth = taylor_turning}};
  hk_spectrum turned = {.b_max = 30}, sprung = {.w_max = 20, .w_reached = 20, .b_max = 30};
  assert_near(hk_stable_step(&method.own, &method.own.order, &turned).limit * 30, 2 * sqrt(2));
  assert_near(hk_stable_step(&method.own, &method.own.order, &sprung).limit * 40, 2 * sqrt(2));
  method.own.order = 2; /* grows on the axis, by z^4/8 a step */
  hk_stable s = hk_stable_step(&method.own, &method.own.order, &turned);
  assert_true(s.limit == 0 && s.growth_rate > 0);
  assert_near(s.suggestion * 30, 0.05);
}

/* What a method does not state is not guessed from its growth on real oscillators. */
static void unstated_growth_where_velocities_turn_gives_an_accurate_step(void **state) {
  (void)state;
  hk_spectrum s = {.w_max = 20, .w_reached = 20, .b_max = 30};
  hk_stable found = stable(RK4, s);
  assert_true(isnan(found.limit));
  assert_near(found.suggestion * 30, 0.05);
}

/* A domain with a gap, 0.5 < hw < 0.55: the step stays below it, whichever mode falls in. Gaps of less than 2 % may be
 * missed. */
static double gapped(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hg, (void)hb;
  return hw > 2 || (hw > 0.5 && hw < 0.55) ? 1.1 : 1;
}

static void the_first_gap_ends_the_search(void **state) {
  (void)state;
  hk_integrator_tables method = {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = gapped}};
  hk_spectrum s = {.w_max = 10};
  hk_stable found = hk_stable_step(&method.own, NULL, &s);
  print_message("%.9g\n", found.limit * 10);
  assert_true(found.limit * 10 <= 0.5 * (1 + near));
}

/* A band far narrower than the search's steps, 3 < hw < 3.03, that damping of 0.02 a step and more closes, below a
 * limit of 6. Of damping that grows with the frequency, g = beta w^2, the fastest mode is the first to pass it
 * unharmed, and with the step the damping of those that lie in it falls: at no step up to the limit may one of 10^4
 * modes grow. */
static double banded(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hb;
  return hw > 6 || (hw > 3 && hw < 3.03 && hg < 0.02) ? 1.1 : 1;
}

static void no_mode_falls_into_a_narrow_band(void **state) {
  (void)state;
  hk_integrator_tables method = {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = banded}};
  for (double beta = 1e-5; beta < 3e-3; beta *= 1.5) {
    hk_spectrum s = {.w_max = 100, .w_reached = 100, .g_max = 1e4 * beta, .beta = beta};
    double limit = hk_stable_step(&method.own, NULL, &s).limit, z = 3.015;
    /* beta w^2 h < 0.02 at w = z/h from h = beta z^2/0.02 on; but no sooner than the fastest mode is in the band. */
    double first = fmin(0.06, fmax(3 / s.w_max, beta * z * z / 0.02));
    print_message("beta %.3g: %.6g of %.6g\n", beta, limit, first);
    assert_true(limit <= first * 1.01 && limit >= 0.95 * first); /* 1.01: z is 3 to 3.03; 0.95: two steps of 2 % */
    for (double h = limit; h > 0.5 * limit; h *= 0.99)
      for (int k = 1; k <= 10000; k++) assert_true(banded(NULL, NULL, h * k * 0.01, h * beta * k * k * 1e-4, 0) == 1);
  }
}

/* The whole chain on scenes: 0.9 of the limit found is at most the true one, and at least 0.8 of it. True limits are
 * those of the exact largest eigenvalues. The extremes of w and g belong to one mode here, but for the mass ratio. */
static void suggestions_are_within_a_fifth_of_the_truth(void **state) {
  (void)state;
  for (int kind = 0; kind < 6; kind++) {
    size_t n = 7;
    spring_network *w = network_create(n * n, 2 * n * n, false);
    double damping = kind & 1 ? 1e-4 : 0, contrast = kind / 2 == 1 ? 1e4 : 1, heavy = kind / 2 == 2 ? 1e6 : 1;
    for (size_t i = 0; i < n * n; i++) {
      network_place(w, i, 0.1 * (double)(i % n), 0.1 * (double)(i / n), 0);
      network_mass(w, i, i % 4 == 0 ? 0.01 * heavy : 0.01);
    }
    network_fix(w, 0);
    for (size_t i = 0; i < n * n; i++) {
      if (i % n + 1 < n) network_join(w, i, i + 1, 500, 500 * damping);
      if (i + n < n * n) network_join(w, i, i + n, 500 / contrast, 500 / contrast * damping);
    }
    for (int covered = 0; covered < 2; covered++) {
      hk_spectrum s, exact = {.w_max = sqrt(network_largest_stiffness(w)), .g_max = network_largest_damping(w)};
      hk_error error = {0};
      exact.beta = damping;
      w->covered = covered;
      assert_int_equal(hk_spectrum_estimate(&w->system, &s, &error), HK_OK);
      for (int m = RK4; m <= SYMPLECTIC; m++) {
        double ratio = stable(m, s).suggestion / stable(m, exact).limit;
        print_message("scene %d, covered %d, method %d: %.4f of the limit\n", kind, covered, m, ratio);
        assert_true(ratio <= 0.9 * (1 + near) && ratio >= 0.8);
      }
    }
    network_destroy(w);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(undamped_limits_are_those_of_the_imaginary_axis),
      cmocka_unit_test(rates_are_limited_on_the_real_axis),
      cmocka_unit_test(damping_shortens_the_symplectic_step),
      cmocka_unit_test(damping_makes_euler_possible),
      cmocka_unit_test(damping_from_below_makes_euler_possible),
      cmocka_unit_test(damping_that_rises_with_frequency_leaves_slow_modes_alone),
      cmocka_unit_test(methods_without_a_stable_step_get_an_accurate_one),
      cmocka_unit_test(nothing_limits_implicit_methods_and_free_flight),
      cmocka_unit_test(turning_limits_the_step),
      cmocka_unit_test(unstated_growth_where_velocities_turn_gives_an_accurate_step),
      cmocka_unit_test(the_first_gap_ends_the_search),
      cmocka_unit_test(no_mode_falls_into_a_narrow_band),
      cmocka_unit_test(suggestions_are_within_a_fifth_of_the_truth),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
