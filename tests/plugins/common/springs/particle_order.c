/* The order is a permutation that brings joined particles together. */
#include "plugins/common/springs/particle_order.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct limited_host {
  hk_host host; /* first member */
  long left;    /* allocations that succeed; negative: all */
  long held;
} limited_host;

static void *allocate(const hk_host *host, size_t bytes) {
  limited_host *l = (limited_host *)(uintptr_t)host;
  if (l->left == 0) return NULL;
  l->left--;
  l->held++;
  return calloc(1, bytes);
}

static void release(const hk_host *host, void *memory) {
  if (memory) ((limited_host *)(uintptr_t)host)->held--;
  free(memory);
}

static limited_host host_with(long allocations) {
  return (limited_host){.host = {.abi = HK_ABI, .allocate = allocate, .release = release}, .left = allocations};
}

enum { SIDE = 64, N = SIDE * SIDE };

/* A grid whose ids are permuted by a stride that is prime to 64 x 64. */
static uint32_t shuffled(size_t at) { return (uint32_t)(at * 2741 % N); }

static size_t grid(uint32_t (*edge)[2]) {
  size_t count = 0;
  for (size_t k = 0; k < N; k++) {
    if (k % SIDE + 1 < SIDE) edge[count][0] = shuffled(k), edge[count++][1] = shuffled(k + 1);
    if (k + SIDE < N) edge[count][0] = shuffled(k), edge[count++][1] = shuffled(k + SIDE);
  }
  return count;
}

static void check_permutation(const uint32_t *place, size_t n) {
  bool *seen = calloc(n, sizeof *seen);
  for (size_t i = 0; i < n; i++) {
    assert_true(place[i] < n && !seen[place[i]]);
    seen[place[i]] = true;
  }
  free(seen);
}

static size_t together(const uint32_t *place, const hk_tuples *edges) { /* edges within 256 places */
  size_t near = 0;
  for (size_t e = 0; e < edges->count; e++)
    near += labs((long)place[hk_tuple(edges, e)[0]] - (long)place[hk_tuple(edges, e)[1]]) < 256;
  return near;
}

/* A compact cluster of 256 on a grid is some 16 x 16 with 32 edges of its 512 across the border; grown ones are ragged
 * and leave remainders, so half as many again and more are allowed. By index, 256/(N/2) = 12 % would be so near. */
static void joined_particles_come_together(void **state) {
  (void)state;
  uint32_t(*edge)[2] = malloc(2 * N * sizeof *edge), *place = malloc(N * sizeof *place);
  hk_tuples edges = {grid(edge), 2, &edge[0][0]};
  limited_host host = host_with(-1);
  assert_true(hk_particle_order(&host.host, N, &edges, place));
  check_permutation(place, N);
  assert_true(together(place, &edges) > edges.count * 4 / 5);
  assert_true(host.held == 0);
  free(edge);
  free(place);
}

static void particles_without_edges_have_places_too(void **state) {
  (void)state;
  uint32_t place[1000];
  const uint32_t pair[3][2] = {{999, 0}, {0, 500}, {500, 999}};
  hk_tuples edges = {3, 2, &pair[0][0]}, none = {0, 2, NULL};
  limited_host host = host_with(-1);
  assert_true(hk_particle_order(&host.host, 1000, &edges, place));
  check_permutation(place, 1000);
  assert_true(place[0] < 3 && place[999] < 3 && place[500] < 3);
  assert_true(hk_particle_order(&host.host, 1000, &none, place));
  for (uint32_t i = 0; i < 1000; i++) assert_int_equal(place[i], i);
}

static void no_memory_is_told_and_nothing_leaks(void **state) {
  (void)state;
  uint32_t place[4];
  const uint32_t pair[2][2] = {{0, 1}, {3, 2}};
  hk_tuples edges = {2, 2, &pair[0][0]};
  for (long k = 0; k <= 5; k++) {
    limited_host host = host_with(k);
    assert_true(hk_particle_order(&host.host, 4, &edges, place) == (k == 5));
    assert_true(host.held == 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(joined_particles_come_together),
      cmocka_unit_test(particles_without_edges_have_places_too),
      cmocka_unit_test(no_memory_is_told_and_nothing_leaks),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
