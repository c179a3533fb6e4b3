/* Pictures show the surface of a liquid in the stead of its particles, at each frame where they are: in runs of hooke.
 */
#include "tests/plugins/outputs/picture_world.h"

#include "tests/support/command.h"

/* A drop of radius 0.1 m that flies along x by 0.4 m in the run, one of another group above it, and a triangle of cloth
 * below; 100 pixels a metre. */
static const char scene[] =
    "local scene = hooke.scene { duration = 1, fps = 1, integrator = 'leapfrog', dt = 0.01 }\n"
    "scene:particle { position = { 0, 0, 0 }, velocity = { 0.4, 0, 0 }, mass = 1, group = 'water' }\n"
    "scene:particle { position = { -0.4, 0, 0.3 }, mass = 1, group = 'other' }\n"
    "scene:mesh { vertices = { { -0.5, 0, -0.4 }, { -0.3, 0, -0.4 }, { -0.4, 0, -0.2 } }, faces = { { 1, 2, 3 } }, "
    "mass = 1 }\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, ground = "
    "false, "
    "fov = 5.1530,\n  color = 'none', plain = { 1, 0, 0 }, %s })\nreturn scene\n";

static const char *const camera = "from = { 0, -10, 0 }, look_at = { 0, 0, 0 }";

static void write_scene(const char *options) {
  static char text[2048];
  snprintf(text, sizeof text, scene, options);
  test_write("liquid.lua", text);
}

/* How many red pixels there are, of pixels x from `from` to `to` and all y. */
static int count_red(const picture *p, int from, int to) {
  int red = 0;
  for (int y = 0; y < 90; y++)
    for (int x = from; x < to; x++) red += is_red(p, x, y);
  return red;
}

static void a_drop_is_a_disc_where_it_is(void **state) {
  (void)state;
  static test_result r;
  static const char *const of[] = {"surface = 0.1, surface_cell = 0.02",
                                   "surface = 0.1, surface_of = 'water', surface_smoothing = 25"};
  for (int k = 0; k < 2; k++) {
    char options[256];
    snprintf(options, sizeof options, "%s, %s", camera, of[k]);
    write_scene(options);
    test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
    if (r.code != 0) fail_msg("%s", r.err);
    for (int frame = 0; frame < 2; frame++) {
      char path[512];
      snprintf(path, sizeof path, "%s/out/liquid/frames/%06d.png", test_folder(), frame);
      picture p = read_picture(path);
      int middle = 80 + 40 * frame, disc = count_red(&p, middle - 15, middle + 15);
      assert_true(is_red(&p, middle, 45) && is_red(&p, middle + 8, 45) && !is_red(&p, middle + 12, 45));
      assert_true(disc > 270 && disc < 350);        /* pi 10^2 = 314; its border is mixed with the background */
      assert_int_equal(is_red(&p, 40, 15), k == 0); /* the other particle is liquid where no group is named */
      assert_true(is_red(&p, 40, 80 - 2));          /* cloth is drawn as ever */
      free(p.rgb);
    }
  }
}

/* One particle by anisotropic kernels is a ball of 1.36 radii (particle_options.h: k_n = 0.5), of 581 pixels. */
static void the_field_of_a_surface_is_chosen(void **state) {
  (void)state;
  static test_result r;
  char options[256], path[512];
  snprintf(options, sizeof options, "%s, surface = 0.1, surface_cell = 0.02, surface_field = 'anisotropic'", camera);
  write_scene(options);
  test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/liquid/frames/000000.png", test_folder());
  picture p = read_picture(path);
  int disc = count_red(&p, 60, 100);
  if (disc < 500 || disc > 640) fail_msg("%d pixels", disc);
  free(p.rgb);
  snprintf(options, sizeof options, "%s, surface = 0.1, surface_field = 'density'", camera);
  write_scene(options);
  test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
  if (r.code != 0) fail_msg("drops below the density's threshold are no error: %s", r.err);
  p = read_picture(path);
  assert_int_equal(count_red(&p, 60, 100), 0);
  free(p.rgb);
}

/* A drop half in a floor at 0 m is half a disc, of 157 pixels, above the middle of the picture. */
static void a_surface_is_cut_by_obstacles(void **state) {
  (void)state;
  static test_result r;
  static const char text[] =
      "local scene = hooke.scene { duration = 0, fps = 1, integrator = 'leapfrog', dt = 0.01 }\n"
      "scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
      "scene:corrector('obstacle', { shape = 'plane', normal = { 0, 0, 1 } })\n"
      "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, ground = "
      "false, "
      "fov = 5.1530, color = 'none', plain = { 1, 0, 0 }, obstacles = false, surface = 0.1, surface_cell = 0.02, "
      "surface_cut = true, from = { 0, -10, 0 }, look_at = { 0, 0, 0 } })\nreturn scene\n";
  char path[512];
  test_write("liquid.lua", text);
  test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/liquid/frames/000000.png", test_folder());
  picture p = read_picture(path);
  int disc = count_red(&p, 0, 160);
  if (!(disc > 125 && disc < 180)) fail_msg("%d pixels", disc);
  assert_true(is_red(&p, 80, 42) && !is_red(&p, 80, 48));
  free(p.rgb);
}

/* The least and largest x and y of the red pixels. */
static void find_bounds(const picture *p, int bounds[4]) {
  bounds[0] = bounds[2] = 999, bounds[1] = bounds[3] = -1;
  for (int y = 0; y < p->height; y++)
    for (int x = 0; x < p->width; x++)
      for (int k = 0; k < 2 && is_red(p, x, y); k++) {
        int at = k ? y : x;
        bounds[2 * k] = at < bounds[2 * k] ? at : bounds[2 * k];
        bounds[2 * k + 1] = at > bounds[2 * k + 1] ? at : bounds[2 * k + 1];
      }
}

/* Two drops, of which one moves: a camera for the whole motion has all of it, however the drops look, and the second
 * picture has their second places. The plane of the picture is not known, but the still one is the same on both. */
static void without_a_camera_the_whole_motion_is_in_the_picture(void **state) {
  (void)state;
  static test_result r;
  static const char *const look[] = {"opaque", "water"};
  for (int k = 0; k < 2; k++) {
    char options[256];
    int bounds[2][4];
    snprintf(options, sizeof options, "surface = 0.1, sheet = 2, surface_look = '%s'", look[k]);
    write_scene(options);
    test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
    if (r.code != 0) fail_msg("%s", r.err);
    for (int frame = 0; frame < 2; frame++) {
      char path[512];
      snprintf(path, sizeof path, "%s/out/liquid/frames/%06d.png", test_folder(), frame);
      picture p = read_picture(path);
      find_bounds(&p, bounds[frame]);
      free(p.rgb);
    }
    if (k == 1) continue; /* clear ones are not red; what is drawn of them is tested with water.c */
    assert_true(bounds[0][0] > 0 && bounds[1][1] < 159 && bounds[1][2] > 0 && bounds[1][3] < 89);
    assert_true(bounds[1][1] - bounds[0][1] > 20); /* the drop has flown to the right */
    assert_int_equal(bounds[0][0], bounds[1][0]);
  }
}

/* Nothing is coloured then: no bar of colours, and no range to be given. */
static void a_liquid_by_itself_has_the_plain_colour(void **state) {
  (void)state;
  static test_result r;
  static const char *const colour[] = {"auto", "none"};
  picture p[2];
  for (int k = 0; k < 2; k++) {
    char text[1024], path[512];
    snprintf(text, sizeof text,
             "local scene = hooke.scene { duration = 1, fps = 1, integrator = 'leapfrog', dt = 0.1 }\n"
             "scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }\n"
             "scene:output('frames', { width = 160, height = 90, video = false, surface = 0.1, color = '%s' })\n"
             "return scene\n",
             colour[k]);
    test_write("alone.lua", text);
    test_hooke(&r, NULL, "run alone.lua --quiet --trust");
    if (r.code != 0) fail_msg("%s", r.err);
    snprintf(path, sizeof path, "%s/out/alone/frames/000001.png", test_folder());
    p[k] = read_picture(path);
  }
  assert_memory_equal(p[0].rgb, p[1].rgb, 3 * 160 * 90);
  free(p[0].rgb), free(p[1].rgb);
}

static void refused(const char *options, const char *text) {
  static test_result r;
  write_scene(options);
  test_hooke(&r, NULL, "run liquid.lua --quiet --trust");
  if (r.code == 0 || !strstr(r.err, text)) fail_msg("exit %d: %s", r.code, r.err);
}

static void what_cannot_be_drawn_is_said(void **state) {
  (void)state;
  refused("from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, surface_look = 'water'",
          "surface: it is required beside surface_of, surface_look");
  refused("from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, surface_of = 'water'",
          "surface: it is required beside surface_of");
  refused("from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, surface_field = 'density'",
          "surface: it is required beside surface_of, surface_look, surface_field");
  refused("from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, surface = 0.1, surface_of = 'wine'",
          "surface_of: there is no group 'wine'");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_drop_is_a_disc_where_it_is),
                                     cmocka_unit_test(the_field_of_a_surface_is_chosen),
                                     cmocka_unit_test(a_surface_is_cut_by_obstacles),
                                     cmocka_unit_test(without_a_camera_the_whole_motion_is_in_the_picture),
                                     cmocka_unit_test(a_liquid_by_itself_has_the_plain_colour),
                                     cmocka_unit_test(what_cannot_be_drawn_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
