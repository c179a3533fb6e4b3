/* Gragg's method: the midpoint rule in m substeps of h/m,
 *     d_1 = h/m f(X),  d_(i+1) = d_(i-1) + 2 h/m f(X + d_i),
 * has an error in even powers of h/m for even m, so that its results for m = 2, 4, 6, 8 give one of order 8:
 *     d = sum w_m d_m,  w_m = product over the other numbers p of m^2/(m^2 - p^2).
 * Hairer, Norsett and Wanner, Solving ODEs I, II.8 and II.9. */
#include "plugins/common/integrate/extrapolation.h"

#include <string.h>

enum { COLUMNS = 4 };
static const int substeps[COLUMNS] = {2, 4, 6, 8};
static const double weight[COLUMNS] = {-1.0 / 360, 16.0 / 45, -729.0 / 280, 1024.0 / 315};

typedef struct midpoint {
  double *change;         /* shaped as X, as are the following */
  double *before, *after; /* d_(i-1) and d_i, exchanged in every substep */
  double *state, *rates;  /* X + d_i, and f there */
} midpoint;

static void add(double *restrict to, const double *restrict from, size_t count, double by) {
  for (size_t e = 0; e < count; e++) to[e] += by * from[e];
}

static hk_status advance(midpoint *m, hk_system *s, double t, double by) {
  for (size_t e = 0; e < s->size; e++) m->state[e] = s->X[e] + m->after[e];
  hk_status status = s->rates(s, t, m->state, m->rates);
  if (status != HK_OK) return status;
  add(m->before, m->rates, s->size, by);
  double *swap = m->before;
  m->before = m->after, m->after = swap;
  return HK_OK;
}

static hk_status add_column(midpoint *m, hk_system *s, double h, const double *slope, int column) {
  size_t v = 3 * s->n;
  int parts = substeps[column];
  double part = h / parts;
  memset(m->before, 0, s->size * sizeof *m->before);
  memset(m->after, 0, s->size * sizeof *m->after);
  add(m->after, s->X + v, v, part);
  add(m->after + v, slope, s->size - v, part);
  for (int i = 1; i < parts; i++) {
    hk_status status = advance(m, s, s->t + i * part, 2 * part);
    if (status != HK_OK) return status;
  }
  add(m->change, m->after, s->size, weight[column]);
  return HK_OK;
}

hk_status hk_extrapolated_change(hk_system *s, double h, const double *slope, double *k, const double **change) {
  midpoint m = {k, k + s->size, k + 2 * s->size, k + 3 * s->size, k + 4 * s->size};
  memset(m.change, 0, s->size * sizeof *m.change);
  for (int column = 0; column < COLUMNS; column++) {
    hk_status status = add_column(&m, s, h, slope, column);
    if (status != HK_OK) return status;
  }
  *change = m.change;
  return HK_OK;
}
