/* Symplectic Euler: v is advanced first, then x with the new v. Order 1; stable up to h w = 2 without damping. */
#include "plugins/common/integrate/growth_factor.h"

#include "core/plugin.h"

#include <complex.h>

typedef struct symplectic_euler {
  double *slope; /* (a, dy) */
} symplectic_euler;

static const hk_field fields[] = {
    {"slope", HK_FIELD_STATE, 1, offsetof(symplectic_euler, slope), HK_SCRATCH},
    {0},
};

/* The roots lambda = 1 + u of v' = v - h w^2 x - h g v, x' = x + h v'; without damping their product is 1. */
static double amplification(const void *self, double hw, double hg) {
  (void)self;

  double z = hw * hw;
  if (hg == 0) return hw <= 2 ? 1 : z / 2 - 1 + sqrt(z * (z / 4 - 1));
  return hk_polynomial_growth(2, (const double[]){z, z + hg, 1});
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  double z = hw * hw;
  return hk_complex_polynomial_growth(2, (const double complex[]){z, z + hg + hb * I, 1});
}

typedef struct advance {
  const double *x, *v, *a;
  double *x_next, *v_next;
  double h;
} advance;

HK_INLINE void advance_each(const advance *all, size_t begin, size_t end) {
  const double *restrict x = all->x, *restrict v = all->v, *restrict a = all->a, h = all->h;
  double *restrict x_next = all->x_next, *restrict v_next = all->v_next;
  for (size_t e = begin; e < end; e++) {
    v_next[e] = v[e] + h * a[e];
    x_next[e] = x[e] + h * v_next[e];
  }
}

HK_VERSIONS(static void, advance_range, (void *context, size_t begin, size_t end),
            advance_each(context, 3 * begin, 3 * end))

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  double *a = ((symplectic_euler *)self)->slope, *X = s->X, *next = s->spare;
  size_t v = 3 * s->n, y = 6 * s->n;
  (void)t_stop, (void)out;
  advance all = {X, X + v, a, next, next + v, h};
  hk_status status = s->pass(s, s->t, X, X + v, X + y, a, a + v, &(hk_pass){&all, NULL, HK_WIDEST(advance_range)});
  if (status != HK_OK) return status;
  for (size_t e = y; e < s->size; e++) next[e] = X[e] + h * a[e - v];
  s->exchange(s);
  return HK_OK;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_SYMPLECTIC | HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "symplectic_euler",
    .summary = "symplectic Euler: v += h a(x, v), then x += h v; order 1",
    .reference = "de Vogelaere 1956; Hairer, Lubich and Wanner, Geometric Numerical Integration, (I.1.9)",
    .instance_size = sizeof(symplectic_euler),
    .fields = fields,
    .integrator = &integrator,
};
