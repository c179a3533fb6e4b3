/* Forces and energy of membranes. Blocks of triangles are gathered, computed in loops that compilers turn into vectors,
 * and scattered one after the other, part by part (part_sums.h). Every width of vectors does the same
 * operations, so their results are bitwise equal. */
#include "plugins/common/membranes/membrane_lane.h"

#include "plugins/kit/vector3.h"

typedef struct block {
  double d[2][3][BLOCK], u[2][3][BLOCK]; /* sides, m, and their rates, m/s */
  double number[HK_MEMBRANE_ROWS][BLOCK];
  double slope[BLOCK];   /* W', of neo_hookean */
  double f[2][3][BLOCK]; /* N, on corners 1 and 2 */
  double power[BLOCK];   /* W, taken by damping */
} block;

/* t, in place of the slope. */
HK_MEMBRANE_INLINE void volumes(block *q) {
  for (int r = 0; r < BLOCK; r++) {
    deformation f = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->d, r);
    hk_metric g = metric(&f);
    q->slope[r] = g.a * g.b - g.c * g.c;
  }
}

HK_MEMBRANE_INLINE void compute(block *q, hk_membrane_model model, bool damped, double damping) {
  for (int r = 0; r < BLOCK; r++) {
    const hk_elasticity m = {q->number[HK_C11][r], q->number[HK_C22][r], q->number[HK_C12][r], q->number[HK_C66][r]};
    deformation f = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->d, r);
    hk_metric g = metric(&f);
    hk_stress s = hk_membrane_stress(model, m, g, q->slope[r]);
    if (damped) {
      deformation w = deform((const double(*)[BLOCK])q->number, (const double(*)[3][BLOCK])q->u, r);
      hk_metric rate = rate_of(&f, &w);
      hk_stress drag = hk_membrane_drag(hk_membrane_viscosity(model, m, g, damping), rate);
      q->power[r] = drag.uu * rate.a + drag.vv * rate.b + drag.uv * rate.c;
      s.uu += drag.uu, s.vv += drag.vv, s.uv += drag.uv;
    }
    for (int c = 0; c < 3; c++) {
      double u = s.uu * f.u[c] + s.uv * f.v[c], v = s.uv * f.u[c] + s.vv * f.v[c];
      q->f[0][c][r] = -(q->number[HK_B0][r] * u + q->number[HK_B1][r] * v);
      q->f[1][c][r] = -(q->number[HK_B2][r] * u + q->number[HK_B3][r] * v);
    }
  }
}

HK_MEMBRANE_INLINE void compute_model(block *q, hk_membrane_model model, double damping) {
  if (model == HK_BARAFF_WITKIN)
    damping > 0 ? compute(q, HK_BARAFF_WITKIN, true, damping) : compute(q, HK_BARAFF_WITKIN, false, 0);
  else if (model == HK_STVK)
    damping > 0 ? compute(q, HK_STVK, true, damping) : compute(q, HK_STVK, false, 0);
  else
    damping > 0 ? compute(q, HK_NEO_HOOKEAN, true, damping) : compute(q, HK_NEO_HOOKEAN, false, 0);
}

HK_VERSIONS(static void, volumes_of, (block * q), volumes(q))
HK_VERSIONS(static void, compute_many, (block * q, hk_membrane_model model, double damping),
            compute_model(q, model, damping))

typedef struct task {
  const hk_membrane *m;
  int lanes;
} task;

/* The sides of the triangles `item` of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, const uint32_t *item, size_t count,
                   double into[2][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *corner = hk_tuple(node, item[r < count ? r : 0]);
    const double *o = from + 3 * (size_t)corner[0], *p = from + 3 * (size_t)corner[1],
                 *q = from + 3 * (size_t)corner[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = p[c] - o[c], into[1][c][r] = q[c] - o[c];
  }
}

static void take(const hk_membrane *m, const uint32_t *item, size_t count, block *q) {
  for (size_t k = 0; k < HK_MEMBRANE_ROWS; k++)
    for (size_t r = 0; r < BLOCK; r++) q->number[k][r] = m->row[k][item[r < count ? r : 0]];
}

static void scatter(const hk_tuples *node, const block *q, const uint32_t *item, size_t count, double *F) {
  for (size_t r = 0; r < count; r++) {
    const uint32_t *corner = hk_tuple(node, item[r]);
    double *a = F + 3 * (size_t)corner[0], *b = F + 3 * (size_t)corner[1], *d = F + 3 * (size_t)corner[2];
    for (int c = 0; c < 3; c++) {
      a[c] -= q->f[0][c][r] + q->f[1][c][r];
      b[c] += q->f[0][c][r];
      d[c] += q->f[1][c][r];
    }
  }
}

static double one_block(const task *t, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_membrane *m = t->m;
  block q;
  double power = 0;
  gather(&m->node, view->x, item, count, q.d);
  take(m, item, count, &q);
  if (m->damping > 0) gather(&m->node, view->v, item, count, q.u);
  if (m->model == HK_NEO_HOOKEAN) {
    HK_WIDEST(t->lanes, volumes_of)(&q);
    for (size_t r = 0; r < BLOCK; r++) q.slope[r] = hk_volume_slope(q.slope[r], m->exponent);
  }
  HK_WIDEST(t->lanes, compute_many)(&q, m->model, m->damping);
  scatter(&m->node, &q, item, count, F);
  for (size_t r = 0; r < count && m->damping > 0; r++) power -= q.power[r];
  return power;
}

static double add_items(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  double power = 0;
  for (size_t k = 0; k < count; k += BLOCK)
    power += one_block(context, view, item + k, count - k < BLOCK ? count - k : BLOCK, F);
  return power;
}

void hk_membrane_forces(const hk_membrane *m, const hk_view *view, size_t part, double *F) {
  const task t = {m, view->host->lanes};
  hk_part_sums_add(&m->sums, view, part, add_items, &t, F);
}

/* ---- one triangle ------------------------------------------------------------------------------------------------ */

void hk_membrane_deformation(const hk_membrane *m, size_t k, const double *x, double f[2][3]) {
  const uint32_t *corner = hk_tuple(&m->node, k);
  double d[2][3];
  for (int s = 0; s < 2; s++) hk_subtract(d[s], x + 3 * (size_t)corner[s + 1], x + 3 * (size_t)corner[0]);
  for (int c = 0; c < 3; c++) {
    f[0][c] = m->row[HK_B0][k] * d[0][c] + m->row[HK_B2][k] * d[1][c];
    f[1][c] = m->row[HK_B1][k] * d[0][c] + m->row[HK_B3][k] * d[1][c];
  }
}

hk_metric hk_membrane_metric(const double f[2][3]) {
  return (hk_metric){hk_dot(f[0], f[0]), hk_dot(f[1], f[1]), hk_dot(f[0], f[1])};
}

typedef struct energy_task {
  const hk_membrane *m;
  const double *x;
} energy_task;

static void energy_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const energy_task *t = context;
  double energy = 0, f[2][3];
  for (size_t k = begin; k < end; k++) {
    hk_membrane_deformation(t->m, k, t->x, f);
    energy += hk_membrane_energy(t->m->model, hk_membrane_elasticity(t->m, k),
                                 hk_membrane_metric((const double(*)[3])f), t->m->exponent);
  }
  t->m->energy[chunk] = energy;
}

double hk_membrane_sum_energy(const hk_membrane *m, const hk_view *view) {
  energy_task t = {m, view->x};
  double sum = 0;
  view->host->parallel_for(view->host, m->node.count, HK_MEMBRANE_GRAIN, energy_chunk, &t);
  for (size_t chunk = 0; chunk * HK_MEMBRANE_GRAIN < m->node.count; chunk++) sum += m->energy[chunk];
  return sum;
}
