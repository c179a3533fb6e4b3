/* The octree of clouds of points: which points are in which cell, their boxes, the walk; points at one place, points in
 * a row, no points. */
#include "plugins/common/space/octree_builder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void *take(const hk_host *host, size_t bytes) {
  (void)host;
  return calloc(1, bytes + 1);
}

static void give(const hk_host *host, void *memory) {
  (void)host;
  free(memory);
}

static void in_turn(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                    void *context) {
  (void)host;
  for (size_t begin = 0, chunk = 0; begin < count; begin += grain, chunk++)
    body(context, begin, count - begin < grain ? count : begin + grain, chunk);
}

static const hk_host host = {.allocate = take, .release = give, .parallel_for = in_turn};

/* The cells inside [first, end) part the points of the cell around them. */
static void check_parts(const hk_octree *t, size_t first, size_t end, size_t begin, size_t until) {
  size_t parts = 0;
  for (size_t k = first; k < end; k = t->cell[k].next, parts++) {
    const hk_octree_cell *cell = &t->cell[k];
    assert_int_equal(cell->begin, begin);
    assert_true(cell->count > 0 && cell->next > k && cell->next <= end);
    begin += cell->count;
    if (cell->next > k + 1) check_parts(t, k + 1, cell->next, cell->begin, begin);
  }
  assert_int_equal(begin, until);
  assert_true(first == 0 || parts >= 2);
}

static void check_boxes(const hk_octree *t, const double *x) {
  for (size_t k = 0; k < t->cells; k++) {
    const hk_octree_cell *cell = &t->cell[k];
    for (size_t c = 0; c < 3; c++) {
      double low = INFINITY, high = -INFINITY;
      for (size_t p = cell->begin; p < (size_t)cell->begin + cell->count; p++) {
        low = fmin(low, x[3 * (size_t)t->order[p] + c]);
        high = fmax(high, x[3 * (size_t)t->order[p] + c]);
      }
      assert_true(low == cell->low[c] && high == cell->high[c]);
    }
  }
}

static void check(const double *x, const uint32_t *list, size_t count, size_t n) {
  hk_octree_builder b = {0};
  hk_octree t;
  uint32_t flawed;
  bool *seen = calloc(n + 1, sizeof *seen);
  assert_int_equal(hk_octree_reserve(&b, &host, count), HK_OK);
  for (int again = 0; again < 2; again++) {
    assert_true(hk_octree_build(&b, x, list, count, &t, &flawed));
    assert_int_equal(t.points, count);
    assert_true(t.cells < 2 * count + 1 && (t.cells > 0) == (count > 0));
    memset(seen, 0, n * sizeof *seen);
    for (size_t k = 0; k < count; k++) {
      assert_false(seen[t.order[k]]);
      seen[t.order[k]] = true;
    }
    for (size_t k = 0; k < count; k++) assert_true(seen[list ? list[k] : k]);
    if (count) check_parts(&t, 0, t.cells, 0, count);
    check_boxes(&t, x);
  }
  hk_octree_release(&b);
  free(seen);
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53 - 0.5;
}

static double *cloud(size_t n, double scale) {
  double *x = calloc(3 * n + 1, sizeof *x);
  uint64_t seed = n;
  for (size_t k = 0; k < 3 * n; k++) x[k] = scale * noise(&seed);
  return x;
}

static void clouds_of_any_number_and_size(void **state) {
  (void)state;
  const size_t counts[] = {0, 1, 2, 8, 9, 10, 100, 5000};
  const double scales[] = {1, 1e-300, 1e300};
  for (size_t q = 0; q < sizeof counts / sizeof *counts; q++)
    for (size_t s = 0; s < sizeof scales / sizeof *scales; s++) {
      double *x = cloud(counts[q], scales[s]);
      check(x, NULL, counts[q], counts[q]);
      free(x);
    }
}

static void a_part_of_the_particles(void **state) {
  (void)state;
  enum { N = 300 };
  uint32_t list[N / 3];
  double *x = cloud(N, 1);
  for (uint32_t k = 0; k < N / 3; k++) list[k] = 3 * k + 1;
  x[0] = NAN; /* nobody's */
  check(x, list, N / 3, N);
  free(x);
}

/* Depth is bounded: what is nearer than 2^-21 of the extent, or at one place, is in one cell without parts. */
static void points_at_one_place_and_nearly_so(void **state) {
  (void)state;
  enum { N = 200 };
  double *x = cloud(N, 1);
  for (size_t k = 0; k < N; k++)
    for (size_t c = 0; c < 3; c++) x[3 * k + c] = k < 100 ? 0.25 : 0.3 + 1e-12 * x[3 * k + c];
  check(x, NULL, N, N);
  for (size_t k = 0; k < 3 * N; k++) x[k] = 7;
  check(x, NULL, N, N);
  for (size_t k = 0; k < N; k++) x[3 * k] = pow(2, -(double)k); /* each half as far as the one before */
  check(x, NULL, N, N);
  free(x);
}

/* Few are sorted in another way than many. */
static void points_at_one_place_keep_their_order(void **state) {
  (void)state;
  static const double x[3 * 200];
  for (size_t count = 1; count <= 200; count += count < 60 ? 1 : 70) {
    hk_octree_builder b = {0};
    hk_octree t;
    uint32_t flawed;
    assert_int_equal(hk_octree_reserve(&b, &host, count), HK_OK);
    assert_true(hk_octree_build(&b, x, NULL, count, &t, &flawed));
    for (size_t k = 0; k < count; k++) assert_int_equal(t.order[k], k);
    hk_octree_release(&b);
  }
}

static void a_place_that_is_not_finite_is_named(void **state) {
  (void)state;
  double *x = cloud(50, 1);
  hk_octree_builder b = {0};
  hk_octree t;
  uint32_t flawed = 0;
  x[3 * 31 + 2] = INFINITY;
  assert_int_equal(hk_octree_reserve(&b, &host, 50), HK_OK);
  assert_false(hk_octree_build(&b, x, NULL, 50, &t, &flawed));
  assert_int_equal(flawed, 31);
  hk_octree_release(&b);
  free(x);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(clouds_of_any_number_and_size),       cmocka_unit_test(a_part_of_the_particles),
      cmocka_unit_test(points_at_one_place_and_nearly_so),   cmocka_unit_test(points_at_one_place_keep_their_order),
      cmocka_unit_test(a_place_that_is_not_finite_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
