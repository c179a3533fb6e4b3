/* Products of a membrane for adjoints and tangents. With U and R the deformations of u and of the velocities, as f of
 * positions, u.F = -(S : e(U)) of a triangle, e(U) = (f_u.U_u, f_v.U_v, f_u.U_v + f_v.U_u), S the elastic and the
 * viscous stress (membrane_model.h). Its derivative by x is the load of dS(U) f + S U + S' R,      S' = the viscous
 * stress of the rate e(U), and that by v the load of S' f, where dS(U) is the derivative of the elastic stress along U;
 * in baraff_witkin the viscosity has the lengths beside, 1/a and 1/b. S is linear in the elasticity, and that is a
 * function of the moduli. Forwards, with U and Q the deformations of the changes of positions and velocities, S f
 * changes by dS f + S U, where dS is dS(U), the viscous stress of the change (f.Q + U.R) of the rate, and both stresses
 * of the change of the elasticity. Blocks of triangles are gathered, computed in loops that compilers turn into
 * vectors, and scattered one after the other, as in membrane_kernel.c. */
#include "plugins/common/membranes/membrane_lane.h"

#include <string.h>

typedef struct block {
  double d[2][3][BLOCK], w[2][3][BLOCK], v[2][3][BLOCK]; /* sides, m; differences of u; rates, m/s */
  double number[HK_MEMBRANE_ROWS][BLOCK];
  double first[BLOCK], second[BLOCK];          /* W' and W'', of neo_hookean; before them t */
  double x_to[2][3][BLOCK], v_to[2][3][BLOCK]; /* on corners 1 and 2 */
  /* -u.F by the elasticity, of the elastic stress and the viscous one for a damping of 1 s, times a number each; that
   * for the elasticity as it is; and by W', over c66. */
  double part[4][BLOCK], creep[BLOCK], by_slope[BLOCK];
  /* Forwards: differences of the change of velocities, and the changes of the elasticity and of W'. */
  double y[2][3][BLOCK], change[4][BLOCK], slope_change[BLOCK];
} block;

/* dS(U): the metric changes by 2 e.a, 2 e.b and e.c; il and jl: 1/|f_u|, 1/|f_v|. */
HK_MEMBRANE_INLINE hk_stress change_of(hk_membrane_model model, hk_elasticity m, hk_metric g, hk_metric e, double il,
                                       double jl, double first, double second) {
  if (model == HK_BARAFF_WITKIN)
    return (hk_stress){m.c11 * il * il * il * e.a, m.c22 * jl * jl * jl * e.b, m.c66 * e.c};
  if (model == HK_STVK) return (hk_stress){m.c11 * e.a + m.c12 * e.b, m.c12 * e.a + m.c22 * e.b, m.c66 * e.c};
  double turn = second * 2 * (e.a * g.b + e.b * g.a - g.c * e.c);
  return (hk_stress){m.c66 * (turn * g.b + 2 * first * e.b), m.c66 * (turn * g.a + 2 * first * e.a),
                     -m.c66 * (turn * g.c + first * e.c)};
}

/* T += S w */
HK_MEMBRANE_INLINE void add_stress(hk_stress S, const deformation *w, deformation *T) {
  for (int c = 0; c < 3; c++) {
    T->u[c] += S.uu * w->u[c] + S.uv * w->v[c];
    T->v[c] += S.uv * w->u[c] + S.vv * w->v[c];
  }
}

/* The load of T on corners 1 and 2; corner 0 has what balances it. */
HK_MEMBRANE_INLINE void set_load(const block *q, const deformation *T, int r, double to[2][3][BLOCK]) {
  for (int c = 0; c < 3; c++) {
    to[0][c][r] = -(q->number[HK_B0][r] * T->u[c] + q->number[HK_B1][r] * T->v[c]);
    to[1][c][r] = -(q->number[HK_B2][r] * T->u[c] + q->number[HK_B3][r] * T->v[c]);
  }
}

/* As block.part has them. */
HK_MEMBRANE_INLINE void set_parts(block *q, hk_membrane_model model, hk_elasticity m, hk_metric g, hk_metric e,
                                  hk_metric rate, double il, double jl, double damping, int r) {
  double u = model == HK_BARAFF_WITKIN ? il * il : 1, v = model == HK_BARAFF_WITKIN ? jl * jl : 1;
  hk_elasticity viscous = {u * rate.a * e.a, v * rate.b * e.b, rate.a * e.b + rate.b * e.a, rate.c * e.c}, elastic;
  double swell = g.b * e.a + g.a * e.b - g.c * e.c;
  if (model == HK_NEO_HOOKEAN)
    elastic = (hk_elasticity){0, 0, 0, e.a + e.b + q->first[r] * swell};
  else if (model == HK_BARAFF_WITKIN)
    elastic = (hk_elasticity){(1 - il) * e.a, (1 - jl) * e.b, 0, g.c * e.c};
  else
    elastic =
        (hk_elasticity){(g.a - 1) / 2 * e.a, (g.b - 1) / 2 * e.b, (g.a - 1) / 2 * e.b + (g.b - 1) / 2 * e.a, g.c * e.c};
  q->part[0][r] = elastic.c11 + damping * viscous.c11, q->part[1][r] = elastic.c22 + damping * viscous.c22;
  q->part[2][r] = elastic.c12 + damping * viscous.c12, q->part[3][r] = elastic.c66 + damping * viscous.c66;
  q->creep[r] = viscous.c11 * m.c11 + viscous.c22 * m.c22 + viscous.c12 * m.c12 + viscous.c66 * m.c66;
  q->by_slope[r] = swell;
}

HK_MEMBRANE_INLINE void compute(block *q, hk_membrane_model model, bool rates, double damping) {
  for (int r = 0; r < BLOCK; r++) {
    const hk_elasticity m = {q->number[HK_C11][r], q->number[HK_C22][r], q->number[HK_C12][r], q->number[HK_C66][r]};
    deformation f = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->d, r),
                U = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->w, r);
    deformation T = {{0, 0, 0}, {0, 0, 0}};
    hk_metric g = metric(&f), e = rate_of(&f, &U);
    double il = model == HK_BARAFF_WITKIN ? hk_inverse_length(g.a) : 1,
           jl = model == HK_BARAFF_WITKIN ? hk_inverse_length(g.b) : 1;
    add_stress(change_of(model, m, g, e, il, jl, q->first[r], q->second[r]), &f, &T);
    hk_stress S = hk_membrane_stress(model, m, g, q->first[r]);
    if (rates) {
      deformation R = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->v, r),
                  V = {{0, 0, 0}, {0, 0, 0}};
      hk_metric rate = rate_of(&f, &R);
      hk_elasticity viscosity = hk_membrane_viscosity(model, m, g, damping);
      hk_stress drag = hk_membrane_drag(viscosity, rate), other = hk_membrane_drag(viscosity, e);
      S.uu += drag.uu, S.vv += drag.vv, S.uv += drag.uv;
      add_stress(other, &R, &T);
      add_stress(other, &f, &V);
      set_load(q, &V, r, q->v_to);
      if (model == HK_BARAFF_WITKIN) { /* the lengths in its viscosity change, too */
        double a = g.a > HK_MEMBRANE_TINY ? -2 * viscosity.c11 * il * il * rate.a * e.a : 0;
        double b = g.b > HK_MEMBRANE_TINY ? -2 * viscosity.c22 * jl * jl * rate.b * e.b : 0;
        for (int c = 0; c < 3; c++) T.u[c] += a * f.u[c], T.v[c] += b * f.v[c];
      }
      set_parts(q, model, m, g, e, rate, il, jl, damping, r);
    }
    add_stress(S, &U, &T);
    set_load(q, &T, r, q->x_to);
  }
}

HK_MEMBRANE_INLINE void compute_model(block *q, hk_membrane_model model, bool rates, double damping) {
  if (model == HK_BARAFF_WITKIN)
    rates ? compute(q, HK_BARAFF_WITKIN, true, damping) : compute(q, HK_BARAFF_WITKIN, false, 0);
  else if (model == HK_STVK)
    rates ? compute(q, HK_STVK, true, damping) : compute(q, HK_STVK, false, 0);
  else
    rates ? compute(q, HK_NEO_HOOKEAN, true, damping) : compute(q, HK_NEO_HOOKEAN, false, 0);
}

/* The change of the viscosity, by the lengths, the elasticity and the damping. */
HK_MEMBRANE_INLINE hk_elasticity viscosity_change(hk_membrane_model model, hk_elasticity m, hk_elasticity dm,
                                                  hk_metric g, hk_metric e, double il, double jl, double damping,
                                                  double more) {
  hk_elasticity of = hk_membrane_viscosity(model, m, g, damping), by_m = hk_membrane_viscosity(model, dm, g, damping),
                by_damping = hk_membrane_viscosity(model, m, g, more);
  double a = model == HK_BARAFF_WITKIN && g.a > HK_MEMBRANE_TINY ? -2 * il * il * e.a : 0;
  double b = model == HK_BARAFF_WITKIN && g.b > HK_MEMBRANE_TINY ? -2 * jl * jl * e.b : 0;
  return (hk_elasticity){of.c11 * a + by_m.c11 + by_damping.c11, of.c22 * b + by_m.c22 + by_damping.c22,
                         by_m.c12 + by_damping.c12, by_m.c66 + by_damping.c66};
}

HK_MEMBRANE_INLINE hk_stress sum_of(hk_stress a, hk_stress b) {
  return (hk_stress){a.uu + b.uu, a.vv + b.vv, a.uv + b.uv};
}

/* The change of the force, in x_to. */
HK_MEMBRANE_INLINE void change(block *q, hk_membrane_model model, bool rates, double damping, double more) {
  for (int r = 0; r < BLOCK; r++) {
    const hk_elasticity m = {q->number[HK_C11][r], q->number[HK_C22][r], q->number[HK_C12][r], q->number[HK_C66][r]},
                        dm = {q->change[0][r], q->change[1][r], q->change[2][r], q->change[3][r]};
    deformation f = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->d, r),
                U = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->w, r);
    deformation T = {{0, 0, 0}, {0, 0, 0}};
    hk_metric g = metric(&f), e = rate_of(&f, &U);
    double il = model == HK_BARAFF_WITKIN ? hk_inverse_length(g.a) : 1,
           jl = model == HK_BARAFF_WITKIN ? hk_inverse_length(g.b) : 1;
    hk_stress S = hk_membrane_stress(model, m, g, q->first[r]);
    hk_stress dS = sum_of(change_of(model, m, g, e, il, jl, q->first[r], q->second[r]),
                          hk_membrane_stress(model, dm, g, q->first[r]));
    if (model == HK_NEO_HOOKEAN) {
      double swell = m.c66 * q->slope_change[r];
      dS = sum_of(dS, (hk_stress){swell * g.b, swell * g.a, -swell * g.c});
    }
    if (rates) {
      deformation R = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->v, r),
                  Q = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->y, r);
      hk_metric rate = rate_of(&f, &R), by_v = rate_of(&f, &Q), by_x = rate_of(&U, &R);
      hk_metric turn = {by_v.a + by_x.a, by_v.b + by_x.b, by_v.c + by_x.c};
      hk_elasticity viscosity = hk_membrane_viscosity(model, m, g, damping);
      S = sum_of(S, hk_membrane_drag(viscosity, rate));
      dS = sum_of(dS, hk_membrane_drag(viscosity, turn));
      dS = sum_of(dS, hk_membrane_drag(viscosity_change(model, m, dm, g, e, il, jl, damping, more), rate));
    }
    add_stress(dS, &f, &T);
    add_stress(S, &U, &T);
    set_load(q, &T, r, q->x_to);
  }
}

HK_MEMBRANE_INLINE void change_model(block *q, hk_membrane_model model, bool rates, double damping, double more) {
  if (model == HK_BARAFF_WITKIN)
    rates ? change(q, HK_BARAFF_WITKIN, true, damping, more) : change(q, HK_BARAFF_WITKIN, false, 0, 0);
  else if (model == HK_STVK)
    rates ? change(q, HK_STVK, true, damping, more) : change(q, HK_STVK, false, 0, 0);
  else
    rates ? change(q, HK_NEO_HOOKEAN, true, damping, more) : change(q, HK_NEO_HOOKEAN, false, 0, 0);
}

/* t, in the place of W'. */
HK_MEMBRANE_INLINE void volumes(block *q) {
  for (int r = 0; r < BLOCK; r++) {
    deformation f = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->d, r);
    hk_metric g = metric(&f);
    q->first[r] = g.a * g.b - g.c * g.c;
  }
}

HK_VERSIONS(static void, volumes_of, (block * q), volumes(q))
HK_VERSIONS(static void, compute_many, (block * q, hk_membrane_model model, bool rates, double damping),
            compute_model(q, model, rates, damping))
HK_VERSIONS(static void, change_many, (block * q, hk_membrane_model model, bool rates, double damping, double more),
            change_model(q, model, rates, damping, more))

/* ---- by parameters ----------------------------------------------------------------------------------------------- */

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

static double product(const double a[4], hk_elasticity b) {
  return a[0] * b.c11 + a[1] * b.c22 + a[2] * b.c12 + a[3] * b.c66;
}

/* How the elasticity of triangle t of the start changes with the numbers of the force. */
typedef struct changes {
  hk_elasticity by_u, by_v, by_nu;
} changes;

static changes changes_of(const hk_membrane_params *p, size_t t) {
  bool weft = p->weft.count, shear = p->shear.count;
  moduli of = {.u = hk_tuple_value(&p->stiffness, t), .nu = p->nu};
  of.v = weft ? hk_tuple_value(&p->weft, t) : of.u;
  of.shear = sqrt(of.u * of.v) / (2 * (1 + p->nu)); /* where it is not given */
  double half = shear ? 0 : of.shear / 2;
  moduli by_u = {1, !weft, half * (1 / of.u + (weft ? 0 : 1 / of.v)), 0}, by_v = {0, 1, half / of.v, 0};
  moduli by_nu = {0, 0, -2 * half / (1 + p->nu), 1};
  return (changes){elasticity_by(of, by_u), elasticity_by(of, by_v), elasticity_by(of, by_nu)};
}

/* Whether a number for all triangles stands for each of them. */
static bool has_one(const hk_membrane_params *p) { return p->stiffness.count <= 1 && p->weft.count <= 1; }

static void add_slopes(const hk_membrane *m, const hk_membrane_params *p, const block *q, const double *t, size_t begin,
                       size_t count, double *const row[5]) {
  bool weft = p->weft.count, shear = p->shear.count;
  bool one = has_one(p);
  changes by = changes_of(p, m->number[begin]);
  for (size_t r = 0; r < count; r++) {
    size_t start = m->number[begin + r], at = p->triangles.count ? start : 0;
    double B = q->number[HK_B0][r] * q->number[HK_B3][r] - q->number[HK_B1][r] * q->number[HK_B2][r];
    double area = 0.5 / fabs(B), part[4] = {q->part[0][r], q->part[1][r], q->part[2][r], q->part[3][r]};
    if (!one) by = changes_of(p, start);
    row[BY_DAMPING][0] -= q->creep[r];
    row[BY_STIFFNESS][at] -= area * product(part, by.by_u);
    if (weft) row[BY_WEFT][at] -= area * product(part, by.by_v);
    if (shear) row[BY_SHEAR][at] -= area * part[3];
    row[BY_NU][0] -= area * product(part, by.by_nu);
    if (m->model != HK_NEO_HOOKEAN) continue;
    double by_n = slope_by_exponent(t[r], m->exponent) / ((1 - p->nu) * (1 - p->nu));
    row[BY_NU][0] -= q->number[HK_C66][r] * by_n * q->by_slope[r];
  }
}

static double part_of(const double *list, size_t at) { return list ? list[at] : 0; }

/* Of the elasticity per area, with the parameters. */
static hk_elasticity elasticity_along(const hk_membrane_params *p, changes by, size_t start,
                                      const double *const row[5]) {
  size_t at = p->triangles.count ? start : 0;
  double u = part_of(row[BY_STIFFNESS], at), nu = part_of(row[BY_NU], 0),
         v = p->weft.count ? part_of(row[BY_WEFT], at) : 0, shear = p->shear.count ? part_of(row[BY_SHEAR], at) : 0;
  return (hk_elasticity){u * by.by_u.c11 + v * by.by_v.c11 + nu * by.by_nu.c11,
                         u * by.by_u.c22 + v * by.by_v.c22 + nu * by.by_nu.c22,
                         u * by.by_u.c12 + v * by.by_v.c12 + nu * by.by_nu.c12,
                         u * by.by_u.c66 + v * by.by_v.c66 + nu * by.by_nu.c66 + shear};
}

static void take_changes(const hk_membrane *m, const hk_membrane_params *p, const double *t, size_t begin, size_t count,
                         const double *const row[5], block *q) {
  double nu = row ? part_of(row[BY_NU], 0) : 0;
  memset(q->change, 0, sizeof q->change);
  memset(q->slope_change, 0, sizeof q->slope_change);
  if (!row || (!row[BY_STIFFNESS] && !row[BY_WEFT] && !row[BY_SHEAR] && !row[BY_NU])) return;
  bool one = has_one(p);
  changes of = changes_of(p, m->number[begin]);
  for (size_t r = 0; r < count; r++) {
    double B = q->number[HK_B0][r] * q->number[HK_B3][r] - q->number[HK_B1][r] * q->number[HK_B2][r];
    double area = 0.5 / fabs(B);
    if (!one) of = changes_of(p, m->number[begin + r]);
    const hk_elasticity by = elasticity_along(p, of, m->number[begin + r], row);
    q->change[0][r] = area * by.c11, q->change[1][r] = area * by.c22;
    q->change[2][r] = area * by.c12, q->change[3][r] = area * by.c66;
    if (m->model == HK_NEO_HOOKEAN && nu != 0)
      q->slope_change[r] = nu * slope_by_exponent(t[r], m->exponent) / ((1 - p->nu) * (1 - p->nu));
  }
}

/* ---- blocks ------------------------------------------------------------------------------------------------------ */

/* The sides of the triangles from `begin` on, of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, size_t begin, size_t count, double into[2][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *corner = hk_tuple(node, begin + (r < count ? r : 0));
    const double *o = from + 3 * (size_t)corner[0], *p = from + 3 * (size_t)corner[1],
                 *q = from + 3 * (size_t)corner[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = p[c] - o[c], into[1][c][r] = q[c] - o[c];
  }
}

static void scatter(const hk_tuples *node, const double by[2][3][BLOCK], size_t begin, size_t count, double *to) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *corner = hk_tuple(node, begin + r);
    double *a = to + 3 * (size_t)corner[0], *b = to + 3 * (size_t)corner[1], *d = to + 3 * (size_t)corner[2];
    for (int c = 0; c < 3; c++) {
      a[c] -= by[0][c][r] + by[1][c][r];
      b[c] += by[0][c][r];
      d[c] += by[1][c][r];
    }
  }
}

static void take(const hk_membrane *m, size_t begin, size_t count, block *q) {
  for (size_t k = 0; k < HK_MEMBRANE_ROWS; k++)
    for (size_t r = 0; r < BLOCK; r++) q->number[k][r] = m->row[k][begin + (r < count ? r : 0)];
}

static void take_volumes(const hk_membrane *m, int lanes, double t[BLOCK], block *q) {
  HK_WIDEST(lanes, volumes_of)(q);
  for (size_t r = 0; r < BLOCK; r++) {
    t[r] = q->first[r];
    q->first[r] = hk_volume_slope(t[r], m->exponent);
    q->second[r] = hk_volume_bend(t[r], m->exponent, q->first[r]);
  }
}

void hk_membrane_transposed(const hk_membrane *m, const hk_view *view, const hk_membrane_params *given, const double *u,
                            const hk_transposed *into, double *const row[5]) {
  bool rates = m->damping > 0 || row;
  double t[BLOCK] = {0};
  block q = {.first = {0}, .second = {0}};
  for (size_t k = 0; k < m->node.count; k += BLOCK) {
    size_t count = m->node.count - k < BLOCK ? m->node.count - k : BLOCK;
    gather(&m->node, view->x, k, count, q.d);
    gather(&m->node, u, k, count, q.w);
    if (rates) gather(&m->node, view->v, k, count, q.v);
    take(m, k, count, &q);
    if (m->model == HK_NEO_HOOKEAN) take_volumes(m, view->host->lanes, t, &q);
    HK_WIDEST(view->host->lanes, compute_many)(&q, m->model, rates, m->damping);
    scatter(&m->node, (const double(*)[3][BLOCK])q.x_to, k, count, into->x);
    if (m->damping > 0) scatter(&m->node, (const double(*)[3][BLOCK])q.v_to, k, count, into->v);
    if (row) add_slopes(m, given, &q, t, k, count, row);
  }
}

void hk_membrane_along(const hk_membrane *m, const hk_view *view, const hk_membrane_params *given, size_t row,
                       const hk_tangent *directions, size_t count_directions) {
  bool rates = m->damping > 0;
  double t[BLOCK] = {0};
  block q = {.first = {0}, .second = {0}};
  for (size_t j = 0; j < count_directions; j++)
    rates = rates || (directions[j].parameter && directions[j].parameter[row + BY_DAMPING]);
  for (size_t k = 0; k < m->node.count; k += BLOCK) {
    size_t count = m->node.count - k < BLOCK ? m->node.count - k : BLOCK;
    gather(&m->node, view->x, k, count, q.d);
    if (rates) gather(&m->node, view->v, k, count, q.v);
    take(m, k, count, &q);
    if (m->model == HK_NEO_HOOKEAN) take_volumes(m, view->host->lanes, t, &q);
    for (const hk_tangent *d = directions; d < directions + count_directions; d++) {
      const double *const *of = d->parameter ? d->parameter + row : NULL;
      gather(&m->node, d->x, k, count, q.w);
      if (rates) gather(&m->node, d->v, k, count, q.y);
      take_changes(m, given, t, k, count, of, &q);
      HK_WIDEST(view->host->lanes, change_many)(&q, m->model, rates, m->damping, of ? part_of(of[BY_DAMPING], 0) : 0);
      scatter(&m->node, (const double(*)[3][BLOCK])q.x_to, k, count, d->force);
    }
  }
}
