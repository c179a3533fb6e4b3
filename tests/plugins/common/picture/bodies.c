/* Pictures of rigid bodies, in runs of hooke: flat sides that end at edges, and no bar of colours where bodies, which
 * have a colour of their own, are all that is seen. */
#include "tests/plugins/outputs/picture_world.h"

#include "tests/support/command.h"

/* A cube of 0.2 m turned by 45 degrees about the vertical, seen with 100 pixels a metre; as what contact meets, or as a
 * body alone, perhaps with a particle beside it. */
static const char scene[] =
    "local surface, beside, legend = param('surface', 0, ''), param('beside', 0, ''), param('legend', 0, '')\n"
    "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog', dt = 0.01 }\n"
    "local box = scene:rigid { shape = 'box', size = 0.2, mass = 1, orientation = { 0, 0, math.pi / 4 } }\n"
    "if surface > 0 then box:surface() end\n"
    "if beside > 0 then scene:particle { position = { 0.5, 0, 0 }, mass = 1, velocity = { 0, 0, 1 } } end\n"
    "scene:output('frames', { width = 480, height = 270, video = false, legend = legend > 0, shadows = false,\n"
    "  from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, fov = 15.378, ground = false, background = { 0.5, 0.5, 0.5 } })\n"
    "return scene\n";

static test_result r;

static picture picture_of(bool surface, bool beside, bool legend) {
  char command[128], path[512];
  test_write("bodies.lua", scene);
  snprintf(command, sizeof command, "run bodies.lua --quiet --no-check surface=%d beside=%d legend=%d", surface, beside,
           legend);
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s: %s", command, r.err);
  snprintf(path, sizeof path, "%s/out/bodies/frames/000000.png", test_folder());
  return read_picture(path);
}

enum { MIDDLE = 240, ROW = 135, CORNER = 14 }; /* pixels; from the middle to the corners at the sides */

/* The side's colour to a step of its 256, from edge to edge. */
static void assert_flat(const picture *p, int begin, int end) {
  for (int x = begin; x <= end; x++)
    for (int y = ROW - 7; y <= ROW + 7; y++)
      for (int c = 0; c < 3; c++) assert_true(abs(at(p, x, y)[c] - at(p, begin, ROW)[c]) <= 1);
}

static void sides_of_bodies_are_flat_up_to_their_edges(void **state) {
  (void)state;
  for (int surface = 0; surface < 2; surface++) {
    picture p = picture_of(surface, false, false);
    assert_flat(&p, MIDDLE - CORNER + 3, MIDDLE - 3);
    assert_flat(&p, MIDDLE + 3, MIDDLE + CORNER - 3);
    assert_true(abs(at(&p, MIDDLE - 3, ROW)[0] - at(&p, MIDDLE + 3, ROW)[0]) > 8);
    free(p.rgb);
  }
}

/* Pixels that two pictures differ in, among those of the lower left, where the bar stands. */
static int changed(const picture *p, const picture *q) {
  int count = 0;
  for (int y = 200; y < 270; y++)
    for (int x = 0; x < 200; x++) count += memcmp(at(p, x, y), at(q, x, y), 3) != 0;
  return count;
}

static void the_legend_is_drawn_where_something_has_its_colours(void **state) {
  (void)state;
  for (int beside = 0; beside < 2; beside++) {
    picture with = picture_of(false, beside, true), without = picture_of(false, beside, false);
    assert_int_equal(changed(&with, &without) > 0, beside);
    free(with.rgb);
    free(without.rgb);
  }
}

/* Groups are numbered from 1 on, as 0 is what has none: orange and green of the table of groups. */
static void bodies_have_the_colours_of_their_groups(void **state) {
  (void)state;
  static const char *const two =
      "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog', dt = 0.01 }\n"
      "scene:rigid { shape = 'box', size = 0.2, mass = 1, position = { -0.3, 0, 0 }, group = 'first' }\n"
      "scene:rigid { shape = 'box', size = 0.2, mass = 1, position = { 0.3, 0, 0 }, group = 'second' }\n"
      "scene:output('frames', { width = 480, height = 270, video = false, color = 'group', shadows = false,\n"
      "  from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, fov = 15.378, ground = false, background = { 0.5, 0.5, 0.5 } })\n"
      "return scene\n";
  char path[512];
  test_write("groups.lua", two);
  test_hooke(&r, NULL, "run groups.lua --quiet --no-check");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/groups/frames/000000.png", test_folder());
  picture p = read_picture(path);
  int first = MIDDLE - 30, second = MIDDLE + 30;
  const unsigned char *orange = at(&p, first, ROW), *green = at(&p, second, ROW);
  assert_true(orange[0] > orange[1] + 30 && orange[1] > orange[2] + 30);
  assert_true(green[1] > green[2] + 15 && green[2] > green[0] + 30);
  free(p.rgb);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sides_of_bodies_are_flat_up_to_their_edges),
      cmocka_unit_test(the_legend_is_drawn_where_something_has_its_colours),
      cmocka_unit_test(bodies_have_the_colours_of_their_groups),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
