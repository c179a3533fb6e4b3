/* Springs listed at random are put into runs, also where some are missing, and keep their numbers. */
#include "plugins/kit/springs/edge_order.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { PLACES = 200, STEP = 71 /* no divisor in common with the counts below */ };

static const hk_host host = {.allocate = test_allocate, .release = test_release};

/* Springs (i, i + 3) for i < PLACES but those with i % period == 0, in any order, any end first. */
static size_t strew(size_t period, uint32_t pair[PLACES][2], double number[PLACES]) {
  uint32_t low[PLACES];
  size_t count = 0;
  for (uint32_t i = 0; i < PLACES; i++)
    if (i % period) low[count++] = i;
  for (size_t e = 0; e < count; e++) {
    uint32_t i = low[e * STEP % count];
    pair[e][e % 2] = i, pair[e][1 - e % 2] = i + 3;
    number[e] = i;
  }
  return count;
}

static hk_edge_order improved(size_t count, uint32_t pair[PLACES][2], double number[PLACES]) {
  hk_edge_order o = {{count, 2, pair[0]}, {count, number}, {1, number}, {count, number}};
  assert_true(hk_edge_order_improve(&o, &host, PLACES + 3));
  return o;
}

static void runs_go_on_over_missing_springs(void **state) {
  const size_t periods[] = {3, 10, 1000};
  (void)state;
  for (size_t p = 0; p < 3; p++) {
    uint32_t pair[PLACES][2], order[PLACES];
    double number[PLACES];
    size_t count = strew(periods[p], pair, number), places;
    const hk_edge_order given = {{count, 2, pair[0]}, {count, number}, {1, number}, {count, number}};
    hk_edge_order o = improved(count, pair, number);
    for (uint32_t e = 0; e < count; e++) {
      const uint32_t *end = hk_tuple(&o.edges, e);
      assert_true(end[1] == end[0] + 3 && o.k.value[e] == end[0] && o.L.value[e] == end[0]);
      order[e] = e;
    }
    assert_int_equal(hk_edge_run(&o.edges, order, count, &places), count);
    assert_int_equal(places, hk_tuple(&o.edges, (uint32_t)count - 1)[0]); /* from 1 on */
    hk_edge_order_release(&o, &host, &given);
  }
}

/* One spring in two places costs as much in a run as in a list. */
static void runs_end_where_springs_are_rare(void **state) {
  (void)state;
  uint32_t pair[PLACES][2], order[PLACES];
  double number[PLACES];
  size_t count = strew(2, pair, number), places;
  const hk_edge_order given = {{count, 2, pair[0]}, {count, number}, {1, number}, {count, number}};
  hk_edge_order o = improved(count, pair, number);
  for (uint32_t e = 0; e < count; e++) order[e] = e;
  assert_true(hk_edge_run(&o.edges, order, count, &places) <= 2 && places < HK_RUN_MIN);
  hk_edge_order_release(&o, &host, &given);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(runs_go_on_over_missing_springs),
      cmocka_unit_test(runs_end_where_springs_are_rare),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
