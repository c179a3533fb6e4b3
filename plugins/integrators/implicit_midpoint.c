/* The implicit midpoint rule, X' = X + h f(t + h/2, (X + X')/2): order 2, symplectic, reversible; it conserves momenta
 * and quadratic invariants. It damps nothing, so stiff motion that the step does not resolve continues to oscillate, at
 * the wrong frequency (2/h) atan(h w/2). */
#include "plugins/common/implicit/dirk.h"

static const hk_dirk_tableau tableau = {.stages = 1, .c = {0.5}, .a = {{0.5}}, .b = {1}};

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_dirk_amplification(&tableau, hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_dirk_rotation(&tableau, hw, hg, hb);
}

static void reset(void *self, hk_reason why) { hk_dirk_reset(self, why); }

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  (void)out;
  return hk_dirk_step(self, &tableau, s, t_stop, h);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 1,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_SYMPLECTIC |
                                                  HK_REVERSIBLE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "implicit_midpoint",
    .summary = "implicit midpoint rule, X' = X + h f((X + X')/2); order 2, symplectic, damps nothing",
    .reference = "Hairer, Lubich and Wanner, Geometric Numerical Integration, II.1 and VI.4",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
