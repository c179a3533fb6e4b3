/* Known surfaces: topology, the order in which area, volume and normals become exact, and vertices that are moved onto
 * the surface. */
#include "tests/plugins/common/isosurface/shapes.h"

typedef struct answer {
  double volume, area, off, turned; /* errors; off: largest |f| at a vertex; turned: largest error of a normal */
} answer;

static void check_topology(const shape *s, const hk_isosurface *found) {
  long euler[4] = {0};
  assert_int_equal(count_broken(found), 0);
  assert_int_equal(find_components(found, euler, 4), s->components);
  for (size_t k = 0; k < s->components; k++) assert_int_equal(euler[k], s->euler);
}

static void check_vertices(const shape *s, const hk_isosurface *found, answer *a) {
  for (size_t v = 0; v < found->vertices; v++) {
    double g[3], error = 0, value = s->value(found->x[v], g), length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    for (int c = 0; c < 3; c++) error += pow(found->normal[v][c] + g[c] / length, 2);
    a->off = fmax(a->off, fabs(value));
    a->turned = fmax(a->turned, sqrt(error));
  }
}

static double *sample(const shape *s, const hk_isosurface_grid *grid) {
  size_t n = grid->points[0];
  double *value = malloc(n * n * n * sizeof *value), unused[3];
  assert_non_null(value);
  for (size_t k = 0; k < n * n * n; k++) {
    double h = grid->spacing[0], x[3] = {h * (double)(k % n), h * (double)(k / n % n), h * (double)(k / n / n)};
    for (int c = 0; c < 3; c++) x[c] += grid->origin[c];
    value[k] = s->value(x, unused);
  }
  return value;
}

static answer find(const shape *s, size_t points, hk_isosurface_options options, bool array) {
  bench b;
  const hk_host *host = open_bench(&b, 1);
  answer a = {0};
  hk_isosurface_grid grid = shape_grid(s, points);
  double *value = array ? sample(s, &grid) : NULL;
  hk_isosurface_field field = {.values = value, .evaluate = array ? NULL : shape_evaluate, .self = s};
  if (hk_isosurface_find(&b.surface, host, &grid, &field, &options) != HK_OK) fail_msg("%s: %s", s->name, b.error.text);
  check_topology(s, &b.surface);
  check_vertices(s, &b.surface, &a);
  a.volume = surface_volume(&b.surface) - s->volume, a.area = surface_area(&b.surface) - s->area;
  free(value);
  close_bench(&b);
  return a;
}

/* Twice as many cells: an error of order 2 becomes a fourth. The bound of 3.2 leaves room for where the surface lies on
 * the grid, which the error of a coarse one depends on. */
static const double rounding = 1e-12; /* where differences of a parabola are exact */

static void check_order(const char *what, const shape *s, double coarse, double fine) {
  if (!(fabs(coarse) > 3.2 * fabs(fine)) && !(fabs(fine) < rounding))
    fail_msg("%s: errors of %s %g and %g", s->name, what, coarse, fine);
}

static void check_shape(const shape *s, hk_isosurface_method method, bool array, unsigned steps) {
  hk_isosurface_options options = {.method = method, .steps = steps};
  answer a = find(s, 21, options, array), b = find(s, 41, options, array), c = find(s, 81, options, array);
  check_order("volume", s, b.volume, c.volume);
  s->area > 0 ? check_order("area", s, b.area, c.area) : check_order("area", s, a.area - b.area, b.area - c.area);
  if (array)
    check_order("normals", s, b.turned, c.turned);
  else
    assert_true(c.turned < 2e-3);
}

static void area_volume_and_normals_have_order_2(void **state) {
  (void)state;
  shape s[SHAPES];
  fill_shapes(s);
  for (int k = 0; k < SHAPES; k++)
    for (int way = 0; way < 3; way++)
      for (int method = 0; method < 2; method++)
        check_shape(&s[k], (hk_isosurface_method)method, way == 0, way == 2 ? 3 : 0);
}

/* Of |f| at the vertices: by interpolation of the order of h^2 (here 2e-2), by parabolas of order above 1.6 a
 * step. */
static void steps_move_vertices_onto_the_surface(void **state) {
  (void)state;
  shape s[SHAPES];
  fill_shapes(s);
  for (int k = 0; k < SHAPES; k++) {
    double before = INFINITY;
    for (unsigned steps = 0; steps <= 8; steps += 2) {
      double off = find(&s[k], 21, (hk_isosurface_options){.steps = steps}, false).off;
      assert_true(off < 0.2 * before || off < 1e-13);
      before = off;
    }
    assert_true(before < 1e-13);
  }
}

/* Two apart, and the sphere turned inside out in a closed box: an outer surface and a hollow. */
static double two_spheres(const double x[3], double g[3]) {
  double left[3] = {x[0] + 1, x[1], x[2]}, right[3] = {x[0] - 1, x[1], x[2]}, other[3];
  double a = sphere_value(left, g) - 0.4, b = sphere_value(right, other) - 0.4;
  for (int c = 0; c < 3; c++) g[c] = a > b ? g[c] : other[c];
  return a > b ? a : b;
}

static double hollow(const double x[3], double g[3]) {
  double value = -sphere_value(x, g);
  for (int c = 0; c < 3; c++) g[c] = -g[c];
  return value;
}

static void every_component_has_its_own_euler_number(void **state) {
  (void)state;
  double ball = 4 * M_PI / 3 * pow(0.6, 1.5);
  shape two = {"two", two_spheres, 2, 2, 2, 2 * ball, 1},
        hole = {"hole", hollow, 1.3, 2, 2, 8 * 1.3 * 1.3 * 1.3 - 4 * M_PI / 3, 1};
  for (int method = 0; method < 2; method++) {
    hk_isosurface_options options = {.method = (hk_isosurface_method)method, .close = true};
    assert_true(fabs(find(&two, 41, options, false).volume) < 0.02 * two.volume);
    assert_true(fabs(find(&hole, 41, options, false).volume) < 0.005 * hole.volume);
    assert_true(fabs(find(&hole, 41, options, true).volume) < 0.005 * hole.volume);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(area_volume_and_normals_have_order_2),
      cmocka_unit_test(steps_move_vertices_onto_the_surface),
      cmocka_unit_test(every_component_has_its_own_euler_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
