/* Elements of any arity solved one by one: Gauss-Seidel sweeps over C(x) with compliance 1/k and damping c.
 *
 * Consider an element with the numbers C (one or several), gradients G = dC/dx and the diagonal inverse masses M^-1,
 * which has given its members the impulse p so far. The velocities without it are v - M^-1 p, the positions x + h v; to
 * first order the impulse G^T P with P = -(h k C + h c dC/dt) afterwards solves
 *     (1 + e W) P = -(h k C + h c G v) + e G M^-1 p,    W = G M^-1 G^T,    e = h^2 k + h c.
 * For p = G^T P_before and one C this is (26) of the paper for lambda = h P, divided by its compliance; all C of a
 * tuple are solved together. One difference from the paper is that p is stored as a vector instead of lambda: an
 * impulse given along a gradient of an earlier sweep is removed along that same gradient. So where the sweeps converge,
 * the velocities satisfy M v = M v_0 - h k G^T C - h c G^T G v with all terms at the end of the substep: backward
 * Euler, even when the gradients turn.
 *
 * Two tuples of one colour never share a particle, so any number of threads gives the same bits. Sliding particles move
 * by S M^-1 p, where S is the projector of the pin; fixed ones and those on paths have M^-1 = 0. The work of path pins
 * is -p.v. Macklin, Mueller and Chentanez 2016, XPBD, (17), (18) and (26). */
#include "plugins/common/elements/xpbd_elements.h"

#include <string.h>

enum { COLOURS = HK_XPBD_COLOURS, VALUES = HK_ELEMENT_VALUES, GRAIN = 256 }; /* GRAIN: tuples, about 30 us of work */

/* ---- arrangement ---- */

static hk_status reserve(hk_xpbd_elements *m, const hk_host *host, size_t n) {
  size_t count = m->tuples.capacity;
  void *old[] = {m->x, m->impulse, m->sequence, m->tint, m->used, m->work};
  for (size_t k = 0; k < sizeof old / sizeof *old; k++) host->release(host, old[k]);
  m->x = host->allocate(host, (3 * n + 1) * sizeof *m->x);
  m->impulse = host->allocate(host, (count + 1) * sizeof *m->impulse);
  m->sequence = host->allocate(host, (count + 1) * sizeof *m->sequence);
  m->tint = host->allocate(host, count + 1);
  m->used = host->allocate(host, (n + 1) * sizeof *m->used);
  m->work = host->allocate(host, (count / GRAIN + 2) * sizeof *m->work);
  if (m->x && m->impulse && m->sequence && m->tint && m->used && m->work) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory to order %zu elements", count);
}

/* The lowest colour that no member has; COLOURS: the tuple is solved alone. */
static unsigned pick_colour(hk_xpbd_elements *m, const hk_element_tuple *e) {
  uint64_t taken = 0;
  unsigned c = 0;
  for (unsigned a = 0; a < e->list->node.arity; a++) taken |= m->used[e->member[a]];
  if (taken == UINT64_MAX) return COLOURS;
  while (taken >> c & 1) c++;
  for (unsigned a = 0; a < e->list->node.arity; a++) m->used[e->member[a]] |= (uint64_t)1 << c;
  return c;
}

static void arrange(hk_xpbd_elements *m, size_t n, bool by_colour) {
  size_t count[COLOURS + 1] = {0}, at[COLOURS + 1];
  memset(m->used, 0, n * sizeof *m->used);
  for (size_t q = 0; q < m->tuples.count; q++) {
    m->tint[q] = (uint8_t)(by_colour ? pick_colour(m, &m->tuples.item[q]) : COLOURS);
    count[m->tint[q]]++;
  }
  m->colour[0] = 0;
  for (m->colours = 0; m->colours < COLOURS && count[m->colours] > 0; m->colours++) {
    at[m->colours] = m->colour[m->colours];
    m->colour[m->colours + 1] = m->colour[m->colours] + count[m->colours];
  }
  at[COLOURS] = m->colour[m->colours];
  for (size_t q = 0; q < m->tuples.count; q++) m->sequence[at[m->tint[q]]++] = (uint32_t)q;
}

hk_status hk_xpbd_elements_take(hk_xpbd_elements *m, hk_system *s, bool fresh, bool by_colour) {
  hk_status status = hk_element_tuples_take(&m->tuples, s->host, s->model, fresh);
  if (status == HK_OK && fresh) status = reserve(m, s->host, s->n);
  if (status == HK_OK) arrange(m, s->n, by_colour);
  return status;
}

void hk_xpbd_elements_start(hk_xpbd_elements *m) { memset(m->impulse, 0, m->tuples.count * sizeof *m->impulse); }

/* ---- sweeps ---- */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The change of the velocity of particle i by an impulse p. */
static void respond(const hk_element_edges *pins, uint32_t i, const double p[3], double into[3]) {
  double w = pins->inverse_mass[i];
  if (pins->slide[i] == HK_NO_SLIDE) {
    for (int c = 0; c < 3; c++) into[c] = w * p[c];
    return;
  }
  const double *S = pins->projector[pins->slide[i]];
  for (int c = 0; c < 3; c++) into[c] = w * dot(S + 3 * c, p);
}

/* b <- A^-1 b by Cholesky; A, of which the lower triangle is read, is positive definite and overwritten. */
static void solve(unsigned n, double A[VALUES][VALUES], double *b) {
  for (unsigned j = 0; j < n; j++) {
    for (unsigned k = 0; k < j; k++) A[j][j] -= A[j][k] * A[j][k];
    A[j][j] = sqrt(A[j][j]);
    for (unsigned i = j + 1; i < n; i++) {
      for (unsigned k = 0; k < j; k++) A[i][j] -= A[i][k] * A[j][k];
      A[i][j] /= A[j][j];
    }
    for (unsigned k = 0; k < j; k++) b[j] -= A[j][k] * b[k];
    b[j] /= A[j][j];
  }
  for (unsigned j = n; j-- > 0;) {
    for (unsigned k = j + 1; k < n; k++) b[j] -= A[k][j] * b[k];
    b[j] /= A[j][j];
  }
}

/* The impulse P of each number C, see above. G and R = M^-1 G^T: values x arity, one vector each. */
static void impulses(const hk_element_tuple *e, const hk_xpbd_substep *s, const double (*G)[3], const double (*R)[3],
                     const double (*p)[3], const double *C, double *P) {
  unsigned values = e->list->values, arity = e->list->node.arity;
  double A[VALUES][VALUES], hk = s->h * e->stiffness, hc = s->h * e->damping, f = s->h * hk + hc;
  for (unsigned q = 0; q < values; q++) {
    P[q] = -hk * C[q];
    for (unsigned a = 0; a < arity; a++)
      P[q] += f * dot(R[arity * q + a], p[a]) - hc * dot(G[arity * q + a], s->v[e->member[a]]);
    for (unsigned r = 0; r <= q; r++) {
      A[q][r] = q == r;
      for (unsigned a = 0; a < arity; a++) A[q][r] += f * dot(G[arity * q + a], R[arity * r + a]);
    }
  }
  solve(values, A, P);
}

/* Replaces the impulse `before` of member a by `next`; returns the work of a path pin on it. */
static double give(const hk_element_tuple *e, const hk_xpbd_substep *s, unsigned a, double before[3],
                   const double next[3]) {
  uint32_t i = e->member[a];
  double change[3], push[3];
  for (int c = 0; c < 3; c++) change[c] = next[c] - before[c];
  respond(s->pins, i, change, push);
  for (int c = 0; c < 3; c++) {
    s->v[i][c] += push[c];
    before[c] = next[c];
  }
  return s->pins->pin[i] == HK_PIN_PATH ? -dot(change, s->v[i]) : 0;
}

static double project(hk_xpbd_elements *m, const hk_xpbd_substep *s, size_t q, bool last) {
  const hk_element_tuple *e = &m->tuples.item[q];
  unsigned values = e->list->values, arity = e->list->node.arity;
  double C[VALUES], P[VALUES], G[4 * VALUES][3], R[4 * VALUES][3], work = 0;
  for (unsigned a = 0; a < arity; a++)
    for (size_t i = e->member[a], c = 0; c < 3; c++) m->x[3 * i + c] = s->x[i][c] + s->h * s->v[i][c];
  hk_element_tuple_evaluate(e, m->x, C, G);
  for (unsigned k = 0; k < values * arity; k++) respond(s->pins, e->member[k % arity], G[k], R[k]);
  impulses(e, s, (const double(*)[3])G, (const double(*)[3])R, (const double(*)[3])m->impulse[q], C, P);
  for (unsigned a = 0; a < arity; a++) {
    double next[3] = {0};
    for (unsigned k = 0; k < values; k++)
      for (int c = 0; c < 3; c++) next[c] += P[k] * G[arity * k + a][c];
    work += give(e, s, a, m->impulse[q][a], next);
  }
  for (unsigned k = 0; k < values && last && e->damping != 0; k++) {
    double u = 0;
    for (unsigned a = 0; a < arity; a++) u += dot(G[arity * k + a], s->v[e->member[a]]);
    work -= s->h * e->damping * u * u;
  }
  return work;
}

typedef struct sweep {
  hk_xpbd_elements *m;
  const hk_xpbd_substep *s;
  size_t first; /* position in `sequence` */
  bool last;
} sweep;

static void sweep_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sweep *w = context;
  double work = 0;
  for (size_t k = w->first + begin; k < w->first + end; k++) work += project(w->m, w->s, w->m->sequence[k], w->last);
  w->m->work[chunk] = work;
}

static double sweep_uncoloured(hk_xpbd_elements *m, const hk_xpbd_substep *s, bool back, bool last) {
  double work = 0;
  size_t first = m->colour[m->colours], count = m->tuples.count - first;
  for (size_t k = 0; k < count; k++) work += project(m, s, m->sequence[first + (back ? count - 1 - k : k)], last);
  return work;
}

double hk_xpbd_elements_sweep(hk_xpbd_elements *m, const hk_xpbd_substep *s, bool back, bool last) {
  double work = back ? sweep_uncoloured(m, s, back, last) : 0;
  for (size_t turn = 0; turn < m->colours; turn++) {
    size_t c = back ? m->colours - 1 - turn : turn, count = m->colour[c + 1] - m->colour[c];
    size_t grain = count > 2 * GRAIN ? GRAIN : count; /* a smaller loop is not worth waking threads */
    sweep w = {m, s, m->colour[c], last};
    if (grain < count)
      s->host->parallel_for(s->host, count, grain, sweep_chunk, &w);
    else
      sweep_chunk(&w, 0, count, 0);
    for (size_t k = 0; k * grain < count; k++) work += m->work[k];
  }
  return back ? work : work + sweep_uncoloured(m, s, back, last);
}
