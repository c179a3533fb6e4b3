/* The change of a solid's forces along directions, for tangents. With U and Q the gradients of the changes of positions
 * and velocities, the stress P = dW/dF + F S(E(R)) changes by
 *     dP(U) + U S(E(R)) + F S(sym(U^T R) + E(Q)),      E(A) = sym(F^T A),
 * and by the changes of mu and lambda of both, in which it is linear (solid_transposed.c). Blocks of tetrahedra are
 * gathered once for all directions, computed in loops that compilers turn into vectors, and scattered one after the
 * other. */
#include "plugins/common/solids/solid.h"

#include "core/plugin/widest.h"

#include <math.h>

enum { BLOCK = 32 };

typedef struct block {
  double slope[3][3][BLOCK], volume[BLOCK]; /* of members 1 to 3 */
  double d[3][3][BLOCK], v[3][3][BLOCK];    /* differences from member 0: m, m/s */
  double w[3][3][BLOCK], y[3][3][BLOCK];    /* of their changes */
  double mu[2][BLOCK], lambda[2][BLOCK];    /* elastic and viscous */
  double dmu[2][BLOCK], dlambda[2][BLOCK];  /* their changes */
  double load[3][3][BLOCK];                 /* on members 1 to 3 */
} block;

typedef struct matrix {
  double e[3][3];
} matrix;

HK_INLINE matrix gradient(const block *q, double (*d)[3][BLOCK], int r) {
  matrix F;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      F.e[a][b] = d[0][a][r] * q->slope[0][b][r] + d[1][a][r] * q->slope[1][b][r] + d[2][a][r] * q->slope[2][b][r];
  return F;
}

HK_INLINE double product(const matrix *A, const matrix *B) {
  double sum = 0;
  for (int a = 0; a < 3; a++) sum += A->e[a][0] * B->e[a][0] + A->e[a][1] * B->e[a][1] + A->e[a][2] * B->e[a][2];
  return sum;
}

HK_INLINE void cross(const double a[3], const double b[3], double to[3]) {
  to[0] = a[1] * b[2] - a[2] * b[1], to[1] = a[2] * b[0] - a[0] * b[2], to[2] = a[0] * b[1] - a[1] * b[0];
}

/* The cofactor of F, whose rows are cross products of the rows of F. */
HK_INLINE matrix cofactor(const matrix *F) {
  matrix G;
  cross(F->e[1], F->e[2], G.e[0]);
  cross(F->e[2], F->e[0], G.e[1]);
  cross(F->e[0], F->e[1], G.e[2]);
  return G;
}

/* Its derivative along U. */
HK_INLINE matrix cofactor_along(const matrix *F, const matrix *U) {
  matrix G;
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    double other[3];
    cross(F->e[b], U->e[c], G.e[a]);
    cross(U->e[b], F->e[c], other);
    for (int k = 0; k < 3; k++) G.e[a][k] += other[k];
  }
  return G;
}

HK_INLINE void add(matrix *T, double part, const matrix *A) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) T->e[a][b] += part * A->e[a][b];
}

/* E += 2 sym(A^T B) */
HK_INLINE void add_strain(const matrix *A, const matrix *B, matrix *E) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      for (int k = 0; k < 3; k++) E->e[a][b] += A->e[k][a] * B->e[k][b] + A->e[k][b] * B->e[k][a];
}

/* S of E that is twice the strain. */
HK_INLINE matrix stress(double mu, double lambda, const matrix *E) {
  matrix S;
  double swell = lambda * (E->e[0][0] + E->e[1][1] + E->e[2][2]) / 2;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) S.e[a][b] = mu * E->e[a][b] + (a == b ? swell : 0);
  return S;
}

/* T += A S */
HK_INLINE void add_product(const matrix *A, const matrix *S, matrix *T) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      T->e[a][b] += A->e[a][0] * S->e[0][b] + A->e[a][1] * S->e[1][b] + A->e[a][2] * S->e[2][b];
}

/* Of P = mu I/(I + 1) F + (lambda (J - 1) - 3/4 mu) G (neo_hookean.c). */
HK_INLINE void add_elastic(block *q, const matrix *F, const matrix *U, int r, matrix *T) {
  const matrix G = cofactor(F), turn = cofactor_along(F, U);
  double mu = q->mu[0][r], lambda = q->lambda[0][r], I = product(F, F), by_I = 1 / (I + 1);
  double J = F->e[0][0] * G.e[0][0] + F->e[0][1] * G.e[0][1] + F->e[0][2] * G.e[0][2];
  add(T, mu * I * by_I, U);
  add(T, 2 * mu * by_I * by_I * product(F, U) + q->dmu[0][r] * I * by_I, F);
  add(T, lambda * product(&G, U) + q->dlambda[0][r] * (J - 1) - 0.75 * q->dmu[0][r], &G);
  add(T, lambda * (J - 1) - 0.75 * mu, &turn);
}

HK_INLINE void add_viscous(block *q, const matrix *F, const matrix *U, int r, matrix *T) {
  const matrix R = gradient(q, q->v, r), Q = gradient(q, q->y, r);
  matrix E = {{{0}}}, change = {{{0}}};
  add_strain(F, &R, &E);
  add_strain(F, &Q, &change);
  add_strain(U, &R, &change);
  const matrix S = stress(q->mu[1][r], q->lambda[1][r], &E), of_E = stress(q->mu[1][r], q->lambda[1][r], &change),
               of_mu = stress(q->dmu[1][r], q->dlambda[1][r], &E);
  matrix dS = of_E;
  add(&dS, 1, &of_mu);
  add_product(U, &S, T);
  add_product(F, &dS, T);
}

HK_INLINE void change(block *q, bool viscous) {
  for (int r = 0; r < BLOCK; r++) {
    const matrix F = gradient(q, q->d, r), U = gradient(q, q->w, r);
    matrix T = {{{0}}};
    add_elastic(q, &F, &U, r, &T);
    if (viscous) add_viscous(q, &F, &U, r, &T);
    for (int m = 0; m < 3; m++)
      for (int a = 0; a < 3; a++)
        q->load[m][a][r] = -q->volume[r] * (T.e[a][0] * q->slope[m][0][r] + T.e[a][1] * q->slope[m][1][r] +
                                            T.e[a][2] * q->slope[m][2][r]);
  }
}

HK_VERSIONS(static void, change_many, (block * q, bool viscous), viscous ? change(q, true) : change(q, false))

/* Lanes beyond get the first one's. */
static void gather(const hk_tuples *tetrahedra, const double *from, size_t first, size_t count,
                   double into[3][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(tetrahedra, first + (r < count ? r : 0));
    const double *o = from + 3 * (size_t)member[0];
    for (int m = 0; m < 3; m++)
      for (int a = 0; a < 3; a++) into[m][a][r] = from[3 * (size_t)member[m + 1] + (size_t)a] - o[a];
  }
}

static void scatter(const hk_tuples *tetrahedra, const block *q, size_t first, size_t count, double *to) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *member = hk_tuple(tetrahedra, first + r);
    for (size_t a = 0; a < 3; a++) {
      to[3 * (size_t)member[0] + a] -= q->load[0][a][r] + q->load[1][a][r] + q->load[2][a][r];
      for (size_t m = 0; m < 3; m++) to[3 * (size_t)member[m + 1] + a] += q->load[m][a][r];
    }
  }
}

static void take(const hk_solid *s, size_t first, size_t count, block *q) {
  for (size_t r = 0; r < BLOCK; r++) {
    const hk_solid_part *p = hk_solid_part_of(s, first + (r < count ? r : 0));
    for (int e = 0; e < 9; e++) q->slope[e / 3][e % 3][r] = p->shape.slope[e / 3 + 1][e % 3];
    q->volume[r] = p->shape.volume;
    q->mu[0][r] = p->elastic.mu, q->lambda[0][r] = p->elastic.lambda;
    q->mu[1][r] = p->viscous.mu, q->lambda[1][r] = p->viscous.lambda;
  }
}

/* Of the moduli of tetrahedron r with those of E, nu and the damping, which are those of tetrahedron k of the start. */
static void take_change(const hk_solid_params *given, size_t k, const double *const row[3], size_t r, block *q) {
  double nu = hk_tuple_value(&given->nu, k), by_nu = row[1] ? row[1][k] : 0, by_E = row[0] ? row[0][k] : 0,
         by_c = row[2] ? row[2][k] : 0;
  hk_solid_moduli elastic = hk_solid_moduli_along(hk_tuple_value(&given->E, k), nu, by_E, by_nu),
                  viscous = hk_solid_creep_along(hk_tuple_value(&given->damping, k), nu, by_c, by_nu);
  q->dmu[0][r] = elastic.mu, q->dlambda[0][r] = elastic.lambda;
  q->dmu[1][r] = viscous.mu, q->dlambda[1][r] = viscous.lambda;
}

static void take_changes(const hk_solid *s, const hk_solid_params *given, const double *const *row, size_t first,
                         size_t count, block *q) {
  bool any = row && (row[0] || row[1] || row[2]);
  for (size_t r = 0; r < BLOCK; r++) {
    for (int e = 0; e < 2; e++) q->dmu[e][r] = q->dlambda[e][r] = 0;
    if (any && r < count) take_change(given, s->tuples.number[first + r], row, r, q);
  }
}

void hk_solid_along(const hk_solid *s, const hk_view *view, const hk_solid_params *given, size_t row,
                    const hk_tangent *directions, size_t count_directions) {
  const hk_tuples *acting = &s->tuples.acting;
  block q;
  bool viscous = s->damped;
  for (size_t j = 0; j < count_directions; j++)
    viscous = viscous || (directions[j].parameter && directions[j].parameter[row + 2]);
  for (size_t k = 0; k < acting->count; k += BLOCK) {
    size_t count = acting->count - k < BLOCK ? acting->count - k : BLOCK;
    take(s, k, count, &q);
    gather(acting, view->x, k, count, q.d);
    if (viscous) gather(acting, view->v, k, count, q.v);
    for (const hk_tangent *t = directions; t < directions + count_directions; t++) {
      gather(acting, t->x, k, count, q.w);
      if (viscous) gather(acting, t->v, k, count, q.y);
      take_changes(s, given, t->parameter ? t->parameter + row : NULL, k, count, &q);
      HK_WIDEST(view->host->lanes, change_many)(&q, viscous);
      scatter(acting, &q, k, count, t->force);
    }
  }
}
