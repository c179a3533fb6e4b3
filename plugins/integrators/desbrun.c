/* The predictor of Desbrun, Schroeder and Barr: internal forces are smoothed by a constant filter and then applied
 * explicitly.
 *
 * The force of the springs is F_i = sum_j k_ij (l - L) n + c (u.n) n + h k_ij (v_j - v_i), the paper's plus the
 * springs' own damping c. With H_ij = k_ij, H_ii = -sum_j k_ij, the same for every coordinate and state, the filter for
 * general masses is F' = (I - h^2 H M^-1)^-1 F. Its columns sum to 1, so the total force is kept. With F' = M a it is
 * (M - h^2 H) a = F, symmetric and positive definite, with one unknown per particle. The scene's solver factorizes the
 * matrix once and solves for three right-hand sides per step, as long as h, pins and topology do not change. The paper
 * stores the dense inverse; the results are the same, but its product costs n^2 operations, a solve about n log n. Then
 * v += h (a + a_external), x += h v.
 *
 * The forces of the filter and of the viscosity h H v are not central and slow down the rotation of bodies.
 * `correction` removes the rigid rotation from a: a_i -= A x (x_i - x_G) with I A = sum (x_i - x_G) x m_i a_i, I the
 * inertia tensor, so that the net torque vanishes (the paper's own term, a torque times h, has no consistent
 * dimension). It also removes the rotation from the v of the viscosity, which the paper does not: otherwise
 * (1 - P) h H v, P the projection onto rotations, can have positive power, and a swinging curtain gained a seventh of
 * its kinetic energy. It acts on each connected body, and on the rotations that the pins allow (body_turns.c).
 *
 * The strain limit that the paper applies after each step is left to a corrector. Channels and work are integrated by
 * Euler's rule. Desbrun, Schroeder and Barr 1999, Interactive animation of structured deformable objects, sections 3
 * and 4.
 *
 * For steps of the length of a frame, as its authors use it, and not for accuracy: stiff cloth to 1e-2 m
 * takes it 589,824 steps where backward_euler takes 138 evaluations (the command is there).
 */
#include "plugins/common/linear/laplacian.h"
#include "plugins/common/integrate/slide_pins.h"
#include "plugins/common/turns/body_turns.h"
#include "plugins/kit/integrate/growth_factor.h"
#include "plugins/kit/vector3.h"

#include "core/plugin.h"

#include <string.h>

typedef struct desbrun {
  bool correction;
  double *next, *slope, *imposed, *force, *scratch; /* shaped as X: new state; (a, dy); pins at the end; (F, a) */
  hk_element_edges edges;
  double h;       /* s, the step of the factorized matrix; 0: none */
  double *weight; /* h^2 k, one per spring */
  hk_laplacian laplacian;
  hk_slide_pins slides;
  hk_body_turns turns;
} desbrun;

static const hk_param params[] = {
    {"correction", "", "keep the angular momentum that the filter would change", .boolean = HK_AT(desbrun, correction),
     .initial = {1}},
    {0},
};

static const hk_field fields[] = {
    {"next", .state = HK_AT(desbrun, next), .width = 1, .flags = HK_SCRATCH},
    {"slope", .state = HK_AT(desbrun, slope), .width = 1, .flags = HK_SCRATCH},
    {"imposed", .state = HK_AT(desbrun, imposed), .width = 1, .flags = HK_SCRATCH},
    {"force", .state = HK_AT(desbrun, force), .width = 1, .flags = HK_SCRATCH},
    {"scratch", .state = HK_AT(desbrun, scratch), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* For the oscillation of a spring: a = -(z x/h + (hg + z) v)/h/(1 + z) with z = (h w)^2, v' = v + h a, x' = x + h v',
 * lambda = 1 + u, so that (1 + z) u^2 + (hg + 2z) u + z = 0. Without damping it is backward Euler. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  double z = hw * hw;
  return hb == 0 ? hk_polynomial_growth(2, (const double[]){z, hg + 2 * z, 1 + z}) : NAN;
}

/* ---- the step ---- */

static hk_status reserve(desbrun *m, const hk_host *host) {
  size_t n = m->edges.n, springs = m->edges.capacity;
  host->release(host, m->weight);
  m->weight = host->allocate(host, (springs + 1) * sizeof *m->weight);
  bool fine = hk_body_turns_reserve(&m->turns, host, n, springs) == HK_OK && m->weight;
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu springs and %zu particles", springs, n);
}

static hk_status arrange(desbrun *m, hk_system *s, bool fresh) {
  hk_status status = fresh ? reserve(m, s->host) : HK_OK;
  if (status == HK_OK) status = hk_slide_pins_build(&m->slides, s->host, &m->edges);
  if (status == HK_OK)
    status = hk_laplacian_build(&m->laplacian, s->host, s->n, m->edges.count, (const uint32_t(*)[2])m->edges.pair);
  if (status == HK_OK) hk_body_turns_arrange(&m->turns, &m->edges);
  return status;
}

/* Factorizes M - h^2 H: the weights of the springs are h^2 k. */
static hk_status factorize(desbrun *m, hk_system *s, double h) {
  m->h = 0;
  for (size_t q = 0; q < m->edges.count; q++) m->weight[q] = h * h * m->edges.stiffness[q];
  hk_laplacian_fill(&m->laplacian, s->model->mass, s->model->inverse_mass, m->weight);
  hk_status status = s->linear->factorize(s, &m->laplacian.matrix);
  if (status == HK_OK) status = hk_slide_pins_factorize(&m->slides, s, m->force, m->force + 3 * s->n);
  if (status == HK_OK) m->h = h;
  return status;
}

static hk_status prepare(desbrun *m, hk_system *s, double h) {
  bool fresh = !m->edges.valid, changed;
  hk_status status = hk_element_edges_uncoupled(s);
  if (status == HK_OK) status = hk_element_edges_take(&m->edges, s, m->imposed, &changed);
  if (status == HK_OK && changed) status = arrange(m, s, fresh);
  if (status == HK_OK && (changed || h != m->h)) status = factorize(m, s, h);
  if (status != HK_OK) hk_element_edges_drop(&m->edges);
  return status;
}

/* Adds to F the springs' forces and h H v; returns the power of their damping. */
static double add_springs(const desbrun *m, const double *x, const double *v, double h, double *F) {
  const hk_element_edges *e = &m->edges;
  double power = 0;
  for (size_t q = 0; q < e->count; q++) {
    size_t i = 3 * (size_t)e->pair[q][0], j = 3 * (size_t)e->pair[q][1];
    double d[3], u[3], t[3], k = e->stiffness[q], c = e->damping[q];
    for (int p = 0; p < 3; p++) {
      d[p] = x[j + p] - x[i + p];
      u[p] = v[j + p] - v[i + p];
    }
    double l = sqrt(hk_dot(d, d)), along = l > 0 ? hk_dot(d, u) / l : 0;
    double f = l > 0 ? (k * (l - e->rest[q]) + c * along) / l : 0;
    power -= c * along * along;
    if (m->correction) {
      uint32_t b = m->turns.label[i / 3] == HK_NO_BODY ? m->turns.label[j / 3] : m->turns.label[i / 3];
      hk_cross(t, b == HK_NO_BODY ? (const double[3]){0} : m->turns.body[b].turn, d);
      for (int p = 0; p < 3; p++) u[p] -= t[p];
    }
    for (int p = 0; p < 3; p++) {
      double pull = f * d[p] + h * k * u[p];
      F[i + p] += pull;
      F[j + p] -= pull;
    }
  }
  return power;
}

/* The power of path pins: their filtered forces are F + h^2 H a, with a = 0 at the pins themselves. */
static double path_power(const desbrun *m, const double *F, const double *a, const double *v, double h) {
  const hk_element_edges *e = &m->edges;
  double power = 0;
  for (size_t k = 0; m->edges.paths > 0 && k < 3 * e->n; k++)
    if (e->pin[k / 3] == HK_PIN_PATH) power -= F[k] * v[k];
  for (size_t q = 0; m->edges.paths > 0 && q < 2 * e->count; q++) {
    size_t i = e->pair[q / 2][q % 2], j = e->pair[q / 2][1 - q % 2];
    if (e->pin[i] == HK_PIN_PATH) power -= h * h * e->stiffness[q / 2] * hk_dot(a + 3 * j, v + 3 * i);
  }
  return power;
}

/* a = (M - h^2 H)^-1 F among the motions that pins allow. Pinned particles have separate equations, whose solution is
 * discarded. */
static hk_status filter_forces(desbrun *m, hk_system *s, const double *F, double *a) {
  hk_status status = s->linear->solve_columns(s, F, a, 3);
  if (status == HK_OK) status = hk_slide_pins_correct(&m->slides, s, a, m->scratch, m->scratch + 3 * s->n);
  if (status == HK_OK) s->filter(s, a);
  return status;
}

/* Path pins get the constant velocity that leads to their positions at the end of the step. */
static void impose_end(desbrun *m, hk_system *s, double t_next, double *X, double h) {
  size_t v = 3 * s->n;
  if (m->edges.paths == 0) return;
  memcpy(m->imposed, X, 2 * v * sizeof *X);
  s->impose(s, t_next, m->imposed, m->imposed + v);
  for (size_t k = 0; k < v; k++)
    if (m->edges.pin[k / 3] == HK_PIN_PATH) X[v + k] = (m->imposed[k] - X[k]) / h;
}

static void advance(const desbrun *m, double *x, double *v, const double *external, const double *internal, double h) {
  size_t n = m->edges.n;
  for (size_t k = 0; k < 3 * n; k++) {
    if (m->edges.pin[k / 3] == HK_PIN_FIXED) continue;
    bool path = m->edges.pin[k / 3] == HK_PIN_PATH;
    v[k] = path ? m->imposed[3 * n + k] : v[k] + h * (external[k] + internal[k]);
    x[k] = path ? m->imposed[k] : x[k] + h * v[k];
  }
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  desbrun *m = self;
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = m->next, *external = m->slope, *dy = m->slope + v, *F = m->force, *a = m->force + v;
  (void)method, (void)out;
  hk_status status = prepare(m, s, h);
  memcpy(X, s->X, s->size * sizeof *X);
  if (status == HK_OK) status = s->accelerations(s, s->t, X, X + v, X + y, external, dy);
  if (status != HK_OK) return status;
  impose_end(m, s, fmin(t_stop, s->t + h), X, h);
  memset(F, 0, v * sizeof *F);
  if (m->correction) hk_body_turns_find(&m->turns, s->model->mass, X, X + v);
  dy[s->size - y - 1] += add_springs(m, X, X + v, h, F);
  status = filter_forces(m, s, F, a);
  if (status != HK_OK) return status;
  dy[s->size - y - 1] += path_power(m, F, a, X + v, h);
  if (m->correction) hk_body_turns_remove(&m->turns, s->model->mass, X, a);
  advance(m, X, X + v, external, a, h);
  for (size_t k = y; k < s->size; k++) X[k] += h * dy[k - y];
  memcpy(s->X, X, s->size * sizeof *X);
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  (void)view;
  hk_element_edges_drop(&((desbrun *)self)->edges);
  return HK_OK;
}

/* Factors are in no checkpoint. */
static void reset(void *self, hk_reason why) {
  if (why == HK_CHECKPOINT) ((desbrun *)self)->h = 0;
}

static const hk_constrained_facet constrained = {.size = sizeof constrained,
                                                 .refused = "its filtered forces know no multipliers"};
static const hk_facet facets[] = {{HK_CONSTRAINED_ID, &constrained}, {0}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_IMPLICIT | HK_NEEDS_SOLVER,
                                         .step = step,
                                         .reset = reset,
                                         .growth = growth,
                                         .facets = facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "desbrun",
    .summary = "predictor of Desbrun: spring forces through the constant filter (I - h^2 H M^-1)^-1, angular momentum "
               "corrected, the rest explicit; order 1",
    .reference = "Desbrun, Schroeder and Barr 1999, Interactive Animation of Structured Deformable Objects, sections 3 "
                 "and 4",
    .instance_size = sizeof(desbrun),
    .params = params,
    .fields = fields,
    .topology = topology,
    .integrator = &integrator,
};
