/* Liquid that comes through a wall: in a plane tank, from the side of an obstacle, and what is wrong with an inflow. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void run(const char *name, const char *sources) {
  char text[2048], words[256];
  snprintf(text, sizeof text,
           "local scene = hooke.scene { duration = 0.5, fps = 20, integrator = 'symplectic_euler' }\n"
           "scene:channel('temperature', { initial = 293 })\n"
           "scene:force('gravity', { g = { 0, 0, -9.81 } })\n%s\nreturn scene\n",
           sources);
  snprintf(words, sizeof words, "run %s --json --no-output --no-check", test_write(name, text));
  test_hooke(&r, NULL, words);
}

static const char tank[] = "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 0.5 }, cell = 0.05 })\n";

/* In 0.5 s places half a cell wide have borne 16 particles each: 0.8 m/s is 0.4 m, of 0.025 m. The faces it covers in
 * part, from 0.06 to 0.14 m with cells of 0.05 m, take their part of the speed. */
static void what_came_in_is_area_by_speed_by_time(void **state) {
  (void)state;
  char text[1024];
  snprintf(text, sizeof text,
           "scene:source('inflow', { low = { 0, 0, 0.06 }, high = { 0, 0, 0.16 }, speed = 0.8, cell = 0.05,\n"
           "  channel = 'temperature', amount = 350 })\n%s"
           "scene:measure('coldest', function(s)\n"
           "  local least = 1e9\n"
           "  for _, id in ipairs(s:ids()) do least = math.min(least, s:channel('temperature', id)) end\n"
           "  return least\n"
           "end)\n",
           tank);
  run("comes.lua", text);
  assert_int_equal(r.code, 0);
  double wanted = 1000 * 0.8 * 0.5 * 0.1 * 0.05;
  assert_true(fabs(test_json(r.out, "mass_in") - wanted) < 1e-12 * wanted);
  assert_true(test_json(r.out, "coldest") == 350);
}

/* From a box that fits the grid to the left, against the axis, until half the time is over. */
static void an_obstacle_lets_it_in(void **state) {
  (void)state;
  char text[1024];
  snprintf(text, sizeof text,
           "scene:corrector('obstacle', { shape = 'box', size = { 0.4, 1, 0.2 }, position = { 1, 0, 0.1 } })\n"
           "scene:source('inflow', { low = { 0.8, 0, 0.05 }, high = { 0.8, 0, 0.15 }, direction = { -2, 0, 0 },\n"
           "  speed = 0.8, cell = 0.05, to = 0.25 })\n%s",
           tank);
  run("obstacle.lua", text);
  assert_int_equal(r.code, 0);
  double wanted = 1000 * 0.8 * 0.25 * 0.1 * 0.05;
  assert_true(fabs(test_json(r.out, "mass_in") - wanted) < 1e-12 * wanted);
  assert_true(test_json(r.out, "leaked") == 0);
}

static const struct {
  const char *params, *said;
} wrong[] = {
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, direction = { 1, 0.2, 0 }", "is not along an axis"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, direction = { 0, 0, 0 }", "is not along an axis"},
    {"low = { 0, 0, 0 }, high = { 0.1, 0, 0.2 }", "give the place of the wall in both"},
    {"low = { 0, 0, 0.3 }, high = { 0, 0, 0.2 }", "give the upper corner"},
    {"low = { 0, 0, 0.2 }, high = { 0, 0, 0.2 }", "are one point, and nothing comes through it"},
    {"low = { 0, 0, 0.2 }, high = { 0, 0, 0.205 }", "take smaller cells, or a wider one"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, speed = 0", "speed: 0 m/s is not above 0: give more"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, from = 1, to = 0.5", "to: 0.5 s is not after from: 1 s"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, channel = 'salt'", "the scene has no channel 'salt'"},
    {"low = { 0.012, 0, 0 }, high = { 0.012, 0, 0.2 }", "is on no face of the grid"},
    {"low = { 0.5, 0, 0 }, high = { 0.5, 0, 0.2 }", "is not on a wall everywhere"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.7 }", "give it a width, within the box"},
    {"low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, density = 900", "give both the same"},
};

static void what_is_wrong_is_said(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1024];
    bool speed = strstr(wrong[k].params, "speed");
    snprintf(text, sizeof text, "scene:source('inflow', { %s%s, cell = 0.05 })\n%s", wrong[k].params,
             speed ? "" : ", speed = 1", tank);
    run("wrong.lua", text);
    if (r.code != 1 || !(strstr(r.err, wrong[k].said) || strstr(r.out, wrong[k].said)))
      fail_msg("%s: exit code %d, %s%s", wrong[k].params, r.code, r.err, r.out);
  }
  run("without.lua", "scene:source('inflow', { low = { 0, 0, 0 }, high = { 0, 0, 0.2 }, speed = 1, cell = 0.05 })");
  assert_int_equal(r.code, 0);
  assert_non_null(strstr(r.out, "there is no corrector liquid in whose wall it could be"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_came_in_is_area_by_speed_by_time),
                                     cmocka_unit_test(an_obstacle_lets_it_in), cmocka_unit_test(what_is_wrong_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
