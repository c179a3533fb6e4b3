/* Strands are as thick as they are: by a channel of radii, or by what contact says of them. Of tetrahedra one sees the
 * edges or, where the scene has their surface, that. */
#include "tests/plugins/outputs/picture_world.h"

#include "tests/support/command.h"

/* Pixels of red above each other at x. */
static int thickness_at(const picture *p, int x, int top, int bottom) {
  int count = 0;
  for (int y = top; y < bottom; y++) count += is_red(p, x, y);
  return count;
}

/* Two springs along x, 100 pixels a metre: one of 0.03 m above one that grows from 0.01 to 0.05 m; a third has no
 * radius of its own. */
static void frames_draw_each_strand_with_its_radius(void **state) {
  (void)state;
  static const uint32_t pair[3][2] = {{0, 1}, {2, 3}, {4, 5}};
  hk_channel channels[] = {{"paint", 3, 0}, {"thick", 1, 3}};
  double y[] = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0.03, 0.03, 0.01, 0.05, 0, 0};
  world w;
  world_open(&w, 6);
  set_still_camera(&w);
  for (int i = 0; i < 6; i++) w.x[3 * i] = i % 2 ? 0.5 : -0.5, w.x[3 * i + 2] = 0.25 * (1 - i / 2);
  hk_element_list list = {.force = "springs", .elements = {.node = {3, 2, &pair[0][0]}, .values = 1}};
  w.model.element_list = &list, w.model.element_lists = 1;
  w.model.channel = channels, w.model.channels = 2, w.view.y = y;
  set_text(&w, "tubes", "thick");
  set_switch(&w, "shadows", false);
  picture p = draw_once(&w);
  assert_in_range(thickness_at(&p, 80, 5, 32), 5, 7);  /* 6 */
  assert_in_range(thickness_at(&p, 80, 35, 55), 5, 7); /* 6 in the middle, and all along: a tube has one radius */
  int chosen = thickness_at(&p, 80, 58, 85);
  assert_in_range(chosen, 1, 2); /* a pixel and a half: what there is to choose is smaller */
  free(p.rgb);
  fake_close(&w.f);
}

/* The same by groups: a rope of 0.06 m and a thread of 0.02 m across. */
static void frames_draw_strands_with_the_radius_of_their_group(void **state) {
  (void)state;
  static const uint32_t pair[2][2] = {{0, 1}, {2, 3}};
  static const char *const names[] = {"rope", "thread"};
  world w;
  world_open(&w, 4);
  set_still_camera(&w);
  for (int i = 0; i < 4; i++)
    w.x[3 * i] = i % 2 ? 0.5 : -0.5, w.x[3 * i + 2] = i / 2 ? -0.2 : 0.2, w.group[i] = (uint32_t)i / 2;
  hk_element_list list = {.force = "springs", .elements = {.node = {2, 2, &pair[0][0]}, .values = 1}};
  w.model.element_list = &list, w.model.element_lists = 1;
  w.model.groups = 2, w.model.group_name = names;
  set_text(&w, "tubes", "rope 0.03, thread 1e-2");
  set_switch(&w, "shadows", false);
  picture p = draw_once(&w);
  assert_in_range(thickness_at(&p, 80, 5, 45), 5, 7);
  assert_in_range(thickness_at(&p, 80, 45, 85), 1, 3);
  free(p.rgb);
  fake_close(&w.f);
  static const char *const wrong[][2] = {{"rope 0.03, cord 1", "tubes: there is no group 'cord'"},
                                         {"rope -1", "tubes: expected a channel, or groups with radii above 0"},
                                         {"rope 0.1 thread 1", "tubes: expected a channel, or groups with radii"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    world_open(&w, 1);
    w.model.groups = 2, w.model.group_name = names;
    set_text(&w, "tubes", wrong[k][0]);
    assert_int_equal(begin(&w), HK_BAD_PARAM);
    assert_non_null(strstr(w.f.error, wrong[k][1]));
    fake_close(&w.f);
  }
}

static void frames_refuse_radii_that_are_none(void **state) {
  (void)state;
  world w;
  world_open(&w, 1);
  set_text(&w, "tubes", "thick");
  assert_int_equal(begin(&w), HK_BAD_PARAM);
  assert_non_null(strstr(w.f.error, "tubes: 'thick' is not one of paint"));
  set_number(&w, "tube", 1);
  assert_int_equal(w.f.plugin->create(w.f.self, &w.f.host, &w.view), HK_BAD_PARAM);
  assert_string_equal(w.f.error, "tube: tubes has the radii; leave one of the two out");
  fake_close(&w.f);
}

static const char scene[] =
    "local scene = hooke.scene { duration = 0.01, fps = 100, integrator = 'leapfrog', dt = 0.001 }\n"
    "local rope = scene:strand { from = { -0.5, 0, 0 }, to = { 0.5, 0, 0 }, n = 6, mass = 1 }\n"
    "scene:force('springs', { edges = rope:edges(), k = 100 })\nscene:force('gravity')\n"
    "scene:corrector('contact', { radius = 0.05 })\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, color = "
    "'none',\n"
    "  plain = { 1, 0, 0 }, particles = 'off', from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, fov = 5.1530,\n"
    "  ground = false })\n"
    "return scene\n";

static void frames_draw_strands_as_thick_as_contact_has_them(void **state) {
  (void)state;
  static test_result r;
  char path[512];
  test_write("rope.lua", scene);
  test_hooke(&r, NULL, "run rope.lua --quiet");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/rope/frames/000000.png", test_folder());
  picture p = read_picture(path);
  for (int x = 40; x <= 120; x += 10) assert_in_range(thickness_at(&p, x, 0, 90), 9, 11);
  free(p.rgb);
}

/* Of 100 pixels a metre, without contact: a rope of 0.05 m, one of an ellipse as large as the circle of 0.03 m, and one
 * whose radius the script does not say, which is as thin as what there is to choose. */
static const char sections[] =
    "local scene = hooke.scene { duration = 0.01, fps = 100, integrator = 'leapfrog', dt = 0.001 }\n"
    "for k, radius in ipairs { 0.05, { 0.09, 0.01 }, 0 } do\n"
    "  local rope = scene:strand { from = { -0.5, 0, 0.5 - k / 4 }, to = { 0.5, 0, 0.5 - k / 4 }, n = 6,\n"
    "    radius = radius ~= 0 and radius or nil }\n"
    "  scene:force('springs', { edges = rope:edges(), k = 100, label = 'rope' .. k })\n"
    "end\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, color = "
    "'none',\n"
    "  plain = { 1, 0, 0 }, particles = 'off', from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, fov = 5.1530, %s\n"
    "  ground = false })\n"
    "return scene\n";

static void draw_sections(const char *more, const int most[3]) {
  static const int rows[4] = {5, 35, 60, 85};
  static test_result r;
  char text[1500], path[512];
  snprintf(text, sizeof text, sections, more);
  test_write("sections.lua", text);
  test_hooke(&r, NULL, "run sections.lua --quiet");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/sections/frames/000000.png", test_folder());
  picture p = read_picture(path);
  for (int x = 40; x <= 120; x += 10)
    for (int k = 0; k < 3; k++)
      assert_in_range(thickness_at(&p, x, rows[k], rows[k + 1]), most[k] > 2 ? most[k] - 2 : 1, most[k]);
  free(p.rgb);
}

static void frames_draw_strands_as_thick_as_their_section(void **state) {
  (void)state;
  draw_sections("", (int[]){11, 7, 2});
  draw_sections("tube = 0.02,", (int[]){5, 5, 5}); /* what the output is told goes before */
}

/* Of four particles that nothing but a force on tetrahedra joins, the middle of each edge is drawn, that of a face is
 * not. */
static void frames_draw_the_edges_of_tetrahedra(void **state) {
  (void)state;
  static const uint32_t node[4] = {0, 1, 2, 3};
  static const double corner[4][2] = {{-0.6, -0.3}, {0.6, -0.3}, {0, 0.35}, {0.1, -0.1}};
  world w;
  world_open(&w, 4);
  set_still_camera(&w);
  for (int i = 0; i < 4; i++) w.x[3 * i] = corner[i][0], w.x[3 * i + 2] = corner[i][1];
  w.x[3 * 3 + 1] = 0.5;
  hk_element_list list = {.force = "neo_hookean", .elements = {.node = {1, 4, node}, .values = 1}};
  w.model.element_list = &list, w.model.element_lists = 1;
  set_number(&w, "tube", 0.02), set_number(&w, "radius", 0.02);
  set_switch(&w, "shadows", false);
  picture p = draw_once(&w);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      double middle[2] = {(corner[i][0] + corner[j][0]) / 2, (corner[i][1] + corner[j][1]) / 2};
      assert_true(is_red(&p, (int)(80 + 100 * middle[0]), (int)(45 - 100 * middle[1])));
    }
  assert_false(is_red(&p, 80 - 15, 45 + 5));
  free(p.rgb);
  fake_close(&w.f);
}

static const char cube[] =
    "local scene = hooke.scene { duration = 0.01, fps = 100, integrator = 'leapfrog', dt = 0.0001 }\n"
    "local cube = scene:block { nx = 3, ny = 3, nz = 3, size = { 0.4, 0.4, 0.4 }, origin = { -0.2, -0.2, -0.2 }, "
    "density = 1000 }\n"
    "scene:force('neo_hookean', { tetrahedra = cube:tetrahedra(), E = 1e4, nu = 0.4 })\n"
    "scene:output('frames', { width = 160, height = 90, video = false, legend = false, shadows = false, color = "
    "'none',\n"
    "  plain = { 1, 0, 0 }, from = { 0, -10, 0 }, look_at = { 0, 0, 0 }, fov = 5.1530, ground = false })\n"
    "return scene\n";

static void frames_draw_the_surface_of_a_soft_body(void **state) {
  (void)state;
  static test_result r;
  char path[512];
  test_write("cube.lua", cube);
  test_hooke(&r, NULL, "run cube.lua --quiet");
  if (r.code != 0) fail_msg("%s", r.err);
  snprintf(path, sizeof path, "%s/out/cube/frames/000000.png", test_folder());
  picture p = read_picture(path);
  for (int y = 30; y <= 60; y += 3)
    for (int x = 65; x <= 95; x += 3) assert_true(is_red(&p, x, y));
  free(p.rgb);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_draw_each_strand_with_its_radius),
      cmocka_unit_test(frames_draw_strands_with_the_radius_of_their_group),
      cmocka_unit_test(frames_refuse_radii_that_are_none),
      cmocka_unit_test(frames_draw_strands_as_thick_as_contact_has_them),
      cmocka_unit_test(frames_draw_strands_as_thick_as_their_section),
      cmocka_unit_test(frames_draw_the_edges_of_tetrahedra),
      cmocka_unit_test(frames_draw_the_surface_of_a_soft_body),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
