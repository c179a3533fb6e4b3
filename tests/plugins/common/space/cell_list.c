/* Cell lists against the loop over all pairs, which is compared number by number: rows have no tolerance. */
#include "plugins/common/space/cell_list.h"
#include "core/engine/host/host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- a host without a plugin ---- */

typedef struct bench {
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error;
  hk_cell_list list;
} bench;

static const hk_host *open_bench(bench *b, int threads) {
  *b = (bench){.plugin = {.kind = HK_SERVICE}};
  b->shared = (hk_shared){
      .error = &b->error, .threads = hk_threads_create(threads), .allocations_left = -1, .lanes = hk_processor_lanes()};
  assert_non_null(b->shared.threads);
  b->instance =
      (hk_instance){.host = hk_host_table, .shared = &b->shared, .plugin = &b->plugin, .label = "cells", .where = ""};
  return &b->instance.host;
}

static void close_bench(bench *b) {
  hk_cell_list_free(&b->list, &b->instance.host);
  hk_memory_clear(&b->instance.blocks);
  hk_threads_destroy(b->shared.threads);
}

/* ---- all pairs ---- */

static double distance2(const double *a, const double *b) {
  double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
  return dx * dx + dy * dy + dz * dz;
}

/* Every `stride`-th row. */
static void check_rows(const char *what, const hk_cell_list *l, const double *x, size_t n, double reach,
                       size_t stride) {
  assert_int_equal(l->n, n);
  assert_int_equal(l->row_start[0], 0);
  for (size_t i = 0; i < n; i += stride) {
    size_t k = l->row_start[i];
    for (size_t j = 0; j < n; j++) {
      if (j == i || !(distance2(x + 3 * i, x + 3 * j) < reach * reach)) continue;
      if (k == l->row_start[i + 1] || l->other[k] != j) fail_msg("%s: row %zu has not %zu where it should", what, i, j);
      k++;
    }
    if (k != l->row_start[i + 1]) fail_msg("%s: row %zu has %zu too many", what, i, l->row_start[i + 1] - k);
  }
}

static void check_cloud(const char *what, const double *x, size_t n, double reach) {
  bench b;
  const hk_host *host = open_bench(&b, 1);
  assert_int_equal(hk_cell_list_build(&b.list, host, x, n, reach), HK_OK);
  check_rows(what, &b.list, x, n, reach, 1);
  close_bench(&b);
}

/* ---- clouds ---- */

enum { POINTS = 1500 };

static uint64_t seed[4];

static double uniform(void) { return hk_random_uniform(seed); }

static double *cloud(double x[3 * POINTS], double scale, double offset) {
  hk_random_seed(seed, 7);
  for (size_t k = 0; k < 3 * POINTS; k++) x[k] = offset + scale * uniform();
  return x;
}

static void random_clouds_have_the_rows_of_all_pairs(void **state) {
  (void)state;
  double x[3 * POINTS];
  const double reach[] = {0.01, 0.1, 0.3, 0.9, 5};
  for (size_t k = 0; k < sizeof reach / sizeof *reach; k++) {
    check_cloud("cube", cloud(x, 1, 0), POINTS, reach[k]);
    check_cloud("cube around the origin", cloud(x, 1, -0.5), POINTS, reach[k]);
  }
}

/* Spacing and reach are equal, or differ by the last digit: whole planes lie on the borders of cells. */
static void lattices_on_the_borders_of_cells(void **state) {
  (void)state;
  double x[3 * 1000];
  for (size_t k = 0; k < 1000; k++) {
    x[3 * k] = 0.1 * (double)(k % 10);
    x[3 * k + 1] = 0.1 * (double)(k / 10 % 10);
    x[3 * k + 2] = 0.1 * (double)(k / 100);
  }
  const double reach[] = {0.1, nextafter(0.1, 1), nextafter(0.1, 0), 0.2, 0.1 * sqrt(2), 0.05};
  for (size_t k = 0; k < sizeof reach / sizeof *reach; k++) check_cloud("lattice", x, 1000, reach[k]);
}

/* Pairs along one axis, a little closer than the reach, anywhere between the borders of cells and up to 1.6e9 cells
 * from the first point, where a number of a cell is rounded most. */
static void pairs_a_little_closer_than_the_reach(void **state) {
  (void)state;
  enum { PAIRS = 500 };
  const double reach = 0.1, from[] = {0, 1e3, 1e6, 1.6e8};
  double x[3 * (2 * PAIRS + 1)];
  for (size_t f = 0; f < sizeof from / sizeof *from; f++)
    for (size_t axis = 0; axis < 3; axis++) {
      memset(x, 0, sizeof x);
      for (size_t p = 1; p <= PAIRS; p++) {
        double *a = x + 3 * (2 * p - 1), *b = a + 3;
        a[axis] = from[f] + reach * (double)p * 3 / PAIRS;
        b[axis] = a[axis] + reach * (1 - 1e-9);
        a[(axis + 1) % 3] = b[(axis + 1) % 3] = (double)p;
      }
      check_cloud("almost the reach", x, 2 * PAIRS + 1, reach);
    }
}

static void clusters_far_apart(void **state) {
  (void)state;
  double x[3 * POINTS];
  cloud(x, 1, 0);
  for (size_t i = 0; i < POINTS; i++)
    for (size_t c = 0; c < 3; c++) x[3 * i + c] += 1e6 * (double)(i * (c + 1) % 5); /* 1e8 cells of 0.01 m apart */
  check_cloud("clusters", x, POINTS, 0.01);
  check_cloud("clusters", x, POINTS, 0.2);
}

static void a_cloud_a_thousand_kilometres_away(void **state) {
  (void)state;
  double x[3 * POINTS];
  check_cloud("far away", cloud(x, 1, 1e6), POINTS, 0.05);
  check_cloud("far away", cloud(x, 1, -1e6), POINTS, 0.2);
}

static void lines_and_planes(void **state) {
  (void)state;
  double x[3 * POINTS];
  for (size_t flat = 0; flat < 3; flat++) {
    cloud(x, 1, 0);
    for (size_t i = 0; i < POINTS; i++) x[3 * i + flat] = 0.3;
    check_cloud("plane", x, POINTS, 0.05);
    for (size_t i = 0; i < POINTS; i++) x[3 * i + (flat + 1) % 3] = -0.3;
    check_cloud("line", x, POINTS, 0.05);
  }
}

static void all_points_in_one(void **state) {
  (void)state;
  double x[3 * 100];
  for (size_t k = 0; k < 300; k++) x[k] = 0.7;
  check_cloud("one place", x, 100, 1e-150);
  check_cloud("one place", x, 100, 1);
  check_cloud("one place", x, 100, 1e150);
}

static void few_points_and_no_reach(void **state) {
  (void)state;
  double x[3 * POINTS];
  cloud(x, 1, 0);
  check_cloud("none", x, 0, 1);
  check_cloud("one", x, 1, 1);
  check_cloud("two", x, 2, 2);
  check_cloud("no reach", x, POINTS, 0);
}

/* The largest doubles, and a stray one that makes the others share a cell. */
static void no_coordinate_is_too_large(void **state) {
  (void)state;
  double x[3 * POINTS];
  cloud(x, 1, 0);
  x[0] = 1.7e308, x[4] = -1.7e308;
  check_cloud("stray", x, POINTS, 0.1);
  cloud(x, 1e308, -0.5e308);
  check_cloud("huge", x, POINTS, 1e150);
  cloud(x, 5e-324, 0);
  check_cloud("tiny", x, 200, 1e-150);
}

/* 1e18 cells of empty space: memory goes with points and pairs. */
static void empty_space_costs_no_memory(void **state) {
  (void)state;
  bench b;
  double x[3 * POINTS];
  const hk_host *host = open_bench(&b, 1);
  cloud(x, 1e6, 0);
  assert_int_equal(hk_cell_list_build(&b.list, host, x, POINTS, 1), HK_OK);
  assert_int_equal(b.list.room, POINTS);
  assert_true(b.list.pairs < POINTS);
  close_bench(&b);
}

/* Rows are made of up to 2048 candidates at once, sorted by one, two or three bytes, and in another way of more. */
static void few_and_many_candidates(void **state) {
  (void)state;
  static const struct {
    size_t n, stride;
    double reach;
  } clouds[] = {{100, 1, 2}, {200, 1, 2}, {2000, 1, 2}, {2049, 1, 2}, {4000, 7, 0.3}, {70000, 997, 0.05}};
  double *x = malloc(3 * 70000 * sizeof *x);
  hk_random_seed(seed, 9);
  for (size_t k = 0; k < 3 * 70000; k++) x[k] = uniform();
  for (size_t k = 0; k < sizeof clouds / sizeof *clouds; k++) {
    bench b;
    const hk_host *host = open_bench(&b, 2);
    assert_int_equal(hk_cell_list_build(&b.list, host, x, clouds[k].n, clouds[k].reach), HK_OK);
    check_rows("many", &b.list, x, clouds[k].n, clouds[k].reach, clouds[k].stride);
    close_bench(&b);
  }
  free(x);
}

/* Where the box has more than four cells a point, cells share numbers, and the nine lanes around a cell may overlap or
 * pass the end of the table: with few points nearly always. Clumps of four in random cells, and on diagonals. */
static void cells_that_share_a_number_add_no_pair(void **state) {
  (void)state;
  double x[3 * 64];
  hk_random_seed(seed, 21);
  for (size_t round = 0; round < 3000; round++) {
    size_t n = 2 + round % 63;
    double size = pow(10, 1 + 4 * uniform()), place[3] = {0};
    for (size_t i = 0; i < n; i++) {
      for (size_t c = 0; c < 3 && i % 4 == 0; c++)
        place[c] = round % 2 && c ? (round % 4 - 2.) * place[0] : size * uniform();
      for (size_t c = 0; c < 3; c++) x[3 * i + c] = place[c] + 2 * uniform();
    }
    check_cloud("shared numbers", x, n, 1);
  }
}

static void any_number_of_threads_gives_the_same_rows(void **state) {
  (void)state;
  enum { MANY = 80000 }; /* three parts of the sort */
  const int threads[] = {1, 2, 7};
  double *x = malloc(3 * MANY * sizeof *x);
  bench b[3];
  hk_random_seed(seed, 3);
  for (size_t k = 0; k < 3 * MANY; k++) x[k] = uniform();
  for (int t = 0; t < 3; t++) {
    const hk_host *host = open_bench(&b[t], threads[t]);
    assert_int_equal(hk_cell_list_build(&b[t].list, host, x, MANY, 0.045), HK_OK);
    assert_memory_equal(b[t].list.row_start, b[0].list.row_start, (MANY + 1) * sizeof(size_t));
    assert_memory_equal(b[t].list.other, b[0].list.other, b[0].list.row_start[MANY] * sizeof(uint32_t));
  }
  assert_true(b[0].list.row_start[MANY] > 20 * MANY);
  for (int t = 0; t < 3; t++) close_bench(&b[t]);
  free(x);
}

/* The second build of the same size asks for nothing; a larger one grows by half at least. */
static void memory_is_kept_and_grows_by_half(void **state) {
  (void)state;
  bench b;
  double x[3 * POINTS];
  const hk_host *host = open_bench(&b, 1);
  cloud(x, 1, 0);
  assert_int_equal(hk_cell_list_build(&b.list, host, x, 1000, 0.1), HK_OK);
  b.shared.allocations_left = 0;
  assert_int_equal(hk_cell_list_build(&b.list, host, x, 1000, 0.1), HK_OK);
  b.shared.allocations_left = -1;
  assert_int_equal(hk_cell_list_build(&b.list, host, x, 1001, 0.1), HK_OK);
  assert_int_equal(b.list.room, 1500);
  check_rows("grown", &b.list, x, 1001, 0.1, 1);
  close_bench(&b);
}

/* The k-th allocation fails, for every k: a status and a message, and the list can be built when there is memory. */
static void without_memory_there_are_no_rows(void **state) {
  (void)state;
  double x[3 * POINTS];
  cloud(x, 1, 0);
  long k = 0;
  for (hk_status status = HK_NO_MEMORY; status != HK_OK; k++) {
    bench b;
    const hk_host *host = open_bench(&b, 1);
    b.shared.allocations_left = k;
    status = hk_cell_list_build(&b.list, host, x, POINTS, 0.1);
    if (status != HK_OK) {
      assert_int_equal(status, HK_NO_MEMORY);
      assert_non_null(strstr(b.error.text, "no memory for the neighbours of"));
      assert_int_equal(b.list.n, 0);
      b.shared.allocations_left = -1;
      assert_int_equal(hk_cell_list_build(&b.list, host, x, POINTS, 0.1), HK_OK);
    }
    check_rows("in the end", &b.list, x, POINTS, 0.1, 1);
    close_bench(&b);
  }
  assert_true(k > 5); /* the count counts */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_clouds_have_the_rows_of_all_pairs),
      cmocka_unit_test(lattices_on_the_borders_of_cells),
      cmocka_unit_test(pairs_a_little_closer_than_the_reach),
      cmocka_unit_test(clusters_far_apart),
      cmocka_unit_test(a_cloud_a_thousand_kilometres_away),
      cmocka_unit_test(lines_and_planes),
      cmocka_unit_test(all_points_in_one),
      cmocka_unit_test(few_points_and_no_reach),
      cmocka_unit_test(no_coordinate_is_too_large),
      cmocka_unit_test(empty_space_costs_no_memory),
      cmocka_unit_test(few_and_many_candidates),
      cmocka_unit_test(cells_that_share_a_number_add_no_pair),
      cmocka_unit_test(any_number_of_threads_gives_the_same_rows),
      cmocka_unit_test(memory_is_kept_and_grows_by_half),
      cmocka_unit_test(without_memory_there_are_no_rows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
