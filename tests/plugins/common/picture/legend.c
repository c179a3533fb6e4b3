/* The legend of pictures: ends of its bar beyond which numbers lie are pointed. */
#include "tests/plugins/outputs/picture_world.h"

enum { WIDTH = 640, HEIGHT = 360 };

/* As legend.c lays it out: a margin of 0.04 of the height, eleven units of the letters' grid for the numbers, and the
 * bar. */
static const double margin = 0.04 * HEIGHT, thickness = 5;

/* A chain of springs that are all stretched by `strain`, with colours from -0.1 to 0.1; camera and floor are given, so
 * that it is drawn at once, or not (`waits`). */
static picture draw_chain(double strain, bool waits) {
  const double range[] = {-0.1, 0.1};
  world w;
  world_open(&w, 8);
  make_chain(&w, strain);
  set_still_camera(&w);
  set_integer(&w, "width", WIDTH), set_integer(&w, "height", HEIGHT);
  set_integer(&w, "sheet", waits);
  set_text(&w, "color", "strain");
  set_switch(&w, "legend", true);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
  picture p = draw_once(&w);
  fake_close(&w.f);
  return p;
}

/* The number of columns left and right of the bar's own length that are blue or red at half its height. */
static void find_points(const picture *p, int out[2]) {
  double unit = fmax(fmax(HEIGHT / 420.0, fmin(HEIGHT / 260.0, 1.4)), 1);
  int y = HEIGHT - 1 - (int)(margin + 11 * unit + thickness / 2), left = (int)margin,
      right = (int)(margin + 0.3 * HEIGHT);
  out[0] = out[1] = 0;
  for (int x = 0; x < WIDTH / 2; x++) {
    const unsigned char *c = at(p, x, y);
    if (x < left - 1) out[0] += c[2] > c[0] + 60;
    if (x > right + 1) out[1] += c[0] > c[2] + 60;
  }
}

static void legend_is_pointed_where_numbers_lie_beyond(void **state) {
  (void)state;
  static const double strain[] = {-0.2, 0.05, 0.2};
  for (int k = 0; k < 6; k++) {
    int found[2];
    picture p = draw_chain(strain[k % 3], k > 2);
    find_points(&p, found);
    /* 1.3 of the bar's thickness, less two pixels at its foot and one at its tip, which is narrower than a pixel */
    for (int end = 0; end < 2; end++) {
      bool pointed = k % 3 == 2 * end;
      assert_true(pointed ? found[end] >= 2 && found[end] <= 7 : found[end] == 0);
    }
    free(p.rgb);
  }
}

/* Pictures that are drawn at once mark what was seen so far. */
static void legend_is_pointed_from_the_frame_on_that_saturates(void **state) {
  (void)state;
  const double range[] = {-0.1, 0.1};
  world w;
  world_open(&w, 8);
  make_chain(&w, 0);
  set_still_camera(&w);
  set_integer(&w, "width", WIDTH), set_integer(&w, "height", HEIGHT);
  set_text(&w, "color", "strain");
  set_switch(&w, "legend", true);
  *(hk_numbers *)fake_field(&w.f, "range") = (hk_numbers){2, range};
  assert_int_equal(begin(&w), HK_OK);
  for (int k = 0; k < 3; k++) {
    make_chain(&w, k == 1 ? 0.3 : 0);
    assert_int_equal(add(&w), HK_OK);
  }
  assert_int_equal(end(&w, HK_VERDICT_OK), HK_OK);
  for (size_t k = 0; k < 3; k++) {
    int found[2];
    picture p = look(&w, k);
    find_points(&p, found);
    assert_int_equal(found[0], 0);
    assert_int_equal(found[1] > 0, k > 0);
    free(p.rgb);
  }
  fake_close(&w.f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(legend_is_pointed_where_numbers_lie_beyond),
      cmocka_unit_test(legend_is_pointed_from_the_frame_on_that_saturates),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
