/* The studios of pictures: a blue one by day, a white one for print, and night; a background that is given takes their
 * place. */
#include "tests/plugins/outputs/picture_world.h"

enum { AUTO, DAY, NIGHT, WHITE, WIDTH = 320, HEIGHT = 180 };

/* Red, green and blue of the picture's lower left corner, where the floor is. */
static void corner(int light, const double *background, int rgb[3]) {
  world w;
  world_open(&w, 8);
  make_chain(&w, 0);
  set_still_camera(&w);
  set_integer(&w, "width", WIDTH), set_integer(&w, "height", HEIGHT);
  *(int *)fake_field(&w.f, "light") = light;
  if (background) set_vector(&w, "background", background[0], background[1], background[2]);
  picture p = draw_once(&w);
  for (int c = 0; c < 3; c++) rgb[c] = at(&p, 3, HEIGHT - 4)[c];
  fake_close(&w.f);
  free(p.rgb);
}

/* Of a background of 0.93, 0.92 and 0.90 the floor is at most a tenth darker at a corner of the picture. */
static void a_studio_is_blue_or_white_or_dark(void **state) {
  (void)state;
  static const double grey[3] = {0.5, 0.5, 0.5};
  int day[3], by_itself[3], white[3], night[3], given[3];
  corner(DAY, NULL, day), corner(AUTO, NULL, by_itself), corner(WHITE, NULL, white), corner(NIGHT, NULL, night);
  corner(WHITE, grey, given);
  assert_memory_equal(day, by_itself, sizeof day);
  assert_true(day[2] > day[0] + 10 && day[2] < 220);
  for (int c = 0; c < 3; c++) assert_true(white[c] > 0.9 * 0.9 * 255 && night[c] < 60 && given[c] < 160);
  assert_true(white[0] >= white[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_studio_is_blue_or_white_or_dark)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
