/* Drains: all that is in the box goes, or so much as the rate allows, for any step; what is joined or outside stays; a
 * tank with an emitter and a drain has the level of the closed form. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e, double dt) {
  test_engine_open(e);
  e->options.dt = dt;
  e->scene->duration = 3;
  hk_plugin_spec *drain = test_plugin(e, HK_SOURCE, "drain");
  test_vector(e, drain, "low", 0, 0, 0);
  test_vector(e, drain, "high", 1, 1, 1);
  return drain;
}

static size_t left(test_engine *e, double t) {
  test_advance(e, t);
  return hk_run_view(e->run)->n;
}

/* Twelve of 2 kg at rest in the box, one outside and two of an edge; the drain opens at 0.5 s and takes 4 kg/s. */
static void the_rate_is_kept_for_any_step(void **state) {
  (void)state;
  static const double dts[] = {0.1, 0.03, 0.7};
  for (int d = 0; d < 3; d++) {
    test_engine e;
    hk_plugin_spec *drain = open_scene(&e, dts[d]);
    test_number(&e, drain, "rate", 4);
    test_number(&e, drain, "from", 0.5);
    test_number(&e, drain, "to", 2.8);
    for (int k = 0; k < 12; k++) test_particle(&e, 0.05 + 0.07 * k, 0.5, 0.5, 2);
    test_particle(&e, 1.5, 0.5, 0.5, 2);
    uint32_t a = test_particle(&e, 0.5, 0.2, 0.5, 2), b = test_particle(&e, 0.5, 0.8, 0.5, 2);
    const uint32_t edge[1][2] = {{a, b}};
    assert_int_equal(hk_scene_add_edges(e.scene, 1, edge, &e.error), HK_OK);
    test_run(&e);
    assert_int_equal(left(&e, 0.5), 15);
    assert_int_equal(left(&e, 1.4), 13); /* 3.6 kg: nearer to 4 than to 2 */
    assert_int_equal(left(&e, 2.1), 12); /* 6.4 kg */
    assert_int_equal(left(&e, 3), 10);   /* 9.2 kg */
    test_engine_close(&e);
  }
}

/* What the box has not held is not made up for: a particle that comes after 2 s goes when the rate allows it. */
static void an_empty_box_saves_nothing_up(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *drain = open_scene(&e, 0.01);
  test_number(&e, drain, "rate", 4);
  for (int k = 0; k < 4; k++) {
    uint32_t id = test_particle(&e, -2 - 0.001 * k, 0.5, 0.5, 2);
    e.scene->particles.velocity[3 * (id - 1)] = 1;
  }
  test_run(&e);
  assert_int_equal(left(&e, 1.99), 4);
  assert_int_equal(left(&e, 2.2), 4); /* 0.8 kg */
  assert_int_equal(left(&e, 2.4), 3); /* 1.6 kg */
  assert_int_equal(left(&e, 2.9), 2); /* 3.6 kg */
  test_engine_close(&e);
}

static void without_a_rate_all_goes(void **state) {
  (void)state;
  test_engine e;
  open_scene(&e, 0.1);
  for (int k = 0; k < 12; k++) test_particle(&e, 0.05 + 0.1 * k, 0.5, 0.5, 2);
  test_run(&e);
  assert_int_equal(left(&e, 0.1), 2); /* at x = 1.05 and 1.15 */
  test_engine_close(&e);
}

static void a_box_without_room_is_refused(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *drain = open_scene(&e, 0.1);
  test_vector(&e, drain, "high", 1, -1, 1);
  test_particle(&e, 0, 0, 0, 1);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "give its upper corner"));
  test_engine_close(&e);
}

/* A tank of 1 m x 0.3 m of water in a plane, which an emitter in it fills by 0.1 m/s and a drain empties by `fall`:
 * 0.3 m + (0.1 m/s - fall) t, as twice the height of the centre of mass, in the mean of the last second. */
static const char tank[] =
    "local filling, fall = require('filling'), param('fall', 0.05, 'm/s', {})\n"
    "local cell = 0.0625\n"
    "local scene = hooke.scene { duration = 2, fps = 50, dt = 0.01, integrator = 'symplectic_euler' }\n"
    "local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, 0.3 }, cell = cell }\n"
    "scene:particles { positions = water.positions, mass = water.mass, group = 'water' }\n"
    "local flow = 1000 * cell\n" /* kg/s, for 1 m/s */
    "scene:source('emitter', { rate = 0.1 * flow / water.mass, mass = water.mass, shape = 'line', speed = 0.5,\n"
    "  position = { 0.1, 0, 0.15 }, ['end'] = { 0.4, 0, 0.15 }, direction = { 0, 0, -1 }, group = 'water' })\n"
    "scene:source('drain', { low = { 0.6, -1, 0 }, high = { 1, 1, 0.1 }, rate = fall * flow })\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = cell })\n"
    "scene:measure('volume', function(s) return s.n * water.mass / flow end)\n"
    "local sum, count = 0, 0\n"
    "scene:measure('off', function(s)\n"
    "  local z = 0\n"
    "  if s.t <= 1 then return 0 end\n"
    "  for _, id in ipairs(s:ids()) do z = z + s:position(id)[3] end\n"
    "  sum, count = sum + 2 * z / s.n - 0.3 - (0.1 - fall) * s.t, count + 1\n"
    "  return sum / count end)\n"
    "return scene\n";

static void a_tank_has_the_level_of_its_balance(void **state) {
  (void)state;
  static const double falls[] = {0, 0.05, 0.1};
  for (int k = 0; k < 3; k++) {
    test_result r;
    char words[256];
    double wanted = 0.3 + 2 * (0.1 - falls[k]);
    snprintf(words, sizeof words, "run %s --json --no-output --no-check fall=%g", test_write("tank.lua", tank),
             falls[k]);
    test_hooke(&r, NULL, words);
    assert_int_equal(r.code, 0);
    double volume = test_json(r.out, "volume"), off = test_json(r.out, "off");
    assert_true(fabs(volume - wanted) < 1.1e-3); /* a particle has 1e-3 m */
    if (!(fabs(off) < 0.02 * wanted)) fail_msg("%.4f m off %.4f m", off, wanted);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_rate_is_kept_for_any_step),
      cmocka_unit_test(an_empty_box_saves_nothing_up),
      cmocka_unit_test(without_a_rate_all_goes),
      cmocka_unit_test(a_box_without_room_is_refused),
      cmocka_unit_test(a_tank_has_the_level_of_its_balance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
