/* The corrector gas in whole runs: air that is warm above rests, wind goes round a cylinder as it does in theory, hot
 * gas rises, steps that are taken back leave no trace, threads do not change bits, and what cannot be is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

typedef struct room {
  test_engine e;
  hk_plugin_spec *gas;
} room;

static void open_room(room *r, double dt) {
  test_engine_open(&r->e);
  r->e.options.integrator = "symplectic_euler";
  r->e.options.dt = dt;
}

/* A plane one of 1 m squared. */
static void hold(room *r, double cell, double top) {
  r->gas = test_plugin(&r->e, HK_CORRECTOR, "gas");
  test_vector(&r->e, r->gas, "low", 0, 0, 0);
  test_vector(&r->e, r->gas, "high", 1, 0, top);
  test_number(&r->e, r->gas, "cell", cell);
}

static const double *field_at(room *r, const char *name, uint32_t id) {
  const hk_model *m = hk_run_view(r->e.run)->model;
  for (size_t k = 0; k < m->publications; k++)
    if (strcmp(m->published[k].name, name) == 0)
      return *m->published[k].values + m->published[k].width * hk_model_find(m, id);
  fail_msg("no field '%s'", name);
  return NULL;
}

static uint32_t probe(room *r, double x, double z) {
  uint32_t id = test_particle(&r->e, x, 0, z, 1);
  test_pin(&r->e, HK_PIN_FIXED, id, NULL);
  return id;
}

/* A source in a closed room, and a tracer above it. */
static uint32_t open_plume(room *r, double dt) {
  open_room(r, dt);
  hold(r, 1 / 16.0, 1);
  uint32_t source = probe(r, 0.47, 0.2), tracer = test_particle(&r->e, 0.5, 0, 0.35, 1);
  test_list(&r->e, r->gas, "sources", (double[]){source}, 1);
  test_number(&r->e, r->gas, "source_temperature", 400);
  test_number(&r->e, r->gas, "source_smoke", 0.1);
  return tracer;
}

/* Heat that comes from above makes layers, whose pressure bears them: 30 K would give 1 m/s in a second. */
static void air_that_is_warm_above_rests(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.05);
  hold(&r, 1 / 8.0, 1);
  uint32_t id = probe(&r, 0.3, 0.8);
  test_number(&r.e, r.gas, "ceiling", 323);
  test_number(&r.e, r.gas, "diffusivity", 0.05);
  test_number(&r.e, r.gas, "tolerance", 1e-9);
  test_run(&r.e);
  test_advance(&r.e, 1);
  const double *u = field_at(&r, "flow", id);
  if (!(hypot(u[0], u[2]) < 1e-9)) fail_msg("%.3g m/s", hypot(u[0], u[2]));
  assert_true(*field_at(&r, "temperature", id) > 300);
  test_engine_close(&r.e);
}

/* The first step from rest in the wind is potential flow: beside a cylinder u = U (1 + a^2/r^2), 1 + 4/9 at r = 1.5 a.
 * Sides at 5 a add (pi a)^2/3 = 3 %, and a has 3.2 cells: 5 %. */
static void wind_goes_round_a_cylinder(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.001);
  hk_plugin_spec *ball = test_plugin(&r.e, HK_CORRECTOR, "obstacle");
  test_text(&r.e, ball, "shape", "sphere");
  test_vector(&r.e, ball, "size", 0.2, 0.2, 0.2);
  test_vector(&r.e, ball, "position", 0.5, 0, 0.5);
  hold(&r, 1 / 32.0, 1);
  test_text(&r.e, r.gas, "open", "sides");
  test_vector(&r.e, r.gas, "wind", 1, 0, 0);
  uint32_t above = probe(&r, 0.5, 0.35), front = probe(&r, 0.35, 0.5);
  test_run(&r.e);
  test_advance(&r.e, 0.001);
  double u = field_at(&r, "flow", above)[0], before = field_at(&r, "flow", front)[0];
  if (!(fabs(u / (13 / 9.0) - 1) < 0.05)) fail_msg("%.4f beside it", u);
  if (!(fabs(before - 5 / 9.0) < 0.05)) fail_msg("%.4f before it", before); /* U (1 - a^2/r^2) */
  test_engine_close(&r.e);
}

static void hot_gas_rises_and_takes_tracers_along(void **state) {
  (void)state;
  room r;
  uint32_t tracer = open_plume(&r, 0.02);
  test_run(&r.e);
  test_advance(&r.e, 0.6);
  double height = test_position(&r.e, tracer)[2];
  if (!(height > 0.42)) fail_msg("%.4f m, %g m/s", height, test_velocity(&r.e, tracer)[2]);
  assert_true(test_velocity(&r.e, tracer)[2] == field_at(&r, "flow", tracer)[2]);
  test_engine_close(&r.e);
}

static void correct(room *r, double t, double h) {
  const hk_instance *gas = test_instance(&r->e, r->gas);
  hk_view view = *hk_run_view(r->e.run);
  double x[6], v[6];
  memcpy(x, view.x, sizeof x);
  memcpy(v, view.v, sizeof v);
  view.t = t;
  hk_correction c = {.h = h, .x_before = view.x, .v_before = view.v, .x = x, .v = v};
  assert_int_equal(gas->plugin->corrector->correct(gas->self, &view, &c), HK_OK);
}

/* As a corrector further down does that asks for it: the two halves are as if the whole had not been tried. What is
 * left is the pressure's tolerance of 1e-6, since its first guess is another one. */
static void a_step_that_is_taken_back_leaves_no_trace(void **state) {
  (void)state;
  double speed[2];
  for (int tried = 0; tried < 2; tried++) {
    room r;
    uint32_t tracer = open_plume(&r, 0.02);
    test_run(&r.e);
    test_advance(&r.e, 0.2);
    if (tried) correct(&r, 0.24, 0.04);
    correct(&r, 0.22, 0.02);
    correct(&r, 0.24, 0.02);
    speed[tried] = field_at(&r, "flow", tracer)[2];
    test_engine_close(&r.e);
  }
  if (!(fabs(speed[1] - speed[0]) < 1e-5 * fabs(speed[0]))) fail_msg("%.9g instead of %.9g", speed[1], speed[0]);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  double last[2][3];
  for (int t = 0; t < 2; t++) {
    room r;
    uint32_t tracer = open_plume(&r, 0.02);
    test_number(&r.e, r.gas, "confinement", 0.3);
    test_number(&r.e, r.gas, "viscosity", 1e-3);
    r.e.options.threads = t ? 3 : 1;
    test_run(&r.e);
    test_advance(&r.e, 0.4);
    memcpy(last[t], test_position(&r.e, tracer), sizeof last[t]);
    test_engine_close(&r.e);
  }
  assert_memory_equal(last[0], last[1], sizeof last[0]);
}

static void said(room *r, const char *sentence) {
  test_run(&r->e);
  bool found = false;
  for (size_t w = 0; w < r->e.run->warnings.count; w++) found |= strstr(r->e.run->warnings.text[w], sentence) != NULL;
  if (!found) fail_msg("nobody said '%s'", sentence);
  test_engine_close(&r->e);
}

static void what_the_grid_cannot_show_is_said(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.01);
  hk_plugin_spec *wall = test_plugin(&r.e, HK_CORRECTOR, "obstacle");
  test_text(&r.e, wall, "shape", "box");
  test_vector(&r.e, wall, "size", 1, 1, 0.05);
  hold(&r, 0.1, 1);
  test_particle(&r.e, 0.5, 0, 0.5, 1);
  said(&r, "obstacle 1 is 0.05 m thin near (0, 0, 0), and cells are 0.1 m: gas may leak");
  open_room(&r, 0.01);
  hold(&r, 0.1, 0.2);
  test_particle(&r.e, 0.5, 0, 0.1, 1);
  said(&r, "the gas has 2 cells across its box along z");
  open_plume(&r, 0.01);
  test_number(&r.e, r.gas, "source_radius", 0.01);
  said(&r, "source_radius: 0.01 m is less than a cell");
}

static void put_ball(room *r, double x, double z, double radius) {
  hk_plugin_spec *ball = test_plugin(&r->e, HK_CORRECTOR, "obstacle");
  test_text(&r->e, ball, "shape", "sphere");
  test_vector(&r->e, ball, "size", 2 * radius, 2 * radius, 2 * radius);
  test_vector(&r->e, ball, "position", x, 0, z);
}

static bool says_gap(room *r) {
  bool found = false;
  hold(r, 0.1, 1);
  test_particle(&r->e, 0.5, 0, 0.95, 1);
  test_run(&r->e);
  for (size_t w = 0; w < r->e.run->warnings.count; w++) found |= strstr(r->e.run->warnings.text[w], "gap") != NULL;
  test_engine_close(&r->e);
  return found;
}

/* Balls 0.15 m apart in cells of 0.1 m, one 0.12 m from the floor; what touches or is more than two cells apart is
 * none. */
static void narrow_gaps_are_said(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.01);
  put_ball(&r, 0.3, 0.6, 0.1);
  put_ball(&r, 0.65, 0.6, 0.1);
  hold(&r, 0.1, 1);
  test_particle(&r.e, 0.5, 0, 0.95, 1);
  said(&r, "between obstacle 1 and obstacle 2, near (0.475, 0, 0.6), is a gap of 0.15 m, and cells are 0.1 m");
  open_room(&r, 0.01);
  put_ball(&r, 0.5, 0.32, 0.2);
  hold(&r, 0.1, 1);
  test_particle(&r.e, 0.5, 0, 0.95, 1);
  said(&r, "between obstacle 1 and a side of the box, near (0.5, 0, 0.06), is a gap of 0.12 m");
  open_room(&r, 0.01);
  put_ball(&r, 0.4, 0.5, 0.1);
  put_ball(&r, 0.6, 0.5, 0.1);
  assert_false(says_gap(&r));
  open_room(&r, 0.01);
  put_ball(&r, 0.3, 0.5, 0.08);
  put_ball(&r, 0.7, 0.5, 0.08);
  hk_plugin_spec *wall = test_plugin(&r.e, HK_CORRECTOR, "obstacle"); /* a floor that the box stands on */
  test_text(&r.e, wall, "shape", "plane");
  assert_false(says_gap(&r));
}

/* Gas of 800 K with 0.1 kg/m^3 of smoke in air of 293 K and 1.2 kg/m^3: a h^2 = 2 cells. Later steps go by the speed,
 * and none has to be divided: the largest number of cells passed is near the bound, and never above. */
static void the_step_is_foretold(void **state) {
  (void)state;
  room r;
  open_plume(&r, NAN);
  r.e.scene->fps = 1;
  r.e.scene->duration = 3;
  test_number(&r.e, r.gas, "source_temperature", 800);
  test_run(&r.e);
  const hk_instance *gas = test_instance(&r.e, r.gas);
  hk_view view = *hk_run_view(r.e.run);
  double h = gas->plugin->corrector->longest_step(gas->self, &view, NULL);
  double lift = 9.81 * (507 / 293.0 - 0.1 / 1.2);
  if (!(fabs(h / sqrt(2 / 16.0 / lift) - 1) < 1e-12)) fail_msg("%.17g s with %g m/s^2", h, lift);
  test_advance(&r.e, 3);
  hk_own_figure figure[HK_OWN_FIGURES];
  gas->plugin->corrector->figures(gas->self, hk_run_view(r.e.run), figure);
  if (!(figure[1].value > 1 && figure[1].value <= 2)) fail_msg("%g cells in a step", figure[1].value);
  if (!(fabs(figure[2].value) < 0.1)) fail_msg("carrying has changed a sum by %g", figure[2].value);
  test_engine_close(&r.e);
}

static void refused(room *r, const char *sentence) {
  assert_int_equal(hk_run_open(r->e.scene, &r->e.options, &r->e.run, &r->e.error), HK_BAD_PARAM);
  if (!strstr(r->e.error.text, sentence)) fail_msg("'%s' in: %s", sentence, r->e.error.text);
  test_engine_close(&r->e);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.01);
  hold(&r, 0.1, -1);
  test_particle(&r.e, 0.5, 0, 0, 1);
  refused(&r, "high: -1 m is below low, 0 m, along z: the gas has no room");
  open_room(&r, 0.01);
  hold(&r, 0.1, 0);
  test_particle(&r.e, 0.5, 0, 0, 1);
  refused(&r, "a gas needs a plane or space");
  open_room(&r, 0.01);
  hold(&r, 1e-5, 1);
  test_particle(&r.e, 0.5, 0, 0, 1);
  refused(&r, "take larger cells or a smaller box, or allow more");
  open_room(&r, 0.01);
  hold(&r, 0.1, 1);
  test_particle(&r.e, 0.5, 0, 0.5, 1);
  test_pin(&r.e, HK_PIN_PLANE, 1, (double[]){0, 1, 0});
  refused(&r, "particle 1 slides on a pin, of which the grid knows nothing");
}

/* They would strike tracers that the gas has moved; and heat that spreads over a thousand cells in a step. */
static void what_a_step_cannot_do_is_refused(void **state) {
  (void)state;
  room r;
  open_room(&r, 0.1);
  hold(&r, 0.1, 1);
  test_plugin(&r.e, HK_CORRECTOR, "obstacle");
  test_particle(&r.e, 0.5, 0, 0.5, 1);
  test_run(&r.e);
  assert_int_equal(hk_run_advance(r.e.run, 0.1, &r.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(r.e.error.text, "put the corrector gas behind all obstacles"));
  test_engine_close(&r.e);
  open_room(&r, 0.1);
  hold(&r, 0.1, 1);
  test_number(&r.e, r.gas, "viscosity", 1000);
  test_particle(&r.e, 0.5, 0, 0.5, 1);
  test_run(&r.e);
  assert_int_equal(hk_run_advance(r.e.run, 0.1, &r.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(r.e.error.text, "spreads over too many cells: take a --dt of"));
  test_engine_close(&r.e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(air_that_is_warm_above_rests),
      cmocka_unit_test(wind_goes_round_a_cylinder),
      cmocka_unit_test(hot_gas_rises_and_takes_tracers_along),
      cmocka_unit_test(a_step_that_is_taken_back_leaves_no_trace),
      cmocka_unit_test(threads_do_not_change_bits),
      cmocka_unit_test(what_the_grid_cannot_show_is_said),
      cmocka_unit_test(narrow_gaps_are_said),
      cmocka_unit_test(the_step_is_foretold),
      cmocka_unit_test(what_cannot_be_is_refused),
      cmocka_unit_test(what_a_step_cannot_do_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
