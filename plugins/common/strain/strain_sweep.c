/* Sweeps over the edges that may be beyond their limits: a bit for each, in the order of the sweep. A move sets the
 * bits of the edges that it touches, in this sweep where they come later, in the next where they came before. */
#include "plugins/kit/springs/edge.h"
#include "plugins/common/strain/strain_limits.h"

/* A move of the edge of this rank has changed the lengths of its ends' other edges. It is looked at again itself: an
 * end that slides moves across the edge, too, so that the limit is reached to second order of the way. */
static void touch(hk_strain_limits *s, uint32_t rank, bool all_next) {
  const uint32_t *pair = s->pair[s->edge_at[rank]];
  for (int end = 0; end < 2; end++)
    for (size_t k = s->start[pair[end]]; k < s->start[pair[end] + 1]; k++)
      hk_mark(s->incident[k] <= rank || all_next ? &s->next : &s->now, s->incident[k]);
}

static bool visit(hk_strain_limits *s, uint32_t rank, const hk_strain_state *state, bool all_next) {
  bool moved = hk_strain_move(s, s->edge_at[rank], state);
  if (moved) {
    touch(s, rank, all_next);
    hk_mark(&s->moved, rank);
  }
  return moved;
}

static size_t sweep_in_order(hk_strain_limits *s, const hk_strain_state *state) {
  size_t moves = 0, from = 0;
  uint32_t rank;
  while (hk_marks_next(&s->now, &from, &rank)) moves += visit(s, rank, state, false);
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
  size_t count = 0, moves = 0, from = 0;
  uint32_t rank;
  while (hk_marks_next(&s->now, &from, &rank)) {
    uint32_t edge = s->edge_at[rank];
    s->excess[edge] = excess_of(s, edge, state->x);
    if (s->excess[edge] > 0) s->list[count++] = edge;
  }
  hk_strain_sort(s, s->list, count, farther_beyond);
  for (size_t k = 0; k < count; k++) moves += visit(s, s->rank_of[s->list[k]], state, true);
  return moves;
}

/* ---- sweeps ---- */

/* What would be visited next. */
static void measure_the_rest(hk_strain_limits *s, const double *x, hk_strain_result *r) {
  size_t from = 0;
  uint32_t rank;
  while (hk_marks_next(&s->now, &from, &rank)) {
    double excess = excess_of(s, s->edge_at[rank], x);
    if (excess > 0) r->left++;
    if (excess > r->excess) r->excess = excess, r->worst = s->edge_at[rank];
  }
}

/* Velocities follow the moves where these keep momentum. What is moved to and fro for ever, between pins that are too
 * far apart, would gain speed for ever: where sweeps come to no end, they do so only if no energy was gained. */
hk_strain_result hk_strain_sweep(hk_strain_limits *s, const hk_strain_state *state, size_t most) {
  hk_strain_result r = {0};
  hk_strain_state moving = *state;
  if (s->order == HK_STRAIN_OUTWARDS) moving.v = NULL;
  for (; r.sweeps < most && !hk_marks_empty(&s->now); r.sweeps++) {
    r.moves += s->order == HK_STRAIN_SORTED ? sweep_sorted(s, &moving) : sweep_in_order(s, &moving);
    hk_marks emptied = s->now;
    s->now = s->next;
    s->next = emptied;
  }
  measure_the_rest(s, state->x, &r);
  if (state->v && ((r.left && s->gain > 0) || !moving.v)) hk_strain_stop_moved(s, state);
  hk_strain_forget(s);
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
  s->excess = host->allocate(host, (s->count + 1) * sizeof *s->excess);
  s->list = host->allocate(host, (s->count + 1) * sizeof *s->list);
  s->touched = host->allocate(host, (s->n + 1) * sizeof *s->touched);
  s->before = host->allocate(host, (s->n + 1) * sizeof *s->before);
  s->is_touched = host->allocate(host, (s->n + 1) * sizeof *s->is_touched);
  if (!s->excess || !s->list || !s->touched || !s->before || !s->is_touched ||
      !hk_marks_make(&s->now, s->count, host) || !hk_marks_make(&s->next, s->count, host) ||
      !hk_marks_make(&s->moved, s->count, host))
    return HK_NO_MEMORY;
  hk_status status = hk_strain_reserve(s, host);
  return status == HK_OK ? hk_strain_cut(s, host) : status;
}

void hk_strain_free(hk_strain_limits *s, const hk_host *host) {
  void *const memory[] = {s->block,        s->beyond,        s->apart,         s->edge_of,  s->looked_at, s->square,
                          s->edge_at,      s->rank_of,       s->start,         s->incident, s->level,     s->queue,
                          s->pin,          s->slide,         s->projector,     s->scratch,  s->excess,    s->list,
                          s->touched,      s->before,        s->is_touched,    s->now.word, s->next.word, s->moved.word,
                          s->now.overview, s->next.overview, s->moved.overview};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  *s = (hk_strain_limits){0};
}
