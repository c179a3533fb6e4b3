/* Sweeps over the edges that may be beyond their limits: a bit for each, in the order of the sweep. A move sets the
 * bits of the edges that it touches, in this sweep where they come later, in the next where they came before. */
#include "plugins/common/springs/edge.h"
#include "plugins/common/strain/strain_limits.h"

#include <string.h>

static size_t words(const hk_strain_limits *s) { return (s->count + 63) / 64; }

static void set(uint64_t *bits, uint32_t rank) { bits[rank >> 6] |= 1ull << (rank & 63); }

/* The lowest set bit of a word that is not 0, which is cleared. */
static uint32_t take_lowest(uint64_t *word) {
  uint32_t bit = (uint32_t)__builtin_ctzll(*word);
  *word &= *word - 1;
  return bit;
}

/* A move of the edge of this rank has changed the lengths of its ends' other edges. It is looked at again itself: an
 * end that slides moves across the edge, too, so that the limit is reached to second order of the way. */
static void touch(hk_strain_limits *s, uint32_t rank, bool all_next) {
  const uint32_t *pair = s->pair[s->edge_at[rank]];
  for (int end = 0; end < 2; end++)
    for (size_t k = s->start[pair[end]]; k < s->start[pair[end] + 1]; k++)
      set(s->incident[k] <= rank || all_next ? s->next : s->now, s->incident[k]);
}

static bool visit(hk_strain_limits *s, uint32_t rank, const hk_strain_state *state, bool all_next) {
  bool moved = hk_strain_move(s, s->edge_at[rank], state);
  if (moved) touch(s, rank, all_next);
  return moved;
}

static size_t sweep_in_order(hk_strain_limits *s, const hk_strain_state *state) {
  size_t moves = 0;
  for (size_t w = 0; w < words(s); w++)
    while (s->now[w]) {
      uint32_t bit = take_lowest(&s->now[w]); /* before the visit, which may set others of this word */
      moves += visit(s, (uint32_t)(64 * w) + bit, state, false);
    }
  return moves;
}

/* ---- by excess ---- */

/* The part of a limit by which an edge is beyond it. */
static double excess_of(const hk_strain_limits *s, size_t edge, const double *x) {
  double l, limit = hk_strain_passed(s, edge, x, &l);
  return limit > 0 ? fabs(l - limit) / limit : 0;
}

static bool farther_beyond(const hk_strain_limits *s, uint32_t e, uint32_t f) {
  return s->excess[e] != s->excess[f] ? s->excess[e] > s->excess[f] : e < f;
}

static size_t sweep_sorted(hk_strain_limits *s, const hk_strain_state *state) {
  size_t count = 0, moves = 0;
  for (size_t w = 0; w < words(s); w++)
    while (s->now[w]) {
      uint32_t edge = s->edge_at[64 * w + take_lowest(&s->now[w])];
      s->excess[edge] = excess_of(s, edge, state->x);
      if (s->excess[edge] > 0) s->list[count++] = edge;
    }
  hk_strain_sort(s, s->list, count, farther_beyond);
  for (size_t k = 0; k < count; k++) moves += visit(s, s->rank_of[s->list[k]], state, true);
  return moves;
}

/* ---- sweeps ---- */

static bool any(const hk_strain_limits *s, const uint64_t *bits) {
  for (size_t w = 0; w < words(s); w++)
    if (bits[w]) return true;
  return false;
}

/* What would be visited next. */
static void look_at_the_rest(hk_strain_limits *s, const double *x, hk_strain_result *r) {
  for (size_t w = 0; w < words(s); w++)
    while (s->now[w]) {
      size_t edge = s->edge_at[64 * w + take_lowest(&s->now[w])];
      double excess = excess_of(s, edge, x);
      if (excess > 0) r->left++;
      if (excess > r->excess) r->excess = excess, r->worst = edge;
    }
}

hk_strain_result hk_strain_sweep(hk_strain_limits *s, const hk_strain_state *state, size_t most) {
  hk_strain_result r = {0};
  while (r.sweeps < most && any(s, s->now)) {
    r.moves += s->order == HK_STRAIN_SORTED ? sweep_sorted(s, state) : sweep_in_order(s, state);
    uint64_t *emptied = s->now;
    s->now = s->next;
    s->next = emptied;
    r.sweeps++;
  }
  look_at_the_rest(s, state->x, &r);
  return r;
}

double hk_strain_violation(const hk_strain_limits *s, const double *x) {
  double most = 0, d[3];
  for (size_t e = 0; e < s->count; e++) {
    double l = hk_edge_difference(x, s->pair[e], d);
    most = fmax(most, fmax(l - s->limit[e][1], s->limit[e][0] - l));
  }
  return most;
}

/* ---- memory ---- */

hk_status hk_strain_build(hk_strain_limits *s, const hk_host *host) {
  hk_status status = hk_strain_cut(s, host);
  if (status == HK_OK) status = hk_strain_reserve(s, host);
  s->now = host->allocate(host, (words(s) + 1) * sizeof *s->now);
  s->next = host->allocate(host, (words(s) + 1) * sizeof *s->next);
  s->excess = host->allocate(host, (s->count + 1) * sizeof *s->excess);
  s->list = host->allocate(host, (s->count + 1) * sizeof *s->list);
  return status == HK_OK && s->now && s->next && s->excess && s->list ? HK_OK : HK_NO_MEMORY;
}

void hk_strain_free(hk_strain_limits *s, const hk_host *host) {
  void *const memory[] = {s->block,    s->beyond, s->apart, s->edge_at, s->rank_of, s->start,
                          s->incident, s->level,  s->queue, s->pin,     s->slide,   s->projector,
                          s->scratch,  s->now,    s->next,  s->excess,  s->list};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  *s = (hk_strain_limits){0};
}
