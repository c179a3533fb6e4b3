/* The implicit trapezoidal rule, X' = X + h/2 (f(t, X) + f(t + h, X')): order 2, A-stable, without damping. The slope
 * at the start is that of the end of the previous step. */
#include "plugins/common/implicit/dirk.h"

static const hk_dirk_tableau tableau = {.stages = 2, .c = {0, 1}, .a = {{0}, {0.5, 0.5}}, .b = {0.5, 0.5}};

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
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_REVERSIBLE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "implicit_trapezoid",
    .summary = "implicit trapezoidal rule, X' = X + h/2 (f(X) + f(X')); order 2, damps nothing",
    .reference = "Hairer and Wanner, Solving ODEs II, IV.3; Newmark 1959 with beta 1/4",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
