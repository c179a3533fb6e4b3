/* The step of grains: the largest stable one, by what their contacts can be at most, against those that they have; and
 * the one that is chosen, by what a collision lasts. */
#include "core/numerics/stability/stability.h"
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

static const double R = 0.1, K = 1000, MASS = 0.01; /* m, N/m, kg */

/* w_max^2 over k/m of grains in a row that touch, smooth ones. */
static double largest(size_t n) {
  test_engine e;
  hk_spectrum spectrum;
  test_engine_open(&e);
  for (size_t i = 0; i < n; i++) test_particle(&e, 1.999 * R * (double)i, 0, 0, MASS);
  hk_plugin_spec *s = test_plugin(&e, HK_FORCE, "soft_spheres");
  test_number(&e, s, "radius", R);
  test_number(&e, s, "stiffness", K);
  test_number(&e, s, "restitution", 1);
  test_number(&e, s, "friction", 0);
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  test_run(&e);
  assert_int_equal(hk_spectrum_estimate(&e.run->dynamics.system, &spectrum, &e.error), HK_OK);
  test_engine_close(&e);
  return spectrum.w_max * spectrum.w_max * MASS / K;
}

/* Two have one contact, w^2 = 2 k/m, three two, whose bound is 4 k/m where 3 k/m is true. Many may have a dozen each,
 * which add up to 5.2 along an axis by caps (crowd.c), and to 10.4 k/m. */
static void no_more_touch_than_there_are(void **state) {
  (void)state;
  assert_true(fabs(largest(2) - 2) < 1e-6);
  assert_true(fabs(largest(3) - 4) < 1e-6);
  double many = largest(9);
  print_message("9 grains: %.4g k/m\n", many);
  assert_true(many > 8 && many < 10.5);
}

/* ---- the step that is chosen ---- */

/* Two grains of m and 2 m, `gap` apart, of which one comes with 1 m/s; without friction. */
static void open_pair(test_engine *e, double gap, double restitution) {
  test_engine_open(e);
  e->scene->fps = 10;
  e->scene->duration = 0.2;
  uint32_t first = test_particle(e, 0, 0, 0, MASS);
  e->scene->particles.velocity[3 * (size_t)(first - 1)] = 1;
  test_particle(e, 2 * R + gap, 0, 0, 2 * MASS);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "soft_spheres");
  test_number(e, s, "radius", R);
  test_number(e, s, "stiffness", K);
  test_number(e, s, "restitution", restitution);
  test_number(e, s, "friction", 0);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  test_run(e);
}

/* Half a period, pi/w with w^2 = k (m + M)/(m M); or, of a grain and a wall, k/m. */
static void a_chosen_step_is_a_twentieth_of_a_collision(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e, 0.1, 1);
  double dt = hk_step_choice_of(&e.run->loop)->length.dt, half = M_PI * sqrt(2. / 3 * MASS / K);
  if (!(fabs(dt - half / 20) < 1e-12 * half)) fail_msg("%g s instead of %g s", dt, half / 20);
  test_engine_close(&e);
  test_engine_open(&e);
  e.scene->fps = 10;
  test_particle(&e, 0, 0, 2 * R, MASS);
  hk_plugin_spec *s = test_plugin(&e, HK_FORCE, "soft_walls");
  test_number(&e, s, "radius", R);
  test_number(&e, s, "stiffness", K);
  test_number(&e, s, "restitution", 1);
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  test_run(&e);
  dt = hk_step_choice_of(&e.run->loop)->length.dt;
  half = M_PI * sqrt(MASS / K);
  if (!(fabs(dt - half / 20) < 1e-12 * half)) fail_msg("wall: %g s instead of %g s", dt, half / 20);
  test_engine_close(&e);
}

/* At the step chosen, wherever in a step a collision begins. The force begins with a jump, which a step sees up to h
 * too late: z w h of the speed, a twentieth of z w t = -log e (grain_law.h). Beside that contact that sets in and
 * ceases changes an energy by about (h w)^2/4 (largest_step.c), and a speed by half of it, twice. */
static void collisions_are_right_at_the_step_chosen(void **state) {
  (void)state;
  static const double restitution[] = {1, 0.8, 0.3};
  for (int k = 0; k < 3; k++)
    for (int part = 0; part < 8; part++) {
      test_engine e;
      double h = M_PI * sqrt(2. / 3 * MASS / K) / 20, wanted = restitution[k];
      open_pair(&e, 1e-3 + h * part / 8, wanted);
      test_advance(&e, 0.2);
      double left = test_velocity(&e, 2)[0] - test_velocity(&e, 1)[0];
      double bound = -log(wanted) / 20 + (M_PI / 20) * (M_PI / 20) / 4;
      if (!(fabs(left - wanted) < bound)) fail_msg("restitution %g instead of %g, bound %g", left, wanted, bound);
      test_engine_close(&e);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_more_touch_than_there_are),
      cmocka_unit_test(a_chosen_step_is_a_twentieth_of_a_collision),
      cmocka_unit_test(collisions_are_right_at_the_step_chosen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
