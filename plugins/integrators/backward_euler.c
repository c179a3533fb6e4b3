/* Backward Euler, X' = X + h f(t + h, X'), solved by Newton's method to its tolerance. Order 1; it damps fast motion:
 * |R| = (1 + (h w)^2)^(-1/2) on an undamped oscillator. */
#include "plugins/common/implicit/dirk.h"

static const hk_dirk_tableau tableau = {.stages = 1, .c = {1}, .a = {{1}}, .b = {1}};

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
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "backward_euler",
    .summary = "backward Euler, x' = x + h v', v' = v + h a(x', v'), by Newton's method; order 1, damps what is stiff",
    .reference = "Hairer and Wanner, Solving ODEs II, IV.3; Baraff and Witkin 1998 take one iteration of it",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
