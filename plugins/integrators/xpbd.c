/* XPBD in small steps. A step h is divided into `substeps` of length h_s. In each, forces without elements (gravity,
 * drag) change the velocities explicitly; then `iterations` sweeps of Gauss-Seidel solve the springs one by one, with
 * compliance 1/k and damping c of the scene (xpbd_springs.c), and after them the other elements (xpbd_elements.c). A
 * single spring is solved exactly: a substep is backward Euler. With several springs, the fixed point of the sweeps is
 * backward Euler up to the rotation of the springs' directions, which vanishes with h_s; that of other elements is
 * backward Euler. Both hold where the sweeps converge: for an element that is stiff (h_s w far above 1) and strained by
 * its own size the linearised correction overshoots; shorter substeps or local_global avoid this.
 *
 * With bdf = 2 a substep is a backward difference of order 2: X' = X + (X - X_before)/3 + g f(X') is backward Euler
 * with g = 2/3 h_s from another starting point, so the same sweeps solve it; explicit forces are those of
 * 2 X - X_before at the end of the substep. The first substep after a start or a reset is backward Euler.
 *
 * Both orders assume that the sweeps converge: for h_s w above 1 a single sweep has the effect of a compliance of about
 * g^2 W, W = 1/m_i + 1/m_j, added to a spring. The error that forward sweeps leave is also not symmetric: measured on a
 * curtain, the error of order 2 then first rises with shorter substeps before it falls, while with symmetric sweeps it
 * falls throughout. Channels and work are integrated by the same rule.
 *
 * Contact (the correctors) acts at the end of a step, not of a substep, and moves what touches by the way of a whole
 * step, on top of what unconverged sweeps leave: a sheet of 33 x 33 particles that falls on a ball is strained by 0.65
 * in steps of 1/120 s with 10 substeps, by 0.34 with 100 of them, and by 0.063 with steps of a substep's length, one
 * substep and 10 iterations (substeps=1,iterations=10, dt = 1/1200 s), where leapfrog has 0.062. The verdict finds the
 * energy of the others wrong.
 *
 * Macklin, Mueller and Chentanez 2016, XPBD, (18) and (26); Macklin and others 2019, Small steps, algorithm 1.
 *
 * For pictures at a fixed price that holds at any stiffness, without a matrix: cloth of 8 x 8 particles, k = 1e6 N/m,
 * is off by 8e-4 m with 256 substeps a frame, 15 ms of a Xeon, but its energy is not balanced; local_global takes 46 ms
 * for 1.9e-3 m, linear_bdf2 4 ms for 6e-4 (the command is in backward_euler.c).
 */
#include "plugins/kit/integrate/growth_factor.h"
#include "plugins/common/elements/xpbd_springs.h"

#include "core/plugin.h"

#include <string.h>

enum { SUBSTEPS = 10 };
enum { FORWARD, SYMMETRIC };

typedef struct xpbd {
  int64_t substeps, iterations, bdf;
  int sweep;
  double *next, *older, *guess, *slope, *imposed; /* shaped as X: states; (a, dy); pins at the end of the substep */
  double *before;                                 /* shaped as X: the state one substep of `length` before X */
  int64_t known;                                  /* whether `before` is valid */
  double length;
  hk_xpbd_springs springs;
} xpbd;

static const hk_param params[] = {
    {"substeps", "", "parts of a step, each with forces and springs; stated growth factors are for the default",
     .integer = HK_AT(xpbd, substeps), .initial = {SUBSTEPS}, .limits = HK_WITHIN(1, 1e6)},
    {"iterations", "", "sweeps over the elements per substep", .integer = HK_AT(xpbd, iterations), .initial = {1},
     .limits = HK_WITHIN(1, 1e6)},
    {"order", "",
     "of the elements: the scene's, or by colours (faster); auto: colours from 1000 on, of springs and of others",
     .choice = HK_AT(xpbd, springs.order), .initial = {HK_XPBD_AUTO}, .choices = "auto|scene|colours"},
    {"bdf", "",
     "order of the backward differences of a substep: 1, backward Euler, or 2; stated growth factors are for 1",
     .integer = HK_AT(xpbd, bdf), .initial = {1}, .limits = HK_WITHIN(1, 2)},
    {"sweep", "", "one sweep through the springs: forward, or there and back (twice the work)",
     .choice = HK_AT(xpbd, sweep), .initial = {FORWARD}, .choices = "forward|symmetric"},
    {0},
};

static const hk_field fields[] = {
    {"next", .state = HK_AT(xpbd, next), .width = 1, .flags = HK_SCRATCH},
    {"before", .state = HK_AT(xpbd, before), .width = 1},
    {"known", .integer = HK_AT(xpbd, known)},
    {"length", .number = HK_AT(xpbd, length)},
    {"older", .state = HK_AT(xpbd, older), .width = 1, .flags = HK_SCRATCH},
    {"guess", .state = HK_AT(xpbd, guess), .width = 1, .flags = HK_SCRATCH},
    {"slope", .state = HK_AT(xpbd, slope), .width = 1, .flags = HK_SCRATCH},
    {"imposed", .state = HK_AT(xpbd, imposed), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* Backward Euler for a spring with damping: (1 + hg + z) u^2 + (hg + 2z) u + z = 0, z = (h w)^2, lambda = 1 + u, for
 * each of the default substeps. The parameters are not taken into account: with bdf = 2 the factor of a spring is that
 * of the plugin bdf2, also at most 1, but closer to it. For several springs neither factor describes sweeps that have
 * not converged. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  double w = hw / SUBSTEPS, g = hg / SUBSTEPS, z = w * w;
  if (hb != 0) return NAN;
  return pow(hk_polynomial_growth(2, (const double[]){z, g + 2 * z, 1 + g + z}), SUBSTEPS);
}

/* A substep from X and, for backward differences of order 2, from `older`, the state before it: the unknowns are
 * X' = X + r (X - older) + g f, with r = 0, g = h or r = 1/3, g = 2/3 h. X' is written to `older`, which may be X. */
typedef struct part {
  double *X, *older, t, t_next, r, g;
} part;

/* Path pins move on a straight line to their positions at the end of the substep. */
static void spread(xpbd *m, const part *p, const double *a) {
  size_t n3 = 3 * m->springs.edges.n;
  for (size_t i = 0; i < m->springs.edges.n; i++) {
    bool path = m->springs.edges.pin[i] == HK_PIN_PATH;
    for (size_t c = 0, k = 3 * i; c < 3; c++, k++) {
      double x = p->X[k] + p->r * (p->X[k] - p->older[k]), v = p->X[n3 + k];
      v += p->r * (v - p->older[n3 + k]);
      m->springs.x[i][c] = x;
      m->springs.v[i][c] = path ? (m->imposed[k] - x) / p->g : v + p->g * a[k];
    }
  }
}

static void gather(const xpbd *m, const part *p) {
  double *x = p->older, *v = x + 3 * m->springs.edges.n;
  for (size_t i = 0; i < m->springs.edges.n; i++) {
    bool path = m->springs.edges.pin[i] == HK_PIN_PATH, fixed = m->springs.edges.pin[i] == HK_PIN_FIXED;
    for (size_t c = 0, k = 3 * i; c < 3; c++, k++) {
      v[k] = path    ? m->imposed[3 * m->springs.edges.n + k]
             : fixed ? p->X[3 * m->springs.edges.n + k]
                     : m->springs.v[i][c];
      x[k] = path ? m->imposed[k] : fixed ? p->X[k] : m->springs.x[i][c] + p->g * v[k];
    }
  }
}

/* Evaluates the explicit forces: at the start of the substep or, for order 2, at its end, in the state extrapolated
 * from X and `older`. */
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
  hk_status status = explicit_forces(m, s, p);
  if (status != HK_OK) return status;
  if (m->springs.edges.paths > 0) {
    memcpy(m->imposed, p->X, y * sizeof *p->X);
    s->impose(s, p->t_next, m->imposed, m->imposed + v);
  }
  spread(m, p, a);
  double work = hk_xpbd_springs_solve(&m->springs, s->host, p->g, m->iterations, m->sweep == SYMMETRIC);
  gather(m, p);
  for (size_t k = y; k < s->size; k++) p->older[k] = p->X[k] + p->r * (p->X[k] - p->older[k]) + p->g * a[k - v];
  p->older[s->size - 1] += work;
  return HK_OK;
}

static void reset(void *self, hk_reason why) {
  if (why != HK_CHECKPOINT) ((xpbd *)self)->known = 0;
}

/* Takes `substeps` of `length`. The first one is backward Euler if the state before it is not known. */
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

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  xpbd *m = self;
  double length = h / (double)m->substeps;
  bool two = m->bdf == 2, known = two && m->known && m->length == length;
  part p = {.X = m->next, .older = two ? m->older : m->next, .t = s->t};
  size_t bytes = s->size * sizeof *s->X;
  (void)method, (void)out;
  hk_status status = hk_xpbd_springs_take(&m->springs, s, m->imposed);
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
  hk_element_edges_drop(&((xpbd *)self)->springs.edges);
  return HK_OK;
}

static const hk_constrained_facet constrained = {.size = sizeof constrained,
                                                 .refused = "it treats elements only; give the bars as stiff springs"};
static const hk_facet facets[] = {{HK_CONSTRAINED_ID, &constrained}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = SUBSTEPS,
                                         .flags = HK_IMPLICIT,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "xpbd",
    .summary =
        "XPBD in small steps: elements solved one by one with compliance 1/k, the rest explicit; order 1, or 2 (bdf)",
    .reference = "Macklin, Mueller and Chentanez 2016, XPBD, (18) and (26); Macklin and others 2019, Small Steps in "
                 "Physics Simulation, algorithm 1",
    .instance_size = sizeof(xpbd),
    .params = params,
    .fields = fields,
    .topology = topology,
    .integrator = &integrator,
};
