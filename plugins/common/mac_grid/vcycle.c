/* See vcycle.h. Loops go over rows of cells, and in a row from its first cell of the liquid to its last. */
#include "plugins/common/mac_grid/vcycle.h"

#include <string.h>

enum { SWEEPS = 3, CHUNK = 4096 };

static const float coarse_part = 0.5F, least_hold = 1e-5F;

/* Of the sweeps before a correction, and in the reverse order after it: the roots of Chebyshev's polynomial for the
 * eigenvalues from 0.4 to 2 of the matrix by its diagonal, which it damps to a ninth; 2 is the largest. */
static const float damping[SWEEPS] = {0.5282F, 0.8333F, 1.9711F};

/* ---- memory ---- */

enum { NUMBERS = 8 };

static void numbers_of(hk_vcycle_level *l, float **list[NUMBERS]) {
  float **all[NUMBERS] = {&l->side[0], &l->side[1], &l->side[2], &l->diagonal, &l->inverse, &l->x, &l->y, &l->b};
  memcpy(list, all, sizeof all);
}

double hk_vcycle_bytes(void) { return NUMBERS * sizeof(float) * 8 / 7.0; }

static size_t rows_of(const hk_vcycle_level *l) { return l->cells[1] * l->cells[2]; }

static bool open_level(hk_vcycle_level *l, const hk_host *host) {
  float **list[NUMBERS];
  bool all = true;
  l->stride[0] = 1;
  l->stride[1] = l->cells[0] + 2;
  l->stride[2] = l->stride[1] * (l->cells[1] + 2);
  l->size = l->stride[2] * (l->cells[2] + 2);
  numbers_of(l, list);
  for (int k = 0; k < NUMBERS; k++) all &= (*list[k] = host->allocate(host, l->size * sizeof(float))) != NULL;
  all &= (l->begin = host->allocate(host, rows_of(l) * sizeof *l->begin)) != NULL;
  all &= (l->end = host->allocate(host, rows_of(l) * sizeof *l->end)) != NULL;
  return all;
}

hk_status hk_vcycle_open(hk_vcycle *v, const hk_host *host, const size_t cells[3]) {
  memset(v, 0, sizeof *v);
  v->host = host;
  memcpy(v->level[0].cells, cells, sizeof v->level[0].cells);
  for (bool more = true; more; v->levels++) {
    hk_vcycle_level *l = &v->level[v->levels];
    more = l->cells[0] * l->cells[1] * l->cells[2] > 1;
    for (int a = 0; a < 3; a++) l[1].cells[a] = (l->cells[a] + 1) / 2;
    if (open_level(l, host)) continue;
    v->levels++;
    hk_vcycle_close(v);
    return HK_NO_MEMORY;
  }
  return HK_OK;
}

void hk_vcycle_close(hk_vcycle *v) {
  for (int n = 0; n < v->levels; n++) {
    float **list[NUMBERS];
    numbers_of(&v->level[n], list);
    for (int k = 0; k < NUMBERS; k++) v->host->release(v->host, *list[k]);
    v->host->release(v->host, v->level[n].begin);
    v->host->release(v->host, v->level[n].end);
  }
  memset(v, 0, sizeof *v);
}

/* ---- rows ---- */

typedef struct task {
  hk_vcycle_level *fine, *coarse;
  float damping;
} task;

static size_t first_of(const hk_vcycle_level *l, size_t row) {
  return 1 + (1 + row % l->cells[1]) * l->stride[1] + (1 + row / l->cells[1]) * l->stride[2];
}

/* The first of the eight cells of the block at the place `first` of row `row` of the coarse level. */
static size_t block_of(const task *t, size_t row) {
  const hk_vcycle_level *f = t->fine;
  return 1 + (1 + 2 * (row % t->coarse->cells[1])) * f->stride[1] +
         (1 + 2 * (row / t->coarse->cells[1])) * f->stride[2];
}

typedef void (*rows_body)(void *, size_t, size_t, size_t);

static void over_rows(const hk_vcycle *v, const hk_vcycle_level *l, rows_body body, task *t) {
  v->host->parallel_for(v->host, rows_of(l), 1 + CHUNK / l->cells[0], body, t);
}

/* ---- numbers ---- */

void hk_vcycle_clear(hk_vcycle *v) {
  float **list[NUMBERS];
  numbers_of(&v->level[0], list);
  for (int k = 0; k < NUMBERS; k++) memset(*list[k], 0, v->level[0].size * sizeof(float));
}

/* What a cell's diagonal has beyond its sides: what the surface holds it by. In b, which is free for it. */
static void hold_rows(void *context, size_t begin, size_t end, size_t chunk) {
  hk_vcycle_level *l = ((task *)context)->fine;
  (void)chunk;
  for (size_t row = begin; row < end; row++) {
    size_t first = first_of(l, row);
    l->begin[row] = (uint32_t)(first + l->cells[0]);
    l->end[row] = (uint32_t)first;
    for (size_t i = first; i < first + l->cells[0]; i++) {
      float sum = 0;
      for (int a = 0; a < 3; a++) sum += l->side[a][i] + l->side[a][i - l->stride[a]];
      float hold = l->diagonal[i] - sum;
      l->b[i] = hold > least_hold * sum ? hold : 0;
      l->inverse[i] = l->diagonal[i] > 0 ? 1 / l->diagonal[i] : 0;
      if (!(l->diagonal[i] > 0)) continue;
      if (l->begin[row] > i) l->begin[row] = (uint32_t)i;
      l->end[row] = (uint32_t)i + 1;
    }
  }
}

/* The sum of four cells, from the place on. */
static float layer(const float *v, size_t at, size_t s, size_t t) {
  return v[at] + v[at + s] + v[at + t] + v[at + s + t];
}

static void side_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const size_t *s = t->fine->stride;
  (void)chunk;
  for (size_t row = begin; row < end; row++) {
    size_t first = first_of(t->coarse, row), block = block_of(t, row);
    for (size_t k = 0; k < t->coarse->cells[0]; k++)
      for (int a = 0; a < 3; a++)
        t->coarse->side[a][first + k] =
            coarse_part * layer(t->fine->side[a], block + 2 * k + s[a], s[(a + 1) % 3], s[(a + 2) % 3]);
  }
}

static void diagonal_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  hk_vcycle_level *c = t->coarse;
  const size_t *s = t->fine->stride;
  (void)chunk;
  for (size_t row = begin; row < end; row++) {
    size_t first = first_of(c, row), block = block_of(t, row);
    for (size_t k = 0; k < c->cells[0]; k++) {
      size_t i = first + k, at = block + 2 * k;
      float sum = coarse_part * (layer(t->fine->b, at, s[0], s[1]) + layer(t->fine->b, at + s[2], s[0], s[1]));
      for (int a = 0; a < 3; a++) sum += c->side[a][i] + c->side[a][i - c->stride[a]];
      c->diagonal[i] = sum;
    }
  }
}

void hk_vcycle_build(hk_vcycle *v) {
  for (int n = 0; n < v->levels; n++) {
    hk_vcycle_level *l = &v->level[n];
    task t = {.fine = l, .coarse = l + 1};
    over_rows(v, l, hold_rows, &t);
    if (n + 1 < v->levels) {
      over_rows(v, l + 1, side_rows, &t);
      over_rows(v, l + 1, diagonal_rows, &t);
    }
    if (n == 0) continue; /* cleared */
    memset(l->x, 0, l->size * sizeof *l->x);
    memset(l->y, 0, l->size * sizeof *l->y);
  }
}

/* ---- the cycle ---- */

/* The first sweep, from 0. */
static void start_rows(void *context, size_t begin, size_t end, size_t chunk) {
  hk_vcycle_level *l = ((task *)context)->fine;
  (void)chunk;
  for (size_t row = begin; row < end; row++)
    for (size_t i = l->begin[row]; i < l->end[row]; i++) l->x[i] = damping[0] * l->inverse[i] * l->b[i];
}

/* b and what the neighbours of cell i add to it. */
#define GATHERED(i)                                                                                                    \
  (b[i] + (s0[i] * x[(i) + 1] + s0[(i)-1] * x[(i)-1]) + (s1[i] * x[(i) + m] + s1[(i)-m] * x[(i)-m]) +                  \
   (s2[i] * x[(i) + n] + s2[(i)-n] * x[(i)-n]))
#define ROW_ARRAYS(l)                                                                                                  \
  const float *restrict b = (l)->b, *restrict x = (l)->x, *restrict s0 = (l)->side[0], *restrict s1 = (l)->side[1],    \
                        *restrict s2 = (l)->side[2];                                                                   \
  const size_t m = (l)->stride[1], n = (l)->stride[2];                                                                 \
  float *restrict y = (l)->y

/* y: x after a sweep. */
static void sweep_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  hk_vcycle_level *l = t->fine;
  const float w = t->damping;
  ROW_ARRAYS(l);
  const float *restrict inverse = l->inverse;
  (void)chunk;
  for (size_t row = begin; row < end; row++)
    for (size_t i = l->begin[row]; i < l->end[row]; i++) y[i] = x[i] + w * (inverse[i] * GATHERED(i) - x[i]);
}

/* y: the residual. */
static void residual_rows(void *context, size_t begin, size_t end, size_t chunk) {
  hk_vcycle_level *l = ((task *)context)->fine;
  ROW_ARRAYS(l);
  const float *restrict diagonal = l->diagonal;
  (void)chunk;
  for (size_t row = begin; row < end; row++)
    for (size_t i = l->begin[row]; i < l->end[row]; i++) y[i] = GATHERED(i) - diagonal[i] * x[i];
}

/* The sum of the fine residuals that a block's linear corrections come to. */
static void restrict_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_vcycle_level *c = t->coarse;
  const float *r = t->fine->y;
  (void)chunk;
  for (size_t row = begin; row < end; row++)
    for (size_t i = c->begin[row]; i < c->end[row]; i++) {
      size_t at = block_of(t, row) + 2 * (i - first_of(c, row));
      float sum = 0;
      for (int a = 0; a < 3; a++) {
        size_t s = t->fine->stride[a], s1 = t->fine->stride[(a + 1) % 3], s2 = t->fine->stride[(a + 2) % 3];
        float low = layer(r, at, s1, s2), high = layer(r, at + s, s1, s2);
        if (a == 0) sum = low + high;
        if (c->side[a][i] > 0) sum += 0.25F * (layer(r, at + 2 * s, s1, s2) - high);
        if (c->side[a][i - c->stride[a]] > 0) sum += 0.25F * (layer(r, at - s, s1, s2) - low);
      }
      c->b[i] = sum;
    }
}

/* Adds a block's correction to its cells. */
static void prolong_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_vcycle_level *c = t->coarse, *f = t->fine;
  (void)chunk;
  for (size_t row = begin; row < end; row++)
    for (size_t i = c->begin[row]; i < c->end[row]; i++) {
      size_t at = block_of(t, row) + 2 * (i - first_of(c, row));
      float way[3][2];
      for (int a = 0; a < 3; a++) {
        size_t s = c->stride[a];
        way[a][0] = c->side[a][i - s] > 0 ? 0.25F * (c->x[i - s] - c->x[i]) : 0;
        way[a][1] = c->side[a][i] > 0 ? 0.25F * (c->x[i + s] - c->x[i]) : 0;
      }
      for (size_t k = 0; k < 8; k++) {
        size_t to = at + (k & 1) + (k >> 1 & 1) * f->stride[1] + (k >> 2) * f->stride[2];
        if (f->inverse[to] > 0) f->x[to] += c->x[i] + (way[0][k & 1] + way[1][k >> 1 & 1] + way[2][k >> 2]);
      }
    }
}

static void sweep(const hk_vcycle *v, hk_vcycle_level *l, float by) {
  over_rows(v, l, sweep_rows, &(task){.fine = l, .damping = by});
  float *swap = l->x;
  l->x = l->y;
  l->y = swap;
}

void hk_vcycle_run(hk_vcycle *v) {
  int last = v->levels - 1;
  for (int n = 0; n <= last; n++) {
    hk_vcycle_level *l = &v->level[n];
    task t = {.fine = l, .coarse = l + 1};
    over_rows(v, l, start_rows, &t);
    if (n == last) break;
    for (int k = 1; k < SWEEPS; k++) sweep(v, l, damping[k]);
    over_rows(v, l, residual_rows, &t);
    over_rows(v, l + 1, restrict_rows, &t);
  }
  for (int n = last - 1; n >= 0; n--) {
    hk_vcycle_level *l = &v->level[n];
    over_rows(v, l + 1, prolong_rows, &(task){.fine = l, .coarse = l + 1});
    for (int k = SWEEPS - 1; k >= 0; k--) sweep(v, l, damping[k]);
  }
}
