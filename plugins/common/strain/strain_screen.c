/* Screening: which blocks of edges have one beyond its limits, by squared lengths, without roots. The edges of grids
 * come in runs (i+t, j+t), whose coordinates are contiguous once x, y and z are apart; the others are looked at one by
 * one. */
#include "plugins/common/strain/strain_limits.h"

#define LOAD(type, p) (*(const type *)(p))

enum { GRAIN = 4096, BLOCKS = 16 };

typedef struct coordinates {
  const double *x[2], *y[2], *z[2]; /* of the first particle of both ends */
} coordinates;

/* The loop over a run with vectors of `lanes` doubles: any length^2 outside of [low, high]? */
#define SCREEN(vector, mask, lanes)                                                                                    \
  mask any = {0};                                                                                                      \
  const vector zero = {0}, lowest = zero + low, highest = zero + high;                                                 \
  size_t k = 0;                                                                                                        \
  for (; k + (lanes) <= count; k += (lanes)) {                                                                         \
    vector dx = LOAD(vector, c->x[1] + k) - LOAD(vector, c->x[0] + k);                                                 \
    vector dy = LOAD(vector, c->y[1] + k) - LOAD(vector, c->y[0] + k);                                                 \
    vector dz = LOAD(vector, c->z[1] + k) - LOAD(vector, c->z[0] + k), l2 = dx * dx + dy * dy + dz * dz;               \
    any |= (mask)(l2 > highest) | (mask)(l2 < lowest);                                                                 \
  }                                                                                                                    \
  int64_t found = 0;                                                                                                   \
  for (int lane = 0; lane < (lanes); lane++) found |= any[lane];                                                       \
  for (; k < count; k++) {                                                                                             \
    double dx = c->x[1][k] - c->x[0][k], dy = c->y[1][k] - c->y[0][k], dz = c->z[1][k] - c->z[0][k];                   \
    double l2 = dx * dx + dy * dy + dz * dz;                                                                           \
    found |= l2 > high || l2 < low;                                                                                    \
  }                                                                                                                    \
  return found

typedef double half __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t half_mask __attribute__((vector_size(16), aligned(8), may_alias));

static bool screen_narrow(const coordinates *c, size_t count, double low, double high) { SCREEN(half, half_mask, 2); }

typedef bool screener(const coordinates *, size_t count, double low, double high);

#if defined(__x86_64__)
typedef double wide __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t wide_mask __attribute__((vector_size(32), aligned(8), may_alias));

__attribute__((target("avx2"))) static bool screen_wide(const coordinates *c, size_t count, double low, double high) {
  SCREEN(wide, wide_mask, 4);
}

static screener *fastest(void) { return __builtin_cpu_supports("avx2") ? screen_wide : screen_narrow; }
#else
static screener *fastest(void) { return screen_narrow; }
#endif

typedef struct task {
  hk_strain_limits *limits;
  const double *x;
  screener *screen;
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
  const uint32_t *pair = s->pair[b->begin];
  coordinates c;
  for (int end = 0; end < 2; end++) {
    c.x[end] = s->apart + pair[end];
    c.y[end] = c.x[end] + s->n;
    c.z[end] = c.y[end] + s->n;
  }
  return t->screen(&c, b->count, b->shortest2, b->longest2);
}

static bool list_beyond(const task *t, const hk_strain_block *b) {
  bool found = false;
  for (size_t e = b->begin; e < b->begin + b->count; e++) {
    const double *a = t->x + 3 * (size_t)t->limits->pair[e][0], *d = t->x + 3 * (size_t)t->limits->pair[e][1];
    double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2], l2 = dx * dx + dy * dy + dz * dz;
    found |= l2 > b->longest2 || l2 < b->shortest2;
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
  task t = {s, x, fastest()};
  bool any = false;
  double l;
  if (s->runs) host->parallel_for(host, s->n, GRAIN, split, &t);
  host->parallel_for(host, s->blocks, BLOCKS, screen_blocks, &t);
  for (size_t k = 0; k < s->blocks; k++) {
    const hk_strain_block *b = &s->block[k];
    for (size_t e = b->begin; s->beyond[k] && e < b->begin + b->count; e++) {
      if (!(hk_strain_passed(s, e, x, &l) > 0)) continue;
      s->now[s->rank_of[e] >> 6] |= 1ull << (s->rank_of[e] & 63);
      any = true;
    }
  }
  return any;
}

/* ---- blocks ---- */

enum { RUN_MIN = 16 /* the call costs more than shorter runs save */ };

static size_t run_length(const hk_strain_limits *s, size_t e) {
  size_t length = 1;
  while (length < HK_STRAIN_BLOCK && e + length < s->count && s->pair[e + length][0] == s->pair[e][0] + length &&
         s->pair[e + length][1] == s->pair[e][1] + length)
    length++;
  return length;
}

static void close_block(hk_strain_limits *s, size_t begin, size_t count, bool run) {
  if (count == 0) return;
  hk_strain_block b = {begin, count, run, 0, INFINITY};
  for (size_t e = begin; e < begin + count; e++) {
    double shortest = s->limit[e][0] * (1 - s->slack), longest = s->limit[e][1] * (1 + s->slack);
    b.shortest2 = fmax(b.shortest2, shortest * shortest);
    b.longest2 = fmin(b.longest2, longest * longest);
  }
  if (s->block) s->block[s->blocks] = b;
  s->blocks++;
  s->runs |= run;
}

/* Blocks of the list; counted only where there is no room for them yet. */
static void cut(hk_strain_limits *s) {
  size_t open = 0; /* first edge of the list block that is being filled */
  s->blocks = 0;
  for (size_t e = 0; e < s->count;) {
    size_t length = run_length(s, e);
    bool run = length >= RUN_MIN;
    if (run || e + length - open > HK_STRAIN_BLOCK) {
      close_block(s, open, e - open, false);
      open = e;
    }
    if (run) {
      close_block(s, e, length, true);
      open = e + length;
    }
    e += length;
  }
  close_block(s, open, s->count - open, false);
}

hk_status hk_strain_cut(hk_strain_limits *s, const hk_host *host) {
  s->block = NULL;
  cut(s);
  s->block = host->allocate(host, (s->blocks + 1) * sizeof *s->block);
  s->beyond = host->allocate(host, (s->blocks + 1) * sizeof *s->beyond);
  s->apart = host->allocate(host, (3 * s->n + 1) * sizeof *s->apart);
  if (!s->block || !s->beyond || !s->apart) return HK_NO_MEMORY;
  cut(s);
  return HK_OK;
}
