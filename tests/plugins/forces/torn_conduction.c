/* Heat does not pass what is gone: springs, bars and triangles that melt or break conduct up to then as their closed
 * form says, and two halves that are torn apart keep their temperatures. */
#include "tests/support/melting.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double ends = 1.5; /* s: from 230 K with 40 K/s all is at 290 K, where the last has molten */

static void add_enthalpy(test_engine *e) {
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &(double){0}, NAN, NULL, &e->error), HK_OK);
}

/* One conductivity, one capacity, both 1. */
static hk_plugin_spec *conduct(test_engine *e) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "conduction");
  test_text(e, spec, "channel", "enthalpy");
  test_number(e, spec, "capacity", 1);
  test_number(e, spec, "conductivity", 1);
  return spec;
}

static void set_enthalpy(test_engine *e, uint32_t id, double h) {
  assert_int_equal(hk_scene_set_channel(e->scene, "enthalpy", id, &h, 1, &e->error), HK_OK);
}

static double enthalpy(test_engine *e, uint32_t id) {
  const hk_view *view = hk_run_view(e->run);
  for (size_t k = 0; k < view->model->channels; k++)
    if (strcmp(view->model->channel[k].name, "enthalpy") == 0)
      return view->y[view->model->channel[k].offset * view->n + id - 1];
  return NAN;
}

/* Two particles of 1 kg, 1 m apart, joined until `ends`. */
static void open_pair(test_engine *e) {
  test_engine_open(e);
  melting_channel(e, 230);
  add_enthalpy(e);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1, 0, 0, 1);
  set_enthalpy(e, 1, 1);
  hk_plugin_spec *heat = conduct(e);
  test_edges(e, heat, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, heat, "section", 0.2);
  e->options.integrator = "symplectic_euler";
  e->options.dt = 1e-3;
  e->scene->fps = 10;
  e->scene->duration = 10;
}

/* h1 - h2 = exp(-2 (section/length) t) as long as they are joined. The steps' error is (0.4 t)(0.4 dt)/2 = 1.2e-4 of
 * it, and the end is known to two steps, 8e-4. */
static void stops(test_engine *e, const char *what) {
  test_run(e);
  test_advance(e, 1.7);
  double left = enthalpy(e, 1) - enthalpy(e, 2), expected = exp(-0.4 * ends);
  test_advance(e, 4);
  double later = enthalpy(e, 1) - enthalpy(e, 2);
  printf("%s: %.6f left, %.6f expected, %.2g in later seconds\n", what, left, expected, later - left);
  assert_true(fabs(left / expected - 1) < 1e-3);
  assert_true(later == left && fabs(enthalpy(e, 1) + enthalpy(e, 2) - 1) < 1e-12);
  test_engine_close(e);
}

static void molten_springs_conduct_no_more(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e);
  melting_warms(&e, 40);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "melting_springs");
  test_edges(&e, springs, (const uint32_t[][2]){{2, 1}}, 1);
  test_number(&e, springs, "k", 1);
  melting_follows(&e, springs, 280, 10);
  stops(&e, "springs that melt");
}

static void molten_bars_conduct_no_more(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e);
  melting_warms(&e, 40);
  hk_plugin_spec *bars = test_plugin(&e, HK_CONSTRAINT, "melting_bars");
  test_edges(&e, bars, (const uint32_t[][2]){{1, 2}}, 1);
  test_text(&e, bars, "channel", "temperature");
  test_number(&e, bars, "melts", 290);
  stops(&e, "bars that melt");
}

/* The ends part with 0.2 m/s, of springs that hardly pull: the strain is 0.3 after 1.5 s. */
static void broken_springs_conduct_no_more(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e);
  e.scene->particles.velocity[3] = 0.2;
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "plastic_springs");
  test_edges(&e, springs, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, springs, "k", 1e-9);
  test_number(&e, springs, "yield", 10);
  test_number(&e, springs, "breaking", 0.2 * ends);
  stops(&e, "springs that break");
}

/* A sheet of 4 x 4 cells whose third row of triangles is as warm as melts from the start: what lies on both sides of it
 * are halves, each of which comes to its own mean, 1 and 0, and loses nothing; with the edges as with the triangles. */
static void torn_halves(const char *plugin, bool by_edges) {
  test_engine e;
  double sum[2] = {0}, most = 0;
  test_engine_open(&e);
  hk_plugin_spec *sheet = melting_sheet(&e, plugin, 1000, 10);
  add_enthalpy(&e);
  uint32_t triangle[2 * MELTING_SIDE * MELTING_SIDE][3], edge[2 * MELTING_SIDE * MELTING_SIDE][2], t = 0, g = 0;
  for (uint32_t i = 0; i < MELTING_SIDE; i++)
    for (uint32_t j = 0; j < MELTING_SIDE; j++) {
      uint32_t a = melting_sheet_at(i, j), b = melting_sheet_at(i + 1, j);
      const double T = i == 2 ? 4000 : 0;
      assert_int_equal(hk_scene_set_channel(e.scene, "temperature", a, &T, 1, &e.error), HK_OK);
      set_enthalpy(&e, a, i < 2 ? 1 : 0);
      test_pin(&e, HK_PIN_FIXED, a, NULL);
      if (i + 1 < MELTING_SIDE) edge[g][0] = a, edge[g++][1] = b;
      if (j + 1 < MELTING_SIDE) edge[g][0] = a, edge[g++][1] = a + 1;
      if (i + 1 == MELTING_SIDE || j + 1 == MELTING_SIDE) continue;
      memcpy(triangle[t++], (uint32_t[]){a, b, b + 1}, sizeof *triangle);
      memcpy(triangle[t++], (uint32_t[]){a, b + 1, a + 1}, sizeof *triangle);
    }
  (void)sheet;
  hk_plugin_spec *heat = conduct(&e);
  if (by_edges)
    test_edges(&e, heat, (const uint32_t(*)[2])edge, g), test_number(&e, heat, "section", 1e-3);
  else
    test_tuples(&e, heat, "triangles", 3, triangle[0], t), test_number(&e, heat, "thickness", 0.01);
  e.options.integrator = "symplectic_euler";
  e.scene->fps = 1;
  e.scene->duration = 100;
  test_run(&e);
  test_advance(&e, 10);
  for (uint32_t id = 1; id <= MELTING_SIDE * MELTING_SIDE; id++) {
    bool first = id <= 2 * MELTING_SIDE;
    sum[!first] += enthalpy(&e, id);
    most = fmax(most, fabs(enthalpy(&e, id) - (first ? 1 : 0)));
  }
  printf("%s, heat in %s: halves have %.15g and %.15g, off by %.2g at most\n", plugin, by_edges ? "edges" : "triangles",
         sum[0], sum[1], most);
  assert_true(most == 0 && sum[0] == 2 * MELTING_SIDE && sum[1] == 0);
  test_engine_close(&e);
}

static void halves_keep_their_temperatures(void **state) {
  (void)state;
  torn_halves("melting_membrane", false);
  torn_halves("melting_membrane", true);
  torn_halves("melting_springs", false);
  torn_halves("melting_springs", true);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(molten_springs_conduct_no_more),
      cmocka_unit_test(molten_bars_conduct_no_more),
      cmocka_unit_test(broken_springs_conduct_no_more),
      cmocka_unit_test(halves_keep_their_temperatures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
