/* Cooling against its closed forms: the integrator's own order, a target for each number of a channel, growth, and what
 * is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double T0 = 1500, air = 300, rate = 3, end = 0.5;

/* u' = -rate u^p scale^(1-p) with u = T - air, scale = T0 - air. */
static double closed_form(double power) {
  double u = T0 - air;
  if (power == 1) return air + u * exp(-rate * end);
  return air + u * pow(1 + (power - 1) * rate * end, 1 / (1 - power));
}

static double cooled(const char *integrator, double dt, double power) {
  test_engine e;
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "temperature", 1, &T0, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, 0, 1);
  hk_plugin_spec *relax = test_plugin(&e, HK_FORCE, "relax");
  test_text(&e, relax, "channel", "temperature");
  test_number(&e, relax, "rate", rate);
  test_list(&e, relax, "target", &air, 1);
  test_number(&e, relax, "power", power);
  test_number(&e, relax, "scale", T0 - air);
  e.options.integrator = integrator;
  e.options.dt = dt;
  e.options.tol = 1e-12;
  e.scene->fps = 10;
  test_run(&e);
  test_advance(&e, end);
  double T = hk_run_view(e.run)->y[0];
  test_engine_close(&e);
  return T;
}

/* From h = 1/100 to 1/400 each method's error falls with its order, measured to a quarter. Power 4 may fall faster: the
 * h^4 term of rk4 is small at the end of this run, so that h^5 shows. */
static void cooling_has_the_order_of_the_integrator(void **state) {
  (void)state;
  static const struct method {
    const char *name;
    double order;
  } methods[] = {{"euler", 1},   {"midpoint", 2},          {"leapfrog", 2},           {"rk4", 4},
                 {"bdf2", 2},    {"implicit_midpoint", 2}, {"implicit_trapezoid", 2}, {"backward_euler", 1},
                 {"stoermer", 4}};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++)
    for (double power = 1; power <= 4; power += 3) {
      double coarse = fabs(cooled(methods[k].name, 1.0 / 100, power) - closed_form(power)),
             fine = fabs(cooled(methods[k].name, 1.0 / 400, power) - closed_form(power));
      double order = log2(coarse / fine) / 2;
      printf("%-20s power %g: error %.3g K at h = 1/400 s, order %.3f\n", methods[k].name, power, fine, order);
      bool right = order > methods[k].order - 0.25 && (power > 1 || order < methods[k].order + 0.25);
      if (!right) fail_msg("%s: order %g", methods[k].name, order);
    }
}

/* dopri5 at a tolerance of 1e-12 makes some 50 steps, each off by 1e-12 of 1500 K at most. */
static void cooling_follows_its_closed_form(void **state) {
  (void)state;
  for (double power = 1; power <= 4; power += 1.5)
    assert_true(fabs(cooled("dopri5", NAN, power) - closed_form(power)) < 50 * 1e-12 * T0);
}

/* y' = growth - rate (y - target): y = target + growth/rate + (y0 - ...) exp(-rate t), for each number of a colour. */
static void each_number_has_its_target(void **state) {
  (void)state;
  const double colour[] = {1, 0.5, 0}, target[] = {0.2, 0.2, 0.9}, growth = 0.3;
  test_engine e;
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "other", 2, (double[]){7, 8}, NAN, NULL, &e.error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e.scene, "colour", 3, colour, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  hk_plugin_spec *relax = test_plugin(&e, HK_FORCE, "relax");
  relax->group = hk_string_copy("default");
  test_text(&e, relax, "channel", "colour");
  test_number(&e, relax, "rate", rate);
  test_number(&e, relax, "growth", growth);
  test_list(&e, relax, "target", target, 3);
  e.options.integrator = "rk4";
  e.options.dt = 1e-3;
  test_run(&e);
  test_advance(&e, end);
  const double *y = hk_run_view(e.run)->y;
  for (size_t i = 0; i < 2; i++) {
    assert_true(y[2 * i] == 7 && y[2 * i + 1] == 8);
    for (size_t c = 0; c < 3; c++) {
      double rest = target[c] + growth / rate;
      assert_true(fabs(y[4 + 3 * i + c] - rest - (colour[c] - rest) * exp(-rate * end)) < 1e-11); /* (rate h)^4 of 1 */
    }
  }
  test_engine_close(&e);
}

static void refuses(const char *channel, size_t targets, const char *sentence) {
  test_engine e;
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "heat", 1, NULL, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, 0, 1);
  hk_plugin_spec *relax = test_plugin(&e, HK_FORCE, "relax");
  test_text(&e, relax, "channel", channel);
  test_list(&e, relax, "target", (double[]){0, 0}, targets);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e.error.text);
  test_engine_close(&e);
}

static void channels_that_are_not_there_are_refused(void **state) {
  (void)state;
  refuses("cold", 1,
          "channel: the scene has no channel 'cold'; declare it: scene:channel(\"cold\", { initial = ... })");
  refuses("heat", 2, "target: 2 numbers for the channel 'heat', which has 1");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cooling_has_the_order_of_the_integrator),
      cmocka_unit_test(cooling_follows_its_closed_form),
      cmocka_unit_test(each_number_has_its_target),
      cmocka_unit_test(channels_that_are_not_there_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
