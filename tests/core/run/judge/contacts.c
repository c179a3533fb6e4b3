/* What core/run/judge/contacts.c promises: a run whose surfaces intersect at a frame is inaccurate and says where and
 * when; a start that intersects is refused, or, where a plugin removes that, told apart. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* Frames 0 to 4 with these counts. */
static void run(const char *counts, bool repairs, const char *options) {
  char text[1024], arguments[256];
  snprintf(text, sizeof text,
           "local s = hooke.scene { duration = 0.4, fps = 10, dt = 0.01, integrator = 'leapfrog' }\n"
           "s:particle { mass = 1 }\ns:force('gravity')\n"
           "s:corrector('%s/tests/fixtures/crossings.so', { repairs = %s, counts = { %s } })\nreturn s\n",
           HK_BUILD, repairs ? "true" : "false", counts);
  test_write("scene.lua", text);
  snprintf(arguments, sizeof arguments, "run scene.lua --trust %s", options);
  test_hooke(&r, NULL, arguments);
}

static void assert_says(int code, const char *text) {
  if (r.code != code || !(strstr(r.out, text) || strstr(r.err, text)))
    fail_msg("exit %d instead of %d, or no \"%s\": %s%s", r.code, code, text, r.out, r.err);
}

static void no_intersection_is_ok_and_said(void **state) {
  (void)state;
  run("0", false, "--json");
  assert_int_equal(r.code, 0);
  assert_true(test_json(r.out, "intersections") == 0);
  assert_true(test_json(r.out, "closest") == 0.2);
  assert_true(test_json(r.out, "impulse") == 10);
  run("0", false, "");
  assert_says(0, "0 intersections at 5 frames, least gap 0.2 m, impulses 10 N s, energy taken 15 J");
  assert_says(0, "no surfaces intersect at any frame, the nearest at a gap of 0.2 m");
}

static void an_intersection_makes_a_run_inaccurate(void **state) {
  (void)state;
  run("0, 0, 3, 4, 0", false, "");
  assert_says(5, "surfaces intersected at 2 of 5 frames, 7 times, first at t = 0.2 s: triangle 1 2 3 and edge 4 5");
}

static void a_start_that_intersects_is_refused(void **state) {
  (void)state;
  run("12, 0", false, "");
  assert_says(1, "surfaces intersect at the start, 12 pairs of an edge and a triangle, the first triangle 1 2 3 and "
                 "edge 4 5: start them apart; or name a corrector that removes intersections");
}

static void a_start_that_is_repaired_is_not(void **state) {
  (void)state;
  run("12, 5, 5, 1, 0", true, "");
  assert_says(0, "0 intersections at 5 frames (12 at the start)");
  run("12, 5, 5, 1, 1", true, "");
  assert_says(5, "1 of the 12 intersections of the start are left");
  run("12, 5, 6, 0", true, "");
  assert_says(5, "surfaces intersected at 1 of 5 frames, 6 times, first at t = 0.2 s");
  run("12, 0, 0, 1, 0", true, "");
  assert_says(5, "surfaces intersected at 1 of 5 frames, 1 times, first at t = 0.3 s");
}

/* The particle has 0.5 g^2 t^2 = 7.7 J at the end: 5 J from nothing are 0.65 of that. What was taken before does not
 * pay for it, nor does a reference of another method, which has the same contact. */
static void contact_that_gives_energy_is_not_ok(void **state) {
  (void)state;
  run("0 }, energies = { 0, 9, 9, 4, 4", false, "");
  assert_says(5,
              "contact gave 5 J, 0.649 of the largest kinetic energy, while no surface was driven: try a smaller dt");
  run("0 }, energies = { 0, 9, 9, 4, 4", false, "--accuracy 1e-3");
  assert_says(5, "contact gave 5 J");
  run("0 }, energies = { 0, 9, 9, 8.5, 9", false, "");
  assert_int_equal(r.code, 0);
}

/* A particle on a path drives what it touches. */
static void driven_contact_gives_what_its_obstacle_does(void **state) {
  (void)state;
  run("0 }, energies = { 0, 9, 9, 4, 4 } }) s:pin({ s:particle { mass = 1 } }, { path = function(t) return t, 0, 0 end",
      false, "");
  assert_null(strstr(r.out, "contact gave"));
}

static void scenes_without_surfaces_say_nothing(void **state) {
  (void)state;
  test_write("scene.lua", "local s = hooke.scene { duration = 0.1 }\ns:particle { mass = 1 }\nreturn s\n");
  test_hooke(&r, NULL, "run scene.lua --json");
  assert_true(isnan(test_json(r.out, "intersections")));
  test_hooke(&r, NULL, "run scene.lua");
  assert_null(strstr(r.out, "intersections"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_intersection_is_ok_and_said),
      cmocka_unit_test(an_intersection_makes_a_run_inaccurate),
      cmocka_unit_test(a_start_that_intersects_is_refused),
      cmocka_unit_test(a_start_that_is_repaired_is_not),
      cmocka_unit_test(contact_that_gives_energy_is_not_ok),
      cmocka_unit_test(driven_contact_gives_what_its_obstacle_does),
      cmocka_unit_test(scenes_without_surfaces_say_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
