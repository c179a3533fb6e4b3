#include "plugins/common/integrate/splitting.h"
#include "plugins/common/integrate/growth_factor.h"

#include <complex.h>
#include <string.h>

const hk_field hk_splitting_fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(hk_splitting, primed), 0},
    {"slope", HK_FIELD_STATE, 1, offsetof(hk_splitting, slope), 0},
    {"stage", HK_FIELD_STATE, 1, offsetof(hk_splitting, stage), HK_SCRATCH},
    {"seen", HK_FIELD_STATE, 1, offsetof(hk_splitting, seen), HK_SCRATCH},
    {0},
};

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
    q = -z * (x + dx) - d * (p + dp + ahead(f, i + 1) * q);
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

double hk_splitting_rotation(const hk_splitting_method *f, double hw, double hg, double hb) {
  double z = hw * hw;
  double complex x[3], p[3], q[3], d = hg + hb * I;
  increments(f, z, d, 1, 0, 0, x);
  increments(f, z, d, 0, 1, 0, p);
  increments(f, z, d, 0, 0, 1, q);
  double complex minors = x[0] * p[1] - p[0] * x[1] + x[0] * q[2] - q[0] * x[2] + p[1] * q[2] - q[1] * p[2];
  double complex determinant =
      x[0] * (p[1] * q[2] - q[1] * p[2]) - p[0] * (x[1] * q[2] - q[1] * x[2]) + q[0] * (x[1] * p[2] - p[1] * x[2]);
  return hk_complex_polynomial_growth(3, (const double complex[]){-determinant, minors, -(x[0] + p[1] + q[2]), 1});
}

double hk_splitting_amplification(const hk_splitting_method *f, double hw, double hg) {
  return hg == 0 ? undamped(f, hw * hw) : hk_splitting_rotation(f, hw, hg, 0);
}

void hk_splitting_reset(void *self, hk_reason why) {
  (void)why;
  ((hk_splitting *)self)->primed = 0;
}

/* A kick, a drift, and the velocity predicted for the next evaluation. */
static void advance(double *restrict x, double *restrict v, double *restrict seen, const double *restrict a,
                    size_t count, double kick, double drift, double predict) {
  for (size_t e = 0; e < count; e++) {
    v[e] += kick * a[e];
    x[e] += drift * v[e];
    seen[e] = v[e] + predict * a[e];
  }
}

static void kick_rates(double *restrict y, double *restrict seen, const double *restrict dy, size_t count, double kick,
                       double predict) {
  for (size_t e = 0; e < count; e++) {
    y[e] += kick * dy[e];
    seen[e] = y[e] + predict * dy[e];
  }
}

hk_status hk_splitting_step(hk_splitting *m, const hk_splitting_method *f, hk_system *s, double t_stop, double h) {
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = m->stage, *seen = m->seen, *a = m->slope, t = s->t;
  hk_status status = HK_OK;
  if (!m->primed) status = s->accelerations(s, t, s->X, s->X + v, s->X + y, a, a + v);
  m->primed = 0;
  memcpy(X, s->X, s->size * sizeof *X);
  for (int i = 0; i < f->stages && status == HK_OK; i++) {
    advance(X, X + v, seen + v, a, v, h * f->kick[i], h * f->drift[i], h * ahead(f, i + 1));
    kick_rates(X + y, seen + y, a + v, s->size - y, h * f->kick[i], h * ahead(f, i + 1));
    t = i + 1 < f->stages ? t + h * f->drift[i] : fmin(t_stop, s->t + h);
    status = s->accelerations(s, t, X, seen + v, seen + y, a, a + v);
  }
  if (status != HK_OK) return status;
  advance(X, X + v, seen + v, a, v, h * f->kick[f->stages], 0, 0);
  kick_rates(X + y, seen + y, a + v, s->size - y, h * f->kick[f->stages], 0);
  memcpy(s->X, X, s->size * sizeof *X);
  m->primed = 1;
  return HK_OK;
}
