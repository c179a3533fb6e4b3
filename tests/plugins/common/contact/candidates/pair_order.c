/* Pairs in order against qsort: many of few particles, so that most are there more than once and share their first
 * particle; all of one bucket; none. */
#include "plugins/common/contact/candidates/pair_order.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_status resize(const hk_host *host, hk_array *field, size_t count) {
  (void)host;
  field->item = realloc(field->item, (count + 1) * 8);
  field->count = count;
  return field->item ? HK_OK : HK_NO_MEMORY;
}

/* Chunks in the other order: none may hang on another. */
static void backwards(const hk_host *host, size_t count, size_t grain,
                      void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context) {
  (void)host;
  for (size_t chunk = (count + grain - 1) / grain; chunk-- > 0;)
    body(context, chunk * grain, (chunk + 1) * grain < count ? (chunk + 1) * grain : count, chunk);
}

static const hk_host host = {.resize = resize, .parallel_for = backwards};

static int by_order(const void *a, const void *b) { return hk_pair_compare(a, b); }

static uint64_t seed = 1;

static uint32_t draw(uint32_t below) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((seed >> 33) % below);
}

static void check(hk_pair_sorter *s, size_t count, uint32_t n, uint32_t first) {
  hk_feature_pair *pair = calloc(count + 1, sizeof *pair), *sorted = calloc(count + 1, sizeof *sorted);
  size_t kept = SIZE_MAX, unique = 0;
  for (size_t k = 0; k < count; k++) {
    pair[k].kind = draw(2) ? HK_EDGE_EDGE : HK_POINT_TRIANGLE;
    for (int c = 0; c < 4; c++) pair[k].vertex[c] = draw(c ? n : first);
  }
  if (count) memcpy(sorted, pair, count * sizeof *pair);
  qsort(sorted, count, sizeof *sorted, by_order);
  for (size_t k = 0; k < count; k++)
    if (k == 0 || by_order(&sorted[k - 1], &sorted[k]) != 0) sorted[unique++] = sorted[k];
  assert_true(hk_pairs_sort(s, &host, pair, count, n, &kept) == HK_OK);
  assert_true(kept == unique);
  for (size_t k = 0; k < kept; k++) assert_true(by_order(&pair[((const uint32_t *)s->order.item)[k]], &sorted[k]) == 0);
  free(pair), free(sorted);
}

static void pairs_rise_and_are_there_once(void **state) {
  (void)state;
  hk_pair_sorter s = {0};
  for (uint32_t n = 1; n < 400; n = 3 * n + 2)
    for (size_t count = 0; count < 20000; count = 3 * count + 1) {
      check(&s, count, n, n);
      check(&s, count, n, 1);
    }
  free(s.start.item), free(s.order.item), free(s.spare.item);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(pairs_rise_and_are_there_once)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
