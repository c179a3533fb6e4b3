/* Where an edge passes through a triangle: at the place known beforehand, and nowhere where it has left it. */
#include "plugins/common/contact/untangling/crossing_points.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

typedef struct seen {
  int count;
  double x[3], n[3];
} seen;

static void add(void *context, const double x[3], const double n[3]) {
  seen *s = context;
  s->count++;
  for (int c = 0; c < 3; c++) s->x[c] = x[c], s->n[c] = n[c];
}

/* The triangle (0,0,1) (2,0,1) (0,2,1), and an edge. */
static seen crossings(const double from[3], const double to[3]) {
  static const uint32_t edge[1][2] = {{3, 4}}, triangle[1][3] = {{0, 1, 2}};
  hk_surface_mesh mesh = {.edges = 1, .triangles = 1, .edge = edge, .triangle = triangle};
  hk_contour_point point = {0, 0, 0};
  hk_contours contours = {.points = 1, .point = &point};
  double x[15] = {0, 0, 1, 2, 0, 1, 0, 2, 1};
  for (int c = 0; c < 3; c++) x[9 + c] = from[c], x[12 + c] = to[c];
  seen s = {0};
  hk_crossing_points(&contours, &mesh, x, &(hk_contact_points){&s, add});
  return s;
}

static void an_edge_passes_where_it_meets_the_plane(void **state) {
  (void)state;
  seen s = crossings((double[]){0.5, 0.25, 0}, (double[]){0.5, 0.75, 4});
  assert_int_equal(s.count, 1);
  assert_true(s.x[0] == 0.5 && s.x[1] == 0.375 && s.x[2] == 1); /* a quarter of the way: exact in binary */
  assert_true(s.n[0] == 0 && s.n[1] == 0 && fabs(s.n[2]) == 1);
}

static void what_has_left_the_triangle_is_none(void **state) {
  (void)state;
  assert_int_equal(crossings((double[]){0.5, 0.25, 1.5}, (double[]){0.5, 0.75, 4}).count, 0); /* above it */
  assert_int_equal(crossings((double[]){1.5, 1.5, 0}, (double[]){1.5, 1.5, 4}).count, 0);     /* beside it */
  assert_int_equal(crossings((double[]){0, 0, 2}, (double[]){2, 0, 2}).count, 0);             /* parallel */
  assert_int_equal(crossings((double[]){0, 0, 1}, (double[]){2, 0, 1}).count, 0);             /* in its plane */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_edge_passes_where_it_meets_the_plane),
      cmocka_unit_test(what_has_left_the_triangle_is_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
