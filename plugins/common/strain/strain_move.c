/* The move of one edge to its limit. With d = x_j - x_i, l = |d|, n = d/l, the limit L and w = 1/m the ends move by
 *     dx_i = w_i/(w_i + w_j) (l - L) n,      dx_j = -w_j/(w_i + w_j) (l - L) n.
 * An end that slides has w n.Pn in the place of w and moves along Pn, with P the projector onto what its pin allows.
 *
 * Velocities, where they are corrected, are those of a rope that has come taut: of the ends' relative velocity u the
 * part along n that leads further beyond the limit is taken by an impulse along the edge, and what is left across it
 * becomes u l/L. So d x u, and with it the angular momentum, is the same before and after the move: without that a mass
 * that whirls on a rope would lose the part 1 - L/l of its speed in every step, of order h^2 each, by an error of the
 * positions alone. */
#include "plugins/kit/vector3.h"
#include "plugins/kit/springs/edge.h"
#include "plugins/common/strain/strain_limits.h"

double hk_strain_passed(const hk_strain_limits *s, size_t edge, const double *x, double *length) {
  const double *a = x + 3 * (size_t)s->pair[edge][0], *b = x + 3 * (size_t)s->pair[edge][1];
  double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2], l2 = dx * dx + dy * dy + dz * dz;
  double shortest = s->limit[edge][0] * (1 - s->slack), longest = s->limit[edge][1] * (1 + s->slack);
  if (l2 <= longest * longest && l2 >= shortest * shortest) return 0;
  *length = sqrt(l2);
  return s->limit[edge][l2 > longest * longest];
}

/* One end of an edge: its inverse mass along the edge, and the direction in which it moves. */
typedef struct end {
  size_t at; /* 3 times its index */
  double w;  /* 1/kg */
  double along[3];
  bool slides;
} end;

static end end_of(const hk_strain_limits *s, uint32_t i, const double n[3], double inverse_mass) {
  end e = {3 * (size_t)i, inverse_mass, {n[0], n[1], n[2]}, s->slide[i] != HK_NO_STRAIN_SLIDE};
  if (!e.slides) return e;
  const double *P = s->projector[s->slide[i]];
  for (int r = 0; r < 3; r++) e.along[r] = hk_dot(P + 3 * r, n);
  e.w *= hk_dot(e.along, e.along);
  return e;
}

/* Adds `amount` times the end's share along its direction; with P idempotent, P n / (n.Pn) has the part 1 along n. */
static void shift(const end *e, double *vector, double amount, double inverse_mass) {
  hk_add_scaled(vector + e->at, amount * inverse_mass, e->along);
}

/* By an impulse along the edge, which takes an energy, J; 0: it does not lead beyond the limit. */
static double stop(const end *i, const end *j, const hk_strain_state *state, const double n[3], const double w[2],
                   bool outwards) {
  double u[3], sum = i->w + j->w;
  hk_subtract(u, state->v + j->at, state->v + i->at);
  double speed = hk_dot(u, n);
  if (!(outwards ? speed > 0 : speed < 0) || !(sum > 0)) return 0;
  shift(i, state->v, speed / sum, w[0]);
  shift(j, state->v, -speed / sum, w[1]);
  return speed * speed / sum / 2;
}

/* Makes what is across the edge `ratio` times as fast, which gives an energy, J. Where an end slides, its pin takes up
 * angular momentum. */
static double spin(const end *i, const end *j, const hk_strain_state *state, const double n[3], double ratio) {
  double u[3], sum = i->w + j->w;
  if (i->slides || j->slides) return 0;
  hk_subtract(u, state->v + j->at, state->v + i->at);
  hk_add_scaled(u, -hk_dot(u, n), n);
  hk_add_scaled(state->v + i->at, -i->w / sum * (ratio - 1), u);
  hk_add_scaled(state->v + j->at, j->w / sum * (ratio - 1), u);
  return hk_dot(u, u) * (ratio * ratio - 1) / sum / 2;
}

/* Of the two ends the one that is nearer to a pin stays, where that is the order. */
static void hold_the_nearer(const hk_strain_limits *s, const uint32_t pair[2], double w[2]) {
  if (s->order != HK_STRAIN_OUTWARDS || s->level[pair[0]] == s->level[pair[1]]) return;
  w[s->level[pair[0]] > s->level[pair[1]]] = 0;
}

static void remember(hk_strain_limits *s, uint32_t particle, const double *v) {
  if (s->is_touched[particle]) return;
  s->is_touched[particle] = true;
  hk_copy(s->before[s->remembered], v + 3 * (size_t)particle);
  s->touched[s->remembered++] = particle;
}

bool hk_strain_move(hk_strain_limits *s, size_t edge, const hk_strain_state *state) {
  const uint32_t *pair = s->pair[edge];
  double l = 0, n[3], w[2] = {state->inverse_mass[pair[0]], state->inverse_mass[pair[1]]};
  double limit = hk_strain_passed(s, edge, state->x, &l);
  if (!(limit > 0) || !(l > 0)) return false;
  hold_the_nearer(s, pair, w);
  hk_edge_difference(state->x, pair, n);
  for (int c = 0; c < 3; c++) n[c] /= l;
  const end i = end_of(s, pair[0], n, w[0]), j = end_of(s, pair[1], n, w[1]);
  double sum = i.w + j.w;
  if (!(sum > 0)) return false;
  if (state->v) {
    for (int q = 0; q < 2; q++) remember(s, pair[q], state->v);
    s->gain -= stop(&i, &j, state, n, w, l > limit);
    s->gain += spin(&i, &j, state, n, l / limit);
  }
  shift(&i, state->x, (l - limit) / sum, w[0]);
  shift(&j, state->x, (limit - l) / sum, w[1]);
  return true;
}

bool hk_strain_stop(const hk_strain_limits *s, size_t edge, const hk_strain_state *state) {
  const uint32_t *pair = s->pair[edge];
  const double *limit = s->limit[edge], w[2] = {state->inverse_mass[pair[0]], state->inverse_mass[pair[1]]};
  double n[3], l = hk_edge_difference(state->x, pair, n);
  bool longest = l >= limit[1] * (1 - s->slack);
  if (!(l > 0) || !(longest || l <= limit[0] * (1 + s->slack))) return false;
  for (int c = 0; c < 3; c++) n[c] /= l;
  const end i = end_of(s, pair[0], n, w[0]), j = end_of(s, pair[1], n, w[1]);
  return stop(&i, &j, state, n, w, longest) > 0;
}
