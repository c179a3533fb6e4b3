/* Screening: which blocks of edges have one beyond its limits, by squared lengths, without roots. Edges are sorted into
 * runs (i+t, j+t), of which grids consist and whose coordinates are contiguous once x, y and z are apart; a run is
 * compared with the narrowest limits of its edges. The others are looked at one by one. */
#include "plugins/common/strain/run_screen.h"
#include "plugins/common/strain/strain_limits.h"

#include <string.h>

enum { GRAIN = 4096, BLOCKS = 16 };

typedef struct task {
  hk_strain_limits *limits;
  const double *x;
  int lanes;
} task;

static void split(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  size_t n = t->limits->n;
  double *x = t->limits->apart, *y = x + n, *z = y + n;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    x[i] = t->x[3 * i];
    y[i] = t->x[3 * i + 1];
    z[i] = t->x[3 * i + 2];
  }
}

static bool run_beyond(const task *t, const hk_strain_block *b) {
  const hk_strain_limits *s = t->limits;
  hk_run_ends c;
  for (int end = 0; end < 2; end++) {
    c.x[end] = s->apart + s->looked_at[b->begin][end];
    c.y[end] = c.x[end] + s->n;
    c.z[end] = c.y[end] + s->n;
  }
  return hk_run_screen(t->lanes, &c, b->count, b->shortest2, b->longest2);
}

static bool list_beyond(const task *t, const hk_strain_block *b) {
  bool found = false;
  for (size_t k = b->begin; k < b->begin + b->count; k++) {
    const uint32_t *pair = t->limits->looked_at[k];
    const double *p = t->x + 3 * (size_t)pair[0], *q = t->x + 3 * (size_t)pair[1], *square = t->limits->square[k];
    double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2], l2 = dx * dx + dy * dy + dz * dz;
    found |= (l2 < square[0]) | (l2 > square[1]);
  }
  return found;
}

static void screen_blocks(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const hk_strain_block *b = &t->limits->block[k];
    t->limits->beyond[k] = b->run ? run_beyond(t, b) : list_beyond(t, b);
  }
}

bool hk_strain_screen(hk_strain_limits *s, const hk_host *host, const double *x) {
  task t = {s, x, host->lanes};
  bool any = false;
  double l;
  if (s->runs) host->parallel_for(host, s->n, GRAIN, split, &t);
  host->parallel_for(host, s->blocks, BLOCKS, screen_blocks, &t);
  for (size_t k = 0; k < s->blocks; k++) {
    const hk_strain_block *b = &s->block[k];
    for (size_t m = b->begin; s->beyond[k] && m < b->begin + b->count; m++) {
      if (!(hk_strain_passed(s, s->edge_of[m], x, &l) > 0)) continue;
      hk_mark(&s->now, s->rank_of[s->edge_of[m]]);
      any = true;
    }
  }
  return any;
}

/* ---- blocks ---- */

enum { RUN_MIN = 16 /* the call costs more than shorter runs save */ };

static uint32_t low(const hk_strain_limits *s, uint32_t e) {
  return s->pair[e][0] < s->pair[e][1] ? s->pair[e][0] : s->pair[e][1];
}

static uint32_t high(const hk_strain_limits *s, uint32_t e) {
  return s->pair[e][0] < s->pair[e][1] ? s->pair[e][1] : s->pair[e][0];
}

static bool by_distance(const hk_strain_limits *s, uint32_t e, uint32_t f) {
  uint32_t apart_e = high(s, e) - low(s, e), apart_f = high(s, f) - low(s, f);
  return apart_e != apart_f ? apart_e < apart_f : low(s, e) < low(s, f);
}

static bool by_low_end(const hk_strain_limits *s, uint32_t e, uint32_t f) {
  return low(s, e) != low(s, f) ? low(s, e) < low(s, f) : high(s, e) < high(s, f);
}

/* How many edges from place k on are a run. */
static size_t run_length(const hk_strain_limits *s, size_t k) {
  const uint32_t *e = s->edge_of + k;
  size_t length = 1;
  while (length < HK_STRAIN_BLOCK && k + length < s->count && low(s, e[length]) == low(s, e[0]) + length &&
         high(s, e[length]) == high(s, e[0]) + length)
    length++;
  return length;
}

static void add_block(hk_strain_limits *s, size_t begin, size_t count, bool run) {
  hk_strain_block b = {begin, count, run, 0, INFINITY};
  for (size_t k = begin; k < begin + count; k++) {
    uint32_t e = s->edge_of[k];
    double shortest = s->limit[e][0] * (1 - s->slack), longest = s->limit[e][1] * (1 + s->slack);
    s->looked_at[k][0] = low(s, e);
    s->looked_at[k][1] = high(s, e);
    s->square[k][0] = shortest * shortest;
    s->square[k][1] = longest * longest;
    b.shortest2 = fmax(b.shortest2, s->square[k][0]);
    b.longest2 = fmin(b.longest2, s->square[k][1]);
  }
  s->block[s->blocks++] = b;
  s->runs |= run;
}

/* Edges in runs come first, in the order in which they were found; `spare` has room for the others. */
static size_t take_runs(hk_strain_limits *s, uint32_t *spare) {
  size_t taken = 0, rest = 0;
  for (size_t k = 0, length; k < s->count; k += length) {
    length = run_length(s, k);
    if (length < RUN_MIN) {
      memcpy(spare + rest, s->edge_of + k, length * sizeof *spare);
      rest += length;
    } else {
      memmove(s->edge_of + taken, s->edge_of + k, length * sizeof *spare);
      add_block(s, taken, length, true);
      taken += length;
    }
  }
  memcpy(s->edge_of + taken, spare, rest * sizeof *spare);
  return taken;
}

static void cut(hk_strain_limits *s) {
  for (size_t e = 0; e < s->count; e++) s->edge_of[e] = (uint32_t)e;
  hk_strain_sort(s, s->edge_of, s->count, by_distance);
  size_t k = take_runs(s, s->list);
  hk_strain_sort(s, s->edge_of + k, s->count - k, by_low_end);
  for (size_t count; k < s->count; k += count) {
    count = s->count - k < HK_STRAIN_BLOCK ? s->count - k : HK_STRAIN_BLOCK;
    add_block(s, k, count, false);
  }
}

hk_status hk_strain_cut(hk_strain_limits *s, const hk_host *host) {
  size_t most = s->count / RUN_MIN + 2; /* blocks: each but two, of a run or of what is left, has so many edges */
  s->block = host->allocate(host, most * sizeof *s->block);
  s->beyond = host->allocate(host, most * sizeof *s->beyond);
  s->apart = host->allocate(host, (3 * s->n + 1) * sizeof *s->apart);
  s->edge_of = host->allocate(host, (s->count + 1) * sizeof *s->edge_of);
  s->looked_at = host->allocate(host, (s->count + 1) * sizeof *s->looked_at);
  s->square = host->allocate(host, (s->count + 1) * sizeof *s->square);
  if (!s->block || !s->beyond || !s->apart || !s->edge_of || !s->looked_at || !s->square) return HK_NO_MEMORY;
  cut(s);
  return HK_OK;
}
