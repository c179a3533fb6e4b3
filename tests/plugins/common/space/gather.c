/* Records gathered by rows: joined they are what one loop in the order of the rows would write, whichever body fills a
 * row, in which order, and however often lists were too short. */
#include "plugins/common/space/gather.h"
#include "core/engine/host/host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { ROWS = 500, GRAIN = 7 };

typedef struct bench {
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error;
  hk_gather gather;
  uint32_t factor; /* lengths of rows */
} bench;

static bench *open_bench(int threads) {
  bench *b = calloc(1, sizeof *b);
  assert_non_null(b);
  b->plugin.kind = HK_SERVICE;
  b->shared = (hk_shared){
      .error = &b->error, .threads = hk_threads_create(threads), .allocations_left = -1, .lanes = hk_processor_lanes()};
  b->instance =
      (hk_instance){.host = hk_host_table, .shared = &b->shared, .plugin = &b->plugin, .label = "rows", .where = ""};
  b->gather.record_size = sizeof(uint32_t);
  return b;
}

static void close_bench(bench *b) {
  hk_gather_free(&b->gather, &b->instance.host);
  assert_null(b->instance.blocks);
  hk_threads_destroy(b->shared.threads);
  free(b);
}

/* Row r has some numbers, every tenth none; work k fills row (k * 13) % ROWS, but for every eleventh. */
static uint32_t length(uint32_t r, uint32_t factor) { return r % 10 ? r * factor % 37 : 0; }

static void fill(void *context, size_t begin, size_t end, size_t chunk) {
  bench *b = context;
  for (size_t k = begin; k < end; k++) {
    uint32_t r = (uint32_t)(k * 13 % ROWS);
    if (k % 11 == 0) continue;
    hk_gather_row(&b->gather, chunk, r);
    for (uint32_t q = 0; q < length(r, b->factor); q++) {
      uint32_t *record = hk_gather_add(&b->gather, chunk);
      if (record) *record = r * 100 + q;
    }
  }
}

static hk_status run(bench *b, uint32_t factor) {
  b->factor = factor;
  hk_status status = hk_gather_run(&b->gather, &b->instance.host, ROWS, ROWS, GRAIN, fill, b);
  return status == HK_OK ? hk_gather_join(&b->gather, &b->instance.host) : status;
}

static void check(const bench *b) {
  const uint32_t *record = b->gather.record;
  bool filled[ROWS] = {false};
  size_t k = 0;
  for (uint32_t w = 0; w < ROWS; w++) filled[w * 13 % ROWS] = w % 11 != 0;
  for (uint32_t r = 0; r < ROWS; r++)
    for (uint32_t q = 0; filled[r] && q < length(r, b->factor); q++) assert_int_equal(record[k++], r * 100 + q);
  assert_int_equal(k, b->gather.count);
}

static void rows_are_joined_in_their_order(void **state) {
  (void)state;
  for (int threads = 1; threads <= 3; threads++) {
    bench *b = open_bench(threads);
    for (uint32_t factor = 1; factor < 20; factor += 3) {
      assert_int_equal(run(b, factor), HK_OK);
      check(b);
    }
    close_bench(b);
  }
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  bench *b = open_bench(2);
  int k = 0;
  for (hk_status status = HK_NO_MEMORY; status != HK_OK; k++) {
    b->shared.allocations_left = k;
    status = run(b, 5);
    assert_true(status == HK_OK || status == HK_NO_MEMORY);
    assert_true(status == HK_OK || b->gather.count == 0);
  }
  assert_true(k > 4);
  check(b);
  close_bench(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_are_joined_in_their_order),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
