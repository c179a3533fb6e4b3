/* The blocks of a solid, -dF/dx and -dF/dv, and a bound of its stiffness.
 *
 * A chunk of element matrices is computed by several threads, and then added by one. Under HK_WANT_DEFINITE the elastic
 * Hessian is projected by its eigenvectors, and of the damping -dF/dv alone is left, which is never negative.
 *
 * The bound: with slopes b_m of the members' shape functions, a change u of positions changes F by sum of u_m b_m^T.
 * For a Hessian of at most h that costs volume h |sum u_m b_m^T|^2 <= volume h (sum |b_q| r_q) sum |b_m| u_m^2/r_m by
 * Cauchy and Schwarz, for any r_m > 0; r_m^2 = 1/mass makes the bound of the frequencies smallest. The term of the
 * volume, lambda (g.u)^2, is bounded by itself in the same way, along the directions g_m. */
#include "plugins/common/solids/solid.h"

#include "plugins/common/solids/matrix3.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* ---- blocks ------------------------------------------------------------------------------------------------------ */

void hk_solid_pattern(const hk_solid *s, hk_pattern *pattern) {
  for (size_t k = 0; k < s->tuples.acting.count; k++) {
    const uint32_t *member = hk_tuple(&s->tuples.acting, k);
    for (int b = 0; b < 16; b++) pattern->block(pattern, member[b / 4], member[b % 4]);
  }
}

typedef struct task {
  hk_solid *s;
  const hk_view *view;
  size_t first; /* tetrahedron */
  unsigned want;
} task;

static void matrices_of(const task *t, size_t k, double K[144], double D[144]) {
  const hk_solid_part *p = hk_solid_part_of(t->s, k);
  const uint32_t *member = hk_tuple(&t->s->tuples.acting, k);
  bool definite = t->want & HK_WANT_DEFINITE, symmetric = t->want & HK_WANT_SYMMETRIC;
  double F[9], rate[9], H[81], viscous[81], by_rate[81];
  hk_tetrahedron_gradient(&p->shape, t->view->x, member, F);
  (definite ? hk_neo_hookean_definite : hk_neo_hookean_hessian)(p->elastic, F, H);
  if (p->viscous.mu > 0) {
    hk_tetrahedron_gradient(&p->shape, t->view->v, member, rate);
    hk_viscosity_derivatives(p->viscous, F, rate, !definite && !symmetric, definite, viscous, by_rate);
    for (int e = 0; e < 81; e++) H[e] += viscous[e];
    hk_tetrahedron_matrix(&p->shape, by_rate, D);
  }
  hk_tetrahedron_matrix(&p->shape, H, K);
}

static void matrices_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) matrices_of(t, t->first + k, t->s->matrix[k][0], t->s->matrix[k][1]);
}

static void scatter(const double A[144], const size_t slot[16], double *into) {
  for (int b = 0; b < 16; b++) {
    double *to = into + 9 * slot[b];
    const double *from = A + 36 * (b / 4) + 3 * (b % 4);
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++) to[3 * r + c] += from[12 * r + c];
  }
}

void hk_solid_jacobian(hk_solid *s, const hk_view *view, const hk_blocks *into) {
  size_t count = s->tuples.acting.count, part;
  for (size_t first = 0; first < count; first += part) {
    task t = {s, view, first, into->want};
    part = count - first < HK_SOLID_GRAIN ? count - first : HK_SOLID_GRAIN;
    view->host->parallel_for(view->host, part, HK_SOLID_GRAIN / 8, matrices_chunk, &t);
    for (size_t k = 0; k < part; k++) {
      scatter(s->matrix[k][0], into->slot + 16 * (first + k), into->K);
      if (hk_solid_part_of(s, first + k)->viscous.mu > 0)
        scatter(s->matrix[k][1], into->slot + 16 * (first + k), into->D);
    }
  }
}

/* ---- bound of the stiffness -------------------------------------------------------------------------------------- */

/* Adds what bounds volume (value |sum u_m b_m^T|^2 + square (sum g_m.u_m)^2). */
static void add_bound(const hk_view *view, const hk_tetrahedron *shape, const uint32_t member[4], double value,
                      double square, const double G[9], double (*block)[6]) {
  double r[4], g[4][3], slopes = 0, sizes = 0;
  for (int m = 0; m < 4; m++) {
    r[m] = sqrt(view->model->inverse_mass[member[m]]);
    for (int c = 0; c < 3; c++) g[m][c] = hk_dot(G + 3 * c, shape->slope[m]);
    slopes += r[m] * hk_length(shape->slope[m]);
    sizes += r[m] * hk_length(g[m]);
  }
  for (int m = 0; m < 4; m++) {
    double *b = block[member[m]], size = hk_length(g[m]);
    if (r[m] == 0) continue; /* held: u is 0 */
    double all = shape->volume * value * slopes * hk_length(shape->slope[m]) / r[m];
    double along = size > 0 ? shape->volume * square * sizes / (size * r[m]) : 0;
    for (int e = 0, row = 0; row < 3; row++)
      for (int c = row; c < 3; c++, e++) b[e] += (row == c ? all : 0) + along * g[m][row] * g[m][c];
  }
}

static double square_of(const double F[9]) {
  double sum = 0;
  for (int e = 0; e < 9; e++) sum += F[e] * F[e];
  return sum;
}

void hk_solid_stiffness_bound(const hk_solid *s, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  for (size_t k = 0; k < s->tuples.acting.count; k++) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    const uint32_t *member = hk_tuple(&s->tuples.acting, k);
    double F[9], G[9];
    hk_tetrahedron_gradient(&p->shape, view->x, member, F);
    hk_matrix3_cofactor(F, G);
    if (part == HK_DAMPING_WHOLE) /* 2 mu |sym(F^T u)|^2 + lambda (F : u)^2 */
      add_bound(view, &p->shape, member, 2 * p->viscous.mu * square_of(F), p->viscous.lambda, F, block);
    else
      add_bound(view, &p->shape, member, hk_neo_hookean_bound(p->elastic, F), p->elastic.lambda, G, block);
  }
}
