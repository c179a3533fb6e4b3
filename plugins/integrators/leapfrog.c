/* Leapfrog, or velocity Verlet, with one evaluation a step:
 *     v_half = v + h/2 a,  x' = x + h v_half,  a' = a(x', v_half + h/2 a),  v' = v_half + h/2 a'.
 * The acceleration of the end serves the next step. Forces that depend on the velocity see the predicted v + h a, which
 * keeps order 2 (the lagged v_half would be of order 1) and bounds the step by h w <= 2 (sqrt(1 + 4 xi^2) - 2 xi),
 * xi = g/(2w), with damping rate g; pure drag h g <= 1. Channels and work y go by the same prediction and average.
 * Without velocity-dependent forces it is symplectic and reversible. */
#include "plugins/common/spectral.h"

#include "core/plugin.h"

typedef struct leapfrog {
  int64_t primed;    /* whether a and dy belong to X */
  double *a;         /* n x 3, at the end of the last step */
  double *predicted; /* n x 3 */
  double *dX;        /* shaped as X: dy, then the predicted y */
} leapfrog;

static const hk_field fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(leapfrog, primed), 0},
    {"acceleration", HK_FIELD_PER_PARTICLE, 3, offsetof(leapfrog, a), 0},
    {"predicted", HK_FIELD_PER_PARTICLE, 3, offsetof(leapfrog, predicted), HK_SCRATCH},
    {"rates", HK_FIELD_STATE, 1, offsetof(leapfrog, dX), 0},
    {0},
};

/* The step on (x, h v, h^2 a), with a = -w^2 x - g v. Without damping the spectral radius is 1 up to h w = 2. */
static double amplification(double hw, double hg) {
  double z = hw * hw;
  if (hg == 0) return hw <= 2 ? 1 : z / 2 - 1 + sqrt(z * (z / 4 - 1));
  double x[3] = {1, 1, 0.5}, p[3] = {0, 1, 1}, a[3], M[9];
  for (int k = 0; k < 3; k++) a[k] = -z * x[k] - hg * p[k];
  for (int k = 0; k < 3; k++) {
    M[k] = x[k];
    M[3 + k] = (k == 1) + ((k == 2) + a[k]) / 2;
    M[6 + k] = a[k];
  }
  double radius = hk_spectral_radius(3, M);
  return hw == 0 ? fmax(1, radius) : radius;
}

static void reset(void *self, hk_reason why) {
  (void)why;
  ((leapfrog *)self)->primed = 0;
}

static hk_status prime(leapfrog *m, hk_system *s) {
  hk_status status = s->accelerations(s, s->t, s->X, s->X + 3 * s->n, s->X + 6 * s->n, m->a, m->dX);
  m->primed = status == HK_OK;
  return status;
}

/* Half kick and drift, with the prediction when a force will look at it. */
static void drift(double *restrict x, double *restrict v, double *restrict predicted, const double *restrict a,
                  size_t count, double h, bool predict) {
  double half = h / 2;
  if (predict)
    for (size_t e = 0; e < count; e++) {
      double kick = half * a[e], w = v[e] + kick;
      v[e] = w;
      x[e] += h * w;
      predicted[e] = w + kick;
    }
  else
    for (size_t e = 0; e < count; e++) {
      v[e] += half * a[e];
      x[e] += h * v[e];
    }
}

static void kick(double *restrict v, const double *restrict a, size_t count, double half) {
  for (size_t e = 0; e < count; e++) v[e] += half * a[e];
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  leapfrog *m = self;
  size_t n = s->n, tail = s->size - 6 * n;
  double *x = s->X, *v = s->X + 3 * n, *y = s->X + 6 * n, *dy = m->dX, *y_next = m->dX + tail;
  bool predict = s->flags & HK_DEPENDS_ON_V;
  (void)out;
  hk_status status = m->primed ? HK_OK : prime(m, s);
  if (status != HK_OK) return status;
  drift(x, v, m->predicted, m->a, 3 * n, h, predict);
  for (size_t e = 0; e < tail; e++) {
    y[e] += h / 2 * dy[e];
    y_next[e] = y[e] + h / 2 * dy[e];
  }
  status = s->accelerations(s, t_stop < s->t + h ? t_stop : s->t + h, x, predict ? m->predicted : v, y_next, m->a, dy);
  m->primed = status == HK_OK;
  if (status != HK_OK) return status;
  kick(v, m->a, 3 * n, h / 2);
  for (size_t e = 0; e < tail; e++) y[e] += h / 2 * dy[e];
  return HK_OK;
}

static const hk_integrator integrator = {.order = 2,
                                         .stages = 1,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE,
                                         .amplification = amplification,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "leapfrog",
    .summary =
        "velocity Verlet with the velocity predicted for velocity-dependent forces; order 2, one evaluation a step",
    .reference = "Verlet 1967; Swope and others 1982",
    .instance_size = sizeof(leapfrog),
    .fields = fields,
    .integrator = &integrator,
};
