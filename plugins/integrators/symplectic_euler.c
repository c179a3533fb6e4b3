/* Symplectic Euler: v first, then x with the new v. Order 1; stable to h w = 2 without damping. */
#include "core/plugin.h"

typedef struct symplectic_euler {
  double *a;  /* n x 3 */
  double *dX; /* shaped as X; the rates of channels */
} symplectic_euler;

static const hk_field fields[] = {
    {"acceleration", HK_FIELD_PER_PARTICLE, 3, offsetof(symplectic_euler, a), HK_SCRATCH},
    {"rates", HK_FIELD_STATE, 1, offsetof(symplectic_euler, dX), HK_SCRATCH},
    {0},
};

/* Trace and determinant of v' = v - h w^2 x - h g v, x' = x + h v'. */
static double amplification(double hw, double hg) {
  double trace = 2 - hg - hw * hw, determinant = 1 - hg, discriminant = trace * trace / 4 - determinant;
  if (hw == 0) return fmax(1, fabs(1 - hg));
  return discriminant < 0 ? sqrt(determinant) : fabs(trace) / 2 + sqrt(discriminant);
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  const symplectic_euler *m = self;
  size_t n = s->n, tail = s->size - 6 * n;
  double *restrict x = s->X, *restrict v = s->X + 3 * n, *restrict y = s->X + 6 * n;
  (void)t_stop, (void)out;
  hk_status status = s->accelerations(s, s->t, x, v, y, m->a, m->dX);
  if (status != HK_OK) return status;
  const double *restrict a = m->a;
  for (size_t e = 0; e < 3 * n; e++) {
    v[e] += h * a[e];
    x[e] += h * v[e];
  }
  for (size_t e = 0; e < tail; e++) y[e] += h * m->dX[e];
  return HK_OK;
}

static const hk_integrator integrator = {
    .order = 1, .stages = 1, .flags = HK_SYMPLECTIC, .amplification = amplification, .step = step};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "symplectic_euler",
    .summary = "symplectic Euler: v += h a(x, v), then x += h v; order 1",
    .reference = "de Vogelaere 1956; Hairer, Lubich and Wanner, Geometric Numerical Integration, I.1.2",
    .instance_size = sizeof(symplectic_euler),
    .fields = fields,
    .integrator = &integrator,
};
