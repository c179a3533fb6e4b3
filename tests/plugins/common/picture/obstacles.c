/* Pictures show what particles meet, wherever its contact is: in runs of hooke. */
#include "tests/plugins/outputs/picture_world.h"

#include "tests/support/command.h"

/* A box of 0.2 m that moves along x by 0.4 m in the run, seen with 100 pixels a metre; the particle is above it, or far
 * out of sight. */
static const char scene[] =
    "local kind, z = param('kind', 'none', ''), param('z', 0.35, '')\n"
    "local scene = hooke.scene { duration = 1, fps = 1, integrator = 'leapfrog', dt = 0.01 }\n"
    "scene:particle { position = { 0, 0, z }, mass = 1 }\n"
    "local box = { shape = 'box', size = { 0.2, 0.2, 0.2 }, position = function(t) return 0.4 * t, 0, 0 end }\n"
    "if kind == 'obstacle' then scene:corrector('obstacle', box) end\n"
    "if kind == 'penalty' then scene:force('penalty', box) end\n"
    "if kind == 'wall' then scene:force('soft_walls', { stiffness = 1, planes = { 0.6, -0.8, 0, -1 }, radius = 0.1 }) "
    "end\n"
    "if kind == 'funnel' then scene:force('soft_walls', { stiffness = 1, funnel = { 0, 0, 0, 0.05, 1 }, radius = 0.01 "
    "}) "
    "end\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, from = { 0, "
    "-10, 0 },\n"
    "  look_at = { 0, 0, 0 }, fov = 5.1530, ground = false })\n"
    "return scene\n";

static test_result r;

static void run(const char *kind, double z) {
  char command[128];
  test_write("obstacles.lua", scene);
  snprintf(command, sizeof command, "run obstacles.lua --quiet kind=%s z=%g", kind, z);
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s: %s", command, r.err);
}

static picture picture_of(int frame) {
  char path[512];
  snprintf(path, sizeof path, "%s/out/obstacles/frames/%06d.png", test_folder(), frame);
  return read_picture(path);
}

/* Solids are brownish, the background is bluish. */
static bool is_solid(const picture *p, int x, int y) { return at(p, x, y)[0] > at(p, x, y)[2]; }

static void pictures_show_obstacles_of_correctors_and_forces_where_they_are(void **state) {
  (void)state;
  static const char *const kinds[] = {"none", "obstacle", "penalty"};
  for (int k = 0; k < 6; k++) {
    run(kinds[k % 3], k < 3 ? 0.35 : 90);
    for (int frame = 0; frame < 2; frame++) {
      picture p = picture_of(frame);
      int middle = 80 + 40 * frame;
      for (int x = 5; x < 160; x += 5) {
        if (abs(abs(x - middle) - 10) <= 1) continue; /* its edge */
        assert_int_equal(is_solid(&p, x, 45), k % 3 > 0 && abs(x - middle) < 10);
      }
      free(p.rgb);
    }
  }
}

/* A plane is seen from the side of its normal, with a colour that is not the background's. */
static void pictures_show_the_planes_of_soft_walls(void **state) {
  (void)state;
  run("none", 0.35);
  picture without = picture_of(0);
  run("wall", 0.35);
  picture with = picture_of(0);
  int other = 0;
  for (int k = 0; k < 160 * 90; k++) other += abs(with.rgb[3 * k] - without.rgb[3 * k]) > 8;
  assert_true(other > 160 * 90 / 4);
  free(without.rgb), free(with.rgb);
}

/* A cone from the neck, 0.1 m wide at z = 0, to the particle: at z = 0.2 its inside is 0.5 m wide; there is nothing
 * below the neck, where no particle is. */
static void pictures_show_the_funnel_of_soft_walls(void **state) {
  (void)state;
  run("funnel", 0.35);
  picture p = picture_of(0);
  for (int x = 5; x < 160; x += 5) {
    if (abs(abs(x - 80) - 25) > 1) assert_int_equal(is_solid(&p, x, 25), abs(x - 80) < 25);
    assert_false(is_solid(&p, x, 60));
  }
  free(p.rgb);
}

/* Three boxes, before a cloth (or a particle), behind it and beside it: the first alone lets it be seen. */
static void pictures_see_the_motion_through_what_hides_most_of_it(void **state) {
  (void)state;
  static const double boxes[] = {0, -2, 0, 1, 0.1, 0.7, 0, 3, 0, 1.4, 0.1, 0.8, 0.7, 0, 0, 0.1, 0.1, 0.8};
  int red[4];
  unsigned char before[4][3], beside[4][3];
  for (int k = 0; k < 4; k++) { /* cloth, then particles; seen through, then not */
    world w;
    world_open(&w, MOST);
    make_cloth(&w, 0, 0);
    for (size_t i = 0; i < MOST; i++) w.x[3 * i + 2] = 0.6 * w.x[3 * i + 1], w.x[3 * i + 1] = 0; /* upright */
    if (k > 1) w.model.triangles.count = 0, set_number(&w, "radius", 0.03);
    set_still_camera(&w);
    set_switch(&w, "shadows", false);
    set_switch(&w, "see_through", k % 2 == 0);
    *(hk_numbers *)fake_field(&w.f, "boxes") = (hk_numbers){sizeof boxes / sizeof *boxes, boxes};
    picture p = draw_once(&w);
    red[k] = find_red(&w, 0).count;
    memcpy(before[k], at(&p, 30, 45), 3), memcpy(beside[k], at(&p, 149, 45), 3);
    free(p.rgb);
    fake_close(&w.f);
  }
  assert_true(red[0] > 4000); /* 100 x 60 pixels, less the edge */
  assert_true(red[2] > 1000);
  assert_int_equal(red[1] + red[3], 0);
  for (int c = 0; c < 3; c++) assert_int_equal(beside[0][c], beside[1][c]);
  assert_memory_not_equal(before[0], before[1], 3);
}

/* A box and a plane: the box goes over into what is behind it, the plane stays. */
static void the_opacity_of_obstacles_is_what_the_scene_says(void **state) {
  (void)state;
  static const double box[] = {0, 0, 0, 0.4, 0.4, 0.4}, opacities[] = {1, 0.25, 0};
  unsigned char colour[4][3];
  for (int k = 0; k < 4; k++) { /* the last has no box */
    world w;
    world_open(&w, 1);
    w.x[0] = 5; /* out of sight */
    set_still_camera(&w);
    set_switch(&w, "shadows", false);
    if (k < 3) set_number(&w, "obstacle_opacity", opacities[k]);
    if (k < 3) *(hk_numbers *)fake_field(&w.f, "boxes") = (hk_numbers){sizeof box / sizeof *box, box};
    picture p = draw_once(&w);
    memcpy(colour[k], at(&p, 80, 45), 3);
    free(p.rgb);
    fake_close(&w.f);
  }
  assert_memory_equal(colour[2], colour[3], 3);
  for (int c = 0; c < 3; c++) { /* an eighth: light is added after colours are mixed */
    assert_true(abs(colour[0][c] - colour[3][c]) > 20);
    assert_true(abs(4 * colour[1][c] - 3 * colour[3][c] - colour[0][c]) < 32);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_show_obstacles_of_correctors_and_forces_where_they_are),
      cmocka_unit_test(pictures_show_the_planes_of_soft_walls),
      cmocka_unit_test(pictures_show_the_funnel_of_soft_walls),
      cmocka_unit_test(pictures_see_the_motion_through_what_hides_most_of_it),
      cmocka_unit_test(the_opacity_of_obstacles_is_what_the_scene_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
