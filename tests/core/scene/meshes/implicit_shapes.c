/* Implicit shapes: what a blob by itself is, how parts are joined, and bounds that hold in any box. */
#include "core/scene/meshes/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static double at(const hk_implicit_shape *s, double x, double y, double z) {
  const double place[1][3] = {{x, y, z}};
  double value;
  hk_implicit_evaluate(s, place, 1, &value);
  return value;
}

static double draw(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0;
}

static void a_blob_by_itself_is_a_ball_of_its_radius(void **state) {
  (void)state;
  hk_blob blob = {{1, 2, 3}, 0.7, 1};
  hk_implicit_shape s = {.kind = HK_IMPLICIT_BLOBS, .count = 1, .blob = &blob};
  assert_true(fabs(at(&s, 1.7, 2, 3)) < 1e-15 && fabs(at(&s, 1, 2, 2.3)) < 1e-15); /* rounding */
  assert_true(at(&s, 1, 2, 3) == 0.5 && at(&s, 1, 2, 4.4) == -0.5);
  double low[3], high[3];
  assert_true(hk_implicit_box(&s, low, high) && low[1] == 2 - 1.4 && high[2] == 3 + 1.4);
}

/* f = x and f = y: values are known everywhere. */
static void linear(void *context, int function, const double (*x)[3], size_t count, double *value) {
  (void)context;
  for (size_t k = 0; k < count; k++) value[k] = x[k][function];
}

static void parts_are_joined_as_their_names_say(void **state) {
  (void)state;
  hk_implicit_shape part[2] = {{.kind = HK_IMPLICIT_FUNCTION, .evaluate = linear, .function = 0, .level = 1},
                               {.kind = HK_IMPLICIT_FUNCTION, .evaluate = linear, .function = 1}};
  hk_implicit_shape s = {.kind = HK_IMPLICIT_UNION, .count = 2, .part = part};
  assert_true(at(&s, 3, -5, 0) == 2 && at(&s, -9, 4, 0) == 4);
  s.kind = HK_IMPLICIT_INTERSECTION;
  assert_true(at(&s, 3, -5, 0) == -5 && at(&s, 9, 4, 0) == 4);
  s.kind = HK_IMPLICIT_DIFFERENCE;
  assert_true(at(&s, 3, -5, 0) == 2 && at(&s, 3, 4, 0) == -4);
  part[0].below = true; /* 1 - x */
  assert_true(at(&s, 3, -5, 0) == -2);
  part[0].below = false;
  s.blend = 2; /* (2 - 1)^2 / 8 where the values differ by 1, nothing where they differ by 2 */
  s.kind = HK_IMPLICIT_UNION;
  assert_true(at(&s, 4, 2, 0) == 3 + 1.0 / 8 && at(&s, 5, 2, 0) == 4);
  s.kind = HK_IMPLICIT_INTERSECTION;
  assert_true(at(&s, 4, 2, 0) == 2 - 1.0 / 8);
  s.kind = HK_IMPLICIT_DIFFERENCE;
  assert_true(at(&s, 4, -2, 0) == 2 - 1.0 / 8);
  double low[3], high[3];
  assert_true(hk_implicit_has_function(&s) && !hk_implicit_box(&s, low, high));
}

static hk_implicit_shape some_blobs(hk_blob *blob, size_t count, uint64_t *seed) {
  for (size_t k = 0; k < count; k++) {
    for (int c = 0; c < 3; c++) blob[k].centre[c] = 2 * draw(seed) - 1;
    blob[k].radius = 0.1 + 0.5 * draw(seed), blob[k].weight = draw(seed) < 0.3 ? -0.5 : 1;
  }
  return (hk_implicit_shape){.kind = HK_IMPLICIT_BLOBS, .count = count, .blob = blob};
}

/* Values at random places of random boxes, and beyond the shape's own box, where nothing is inside. */
static void bounds_hold_in_any_box(void **state) {
  (void)state;
  uint64_t seed = 11;
  hk_blob blob[2][5];
  for (int trial = 0; trial < 300; trial++) {
    hk_implicit_shape part[2] = {some_blobs(blob[0], 5, &seed), some_blobs(blob[1], 3, &seed)};
    hk_implicit_shape s = {.kind = (hk_implicit_kind)(HK_IMPLICIT_UNION + trial % 3), .count = 2, .part = part};
    double low[3], high[3], range[2], box[2][3];
    s.blend = trial % 2 ? draw(&seed) : 0;
    for (int c = 0; c < 3; c++) low[c] = 2.4 * draw(&seed) - 1.2, high[c] = low[c] + draw(&seed);
    hk_implicit_bounds(&s, low, high, range);
    assert_true(hk_implicit_box(&s, box[0], box[1]));
    for (int k = 0; k < 200; k++) {
      double x[3], far[3];
      bool outside = false;
      for (int c = 0; c < 3; c++) {
        x[c] = low[c] + draw(&seed) * (high[c] - low[c]), far[c] = 6 * draw(&seed) - 3;
        outside = outside || far[c] < box[0][c] || far[c] > box[1][c];
      }
      double value = at(&s, x[0], x[1], x[2]);
      if (!(value >= range[0] && value <= range[1])) fail_msg("%g is not from %g to %g", value, range[0], range[1]);
      assert_true(!outside || at(&s, far[0], far[1], far[2]) < 0);
    }
  }
}

/* Blobs in a box: below 0 beyond it, the distance from a face deep inside, and bounds that hold. */
static void a_box_closes_a_shape(void **state) {
  (void)state;
  uint64_t seed = 21;
  hk_blob blob[5];
  hk_implicit_shape s = some_blobs(blob, 5, &seed);
  hk_boxed_shape boxed = {&s, {-0.6, -0.5, -0.4}, {0.5, 0.6, 0.7}};
  for (int trial = 0; trial < 2000; trial++) {
    double x[1][3], low[3], high[3], range[2], value[1];
    for (int c = 0; c < 3; c++) {
      x[0][c] = 2 * draw(&seed) - 1;
      low[c] = x[0][c] - 0.3 * draw(&seed), high[c] = x[0][c] + 0.3 * draw(&seed);
    }
    double face = INFINITY;
    for (int c = 0; c < 3; c++) face = fmin(face, fmin(x[0][c] - boxed.low[c], boxed.high[c] - x[0][c]));
    hk_boxed_shape_evaluate(&boxed, (const double(*)[3])x, 1, value);
    hk_boxed_shape_bounds(&boxed, low, high, range);
    assert_true(value[0] == (face < 0 ? face : fmin(face, at(&s, x[0][0], x[0][1], x[0][2]))));
    assert_true(value[0] >= range[0] && value[0] <= range[1]);
  }
}

/* Many places at once: the blobs that a batch leaves out have no part in it. */
static void many_places_have_the_values_of_each(void **state) {
  (void)state;
  enum { PLACES = 500 };
  uint64_t seed = 5;
  hk_blob blob[6];
  double x[PLACES][3], value[PLACES];
  hk_implicit_shape s = some_blobs(blob, 6, &seed);
  for (int k = 0; k < PLACES; k++)
    for (int c = 0; c < 3; c++) x[k][c] = 3 * draw(&seed) - 1.5;
  hk_implicit_evaluate(&s, (const double(*)[3])x, PLACES, value);
  for (int k = 0; k < PLACES; k++) assert_true(value[k] == at(&s, x[k][0], x[k][1], x[k][2]));
}

/* Two softly joined shapes are inside where both are -1/2, everywhere, when blend is 2 or more. */
static void a_union_that_has_no_end_has_no_box(void **state) {
  (void)state;
  uint64_t seed = 2;
  hk_blob blob[2][2];
  hk_implicit_shape part[2] = {some_blobs(blob[0], 2, &seed), some_blobs(blob[1], 2, &seed)};
  hk_implicit_shape s = {.kind = HK_IMPLICIT_UNION, .count = 2, .part = part, .blend = 2};
  double low[3], high[3];
  assert_true(at(&s, 50, 50, 50) >= 0 && !hk_implicit_box(&s, low, high));
  s.blend = 1.99;
  assert_true(at(&s, 50, 50, 50) < 0 && hk_implicit_box(&s, low, high));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_blob_by_itself_is_a_ball_of_its_radius),
                                     cmocka_unit_test(parts_are_joined_as_their_names_say),
                                     cmocka_unit_test(bounds_hold_in_any_box),
                                     cmocka_unit_test(a_box_closes_a_shape),
                                     cmocka_unit_test(many_places_have_the_values_of_each),
                                     cmocka_unit_test(a_union_that_has_no_end_has_no_box)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
