/* Baraff and Witkin's step: backward Euler with one linearisation,
 *     (M + h D + h^2 K) dv = h (F(x, v) - h K v),   v' = v + dv,   x' = x + h v',
 * and their control of the step: a step that changes the strain of any spring by more than `stretch`, or that passes
 * through a contact, is discarded and repeated with half the length; after `patience` accepted steps the length is
 * doubled, up to a frame or `dt`. Particles with a scripted motion have a prescribed dv, which enters the equations of
 * their neighbours through the right-hand side. The matrix may be indefinite where springs are compressed; the step is
 * then repeated with semi-definite blocks. Constraint forces are those of the start of the step plus those that keep dv
 * consistent with the constraints. Channels are explicit.
 * Baraff and Witkin 1998, equations (6) and (16), sections 5 and 6. */
#include "core/plugin.h"
#include "plugins/common/linear/block_product.h"
#include "plugins/common/integrate/growth_factor.h"
#include "plugins/common/moves/safe_move.h"
#include "plugins/common/linear/block_product.h"

#include <float.h>
#include <string.h>

typedef struct baraff_witkin {
  double stretch;
  int64_t patience;
  double length; /* s, length of the next step */
  int64_t good;  /* accepted steps since `length` changed */
  double *memory;
} baraff_witkin;

enum { STATES = 4 };

static const hk_param params[] = {
    {"stretch",
     "",
     "largest change of a spring's strain (l - L)/L in a step",
     HK_NUMBER,
     {0.1},
     0,
     INFINITY,
     offsetof(baraff_witkin, stretch),
     HK_ABOVE_MIN,
     NULL},
    {"patience",
     "",
     "steps that must go well before a longer one is tried",
     HK_INTEGER,
     {4},
     1,
     1000000,
     offsetof(baraff_witkin, patience),
     0,
     NULL},
    {0},
};

static const hk_field fields[] = {
    {"length", HK_FIELD_NUMBER, 1, offsetof(baraff_witkin, length), 0},
    {"good", HK_FIELD_INTEGER, 1, offsetof(baraff_witkin, good), 0},
    {"memory", HK_FIELD_STATE, STATES, offsetof(baraff_witkin, memory), HK_SCRATCH},
    {0},
};

/* For a linear equation one linearisation is exact, so the roots are those of backward Euler; with u = lambda - 1,
 * (1 + h g + (h w)^2) u^2 + (h g + 2 (h w)^2) u + (h w)^2 = 0. */
static double amplification(const void *self, double hw, double hg) {
  (void)self;

  const double z = hw * hw, c[] = {z, hg + 2 * z, 1 + hg + z};
  return hk_polynomial_growth(2, c);
}

static double length_of(const double *x, const uint32_t pair[2]) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) {
    double d = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
    sum += d * d;
  }
  return sqrt(sum);
}

/* The largest change of strain from x to x_new among elements that are plain edges. */
static double stretched(const hk_model *model, const double *x, const double *x_new) {
  double largest = 0;
  for (size_t k = 0; k < model->element_lists; k++) {
    const hk_elements *list = &model->element_list[k].elements;
    if (!model->element_list[k].acts || !hk_elements_are_edges(list)) continue;
    for (size_t e = 0; e < list->node.count; e++) {
      double rest = list->rest.count ? hk_tuple_value(&list->rest, e) : 0;
      if (!(rest > 0)) continue;
      double change = fabs(length_of(x_new, hk_tuple(&list->node, e)) - length_of(x, hk_tuple(&list->node, e))) / rest;
      if (!(change <= largest)) largest = change;
    }
  }
  return largest;
}

typedef struct trial {
  double *X, *a, *b, *dv, *z, *q; /* state; slopes; right-hand side and solution; prescribed changes, products */
} trial;

/* b = h F - K (h^2 v + h^2 z) - D h z, filtered. */
static void right_hand_side(const hk_system *s, const hk_matrix *K, const hk_matrix *D, double h, trial *w) {
  size_t m = 3 * s->n;
  const double *v = s->X + m;
  for (size_t e = 0; e < m; e++) w->b[e] = h * h * (v[e] + w->z[e]);
  hk_block_product(s->host, K, w->b, w->q);
  for (size_t e = 0; e < m; e++) w->b[e] = h * s->model->mass[e / 3] * w->a[e] - w->q[e];
  for (size_t e = 0; e < m; e++) w->z[e] *= h;
  hk_block_product(s->host, D, w->z, w->q);
  for (size_t e = 0; e < m; e++) w->b[e] -= w->q[e];
}

/* With constraints, dv satisfies J dv = h J a, where a includes the constraint forces. */
static hk_status solve(hk_system *s, double h, trial *w) {
  if (s->equations == 0) return s->solve(s, w->b, w->dv, NULL);
  for (size_t e = 0; e < 3 * s->n; e++) w->q[e] = h * w->a[e];
  return s->solve_along(s, w->b, w->q, w->dv, NULL);
}

static hk_status linearise(hk_system *s, double h, unsigned want, trial *w) {
  size_t m = 3 * s->n;
  hk_matrix K, D, A;
  double *v = s->X + m;
  hk_status status = s->jacobian(s, s->t, s->X, want, &K, &D);
  if (status != HK_OK) return status;
  memcpy(w->X, s->X, s->size * sizeof *w->X);
  s->impose(s, s->t + h, w->X, w->X + m); /* prescribed velocities; z: their changes, which the filter removes */
  for (size_t e = 0; e < m; e++) w->z[e] = s->model->inverse_mass[e / 3] > 0 ? 0 : w->X[m + e] - v[e];
  right_hand_side(s, &K, &D, h, w);
  s->filter(s, w->b);
  status = s->combine(s, 1, h, h * h, &A);
  if (status == HK_OK) status = s->factorize(s, &A);
  if (status == HK_OK) status = solve(s, h, w);
  if (status != HK_OK) return status;
  s->filter(s, w->dv);
  for (size_t e = 0; e < m; e++) {
    w->X[m + e] = v[e] + w->dv[e];
    w->X[e] = s->X[e] + h * w->X[m + e];
  }
  for (size_t e = 2 * m; e < s->size; e++) w->X[e] = s->X[e] + h * w->a[e - m];
  s->impose(s, s->t + h, w->X, w->X + m);
  return HK_OK;
}

static trial begin(const baraff_witkin *m, const hk_system *s) {
  size_t v = 3 * s->n;
  double *at = m->memory;
  return (trial){at, at + s->size, at + 2 * s->size, at + 2 * s->size + v, at + 3 * s->size, at + 3 * s->size + v};
}

static hk_status try_step(hk_system *s, double h, trial *w) {
  unsigned flags;
  hk_status status = s->solver_flags(s, &flags);
  unsigned want = flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC;
  if (status == HK_OK) status = linearise(s, h, want, w);
  return status == HK_NOT_CONVERGED ? linearise(s, h, want | HK_WANT_DEFINITE, w) : status;
}

/* *good: no spring's strain changes by more than `stretch`, and the straight line to the new state passes through no
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

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  baraff_witkin *m = self;
  size_t v = 3 * s->n;
  double span = t_stop - s->t, asked = h, whole = fmin(h, span), moved = 0;
  trial w = begin(m, s);
  hk_status status = s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, w.a, w.a + v);
  if (status != HK_OK) return status;
  double length = m->length > 0 ? m->length : span, pieces = ceil(fmin(whole, span) / length * (1 - 1e-9));
  for (h = fmin(whole, span / fmax(1, pieces));; h /= 2) {
    status = try_step(s, h, &w);
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
                         "a step of %g s still changes a spring's strain by %g, more than stretch = %g", h, moved,
                         m->stretch);
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
                                         .amplification = amplification,
                                         .step = step};

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
