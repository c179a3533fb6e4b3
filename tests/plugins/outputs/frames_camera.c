/* Where cameras stand: on their way by key frames. */
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(frames_camera_passes_its_keyframes),
      cmocka_unit_test(frames_refuse_keyframes_that_are_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
