/* scene:periodic{}: what it refuses, and that nothing acts wrongly in a periodic box without a word: plugins that know
 * of none are refused or named. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SCENE "local scene = hooke.scene { duration = 0.1, fps = 10 }\n"
#define BALLS SCENE "for k = 1, 3 do scene:particle { position = { k, 0, 0.1 * k }, mass = 1 } end\n"
#define BOX BALLS "scene:periodic { high = { 6, 7, 8 } }\n"
#define PAIRS "scene:force('lennard_jones', { sigma = 0.5 })\n"

static test_result r;

static void run(const char *lines, int code) {
  char scene[1024];
  snprintf(scene, sizeof scene, "%sreturn scene\n", lines);
  test_write("box.lua", scene);
  test_hooke(&r, NULL, "run box.lua --quiet --no-output --trust");
  if (r.code != code) fail_msg("exit %d: %s\n%s", r.code, r.err, scene);
}

typedef struct said {
  const char *scene, *text;
} said;

static void expect(const said *list, size_t count, int code) {
  for (size_t k = 0; k < count; k++) {
    run(list[k].scene, code);
    if (!strstr(r.err, list[k].text)) fail_msg("expected '%s' in: %s\n%s", list[k].text, r.err, list[k].scene);
  }
}

static void a_box_that_is_none_is_refused(void **state) {
  (void)state;
  static const said list[] = {
      {BALLS "scene:periodic {}\n", "box.lua:3: periodic: high is required"},
      {BALLS "scene:periodic { high = { 1, 0, 1 } }\n",
       "box.lua:3: periodic: along y the box goes from 0 to 0 m: high has to be above low"},
      {BALLS "scene:periodic { low = { 2, 0, 0 }, high = { 1, 1, 1 } }\n", "along x the box goes from 2 to 1 m"},
      {BALLS "scene:periodic { high = { 1, 1, 1 }, axes = 'xw' }\n", "axes: 'xw' is no list of axes: give x, y, z, xy"},
      {BALLS "scene:periodic { high = { 1, 1, 1 }, axes = 'xx' }\n", "axes: 'xx' is no list of axes"},
      {BALLS "scene:periodic { high = { 1, 1, 1 }, axes = '' }\n", "axes: the box repeats along none"},
      {BALLS "scene:periodic { high = { 1, 1, 1 }, axes = 3 }\n", "axes: expected a text such as \"xy\", got number"},
      {BALLS "scene:periodic { size = { 1, 1, 1 } }\n", "size"},
  };
  expect(list, sizeof list / sizeof *list, 1);
}

/* 2 radii are 2.5 m: a box of that length will do, along axes that repeat. */
static void one_that_is_too_short_is_refused_with_numbers(void **state) {
  (void)state;
  static const said short_ones[] = {
      {BALLS "scene:periodic { high = { 6, 2.4, 8 } }\n" PAIRS,
       "box.lua:4: lennard_jones: neighbours: the periodic box is 2.4 m long along y, less than twice the radius of "
       "1.25 m of which a plugin asks for "
       "neighbours, so that a particle would meet two images of another: make the box at least 2.5 m long, or the "
       "radius (cut-off) at most 1.2 m"},
      {BALLS "scene:periodic { high = { 6, 2, 8 }, axes = 'xy' }\nscene:force('soft_spheres', { radius = 0.6, "
             "stiffness = 1 })\n",
       "the periodic box is 2 m long along y, less than twice the radius of 1.2 m"},
  };
  expect(short_ones, sizeof short_ones / sizeof *short_ones, 1);
  run(BALLS "scene:periodic { high = { 4, 2.5, 2.5 } }\n" PAIRS, 0);
  run(BALLS "scene:periodic { high = { 6, 0, 3 }, axes = 'xz' }\n" PAIRS, 0);
}

/* The last one is built for minor 0, and asks for neighbours without their images. */
static void what_would_miss_images_is_refused(void **state) {
  (void)state;
  static const said list[] = {
      {BOX "scene:force('nbody', {})\n", "box.lua:4: nbody: gravity reaches all images of a periodic box"},
      {BOX "local g = scene:grid { nx = 3, ny = 3 }\nscene:corrector('contact', { thickness = 0.01 })\n",
       "contact of surfaces sees no images across the faces of a periodic box"},
      {BOX "local g = scene:grid { nx = 3, ny = 3 }\nscene:force('barrier', { thickness = 0.01, stiffness = 1 })\n",
       "contact of surfaces sees no images"},
      {BOX "scene:force('" HK_BUILD "/tests/fixtures/lennard_jones.so', {})\n",
       "a plugin asks for neighbours and knows no periodic box, so that it would miss what acts across the faces"},
  };
  expect(list, sizeof list / sizeof *list, 1);
}

static void what_knows_no_box_is_named(void **state) {
  (void)state;
  static const said list[] = {
      {BOX PAIRS "scene:force('central', { strength = 1 })\n",
       "box.lua:5: central knows no periodic box: it acts on particles where they are, which may be outside of the "
       "box"},
      {BOX PAIRS "scene:corrector('obstacle', { shape = 'plane' })\n", "box.lua:5: obstacle knows no periodic box"},
      {BOX "scene:force('gravity')\n", "the periodic box has no effect: no plugin of the scene acts across its faces"},
  };
  expect(list, sizeof list / sizeof *list, 0);
  run(BOX PAIRS "scene:force('gravity')\nscene:force('springs', { edges = { {1, 2} }, k = 1 })\n"
                "scene:constraint('bars', { edges = { {2, 3} } })\nscene:force('drag', { d = 1 })\n",
      0);
  if (*r.err) fail_msg("of what needs no images nothing is to be said: %s", r.err);
}

static void the_catalogue_knows_what_knows_a_box(void **state) {
  (void)state;
  test_hooke(&r, NULL, "plugins soft_spheres");
  assert_non_null(strstr(r.out, "right in a periodic box"));
  test_hooke(&r, NULL, "plugins central");
  assert_null(strstr(r.out, "periodic box"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_box_that_is_none_is_refused),
      cmocka_unit_test(one_that_is_too_short_is_refused_with_numbers),
      cmocka_unit_test(what_would_miss_images_is_refused),
      cmocka_unit_test(what_knows_no_box_is_named),
      cmocka_unit_test(the_catalogue_knows_what_knows_a_box),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
