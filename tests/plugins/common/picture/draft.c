/* hooke run --draft: pictures of half the size, even in both directions. */
#include "tests/plugins/outputs/picture_world.h"
#include "tests/support/command.h"

static const char *const scene = "local scene = hooke.scene { duration = 0.02, fps = 50 }\n"
                                 "scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                                 "scene:output('frames', { width = 642, height = 362, video = false })\n"
                                 "return scene\n";

static void draft_pictures_are_half_as_wide_and_high(void **state) {
  (void)state;
  static test_result r;
  test_write("quick.lua", scene);
  test_hooke(&r, NULL, "run quick.lua --quiet --out whole");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run quick.lua --quiet --draft --out draft");
  assert_int_equal(r.code, 0);
  char path[600];
  static const int size[2][2] = {{642, 362}, {322, 182}};
  for (int k = 0; k < 2; k++) {
    snprintf(path, sizeof path, "%s/%s/frames/000001.png", test_folder(), k ? "draft" : "whole");
    picture p = read_picture(path);
    assert_int_equal(p.width, size[k][0]);
    assert_int_equal(p.height, size[k][1]);
    free(p.rgb);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(draft_pictures_are_half_as_wide_and_high)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
