/* Tangents through linear steps. */
#include "core/numerics/sensitivity/linearised/linearised.h"

#include <string.h>

void hk_linearised_place(const hk_sensitivity *s, const hk_taken_step *step, const hk_carried *dZ, double *dX) {
  const hk_linear_point p = hk_linearised_at(s, step);
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) {
    dX[e] = dZ[e] + p.back * (dZ[e] - dZ[3 * v + e]) + p.g * dZ[v + e];
    dX[v + e] = dZ[v + e];
  }
}

/* d(dv) by the factors of the step: of c alone, or with d of the system of p. */
static hk_status pass(hk_sensitivity *s, const hk_linear_point *p, double *c, double *d, double *change) {
  double *of_p = s->linearised->w[6], *y = s->linearised->w[7];
  size_t v = 3 * s->n;
  hk_matrix A;
  if (!p->projected) return hk_linearised_solve(s, c, change);
  hk_status status = hk_linearised_solve(s, d, of_p);
  if (status == HK_OK) status = hk_linearised_matrix(s, p, 0, &A);
  if (status != HK_OK) return status;
  hk_linearised_product(&A, of_p, y);
  for (size_t e = 0; e < v; e++) c[e] -= y[e];
  status = hk_linearised_solve(s, c, change);
  for (size_t e = 0; e < v; e++) change[e] += of_p[e];
  return status;
}

hk_status hk_linearised_tangent(hk_sensitivity *s, const hk_taken_step *step, const hk_varied *by, const double *dX,
                                const double *da, hk_carried *dZ) {
  const hk_linear_point p = hk_linearised_at(s, step);
  const double *mass = s->dynamics->state->model.mass;
  double *c = s->linearised->w[3], *d = s->linearised->w[4], *change = s->linearised->w[5];
  double *between = s->linearised->w[6]; /* and the next one: free until `pass` */
  size_t v = 3 * s->n;
  memcpy(between, dZ + 5 * v, v * sizeof *dZ);
  memcpy(between + v, dZ, v * sizeof *dZ);
  for (size_t e = 0; e < v; e++) {
    double turn = p.back * (dZ[v + e] - dZ[4 * v + e]);
    c[e] = d[e] = mass[e / 3] * (turn + p.g * da[e]);
  }
  hk_status status = hk_linearised_change(s, &p, by, dX, between, c, d);
  if (status == HK_OK) status = pass(s, &p, c, d, change);
  for (size_t e = 0; e < v; e++) {
    double x = dZ[e], u = dZ[v + e], after = u + change[e];
    dZ[e] = x + p.back * (x - dZ[3 * v + e]) + p.g * after;
    dZ[v + e] = after;
    dZ[2 * v + e] = (after - u - p.back * (u - dZ[4 * v + e])) / p.g;
    dZ[3 * v + e] = x;
    dZ[4 * v + e] = u;
    dZ[5 * v + e] = dX[e];
  }
  return status;
}
