/* The blocks of many hinges: gathered, computed in loops that compilers turn into vectors, and scattered, by
 * several threads where they have no particle in common. With
 * the inverse heights A = |e| m/|m|^2 and B = |e| n/|n|^2 as vectors along the normals, so that g_c = -A and g_d = -B,
 * with u the unit vector of the edge, U = A x u and V = u x B, z = k C + c dC/dt,
 *     c c: A (k/2 A + z U)^T + (k/2 A + z U) A^T = P     d d: the same of B and V = Q      c d: k A B^T = X
 *     c b: -s P - t X + Y          Y = z/|e| u A^T       d b: -t Q - s X^T + Z             Z = z/|e| u B^T
 *     b b: s^2 P + t^2 Q + s t (X + X^T) - s (Y + Y^T) - t (Z + Z^T) + z/|e|^4 (|m|^2 A U^T + |n|^2 B V^T),
 * and those of a are minus the sums of the others, by which a translation changes nothing. This is the Hessian of
 * hinge.c in the frames of the two triangles. */
#include "plugins/common/shells/hinge_kernel.h"
#include "plugins/common/shells/hinge_lane.h"

enum { BLOCK = 16, CC = 0, DD, CD, CB, DB, BB, KINDS };

typedef struct block {
  double d[3][3][BLOCK], u[3][3][BLOCK]; /* e, p, q, m, and their rates, m/s */
  double k[BLOCK], c[BLOCK], rest[BLOCK], turned[BLOCK];
  double K[KINDS][9][BLOCK], D[KINDS][9][BLOCK];
} block;

HK_HINGE_INLINE void cross(const double a[3], const double b[3], double into[3]) {
  into[0] = a[1] * b[2] - a[2] * b[1], into[1] = a[2] * b[0] - a[0] * b[2], into[2] = a[0] * b[1] - a[1] * b[0];
}

/* What the formulas are made of. */
typedef struct frames {
  double u[3], A[3], B[3], U[3], V[3];
  double s, t, inverse; /* 1/|e| */
  double m, n;          /* |m|^2/|e|^4, |n|^2/|e|^4 */
} frames;

HK_HINGE_INLINE frames frames_of(const hk_hinge_lane *h, const double e[3]) {
  double on = h->fine ? 1 : 0, a = on * h->length / h->mm, b = on * h->length / h->nn;
  frames f = {.s = h->s, .t = h->t, .inverse = on / h->length};
  f.m = h->mm / (h->ee * h->ee), f.n = h->nn / (h->ee * h->ee);
  for (int c = 0; c < 3; c++) f.u[c] = f.inverse * e[c], f.A[c] = a * h->m[c], f.B[c] = b * h->n[c];
  cross(f.A, f.u, f.U);
  cross(f.u, f.B, f.V);
  return f;
}

/* The vectors k/2 A + z U, k/2 B + z V, z/|e| u, and the factors of the fold at the edge. */
typedef struct parts {
  double k, p[3], q[3], y[3], m, n;
} parts;

HK_HINGE_INLINE void entry(const frames *f, const parts *o, int i, int j, double into[KINDS][9][BLOCK], int r) {
  double P = f->A[i] * o->p[j] + o->p[i] * f->A[j], Q = f->B[i] * o->q[j] + o->q[i] * f->B[j];
  double X = o->k * (f->A[i] * f->B[j]), across = o->k * (f->A[j] * f->B[i]);
  double Y = o->y[i] * f->A[j], Z = o->y[i] * f->B[j];
  double last = f->s * (Y + o->y[j] * f->A[i]) + f->t * (Z + o->y[j] * f->B[i]);
  double fold = o->m * (f->A[i] * f->U[j]) + o->n * (f->B[i] * f->V[j]);
  into[CC][3 * i + j][r] = P, into[DD][3 * i + j][r] = Q, into[CD][3 * i + j][r] = X;
  into[CB][3 * i + j][r] = Y - f->s * P - f->t * X;
  into[DB][3 * i + j][r] = Z - f->t * Q - f->s * across;
  into[BB][3 * i + j][r] = f->s * f->s * P + f->t * f->t * Q + f->s * f->t * (X + across) - last + fold;
}

/* Without loops, which compilers would have to undo first. */
HK_HINGE_INLINE void assemble(const frames *f, double k, double z, double into[KINDS][9][BLOCK], int r) {
  parts o = {.k = k, .m = z * f->m, .n = z * f->n};
  for (int c = 0; c < 3; c++) {
    o.p[c] = k / 2 * f->A[c] + z * f->U[c], o.q[c] = k / 2 * f->B[c] + z * f->V[c], o.y[c] = z * f->inverse * f->u[c];
  }
  entry(f, &o, 0, 0, into, r), entry(f, &o, 0, 1, into, r), entry(f, &o, 0, 2, into, r);
  entry(f, &o, 1, 0, into, r), entry(f, &o, 1, 1, into, r), entry(f, &o, 1, 2, into, r);
  entry(f, &o, 2, 0, into, r), entry(f, &o, 2, 1, into, r), entry(f, &o, 2, 2, into, r);
}

HK_HINGE_INLINE void compute(block *o, bool definite, bool damped) {
  for (int r = 0; r < BLOCK; r++) {
    const double e[3] = {o->d[0][0][r], o->d[0][1][r], o->d[0][2][r]};
    const double p[3] = {o->d[1][0][r], o->d[1][1][r], o->d[1][2][r]};
    const double q[3] = {o->d[2][0][r], o->d[2][1][r], o->d[2][2][r]};
    hk_hinge_lane h = hk_hinge_measure(e, p, q);
    frames f = frames_of(&h, e);
    double z = 0;
    if (!definite) {
      z = o->k[r] * (hk_hinge_unwrap(hk_hinge_lane_angle(&h, q), o->turned[r]) - o->rest[r]);
      for (int c = 0; c < 3 && damped; c++) {
        double along = f.s * o->u[0][c][r] - o->u[1][c][r], other = f.t * o->u[0][c][r] - o->u[2][c][r];
        z += o->c[r] * (f.A[c] * along + f.B[c] * other);
      }
    }
    assemble(&f, o->k[r], z, o->K, r);
    if (damped) assemble(&f, o->c[r], 0, o->D, r);
  }
}

HK_HINGE_INLINE void compute_kind(block *o, bool definite, bool damped) {
  if (definite)
    damped ? compute(o, true, true) : compute(o, true, false);
  else
    damped ? compute(o, false, true) : compute(o, false, false);
}

HK_HINGE_INLINE void fetch(const double from[9][BLOCK], size_t r, double into[9]) {
  for (int q = 0; q < 9; q++) into[q] = from[q][r];
}

HK_HINGE_INLINE void across(const double from[9], double into[9]) {
  for (int q = 0; q < 9; q++) into[q] = from[3 * (q % 3) + q / 3];
}

HK_HINGE_INLINE void give(double *into, const double by[9]) {
  for (int q = 0; q < 9; q++) into[q] += by[q];
}

/* To the blocks of the members of hinge r. */
HK_HINGE_INLINE void scatter(const double from[KINDS][9][BLOCK], size_t r, const size_t *slot, double *into) {
  double own[9][9], row[3][9], column[3][9], all[9];
  fetch(from[BB], r, own[0]), fetch(from[CB], r, own[3]), fetch(from[DB], r, own[6]);
  fetch(from[CC], r, own[4]), fetch(from[CD], r, own[5]), fetch(from[DD], r, own[8]);
  across(own[3], own[1]), across(own[6], own[2]), across(own[5], own[7]);
  for (int m = 0; m < 3; m++)
    for (int q = 0; q < 9; q++) row[m][q] = -(own[3 * m][q] + own[3 * m + 1][q] + own[3 * m + 2][q]);
  for (int m = 0; m < 3; m++) across(row[m], column[m]);
  for (int q = 0; q < 9; q++) all[q] = -(row[0][q] + row[1][q] + row[2][q]);
  give(into + 9 * slot[0], all);
  for (int m = 0; m < 3; m++) {
    give(into + 9 * slot[m + 1], column[m]);
    give(into + 9 * slot[4 * m + 4], row[m]);
    for (int b = 0; b < 3; b++) give(into + 9 * slot[4 * m + 5 + b], own[3 * m + b]);
  }
}

/* Blocks lie apart in megabytes, and come while the hinges are computed: 190 ns a triangle are 150 then. */
HK_HINGE_INLINE void fetch_ahead(const double *into, const size_t *slot, size_t count) {
  for (size_t k = 0; k < 16 * count; k++) {
    __builtin_prefetch(into + 9 * slot[k], 1);
    __builtin_prefetch(into + 9 * slot[k] + 8, 1);
  }
}

HK_HINGE_INLINE void add(block *o, size_t count, bool definite, bool damped, const size_t *slot,
                         const hk_blocks *into) {
  fetch_ahead(into->K, slot, count);
  compute_kind(o, definite, damped);
  for (size_t r = 0; r < count; r++) scatter((const double(*)[9][BLOCK])o->K, r, slot + 16 * r, into->K);
  if (!damped) return;
  fetch_ahead(into->D, slot, count);
  for (size_t r = 0; r < count; r++) scatter((const double(*)[9][BLOCK])o->D, r, slot + 16 * r, into->D);
}

HK_VERSIONS(static void, add_many,
            (block * o, size_t count, bool definite, bool damped, const size_t *slot, const hk_blocks *into),
            add(o, count, definite, damped, slot, into))

/* The differences from a, of one array; lanes beyond get those of the first. */
static void gather(const hk_tuples *node, const double *from, size_t begin, size_t count, double into[3][3][BLOCK]) {
  for (size_t r = 0; r < BLOCK; r++) {
    const uint32_t *member = hk_tuple(node, begin + (r < count ? r : 0));
    const double *a = from + 3 * (size_t)member[0];
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++) into[m][c][r] = from[3 * (size_t)member[m + 1] + (size_t)c] - a[c];
  }
}

typedef struct task {
  const hk_bending *b;
  const double *rest, *turned;
  const hk_view *view;
  const hk_blocks *into;
} task;

/* The numbers of hinges begin to begin + count; returns whether any is damped. */
static bool take(const task *t, size_t begin, size_t count, block *o) {
  const hk_elements *a = &t->b->element.acting;
  bool damped = false;
  for (size_t r = 0; r < BLOCK; r++) {
    size_t k = begin + (r < count ? r : 0), q = t->b->number[k];
    o->k[r] = a->stiffness.value[k], o->c[r] = a->damping.value[k];
    o->rest[r] = t->rest[q], o->turned[r] = t->turned[q];
    damped = damped || o->c[r] != 0;
  }
  gather(&a->node, t->view->x, begin, count, o->d);
  if (damped) gather(&a->node, t->view->v, begin, count, o->u);
  return damped;
}

static void add_chunk(const void *context, size_t begin, size_t end) {
  const task *t = context;
  block o;
  for (size_t count; begin < end; begin += count) {
    count = end - begin < BLOCK ? end - begin : BLOCK;
    bool damped = take(t, begin, count, &o);
    HK_WIDEST(t->view->host->lanes, add_many)
    (&o, count, t->into->want & HK_WANT_DEFINITE, damped, t->into->slot + 16 * begin, t->into);
  }
}

void hk_hinge_blocks(const hk_bending *b, const double *rest, const double *turned, const hk_view *view,
                     const hk_blocks *into) {
  const task t = {b, rest, turned, view, into};
  hk_chunk_rounds_run(&b->rounds, view->host, add_chunk, &t);
}
