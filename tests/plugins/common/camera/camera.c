/* Where cameras stand: on their way by key frames, chosen, and several of them. */
#include "tests/plugins/outputs/picture_world.h"

static const double way[] = {0, 0, -10, 0, 0, 0, 0, 2, 10, 0, 0, 0, 0, 0};

/* Two particles 0.8 m apart in the line of sight of the first row, across that of the second. */
static void open_pair(world *w) {
  world_open(w, 2);
  set_still_camera(w);
  set_number(w, "radius", 0.1);
  w->x[1] = -0.4, w->x[4] = 0.4;
}

static picture draw_at(world *w, double t) {
  w->view.t = t;
  picture p = draw_once(w);
  fake_close(&w->f);
  return p;
}

/* At its rows and beyond them a camera is where they say, in the middle between two at the middle: the velocity is 0 at
 * both. */
static void frames_camera_passes_its_keyframes(void **state) {
  (void)state;
  static const struct {
    double t, from[3];
  } known[] = {{-1, {0, -10, 0}}, {0, {0, -10, 0}}, {1, {5, -5, 0}}, {2, {10, 0, 0}}, {5, {10, 0, 0}}};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    world w;
    open_pair(&w);
    set_vector(&w, "from", known[k].from[0], known[k].from[1], known[k].from[2]);
    picture placed = draw_at(&w, known[k].t);
    open_pair(&w);
    set_vector(&w, "from", NAN, NAN, NAN);
    set_vector(&w, "look_at", NAN, NAN, NAN);
    *(hk_numbers *)fake_field(&w.f, "keyframes") = (hk_numbers){14, way};
    picture moved = draw_at(&w, known[k].t);
    assert_memory_equal(placed.rgb, moved.rgb, 3 * 160 * 90);
    free(placed.rgb), free(moved.rgb);
  }
}

/* An upright row of particles, 1 m high. */
static void frames_keep_the_subject_at_two_thirds_of_the_height(void **state) {
  (void)state;
  world w;
  world_open(&w, MOST);
  for (int i = 0; i < MOST; i++) w.x[3 * i] = w.x[3 * i + 1] = 0, w.x[3 * i + 2] = (double)i / (MOST - 1);
  set_number(&w, "radius", 0.005);
  set_number(&w, "outliers", 0);
  set_text(&w, "views", "front"); /* seen level, no end is nearer */
  free(draw_once(&w).rgb);
  extent e = find_red(&w, 0);
  /* 60 of 90 pixels for the row and a margin of a fiftieth of its size, half its length, less what beads fill of it */
  double pixels = 60 * (1 + 2 * 0.005) / (1 + 2 * 0.02 * 0.5);
  assert_true(fabs(e.bottom - e.top + 1 - pixels) <= 2);
  assert_in_range(e.top + e.bottom, 88, 90); /* in the middle */
  fake_close(&w.f);
}

/* Four cells; two particles, one behind the other from the front, side by side from the right and, one above the other,
 * from above. Each has its camera: from any side the pair is seen whole. */
static void frames_show_several_views_with_their_names(void **state) {
  (void)state;
  static const double more[] = {0, -10, 0, 0, 0, 0};
  world w;
  open_pair(&w);
  set_integer(&w, "width", 482), set_integer(&w, "height", 442);
  set_text(&w, "views", "front, right top,camera2");
  *(hk_numbers *)fake_field(&w.f, "cameras") = (hk_numbers){6, more};
  picture p = draw_once(&w);
  for (int k = 0; k < 4; k++) {
    const int corner[2] = {k % 2 * 242, k / 2 * 222};
    int ink = 0, low[2] = {999, 999}, high[2] = {-1, -1};
    for (int y = 0; y < 220; y++)
      for (int x = 0; x < 240; x++) {
        const unsigned char *c = at(&p, corner[0] + x, corner[1] + y);
        ink += y < 30 && c[0] < 110 && c[2] < 130; /* the background is above 130 */
        if (!is_red(&p, corner[0] + x, corner[1] + y)) continue;
        low[0] = x < low[0] ? x : low[0], high[0] = x > high[0] ? x : high[0];
        low[1] = y < low[1] ? y : low[1], high[1] = y > high[1] ? y : high[1];
      }
    assert_true(ink > 10); /* its name */
    int wide = high[0] - low[0], tall = high[1] - low[1];
    assert_true(k == 1 ? wide > 4 * tall : k == 2 ? tall > 4 * wide : abs(wide - tall) <= 2);
    assert_in_range(abs(low[0] + high[0] - 239), 0, 3);
    assert_in_range(abs(low[1] + high[1] - 219), 0, 3);
  }
  for (int c = 0; c < 3; c++) assert_int_equal(at(&p, 240, 100)[c], 255); /* between them */
  free(p.rgb);
  fake_close(&w.f);
}

/* Letters and numbers of the legend are in a strip below the stills, as large as on a picture, and on no still. */
static void frames_have_one_legend_for_a_sheet(void **state) {
  (void)state;
  static const double range[] = {0, 1};
  char path[512];
  int ink[2] = {0};
  world w;
  world_open(&w, 1);
  set_still_camera(&w);
  set_switch(&w, "legend", true);
  set_integer(&w, "width", 320), set_integer(&w, "height", 240);
  set_integer(&w, "sheet", 4);
  set_switch(&w, "reverse", true); /* at rest it is yellow */
  set_text(&w, "color", "speed");
  set_number(&w, "radius", 0.2);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 4; k++) assert_int_equal(add(&w), HK_OK);
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  snprintf(path, sizeof path, "%s/sheet.png", w.f.folder);
  picture single = look(&w, 3), sheet = read_picture(path);
  assert_int_equal(sheet.width, 2 * 160 + 4);
  assert_true(sheet.height > 2 * 120 + 2 * 4 + 30);
  for (int y = 0; y < sheet.height; y++)
    for (int x = 0; x < sheet.width; x++) ink[y > 2 * 120 + 4] += at(&sheet, x, y)[0] < 90;
  int whole = 0; /* where the picture has its legend: below the particle and its shadow */
  for (int y = 180; y < 240; y++)
    for (int x = 0; x < 320; x++) whole += at(&single, x, y)[0] < 90;
  assert_true(whole > 60);
  assert_true(ink[0] < ink[1] / 2);                         /* the particle itself has dark colours */
  assert_in_range(ink[1], whole * 9 / 10, whole * 11 / 10); /* the background differs a little */
  free(single.rgb), free(sheet.rgb);
  fake_close(&w.f);
}

static void refuse(const double *rows, size_t count, const char *message) {
  world w;
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "keyframes") = (hk_numbers){count, rows};
  assert_int_equal(begin(&w), HK_BAD_PARAM);
  assert_string_equal(w.f.error, message);
  fake_close(&w.f);
}

static void frames_refuse_keyframes_that_are_none(void **state) {
  (void)state;
  static const double back[] = {1, 0, -1, 0, 0, 0, 0, 1, 0, -2, 0, 0, 0, 0}, inside[] = {0, 1, 2, 3, 1, 2, 3};
  refuse(way, 6, "keyframes: expected t, x, y, z of the camera and x, y, z of what it looks at for each");
  refuse(back, 14, "keyframes: t = 1 s of row 2 is not after 1 s");
  refuse(inside, 7, "keyframes: in row 1 the camera stands where it looks at");
  world w;
  world_open(&w, 1);
  *(hk_numbers *)fake_field(&w.f, "keyframes") = (hk_numbers){14, way};
  set_vector(&w, "from", 0, -1, 0);
  assert_int_equal(begin(&w), HK_BAD_PARAM);
  assert_string_equal(w.f.error, "keyframes: they say where the camera is; leave out from");
  fake_close(&w.f);
}

static void refuse_views(const char *names, size_t numbers, const char *message) {
  world w;
  world_open(&w, 1);
  set_text(&w, "views", names);
  *(hk_numbers *)fake_field(&w.f, "cameras") = (hk_numbers){numbers, way};
  assert_int_equal(begin(&w), HK_BAD_PARAM);
  assert_string_equal(w.f.error, message);
  fake_close(&w.f);
}

static void frames_refuse_views_that_are_none(void **state) {
  (void)state;
  refuse_views("front, side", 0, "views: 'side' is not one of camera, front, back, left, right, top, bottom");
  refuse_views(
      "camera3", 6,
      "views: 'camera3' is not one of camera, front, back, left, right, top, bottom; camera2 and so on are the "
      "rows of cameras");
  refuse_views("top", 5, "cameras: expected x, y, z of where it stands and of what it looks at for each");
  refuse_views("top top top top top top top top top top top top top top top top top", 0,
               "views: a picture has 16 at most");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_camera_passes_its_keyframes),
      cmocka_unit_test(frames_keep_the_subject_at_two_thirds_of_the_height),
      cmocka_unit_test(frames_show_several_views_with_their_names),
      cmocka_unit_test(frames_have_one_legend_for_a_sheet),
      cmocka_unit_test(frames_refuse_keyframes_that_are_none),
      cmocka_unit_test(frames_refuse_views_that_are_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
