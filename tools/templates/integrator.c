/* NAME: symplectic Euler, v += h a(x, v), then x += h v. Describe here the method and its source. */
#include "core/plugin.h"

#include <complex.h>

typedef struct NAME {
  double *slope; /* (a, dy), as long as X */
} NAME;

static const hk_field fields[] = {
    {"slope", .state = HK_AT(NAME, slope), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* Growth of a step on z'' = -(g + i b) z' - w^2 z: the larger root of l^2 - (2 - u) l + 1 - hg - i hb with
 * u = (hw)^2 + hg + i hb. Stable steps are derived from it. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method;
  double complex damped = hg + hb * I, half = 1 - (hw * hw + damped) / 2, root = csqrt(half * half - (1 - damped));
  return fmax(cabs(half + root), cabs(half - root));
}

/* One step of exactly h, in place. X = (x, v, y): channels and the work follow x and v. */
static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  NAME *p = self;
  double *x = s->X, *v = x + 3 * s->n, *y = x + 6 * s->n, *a = p->slope, *dy = a + 3 * s->n;
  (void)method, (void)t_stop, (void)out;
  hk_status status = s->accelerations(s, s->t, x, v, y, a, dy);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < 3 * s->n; e++) {
    v[e] += h * a[e];
    x[e] += h * v[e];
  }
  for (size_t e = 0; e < s->size - 6 * s->n; e++) y[e] += h * dy[e];
  return HK_OK;
}

static const hk_integrator integrator = {
    .size = sizeof(hk_integrator), .order = 1, .stages = 1, .flags = HK_SYMPLECTIC, .step = step, .growth = growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "NAME",
    .summary = "symplectic Euler: v += h a(x, v), then x += h v; order 1",
    .reference = "",
    .instance_size = sizeof(NAME),
    .fields = fields,
    .integrator = &integrator,
};
