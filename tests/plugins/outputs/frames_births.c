/* Ages of particles that a source bears and lets die, in runs of hooke. Every particle rises at 1 m/s from its birth
 * on, and the channel `clock` counts its time. */
#include "tests/plugins/outputs/picture_world.h"

#include "tests/support/command.h"

static const char scene[] =
    "local color, part = param('color', 'age', ''), param('part', 'whole', '')\n"
    "local scene = hooke.scene { duration = 1, fps = 20, integrator = 'leapfrog', dt = 0.005 }\n"
    "scene:channel('clock', { rate = function() return 1 end })\n"
    "scene:particle { position = { 0.3, 0, 0 }, mass = 1 }\n"
    "scene:source('" HK_BUILD "/tests/fixtures/spout.so', { every = 0.04, lifetime = 0.3 })\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, color = color, map = 'grey',\n"
    "  range = { 0, 1 }, radius = 0.06, from = { 0, -3, 0.5 }, look_at = { 0, 0, 0.5 }, ground = false })\n"
    "if part == 'whole' then return scene end\n"
    "if part == 'second' then scene:start { file = 'half.checkpoint' } end\n"
    "local run = scene:run { to = part == 'first' and 0.5 or 1 }\n"
    "if part == 'first' then run:save('half.checkpoint') end\n";

static test_result r;

/* The picture with the highest number. */
static picture last_picture(const char *arguments) {
  char command[256], name[64], path[512];
  snprintf(command, sizeof command, "run births.lua --trust %s", arguments);
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s: %s", command, r.err);
  int count = 0;
  do snprintf(name, sizeof name, "out/births/frames/%06d.png", count++);
  while (test_exists(name));
  snprintf(path, sizeof path, "%s/out/births/frames/%06d.png", test_folder(), count - 2);
  return read_picture(path);
}

static void frames_know_ages_to_half_a_frame(void **state) {
  (void)state;
  test_write("births.lua", scene);
  picture seen = last_picture("color=age"), known = last_picture("color=clock");
  int bright = 0;
  for (int k = 0; k < 3 * 160 * 90; k++) {
    /* Half a frame is 1/40 of the range, 6.4 bytes of grey; the light and its rounding make 8 of them at most. */
    assert_in_range(abs(seen.rgb[k] - known.rgb[k]), 0, 8);
    bright += known.rgb[k] > 200;
  }
  assert_true(bright > 30);
  free(seen.rgb), free(known.rgb);
}

/* Whether a checkpoint has the fields of outputs is the host's affair: what is not known must be told. */
static void frames_know_ages_after_a_checkpoint_or_say_not(void **state) {
  (void)state;
  test_write("births.lua", scene);
  picture whole = last_picture("");
  assert_null(strstr(r.err, "nobody noted"));
  free(last_picture("part=first").rgb);
  picture second = last_picture("part=second");
  bool told = strstr(r.err, "age: 13 particles were born before t = 0.5 s, nobody noted when") != NULL;
  if (!told) assert_memory_equal(whole.rgb, second.rgb, 3 * 160 * 90);
  free(whole.rgb), free(second.rgb);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_know_ages_to_half_a_frame),
      cmocka_unit_test(frames_know_ages_after_a_checkpoint_or_say_not),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
