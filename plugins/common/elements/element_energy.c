/* A step of backward Euler over elements minimises h^2 E(x) + Q(d) plus the inertia term, with E = 1/2 sum k C^2 and
 * damping along the gradients dC_0 at the start of the step, Q = h/2 sum c (dC_0.d)^2, d = x - x_start.
 *
 * For a method whose matrix is constant and the same for each coordinate every tuple has the weight w = h (h k + c) sum
 * |dC|^2. Where a translation of the tuple does not change C, (dC.u)^2 <= |dC|^2 |u - mean u|^2: w (I - 1 1^T/arity) is
 * an upper bound of the tuple's Gauss-Newton matrix. It is the graph Laplacian of the complete graph of its members
 * with edge weight w/arity. Where a translation changes C (one particle tied to a place) w is added to the diagonal.
 * Liu, Bouaziz and Kavan, Quasi-Newton methods for real-time simulation of hyperelastic materials, ACM TOG 36 (2017).
 *
 * Tuples are evaluated by several threads and summed in the order of the scene, so results have the same bits for any
 * number of threads. */
#include "plugins/common/elements/element_energy.h"

#include <string.h>

enum { GRAIN = 256 };
static const double INVARIANT = 1e-9; /* relative to |dC|: bound of the sum over members that rounding leaves */
static const double TELLING = 1.2;    /* growth of the steepness that is worth a new matrix */

static hk_status reserve(hk_element_energy *m, const hk_host *host) {
  const hk_element_tuples *t = &m->tuples;
  void *old[] = {m->C, m->dC, m->start, m->steepness, m->anchored};
  for (size_t k = 0; k < sizeof old / sizeof *old; k++) host->release(host, old[k]);
  m->C = host->allocate(host, (t->most_values + 1) * sizeof *m->C);
  m->dC = host->allocate(host, (t->most_gradients + 1) * sizeof *m->dC);
  m->start = host->allocate(host, (t->most_gradients + 1) * sizeof *m->start);
  m->steepness = host->allocate(host, (t->capacity + 1) * sizeof *m->steepness);
  m->anchored = host->allocate(host, (t->capacity + 1) * sizeof *m->anchored);
  if (m->C && m->dC && m->start && m->steepness && m->anchored) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for the gradients of %zu elements", t->capacity);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Computes from the present gradients the steepness, and whether the tuple is anchored. */
static double steepness_of(const hk_element_energy *m, size_t q, bool *anchored) {
  const hk_element_tuple *e = &m->tuples.item[q];
  unsigned arity = e->list->node.arity;
  double sum = 0, moved = 0;
  for (unsigned k = 0; k < e->list->values; k++) {
    double whole[3] = {0};
    for (unsigned a = 0; a < arity; a++) {
      const double *g = m->dC[e->gradient + arity * k + a];
      for (int c = 0; c < 3; c++) whole[c] += g[c];
      sum += dot(g, g);
    }
    moved += dot(whole, whole);
  }
  *anchored = moved > INVARIANT * INVARIANT * sum;
  return sum;
}

bool hk_element_energy_raise(hk_element_energy *m) {
  bool any = false;
  for (size_t q = 0; q < m->tuples.count; q++) {
    bool anchored;
    double now = steepness_of(m, q, &anchored);
    if (!(now > TELLING * m->steepness[q])) continue;
    m->steepness[q] = now;
    m->anchored[q] |= anchored;
    any = true;
  }
  return any;
}

hk_status hk_element_energy_take(hk_element_energy *m, const hk_host *host, const hk_model *model, const double *x,
                                 bool fresh) {
  hk_status status = hk_element_tuples_take(&m->tuples, host, model, fresh);
  if (status == HK_OK && fresh) status = reserve(m, host);
  m->pairs = 0;
  m->damped = false;
  if (status != HK_OK) return status;
  hk_element_energy_evaluate(m, host, x);
  for (size_t q = 0; q < m->tuples.count; q++) {
    unsigned arity = m->tuples.item[q].list->node.arity;
    m->steepness[q] = steepness_of(m, q, &m->anchored[q]);
    m->pairs += arity * (arity - 1) / 2;
    m->damped |= m->tuples.item[q].damping != 0;
  }
  return HK_OK;
}

void hk_element_energy_pairs(const hk_element_energy *m, uint32_t (*pair)[2]) {
  for (size_t q = 0; q < m->tuples.count; q++) {
    const hk_element_tuple *e = &m->tuples.item[q];
    for (unsigned a = 1; a < e->list->node.arity; a++)
      for (unsigned b = 0; b < a; b++, pair++) (*pair)[0] = e->member[b], (*pair)[1] = e->member[a];
  }
}

void hk_element_energy_weights(const hk_element_energy *m, double h, double *weight, double *diagonal) {
  for (size_t q = 0; q < m->tuples.count; q++) {
    const hk_element_tuple *e = &m->tuples.item[q];
    unsigned arity = e->list->node.arity;
    double w = h * (h * e->stiffness + e->damping) * m->steepness[q];
    for (unsigned k = 0; k < arity * (arity - 1) / 2; k++) *weight++ = m->anchored[q] ? 0 : w / arity;
    for (unsigned a = 0; a < arity && m->anchored[q]; a++) diagonal[e->member[a]] += w;
  }
}

/* ---- evaluation ---- */

typedef struct task {
  hk_element_energy *m;
  const double *x;
} task;

static void evaluate_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (const hk_element_tuple *e = t->m->tuples.item + begin; e < t->m->tuples.item + end; e++)
    hk_element_tuple_evaluate(e, t->x, t->m->C + e->first, t->m->dC + e->gradient);
}

void hk_element_energy_evaluate(hk_element_energy *m, const hk_host *host, const double *x) {
  task t = {m, x};
  if (m->tuples.count > 0) host->parallel_for(host, m->tuples.count, GRAIN, evaluate_chunk, &t);
}

void hk_element_energy_start(hk_element_energy *m, const hk_host *host, const double *x) {
  if (!m->damped) return;
  hk_element_energy_evaluate(m, host, x);
  memcpy(m->start, m->dC, m->tuples.gradients * sizeof *m->start);
}

/* dC_0.d of the k-th number C of a tuple. */
static double along_start(const hk_element_energy *m, const hk_element_tuple *e, unsigned k, const double *d) {
  unsigned arity = e->list->node.arity;
  double sum = 0;
  for (unsigned a = 0; a < arity; a++) sum += dot(m->start[e->gradient + arity * k + a], d + 3 * (size_t)e->member[a]);
  return sum;
}

double hk_element_energy_value(const hk_element_energy *m, const double *d, double h, double *slope) {
  double sum = 0;
  for (size_t q = 0; q < m->tuples.count; q++) {
    const hk_element_tuple *e = &m->tuples.item[q];
    double elastic = 0, damped = 0, size = 0;
    for (unsigned k = 0; k < e->list->values; k++) {
      double C = m->C[e->first + k], u = e->damping != 0 ? along_start(m, e, k, d) : 0;
      elastic += C * C;
      damped += u * u;
      size += fabs(C);
    }
    sum += h * (h * e->stiffness * elastic + e->damping * damped) / 2;
    *slope += h * h * e->stiffness * size * sqrt(m->steepness[q]);
  }
  return sum;
}

void hk_element_energy_forces(const hk_element_energy *m, const double *d, double h, double *F, double *power) {
  for (const hk_element_tuple *e = m->tuples.item; e < m->tuples.item + m->tuples.count; e++) {
    unsigned arity = e->list->node.arity;
    for (unsigned k = 0; k < e->list->values; k++) {
      const double(*g)[3] = (const double(*)[3])m->dC + e->gradient + arity * k;
      const double(*g0)[3] = (const double(*)[3])m->start + e->gradient + arity * k;
      double z = e->stiffness * m->C[e->first + k], u = e->damping != 0 ? along_start(m, e, k, d) / h : 0;
      for (unsigned a = 0; a < arity; a++)
        for (size_t i = e->member[a], c = 0; c < 3; c++)
          F[3 * i + c] -= z * g[a][c] + (u != 0 ? e->damping * u * g0[a][c] : 0);
      if (power) *power -= e->damping * u * u;
    }
  }
}
