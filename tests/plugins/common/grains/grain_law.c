/* The law of a soft contact by itself: against its own equation of motion, integrated here, and at its limits. */
#include "plugins/common/grains/grain_law.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

/* x'' = -x - 2 z x' from x = 0, x' = 1 until the right-hand side ends, in steps of 1e-5 by the classical method of
 * order 4; the last step may be one too many: 1e-5 of the duration. */
static void damping_gives_the_restitution_of_its_equation(void **state) {
  (void)state;
  const double wanted[] = {1, 0.99, 0.7, 0.3, exp(-2), 0.1, 0.01};
  for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
    double z = hk_grain_damping(wanted[k]), x = 0, v = 1, h = 1e-5, t = 0;
    while (t == 0 || x + 2 * z * v > 0) {
      double k1 = -x - 2 * z * v, v2 = v + h / 2 * k1, k2 = -(x + h / 2 * v) - 2 * z * v2, v3 = v + h / 2 * k2,
             k3 = -(x + h / 2 * v2) - 2 * z * v3, v4 = v + h * k3, k4 = -(x + h * v3) - 2 * z * v4;
      x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      t += h;
    }
    assert_true(fabs(-v - wanted[k]) < 2e-5 && fabs(t - hk_grain_duration(z)) < 2 * h);
  }
}

static hk_grain_contact sliding(double slip, double u) {
  return (hk_grain_contact){.overlap = 0.01, .mass = 2, .normal = {0, 0, 1}, .u = {u, 0, 0}, .slip = {slip, 0, 0}};
}

/* N = 10 N, T at most 4 N: by hand. */
static void friction_is_a_spring_up_to_its_limit(void **state) {
  (void)state;
  hk_grain_law law = {.stiffness = 1000, .tangential = 500, .friction = 0.4, .damping = 0, .yielding = 1};
  hk_grain_contact below = sliding(0.006, 0), above = sliding(0.02, 3);
  hk_grain_force(&law, &below);
  assert_true(fabs(below.force[2] - 10) < 1e-12 && fabs(below.force[0] + 3) < 1e-12 && below.slip[0] == 0.006);
  hk_grain_force(&law, &above);
  assert_true(fabs(above.force[0] + 4) < 1e-12);       /* mu N */
  assert_true(fabs(above.slip[0] - 4. / 500) < 1e-15); /* what gives that force */
  assert_true(fabs(above.power + 4 * 3) < 1e-12);      /* what it takes */
  assert_true(above.across[2] == 0 && above.across[0] == above.force[0]);
}

static void a_contact_never_pulls(void **state) {
  (void)state;
  hk_grain_law law = {.stiffness = 1000, .tangential = 500, .friction = 0.4, .damping = 0.5, .yielding = 1};
  for (double apart = -2; apart <= 2; apart += 0.125) {
    hk_grain_contact c = sliding(0.01, 1);
    c.u[2] = apart;
    hk_grain_force(&law, &c);
    double N = 10 - 2 * 0.5 * sqrt(2000) * apart;
    assert_true(fabs(c.force[2] - fmax(0, N)) < 1e-12);
    assert_true(hypot(c.force[0], c.force[1]) <= 0.4 * fmax(0, N) * (1 + 1e-15));
    assert_true(c.power <= 0);
  }
}

/* A tangential spring that slips at once holds nothing, and must not shorten the step. */
static void without_friction_nothing_is_stiff_across(void **state) {
  (void)state;
  hk_grain_law law = {.stiffness = 1000, .tangential = 500, .damping = 0.1, .yielding = 3.5};
  hk_grain_bound K = hk_grain_stiffness(&law, HK_STIFFNESS_WHOLE, 2), D = hk_grain_stiffness(&law, HK_DAMPING_WHOLE, 2);
  assert_true(K.along == 1000 && K.across == 0 && D.across == 0);
  assert_true(fabs(D.along - 2 * 0.1 * sqrt(2000)) < 1e-12);
  law.friction = 0.4;
  assert_true(hk_grain_stiffness(&law, HK_STIFFNESS_WHOLE, 2).across == 1750);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(damping_gives_the_restitution_of_its_equation),
      cmocka_unit_test(friction_is_a_spring_up_to_its_limit),
      cmocka_unit_test(a_contact_never_pulls),
      cmocka_unit_test(without_friction_nothing_is_stiff_across),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
