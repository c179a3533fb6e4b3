/* Blanes and Moan's splitting SRKN(6, 4) for x'' = F(x, t): kicks b_i and drifts a_i alternate; symmetric, of order 4
 * and symplectic. The drifts advance the time. The last kick of a step and the first of the next have the same x and
 * use the same evaluation, so a step takes six evaluations.
 *
 * Evaluations get v and the channels y in the middle of the kick, predicted with the rates of the kick before. This
 * gives order 2 for drag, for power and for channel rates that depend on v or y, without further evaluations. Channels
 * whose rates depend on x and t alone are advanced by kicks like v and have order 4. */
#include "plugins/common/integrate/growth_factor.h"

#include "core/plugin.h"

#include <complex.h>
#include <string.h>

enum { STAGES = 6 };

/* b_1 a_1 b_2 ... a_6 b_7, Blanes and Moan 2002, table 3, SRKN_6^b. */
#define A1 0.245298957184271
#define A2 0.604872665711080
#define B1 0.0829844064174052
#define B2 0.396309801498368
#define B3 -0.0390563049223486
static const double drifts[STAGES] = {A1, A2, 0.5 - (A1 + A2), 0.5 - (A1 + A2), A2, A1};
static const double kicks[STAGES + 1] = {B1, B2, B3, 1 - 2 * (B1 + B2 + B3), B3, B2, B1};

typedef struct blanes_moan {
  int64_t primed; /* whether `slope` is that of X */
  double *slope;  /* (a, dy) of the last kick */
  double *stage;  /* shaped as X: the state between kicks */
  double *seen;   /* shaped as X: predicted v and y for the next evaluation */
} blanes_moan;

static const hk_field fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(blanes_moan, primed), 0},
    {"slope", HK_FIELD_STATE, 1, offsetof(blanes_moan, slope), 0},
    {"stage", HK_FIELD_STATE, 1, offsetof(blanes_moan, stage), HK_SCRATCH},
    {"seen", HK_FIELD_STATE, 1, offsetof(blanes_moan, seen), HK_SCRATCH},
    {0},
};

static double ahead(int kick) { return kick == STAGES ? kicks[kick] : kicks[kick] / 2; }

/* Applies the step to (x, h v, h^2 a) = (x, p, q), d = h (g + i b); out: the increments, that is the result minus the
 * given values. */
static void increments(double z, double complex d, double x, double p, double complex q, double complex out[3]) {
  double complex dx = 0, dp = 0, q0 = q;
  for (int i = 0; i < STAGES; i++) {
    dp += kicks[i] * q;
    dx += drifts[i] * (p + dp);
    q = -z * (x + dx) - d * (p + dp + ahead(i + 1) * q);
  }
  out[0] = dx;
  out[1] = dp + kicks[STAGES] * q;
  out[2] = q - q0;
}

static double undamped(double z) {
  double complex x[3], p[3];
  increments(z, 0, 1, 0, -z, x);
  increments(z, 0, 0, 1, 0, p);
  double half = 1 + creal(x[0] + p[1]) / 2; /* half the trace of the step's matrix, whose determinant is 1 */
  return fabs(half) <= 1 ? 1 : fabs(half) + sqrt(half * half - 1);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  double z = hw * hw;
  double complex x[3], p[3], q[3], d = hg + hb * I;
  increments(z, d, 1, 0, 0, x);
  increments(z, d, 0, 1, 0, p);
  increments(z, d, 0, 0, 1, q);
  double complex minors = x[0] * p[1] - p[0] * x[1] + x[0] * q[2] - q[0] * x[2] + p[1] * q[2] - q[1] * p[2];
  double complex determinant =
      x[0] * (p[1] * q[2] - q[1] * p[2]) - p[0] * (x[1] * q[2] - q[1] * x[2]) + q[0] * (x[1] * p[2] - p[1] * x[2]);
  return hk_complex_polynomial_growth(3, (const double complex[]){-determinant, minors, -(x[0] + p[1] + q[2]), 1});
}

static double amplification(const void *self, double hw, double hg) {
  return hg == 0 ? undamped(hw * hw) : rotation(self, hw, hg, 0);
}

static void reset(void *self, hk_reason why) {
  (void)why;
  ((blanes_moan *)self)->primed = 0;
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

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  blanes_moan *m = self;
  size_t v = 3 * s->n, y = 6 * s->n;
  double *X = m->stage, *seen = m->seen, *a = m->slope, t = s->t;
  (void)out;
  hk_status status = HK_OK;
  if (!m->primed) status = s->accelerations(s, t, s->X, s->X + v, s->X + y, a, a + v);
  m->primed = 0;
  memcpy(X, s->X, s->size * sizeof *X);
  for (int i = 0; i < STAGES && status == HK_OK; i++) {
    advance(X, X + v, seen + v, a, v, h * kicks[i], h * drifts[i], h * ahead(i + 1));
    kick_rates(X + y, seen + y, a + v, s->size - y, h * kicks[i], h * ahead(i + 1));
    t = i + 1 < STAGES ? t + h * drifts[i] : fmin(t_stop, s->t + h);
    status = s->accelerations(s, t, X, seen + v, seen + y, a, a + v);
  }
  if (status != HK_OK) return status;
  advance(X, X + v, seen + v, a, v, h * kicks[STAGES], 0, 0);
  kick_rates(X + y, seen + y, a + v, s->size - y, h * kicks[STAGES], 0);
  memcpy(s->X, X, s->size * sizeof *X);
  m->primed = 1;
  return HK_OK;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 4,
                                         .stages = STAGES,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "blanes_moan",
    .summary =
        "Runge-Kutta-Nystroem splitting of kicks v += b h a and drifts x += a h v, six evaluations a step; order "
        "4 for forces F(x, t), 2 in what depends on the velocity",
    .reference = "Blanes and Moan 2002, J. Comput. Appl. Math. 142, table 3, SRKN_6^b",
    .instance_size = sizeof(blanes_moan),
    .fields = fields,
    .integrator = &integrator,
};
