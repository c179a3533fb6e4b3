/* The blocks of membranes. Triangles are gathered, computed in loops that compilers turn into vectors, and scattered,
 * by several threads where they have no corner in common. With damping, -dF/dx also has the viscous stress, and how the
 * directions of the damping turn, which is not symmetric and goes triangle by triangle: symmetric blocks leave out the
 * latter, definite ones both. */
#include "plugins/common/membranes/membrane.h"
#include "plugins/common/membranes/membrane_curvature.h"

#include "plugins/kit/vector3.h"

enum { BLOCK = 32 };

typedef struct block {
  double d[2][3][BLOCK], u[2][3][BLOCK]; /* sides, m, and their rates, m/s */
  double number[HK_MEMBRANE_ROWS][BLOCK];
  double first[BLOCK], second[BLOCK];    /* W', W'', of neo_hookean; before, t in `first` */
  double K[3][9][BLOCK], D[3][9][BLOCK]; /* between corners 1 and 1, 1 and 2, 2 and 2 */
} block;

typedef struct deformation {
  double f[3], g[3], B[4];
} deformation;

HK_MEMBRANE_INLINE deformation deform(const block *q, const double d[2][3][BLOCK], int r) {
  deformation o = {.B = {q->number[HK_B0][r], q->number[HK_B1][r], q->number[HK_B2][r], q->number[HK_B3][r]}};
  for (int c = 0; c < 3; c++) {
    o.f[c] = o.B[0] * d[0][c][r] + o.B[2] * d[1][c][r];
    o.g[c] = o.B[1] * d[0][c][r] + o.B[3] * d[1][c][r];
  }
  return o;
}

HK_MEMBRANE_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

HK_MEMBRANE_INLINE hk_metric metric(const deformation *o) {
  return (hk_metric){dot(o->f, o->f), dot(o->g, o->g), dot(o->f, o->g)};
}

HK_MEMBRANE_INLINE deformation turned(const deformation *o, double p, double q) {
  deformation n;
  for (int c = 0; c < 3; c++) n.f[c] = p * o->f[c] + q * o->g[c], n.g[c] = p * o->g[c] - q * o->f[c];
  for (int c = 0; c < 4; c += 2) n.B[c] = p * o->B[c] + q * o->B[c + 1], n.B[c + 1] = p * o->B[c + 1] - q * o->B[c];
  return n;
}

HK_MEMBRANE_INLINE void entry(const deformation *o, const hk_curvature *k, int i, int j, double into[3][9][BLOCK],
                              int r) {
  const double *B = o->B;
  double ff = o->f[i] * o->f[j], fg = o->f[i] * o->g[j], gf = o->g[i] * o->f[j], gg = o->g[i] * o->g[j], one = i == j;
  double uu = k->uu.i * one + k->uu.ff * ff + k->uu.fg * (fg + gf) + k->uu.gg * gg;
  double vv = k->vv.i * one + k->vv.ff * ff + k->vv.fg * (fg + gf) + k->vv.gg * gg;
  double even = k->uv.i * one + k->uv.ff * ff + k->uv.gg * gg;
  double uv = even + k->uv.fg * fg + k->uv.gf * gf, vu = even + k->uv.fg * gf + k->uv.gf * fg;
  into[0][3 * i + j][r] = B[0] * (B[0] * uu + B[1] * uv) + B[1] * (B[0] * vu + B[1] * vv);
  into[1][3 * i + j][r] = B[0] * (B[2] * uu + B[3] * uv) + B[1] * (B[2] * vu + B[3] * vv);
  into[2][3 * i + j][r] = B[2] * (B[2] * uu + B[3] * uv) + B[3] * (B[2] * vu + B[3] * vv);
}

/* The blocks between corners of a curvature; without loops, which compilers would have to undo first. */
HK_MEMBRANE_INLINE void assemble(const deformation *o, const hk_curvature *k, double into[3][9][BLOCK], int r) {
  entry(o, k, 0, 0, into, r), entry(o, k, 0, 1, into, r), entry(o, k, 0, 2, into, r);
  entry(o, k, 1, 0, into, r), entry(o, k, 1, 1, into, r), entry(o, k, 1, 2, into, r);
  entry(o, k, 2, 0, into, r), entry(o, k, 2, 1, into, r), entry(o, k, 2, 2, into, r);
}

HK_MEMBRANE_INLINE void volumes(block *q) {
  for (int r = 0; r < BLOCK; r++) {
    deformation o = deform(q, (const double(*)[3][BLOCK])q->d, r);
    hk_metric g = metric(&o);
    q->first[r] = g.a * g.b - g.c * g.c;
  }
}

HK_MEMBRANE_INLINE void compute(block *q, hk_membrane_model model, bool definite, double damping) {
  for (int r = 0; r < BLOCK; r++) {
    const hk_elasticity m = {q->number[HK_C11][r], q->number[HK_C22][r], q->number[HK_C12][r], q->number[HK_C66][r]};
    deformation o = deform(q, (const double(*)[3][BLOCK])q->d, r), at = o;
    hk_metric g = metric(&o);
    hk_curvature k;
    if (model == HK_BARAFF_WITKIN)
      k = hk_curvature_baraff_witkin(m, g, definite);
    else if (model == HK_STVK)
      k = hk_curvature_stvk(m, g, definite);
    else if (definite) {
      double p, s;
      hk_principal_turn(g, &p, &s);
      at = turned(&o, p, s);
      hk_metric h = {dot(at.f, at.f), dot(at.g, at.g), 0};
      k = hk_curvature_neo_hookean_definite(m.c66, h, q->first[r], q->second[r]);
    } else
      k = hk_curvature_neo_hookean(m.c66, g, q->first[r], q->second[r]);
    if (damping > 0) {
      hk_elasticity viscosity = hk_membrane_viscosity(model, m, g, damping);
      hk_curvature of_damping = hk_curvature_of_strains(viscosity);
      if (!definite) {
        deformation w = deform(q, (const double(*)[3][BLOCK])q->u, r);
        hk_metric rate = {dot(o.f, w.f), dot(o.g, w.g), dot(o.f, w.g) + dot(o.g, w.f)};
        hk_stress drag = hk_membrane_drag(viscosity, rate);
        hk_curvature_add_stress(&k, drag);
        if (model == HK_BARAFF_WITKIN) {
          double u = hk_inverse_length(g.a), v = hk_inverse_length(g.b);
          k.uu.ff -= drag.uu * u * u, k.vv.gg -= drag.vv * v * v;
        }
      }
      assemble(&o, &of_damping, q->D, r);
    }
    assemble(&at, &k, q->K, r);
  }
}

HK_MEMBRANE_INLINE void compute_kind(block *q, hk_membrane_model model, bool definite, double damping) {
  if (damping > 0)
    definite ? compute(q, model, true, damping) : compute(q, model, false, damping);
  else
    definite ? compute(q, model, true, 0) : compute(q, model, false, 0);
}

HK_MEMBRANE_INLINE void compute_model(block *q, hk_membrane_model model, bool definite, double damping) {
  if (model == HK_BARAFF_WITKIN)
    compute_kind(q, HK_BARAFF_WITKIN, definite, damping);
  else if (model == HK_STVK)
    compute_kind(q, HK_STVK, definite, damping);
  else
    compute_kind(q, HK_NEO_HOOKEAN, definite, damping);
}

HK_VERSIONS(static void, volumes_of, (block * q), volumes(q))
HK_VERSIONS(static void, compute_many, (block * q, hk_membrane_model model, bool definite, double damping),
            compute_model(q, model, definite, damping))

/* ---- what turns -------------------------------------------------------------------------------------------------- */

/* H += factor p q^T, of 6 x 6 */
static void add_outer(double H[36], double factor, const double p[6], const double q[6]) {
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++) H[6 * r + c] += factor * p[r] * q[c];
}

/* The derivatives of the strains by [f g], at f, g, or their rates at the rates of f, g. */
static void strain_gradients(const double f[2][3], double out[3][6]) {
  for (int c = 0; c < 3; c++) {
    out[0][c] = f[0][c], out[0][3 + c] = 0;
    out[1][c] = 0, out[1][3 + c] = f[1][c];
    out[2][c] = f[1][c], out[2][3 + c] = f[0][c];
  }
}

/* The part of -dP/d[f g] by which the viscous stress P changes with the rates of the strains at fixed velocities. */
static void turning(const hk_membrane *m, const hk_view *view, size_t k, double H[36]) {
  double f[2][3], w[2][3], at[3][6], rate[3][6];
  hk_membrane_deformation(m, k, view->x, f);
  hk_membrane_deformation(m, k, view->v, w);
  hk_metric g = hk_membrane_metric((const double(*)[3])f);
  hk_elasticity e = hk_membrane_viscosity(m->model, hk_membrane_elasticity(m, k), g, m->damping);
  strain_gradients((const double(*)[3])f, at);
  strain_gradients((const double(*)[3])w, rate);
  for (int c = 0; c < 36; c++) H[c] = 0;
  add_outer(H, e.c11, at[0], rate[0]);
  add_outer(H, e.c12, at[0], rate[1]);
  add_outer(H, e.c12, at[1], rate[0]);
  add_outer(H, e.c22, at[1], rate[1]);
  add_outer(H, e.c66, at[2], rate[2]);
  if (m->model != HK_BARAFF_WITKIN) return;
  double u = hk_inverse_length(g.a), v = hk_inverse_length(g.b);
  add_outer(H, -e.c11 * hk_dot(f[0], w[0]) * u * u, at[0], at[0]);
  add_outer(H, -e.c22 * hk_dot(f[1], w[1]) * v * v, at[1], at[1]);
}

static void add_turning(const hk_membrane *m, const hk_view *view, size_t k, const size_t *slot, double *into) {
  const double B[4] = {m->row[HK_B0][k], m->row[HK_B1][k], m->row[HK_B2][k], m->row[HK_B3][k]};
  const double of[3][2] = {{-(B[0] + B[2]), -(B[1] + B[3])}, {B[0], B[1]}, {B[2], B[3]}};
  double H[36];
  turning(m, view, k, H);
  for (int b = 0; b < 9; b++)
    for (int q = 0; q < 9; q++)
      for (int e = 0; e < 4; e++)
        into[9 * slot[b] + (size_t)q] +=
            of[b / 3][e / 2] * of[b % 3][e % 2] * H[6 * (3 * (e / 2) + q / 3) + 3 * (e % 2) + q % 3];
}

/* ---- many triangles ---------------------------------------------------------------------------------------------- */

static void gather(const hk_tuples *node, const double *from, size_t begin, size_t count, double into[2][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *corner = hk_tuple(node, begin + (r < count ? r : 0));
    const double *o = from + 3 * (size_t)corner[0], *p = from + 3 * (size_t)corner[1],
                 *q = from + 3 * (size_t)corner[2];
    for (int c = 0; c < 3; c++) into[0][c][r] = p[c] - o[c], into[1][c][r] = q[c] - o[c];
  }
}

/* To the blocks of the corners: those of corner 0 balance the others. */
static void scatter(const double from[3][9][BLOCK], size_t r, const size_t *slot, double *into) {
  double *K[9];
  for (int b = 0; b < 9; b++) K[b] = into + 9 * slot[b];
  for (int q = 0; q < 9; q++) {
    int across = 3 * (q % 3) + q / 3;
    double one = from[0][q][r], mixed = from[1][q][r], other = from[1][across][r], two = from[2][q][r];
    K[0][q] += one + mixed + other + two, K[1][q] -= one + other, K[2][q] -= mixed + two;
    K[3][q] -= one + mixed, K[4][q] += one, K[5][q] += mixed;
    K[6][q] -= other + two, K[7][q] += other, K[8][q] += two;
  }
}

static void fill(const hk_membrane *m, const hk_view *view, size_t begin, size_t count, bool definite, block *q) {
  gather(&m->node, view->x, begin, count, q->d);
  if (m->damping > 0) gather(&m->node, view->v, begin, count, q->u);
  for (size_t k = 0; k < HK_MEMBRANE_ROWS; k++)
    for (size_t r = 0; r < BLOCK; r++) q->number[k][r] = m->row[k][begin + (r < count ? r : 0)];
  if (m->model == HK_NEO_HOOKEAN) {
    HK_WIDEST(view->host->lanes, volumes_of)(q);
    for (size_t r = 0; r < BLOCK; r++) {
      hk_volume_term w = hk_volume_term_at(q->first[r], m->exponent);
      q->first[r] = w.first, q->second[r] = w.second;
    }
  }
  HK_WIDEST(view->host->lanes, compute_many)(q, m->model, definite, m->damping);
}

typedef struct task {
  const hk_membrane *m;
  const hk_view *view;
  const hk_blocks *into;
} task;

static void add_chunk(const void *context, size_t begin, size_t end) {
  const task *t = context;
  const hk_membrane *m = t->m;
  unsigned want = t->into->want;
  bool turns = m->damping > 0 && !(want & (HK_WANT_DEFINITE | HK_WANT_SYMMETRIC));
  block q;
  for (size_t count; begin < end; begin += count) {
    count = end - begin < BLOCK ? end - begin : BLOCK;
    fill(m, t->view, begin, count, want & HK_WANT_DEFINITE, &q);
    const size_t *slot = t->into->slot + 9 * begin;
    for (size_t r = 0; r < count; r++) scatter((const double(*)[9][BLOCK])q.K, r, slot + 9 * r, t->into->K);
    for (size_t r = 0; r < count && m->damping > 0; r++)
      scatter((const double(*)[9][BLOCK])q.D, r, slot + 9 * r, t->into->D);
    for (size_t r = 0; r < count && turns; r++) add_turning(m, t->view, begin + r, slot + 9 * r, t->into->K);
  }
}

void hk_membrane_blocks(const hk_membrane *m, const hk_view *view, const hk_blocks *into) {
  const task t = {m, view, into};
  hk_chunk_rounds_run(&m->rounds, view->host, add_chunk, &t);
}

void hk_membrane_pattern(const hk_membrane *m, hk_pattern *pattern) {
  for (size_t k = 0; k < m->node.count; k++)
    for (int b = 0; b < 9; b++) pattern->block(pattern, hk_tuple(&m->node, k)[b / 3], hk_tuple(&m->node, k)[b % 3]);
}
