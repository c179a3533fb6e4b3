/* The sum over all pairs in 32-bit arithmetic, in blocks of targets, and its errors against the sum in doubles. */
#include "plugins/common/gravity_single/single_sum.h"
#include "plugins/common/gravity/tree_errors.h"

#include <stdlib.h>
#include <string.h>

enum {
  BLOCK = HK_SINGLE_BLOCK,
  GROUP = HK_GRAVITY_BLOCK, /* targets that are summed in doubles together */
  CHUNK_PAIRS = 1 << 17,    /* some 20 us: far above the cost of handing it to a thread */
  EACH = HK_SAMPLE / HK_SAMPLE_GROUPS
};

hk_status hk_single_reserve(hk_single_sum *s, const hk_host *host, size_t n) {
  if (s->body && n <= s->room) return HK_OK;
  hk_single_release(s);
  s->host = host;
  s->path = hk_single_best();
  s->room = n + n / 2 + BLOCK;
  s->body = host->allocate(host, s->room * sizeof *s->body);
  return s->body ? HK_OK : HK_NO_MEMORY;
}

void hk_single_release(hk_single_sum *s) {
  if (s->host) s->host->release(s->host, s->body);
  s->body = NULL;
  s->room = 0;
}

/* ---- bodies in floats ---- */

static double mean(const double *x, size_t count) {
  double sum = 0;
  for (size_t k = 0; k < count; k++) sum += x[k] - x[0];
  return x[0] + sum / (double)count;
}

/* In two loops, so that the high part is read from memory: gcc 12 with -O3 takes (double)(float)x
 * for x where it makes vectors of both conversions, and low parts of 0. */
static void split(hk_single_sum *s, size_t count, const double *x, size_t c) {
  double origin = mean(x, count);
  for (size_t k = 0; k < count; k++) s->body[k].high[c] = (float)(x[k] - origin);
  for (size_t k = 0; k < count; k++) s->body[k].low[c] = (float)(x[k] - origin - (double)s->body[k].high[c]);
}

/* A force, of distances from 2^-30 to 4, has to be within the normal floats, from 2^-126: masses from 2^-90. */
static void weigh(hk_single_sum *s, size_t count, const double *m) {
  double most = 0, least = INFINITY;
  int exponent;
  for (size_t k = 0; k < count; k++) {
    most = fmax(most, m[k]);
    if (m[k] > 0) least = fmin(least, m[k]);
  }
  frexp(most, &exponent);
  s->fits = most > 0 && least >= 0x1p-90 * most && abs(exponent) < 1000;
  s->unit = s->fits ? ldexp(1, exponent) : 1;
  for (size_t k = 0; k < count && s->fits; k++) s->body[k].m = (float)(m[k] / s->unit);
}

static void prepare(hk_single_sum *s, const hk_gravity_bodies *g) {
  if (g->count == 0) return;
  split(s, g->count, g->at.x, 0);
  split(s, g->count, g->at.y, 1);
  split(s, g->count, g->at.z, 2);
  weigh(s, g->count, g->at.m);
}

/* ---- sums ---- */

typedef struct task {
  hk_single_sum *s;
  hk_gravity_bodies *g;
  double G, *F;
  size_t stride;
  hk_pull_sample *sample;
} task;

static void place_targets(const hk_single_sum *s, const hk_gravity_block *b, hk_single_targets *t) {
  for (size_t l = 0; l < BLOCK; l++) {
    const hk_single_body *body = s->body + b->first + (l < b->count ? l : 0);
    for (size_t c = 0; c < 3; c++) t->high[c][l] = body->high[c], t->low[c][l] = body->low[c];
  }
}

/* The least s^2 for which floats do. Two bodies near each other are both about r from the origin, and coordinates are
 * off by 2^-48 of r at most: from 2^-24 r on, distances are right to two roundings of floats. From 2^-30 on, cubes are
 * within their range. */
static double least_square(const hk_single_body *body) {
  double r2 = 0;
  for (size_t c = 0; c < 3; c++) r2 += (double)body->high[c] * (double)body->high[c];
  return fmax(0x1p-48 * r2, 0x1p-60);
}

static bool floats_do(const hk_single_sum *s, const hk_single_pull *sum, size_t first, size_t from, size_t count) {
  for (size_t l = from; l < from + count; l++) {
    if (!((double)sum->nearest[l] >= least_square(s->body + first + l))) return false;
    if (!isfinite(sum->a[0][l] + sum->a[1][l] + sum->a[2][l])) return false;
  }
  return true;
}

/* The pairs of a block with the sources outside it. */
static void pull_floats(const hk_single_sum *s, const hk_gravity_bodies *g, const hk_gravity_block *b,
                        const hk_gravity_block *inside, hk_single_pull *sum) {
  hk_single_targets t;
  place_targets(s, b, &t);
  for (size_t l = 0; l < BLOCK; l++) sum->nearest[l] = INFINITY;
  s->path->pull(s->body, b->begin, inside->begin, &t, (float)g->eps2, sum);
  s->path->pull(s->body, inside->end, b->end, &t, (float)g->eps2, sum);
}

/* The part of the sources that is in the block; none: an empty range at their end. */
static hk_gravity_block inside_of(const hk_gravity_block *b) {
  bool inside = b->first >= b->begin && b->first < b->end;
  return (hk_gravity_block){b->first, b->count, inside ? b->first : b->end, inside ? b->first + b->count : b->end};
}

/* a: sum of m d/s^3 for each body of a block. Returns 1 + a body that is at the place of another one, or 0. */
static size_t pull_block(const hk_single_sum *s, const hk_gravity_bodies *g, const hk_gravity_block *b,
                         double (*a)[3]) {
  const hk_gravity_block inside = inside_of(b);
  hk_single_pull far = {0};
  size_t met = 0;
  if (s->fits) pull_floats(s, g, b, &inside, &far);
  for (size_t from = 0; from < b->count; from += GROUP) {
    size_t count = b->count - from < GROUP ? b->count - from : GROUP;
    bool floats = s->fits && floats_do(s, &far, b->first, from, count);
    hk_gravity_block exact = floats ? inside : *b;
    hk_pull sum;
    exact.first = b->first + from, exact.count = count;
    hk_gravity_pull(g, &exact, &sum);
    if (met == 0) met = hk_gravity_meeting(g, &exact, &sum);
    for (size_t l = 0; l < count; l++)
      for (size_t c = 0; c < 3; c++) a[from + l][c] = sum.a[c][l] + (floats ? s->unit * far.a[c][from + l] : 0);
  }
  return met;
}

static size_t add_block(const task *t, const hk_gravity_block *b) {
  double a[BLOCK][3];
  size_t met = pull_block(t->s, t->g, b, a);
  for (size_t l = 0; l < b->count; l++) {
    double f = t->G * t->g->at.m[b->first + l] * (t->g->scale * t->g->scale);
    for (size_t c = 0; c < 3; c++) t->F[3 * (size_t)t->g->order[b->first + l] + c] += f * a[l][c];
  }
  return met;
}

static void force_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  task *t = context;
  size_t met = 0;
  for (size_t k = begin; k < end; k++) {
    hk_gravity_block b = hk_gravity_block_at(t->g, k, BLOCK);
    size_t here = add_block(t, &b);
    if (met == 0) met = here;
  }
  t->g->part[chunk] = (double)met;
}

bool hk_single_forces(hk_single_sum *s, hk_gravity_bodies *g, double G, double *F) {
  task t = {.s = s, .g = g, .G = G, .F = F};
  size_t blocks = hk_gravity_blocks(g, BLOCK), grain = g->count ? CHUNK_PAIRS / BLOCK / g->count + 1 : 1;
  prepare(s, g);
  memset(g->part, 0, g->parts * sizeof *g->part);
  g->host->parallel_for(g->host, blocks, grain, force_blocks, &t);
  return hk_gravity_apart(g, blocks);
}

/* ---- errors ---- */

/* Bodies evenly spaced in a block. */
static void sample_block(const task *t, const hk_gravity_block *b, size_t at) {
  size_t each = b->count < EACH ? b->count : EACH;
  double a[BLOCK][3];
  pull_block(t->s, t->g, b, a);
  for (size_t e = 0; e < each; e++) {
    size_t l = (2 * e + 1) * b->count / (2 * each);
    hk_gravity_block one = {b->first + l, 1, b->begin, b->end};
    hk_pull sum;
    hk_gravity_pull(t->g, &one, &sum);
    t->sample->body[at + e] = (uint32_t)(b->first + l);
    for (size_t c = 0; c < 3; c++) t->sample->found[at + e][c] = a[l][c], t->sample->exact[at + e][c] = sum.a[c][0];
  }
}

static void sample_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    hk_gravity_block b = hk_gravity_block_at(t->g, k * t->stride, BLOCK);
    sample_block(t, &b, EACH * k);
  }
}

void hk_single_errors(hk_single_sum *s, hk_gravity_bodies *g, double G, const double *v, hk_force_errors *out) {
  hk_pull_sample sample;
  size_t blocks = hk_gravity_blocks(g, BLOCK);
  task t = {.s = s, .g = g, .G = G, .stride = blocks / HK_SAMPLE_GROUPS + 1, .sample = &sample};
  prepare(s, g);
  hk_pull_sample_clear(&sample);
  g->host->parallel_for(g->host, (blocks + t.stride - 1) / t.stride, 1, sample_blocks, &t);
  hk_pull_sample_errors(&sample, g, G, v, out);
}
