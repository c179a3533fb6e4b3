/* Baraff and Witkin's step: backward Euler with one linearisation and altered positions,
 *     (M + h D + h^2 K) dv = h (F(x, v) - K (h v + y)),   v' = v + dv,   x' = x + h v' + y.
 * y is what a position changes beside its velocity: that of particles on a path which is not straight, by which their
 * neighbours' forces then know where they will be. The equations are solved by the scene's solver, which keeps momentum
 * to rounding where it is a direct one, or, with `solve`, by the paper's filtered conjugate gradients, in which
 * velocities that pins prescribe or confine stay so to the last bit (plugins/common/linear/filtered_gradients.c); by
 * the former also where constraints act or blocks are not symmetric.
 *
 * The control of the step is theirs, too: a step that changes the strain of any spring or triangle by more than
 * `stretch`, or that passes through a contact, is discarded and repeated with half the length; after `patience`
 * accepted steps the length is doubled, up to a frame or `dt`. The matrix may be indefinite where springs are
 * compressed; the step is then repeated with semi-definite blocks. Constraint forces are those of the start of the step
 * plus those that keep dv consistent with the constraints. Channels are explicit. Baraff and Witkin 1998, equations
 * (6), (16) and (18), sections 5 and 6.
 *
 * Beside backward_euler it solves once a step: cloth of 8 x 8 particles takes it 38 evaluations, backward_euler 138
 * (the command is there). linear_bdf2, of order 2, takes 51 for a sixth of the error.
 */
#include "core/plugin.h"
#include "plugins/kit/integrate/growth_factor.h"
#include "plugins/common/implicit/safe_move.h"
#include "plugins/common/linear/block_product.h"
#include "plugins/common/linear/filtered_gradients.h"

#include <float.h>
#include <string.h>

typedef struct baraff_witkin {
  double stretch;
  int64_t patience;
  int solve;
  double tolerance;
  double length; /* s, length of the next step */
  int64_t good;  /* accepted steps since `length` changed */
  double *memory;
} baraff_witkin;

enum { STATES = 8, FILTERED = 1 };

static const hk_param params[] = {
    {"stretch", "", "largest change in a step of the strain of a spring, (l - L)/L, or of a triangle",
     .number = HK_AT(baraff_witkin, stretch), .initial = {0.1}, .limits = HK_ABOVE(0)},
    {"patience", "", "steps that must go well before a longer one is tried", .integer = HK_AT(baraff_witkin, patience),
     .initial = {4}, .limits = HK_WITHIN(1, 1000000)},
    {"solve", "", "by the scene's solver, or by the paper's filtered conjugate gradients",
     .choice = HK_AT(baraff_witkin, solve), .choices = "solver|filtered"},
    {"tolerance", "", "residual of the filtered gradients that will do, relative to the right-hand side",
     .number = HK_AT(baraff_witkin, tolerance), .initial = {1e-9}, .limits = HK_ABOVE_TO(0, 1)},
    {0},
};

static const hk_field fields[] = {
    {"length", .number = HK_AT(baraff_witkin, length)},
    {"good", .integer = HK_AT(baraff_witkin, good)},
    {"memory", .state = HK_AT(baraff_witkin, memory), .width = STATES, .flags = HK_SCRATCH},
    {0},
};

/* For a linear equation one linearisation is exact, so the roots are those of backward Euler; with u = lambda - 1,
 * (1 + h g + (h w)^2) u^2 + (h g + 2 (h w)^2) u + (h w)^2 = 0. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  const double z = hw * hw, c[] = {z, hg + 2 * z, 1 + hg + z};
  return hb == 0 ? hk_polynomial_growth(2, c) : NAN;
}

static double length_of(const double *x, const uint32_t pair[2]) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) {
    double d = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
    sum += d * d;
  }
  return sqrt(sum);
}

/* The largest change of strain from x to x_new of element e, whose numbers C are strains times `rest`. */
static double change_of(const hk_elements *list, size_t e, double rest, const double *x, const double *x_new) {
  if (hk_elements_are_edges(list))
    return fabs(length_of(x_new, hk_tuple(&list->node, e)) - length_of(x, hk_tuple(&list->node, e))) / rest;
  double C[2][HK_ELEMENT_VALUES], dC[4 * HK_ELEMENT_VALUES][3], largest = 0;
  list->evaluate(list->self, x, e, e + 1, C[0], dC);
  list->evaluate(list->self, x_new, e, e + 1, C[1], dC);
  for (unsigned v = 0; v < list->values; v++) {
    double change = fabs(C[1][v] - C[0][v]) / rest;
    if (!(change <= largest)) largest = change;
  }
  return largest;
}

/* The same among all springs, and triangles that have a rest value. */
static double stretched(const hk_model *model, const double *x, const double *x_new) {
  double largest = 0;
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    bool has = model->element_list[k].acts && (hk_elements_are_edges(list) || list->node.arity == 3);
    for (size_t e = 0; e < list->node.count && has && list->rest.count; e++) {
      double rest = hk_tuple_value(&list->rest, e), change = rest > 0 ? change_of(list, e, rest, x, x_new) : 0;
      if (!(change <= largest)) largest = change;
    }
  }
  return largest;
}

/* Vectors of n x 3 but for X and a: state; slopes; right-hand side and solution; prescribed changes z; positions y; a
 * product; room. */
typedef struct trial {
  double *X, *a, *b, *dv, *z, *y, *q, *work;
} trial;

/* b = h F - K (h^2 v + h y) */
static void right_hand_side(const hk_system *s, const hk_matrix *K, double h, trial *w) {
  size_t m = 3 * s->n;
  const double *v = s->X + m;
  for (size_t e = 0; e < m; e++) w->dv[e] = h * (h * v[e] + w->y[e]);
  hk_block_product(s->host, K, w->dv, w->q);
  for (size_t e = 0; e < m; e++) w->b[e] = h * s->model->mass[e / 3] * w->a[e] - w->q[e];
}

/* What is prescribed: velocities z, and positions y beside them. */
static void prescribe(hk_system *s, double h, trial *w) {
  size_t m = 3 * s->n;
  const double *x = s->X, *v = s->X + m;
  memcpy(w->X, s->X, s->size * sizeof *w->X);
  s->impose(s, s->t + h, w->X, w->X + m);
  for (size_t e = 0; e < m; e++) {
    bool given = !(s->model->inverse_mass[e / 3] > 0);
    w->z[e] = given ? w->X[m + e] - v[e] : 0;
    w->y[e] = given ? w->X[e] - x[e] - h * w->X[m + e] : 0;
  }
}

static void filter(void *context, double *vector) {
  hk_system *s = context;
  s->filter(s, vector);
}

static hk_status solve_filtered(const baraff_witkin *m, hk_system *s, double h, const hk_matrix *K, const hk_matrix *D,
                                trial *w) {
  const hk_filtered_equations equations = {s->host, K, D, s->model->mass, h, w->b, filter, s};
  const double *residual;
  int iterations;
  memcpy(w->dv, w->z, 3 * s->n * sizeof *w->dv);
  return hk_filtered_gradients(&equations, w->dv, m->tolerance, w->work, &residual, &iterations);
}

/* dv = z + u, A u = b - A z. With constraints, u satisfies J u = h J a, where a includes the constraint forces. */
static hk_status solve_by_solver(hk_system *s, double h, const hk_matrix *K, const hk_matrix *D, trial *w) {
  size_t m = 3 * s->n;
  hk_matrix A;
  hk_block_product(s->host, K, w->z, w->q);
  for (size_t e = 0; e < m; e++) w->b[e] -= h * h * w->q[e];
  hk_block_product(s->host, D, w->z, w->q);
  for (size_t e = 0; e < m; e++) w->b[e] -= h * w->q[e];
  s->filter(s, w->b);
  for (size_t e = 0; e < m; e++) w->q[e] = h * w->a[e];
  hk_status status = s->linear->combine(s, 1, h, h * h, &A);
  if (status == HK_OK) status = s->linear->factorize(s, &A);
  if (status == HK_OK)
    status = hk_system_equations(s) ? s->linear->solve_along(s, w->b, w->q, w->dv, NULL)
                                    : s->linear->solve(s, w->b, w->dv, NULL);
  if (status != HK_OK) return status;
  s->filter(s, w->dv);
  for (size_t e = 0; e < m; e++) w->dv[e] += w->z[e];
  return HK_OK;
}

/* The state after a step, of the velocities' change dv. */
static void advance(hk_system *s, double h, trial *w) {
  size_t m = 3 * s->n;
  for (size_t e = 0; e < m; e++) {
    w->X[m + e] = s->X[m + e] + w->dv[e];
    w->X[e] = s->X[e] + h * w->X[m + e] + w->y[e];
  }
  for (size_t e = 2 * m; e < s->size; e++) w->X[e] = s->X[e] + h * w->a[e - m];
  s->impose(s, s->t + h, w->X, w->X + m);
}

static hk_status linearise(const baraff_witkin *m, hk_system *s, double h, unsigned want, bool filtered, trial *w) {
  hk_matrix K, D;
  hk_status status = s->linear->jacobian(s, s->t, s->X, want, &K, &D);
  if (status != HK_OK) return status;
  prescribe(s, h, w);
  right_hand_side(s, &K, h, w);
  status = filtered && K.symmetric ? solve_filtered(m, s, h, &K, &D, w) : solve_by_solver(s, h, &K, &D, w);
  if (status == HK_OK) advance(s, h, w);
  return status;
}

static trial begin(const baraff_witkin *m, const hk_system *s) {
  size_t v = 3 * s->n;
  double *at = m->memory, *rest = at + 2 * s->size;
  return (trial){at, at + s->size, rest, rest + v, rest + 2 * v, rest + 3 * v, rest + 4 * v, rest + 5 * v};
}

static hk_status try_step(const baraff_witkin *m, hk_system *s, double h, trial *w) {
  bool filtered = m->solve == FILTERED && hk_system_equations(s) == 0;
  unsigned flags = 0;
  hk_status status = filtered ? HK_OK : s->linear->solver_flags(s, &flags);
  unsigned want = flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC;
  if (status == HK_OK) status = linearise(m, s, h, want, filtered, w);
  return status == HK_NOT_CONVERGED ? linearise(m, s, h, want | HK_WANT_DEFINITE, filtered, w) : status;
}

/* *good: no strain changes by more than `stretch`, and the straight line to the new state passes through no
 * contact. */
static hk_status judge(const baraff_witkin *m, hk_system *s, double h, const trial *w, double *moved, bool *good) {
  double part = 1;
  *moved = stretched(s->model, s->X, w->X);
  *good = *moved <= m->stretch;
  if (!*good || !s->contact) return HK_OK;
  for (size_t e = 0; e < 3 * s->n; e++) w->b[e] = w->X[e] - s->X[e];
  hk_status status = hk_safe_part(s, s->t + h, s->X, w->b, w->q, &part);
  *good = part >= 1;
  return status;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  baraff_witkin *m = self;
  size_t v = 3 * s->n;
  double span = t_stop - s->t, asked = h, whole = fmin(h, span), moved = 0;
  trial w = begin(m, s);
  (void)method;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, w.a, w.a + v);
  if (status != HK_OK) return status;
  double length = m->length > 0 ? m->length : span, pieces = ceil(fmin(whole, span) / length * (1 - 1e-9));
  for (h = fmin(whole, span / fmax(1, pieces));; h /= 2) {
    status = try_step(m, s, h, &w);
    bool good = false;
    if (status == HK_OK) status = judge(m, s, h, &w, &moved, &good);
    if (good) break;
    if (status != HK_OK && status != HK_NOT_CONVERGED) return status;
    m->good = 0;
    m->length = h / 2;
    if (h > 1e-9 * span) continue;
    if (status == HK_OK && !isfinite(moved)) return HK_NOT_FINITE; /* the host reports the particle */
    if (moved <= m->stretch)
      return s->host->fail(s->host, HK_NOT_CONVERGED, "a step of %g s still leads through a contact", h);
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "a step of %g s still changes a strain by %g, more than stretch = %g", h, moved, m->stretch);
  }
  memcpy(s->X, w.X, s->size * sizeof *w.X);
  if (m->length > 0 && ++m->good >= m->patience) {
    m->length = fmin(2 * m->length, 1e9);
    m->good = 0;
  }
  *out = (hk_step){h, asked, NAN};
  return HK_OK;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_ADAPTIVE | HK_NEEDS_JACOBIAN,
                                         .step = step,
                                         .growth = growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "baraff_witkin",
    .summary =
        "backward Euler with one linearisation, (M + h D + h^2 K) dv = h (F - h K v); the step follows the stretch",
    .reference = "Baraff and Witkin 1998, Large steps in cloth simulation, equations (6) and (16), section 6",
    .instance_size = sizeof(baraff_witkin),
    .params = params,
    .fields = fields,
    .integrator = &integrator,
};
