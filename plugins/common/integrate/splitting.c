#include "plugins/common/integrate/splitting.h"
#include "plugins/kit/integrate/growth_factor.h"
#include "plugins/kit/integrate/rattle.h"

#include <complex.h>
#include <string.h>

const hk_field hk_splitting_fields[] = {
    {"primed", .integer = HK_AT(hk_splitting, primed)},
    {"slope", .state = HK_AT(hk_splitting, slope), .width = 1},
    {"seen", .state = HK_AT(hk_splitting, seen), .width = 1, .flags = HK_SCRATCH},
    {"low", .per_particle = HK_AT(hk_splitting, low), .width = 3},
    {0},
};

static const hk_constrained_facet constrained = {.size = sizeof constrained, .keeps = true};
const hk_facet hk_splitting_facets[] = {{HK_CONSTRAINED_ID, &constrained}, {0}};

static double ahead(const hk_splitting_method *f, int kick) {
  return kick == f->stages ? f->kick[kick] : f->kick[kick] / 2;
}

/* Applies the step to (x, h v, h^2 a) = (x, p, q), d = h (g + i b); out: the increments, that is the result minus the
 * given values. */
static void increments(const hk_splitting_method *f, double z, double complex d, double x, double p, double complex q,
                       double complex out[3]) {
  double complex dx = 0, dp = 0, q0 = q;
  for (int i = 0; i < f->stages; i++) {
    dp += f->kick[i] * q;
    dx += f->drift[i] * (p + dp);
    if (f->kick[i + 1] != 0) q = -z * (x + dx) - d * (p + dp + ahead(f, i + 1) * q);
  }
  out[0] = dx;
  out[1] = dp + f->kick[f->stages] * q;
  out[2] = q - q0;
}

static double undamped(const hk_splitting_method *f, double z) {
  double complex x[3], p[3];
  increments(f, z, 0, 1, 0, -z, x);
  increments(f, z, 0, 0, 1, 0, p);
  double half = 1 + creal(x[0] + p[1]) / 2; /* half the trace of the step's matrix, whose determinant is 1 */
  return fabs(half) <= 1 ? 1 : fabs(half) + sqrt(half * half - 1);
}

double hk_splitting_growth(const void *self, const void *method, double hw, double hg, double hb) {
  const hk_splitting_method *f = method;
  double z = hw * hw;
  (void)self;
  if (hg == 0 && hb == 0) return undamped(f, z);
  double complex x[3], p[3], q[3], d = hg + hb * I;
  increments(f, z, d, 1, 0, 0, x);
  increments(f, z, d, 0, 1, 0, p);
  increments(f, z, d, 0, 0, 1, q);
  double complex minors = x[0] * p[1] - p[0] * x[1] + x[0] * q[2] - q[0] * x[2] + p[1] * q[2] - q[1] * p[2];
  double complex determinant =
      x[0] * (p[1] * q[2] - q[1] * p[2]) - p[0] * (x[1] * q[2] - q[1] * x[2]) + q[0] * (x[1] * p[2] - p[1] * x[2]);
  return hk_complex_polynomial_growth(3, (const double complex[]){-determinant, minors, -(x[0] + p[1] + q[2]), 1});
}

void hk_splitting_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_splitting *)self)->primed = 0;
}

/* What is done before and after an evaluation. */
typedef struct stage {
  const double *X;      /* the state before the step where this is the first stage, or NULL */
  double *x, *v, *seen; /* n x 3; seen: the velocities that forces see */
  const double *a;
  double kick, drift, predict, last; /* last: the kick after the evaluation */
  size_t n;
} stage;

/* A kick, a drift, and the velocity predicted for the evaluation. */
static void advance(void *context, size_t begin, size_t end) {
  const stage *s = context;
  double *restrict x = s->x, *restrict v = s->v, *restrict seen = s->seen;
  const double *restrict a = s->a;
  size_t first = 3 * begin, count = 3 * (end - begin);
  if (s->X) memcpy(x + first, s->X + first, count * sizeof *x);
  if (s->X) memcpy(v + first, s->X + 3 * s->n + first, count * sizeof *v);
  for (size_t e = first; e < first + count; e++) {
    v[e] += s->kick * a[e];
    x[e] += s->drift * v[e];
    seen[e] = v[e] + s->predict * a[e];
  }
}

static void kick_last(void *context, size_t begin, size_t end) {
  const stage *s = context;
  double *restrict v = s->v;
  const double *restrict a = s->a;
  for (size_t e = 3 * begin; e < 3 * end; e++) v[e] += s->last * a[e];
}

static void kick_rates(double *restrict y, double *restrict seen, const double *restrict dy, size_t count, double kick,
                       double predict) {
  for (size_t e = 0; e < count; e++) {
    y[e] += kick * dy[e];
    seen[e] = y[e] + predict * dy[e];
  }
}

static hk_status prime(hk_splitting *m, hk_system *s) {
  size_t v = 3 * s->n;
  hk_status status =
      m->primed ? HK_OK : s->accelerations(s, s->t, s->X, s->X + v, s->X + 2 * v, m->slope, m->slope + v);
  m->primed = 0; /* until the end of the step, which writes over the slope */
  return status;
}

/* The states alternate between two lists, so that X stays as it was; their number is odd. */
static hk_status constrained_step(hk_splitting *m, const hk_splitting_method *f, hk_system *s, double t_stop,
                                  double h) {
  double *from = s->X, *to = s->spare, t = s->t;
  s->constraint->takes_constraints = false;
  if (!m->primed) memset(m->low, 0, 3 * s->n * sizeof *m->low);
  hk_status status = prime(m, s);
  for (int i = 0; i < f->parts && status == HK_OK; i++) {
    double part = f->part[i] * h, next = i + 1 < f->parts ? t + part : fmin(t_stop, s->t + h);
    status = hk_rattle_step_whole(s, t, from, next, part, to, m->slope, m->slope + 3 * s->n, m->low);
    t = next, from = to, to = from == s->spare ? m->seen : s->spare;
  }
  if (status != HK_OK) return status;
  s->exchange(s);
  m->primed = 1;
  return HK_OK;
}

hk_status hk_splitting_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  hk_splitting *m = self;
  const hk_splitting_method *f = method;
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = s->spare, *seen = m->seen, *a = m->slope, t = s->t, last = h * f->kick[f->stages];
  (void)out;
  if (s->constraint && s->constraint->holonomic) return constrained_step(m, f, s, t_stop, h);
  hk_status status = prime(m, s);
  memcpy(X + y, s->X + y, (s->size - y) * sizeof *X);
  for (int i = 0; i < f->stages && status == HK_OK; i++) {
    stage at = {i == 0 ? s->X : NULL, X,    X + v, seen + v, a, h * f->kick[i], h * f->drift[i],
                h * ahead(f, i + 1),  last, s->n};
    kick_rates(X + y, seen + y, a + v, s->size - y, at.kick, at.predict);
    t = i + 1 < f->stages ? t + h * f->drift[i] : fmin(t_stop, s->t + h);
    hk_fused work = {&at, advance, i + 1 < f->stages ? NULL : kick_last};
    status = s->fused(s, t, X, seen + v, seen + y, a, a + v, &work);
  }
  if (status != HK_OK) return status;
  kick_rates(X + y, seen + y, a + v, s->size - y, last, 0);
  s->exchange(s);
  m->primed = 1;
  return HK_OK;
}
