/* Heat from outside against closed forms: Newton's cooling, radiation, a source that melts, and what is counted. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double mass = 2, capacity = 500, area = 0.3; /* kg, J/(kg K), m^2 */

static hk_plugin_spec *body(test_engine *e, double T) {
  double h = capacity * T, none = 0;
  test_engine_open(e);
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &h, NAN, NULL, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e->scene, "given", 1, &none, NAN, NULL, &e->error), HK_OK);
  test_particle(e, 0, 0, 0, mass);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "heating");
  test_text(e, spec, "channel", "enthalpy");
  test_number(e, spec, "capacity", capacity);
  test_text(e, spec, "account", "given");
  e->options.integrator = "rk4";
  return spec;
}

/* The enthalpy at `end`, J/kg; all of its change is on the account. */
static double enthalpy_at(test_engine *e, double end) {
  e->scene->fps = 1 / end;
  test_run(e);
  double before = hk_run_view(e->run)->y[0];
  test_advance(e, end);
  const hk_view *view = hk_run_view(e->run);
  double after = view->y[0];
  for (size_t i = 0; i < view->n; i++)
    assert_true(fabs(view->y[i] - before - view->y[view->n + i]) < 1e-12 * fabs(before));
  test_engine_close(e);
  return after;
}

/* T = T0 + (T1 - T0) exp(-t area convection/(m c)); rk4 with steps of a tenth of the time is off by
 * 0.1^4/120 of 2.4 times 9 K. */
static void a_body_cools_as_newton_says(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = body(&e, 400);
  const double by = 40, end = 200;
  test_number(&e, spec, "convection", by);
  test_number(&e, spec, "area", area);
  test_number(&e, spec, "surroundings", 300);
  double T = enthalpy_at(&e, end) / capacity, wanted = 300 + 100 * exp(-end * area * by / (mass * capacity));
  printf("convection: %.8g K, exactly %.8g K\n", T, wanted);
  assert_true(fabs(T - wanted) < 2.5e-5);
}

/* Into empty space: T^-3 = T0^-3 + 3 area e sigma t/(m c). */
static void a_body_radiates_as_stefan_and_boltzmann_say(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = body(&e, 1500);
  const double end = 60, sigma = 5.670374419e-8, e0 = 0.8;
  test_number(&e, spec, "emissivity", e0);
  test_number(&e, spec, "area", area);
  test_number(&e, spec, "surroundings", 0);
  double T = enthalpy_at(&e, end) / capacity;
  double wanted = pow(pow(1500, -3) + 3 * area * e0 * sigma * end / (mass * capacity), -1.0 / 3);
  printf("radiation: %.8g K, exactly %.8g K\n", T, wanted);
  assert_true(wanted < 1200 && fabs(T - wanted) < 1e-3);
}

/* 10 K below its melting point, a source of 50 W melts it in m (10 c + latent)/50 s, and not before. */
static void a_source_melts_in_its_time(void **state) {
  (void)state;
  const double latent = 2e4, time = mass * (10 * capacity + latent) / 50;
  test_engine e;
  hk_plugin_spec *spec = body(&e, -10); /* 0 is the solid at the solidus */
  test_number(&e, spec, "solidus", 300);
  test_number(&e, spec, "latent", latent);
  test_number(&e, spec, "power", 50);
  assert_true(fabs(enthalpy_at(&e, time) - latent) < 1e-8 * latent);
}

/* Two of three particles get heat, each by its own area. */
static void each_particle_has_its_own_area(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = body(&e, 400);
  test_particle(&e, 1, 0, 0, mass);
  test_particle(&e, 2, 0, 0, mass);
  test_list(&e, spec, "particles", (double[]){3, 2}, 2);
  test_list(&e, spec, "area", (double[]){0.1, 0.2}, 2);
  test_number(&e, spec, "convection", 1e-3);
  test_number(&e, spec, "surroundings", 300);
  e.scene->fps = 1;
  test_run(&e);
  test_advance(&e, 1);
  const double *y = hk_run_view(e.run)->y;
  assert_true(y[0] == capacity * 400);
  assert_true(fabs((y[2] - y[0]) * mass / (-0.1 * 1e-3 * 100) - 1) < 1e-6);
  assert_true(fabs((y[1] - y[0]) * mass / (-0.2 * 1e-3 * 100) - 1) < 1e-6);
  test_engine_close(&e);
}

/* A hot ball of 0.2 m that moves by 1 m/s along x: of three particles it passes one within its reach, which cools as
 * Newton says for as long as it is there, (0.1 + 0.05)/1 s on either side; one is beside its way, one ahead of it. */
static hk_status ball_at(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                         size_t room, size_t *got, hk_error *error) {
  (void)f, (void)caller, (void)count, (void)room, (void)error;
  out[0] = *t - 0.5;
  out[1] = out[2] = 0;
  *got = 3;
  return HK_OK;
}

static void a_moving_ball_heats_what_it_passes(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = body(&e, 300);
  test_particle(&e, 0, 0.16, 0, mass);
  test_particle(&e, 2, 0, 0, mass);
  test_text(&e, spec, "shape", "sphere");
  test_vector(&e, spec, "size", 0.2, 0.2, 0.2);
  test_function(&e, spec, "position", (hk_function){.call = ball_at});
  test_number(&e, spec, "reach", 0.05);
  test_number(&e, spec, "convection", 40);
  test_number(&e, spec, "area", area);
  test_number(&e, spec, "surroundings", 900);
  e.options.dt = 1e-3;
  e.scene->fps = 1;
  test_run(&e);
  test_advance(&e, 1);
  const double *y = hk_run_view(e.run)->y;
  double wanted = 900 - 600 * exp(-0.3 * area * 40 / (mass * capacity));
  printf("a ball that passes: %.8g K, exactly %.8g K\n", y[0] / capacity, wanted);
  assert_true(y[1] == capacity * 300 && y[2] == capacity * 300);
  assert_true(fabs(y[0] / capacity - wanted) < 1e-2 * (wanted - 300)); /* it comes and goes within a step of 1e-3 s */
  test_engine_close(&e);
}

static void refuses(const char *name, double value, const char *sentence) {
  test_engine e;
  hk_plugin_spec *spec = body(&e, 300);
  if (strcmp(name, "account") == 0)
    test_text(&e, spec, "account", "enthalpy");
  else if (strcmp(name, "shape") == 0)
    test_text(&e, spec, "shape", "sphere");
  else
    test_number(&e, spec, name, value);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e.error.text);
  test_engine_close(&e);
}

/* An empty list of areas is refused, and convection without a surface is said to do nothing. */
static void a_surface_is_asked_for(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = body(&e, 400);
  test_list(&e, spec, "area", (double[]){0}, 0);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "area: the list is empty: give one number"));
  test_engine_close(&e);
  for (int k = 0; k < 2; k++) {
    spec = body(&e, 400);
    test_number(&e, spec, "convection", 40);
    if (k) test_number(&e, spec, "area", area);
    test_run(&e);
    hk_summary s;
    hk_run_summary(e.run, &s);
    assert_int_equal(s.warnings, k ? 0 : 1);
    test_engine_close(&e);
  }
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  refuses("solidus", 300, "latent: what melts takes heat for it: give `latent` in J/kg");
  refuses("shape", 0, "reach: a shape heats what is near: give `reach`, the distance from it in metres");
  refuses("account", 0, "account: 'enthalpy' is the channel of the enthalpy itself");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_body_cools_as_newton_says),
      cmocka_unit_test(a_body_radiates_as_stefan_and_boltzmann_say),
      cmocka_unit_test(a_source_melts_in_its_time),
      cmocka_unit_test(each_particle_has_its_own_area),
      cmocka_unit_test(a_moving_ball_heats_what_it_passes),
      cmocka_unit_test(a_surface_is_asked_for),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
