/* Corners are sorted by particle by counting. Every particle then sums its own loads, in any thread. */
#include "plugins/common/elements/corner_sums.h"

enum { GRAIN = 2048 }; /* particles of a chunk, some 20 us */

hk_status hk_corner_sums_sort(hk_corner_sums *s, const hk_host *host, size_t n, const hk_tuples *node) {
  size_t corners = node->arity * node->count;
  host->release(host, s->first);
  host->release(host, s->corner);
  s->first = host->allocate(host, (n + 2) * sizeof *s->first);
  s->corner = host->allocate(host, (corners + 1) * sizeof *s->corner);
  if (!s->first || !s->corner)
    return host->fail(host, HK_NO_MEMORY, "no memory for the corners of %zu elements", node->count);
  for (size_t c = 0; c < corners; c++) s->first[node->index[c] + 2]++;
  for (size_t i = 2; i < n + 2; i++) s->first[i] += s->first[i - 1];
  for (size_t c = 0; c < corners; c++) s->corner[s->first[node->index[c] + 1]++] = (uint32_t)c;
  return HK_OK;
}

typedef struct task {
  const hk_corner_sums *sums;
  const double (*load)[3];
  double *F;
} task;

static void add_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const uint32_t *corner = t->sums->corner;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    double *F = t->F + 3 * i, x = F[0], y = F[1], z = F[2];
    for (size_t c = t->sums->first[i]; c < t->sums->first[i + 1]; c++) {
      const double *load = t->load[corner[c]];
      x += load[0], y += load[1], z += load[2];
    }
    F[0] = x, F[1] = y, F[2] = z;
  }
}

void hk_corner_sums_add(const hk_corner_sums *s, const hk_host *host, size_t n, const double (*load)[3], double *F) {
  task t = {s, load, F};
  host->parallel_for(host, n, GRAIN, add_chunk, &t);
}
