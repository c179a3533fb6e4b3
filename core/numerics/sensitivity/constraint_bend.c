/* Products with the second derivatives of constraints' equations, exact for the kinds that say what they are: distances
 * L - |d| have -(I - n n^T)/|d| between their ends, differences none, and ways are bilinear, so that a difference of
 * their gradients over any length is exact but for rounding. Riders stand where their carriers put them: changes follow
 * these, and what is found for riders is theirs. */
#include "core/numerics/sensitivity/constraint_bend.h"

#include "core/engine/contract/contract.h"

#include <string.h>

/* The blocks of instance k as it names them. */
typedef struct named_blocks {
  size_t first, end;
  uint32_t (*pair)[2];
} named_blocks;

static named_blocks blocks_of(const hk_constraints *c, size_t k) {
  const size_t *first = c->riding.given ? c->riding.first : c->block_first;
  return (named_blocks){first[k], first[k + 1], c->riding.given ? c->riding.pair : c->list.pair};
}

size_t hk_constraint_bend_blocks(const hk_dynamics *d) {
  const hk_constraints *c = d->constraints;
  return c->riding.given ? c->riding.given : c->blocks;
}

static void turn_distances(const named_blocks *b, const double *x, const double *dx, double (*dJ)[3]) {
  for (size_t at = b->first; at + 1 < b->end; at += 2) {
    size_t i = 3 * (size_t)b->pair[at][1], j = 3 * (size_t)b->pair[at + 1][1];
    double d[3], e[3], square = 0, along = 0;
    for (size_t c = 0; c < 3; c++) {
      d[c] = x[j + c] - x[i + c];
      e[c] = dx[j + c] - dx[i + c];
      square += d[c] * d[c];
      along += d[c] * e[c];
    }
    for (size_t c = 0; c < 3; c++) {
      dJ[at][c] = (e[c] - along / square * d[c]) / sqrt(square);
      dJ[at + 1][c] = -dJ[at][c];
    }
  }
}

static hk_status gradients_at(hk_dynamics *d, size_t k, double t, const double *x, double (*J)[3]) {
  const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
  hk_view view = hk_constraint_view(d, instance, t, x, x);
  const hk_instance *outer = hk_enter(instance);
  hk_status status = instance->plugin->constraint->jacobian(instance->self, &view, J);
  hk_leave(instance, outer);
  return hk_constraint_failed(d, instance, t, status);
}

/* By gradients where dx is as large as the scene. */
static hk_status turn_ways(hk_dynamics *d, const hk_constraint_bend *s, size_t k, const named_blocks *b, double t,
                           const double *x, const double *dx, double (*dJ)[3]) {
  size_t v = 3 * s->n;
  double size = 0, change = 0, *there = s->work + 2 * v;
  double(*less)[3] = s->beside[1] + b->first;
  for (size_t e = 0; e < v; e++) {
    size = fmax(size, fabs(x[e] - x[e % 3]));
    change = fmax(change, fabs(dx[e]));
  }
  if (!(change > 0)) return HK_OK;
  double part = (size > 0 ? size : 1) / change;
  for (size_t e = 0; e < v; e++) there[e] = x[e] + part * dx[e];
  hk_status status = gradients_at(d, k, t, there, dJ + b->first);
  for (size_t e = 0; e < v; e++) there[e] = x[e] - part * dx[e];
  if (status == HK_OK) status = gradients_at(d, k, t, there, less);
  for (size_t q = b->first; q < b->end; q++)
    for (size_t c = 0; c < 3; c++) dJ[q][c] = (dJ[q][c] - less[q - b->first][c]) / (2 * part);
  return status;
}

/* beside[0] = the derivative of all gradients along dx. */
static hk_status turn(hk_dynamics *d, const hk_constraint_bend *s, double t, const double *x, const double *dx) {
  const hk_constraints *c = d->constraints;
  size_t v = 3 * s->n, kinds = d->plugins->kind[HK_CONSTRAINT].count;
  double *moved = s->work + v, (*dJ)[3] = s->beside[0];
  hk_status status = HK_OK;
  memset(dJ, 0, hk_constraint_bend_blocks(d) * sizeof *dJ);
  memcpy(moved, dx, v * sizeof *dx);
  hk_riders_follow(c->model, moved);
  for (size_t k = 0; k < kinds && status == HK_OK; k++) {
    unsigned flags = d->plugins->kind[HK_CONSTRAINT].item[k]->plugin->constraint->flags;
    named_blocks b = blocks_of(c, k);
    if (flags & HK_DISTANCES) turn_distances(&b, x, moved, dJ);
    if (flags & HK_WAYS) status = turn_ways(d, s, k, &b, t, x, moved, dJ);
  }
  return status;
}

hk_status hk_constraint_bend_add(hk_dynamics *d, const hk_constraint_bend *s, double t, const double *x,
                                 const double *u, const double *dx, double *to) {
  const hk_constraints *c = d->constraints;
  named_blocks b = blocks_of(c, d->plugins->kind[HK_CONSTRAINT].count - 1);
  size_t v = 3 * s->n;
  double *of = s->work, (*dJ)[3] = s->beside[0];
  hk_status status = turn(d, s, t, x, dx);
  memset(of, 0, v * sizeof *of);
  for (size_t q = 0; q < b.end && status == HK_OK; q++)
    for (size_t e = 0; e < 3; e++) of[3 * (size_t)b.pair[q][1] + e] += u[b.pair[q][0]] * dJ[q][e];
  hk_riders_gather(c->model, of);
  for (size_t e = 0; e < v; e++) to[e] += of[e];
  return status;
}

hk_status hk_constraint_turn(hk_dynamics *d, const hk_constraint_bend *s, double t, const double *x, const double *dx,
                             const double *w, double *rate) {
  const hk_constraints *c = d->constraints;
  named_blocks b = blocks_of(c, d->plugins->kind[HK_CONSTRAINT].count - 1);
  double(*dJ)[3] = s->beside[0];
  hk_status status = turn(d, s, t, x, dx);
  memset(rate, 0, c->equations * sizeof *rate);
  for (size_t q = 0; q < b.end && status == HK_OK; q++)
    rate[b.pair[q][0]] += hk_constraint_dot(dJ[q], w + 3 * (size_t)b.pair[q][1]);
  return status;
}
