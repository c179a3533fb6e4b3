/* Rows in periodic boxes against a plain search over all pairs and all images, number by number: cubes, sheets and thin
 * boxes, boxes shorter than the reach, along every choice of axes, for points far outside of the box, and 1 to 3
 * threads. */
#include "plugins/common/space/images.h"
#include "core/engine/host/host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { POINTS = 400 };

typedef struct bench {
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error;
  hk_cell_list list;
  hk_images images;
} bench;

static const hk_host *open_bench(bench *b, int threads) {
  *b = (bench){.plugin = {.kind = HK_SERVICE}};
  b->shared = (hk_shared){.error = &b->error, .threads = hk_threads_create(threads), .allocations_left = -1};
  assert_non_null(b->shared.threads);
  b->instance =
      (hk_instance){.host = hk_host_table, .shared = &b->shared, .plugin = &b->plugin, .label = "images", .where = ""};
  return &b->instance.host;
}

static void close_bench(bench *b) {
  hk_memory_clear(&b->instance.blocks);
  hk_threads_destroy(b->shared.threads);
}

/* The least distance of i and the images of j, squared: of each axis, the least of many images. */
static double nearest2(const hk_periodic_box *box, const double *a, const double *b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double length = box->high[c] - box->low[c], least = fabs(b[c] - a[c]);
    for (int k = -9; k <= 9 && box->repeats[c]; k++) least = fmin(least, fabs(b[c] - a[c] + k * length));
    sum += least * least;
  }
  return sum;
}

static bool near[POINTS][POINTS];

static void check_rows(const char *what, const bench *b) {
  const hk_cell_list *l = &b->list;
  for (size_t i = 0; i < POINTS; i++) {
    size_t k = l->row_start[i];
    for (size_t j = 0; j < POINTS; j++) {
      if (!near[i][j]) continue;
      if (k == l->row_start[i + 1] || l->other[k] != j) fail_msg("%s: row %zu has not %zu where it should", what, i, j);
      k++;
    }
    if (k != l->row_start[i + 1]) fail_msg("%s: row %zu has %zu too many", what, i, l->row_start[i + 1] - k);
  }
}

static void check(const char *what, const hk_periodic_box *box, const double *x, double reach) {
  for (size_t i = 0; i < POINTS; i++)
    for (size_t j = 0; j <= i; j++)
      near[i][j] = near[j][i] = j != i && nearest2(box, x + 3 * i, x + 3 * j) < reach * reach;
  for (int threads = 1; threads <= 3; threads++) {
    bench b;
    const hk_host *host = open_bench(&b, threads);
    for (int again = 0; again < 2; again++) { /* also in memory that was used before */
      hk_status status = hk_images_rows(&b.images, &b.list, host, box, x, POINTS, again ? reach : reach / 3);
      assert_int_equal(status, HK_OK);
    }
    check_rows(what, &b);
    close_bench(&b);
  }
}

/* In the box, or up to `far` of its lengths away. */
static void scatter(const hk_periodic_box *box, double far, double x[3 * POINTS]) {
  uint64_t state[4];
  hk_random_seed(state, 5);
  for (size_t e = 0; e < 3 * POINTS; e++) {
    double length = box->high[e % 3] - box->low[e % 3];
    x[e] = box->low[e % 3] + length * hk_random_uniform(state);
    if (box->repeats[e % 3]) x[e] += length * floor(far * (2 * hk_random_uniform(state) - 1));
  }
}

static void rows_are_those_of_a_search_over_images(void **state) {
  (void)state;
  static const struct {
    const char *what;
    hk_periodic_box box;
    double reach;
  } cases[] = {
      {"cube", {{0, 0, 0}, {1, 1, 1}, {true, true, true}}, 0.2},
      {"cube with the longest reach", {{0, 0, 0}, {1, 1, 1}, {true, true, true}}, 0.5},
      {"cube around the origin", {{-1, -1, -1}, {1, 1, 1}, {true, true, true}}, 0.31},
      {"box", {{3, -7, 0.5}, {4, -4, 2.5}, {true, true, true}}, 0.4},
      {"sheet", {{0, 0, 0}, {1, 1, 0}, {true, true, false}}, 0.1},
      {"tube", {{0, 0, 0}, {1, 5, 5}, {true, false, false}}, 0.45},
      {"thin box, open above and below", {{0, 0, 0}, {0.3, 4, 9}, {true, true, false}}, 0.2},
      {"shorter than the reach", {{0, 0, 0}, {0.2, 1, 3}, {true, true, true}}, 0.3},
      {"much shorter than the reach", {{0, 0, 0}, {0.1, 0.1, 4}, {true, true, true}}, 0.7},
  };
  double x[3 * POINTS];
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    for (int far = 0; far < 2; far++) {
      scatter(&cases[k].box, 4 * far, x);
      check(cases[k].what, &cases[k].box, x, cases[k].reach);
    }
}

/* On faces, edges and corners, and a particle alone. */
static void places_on_faces_are_in_the_box_once(void **state) {
  (void)state;
  const hk_periodic_box box = {{0, 0, 0}, {1, 1, 1}, {true, true, true}};
  double x[3 * POINTS];
  for (size_t e = 0; e < 3 * POINTS; e++) x[e] = (double)(e * 7 % 5) / 4;
  check("lattice on the faces", &box, x, 0.3);
  bench b;
  const hk_host *host = open_bench(&b, 1);
  assert_int_equal(hk_images_rows(&b.images, &b.list, host, &box, x, 1, 2), HK_OK);
  assert_int_equal(b.list.row_start[1], 0);
  close_bench(&b);
}

/* |d| <= length / 2, and the opposite of the opposite. */
static void the_nearest_image_is_the_nearest_either_way(void **state) {
  (void)state;
  const hk_periodic_box box = {{0, -1, 2}, {1, 2, 9}, {true, true, false}};
  uint64_t seed[4];
  hk_random_seed(seed, 6);
  for (int k = 0; k < 1000; k++) {
    double d[3], other[3], from[3] = {0}, to[3];
    for (int c = 0; c < 3; c++) d[c] = to[c] = 16 * (hk_random_uniform(seed) - 0.5), other[c] = -d[c];
    hk_nearest_image(&box, d);
    hk_nearest_image(&box, other);
    double found = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    assert_true(fabs(found - nearest2(&box, from, to)) < 1e-12 * found); /* rounding of 8 m in 1 m */
    for (int c = 0; c < 3; c++) assert_true(d[c] == -other[c]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_are_those_of_a_search_over_images),
      cmocka_unit_test(places_on_faces_are_in_the_box_once),
      cmocka_unit_test(the_nearest_image_is_the_nearest_either_way),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
