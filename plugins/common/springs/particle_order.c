/* Clusters are grown breadth first over the edges: a cluster takes the neighbours of its particles until it is full;
 * the remaining neighbours at its border are queued as seeds of further clusters. */
#include "plugins/common/springs/particle_order.h"

enum { CLUSTER = 256 }; /* particles whose x, v and F, some 20 kB, fit the first-level cache */

typedef struct growth {
  size_t n, placed, seeds, next_seed;
  uint32_t *start, *neighbour; /* n + 2 and 2 x edges: compressed rows */
  uint32_t *order, *seed;      /* n each: particles by place; queue of particles at borders */
  bool *queued;                /* n: the particle is in `seed` */
  uint32_t *place;             /* UINT32_MAX: no place yet */
} growth;

static void list_neighbours(growth *g, const hk_tuples *edges) {
  for (size_t e = 0; e < edges->count; e++)
    g->start[hk_tuple(edges, e)[0] + 2]++, g->start[hk_tuple(edges, e)[1] + 2]++;
  for (size_t i = 2; i < g->n + 2; i++) g->start[i] += g->start[i - 1];
  for (size_t e = 0; e < edges->count; e++) {
    uint32_t i = hk_tuple(edges, e)[0], j = hk_tuple(edges, e)[1];
    g->neighbour[g->start[i + 1]++] = j;
    g->neighbour[g->start[j + 1]++] = i;
  }
}

static void place_particle(growth *g, uint32_t particle) {
  g->place[particle] = (uint32_t)g->placed;
  g->order[g->placed++] = particle;
}

static void grow_cluster(growth *g, uint32_t from) {
  size_t head = g->placed, full = g->placed + CLUSTER;
  place_particle(g, from);
  for (; head < g->placed; head++)
    for (uint32_t k = g->start[g->order[head]]; k < g->start[g->order[head] + 1]; k++) {
      uint32_t other = g->neighbour[k];
      if (g->place[other] != UINT32_MAX) continue;
      if (g->placed < full) {
        place_particle(g, other);
      } else if (!g->queued[other]) {
        g->queued[other] = true;
        g->seed[g->seeds++] = other;
      }
    }
}

bool hk_particle_order(const hk_host *host, size_t n, const hk_tuples *edges, uint32_t *place) {
  growth g = {.n = n, .place = place};
  g.start = host->allocate(host, (n + 2) * sizeof *g.start);
  g.neighbour = host->allocate(host, (2 * edges->count + 1) * sizeof *g.neighbour);
  g.order = host->allocate(host, (n + 1) * sizeof *g.order);
  g.seed = host->allocate(host, (n + 1) * sizeof *g.seed);
  g.queued = host->allocate(host, (n + 1) * sizeof *g.queued);
  bool fine = g.start && g.neighbour && g.order && g.seed && g.queued;
  if (fine) {
    list_neighbours(&g, edges);
    for (size_t i = 0; i < n; i++) place[i] = UINT32_MAX;
    for (uint32_t i = 0; i < n; i++) {
      if (place[i] == UINT32_MAX) grow_cluster(&g, i);
      for (; g.next_seed < g.seeds; g.next_seed++)
        if (place[g.seed[g.next_seed]] == UINT32_MAX) grow_cluster(&g, g.seed[g.next_seed]);
    }
  }
  host->release(host, g.start);
  host->release(host, g.neighbour);
  host->release(host, g.order);
  host->release(host, g.seed);
  host->release(host, g.queued);
  return fine;
}
