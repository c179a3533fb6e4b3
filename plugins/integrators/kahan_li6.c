/* Kahan and Li's composition of nine leapfrog steps, some of them backwards in time: order 6 for forces F(x, t)
 * (splitting.h). Among such compositions of order 6 its coefficients are small, and so are its errors. */
#include "plugins/common/integrate/splitting.h"

/* Kahan and Li 1997, table 2, s9odr6a. */
static const hk_splitting_method method =
    HK_COMPOSED_9(0.39216144400731413927925056, 0.33259913678935943859974864, -0.70624617255763935980996482,
                  0.08221359629355080023149045, 0.79854399093482996339895035);

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_splitting_amplification(&method, hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_splitting_rotation(&method, hw, hg, hb);
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  (void)out;
  return hk_splitting_step(self, &method, s, t_stop, h);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 6,
                                         .stages = 9,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE | HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = hk_splitting_reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "kahan_li6",
    .summary =
        "Runge-Kutta-Nystroem splitting: nine leapfrog steps of lengths g_i h, some backwards, nine evaluations a "
        "step; order 6 for forces F(x, t), 2 in what depends on the velocity",
    .reference = "Kahan and Li 1997, Math. Comp. 66, s9odr6a; Hairer, Lubich and Wanner, Geometric Numerical "
                 "Integration, (V.3.11)",
    .instance_size = sizeof(hk_splitting),
    .fields = hk_splitting_fields,
    .integrator = &integrator,
};
