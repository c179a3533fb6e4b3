/* Sides of the same two particles become neighbours in a sorted list. */
#include "plugins/common/snapshot/border.h"

#include <stdlib.h>

static int by_ends(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

static uint64_t side_of(uint32_t a, uint32_t b) { return a > b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a; }

static hk_status make_room(hk_border *b, const hk_host *host, size_t sides) {
  if (sides < b->room) return HK_OK;
  host->release(host, b->side);
  b->room = sides + sides / 2 + 1;
  b->side = host->allocate(host, b->room * sizeof *b->side);
  if (b->side) return HK_OK;
  b->room = b->count = 0;
  return host->fail(host, HK_NO_MEMORY, "no memory for the border of %zu triangles", sides / 3);
}

/* Keeps those that stand alone in the sorted list. */
static size_t keep_single(uint64_t *side, size_t count) {
  size_t kept = 0;
  for (size_t k = 0, next; k < count; k = next) {
    for (next = k + 1; next < count && side[next] == side[k];) next++;
    if (next == k + 1) side[kept++] = side[k];
  }
  return kept;
}

hk_status hk_border_follow(hk_border *b, const hk_host *host, const hk_snapshot3d *s) {
  if (b->side && b->topology == s->topology) return HK_OK;
  hk_status status = make_room(b, host, 3 * s->cloth);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < s->cloth; k++)
    for (int i = 0; i < 3; i++) b->side[3 * k + (size_t)i] = side_of(s->triangle[k][i], s->triangle[k][(i + 1) % 3]);
  qsort(b->side, 3 * s->cloth, sizeof *b->side, by_ends);
  b->count = keep_single(b->side, 3 * s->cloth);
  b->topology = s->topology;
  return HK_OK;
}

void hk_border_free(hk_border *b, const hk_host *host) {
  host->release(host, b->side);
  *b = (hk_border){0};
}
