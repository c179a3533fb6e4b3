/* Heat on a grid: the enthalpy is kept to rounding while particles move through the cells and melt, faces give what
 * they should, steps may be long, and what does not fit together is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double cell = 0.1, latent = 1e5;

/* A plane box of 1 m by 0.4 m, full of particles that turn about its middle; the left half is molten. */
static hk_plugin_spec *full(test_engine *e) {
  double none = 0;
  test_engine_open(e);
  e->options.integrator = "symplectic_euler";
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &none, NAN, NULL, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e->scene, "given", 1, &none, NAN, NULL, &e->error), HK_OK);
  for (int i = 0; i < 20; i++)
    for (int k = 0; k < 8; k++) {
      double x = (i + 0.5) * cell / 2, z = (k + 0.5) * cell / 2, value = i < 10 ? 2 * latent : -latent;
      uint32_t id = test_particle(e, x, 0, z, 1000 * cell * cell * cell / 4);
      assert_int_equal(hk_scene_set_channel(e->scene, "enthalpy", id, &value, 1, &e->error), HK_OK);
    }
  hk_plugin_spec *heat = test_plugin(e, HK_FORCE, "grid_conduction");
  test_vector(e, heat, "low", 0, 0, 0);
  test_vector(e, heat, "high", 1, 0, 0.4);
  test_number(e, heat, "cell", cell);
  test_text(e, heat, "channel", "enthalpy");
  test_text(e, heat, "account", "given");
  test_number(e, heat, "solidus", 300);
  test_number(e, heat, "latent", latent);
  test_number(e, heat, "capacity", 1000);
  test_number(e, heat, "conductivity", 1000);
  e->scene->fps = 10;
  return heat;
}

static double sum_of(test_engine *e, size_t channel) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++) sum += view->model->mass[i] * view->y[channel * view->n + i];
  return sum;
}

/* No particle becomes warmer than the warmest or colder than the coldest, but for a part that none about it has room
 * for: 0.2 % here. */
static void the_enthalpy_is_kept(void **state) {
  (void)state;
  test_engine e;
  full(&e);
  for (uint32_t id = 1; id <= 160; id++) {
    const double *x = e.scene->particles.position + 3 * (size_t)(id - 1);
    double *v = e.scene->particles.velocity + 3 * (size_t)(id - 1);
    v[0] = 0.3 * (x[2] - 0.2), v[2] = 0.1 * (0.5 - x[0]);
  }
  e.scene->dt = 0.02;
  test_run(&e);
  double before = sum_of(&e, 0);
  test_advance(&e, 2);
  double off = sum_of(&e, 0) / before - 1, most = -INFINITY, least = INFINITY;
  const double *h = hk_run_view(e.run)->y;
  for (size_t i = 0; i < 160; i++) most = fmax(most, h[i]), least = fmin(least, h[i]);
  printf("enthalpy off by %.2g of it; from %.4g to %.4g J/kg\n", off, least, most);
  assert_true(fabs(off) < 1e-13 && most < 2.01 * latent && least > -1.01 * latent);
  test_engine_close(&e);
}

/* A melt turns beside a hot wall and a cold one, with solid in its cells: what is molten already leaves the cells' heat
 * to what melts. Without that the coldest came to 288.3 K. */
static void nothing_is_warmer_than_the_wall(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *heat = full(&e);
  test_list(&e, heat, "temperatures", (double[]){310, 290, 0, 0, 0, 0}, 6);
  for (uint32_t id = 1; id <= 160; id++) {
    const double *x = e.scene->particles.position + 3 * (size_t)(id - 1), mixed = id % 3 ? -5000 : latent + 5000;
    double *v = e.scene->particles.velocity + 3 * (size_t)(id - 1);
    v[0] = 0.3 * (x[2] - 0.2), v[2] = 0.1 * (0.5 - x[0]);
    assert_int_equal(hk_scene_set_channel(e.scene, "enthalpy", id, &mixed, 1, &e.error), HK_OK);
  }
  e.scene->dt = 0.02;
  test_run(&e);
  double most = -INFINITY, least = INFINITY;
  for (int step = 1; step <= 100; step++) {
    test_advance(&e, 0.02 * step);
    const double *h = hk_run_view(e.run)->y;
    for (size_t i = 0; i < 160; i++) most = fmax(most, h[i]), least = fmin(least, h[i]);
  }
  printf("between walls of 310 K and 290 K: %.6g to %.6g K\n", 300 + least / 1000, 300 + (most - latent) / 1000);
  assert_true(most < latent + 1e4 * (1 + 1e-9) && least > -1e4 * (1 + 1e-9));
  test_engine_close(&e);
}

/* A phase that does not conduct has no end to its enthalpies: heat moves in the other, and is kept. */
static void a_phase_may_not_conduct(void **state) {
  (void)state;
  static const double conductivity[2][2] = {{1000, 0}, {0, 1000}};
  for (int k = 0; k < 2; k++) {
    test_engine e;
    hk_plugin_spec *heat = full(&e);
    test_number(&e, heat, "conductivity", conductivity[k][0]);
    test_number(&e, heat, "conductivity_liquid", conductivity[k][1]);
    test_list(&e, heat, "fluxes", (double[]){1e6, -1e6, 0, 0, 0, 0}, 6);
    for (uint32_t id = 1; id <= 160; id++) {
      const double *x = e.scene->particles.position + 3 * (size_t)(id - 1);
      double *v = e.scene->particles.velocity + 3 * (size_t)(id - 1);
      v[0] = 0.3 * (x[2] - 0.2), v[2] = 0.1 * (0.5 - x[0]);
    }
    e.scene->dt = 0.02;
    test_run(&e);
    double before = sum_of(&e, 0);
    test_advance(&e, 2);
    printf("enthalpy off by %.2g of it\n", sum_of(&e, 0) / before - 1);
    assert_true(fabs(sum_of(&e, 0) / before - 1) < 1e-12);
    test_engine_close(&e);
  }
}

/* 500 W/m^2 through 0.4 m by 0.1 m for 10 s; the heat of the first step flows in the second. */
static void faces_give_their_flux(void **state) {
  (void)state;
  test_engine e;
  test_list(&e, full(&e), "fluxes", (double[]){500, 0, 0, 0, 0, 0}, 6);
  e.scene->dt = 0.1;
  test_run(&e);
  double before = sum_of(&e, 0);
  test_advance(&e, 10);
  double given = sum_of(&e, 1), gained = sum_of(&e, 0) - before;
  printf("given %.10g J, gained %.10g J\n", given, gained);
  assert_true(fabs(given / (500 * 0.04 * 10) - 1) < 1e-9 && fabs(gained / given - 1) < 1e-9);
  test_engine_close(&e);
}

/* Between two temperatures, in steps of a thousand times the stable one of explicit methods, cell^2/(2 D) = 5 s: a
 * straight line, but within half a cell of the faces; where the jump was what is finer than cells decays slowly. */
static void long_steps_come_to_rest(void **state) {
  (void)state;
  test_engine e;
  test_list(&e, full(&e), "temperatures", (double[]){310, 290, 0, 0, 0, 0}, 6);
  e.scene->dt = 5000;
  e.scene->fps = 1.0 / 5000;
  test_run(&e);
  test_advance(&e, 200000);
  const double *h = hk_run_view(e.run)->y;
  for (size_t i = 0; i < 160; i++) {
    double x = hk_run_view(e.run)->x[3 * i], T = 310 - 20 * x,
           found = h[i] < 0 ? 300 + h[i] / 1000 : 300 + (h[i] - latent) / 1000;
    if (x > cell && x < 1 - cell && fabs(x - 0.5) > 2.5 * cell) assert_true(fabs(found - T) < 0.02);
  }
  test_engine_close(&e);
}

static void refuses(test_engine *e, const char *sentence) {
  assert_int_equal(hk_run_open(e->scene, &e->options, &e->run, &e->error), HK_BAD_PARAM);
  if (!strstr(e->error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e->error.text);
  test_engine_close(e);
}

static void what_does_not_fit_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_list(&e, full(&e), "fluxes", (double[]){500, 0}, 2);
  refuses(&e, "fluxes: there are 2, and a box has six faces");
  hk_plugin_spec *heat = full(&e);
  test_list(&e, heat, "fluxes", (double[]){500, 0, 0, 0, 0, 0}, 6);
  test_list(&e, heat, "temperatures", (double[]){310, 0, 0, 0, 0, 0}, 6);
  refuses(&e, "fluxes: the face at low x has a temperature, 310 K, and a flux, 500 W/m^2: of one place only one");
  test_list(&e, full(&e), "temperatures", (double[]){0, 0, 300, 0, 0, 0}, 6);
  refuses(&e, "the box has no depth between the faces at y");
  test_number(&e, full(&e), "liquidus", 290);
  refuses(&e, "liquidus: melting ends at 290 K and begins at the solidus, 300 K");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_enthalpy_is_kept),    cmocka_unit_test(nothing_is_warmer_than_the_wall),
      cmocka_unit_test(a_phase_may_not_conduct), cmocka_unit_test(faces_give_their_flux),
      cmocka_unit_test(long_steps_come_to_rest), cmocka_unit_test(what_does_not_fit_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
