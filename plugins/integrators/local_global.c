/* Backward Euler by local and global iterations. A step minimises
 *     g(x) = 1/2 (x - y)^T M (x - y) + h^2 E(x),      y = x_n + h v_n + h^2 M^-1 f_explicit,      v = (x - x_n)/h,
 * E the energy of the springs. The local step finds, for every spring, the vector of its rest length that is closest to
 * the spring. The global step minimises the remaining quadratic function, whose matrix A = M + h^2 L is n x n and
 * constant: one factorization, three right-hand sides. Both together are written as a correction, x <- x + A^-1 r,
 * r = -dg/dx = M (y - x) + h^2 f(x): the iterates are the same, but rounding is relative to the correction, and r
 * contains the springs' force itself. For the same reason the unknown is the displacement d = x - x_n: v = d/h loses no
 * digits at small steps. g decreases in every iteration, since the quadratic function lies above g and touches it at x.
 *
 * Elements with an `evaluate` (triangles, tetrahedra) have no such local step. Their forces in r are exact; in A they
 * are represented by a weight for the members of each tuple, computed at the start of the run or of a topology
 * (element_energy.c). The iteration is then a quasi-Newton method whose fixed point is backward Euler. The quadratic
 * function need not lie above g: if a correction would raise g, it is halved until it does not. If that happens because
 * gradients have become steeper than when the weights were computed, the weights of those tuples are computed again.
 *
 * Damping along a spring acts in the direction that it had at the start of the step: with n = d(x_n)/|d(x_n)| and the
 * velocities (x - x_n)/h its force is -(c/h) (n.delta) n, delta the change of d in the step. This is the gradient of a
 * quadratic function, h c |delta|^2/2 lies above it, and A = M + h^2 L_k + h L_c stays constant. Forces without
 * elements (gravity, drag, wind) are explicit, evaluated at the start of the step; where one depends on the velocity so
 * strongly that this would be unstable (h g > 2), the step is refused. A force that acts between particles but
 * describes no elements is refused with an error that names it. Particles that slide are kept on their lines and planes
 * exactly (slide_pins.h). Channels and the work of explicit forces follow Euler's rule; the work of dampers and paths
 * is that of the new state.
 *
 * Invariant: `h` is the step of the factorized matrix in the solver, 0 if there is none. The matrix is made again only
 * when h, the springs or the pins change.
 * Liu, Bouaziz and Kavan, Quasi-Newton methods for real-time simulation of hyperelastic materials, ACM TOG 36 (2017);
 * Liu, Bargteil, O'Brien and Kavan, Fast simulation of mass-spring systems, ACM TOG 32 (2013); acceleration: Peng and
 * others, Anderson acceleration for geometry optimization and physics simulation, ACM TOG 37 (2018).
 *
 * For a fixed price a step, whatever happens: one factorization for the whole run. For a given error others are
 * cheaper: cloth of 8 x 8 particles, k = 1e6 N/m, to 1e-2 m takes it 1,152 evaluations and 46 ms, backward_euler 138
 * and 12 ms (the command is there).
 */
#include "plugins/common/linear/anderson.h"
#include "plugins/common/elements/element_energy.h"
#include "plugins/common/springs/element_edges.h"
#include "plugins/common/springs/layout_forces.h"
#include "plugins/common/linear/laplacian.h"
#include "plugins/common/integrate/slide_pins.h"
#include "plugins/common/integrate/step_control.h"

#include <float.h>
#include <string.h>

enum { PLAIN, ANDERSON };

static const double at_rest = 1e-3; /* relative to the extent: smallest displacement that changes are compared with */
/* The relative change that causes a warning: an iteration reduces errors of cloth by a factor of about 0.99, so a
 * change of 1e-3 leaves an error of some 10 %. */
static const double telling = 1e-3;

typedef struct local_global {
  int64_t iterations, window;
  int acceleration;
  double tolerance;

  const hk_host *host;
  hk_element_edges edges;
  hk_laplacian laplacian;
  hk_slide_pins slides;
  hk_spring_layout springs, dampers; /* springs without damping; dampers without stiffness */
  hk_element_energy elements;        /* the elements that are not springs */
  double *weight, *diagonal;         /* off-diagonal: edges, then pairs of the elements' members; diagonal: n */
  double h;
  hk_anderson anderson;

  int64_t warned;
  double change;      /* change in the last iteration, relative to the step's displacement */
  double *d, *y;      /* n x 3, m: displacements in this step, of x and without internal forces */
  double *from;       /* n x 3, m: d before the last correction; with elements only */
  bool soft;          /* whether a correction was reduced to a quarter or less */
  bool weighed;       /* whether weights of the elements were computed in this run */
  hk_array steepness; /* double: of the elements, for runs resumed from a checkpoint */
  double *F, *r, *dx, *scratch;
  double *next, *slope; /* shaped as X: the new state; (a, dy) */
} local_global;

static const hk_param params[] = {
    {"iterations", "", "local and global iterations a step", .integer = HK_AT(local_global, iterations),
     .initial = {10}, .limits = HK_WITHIN(1, 1e6)},
    {"tolerance", "",
     "stops when an iteration moves positions by less than this part of what the step does; not "
     "reached, the step is halved. 0: all iterations, whatever they leave",
     .number = HK_AT(local_global, tolerance), .limits = HK_WITHIN(0, 1)},
    {"acceleration", "", "of the iteration", .choice = HK_AT(local_global, acceleration), .initial = {PLAIN},
     .choices = "none|anderson"},
    {"window", "", "iterations that anderson looks back", .integer = HK_AT(local_global, window), .initial = {5},
     .limits = HK_WITHIN(1, HK_ANDERSON_MOST)},
    {0},
};

static const hk_field fields[] = {
    {"warned", .integer = HK_AT(local_global, warned)},
    {"steepness", .array = HK_AT(local_global, steepness), .width = sizeof(double)},
    {"change", .number = HK_AT(local_global, change)},
    {"displacement", .per_particle = HK_AT(local_global, d), .width = 3, .flags = HK_SCRATCH},
    {"from", .per_particle = HK_AT(local_global, from), .width = 3, .flags = HK_SCRATCH},
    {"inertia", .per_particle = HK_AT(local_global, y), .width = 3, .flags = HK_SCRATCH},
    {"force", .per_particle = HK_AT(local_global, F), .width = 3, .flags = HK_SCRATCH},
    {"gradient", .per_particle = HK_AT(local_global, r), .width = 3, .flags = HK_SCRATCH},
    {"correction", .per_particle = HK_AT(local_global, dx), .width = 3, .flags = HK_SCRATCH},
    {"scratch", .per_particle = HK_AT(local_global, scratch), .width = 3, .flags = HK_SCRATCH},
    {"next", .state = HK_AT(local_global, next), .width = 1, .flags = HK_SCRATCH},
    {"slope", .state = HK_AT(local_global, slope), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* The largest modulus of the roots of (1 + z^2 + hg) lambda^2 - (2 + hg) lambda + 1, z = hw, for the damping of
 * springs. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  double z = 2 * hw, leading = 1 + hw * hw + hg;
  if (hb != 0) return NAN;
  if (hg < z) return 1 / sqrt(leading);
  return fmin(1, (2 + hg + sqrt((hg - z) * (hg + z))) / (2 * leading));
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  local_global *m = self;
  (void)view;
  m->host = host;
  return HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  local_global *m = self;
  (void)view;
  hk_element_edges_drop(&m->edges);
  return HK_OK;
}

/* ---- The matrix ---- */

static hk_status lay_out(local_global *m, const hk_host *host, const hk_partition *partition) {
  const hk_tuples edges = {m->edges.count, 2, m->edges.count ? &m->edges.pair[0][0] : NULL};
  double zero = 0;
  const hk_per_tuple none = {1, &zero}, k = {edges.count, m->edges.stiffness}, c = {edges.count, m->edges.damping},
                     rest = {edges.count, m->edges.rest};
  hk_spring_layout_free(&m->springs, host);
  hk_spring_layout_free(&m->dampers, host);
  if (edges.count == 0) return HK_OK;
  hk_status status = hk_spring_layout_build(&m->springs, host, partition, &edges, &k, &none, &rest, NULL);
  double damping = 0;
  for (size_t e = 0; e < edges.count; e++) damping = fmax(damping, m->edges.damping[e]);
  if (status != HK_OK || damping == 0) return status;
  return hk_spring_layout_build(&m->dampers, host, partition, &edges, &none, &c, &none, NULL);
}

/* The pairs of the matrix: springs, then the pairs of the elements' members. */
static hk_status build_matrix(local_global *m, size_t n) {
  const hk_host *host = m->host;
  size_t edges = m->edges.count, pairs = edges + m->elements.pairs;
  uint32_t(*pair)[2] = host->allocate(host, (pairs + 1) * sizeof *pair);
  host->release(host, m->weight);
  host->release(host, m->diagonal);
  m->weight = host->allocate(host, (pairs + 1) * sizeof *m->weight);
  m->diagonal = host->allocate(host, (n + 1) * sizeof *m->diagonal);
  if (!pair || !m->weight || !m->diagonal) {
    host->release(host, pair);
    return host->fail(host, HK_NO_MEMORY, "no memory for the weights of %zu springs", pairs);
  }
  memcpy(pair, m->edges.pair, edges * sizeof *pair);
  hk_element_energy_pairs(&m->elements, pair + edges);
  hk_status status = hk_laplacian_build(&m->laplacian, host, n, pairs, (const uint32_t(*)[2])pair);
  host->release(host, pair);
  return status;
}

static void keep_weights(local_global *m) {
  if (m->steepness.count > 0) memcpy(m->steepness.item, m->elements.steepness, m->steepness.count * sizeof(double));
}

/* Computes the elements' weights at X; at the first step after a checkpoint those of the checkpoint are used. */
static hk_status weigh_elements(local_global *m, hk_system *s, bool fresh) {
  hk_status status = hk_element_energy_take(&m->elements, m->host, s->model, s->X, fresh);
  size_t count = m->elements.tuples.count;
  bool resumed = !m->weighed && count > 0 && m->steepness.count == count;
  m->weighed = true;
  if (status == HK_OK && resumed) memcpy(m->elements.steepness, m->steepness.item, count * sizeof(double));
  if (status != HK_OK || resumed) return status;
  if (m->steepness.count != count) status = m->host->resize(m->host, &m->steepness, count);
  if (status == HK_OK) keep_weights(m);
  return status;
}

static hk_status rebuild(local_global *m, hk_system *s, bool fresh) {
  hk_status status = hk_slide_pins_build(&m->slides, m->host, &m->edges);
  if (status == HK_OK) status = weigh_elements(m, s, fresh);
  if (status == HK_OK) status = build_matrix(m, s->n);
  if (status == HK_OK) status = lay_out(m, m->host, s->model->partition);
  if (status == HK_OK && m->acceleration == ANDERSON)
    status = hk_anderson_reserve(&m->anderson, m->host, 3 * s->n, (size_t)m->window);
  return status;
}

static hk_status make_matrix(local_global *m, hk_system *s, double h) {
  size_t edges = m->edges.count;
  for (size_t e = 0; e < edges; e++) m->weight[e] = h * (h * m->edges.stiffness[e] + m->edges.damping[e]);
  memcpy(m->diagonal, s->model->mass, s->n * sizeof *m->diagonal);
  hk_element_energy_weights(&m->elements, h, m->weight + edges, m->diagonal);
  hk_laplacian_fill(&m->laplacian, m->diagonal, s->model->inverse_mass, m->weight);
  m->h = 0;
  hk_status status = s->linear->factorize(s, &m->laplacian.matrix);
  if (status == HK_OK) status = hk_slide_pins_factorize(&m->slides, s, m->r, m->dx);
  if (status == HK_OK) m->h = h;
  return status;
}

static hk_status prepare(local_global *m, hk_system *s, double h) {
  bool fresh = !m->edges.valid, changed;
  hk_status status = hk_element_edges_take(&m->edges, s, m->scratch, &changed);
  if (status != HK_OK) return status;
  if (changed) {
    m->h = 0;
    status = rebuild(m, s, fresh);
    if (status != HK_OK) hk_element_edges_drop(&m->edges); /* the next attempt builds everything again */
  }
  return status != HK_OK || h == m->h ? status : make_matrix(m, s, h);
}

/* ---- The explicit part ---- */

/* Estimates the rate g at which explicit accelerations change with the velocity, in the direction of the acceleration,
 * and refuses the step for h g > 2, where explicit steps on v' = -g v are unstable. */
static hk_status check_rate(local_global *m, hk_system *s, double h) {
  bool depends = false;
  for (size_t k = 0; k < s->split->forces; k++)
    depends |= s->split->takes[k] && s->split->force[k].flags & HK_DEPENDS_ON_V;
  if (!depends) return HK_OK;
  size_t n = 3 * s->n;
  double *x = m->next, *v = m->next + n, *a = m->slope, *other = m->F, whole = 0, part = 0;
  memcpy(x, s->X, 2 * n * sizeof *x);
  for (size_t e = 0; e < n; e++) v[e] += h * a[e];
  hk_status status = s->accelerations(s, s->t, x, v, s->X + 2 * n, other, m->next + 2 * n);
  for (size_t e = 0; e < n && status == HK_OK; e++) {
    whole += a[e] * a[e];
    part += (other[e] - a[e]) * (other[e] - a[e]);
  }
  if (status != HK_OK || !(part > 4 * whole)) return status;
  return m->host->fail(m->host, HK_NOT_CONVERGED,
                       "forces that depend on the velocity and are taken explicitly change by %.3g times themselves in "
                       "a step of %g s, more than 2: take a shorter step, or an integrator that solves for them",
                       sqrt(part / whole), h);
}

/* Computes the new x and evaluates the elements there. */
static void place(local_global *m, const hk_system *s) {
  for (size_t e = 0; e < 3 * s->n; e++) m->next[e] = s->X[e] + m->d[e];
  hk_element_energy_evaluate(&m->elements, m->host, m->next);
}

static hk_status predict(local_global *m, hk_system *s, double h, double t_next) {
  size_t n = 3 * s->n;
  const double *x = s->X, *v = s->X + n, *a = m->slope;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + n, s->X + 2 * n, m->slope, m->slope + n);
  if (status == HK_OK) status = check_rate(m, s, h);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < s->n; i++) {
    bool moves = s->model->inverse_mass[i] > 0;
    for (size_t e = 3 * i; e < 3 * i + 3; e++) m->d[e] = moves ? h * (v[e] + h * a[e]) : 0;
  }
  place(m, s);
  memcpy(m->next + n, v, n * sizeof *v);
  s->impose(s, t_next, m->next, m->next + n);
  for (size_t i = 0; i < s->n && m->edges.paths > 0; i++)
    for (size_t e = 3 * i; m->edges.pin[i] == HK_PIN_PATH && e < 3 * i + 3; e++) m->d[e] = m->next[e] - x[e];
  memcpy(m->y, m->d, n * sizeof *m->y);
  return HK_OK;
}

/* ---- The iteration ---- */

/* F = forces of springs, elements and dampers at the new x; *power += the power of damping, unless NULL. */
static void forces(local_global *m, const hk_system *s, double h, double *power) {
  const double *x = m->next;
  memset(m->F, 0, 3 * s->n * sizeof *m->F);
  hk_layout_forces(&m->springs, m->host, x, x, m->F, NULL);
  hk_element_energy_forces(&m->elements, m->d, h, m->F, power);
  if (!m->dampers.damped) return;
  for (size_t e = 0; e < 3 * s->n; e++) m->scratch[e] = m->d[e] / h;
  hk_layout_forces(&m->dampers, m->host, s->X, m->scratch, m->F, power);
}

static void residual(local_global *m, const hk_system *s, double h) {
  const double *restrict d = m->d, *restrict y = m->y, *restrict F = m->F;
  double *restrict r = m->r;
  for (size_t i = 0; i < s->n; i++) {
    bool moves = s->model->inverse_mass[i] > 0;
    double mass = moves ? s->model->mass[i] : 0, hh = moves ? h * h : 0;
    for (size_t e = 3 * i; e < 3 * i + 3; e++) r[e] = mass * (y[e] - d[e]) + hh * F[e];
  }
}

/* The rounding error of g: that of a sum of 3n squares, and that of x, with the sensitivity `slope` of g to x. */
static double noise_of(const local_global *m, size_t n, double g, double slope) {
  double far = 0;
  for (size_t e = 0; e < 3 * n; e++) far = fmax(far, fabs(m->next[e]));
  return DBL_EPSILON * ((16 + sqrt(3 * (double)n)) * g + slope * far);
}

/* g at the new x; *noise: with elements its rounding error, else 0. */
static double objective(const local_global *m, const hk_system *s, double h, double *noise) {
  const double *x = m->next;
  double inertia = 0, springs = 0, dampers = 0, pull = 0;
  *noise = 0;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = 3 * i; s->model->inverse_mass[i] > 0 && e < 3 * i + 3; e++)
      inertia += s->model->mass[i] * (m->d[e] - m->y[e]) * (m->d[e] - m->y[e]);
  for (size_t e = 0; e < m->edges.count; e++) {
    size_t i = 3 * (size_t)m->edges.pair[e][0], j = 3 * (size_t)m->edges.pair[e][1];
    double l2 = 0, l02 = 0, along = 0;
    for (size_t c = 0; c < 3; c++) {
      double d = x[j + c] - x[i + c], d0 = s->X[j + c] - s->X[i + c];
      l2 += d * d;
      l02 += d0 * d0;
      along += d0 * (d - d0);
    }
    double stretch = sqrt(l2) - m->edges.rest[e];
    springs += m->edges.stiffness[e] * stretch * stretch;
    pull += m->edges.stiffness[e] * fabs(stretch);
    if (l02 > 0) dampers += m->edges.damping[e] * along * along / l02;
  }
  double g = inertia / 2 + h * (h * springs + dampers) / 2;
  if (m->elements.tuples.count == 0) return g;
  double slope = 2 * h * h * pull;
  g += hk_element_energy_value(&m->elements, m->d, h, &slope);
  *noise = noise_of(m, s->n, g, slope);
  return g;
}

static void accelerate(local_global *m, size_t n) {
  double *G = m->scratch;
  for (size_t e = 0; e < n; e++) G[e] = m->d[e] + m->dx[e];
  hk_anderson_next(&m->anderson, m->dx, G, m->r, m->d);
}

/* Moves to `from` + part dx; returns g there. */
static double try_part(local_global *m, const hk_system *s, double h, double part, double *noise) {
  for (size_t e = 0; e < 3 * s->n; e++) m->d[e] = m->from[e] + part * m->dx[e];
  place(m, s);
  return objective(m, s, h, noise);
}

/* With elements an unaccelerated correction may raise g as well. It is halved until g does not rise by more than its
 * rounding error, which is reached because dx is a direction of descent. */
static double shorten(local_global *m, const hk_system *s, double h, double g, double now, double *noise) {
  const double shortest = 0x1p-30;
  double kept = *noise;
  for (double part = 0.5; !(now <= g + kept + *noise); part /= 2) {
    now = try_part(m, s, h, part >= shortest ? part : 0, noise);
    m->soft |= part < 0.5;
    if (part < shortest) break;
  }
  return now;
}

/* If g rose, the accelerated x is replaced by the unaccelerated one, which cannot raise g without elements, and the
 * acceleration starts again. */
static void safeguard(local_global *m, const hk_system *s, double h, double *g) {
  bool elements = m->elements.tuples.count > 0;
  double noise, now = objective(m, s, h, &noise);
  if (m->acceleration == ANDERSON && now > *g + noise) {
    memcpy(m->d, m->anderson.g_last, 3 * s->n * sizeof *m->d);
    place(m, s);
    hk_anderson_clear(&m->anderson);
    now = objective(m, s, h, &noise);
  }
  *g = elements && *g < INFINITY ? shorten(m, s, h, *g, now, &noise) : now;
}

static void move(local_global *m, size_t n) {
  double *restrict d = m->d;
  const double *restrict dx = m->dx;
  for (size_t e = 0; e < n; e++) d[e] += dx[e];
}

/* |dx| relative to the step's displacement |x - x_n|, both weighted by masses; near rest relative to a thousandth of
 * the scene's size. */
static double relative_change(const local_global *m, const hk_system *s, double extent) {
  double change = 0, moved = 0, mass = 0;
  for (size_t i = 0; i < s->n; i++) {
    double a = 0, b = 0;
    for (size_t e = 3 * i; e < 3 * i + 3; e++) {
      a += m->dx[e] * m->dx[e];
      b += m->d[e] * m->d[e];
    }
    change += s->model->mass[i] * a;
    moved += s->model->mass[i] * b;
    mass += 3 * s->model->mass[i];
  }
  double scale = fmax(moved, mass * at_rest * at_rest * extent * extent);
  return scale > 0 ? sqrt(change / scale) : 0;
}

static hk_status correction(local_global *m, hk_system *s, double h) {
  forces(m, s, h, NULL);
  residual(m, s, h);
  hk_status status = s->linear->solve_columns(s, m->r, m->dx, 3);
  return status == HK_OK ? hk_slide_pins_correct(&m->slides, s, m->dx, m->F, m->scratch) : status;
}

static hk_status stiffen(local_global *m, hk_system *s, double h) {
  m->soft = false;
  if (!hk_element_energy_raise(&m->elements)) return HK_OK;
  keep_weights(m);
  hk_anderson_clear(&m->anderson);
  return make_matrix(m, s, h);
}

/* With elements, the iteration starts where g is smaller: at the position without internal forces, or at that of the
 * start of the step. g of the new x is then at most g of the old one, so that no step adds energy. */
static void choose_start(local_global *m, const hk_system *s, double h) {
  double noise, flight;
  place(m, s);
  flight = objective(m, s, h, &noise);
  for (size_t e = 0; e < 3 * s->n; e++)
    if (m->edges.pin[e / 3] != HK_PIN_PATH) m->d[e] = 0;
  place(m, s);
  if (objective(m, s, h, &noise) < flight) return;
  memcpy(m->d, m->y, 3 * s->n * sizeof *m->d);
}

static hk_status iterate(local_global *m, hk_system *s, double h) {
  size_t n = 3 * s->n;
  double g = INFINITY, extent = hk_scales_extent(&(hk_scales){0}, s, s->X);
  bool elements = m->elements.tuples.count > 0, guarded = elements || m->acceleration == ANDERSON;
  hk_anderson_clear(&m->anderson);
  if (elements) choose_start(m, s, h);
  for (int64_t k = 0; k < m->iterations; k++) {
    place(m, s);
    if (guarded) safeguard(m, s, h, &g);
    hk_status status = m->soft ? stiffen(m, s, h) : HK_OK;
    if (status == HK_OK) status = correction(m, s, h);
    if (status != HK_OK) return status;
    m->change = relative_change(m, s, extent);
    if (elements) memcpy(m->from, m->d, n * sizeof *m->from);
    if (m->acceleration == ANDERSON && k + 1 < m->iterations && !(m->change <= m->tolerance))
      accelerate(m, n);
    else
      move(m, n);
    if (m->change <= m->tolerance) break;
  }
  if (!elements) return HK_OK;
  place(m, s);
  hk_anderson_clear(&m->anderson); /* the last correction was not accelerated */
  double noise, now = objective(m, s, h, &noise);
  shorten(m, s, h, g, now, &noise);
  return HK_OK;
}

/* With a fixed number of iterations there is no test of convergence: warns once when the result is far from backward
 * Euler. */
static void warn_once(local_global *m) {
  if (m->warned || m->change <= telling) return;
  m->warned = 1;
  m->host->warn(
      m->host,
      "the last of %lld iterations still changes positions by %.2g of what the step moves: more iterations, a "
      "tolerance or acceleration = \"anderson\" bring the step nearer to backward Euler",
      (long long)m->iterations, m->change);
}

static hk_status check_convergence(local_global *m, hk_step *out) {
  if (m->tolerance == 0) {
    warn_once(m);
    return HK_OK;
  }
  out->error = m->change / m->tolerance;
  if (m->change <= m->tolerance) return HK_OK;
  return m->host->fail(
      m->host, HK_NOT_CONVERGED,
      "%lld iterations leave a relative change of %.3g, above the tolerance %g: allow more iterations, "
      "take acceleration = \"anderson\", or a shorter step",
      (long long)m->iterations, m->change, m->tolerance);
}

/* ---- The step ---- */

/* The work that path pins do against springs, dampers and elements, J; their work against explicit forces is in the
 * power. */
static double work_of_paths(const local_global *m, const hk_system *s) {
  double work = 0;
  for (size_t i = 0; m->edges.paths > 0 && i < s->n; i++)
    for (size_t e = 3 * i; m->edges.pin[i] == HK_PIN_PATH && e < 3 * i + 3; e++) work -= m->F[e] * m->d[e];
  return work;
}

static void finish(local_global *m, hk_system *s, double h, double t_next) {
  size_t n = 3 * s->n;
  double power = 0, *v = m->next + n;
  place(m, s);
  if (m->dampers.damped || m->elements.damped || m->edges.paths > 0) forces(m, s, h, &power);
  for (size_t e = 0; e < n; e++) v[e] = m->d[e] / h;
  double work = h * power + work_of_paths(m, s);
  s->impose(s, t_next, m->next, v);
  for (size_t e = 2 * n; e < s->size; e++) s->X[e] += h * m->slope[e - n];
  s->X[s->size - 1] += work;
  memcpy(s->X, m->next, 2 * n * sizeof *v);
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  local_global *m = self;
  double t_next = fmin(t_stop, s->t + h);
  (void)method;
  hk_status status = prepare(m, s, h);
  if (status == HK_OK) hk_element_energy_start(&m->elements, m->host, s->X);
  if (status == HK_OK) status = predict(m, s, h, t_next);
  if (status == HK_OK) status = iterate(m, s, h);
  if (status == HK_OK) status = check_convergence(m, out);
  if (status == HK_OK) finish(m, s, h, t_next);
  return status;
}

/* Factors are in no checkpoint. */
static void reset(void *self, hk_reason why) {
  if (why == HK_CHECKPOINT) ((local_global *)self)->h = 0;
}

static const hk_constrained_facet constrained = {.size = sizeof constrained,
                                                 .refused = "its constant matrix has no multipliers"};
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
    .name = "local_global",
    .summary = "backward Euler by local and global iterations, (M + h^2 L) dx = M (y - x) + h^2 f(x), with one "
               "prefactored n x n matrix; order 1",
    .reference =
        "Liu, Bargteil, O'Brien and Kavan 2013, ACM TOG 32, section 4; Liu, Bouaziz and Kavan 2017, ACM TOG 36; "
        "Peng and others 2018, algorithm 1",
    .instance_size = sizeof(local_global),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .integrator = &integrator,
};
