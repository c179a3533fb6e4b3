/* Wind on particles: by hand, on a path with a closed form, together with a vortex, and refused where it makes no
 * sense. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_wind(test_engine *e, const char *name, double value) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 2), test_particle(e, 1, 2, 3, 0.5);
  memcpy(e->scene->particles.velocity, (double[]){1, 0, -2, 0, 3, 0}, 6 * sizeof(double));
  e->options.dt = 1e-3;
  hk_plugin_spec *wind = test_plugin(e, HK_FORCE, "wind");
  test_text(e, wind, "on", "particles");
  test_vector(e, wind, "velocity", 4, -1, 0);
  if (name) test_number(e, wind, name, value);
  return wind;
}

/* u - v is (3, -1, 2) and (4, -4, 0); all exact in binary. */
static void wind_per_particle_and_per_mass_by_hand(void **state) {
  (void)state;
  static const double apart[6] = {3, -1, 2, 4, -4, 0}, v[6] = {1, 0, -2, 0, 3, 0};
  for (int k = 0; k < 4; k++) {
    test_engine e;
    double F[6], power = 0, still = k < 2;
    hk_plugin_spec *spec = open_wind(&e, k % 2 ? "rate" : "d", 0.5);
    if (!still) test_boolean(&e, spec, "relative", false);
    test_run(&e);
    hk_instance *wind = test_instance(&e, spec);
    hk_view view = force_view(&e, wind);
    double done = force_evaluate(wind, &view, F);
    for (int c = 0; c < 6; c++) {
      double d = k % 2 ? 0.5 * (c < 3 ? 2 : 0.5) : 0.5, wanted = d * (apart[c] + (still ? 0 : v[c]));
      assert_true(F[c] == wanted);
      power += wanted * v[c];
    }
    assert_true(done == power);
    /* The force is linear: differences have rounding alone. */
    assert_true(force_damping_error(wind, &view) < 1e-12 && force_stiffness_error(wind, &view) == 0);
    test_engine_close(&e);
  }
}

/* x = u t + (v - u) (1 - e^(-r t))/r. rk4 with 1,000 steps leaves (h r)^4/120 of it: 1e-13. */
static void path_in_steady_wind_is_its_closed_form(void **state) {
  (void)state;
  const double rate = 2, w[3] = {4, -1, 0}, v[3] = {1, 0, -2};
  test_engine e;
  open_wind(&e, "rate", rate);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->duration = 1;
  test_run(&e);
  test_advance(&e, 1);
  for (int c = 0; c < 3; c++)
    assert_true(fabs(test_position(&e, 1)[c] - (w[c] + (v[c] - w[c]) * (1 - exp(-rate)) / rate)) < 1e-12);
  test_engine_close(&e);
}

/* Of two airs of one drag the second gives d u alone: F = d (u_1 + u_2 - v), here with u_2 = 0 on the vortex' axis and
 * its speed of 6/(2 pi 2) at 2 m from it. */
static void airs_are_summed(void **state) {
  (void)state;
  test_engine e;
  double F[6], G[6];
  hk_plugin_spec *wind = open_wind(&e, "d", 0.5), *vortex = test_plugin(&e, HK_FORCE, "vortex");
  test_number(&e, vortex, "strength", 6);
  test_number(&e, vortex, "core", 0.1);
  test_number(&e, vortex, "d", 0.5);
  test_boolean(&e, vortex, "relative", false);
  test_vector(&e, vortex, "center", 1, 0, 0);
  test_run(&e);
  hk_view view = force_view(&e, test_instance(&e, wind));
  force_evaluate(test_instance(&e, wind), &view, F);
  force_evaluate(test_instance(&e, vortex), &view, G);
  double u = -6 / (6.283185307179586 * 2), wanted[3] = {0.5 * (4 + u - 0), 0.5 * (-1 - 3), 0};
  for (int c = 0; c < 3; c++) assert_true(fabs(F[3 + c] + G[3 + c] - wanted[c]) < 1e-15);
  test_engine_close(&e);
}

static void nonsense_is_refused(void **state) {
  (void)state;
  static const char *const wanted[] = {"give either d", "d is for particles", "blows on particles"};
  for (int k = 0; k < 3; k++) {
    test_engine e;
    hk_plugin_spec *wind = open_wind(&e, k == 1 ? "d" : NULL, 1);
    if (k > 0) test_text(&e, wind, "on", "triangles");
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    if (!strstr(e.error.text, wanted[k])) fail_msg("%s", e.error.text);
    test_engine_close(&e);
  }
}

/* The summary and the help of the coefficients state one formula in the same letters. */
static void formula_is_stated_once(void **state) {
  (void)state;
  test_engine e;
  const hk_plugin *wind = open_wind(&e, NULL, 0)->plugin;
  const char *d = NULL, *rate = NULL;
  for (const hk_param *p = wind->params; p->name; p++)
    if (strcmp(p->name, "d") == 0)
      d = p->help;
    else if (strcmp(p->name, "rate") == 0)
      rate = p->help;
  assert_non_null(strstr(wind->summary, "F = d (u - v); u: velocity of the air"));
  assert_true(d && strstr(d, "F = d (u - v); u: velocity of the air"));
  assert_true(rate && strstr(rate, "F = rate m (u - v)"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wind_per_particle_and_per_mass_by_hand),
      cmocka_unit_test(path_in_steady_wind_is_its_closed_form),
      cmocka_unit_test(airs_are_summed),
      cmocka_unit_test(nonsense_is_refused),
      cmocka_unit_test(formula_is_stated_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
