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
 * its kinetic energy. It acts on each connected body, and on the rotations that the pins allow: with one pin, rotations
 * about that point; with pins on a line, about that axis; with pins that are not on one line, none. A body whose
 * particles lie on a line has no inertia about it: eigenvalues of I below SMALL times the trace count as 0.
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
#include "plugins/kit/integrate/growth_factor.h"

#include "core/plugin.h"

#include <string.h>

#define NOBODY UINT32_MAX
static const double SMALL = 1e-12;    /* relative to the trace of I: a body with a thickness of 1e-6 of its length */
static const double ONE_POINT = 1e-9; /* relative to the body's size: closer pins are one point, or on one line */

typedef struct body {
  double mass, centre[3], drift[3], inertia[6], torque[3], turn[3]; /* inertia: xx, xy, xz, yy, yz, zz; turn: A */
  double radius2, far2; /* m^2, largest squared distance from the centre, of particles and of pins */
  uint32_t pin, far;    /* the first of its pinned particles and the one farthest from it; NOBODY: none */
  bool fixed;           /* its pins are not on one line */
} body;

typedef struct desbrun {
  bool correction;
  double *next, *slope, *imposed, *force, *scratch; /* shaped as X: new state; (a, dy); pins at the end; (F, a) */
  hk_element_edges edges;
  double h;       /* s, the step of the factorized matrix; 0: none */
  double *weight; /* h^2 k, one per spring */
  hk_laplacian laplacian;
  hk_slide_pins slides;
  size_t bodies;
  body *body;
  uint32_t *label; /* n: the particle's body; NOBODY: pinned */
  size_t anchors;
  uint32_t (*anchor)[2]; /* a body and a pinned particle that a spring joins to it */
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

/* ---- bodies ---- */

static uint32_t root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* A body is a set of free particles connected by springs; pinned particles connect nothing. The root of a set is its
 * smallest index, so the loop that numbers the bodies reaches it first. */
static void find_bodies(desbrun *m) {
  const hk_element_edges *e = &m->edges;
  uint32_t *label = m->label;
  m->bodies = m->anchors = 0;
  for (uint32_t i = 0; i < e->n; i++) label[i] = i;
  for (size_t q = 0; q < e->count; q++) {
    uint32_t i = e->pair[q][0], j = e->pair[q][1];
    if (e->pin[i] != HK_FREE || e->pin[j] != HK_FREE) continue;
    i = root(label, i), j = root(label, j);
    label[i > j ? i : j] = i > j ? j : i;
  }
  for (uint32_t i = 0; i < e->n; i++) label[i] = root(label, i);
  for (uint32_t i = 0; i < e->n; i++)
    label[i] = e->pin[i] != HK_FREE ? NOBODY : label[i] == i ? (uint32_t)m->bodies++ : label[label[i]];
  for (size_t q = 0; q < 2 * e->count; q++) {
    uint32_t i = e->pair[q / 2][q % 2], j = e->pair[q / 2][1 - q % 2];
    if (e->pin[i] != HK_FREE || e->pin[j] == HK_FREE) continue;
    m->anchor[m->anchors][0] = label[i];
    m->anchor[m->anchors++][1] = j;
  }
}

static void find_centres(desbrun *m, const double *mass, const double *x, const double *a) {
  for (size_t b = 0; b < m->bodies; b++) m->body[b] = (body){.pin = NOBODY, .far = NOBODY};
  for (size_t k = 0; k < m->anchors; k++) {
    body *b = &m->body[m->anchor[k][0]];
    if (b->pin == NOBODY) b->pin = m->anchor[k][1];
  }
  for (size_t i = 0; i < m->edges.n; i++) {
    if (m->label[i] == NOBODY) continue;
    body *b = &m->body[m->label[i]];
    b->mass += mass[i];
    for (int c = 0; c < 3; c++) {
      b->centre[c] += mass[i] * x[3 * i + c];
      b->drift[c] += mass[i] * a[3 * i + c];
    }
  }
  for (size_t k = 0; k < m->bodies; k++) {
    body *b = &m->body[k];
    for (int c = 0; c < 3; c++) {
      b->centre[c] = b->pin == NOBODY ? b->centre[c] / b->mass : x[3 * b->pin + c];
      b->drift[c] = b->pin == NOBODY ? b->drift[c] / b->mass : a[3 * b->pin + c];
    }
  }
}

static void cross(const double a[3], const double b[3], double into[3]) {
  for (int c = 0; c < 3; c++) into[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void from_centre(const body *b, const double *x, double r[3]) {
  for (int c = 0; c < 3; c++) r[c] = x[c] - b->centre[c];
}

static void find_moments(desbrun *m, const double *mass, const double *x, const double *a) {
  for (size_t i = 0; i < m->edges.n; i++) {
    double r[3], w[3], t[3];
    if (m->label[i] == NOBODY) continue;
    body *b = &m->body[m->label[i]];
    from_centre(b, x + 3 * i, r);
    for (int c = 0; c < 3; c++) w[c] = a[3 * i + c] - b->drift[c];
    cross(r, w, t);
    double r2 = dot(r, r);
    for (int c = 0; c < 3; c++) b->torque[c] += mass[i] * t[c];
    for (int p = 0, k = 0; p < 3; p++)
      for (int q = p; q < 3; q++, k++) b->inertia[k] += mass[i] * ((p == q ? r2 : 0) - r[p] * r[q]);
    if (r2 > b->radius2) b->radius2 = r2;
  }
}

/* Determines for each body whether its pins lie at one point, on a line or neither. */
static void find_pins(desbrun *m, const double *x) {
  double r[3], along[3], off[3];
  for (size_t k = 0; k < m->anchors; k++) {
    body *b = &m->body[m->anchor[k][0]];
    from_centre(b, x + 3 * m->anchor[k][1], r);
    if (dot(r, r) > ONE_POINT * ONE_POINT * b->radius2 && dot(r, r) > b->far2) {
      b->far = m->anchor[k][1];
      b->far2 = dot(r, r);
    }
  }
  for (size_t k = 0; k < m->anchors; k++) {
    body *b = &m->body[m->anchor[k][0]];
    if (b->far == NOBODY) continue;
    from_centre(b, x + 3 * m->anchor[k][1], r);
    from_centre(b, x + 3 * b->far, along);
    cross(along, r, off);
    if (dot(off, off) > ONE_POINT * ONE_POINT * b->far2 * fmax(b->far2, b->radius2)) b->fixed = true;
  }
}

/* Jacobi's rotations: the rows of V become the eigenvectors of the symmetric S, its diagonal the eigenvalues. */
static void diagonalize(double S[3][3], double V[3][3]) {
  for (int sweep = 0; sweep < 12; sweep++)
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) {
        if (S[p][q] == 0) continue;
        double theta = (S[q][q] - S[p][p]) / (2 * S[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; k++) {
          double a = S[k][p], b = S[k][q];
          S[k][p] = c * a - s * b, S[k][q] = s * a + c * b;
        }
        for (int k = 0; k < 3; k++) {
          double a = S[p][k], b = S[q][k], v = V[p][k], w = V[q][k];
          S[p][k] = c * a - s * b, S[q][k] = s * a + c * b;
          V[p][k] = c * v - s * w, V[q][k] = s * v + c * w;
        }
      }
}

/* A = I^-1 torque, about the axes with inertia. */
static void turn_freely(body *b) {
  const double *tensor = b->inertia;
  double S[3][3] = {
      {tensor[0], tensor[1], tensor[2]}, {tensor[1], tensor[3], tensor[4]}, {tensor[2], tensor[4], tensor[5]}};
  double V[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, trace = tensor[0] + tensor[3] + tensor[5];
  diagonalize(S, V);
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3 && S[k][k] > SMALL * trace; c++) b->turn[c] += V[k][c] * dot(V[k], b->torque) / S[k][k];
}

static void turn_about(body *b, const double *x) {
  double e[3], I_e[3];
  const double *tensor = b->inertia;
  from_centre(b, x + 3 * b->far, e);
  for (int c = 0; c < 3; c++) e[c] /= sqrt(b->far2);
  I_e[0] = tensor[0] * e[0] + tensor[1] * e[1] + tensor[2] * e[2];
  I_e[1] = tensor[1] * e[0] + tensor[3] * e[1] + tensor[4] * e[2];
  I_e[2] = tensor[2] * e[0] + tensor[4] * e[1] + tensor[5] * e[2];
  double inertia = dot(e, I_e), trace = tensor[0] + tensor[3] + tensor[5];
  for (int c = 0; c < 3 && inertia > SMALL * trace; c++) b->turn[c] = e[c] * dot(e, b->torque) / inertia;
}

/* The rigid rotation of each body in a field of velocities or accelerations. */
static void find_turns(desbrun *m, const double *mass, const double *x, const double *a) {
  find_centres(m, mass, x, a);
  find_moments(m, mass, x, a);
  find_pins(m, x);
  for (size_t k = 0; k < m->bodies; k++) {
    body *b = &m->body[k];
    if (b->far == NOBODY)
      turn_freely(b);
    else if (!b->fixed)
      turn_about(b, x);
  }
}

static void correct(desbrun *m, const double *mass, const double *x, double *a) {
  find_turns(m, mass, x, a);
  for (size_t i = 0; i < m->edges.n; i++) {
    double r[3], t[3];
    if (m->label[i] == NOBODY) continue;
    from_centre(&m->body[m->label[i]], x + 3 * i, r);
    cross(m->body[m->label[i]].turn, r, t);
    for (int c = 0; c < 3; c++) a[3 * i + c] -= t[c];
  }
}

/* ---- the step ---- */

static hk_status reserve(desbrun *m, const hk_host *host) {
  size_t n = m->edges.n, springs = m->edges.capacity;
  host->release(host, m->weight);
  host->release(host, m->body);
  host->release(host, m->label);
  host->release(host, m->anchor);
  m->weight = host->allocate(host, (springs + 1) * sizeof *m->weight);
  m->body = host->allocate(host, (n + 1) * sizeof *m->body);
  m->label = host->allocate(host, (n + 1) * sizeof *m->label);
  m->anchor = host->allocate(host, (springs + 1) * sizeof *m->anchor);
  bool fine = m->weight && m->body && m->label && m->anchor;
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu springs and %zu particles", springs, n);
}

static hk_status arrange(desbrun *m, hk_system *s, bool fresh) {
  hk_status status = fresh ? reserve(m, s->host) : HK_OK;
  if (status == HK_OK) status = hk_slide_pins_build(&m->slides, s->host, &m->edges);
  if (status == HK_OK)
    status = hk_laplacian_build(&m->laplacian, s->host, s->n, m->edges.count, (const uint32_t(*)[2])m->edges.pair);
  if (status == HK_OK) find_bodies(m);
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
    double l = sqrt(dot(d, d)), along = l > 0 ? dot(d, u) / l : 0;
    double f = l > 0 ? (k * (l - e->rest[q]) + c * along) / l : 0;
    power -= c * along * along;
    if (m->correction) {
      uint32_t b = m->label[i / 3] == NOBODY ? m->label[j / 3] : m->label[i / 3];
      cross(b == NOBODY ? (const double[3]){0} : m->body[b].turn, d, t);
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
    if (e->pin[i] == HK_PIN_PATH) power -= h * h * e->stiffness[q / 2] * dot(a + 3 * j, v + 3 * i);
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
  if (m->correction) find_turns(m, s->model->mass, X, X + v);
  dy[s->size - y - 1] += add_springs(m, X, X + v, h, F);
  status = filter_forces(m, s, F, a);
  if (status != HK_OK) return status;
  dy[s->size - y - 1] += path_power(m, F, a, X + v, h);
  if (m->correction) correct(m, s->model->mass, X, a);
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
