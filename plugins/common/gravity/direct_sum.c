/* The sum over all pairs, in blocks of targets. */
#include "plugins/common/gravity/direct_sum.h"
#include "plugins/common/gravity/mutual_sum.h"

#include <string.h>

enum {
  BLOCK = HK_GRAVITY_BLOCK,
  CHUNK_PAIRS = 1 << 16, /* some 20 us and more: far above the cost of handing it to a thread */
  CHUNK_BODIES = 4096
};

/* ---- loops over blocks of targets ---- */

/* Targets [first, first + count), all of which attract or none, and their sources [begin, end). */
typedef struct block {
  size_t first, count, begin, end;
} block;

static size_t blocks_of(size_t bodies) { return (bodies + BLOCK - 1) / BLOCK; }

static block block_at(const hk_gravity_bodies *g, size_t index) {
  size_t attracting = blocks_of(g->sources);
  bool attracts = index < attracting;
  size_t first = attracts ? index * BLOCK : g->sources + (index - attracting) * BLOCK;
  size_t left = (attracts ? g->sources : g->count) - first;
  return (block){first, left < BLOCK ? left : BLOCK, attracts && !g->mutual ? g->sources : 0,
                 attracts ? g->count : g->sources};
}

typedef struct task {
  hk_gravity_bodies *g;
  double G, *out;
} task;

static size_t over_blocks(task *t, void (*body)(void *, size_t, size_t, size_t)) {
  const hk_gravity_bodies *g = t->g;
  size_t blocks = blocks_of(g->sources) + blocks_of(g->count - g->sources);
  size_t grain = g->count ? CHUNK_PAIRS / BLOCK / g->count + 1 : 1;
  g->host->parallel_for(g->host, blocks, grain, body, t);
  return blocks;
}

/* ---- forces ---- */

/* Where an estimate leaves the range of floats, roots do not. */
static bool is_finite(const hk_pull *sum, size_t count) {
  double all = 0;
  for (size_t l = 0; l < count; l++) all += 0 * (sum->a[0][l] + sum->a[1][l] + sum->a[2][l]);
  return all == 0;
}

/* 1 + the first body of the block that by its sums is at the place of another one; 0: none. With softening 0 a body
 * meets itself at its place, and nobody else. (Where something is not finite, it does not.) */
static size_t coinciding(const hk_gravity_bodies *g, const block *b, const hk_pull *sum) {
  for (size_t l = 0; l < b->count && !(g->eps2 > 0); l++)
    if (sum->zeros[l] > (b->first + l >= b->begin && b->first + l < b->end)) return 1 + b->first + l;
  return 0;
}

/* The sums of a block, whatever the range of the processor's estimates. */
static void pull_of(const hk_gravity_bodies *g, const block *b, hk_pull *sum) {
  hk_targets at;
  *sum = (hk_pull){0};
  hk_gravity_targets(g, b->first, b->count, &at);
  g->path->pull(&g->at, b->begin, b->end, &at, g->eps2, sum);
  if (is_finite(sum, b->count)) return;
  *sum = (hk_pull){0};
  hk_gravity_path_of(2)->pull(&g->at, b->begin, b->end, &at, g->eps2, sum);
}

/* The force m a for a host that multiplies by 1/m, which is off by a part of `off`: rounding makes of that a part which
 * is another one from one range of numbers to the next, and so another one in each component. Such a force is turned a
 * little, always the same way at a place, and orbits gain or lose energy and angular momentum with time, where
 * roundings without a bias have them walk at random. */
static double force_for(double a, double m, double off) {
  double F = m * a, rest = fma(m, a, -F);
  return F + (rest - F * off);
}

static double inverse_off(double m) {
  double off = fma(1 / m, m, -1);
  return fabs(off) < 1 ? off : 0; /* of no mass, or hardly any, the inverse is none */
}

static void add_force(const task *t, size_t k, const double a[3]) {
  const hk_gravity_bodies *g = t->g;
  double per_mass = t->G * (g->scale * g->scale), m = g->at.m[k], off = inverse_off(m);
  for (size_t c = 0; c < 3; c++) t->out[3 * (size_t)g->order[k] + c] += force_for(per_mass * a[c], m, off);
}

static size_t add_pull(const task *t, const block *b) {
  hk_gravity_bodies *g = t->g;
  hk_pull sum;
  pull_of(g, b, &sum);
  for (size_t l = 0; l < b->count; l++)
    add_force(t, b->first + l, (const double[]){sum.a[0][l], sum.a[1][l], sum.a[2][l]});
  return coinciding(g, b, &sum);
}

static void force_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  size_t met = 0;
  for (size_t k = begin; k < end; k++) {
    block b = block_at(t->g, k);
    size_t here = add_pull(t, &b);
    if (met == 0) met = here;
  }
  t->g->part[chunk] = (double)met;
}

static void mutual_forces(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  double *const *a = t->g->pull;
  (void)chunk;
  for (size_t k = begin; k < end; k++) add_force(t, k, (const double[]){a[0][k], a[1][k], a[2][k]});
}

bool hk_direct_forces(hk_gravity_bodies *g, double G, double *F) {
  task t = {g, G, F};
  g->met = 0;
  if (hk_mutual_pull(g)) {
    g->host->parallel_for(g->host, g->count, CHUNK_BODIES, mutual_forces, &t);
    return true;
  }
  memset(g->part, 0, g->parts * sizeof *g->part);
  return hk_gravity_apart(g, over_blocks(&t, force_blocks));
}

bool hk_gravity_apart(hk_gravity_bodies *g, size_t parts) {
  g->met = 0;
  for (size_t k = 0; k < parts && g->met == 0; k++) g->met = (size_t)g->part[k];
  return g->met == 0;
}

void hk_gravity_coincident(const hk_gravity_bodies *g, uint32_t pair[2]) {
  size_t k = g->met - 1;
  double least = INFINITY;
  pair[0] = pair[1] = g->order[k];
  for (size_t j = 0; j < g->count; j++) {
    double s = hk_gravity_distance(g, j, k);
    if (j == k || !(s < least)) continue;
    least = s;
    pair[1] = g->order[j];
  }
}

/* ---- the energy: every pair once, by its later body ---- */

static double block_energy(const hk_gravity_bodies *g, const block *b) {
  double potential[BLOCK] = {0}, sum = 0;
  bool attracts = b->first < g->sources;
  hk_targets at;
  hk_gravity_targets(g, b->first, b->count, &at);
  g->path->scalar(&g->at, 0, !attracts ? g->sources : g->mutual ? b->first : 0, &at, g->eps2, 1, potential);
  for (size_t l = 0; l < b->count; l++) {
    sum += g->at.m[b->first + l] * potential[l];
    for (size_t j = b->first; j < b->first + l && attracts && g->mutual; j++)
      sum += g->at.m[j] * g->at.m[b->first + l] / hk_gravity_distance(g, j, b->first + l);
  }
  return sum;
}

static void energy_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    block b = block_at(t->g, k);
    t->g->part[k] = block_energy(t->g, &b);
  }
}

double hk_direct_energy(hk_gravity_bodies *g, double G) {
  task t = {g, G, NULL};
  double sum = 0;
  size_t blocks = over_blocks(&t, energy_blocks);
  for (size_t k = 0; k < blocks; k++) sum += g->part[k];
  return -G * g->scale * sum;
}

/* ---- the bound of the stiffness ---- */

/* With softening a body is not apart from itself: it is left out by its index. */
static void stiffness_of(const hk_gravity_bodies *g, const block *b, double *sum) {
  bool inside = b->first >= b->begin && b->first < b->end;
  size_t until = inside ? b->first : b->end, from = inside ? b->first + b->count : b->end;
  hk_targets at;
  hk_gravity_targets(g, b->first, b->count, &at);
  g->path->scalar(&g->at, b->begin, until, &at, g->eps2, 3, sum);
  g->path->scalar(&g->at, from, b->end, &at, g->eps2, 3, sum);
  for (size_t l = 0; l < b->count; l++)
    for (size_t j = until; j < from; j++) {
      double s = hk_gravity_distance(g, j, b->first + l);
      if (j != b->first + l) sum[l] += g->at.m[j] / (s * s * s);
    }
}

static void stiffness_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_gravity_bodies *g = t->g;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    block b = block_at(g, k);
    double sum[BLOCK] = {0};
    stiffness_of(g, &b, sum);
    for (size_t l = 0; l < b.count; l++) t->out[b.first + l] = t->G * g->scale * g->scale * g->scale * sum[l];
  }
}

void hk_direct_stiffness(hk_gravity_bodies *g, double G, double *pull) {
  task t = {g, G, pull};
  over_blocks(&t, stiffness_blocks);
}
