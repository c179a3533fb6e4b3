/* Searches in the tree against loops over all boxes, without a tolerance: after building, after boxes moved and the
 * tree was fitted, and after it was built anew. */
#include "plugins/common/space/bvh.h"
#include "core/engine/base/base.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_status fail_with(const hk_host *host, hk_status status, const char *format, ...) {
  (void)host, (void)format;
  return status;
}

/* The last chunk first: the order of chunks leaves no trace. */
static void parallel_for(const hk_host *h, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                         void *context) {
  (void)h;
  for (size_t chunk = (count + grain - 1) / grain; chunk-- > 0;)
    body(context, chunk * grain, count < (chunk + 1) * grain ? count : (chunk + 1) * grain, chunk);
}

static const hk_host host = {
    .allocate = test_allocate, .release = test_release, .fail = fail_with, .parallel_for = parallel_for};

enum { MOST = 3000 };
static hk_box box[MOST];
static uint64_t seed[4];

static double uniform(void) { return hk_random_uniform(seed); }

/* Small boxes in a cube; some in the same place, some without extent. */
static void scatter(size_t count) {
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      double at = k % 11 == 0 ? 0.5 : uniform(), half = k % 5 == 0 ? 0 : 0.02 * uniform();
      box[k].low[c] = at - half;
      box[k].high[c] = at + half;
    }
}

static void shift(size_t count, double by) {
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      double d = by * (2 * uniform() - 1);
      box[k].low[c] += d;
      box[k].high[c] += d;
    }
}

typedef struct seen {
  char item[MOST];
} seen;

static void see(void *context, uint32_t item) {
  seen *s = context;
  assert_int_equal(s->item[item], 0); /* once */
  s->item[item] = 1;
}

static double away2(const double p[3], const hk_box *b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    double d = fmax(0, fmax(b->low[c] - p[c], p[c] - b->high[c]));
    sum += d * d;
  }
  return sum;
}

static const double *from;

static double box_distance2(void *context, uint32_t item, double best2) {
  (void)best2;
  ++*(size_t *)context;
  return away2(from, &box[item]);
}

static void compare(const hk_bvh *tree, size_t count) {
  static seen s;
  for (int k = 0; k < 50; k++) {
    hk_box with;
    double p[3];
    for (int c = 0; c < 3; c++) p[c] = with.low[c] = uniform(), with.high[c] = with.low[c] + 0.2 * uniform();
    memset(&s, 0, sizeof s);
    hk_bvh_overlaps(tree, box, &with, see, &s);
    double best2 = INFINITY;
    for (size_t i = 0; i < count; i++) {
      assert_int_equal(s.item[i], hk_box_overlap(&box[i], &with));
      best2 = fmin(best2, away2(p, &box[i]));
    }
    size_t asked = 0;
    from = p;
    assert_true(hk_bvh_nearest(tree, p, INFINITY, box_distance2, &asked) == best2);
    assert_true(count < 100 || asked < count / 2);
  }
}

static void searches_find_what_loops_find(void **state) {
  (void)state;
  static const size_t counts[] = {0, 1, 2, 4, 5, 9, 100, MOST};
  hk_random_seed(seed, 3);
  for (size_t q = 0; q < sizeof counts / sizeof *counts; q++) {
    hk_bvh tree = {0};
    scatter(counts[q]);
    assert_int_equal(hk_bvh_build(&tree, &host, box, counts[q]), HK_OK);
    compare(&tree, counts[q]);
    for (int k = 0; k < 3; k++) {
      shift(counts[q], 0.05);
      hk_bvh_refit(&tree, &host, box);
      compare(&tree, counts[q]);
    }
    double fitted = hk_bvh_cost(&tree);
    assert_int_equal(hk_bvh_build(&tree, &host, box, counts[q]), HK_OK);
    compare(&tree, counts[q]);
    assert_true(counts[q] < 1000 || hk_bvh_cost(&tree) < fitted); /* a few boxes are as good in any order */
    if (counts[q] == MOST) print_message("cost %.1f fitted, %.1f built anew\n", fitted, hk_bvh_cost(&tree));
    hk_bvh_free(&tree, &host);
  }
}

/* Boxes that are all the same cannot be told apart by a split; the tree is as deep as others. */
static void coincident_boxes_are_no_worse(void **state) {
  (void)state;
  hk_bvh tree = {0};
  memset(box, 0, sizeof box);
  assert_int_equal(hk_bvh_build(&tree, &host, box, MOST), HK_OK);
  static seen s;
  memset(&s, 0, sizeof s);
  hk_bvh_overlaps(&tree, box, &box[0], see, &s);
  for (size_t i = 0; i < MOST; i++) assert_int_equal(s.item[i], 1);
  hk_bvh_free(&tree, &host);
}

static void *refuse(const hk_host *h, size_t bytes) {
  (void)h, (void)bytes;
  return NULL;
}

static void no_memory_leaves_an_empty_tree(void **state) {
  (void)state;
  hk_host poor = host;
  hk_bvh tree = {0};
  poor.allocate = refuse;
  assert_int_equal(hk_bvh_build(&tree, &poor, box, 10), HK_NO_MEMORY);
  assert_true(tree.items == 0 && tree.nodes == 0);
  size_t asked = 0;
  assert_true(hk_bvh_nearest(&tree, box[0].low, INFINITY, box_distance2, &asked) == INFINITY && asked == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(searches_find_what_loops_find),
      cmocka_unit_test(coincident_boxes_are_no_worse),
      cmocka_unit_test(no_memory_leaves_an_empty_tree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
