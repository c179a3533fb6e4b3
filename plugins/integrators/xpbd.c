/* XPBD in small steps. A step of h is `substeps` of h_s: forces without elements (gravity, drag) kick explicitly, then
 * `iterations` sweeps of Gauss-Seidel solve the springs one by one, with compliance 1/k and damping c of the scene.
 *
 * With C = l - L, n its gradient, W = 1/m_i + 1/m_j, alpha = 1/(k h_s^2), beta = c h_s^2 and gamma = alpha beta/h_s =
 * c/(k h_s), the paper's (26) for lambda, divided through by alpha h_s, is one for the impulse P = lambda/h_s:
 *     dP = -(h_s k C + h_s c u + P)/(1 + (h_s^2 k + h_s c) W),   v_j += dP n/m_j,   v_i -= dP n/m_i,   u = n.(v_j -
 * v_i), which knows k = 0. Where P + h_s k C + h_s c u = 0, P is the impulse h_s F of the spring at the end of the
 * substep; a single spring is there after one solve, since its direction then no longer turns: backward Euler exactly.
 * Several springs reach a fixed point that is backward Euler up to the turning of directions, which vanishes with h_s.
 *
 * With bdf = 2 the substeps are backward differences of order 2: X' = X + (X - X_before)/3 + g f' is backward Euler of
 * g = 2/3 h_s from another start, so the same sweeps solve it, and explicit forces are those of 2 X - X_before at the
 * end of the substep. The first substep after a start or a reset is backward Euler. Both hold as far as the sweeps
 * come: one sweep adds a compliance of about g^2 W to every spring. In the forward order that also is not symmetric,
 * which order 2, less damped, bears only where h_s is long against the springs' periods or short enough for the sweeps
 * to converge; a symmetric sweep bears it always.
 *
 * Velocities are the unknowns, x is x_n + h_s v: what one end loses the other gains, and momentum keeps to rounding.
 * From COLOURS_FROM springs on they are solved colour by colour, in a colour no two share a particle, four at a time;
 * results depend on that order, never on threads. Sliding particles move by S n/m, S what the pin allows. Channels and
 * work go by Euler's rule per substep; of the work of springs, damping takes h_s c u^2 and path pins give -P n.v.
 * Macklin, Mueller and Chentanez 2016, XPBD, (18) and (26); Macklin and others 2019, Small steps, algorithm 1. */
#include "plugins/common/element_edges.h"
#include "plugins/common/spectral.h"

#include "core/plugin.h"

#include <string.h>

/* GRAIN: batches, some 30 us of work; a colour of less than two grains does not pay for waking threads. */
enum { SUBSTEPS = 10, LANES = 4, COLOURS_FROM = 1000, COLOURS = 64, GRAIN = 1024 };
enum { ORDER_AUTO, ORDER_SCENE, ORDER_COLOURS };
enum { FORWARD, SYMMETRIC };

typedef struct spring {
  uint32_t i, j;
  double a, b, e, s, rest, wi, wj, P; /* h k, h c, h^2 k + h c, 1/(1 + e W) */
} spring;

typedef struct batch {
  uint32_t i[LANES], j[LANES];
  double a[LANES], b[LANES], s[LANES], rest[LANES], wi[LANES], wj[LANES], P[LANES];
} batch;

typedef double vector __attribute__((vector_size(8 * LANES)));
typedef int64_t mask __attribute__((vector_size(8 * LANES)));

typedef struct xpbd {
  int64_t substeps, iterations, bdf;
  int order, sweep;
  double *next, *older, *guess, *slope, *imposed; /* shaped as X: states; (a, dy); pins at the end of the substep */
  double *before;                                 /* shaped as X: a substep of `length` before X ... */
  int64_t known;                                  /* ... if it is known */
  double length;
  hk_element_edges edges;
  double h;                /* s, that the springs' numbers are for; 0: none */
  size_t springs, batches; /* solved one by one; in fours */
  spring *spring;
  batch *batch;
  uint32_t *source, *lane_source;      /* springs, batches x LANES: position in `edges` */
  size_t colours, colour[COLOURS + 1]; /* batches of colour k: colour[k] to colour[k + 1] */
  uint64_t *used;                      /* n: colours at a particle */
  uint8_t *tint;                       /* springs of `edges`: colour; COLOURS: alone, UINT8_MAX: does nothing */
  double (*x)[LANES], (*v)[LANES];     /* n + 1 each, the last for lanes without a spring */
  double *work;                        /* per chunk of batches */
} xpbd;

static const hk_param params[] = {
    {"substeps",
     "",
     "parts of a step, each with forces and springs; stated growth factors are for the default",
     HK_INTEGER,
     {SUBSTEPS},
     1,
     1e6,
     offsetof(xpbd, substeps),
     0,
     NULL},
    {"iterations",
     "",
     "sweeps over the springs per substep",
     HK_INTEGER,
     {1},
     1,
     1e6,
     offsetof(xpbd, iterations),
     0,
     NULL},
    {"order",
     "",
     "of the springs: the scene's, or by colours (faster); auto: colours from 1000 springs on",
     HK_CHOICE,
     {ORDER_AUTO},
     0,
     0,
     offsetof(xpbd, order),
     0,
     "auto|scene|colours"},
    {"bdf",
     "",
     "order of the backward differences of a substep: 1, backward Euler, or 2; stated growth factors are for 1",
     HK_INTEGER,
     {1},
     1,
     2,
     offsetof(xpbd, bdf),
     0,
     NULL},
    {"sweep",
     "",
     "one sweep through the springs: forward, or there and back (twice the work)",
     HK_CHOICE,
     {FORWARD},
     0,
     0,
     offsetof(xpbd, sweep),
     0,
     "forward|symmetric"},
    {0},
};

static const hk_field fields[] = {
    {"next", HK_FIELD_STATE, 1, offsetof(xpbd, next), HK_SCRATCH},
    {"before", HK_FIELD_STATE, 1, offsetof(xpbd, before), 0},
    {"known", HK_FIELD_INTEGER, 1, offsetof(xpbd, known), 0},
    {"length", HK_FIELD_NUMBER, 1, offsetof(xpbd, length), 0},
    {"older", HK_FIELD_STATE, 1, offsetof(xpbd, older), HK_SCRATCH},
    {"guess", HK_FIELD_STATE, 1, offsetof(xpbd, guess), HK_SCRATCH},
    {"slope", HK_FIELD_STATE, 1, offsetof(xpbd, slope), HK_SCRATCH},
    {"imposed", HK_FIELD_STATE, 1, offsetof(xpbd, imposed), HK_SCRATCH},
    {0},
};

/* Backward Euler for a spring with damping: (1 + hg + z) u^2 + (hg + 2z) u + z = 0, z = (h w)^2, lambda = 1 + u, for
 * each of the default substeps. */
static double amplification(double hw, double hg) {
  double w = hw / SUBSTEPS, g = hg / SUBSTEPS, z = w * w;
  return pow(hk_polynomial_growth(2, (const double[]){z, g + 2 * z, 1 + g + z}), SUBSTEPS);
}

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

/* The least colour that neither end has; COLOURS: the spring is solved alone. */
static unsigned pick_colour(xpbd *m, size_t q) {
  const hk_element_edges *e = &m->edges;
  uint64_t *at = &m->used[e->pair[q][0]], *bt = &m->used[e->pair[q][1]], taken = *at | *bt;
  if (slides(e, q) || follows(e, q) || taken == UINT64_MAX) return COLOURS;
  unsigned c = 0;
  while (taken >> c & 1) c++;
  *at |= (uint64_t)1 << c;
  *bt |= (uint64_t)1 << c;
  return c;
}

static hk_status reserve(xpbd *m, const hk_host *host) {
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

static void arrange(xpbd *m) {
  const hk_element_edges *e = &m->edges;
  size_t count[COLOURS] = {0};
  bool alone = m->order == ORDER_SCENE || (m->order == ORDER_AUTO && e->count < COLOURS_FROM);
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

static void set_numbers(xpbd *m, double h) {
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

/* ---- the springs ---- */

/* What a push along d does to the velocity of particle i of inverse mass w: w S d. Returns d.S d w. */
static double respond(const hk_element_edges *e, uint32_t i, double w, const double d[3], double into[3]) {
  for (int c = 0; c < 3; c++) into[c] = w * d[c];
  if (e->slide[i] != HK_NO_SLIDE) {
    const double *S = e->projector[e->slide[i]];
    for (int c = 0; c < 3; c++) into[c] = w * (S[3 * c] * d[0] + S[3 * c + 1] * d[1] + S[3 * c + 2] * d[2]);
  }
  return into[0] * d[0] + into[1] * d[1] + into[2] * d[2];
}

/* Solves one spring; returns the work of its damping, when it is the last sweep, and of path pins on it. */
static double solve_one(const xpbd *m, spring *q, double h, bool last) {
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

/* Rows (x, y, z, 0) of four springs to columns. */
#define COLUMNS(r, X, Y, Z)                                                                                            \
  do {                                                                                                                 \
    vector a_ = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), b_ = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6); \
    vector c_ = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7), d_ = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7); \
    X = __builtin_shufflevector(a_, b_, 0, 1, 4, 5);                                                                   \
    Z = __builtin_shufflevector(a_, b_, 2, 3, 6, 7);                                                                   \
    Y = __builtin_shufflevector(c_, d_, 0, 1, 4, 5);                                                                   \
  } while (0)

#define OF(lanes) (*(vector *)(void *)(lanes))

/* solve_one for four springs at a time of one colour. Compiled for two instruction sets: same operations, same
 * bits. */
static inline __attribute__((always_inline)) double solve_fours(batch *q, size_t count, double (*x)[LANES],
                                                                double (*v)[LANES], double h, bool keep, bool last) {
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

#if defined(__x86_64__)
__attribute__((target("avx2"))) static double solve_wide(batch *q, size_t count, double (*x)[LANES], double (*v)[LANES],
                                                         double h, bool keep, bool last) {
  return solve_fours(q, count, x, v, h, keep, last);
}
static bool has_wide(void) { return __builtin_cpu_supports("avx2"); }
#else
#define solve_wide solve_fours
static bool has_wide(void) { return false; }
#endif

static double solve_plain(batch *q, size_t count, double (*x)[LANES], double (*v)[LANES], double h, bool keep,
                          bool last) {
  return solve_fours(q, count, x, v, h, keep, last);
}

typedef struct sweep {
  const xpbd *m;
  size_t first; /* batch */
  double h;
  bool last, wide;
} sweep;

static void sweep_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const sweep *s = context;
  const xpbd *m = s->m;
  batch *q = m->batch + s->first + begin;
  bool keep = m->iterations > 1 || m->sweep == SYMMETRIC;
  m->work[chunk] = s->wide ? solve_wide(q, end - begin, m->x, m->v, s->h, keep, s->last)
                           : solve_plain(q, end - begin, m->x, m->v, s->h, keep, s->last);
}

/* One sweep over all springs; returns the work. */
static double sweep_once(const xpbd *m, const hk_host *host, double h, bool last, bool back) {
  bool wide = has_wide();
  double work = 0;
  for (size_t k = 0; k < m->springs && back; k++) work += solve_one(m, &m->spring[m->springs - 1 - k], h, last);
  for (size_t turn = 0; turn < m->colours; turn++) {
    size_t c = back ? m->colours - 1 - turn : turn;
    size_t count = m->colour[c + 1] - m->colour[c], grain = count > 2 * GRAIN ? GRAIN : count;
    sweep s = {m, m->colour[c], h, last, wide};
    if (grain < count)
      host->parallel_for(host, count, grain, sweep_chunk, &s);
    else
      sweep_chunk(&s, 0, count, 0);
    for (size_t k = 0; k * grain < count; k++) work += m->work[k];
  }
  for (size_t k = 0; k < m->springs && !back; k++) work += solve_one(m, &m->spring[k], h, last);
  return work;
}

static double solve_springs(xpbd *m, const hk_host *host, double h) {
  double work = 0;
  int64_t each = m->sweep == SYMMETRIC ? 2 : 1, sweeps = m->iterations * each;
  for (size_t k = 0; k < m->springs; k++) m->spring[k].P = 0;
  for (size_t k = 0; k < m->batches && sweeps > 1; k++) memset(m->batch[k].P, 0, sizeof m->batch[k].P);
  for (int64_t k = 0; k < sweeps; k++) work += sweep_once(m, host, h, k + 1 == sweeps, k % each == 1);
  return work;
}

/* ---- the step ---- */

/* A substep from X and, for backward differences of order 2, from `older`, the state before it: the unknowns are
 * X' = X + r (X - older) + g f, with r = 0, g = h or r = 1/3, g = 2/3 h. It is written to `older`, which may be X. */
typedef struct part {
  double *X, *older, t, t_next, r, g;
} part;

/* Path pins go straight to where they are at the end. */
static void spread(xpbd *m, const part *p, const double *a) {
  size_t n3 = 3 * m->edges.n;
  for (size_t i = 0; i < m->edges.n; i++) {
    bool path = m->edges.pin[i] == HK_PIN_PATH;
    for (size_t c = 0, k = 3 * i; c < 3; c++, k++) {
      double x = p->X[k] + p->r * (p->X[k] - p->older[k]), v = p->X[n3 + k];
      v += p->r * (v - p->older[n3 + k]);
      m->x[i][c] = x;
      m->v[i][c] = path ? (m->imposed[k] - x) / p->g : v + p->g * a[k];
    }
  }
}

static void gather(const xpbd *m, const part *p) {
  double *x = p->older, *v = x + 3 * m->edges.n;
  for (size_t i = 0; i < m->edges.n; i++) {
    bool path = m->edges.pin[i] == HK_PIN_PATH, fixed = m->edges.pin[i] == HK_PIN_FIXED;
    for (size_t c = 0, k = 3 * i; c < 3; c++, k++) {
      v[k] = path ? m->imposed[3 * m->edges.n + k] : fixed ? p->X[3 * m->edges.n + k] : m->v[i][c];
      x[k] = path ? m->imposed[k] : fixed ? p->X[k] : m->x[i][c] + p->g * v[k];
    }
  }
}

/* What is taken explicitly: at the start of the substep, or for order 2 where X and `older` point to at its end. */
static hk_status explicit_forces(xpbd *m, hk_system *s, const part *p) {
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = p->X, t = p->t;
  if (p->r > 0) {
    X = m->guess;
    t = p->t_next;
    for (size_t e = 0; e < s->size; e++) X[e] = p->X[e] + (p->X[e] - p->older[e]);
  }
  return s->accelerations(s, t, X, X + v, X + y, m->slope, m->slope + v);
}

static hk_status substep(xpbd *m, hk_system *s, const part *p) {
  size_t v = 3 * s->n, y = 6 * s->n;
  const double *a = m->slope;
  if (p->g != m->h) set_numbers(m, p->g);
  hk_status status = explicit_forces(m, s, p);
  if (status != HK_OK) return status;
  if (m->edges.paths > 0) {
    memcpy(m->imposed, p->X, y * sizeof *p->X);
    s->impose(s, p->t_next, m->imposed, m->imposed + v);
  }
  spread(m, p, a);
  double work = solve_springs(m, s->host, p->g);
  gather(m, p);
  for (size_t k = y; k < s->size; k++) p->older[k] = p->X[k] + p->r * (p->X[k] - p->older[k]) + p->g * a[k - v];
  p->older[s->size - 1] += work;
  return HK_OK;
}

static hk_status prepare(xpbd *m, hk_system *s) {
  bool fresh = !m->edges.valid, changed;
  hk_status status = hk_element_edges_take(&m->edges, s, m->imposed, &changed);
  if (status == HK_OK && fresh) status = reserve(m, s->host);
  if (status != HK_OK) {
    hk_element_edges_drop(&m->edges);
    return status;
  }
  if (changed) arrange(m);
  if (changed) m->h = 0;
  return HK_OK;
}

static void reset(void *self, hk_reason why) {
  (void)why;
  ((xpbd *)self)->known = 0;
}

/* Of `substeps` of `length`, the first a backward Euler where the state before it is not known. */
static hk_status substeps(xpbd *m, hk_system *s, double t_stop, double length, bool known, part *p) {
  hk_status status = HK_OK;
  for (int64_t k = 1; k <= m->substeps && status == HK_OK; k++) {
    p->t_next = k == m->substeps ? t_stop : s->t + (double)k * length;
    p->r = known ? 1.0 / 3 : 0;
    p->g = known ? 2 * length / 3 : length;
    status = substep(m, s, p);
    p->t = p->t_next;
    double *X = p->older;
    p->older = p->X;
    p->X = X;
    known = m->bdf == 2;
  }
  return status;
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  xpbd *m = self;
  double length = h / (double)m->substeps;
  bool two = m->bdf == 2, known = two && m->known && m->length == length;
  part p = {.X = m->next, .older = two ? m->older : m->next, .t = s->t};
  size_t bytes = s->size * sizeof *s->X;
  (void)out;
  hk_status status = prepare(m, s);
  if (status != HK_OK) return status;
  memcpy(m->next, s->X, bytes);
  if (two) memcpy(m->older, known ? m->before : s->X, bytes);
  status = substeps(m, s, fmin(t_stop, s->t + h), length, known, &p);
  if (status != HK_OK) return status;
  memcpy(s->X, p.X, bytes);
  if (two) memcpy(m->before, p.older, bytes);
  m->known = two;
  m->length = length;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  (void)view;
  hk_element_edges_drop(&((xpbd *)self)->edges);
  return HK_OK;
}

static const hk_integrator integrator = {
    .order = 1, .stages = SUBSTEPS, .flags = HK_IMPLICIT, .amplification = amplification, .step = step, .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "xpbd",
    .summary = "XPBD in small steps: springs solved one by one with compliance 1/k, the rest explicit; order 1",
    .reference = "Macklin, Mueller and Chentanez 2016, XPBD, (18) and (26); Macklin and others 2019, Small Steps in "
                 "Physics Simulation, algorithm 1",
    .instance_size = sizeof(xpbd),
    .params = params,
    .fields = fields,
    .topology = topology,
    .integrator = &integrator,
};
