/* Smoke in pictures, as scripts ask for it: it is drawn, a scene without gas is told so, and so is one whose pictures
 * have to wait for its end. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SCENE                                                                                                          \
  "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.05 }\n"                                                \
  "local p = scene:particle { position = { 0.5, 0.5, 0.5 }, mass = 1 }\nscene:pin({ p })\n"
#define GAS                                                                                                            \
  "scene:corrector('gas', { low = { 0, 0, 0 }, high = { 1, 1, 1 }, cell = 0.25, sources = { p },\n"                    \
  "  source_smoke = SMOKE })\n"
#define SMALL "width = 32, height = 32, video = false, color = 'none', particles = 'off', ground = false, "
#define CAMERA "from = { 0.5, -4, 0.5 }, look_at = { 0.5, 0.5, 0.5 } })\nreturn scene\n"

static void what_cannot_be_drawn_is_refused(void **state) {
  (void)state;
  test_refused(SCENE "scene:output('frames', { smoke = 8700, " SMALL CAMERA, "--quiet", 1,
               "smoke: the scene has no gas; add the corrector gas");
  test_refused(SCENE "local SMOKE = 1\n" GAS "scene:output('frames', { smoke = 8700, " SMALL "})\nreturn scene\n",
               "--quiet", 1, "smoke: its pictures are drawn as the run goes on: give from, look_at");
  test_refused(SCENE "local SMOKE = 1\n" GAS "scene:output('frames', { glow = 1, " SMALL CAMERA, "--quiet", 1,
               "glow: gas is drawn where smoke is given");
}

/* The bytes of the last picture. */
static size_t picture(const char *smoke, char *bytes, size_t room) {
  static test_result r;
  char scene[2048];
  snprintf(scene, sizeof scene, SCENE "local SMOKE = %s\n" GAS "scene:output('frames', { smoke = 8700, " SMALL CAMERA,
           smoke);
  test_write("smoke.lua", scene);
  test_hooke(&r, NULL, "run smoke.lua --quiet --out smoke");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  char path[1024];
  snprintf(path, sizeof path, "%s/smoke/frames/000001.png", test_folder());
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  size_t size = fread(bytes, 1, room, file);
  fclose(file);
  return size;
}

static void smoke_changes_the_picture(void **state) {
  (void)state;
  static char with[20000], without[20000];
  size_t a = picture("1e-2", with, sizeof with), b = picture("0", without, sizeof without);
  assert_true(a > 100 && b > 100);
  assert_true(a != b || memcmp(with, without, a) != 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_cannot_be_drawn_is_refused),
      cmocka_unit_test(smoke_changes_the_picture),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
