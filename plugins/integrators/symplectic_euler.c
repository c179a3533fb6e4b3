/* Symplectic Euler: v is advanced first, then x with the new v. Order 1; stable up to h w = 2 without damping.
 *
 * With constraints that are all equalities it is that of Hairer, Lubich and Wanner, VII.1.3: impulses along J at the
 * start of the step bring x onto g(x') = 0, and v has them too, before the host brings it onto J' v' = 0. So it is
 * symplectic with them as well, and angular momenta are kept. Without the impulses, x alone brought onto g = 0, a body
 * that spins with w gains (w h)^2/2 of its spin in each step.
 *
 * Beside leapfrog it has no history and its velocities are those of half a step: order 1. On a curtain (euler.c) as
 * many steps, 180, leave 6.0e-4 m, leapfrog 8.6e-7.
 */
#include "plugins/kit/integrate/growth_factor.h"

#include "core/plugin.h"

#include <complex.h>

typedef struct symplectic_euler {
  double *slope; /* (a, dy) */
} symplectic_euler;

static const hk_field fields[] = {
    {"slope", .state = HK_AT(symplectic_euler, slope), .width = 1, .flags = HK_SCRATCH},
    {0},
};

/* The roots lambda = 1 + u of v' = v - h w^2 x - h g v, x' = x + h v'; without damping their product is 1. */
static double growth(const void *self, const void *method, double hw, double hg, double hb) {
  double z = hw * hw;
  (void)self, (void)method;
  if (hb != 0) return hk_complex_polynomial_growth(2, (const double complex[]){z, z + hg + hb * I, 1});
  if (hg == 0) return hw <= 2 ? 1 : z / 2 - 1 + sqrt(z * (z / 4 - 1));
  return hk_polynomial_growth(2, (const double[]){z, z + hg, 1});
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

/* From X to `next`, to which the constraint forces at X have been applied already; what they are short of is the rest.
 */
static hk_status hold(hk_system *s, double t_next, double h, double *next) {
  double work = 0;
  if (!s->constraint || !s->constraint->holonomic) return HK_OK;
  hk_status status = s->constraint->shake(s, t_next, s->X, h, next, next + 3 * s->n, &work);
  next[s->size - 1] += work;
  return status;
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  double *a = ((symplectic_euler *)self)->slope, *X = s->X, *next = s->spare;
  size_t v = 3 * s->n, y = 6 * s->n;
  (void)method, (void)out;
  advance all = {X, X + v, a, next, next + v, h};
  hk_status status =
      s->fused(s, s->t, X, X + v, X + y, a, a + v, &(hk_fused){&all, NULL, HK_WIDEST(s->host->lanes, advance_range)});
  if (status != HK_OK) return status;
  for (size_t e = y; e < s->size; e++) next[e] = X[e] + h * a[e - v];
  status = hold(s, fmin(t_stop, s->t + h), h, next);
  if (status == HK_OK) s->exchange(s);
  return status;
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_SYMPLECTIC | HK_USES_SPARE,
                                         .step = step,
                                         .growth = growth,
                                         .facets = HK_FACETS(HK_STAGES_FACET(.count = 1, .x_end = {1}, .v_end = {1}))};

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
