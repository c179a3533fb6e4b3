/* hk_array_move against the straightforward loop on a copy: random deaths, to memory apart, in place, and to a place
 * that overlaps further down or further up, where some items move down and others up. */
#include "core/engine/base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 300, ROOM = 3 * MOST };

typedef struct item {
  uint32_t a, b, c;
} item;

static void try_one(uint64_t random[4], size_t n, double dying, ptrdiff_t shift) {
  item memory[ROOM], wanted[ROOM], *from = memory + MOST, *to = from + shift;
  uint32_t map[MOST] = {0}, next = 0;
  for (uint32_t k = 0; k < ROOM; k++) memory[k] = wanted[k] = (item){k, k + 1, ~k};
  for (size_t i = 0; i < n; i++) map[i] = hk_random_uniform(random) < dying ? UINT32_MAX : next++;
  for (size_t i = 0; i < n; i++)
    if (map[i] != UINT32_MAX) wanted[MOST + shift + (ptrdiff_t)map[i]] = from[i];
  assert_int_equal(hk_array_move(to, from, sizeof *to, map, n), next);
  if (next) assert_memory_equal(to, wanted + MOST + shift, next * sizeof *to);
  for (ptrdiff_t k = 0; k < ROOM; k++) { /* what is neither is as it was */
    bool touched = (k >= MOST && k < MOST + (ptrdiff_t)n) || (k >= MOST + shift && k < MOST + shift + (ptrdiff_t)next);
    if (!touched) assert_true(memory[k].a == (uint32_t)k);
  }
}

static void moves_are_those_of_the_plain_loop(void **state) {
  (void)state;
  uint64_t random[4];
  hk_random_seed(random, 5);
  for (int k = 0; k < 20000; k++) {
    size_t n = (size_t)(hk_random_uniform(random) * MOST);
    double dying = pow(hk_random_uniform(random), 3);
    ptrdiff_t shift = (ptrdiff_t)((2 * hk_random_uniform(random) - 1) * MOST);
    try_one(random, n, dying, k % 3 ? shift / (1 + k % 20) : 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(moves_are_those_of_the_plain_loop)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
