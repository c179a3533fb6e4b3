/* Products of a membrane for adjoints. With U and R the deformations of u and of the velocities, as f of positions,
 * u.F = -(S : e(U)) of a triangle, e(U) = (f_u.U_u, f_v.U_v, f_u.U_v + f_v.U_u), S the elastic and the viscous stress
 * (membrane_model.h). Its derivative by x is the load of
 *     dS(U) f + S U + S' R,      S' = the viscous stress of the rate e(U),
 * and that by v the load of S' f, where dS(U) is the derivative of the elastic stress along U; in baraff_witkin the
 * viscosity has the lengths beside, 1/a and 1/b. S is linear in the elasticity, and that is a function of the moduli.
 */
#include "plugins/common/membranes/membrane.h"

#include "plugins/kit/vector3.h"

typedef struct state {
  double f[2][3], U[2][3], R[2][3];
  hk_metric g, e, rate;   /* of f; e(U); of R */
  hk_elasticity m;        /* of the triangle */
  hk_volume_term W;       /* of neo_hookean */
  double damping, il, jl; /* s; 1/|f_u|, 1/|f_v| where the viscosity has them, and 1 */
} state;

static hk_metric rate_of(const double f[2][3], const double w[2][3]) {
  return (hk_metric){hk_dot(f[0], w[0]), hk_dot(f[1], w[1]), hk_dot(f[0], w[1]) + hk_dot(f[1], w[0])};
}

static state state_of(const hk_membrane *m, const hk_view *view, const double *u, size_t k) {
  state s = {.m = hk_membrane_elasticity(m, k), .damping = m->damping, .il = 1, .jl = 1};
  hk_membrane_deformation(m, k, view->x, s.f);
  hk_membrane_deformation(m, k, u, s.U);
  hk_membrane_deformation(m, k, view->v, s.R);
  s.g = hk_membrane_metric((const double(*)[3])s.f);
  s.e = rate_of((const double(*)[3])s.f, (const double(*)[3])s.U);
  s.rate = rate_of((const double(*)[3])s.f, (const double(*)[3])s.R);
  if (m->model == HK_NEO_HOOKEAN) s.W = hk_volume_term_at(s.g.a * s.g.b - s.g.c * s.g.c, m->exponent);
  if (m->model == HK_BARAFF_WITKIN) s.il = hk_inverse_length(s.g.a), s.jl = hk_inverse_length(s.g.b);
  return s;
}

/* dS(U): the metric changes by 2 e.a, 2 e.b and e.c. */
static hk_stress change_of(hk_membrane_model model, const state *s) {
  const hk_elasticity *m = &s->m;
  const hk_metric *g = &s->g, *e = &s->e;
  if (model == HK_BARAFF_WITKIN)
    return (hk_stress){m->c11 * s->il * s->il * s->il * e->a, m->c22 * s->jl * s->jl * s->jl * e->b, m->c66 * e->c};
  if (model == HK_STVK) return (hk_stress){m->c11 * e->a + m->c12 * e->b, m->c12 * e->a + m->c22 * e->b, m->c66 * e->c};
  double turn = s->W.second * 2 * (e->a * g->b + e->b * g->a - g->c * e->c);
  return (hk_stress){m->c66 * (turn * g->b + 2 * s->W.first * e->b), m->c66 * (turn * g->a + 2 * s->W.first * e->a),
                     -m->c66 * (turn * g->c + s->W.first * e->c)};
}

/* T += S w */
static void add_stress(hk_stress S, const double w[2][3], double T[2][3]) {
  hk_add_scaled(T[0], S.uu, w[0]);
  hk_add_scaled(T[0], S.uv, w[1]);
  hk_add_scaled(T[1], S.uv, w[0]);
  hk_add_scaled(T[1], S.vv, w[1]);
}

static void add_load(const hk_membrane *m, size_t k, const double T[2][3], double *to) {
  const uint32_t *corner = hk_tuple(&m->node, k);
  for (size_t c = 0; c < 3; c++) {
    double first = m->row[HK_B0][k] * T[0][c] + m->row[HK_B1][k] * T[1][c];
    double second = m->row[HK_B2][k] * T[0][c] + m->row[HK_B3][k] * T[1][c];
    to[3 * (size_t)corner[0] + c] += first + second;
    to[3 * (size_t)corner[1] + c] -= first;
    to[3 * (size_t)corner[2] + c] -= second;
  }
}

static void add_viscous(hk_membrane_model model, const state *s, double by_x[2][3], double by_v[2][3]) {
  hk_elasticity viscosity = hk_membrane_viscosity(model, s->m, s->g, s->damping);
  hk_stress drag = hk_membrane_drag(viscosity, s->rate), other = hk_membrane_drag(viscosity, s->e);
  add_stress(drag, (const double(*)[3])s->U, by_x);
  add_stress(other, (const double(*)[3])s->R, by_x);
  add_stress(other, (const double(*)[3])s->f, by_v);
  if (model != HK_BARAFF_WITKIN) return;
  if (s->g.a > HK_MEMBRANE_TINY)
    hk_add_scaled(by_x[0], -2 * viscosity.c11 * s->il * s->il * s->rate.a * s->e.a, s->f[0]);
  if (s->g.b > HK_MEMBRANE_TINY)
    hk_add_scaled(by_x[1], -2 * viscosity.c22 * s->jl * s->jl * s->rate.b * s->e.b, s->f[1]);
}

/* ---- by parameters ----------------------------------------------------------------------------------------------- */

/* -u.F by the elasticity, of the elastic stress and of the viscous one for a damping of 1 s. */
static hk_elasticity elastic_part(hk_membrane_model model, const state *s) {
  const hk_metric *g = &s->g, *e = &s->e;
  double eu = (g->a - 1) / 2, ev = (g->b - 1) / 2;
  if (model == HK_NEO_HOOKEAN)
    return (hk_elasticity){.c66 = e->a + e->b + s->W.first * (g->b * e->a + g->a * e->b - g->c * e->c)};
  if (model == HK_BARAFF_WITKIN) return (hk_elasticity){(1 - s->il) * e->a, (1 - s->jl) * e->b, 0, g->c * e->c};
  return (hk_elasticity){eu * e->a, ev * e->b, ev * e->a + eu * e->b, g->c * e->c};
}

static hk_elasticity viscous_part(const state *s) {
  const hk_metric *r = &s->rate, *e = &s->e;
  return (hk_elasticity){s->il * s->il * r->a * e->a, s->jl * s->jl * r->b * e->b, r->a * e->b + r->b * e->a,
                         r->c * e->c};
}

static double product(hk_elasticity a, hk_elasticity b) {
  return a.c11 * b.c11 + a.c22 * b.c22 + a.c12 * b.c12 + a.c66 * b.c66;
}

/* dW'/dn; below least, where W goes on as its parabola, of that (membrane_model.h). */
static double slope_by_exponent(double t, double n) {
  const double least = 0.01;
  if (t >= least) return -log(t) * hk_volume_slope(t, n);
  double first = hk_volume_slope(least, n), by_n = -log(least) * first;
  return by_n - (t - least) * (first + (n + 1) * by_n) / least;
}

/* The moduli of a triangle, and the elasticity per area as membrane_rest.c has it: how it changes with them. */
typedef struct moduli {
  double u, v, shear, nu;
} moduli;

static hk_elasticity elasticity_by(moduli at, moduli change) {
  double ratio = at.v / at.u, rest = 1 - at.nu * at.nu * ratio;
  double turn = -2 * at.nu * ratio * change.nu - at.nu * at.nu * (change.v - ratio * change.u) / at.u;
  return (hk_elasticity){(change.u - at.u / rest * turn) / rest, (change.v - at.v / rest * turn) / rest,
                         (change.nu * at.v + at.nu * change.v - at.nu * at.v / rest * turn) / rest, change.shear};
}

enum { BY_STIFFNESS, BY_WEFT, BY_SHEAR, BY_NU, BY_DAMPING };

static void add_slopes(const hk_membrane *m, const hk_membrane_params *p, const state *s, size_t k,
                       double *const row[5]) {
  size_t t = m->number[k], at = p->triangles.count ? t : 0;
  double area = 0.5 / fabs(m->row[HK_B0][k] * m->row[HK_B3][k] - m->row[HK_B1][k] * m->row[HK_B2][k]);
  hk_elasticity viscous = viscous_part(s), part = elastic_part(m->model, s);
  row[BY_DAMPING][0] -= product(viscous, s->m);
  part = (hk_elasticity){part.c11 + s->damping * viscous.c11, part.c22 + s->damping * viscous.c22,
                         part.c12 + s->damping * viscous.c12, part.c66 + s->damping * viscous.c66};
  bool weft = p->weft.count, shear = p->shear.count;
  moduli of = {.u = hk_tuple_value(&p->stiffness, t), .nu = p->nu};
  of.v = weft ? hk_tuple_value(&p->weft, t) : of.u;
  of.shear = sqrt(of.u * of.v) / (2 * (1 + p->nu)); /* where it is not given */
  double half = shear ? 0 : of.shear / 2;
  moduli by_u = {1, !weft, half * (1 / of.u + (weft ? 0 : 1 / of.v)), 0}, by_v = {0, 1, half / of.v, 0};
  moduli by_nu = {0, 0, -2 * half / (1 + p->nu), 1};
  row[BY_STIFFNESS][at] -= area * product(part, elasticity_by(of, by_u));
  if (weft) row[BY_WEFT][at] -= area * product(part, elasticity_by(of, by_v));
  if (shear) row[BY_SHEAR][at] -= area * part.c66;
  row[BY_NU][0] -= area * product(part, elasticity_by(of, by_nu));
  if (m->model != HK_NEO_HOOKEAN) return;
  const hk_metric *g = &s->g, *e = &s->e;
  double by_n = slope_by_exponent(g->a * g->b - g->c * g->c, m->exponent) / ((1 - p->nu) * (1 - p->nu));
  row[BY_NU][0] -= s->m.c66 * by_n * (g->b * e->a + g->a * e->b - g->c * e->c);
}

void hk_membrane_transposed(const hk_membrane *m, const hk_view *view, const hk_membrane_params *given, const double *u,
                            const hk_transposed *into, double *const row[5]) {
  for (size_t k = 0; k < m->node.count; k++) {
    double by_x[2][3] = {{0}}, by_v[2][3] = {{0}};
    state s = state_of(m, view, u, k);
    add_stress(change_of(m->model, &s), (const double(*)[3])s.f, by_x);
    add_stress(hk_membrane_stress(m->model, s.m, s.g, s.W.first), (const double(*)[3])s.U, by_x);
    if (m->damping > 0) {
      add_viscous(m->model, &s, by_x, by_v);
      add_load(m, k, (const double(*)[3])by_v, into->v);
    }
    add_load(m, k, (const double(*)[3])by_x, into->x);
    if (row) add_slopes(m, given, &s, k, row);
  }
}
