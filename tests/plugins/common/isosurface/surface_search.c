/* The search along a surface: the same bits as where all blocks are evaluated, each point asked for once, and what it
 * says of values that are not allowed and of what it does not find. */
#include "tests/plugins/common/isosurface/balls.h"
#include "tests/plugins/common/isosurface/shapes.h"

enum { N = 81 };

static unsigned char times_asked[N][N][N];

typedef struct noted {
  const shape *s;
  hk_isosurface_grid grid;
} noted;

static void noting(const void *self, const double (*x)[3], size_t count, double *value) {
  const noted *n = self;
  shape_evaluate(n->s, x, count, value);
  for (size_t k = 0; k < count; k++) {
    size_t at[3];
    for (int c = 0; c < 3; c++) at[c] = (size_t)lround((x[k][c] - n->grid.origin[c]) / n->grid.spacing[c]);
    times_asked[at[2]][at[1]][at[0]]++;
  }
}

static bool same_mesh(const hk_isosurface *a, const hk_isosurface *b) {
  return a->vertices == b->vertices && a->triangles == b->triangles &&
         memcmp(a->x, b->x, a->vertices * sizeof *a->x) == 0 &&
         memcmp(a->triangle, b->triangle, a->triangles * sizeof *a->triangle) == 0;
}

static void a_search_finds_the_same_bits(void **state) {
  (void)state;
  shape shapes[SHAPES];
  fill_shapes(shapes);
  for (size_t k = 0; k < SHAPES; k++)
    for (int method = 0; method < 2; method++) {
      bench all, found;
      hk_isosurface_field field = {.evaluate = shape_evaluate, .self = &shapes[k]};
      hk_isosurface_options options = {.method = (hk_isosurface_method)method, .steps = 2};
      hk_isosurface_grid grid = shape_grid(&shapes[k], 60 + k);
      open_bench(&all, 1);
      open_bench(&found, 1);
      assert_int_equal(find(&all, grid, field, options), HK_OK);
      options.coarse = 5, options.without_normals = true;
      assert_int_equal(find(&found, grid, field, options), HK_OK);
      assert_true(same_mesh(&all.surface, &found.surface) && !found.surface.normal);
      close_bench(&all);
      close_bench(&found);
    }
}

/* Coarse points, which may be asked for once more, are a 64th; what is near the torus less than a third of the box. */
static void points_are_asked_for_once_and_near_the_surface(void **state) {
  (void)state;
  shape shapes[SHAPES];
  size_t once = 0, coarse = 0;
  fill_shapes(shapes);
  noted n = {&shapes[1], shape_grid(&shapes[1], N)};
  bench b;
  open_bench(&b, 1);
  memset(times_asked, 0, sizeof times_asked);
  assert_int_equal(find(&b, n.grid, (hk_isosurface_field){.evaluate = noting, .self = &n},
                        (hk_isosurface_options){.coarse = 4, .without_normals = true}),
                   HK_OK);
  for (size_t k = 0; k < (size_t)N * N * N; k++) {
    size_t at[3] = {k % N, k / N % N, k / N / N};
    bool is_coarse = at[0] % 4 == 0 && at[1] % 4 == 0 && at[2] % 4 == 0;
    unsigned asked = times_asked[at[2]][at[1]][at[0]];
    assert_true(asked <= (is_coarse ? 2U : 1U));
    once += !is_coarse && asked, coarse += is_coarse;
  }
  assert_true(coarse == 21 * 21 * 21 && once < (size_t)N * N * N / 3);
  close_bench(&b);
}

/* A ball holds a coarse point wherever it is when its diameter is sqrt(3) coarse spacings. */
static void what_is_wider_than_the_coarse_grid_is_found(void **state) {
  (void)state;
  uint64_t seed = 7;
  for (int trial = 0; trial < 30; trial++) {
    bench b;
    counted s = {.radius = 1.001 * sqrt(3) / 2 * 4 * 2 / 40.0};
    for (int c = 0; c < 3; c++) {
      seed = seed * 6364136223846793005u + 1442695040888963407u;
      s.place[c] = ((double)(seed >> 40) / (double)(1 << 24) - 0.5) * 1.2;
    }
    open_bench(&b, 1);
    assert_int_equal(find(&b, box(41, 41, 41), (hk_isosurface_field){.evaluate = counted_sphere, .self = &s},
                          (hk_isosurface_options){.coarse = 4}),
                     HK_OK);
    assert_int_equal(count_broken(&b.surface), 0);
    close_bench(&b);
  }
}

static void a_surface_along_the_box_is_closed_or_refused(void **state) {
  (void)state;
  counted at_wall = {.place = {1, 0.01, 0.02}, .radius = 0.8};
  hk_isosurface_field field = {.evaluate = counted_sphere, .self = &at_wall};
  hk_isosurface_options options = {.close = true, .steps = 1};
  bench all, found;
  open_bench(&all, 1);
  open_bench(&found, 1);
  assert_int_equal(find(&all, box(41, 43, 45), field, options), HK_OK);
  options.coarse = 4;
  assert_int_equal(find(&found, box(41, 43, 45), field, options), HK_OK);
  assert_true(same(&all.surface, &found.surface));
  options.close = false;
  assert_int_equal(find(&found, box(41, 43, 45), field, options), HK_BAD_PARAM);
  assert_non_null(strstr(found.error.text, "the surface leaves the box"));
  close_bench(&all);
  close_bench(&found);
}

static void refused(counted s, hk_isosurface_options options, hk_status expected, const char *text) {
  bench b;
  open_bench(&b, 1);
  hk_status status = find(&b, box(41, 41, 41), (hk_isosurface_field){.evaluate = counted_sphere, .self = &s}, options);
  if (status != expected || !strstr(b.error.text, text)) fail_msg("%d: %s", (int)status, b.error.text);
  close_bench(&b);
}

static void what_cannot_be_is_said(void **state) {
  (void)state;
  counted tiny = {.place = {0.03, 0.07, 0.11}, .radius = 0.01}, holed = ball;
  holed.hole = 0.71; /* beside the ball, which ends at 0.73; coarse points are at 0.6, 0.8 */
  refused(tiny, (hk_isosurface_options){.coarse = 4}, HK_BAD_PARAM, "on every point 4 and the level 0");
  refused(holed, (hk_isosurface_options){.coarse = 4}, HK_NOT_FINITE, "the field is nan at (0.8, ");
  refused(ball, (hk_isosurface_options){.coarse = 4, .most_bytes = 1000}, HK_NO_MEMORY, "and 0.001 MB are allowed");
  refused(ball, (hk_isosurface_options){.coarse = 4, .most_bytes = 200000}, HK_NO_MEMORY, "are allowed");
}

/* Between coarse points, next to the surface: the block is evaluated, and its value refused. */
static void band(const void *self, const double (*x)[3], size_t count, double *value) {
  counted_sphere(self, x, count, value);
  for (size_t k = 0; k < count; k++)
    if (x[k][0] > 0.64 && x[k][0] < 0.76) value[k] = NAN;
}

static void a_value_beside_the_surface_is_refused(void **state) {
  (void)state;
  bench b;
  open_bench(&b, 1);
  assert_int_equal(find(&b, box(41, 41, 41), (hk_isosurface_field){.evaluate = band, .self = &ball},
                        (hk_isosurface_options){.coarse = 4}),
                   HK_NOT_FINITE);
  assert_non_null(strstr(b.error.text, "the field is nan at (0.65, "));
  close_bench(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_search_finds_the_same_bits),
                                     cmocka_unit_test(points_are_asked_for_once_and_near_the_surface),
                                     cmocka_unit_test(what_is_wider_than_the_coarse_grid_is_found),
                                     cmocka_unit_test(a_surface_along_the_box_is_closed_or_refused),
                                     cmocka_unit_test(what_cannot_be_is_said),
                                     cmocka_unit_test(a_value_beside_the_surface_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
