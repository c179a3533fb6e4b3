/* The sum over pairs of bodies that attract each other, where a pair's root serves both of them. The bodies are divided
 * into teams, and teams meet as those of a tournament do (Kirkman's rounds): in each round every team has one opponent,
 * so that the meetings of a round write to different sums and run at the same time. The number of teams follows from
 * that of bodies, and the sums of a body are added in the order of rounds, so that they have the same bits for any
 * number of threads. Within teams, sums go over tiles of HK_GRAVITY_TILE bodies, whose sums stay in the cache. */
#include "plugins/common/gravity/mutual_sum.h"

#include <string.h>

enum { BLOCK = HK_GRAVITY_BLOCK, TILE = HK_GRAVITY_TILE, FEWEST = 48, TEAMS = 64 };

typedef struct tournament {
  hk_gravity_bodies *g;
  size_t bodies;             /* with those of mass 0 that complete the last block */
  size_t tiles, size, teams; /* tiles; tiles of a team */
  size_t round, seats;       /* of 0 to seats - 2; teams, one of which may have nobody */
} tournament;

/* Bodies of mass 0, apart from all others, in what is left of the last block. */
static size_t complete_block(hk_gravity_bodies *g) {
  size_t bodies = (g->count + BLOCK - 1) / BLOCK * BLOCK;
  for (size_t k = g->count; k < bodies; k++) {
    g->at.x[k] = g->at.x[0] + 3 + (double)(k - g->count);
    g->at.y[k] = g->at.y[0];
    g->at.z[k] = g->at.z[0];
    g->at.m[k] = 0;
  }
  return bodies;
}

static size_t smaller(size_t a, size_t b) { return a < b ? a : b; }

static void meet_tiles(const tournament *t, size_t p, size_t q) {
  const hk_gravity_bodies *g = t->g;
  const size_t one[2] = {p * TILE, smaller((p + 1) * TILE, t->bodies)};
  const size_t two[2] = {q * TILE, smaller((q + 1) * TILE, t->bodies)};
  g->path->mutual(&g->at, one, two, g->eps2, g->pull);
}

static void meet(const tournament *t, size_t one, size_t two) {
  size_t end = smaller((one + 1) * t->size, t->tiles), last = smaller((two + 1) * t->size, t->tiles);
  for (size_t p = one * t->size; p < end; p++)
    for (size_t q = one == two ? p : two * t->size; q < last; q++) meet_tiles(t, p, q);
}

static void meet_themselves(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t team = begin; team < end; team++) meet(context, team, team);
}

/* One seat stays, the others move round a circle, and who sit opposite each other meet. */
static void meet_opponents(void *context, size_t begin, size_t end, size_t chunk) {
  const tournament *t = context;
  size_t circle = t->seats - 1;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t one = (t->round + k) % circle, two = k ? (t->round + circle - k) % circle : circle;
    if (one < t->teams && two < t->teams) meet(t, smaller(one, two), one < two ? two : one);
  }
}

static bool is_finite(const hk_gravity_bodies *g) {
  double all = 0;
  for (size_t c = 0; c < 3; c++)
    for (size_t k = 0; k < g->count; k++) all += 0 * g->pull[c][k];
  return all == 0;
}

bool hk_mutual_pull(hk_gravity_bodies *g) {
  if (!g->mutual || g->sources < g->count || g->count < FEWEST) return false;
  tournament t = {.g = g, .bodies = complete_block(g)};
  t.tiles = (t.bodies + TILE - 1) / TILE;
  t.size = (t.tiles + TEAMS - 1) / TEAMS;
  t.teams = (t.tiles + t.size - 1) / t.size;
  t.seats = t.teams + t.teams % 2;
  for (size_t c = 0; c < 3; c++) memset(g->pull[c], 0, t.bodies * sizeof *g->pull[c]);
  g->host->parallel_for(g->host, t.teams, 1, meet_themselves, &t);
  for (t.round = 0; t.round + 1 < t.seats; t.round++)
    g->host->parallel_for(g->host, t.seats / 2, 1, meet_opponents, &t);
  return is_finite(g);
}
