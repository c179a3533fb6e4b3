#include "plugins/common/occlusion/occlusion.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

/* A square of side 2 around (0, 0, 1), whose front looks up, between an eye at (0, 0, 2) and points at z = 0. */
static const float square[4][3] = {{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
static const uint32_t face[2][3] = {{0, 1, 2}, {0, 2, 3}}, back[2][3] = {{0, 2, 1}, {0, 3, 2}};

static double hidden_by(hk_sight *s, const uint32_t (*triangle)[3]) {
  return hk_sight_hidden_by(s, square, sizeof square[0], triangle, 2);
}

/* At z = 0 its shadow reaches from -2 to 2. */
static hk_sight row_of_points(float from, float to, size_t count) {
  hk_sight s = {.eye = {0, 0, 2}};
  for (size_t k = 0; k < count; k++)
    hk_sight_add(&s, (float[]){from + (to - from) * ((float)k + 0.5f) / (float)count, 0.1f, 0});
  return s;
}

static void triangles_hide_what_is_behind_their_front(void **state) {
  (void)state;
  hk_sight s = row_of_points(-4, 4, 200);
  assert_float_equal(hidden_by(&s, back), 0, 0);
  assert_float_equal(hidden_by(&s, face), 0.5, 1e-12);
  for (size_t k = 0; k < s.points; k++) assert_int_equal(s.hidden[k], fabsf(s.point[k][0]) < 2);
}

/* Before it, on it, and where nothing is known: not hidden. */
static void what_is_nearer_or_on_the_triangle_is_seen(void **state) {
  (void)state;
  hk_sight s = {.eye = {0, 0, 2}};
  const float height[] = {1.5f, 1, 0.99f, NAN};
  for (int k = 0; k < 4; k++) hk_sight_add(&s, (float[]){0.1f, 0.2f, height[k]});
  assert_int_equal(s.points, 3);
  hidden_by(&s, face);
  assert_int_equal(s.hidden[0] + s.hidden[1], 0);
  assert_int_equal(s.hidden[2], 1);
}

static void spheres_that_no_line_of_sight_meets_are_told(void **state) {
  (void)state;
  hk_sight s = row_of_points(-1, 1, 100);
  assert_true(hk_sight_may_meet(&s, (double[]){0, 0, 1}, 0.1));
  assert_false(hk_sight_may_meet(&s, (double[]){1.5, 0, 1}, 0.5));
  assert_false(hk_sight_may_meet(&s, (double[]){0, 0, 3}, 0.9));  /* behind the eye */
  assert_false(hk_sight_may_meet(&s, (double[]){0, 0, -1}, 0.9)); /* behind the points */
}

/* Opaque up to a half, 0.18 from three quarters on, and between them without a jump or a way back. */
static void things_fade_with_what_all_of_them_hide(void **state) {
  (void)state;
  double last = 1;
  for (size_t hidden = 0; hidden <= 200; hidden++) {
    hk_sight s = row_of_points(-4, 4, 200);
    for (size_t k = 0; k < hidden; k++) s.hidden[k] = true;
    double opacity = hk_sight_opacity(&s, (double)hidden / 200);
    assert_true(opacity <= last && last - opacity < 0.03);
    if (hidden <= 100) assert_float_equal(opacity, 1, 0);
    if (hidden >= 150) assert_float_equal(opacity, 0.18, 1e-12);
    assert_float_equal(hk_sight_opacity(&s, 0), 1, 0); /* what hides nothing stays */
    last = opacity;
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(triangles_hide_what_is_behind_their_front),
      cmocka_unit_test(what_is_nearer_or_on_the_triangle_is_seen),
      cmocka_unit_test(spheres_that_no_line_of_sight_meets_are_told),
      cmocka_unit_test(things_fade_with_what_all_of_them_hide),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
