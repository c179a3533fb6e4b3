/* Springs solved one by one: Gauss-Seidel sweeps over C = l - L with compliance 1/k and damping c. In each sweep the
 * elements with an `evaluate` follow (xpbd_elements.c).
 *
 * With n the gradient of C, W = 1/m_i + 1/m_j, alpha = 1/(k h^2), beta = c h^2 and gamma = alpha beta/h = c/(k h), the
 * paper's (26) for lambda, divided by alpha h, becomes an equation for the impulse P = lambda/h:
 *     dP = -(h k C + h c u + P)/(1 + (h^2 k + h c) W),   v_j += dP n/m_j,   v_i -= dP n/m_i,   u = n.(v_j - v_i),
 * which also holds for k = 0. Where P + h k C + h c u = 0, P is the impulse h F of the spring at the end of the
 * substep; a single spring reaches this with one solve, since its direction then no longer turns. Velocities are the
 * unknowns, positions are x + h v: both ends get opposite impulses, so momentum is conserved up to rounding.
 *
 * From COLOURS_FROM springs on they are solved colour by colour, four at a time; two springs of one colour never share
 * a particle. Results depend on that order, never on threads. Sliding particles move by S n/m, where S is the projector
 * of the pin. The work of damping is -h c u^2 and that of path pins -P n.v. Macklin, Mueller and Chentanez 2016, XPBD,
 * (18) and (26). */
#include "plugins/common/elements/xpbd_springs.h"

#include <math.h>
#include <string.h>

/* GRAIN: batches, about 30 us of work; a colour of less than two grains is not worth waking threads. */
enum { LANES = HK_XPBD_LANES, COLOURS = HK_XPBD_COLOURS, COLOURS_FROM = HK_XPBD_COLOURS_FROM, GRAIN = 1024 };

typedef struct hk_xpbd_spring {
  uint32_t i, j;
  double a, b, e, s, rest, wi, wj, P; /* a = h k, b = h c, e = h^2 k + h c, s = 1/(1 + e W) */
} spring;

typedef struct hk_xpbd_batch {
  uint32_t i[LANES], j[LANES];
  double a[LANES], b[LANES], s[LANES], rest[LANES], wi[LANES], wj[LANES], P[LANES];
} batch;

typedef double vector __attribute__((vector_size(8 * LANES)));
typedef int64_t mask __attribute__((vector_size(8 * LANES)));

/* ---- arrangement ---- */

static bool slides(const hk_element_edges *e, size_t q) {
  return e->slide[e->pair[q][0]] != HK_NO_SLIDE || e->slide[e->pair[q][1]] != HK_NO_SLIDE;
}

static bool follows(const hk_element_edges *e, size_t q) {
  return e->pin[e->pair[q][0]] == HK_PIN_PATH || e->pin[e->pair[q][1]] == HK_PIN_PATH;
}

static bool idle(const hk_element_edges *e, size_t q) {
  double W = e->inverse_mass[e->pair[q][0]] + e->inverse_mass[e->pair[q][1]];
  return (e->stiffness[q] == 0 && e->damping[q] == 0) || (W == 0 && !follows(e, q));
}

/* The lowest colour that neither end has; COLOURS: the spring is solved alone. */
static unsigned pick_colour(hk_xpbd_springs *m, size_t q) {
  const hk_element_edges *e = &m->edges;
  uint64_t *at = &m->used[e->pair[q][0]], *bt = &m->used[e->pair[q][1]], taken = *at | *bt;
  if (slides(e, q) || follows(e, q) || taken == UINT64_MAX) return COLOURS;
  unsigned c = 0;
  while (taken >> c & 1) c++;
  *at |= (uint64_t)1 << c;
  *bt |= (uint64_t)1 << c;
  return c;
}

static hk_status reserve(hk_xpbd_springs *m, const hk_host *host) {
  size_t springs = m->edges.capacity, n = m->edges.n, batches = springs / LANES + COLOURS;
  host->release(host, m->spring);
  host->release(host, m->batch);
  host->release(host, m->source);
  host->release(host, m->lane_source);
  host->release(host, m->used);
  host->release(host, m->tint);
  host->release(host, m->x);
  host->release(host, m->v);
  host->release(host, m->work);
  m->spring = host->allocate(host, (springs + 1) * sizeof *m->spring);
  m->batch = host->allocate(host, batches * sizeof *m->batch);
  m->source = host->allocate(host, (springs + 1) * sizeof *m->source);
  m->lane_source = host->allocate(host, batches * LANES * sizeof *m->lane_source);
  m->used = host->allocate(host, (n + 1) * sizeof *m->used);
  m->tint = host->allocate(host, springs + 1);
  m->x = host->allocate(host, (n + 1) * sizeof *m->x);
  m->v = host->allocate(host, (n + 1) * sizeof *m->v);
  m->work = host->allocate(host, (batches / GRAIN + COLOURS) * sizeof *m->work);
  bool fine = m->spring && m->batch && m->source && m->lane_source && m->used && m->tint && m->x && m->v && m->work;
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory to order %zu springs", springs);
}

static void arrange(hk_xpbd_springs *m) {
  const hk_element_edges *e = &m->edges;
  size_t count[COLOURS] = {0};
  bool alone = m->order == HK_XPBD_SCENE || (m->order == HK_XPBD_AUTO && e->count < COLOURS_FROM);
  memset(m->used, 0, e->n * sizeof *m->used);
  m->springs = m->colours = m->colour[0] = 0;
  for (size_t q = 0; q < e->count; q++) {
    m->tint[q] = idle(e, q) ? UINT8_MAX : (uint8_t)(alone ? COLOURS : pick_colour(m, q));
    if (m->tint[q] == COLOURS) m->source[m->springs++] = (uint32_t)q;
    if (m->tint[q] < COLOURS) count[m->tint[q]]++;
  }
  for (; m->colours < COLOURS && count[m->colours] > 0; m->colours++)
    m->colour[m->colours + 1] = m->colour[m->colours] + (count[m->colours] + LANES - 1) / LANES;
  m->batches = m->colour[m->colours];
  for (size_t k = 0; k < m->batches * LANES; k++) m->lane_source[k] = UINT32_MAX;
  memset(count, 0, sizeof count);
  for (size_t q = 0; q < e->count; q++) {
    unsigned c = m->tint[q];
    if (c < COLOURS) m->lane_source[LANES * m->colour[c] + count[c]++] = (uint32_t)q;
  }
}

static spring numbers(const hk_element_edges *e, size_t q, double h) {
  uint32_t i = e->pair[q][0], j = e->pair[q][1];
  spring s = {.i = i, .j = j, .rest = e->rest[q], .wi = e->inverse_mass[i], .wj = e->inverse_mass[j]};
  s.a = h * e->stiffness[q];
  s.b = h * e->damping[q];
  s.e = h * s.a + s.b;
  s.s = 1 / (1 + s.e * (s.wi + s.wj));
  return s;
}

static void set_numbers(hk_xpbd_springs *m, double h) {
  for (size_t k = 0; k < m->springs; k++) m->spring[k] = numbers(&m->edges, m->source[k], h);
  for (size_t k = 0; k < LANES * m->batches; k++) {
    batch *b = &m->batch[k / LANES];
    size_t r = k % LANES;
    uint32_t none = (uint32_t)m->edges.n, q = m->lane_source[k];
    spring s = q == UINT32_MAX ? (spring){.i = none, .j = none} : numbers(&m->edges, q, h);
    b->i[r] = s.i, b->j[r] = s.j;
    b->a[r] = s.a, b->b[r] = s.b, b->s[r] = s.s, b->rest[r] = s.rest;
    b->wi[r] = s.wi, b->wj[r] = s.wj;
  }
  m->h = h;
}

static hk_status take_elements(hk_xpbd_springs *m, hk_system *s, bool fresh) {
  size_t tuples = 0;
  for (size_t k = 0; k < s->model->element_lists; k++)
    if (!hk_elements_are_edges(&s->model->element_list[k].elements))
      tuples += s->model->element_list[k].elements.node.count;
  bool by_colour = m->order == HK_XPBD_BY_COLOUR || (m->order == HK_XPBD_AUTO && tuples >= COLOURS_FROM);
  return hk_xpbd_elements_take(&m->elements, s, fresh, by_colour);
}

hk_status hk_xpbd_springs_take(hk_xpbd_springs *m, hk_system *s, double *scratch) {
  bool fresh = !m->edges.valid, changed;
  hk_status status = hk_element_edges_take(&m->edges, s, scratch, &changed);
  if (status == HK_OK && fresh) status = reserve(m, s->host);
  if (status != HK_OK) {
    hk_element_edges_drop(&m->edges);
    return status;
  }
  if (!changed) return HK_OK;
  arrange(m);
  m->h = 0;
  status = take_elements(m, s, fresh);
  if (status != HK_OK) hk_element_edges_drop(&m->edges);
  return status;
}

/* ---- sweeps ---- */

/* The change of the velocity of particle i of inverse mass w by an impulse d: w S d. Returns d.S d w. */
static double respond(const hk_element_edges *e, uint32_t i, double w, const double d[3], double into[3]) {
  for (int c = 0; c < 3; c++) into[c] = w * d[c];
  if (e->slide[i] != HK_NO_SLIDE) {
    const double *S = e->projector[e->slide[i]];
    for (int c = 0; c < 3; c++) into[c] = w * (S[3 * c] * d[0] + S[3 * c + 1] * d[1] + S[3 * c + 2] * d[2]);
  }
  return into[0] * d[0] + into[1] * d[1] + into[2] * d[2];
}

/* Solves one spring; returns the work of path pins on it and, in the last sweep, of its damping. */
static double solve_one(const hk_xpbd_springs *m, spring *q, double h, bool last) {
  double d[3], ri[3], rj[3], *vi = m->v[q->i], *vj = m->v[q->j], l2 = 0, w = 0, pin = 0;
  for (int c = 0; c < 3; c++) {
    d[c] = (m->x[q->j][c] - m->x[q->i][c]) + h * (vj[c] - vi[c]);
    l2 += d[c] * d[c];
    w += d[c] * (vj[c] - vi[c]);
  }
  if (!(l2 > 0)) return 0;
  double l = sqrt(l2), u = w / l, s = q->s, W = q->wi + q->wj;
  double Wi = respond(&m->edges, q->i, q->wi, d, ri), Wj = respond(&m->edges, q->j, q->wj, d, rj);
  if (m->edges.slides > 0) {
    W = (Wi + Wj) / l2;
    s = 1 / (1 + q->e * W);
  }
  double p = -s * (q->a * (l - q->rest) + q->b * u + q->P), f = p / l;
  q->P += p;
  for (int c = 0; c < 3; c++) {
    vi[c] -= f * ri[c];
    vj[c] += f * rj[c];
  }
  if (m->edges.pin[q->i] == HK_PIN_PATH) pin += f * (d[0] * vi[0] + d[1] * vi[1] + d[2] * vi[2]);
  if (m->edges.pin[q->j] == HK_PIN_PATH) pin -= f * (d[0] * vj[0] + d[1] * vj[1] + d[2] * vj[2]);
  u += W * p;
  return pin - (last ? q->b * u * u : 0);
}

/* Transposes the rows (x, y, z, 0) of four springs into columns. */
#define COLUMNS(r, X, Y, Z)                                                                                            \
  do {                                                                                                                 \
    vector a_ = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), b_ = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6); \
    vector c_ = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7), d_ = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7); \
    X = __builtin_shufflevector(a_, b_, 0, 1, 4, 5);                                                                   \
    Z = __builtin_shufflevector(a_, b_, 2, 3, 6, 7);                                                                   \
    Y = __builtin_shufflevector(c_, d_, 0, 1, 4, 5);                                                                   \
  } while (0)

#define OF(lanes) (*(vector *)(void *)(lanes))

/* The same as solve_one, for four springs of one colour at a time. It is compiled for every width of vectors, with
 * the same operations and hence the same bits. */
HK_INLINE double solve_fours(batch *q, size_t count, double (*x)[LANES], double (*v)[LANES], double h, bool keep,
                             bool last) {
  vector work = {0};
  for (batch *end = q + count; q < end; q++) {
    vector d[LANES], g[LANES], dx, dy, dz, ux, uy, uz;
    for (int r = 0; r < LANES; r++) {
      g[r] = OF(v[q->j[r]]) - OF(v[q->i[r]]);
      d[r] = (OF(x[q->j[r]]) - OF(x[q->i[r]])) + h * g[r];
    }
    COLUMNS(d, dx, dy, dz);
    COLUMNS(g, ux, uy, uz);
    vector l2 = dx * dx + dy * dy + dz * dz, one = {1, 1, 1, 1};
    mask there = (mask)(l2 > 0);
    l2 = (vector)((there & (mask)l2) | (~there & (mask)one));
    vector l = {sqrt(l2[0]), sqrt(l2[1]), sqrt(l2[2]), sqrt(l2[3])}, n = 1 / l;
    vector u = (dx * ux + dy * uy + dz * uz) * n, s = (vector)((mask)OF(q->s) & there), p;
    if (keep) {
      p = -s * (OF(q->a) * (l - OF(q->rest)) + OF(q->b) * u + OF(q->P));
      OF(q->P) += p;
    } else
      p = -s * (OF(q->a) * (l - OF(q->rest)) + OF(q->b) * u);
    vector fi = p * n * OF(q->wi), fj = p * n * OF(q->wj);
    for (int r = 0; r < LANES; r++) {
      OF(v[q->i[r]]) -= fi[r] * d[r];
      OF(v[q->j[r]]) += fj[r] * d[r];
    }
    u += (OF(q->wi) + OF(q->wj)) * p;
    if (last) work -= (vector)((mask)(OF(q->b) * u * u) & there);
  }
  return (work[0] + work[1]) + (work[2] + work[3]);
}

HK_VERSIONS(static double, solve_batches,
            (batch * q, size_t count, double (*x)[LANES], double (*v)[LANES], double h, bool keep, bool last),
            return solve_fours(q, count, x, v, h, keep, last))

typedef struct sweep {
  const hk_xpbd_springs *m;
  size_t first; /* batch */
  double h;
  bool keep, last;
  int lanes;
} sweep;

static void sweep_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sweep *s = context;
  const hk_xpbd_springs *m = s->m;
  batch *q = m->batch + s->first + begin;
  m->work[chunk] = HK_WIDEST(s->lanes, solve_batches)(q, end - begin, m->x, m->v, s->h, s->keep, s->last);
}

/* One sweep over all springs, with the settings of `all`; returns the work. */
static double sweep_once(const hk_xpbd_springs *m, const hk_host *host, const sweep *all, bool back) {
  double work = 0;
  for (size_t k = 0; k < m->springs && back; k++)
    work += solve_one(m, &m->spring[m->springs - 1 - k], all->h, all->last);
  for (size_t turn = 0; turn < m->colours; turn++) {
    size_t c = back ? m->colours - 1 - turn : turn;
    size_t count = m->colour[c + 1] - m->colour[c], grain = count > 2 * GRAIN ? GRAIN : count;
    sweep s = *all;
    s.first = m->colour[c];
    if (grain < count)
      host->parallel_for(host, count, grain, sweep_chunk, &s);
    else
      sweep_chunk(&s, 0, count, 0);
    for (size_t k = 0; k * grain < count; k++) work += m->work[k];
  }
  for (size_t k = 0; k < m->springs && !back; k++) work += solve_one(m, &m->spring[k], all->h, all->last);
  return work;
}

double hk_xpbd_springs_solve(hk_xpbd_springs *m, const hk_host *host, double h, int64_t iterations, bool symmetric) {
  int64_t each = symmetric ? 2 : 1, sweeps = iterations * each;
  sweep s = {.m = m, .h = h, .keep = sweeps > 1, .lanes = host->lanes};
  double work = 0;
  if (h != m->h) set_numbers(m, h);
  for (size_t k = 0; k < m->springs; k++) m->spring[k].P = 0;
  for (size_t k = 0; k < m->batches && s.keep; k++) memset(m->batch[k].P, 0, sizeof m->batch[k].P);
  const hk_xpbd_substep substep = {host, &m->edges, m->x, m->v, h};
  bool others = m->elements.tuples.count > 0;
  if (others) hk_xpbd_elements_start(&m->elements);
  for (int64_t k = 0; k < sweeps; k++) {
    bool back = k % each == 1;
    s.last = k + 1 == sweeps;
    if (others && back) work += hk_xpbd_elements_sweep(&m->elements, &substep, true, s.last);
    work += sweep_once(m, host, &s, back);
    if (others && !back) work += hk_xpbd_elements_sweep(&m->elements, &substep, false, s.last);
  }
  return work;
}
