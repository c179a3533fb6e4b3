/* TR-BDF2: the trapezoidal rule to t + (2 - sqrt 2) h, then the backward difference formula of order 2 to t + h, both
 * with the same matrix. Order 2, L-stable, with an error estimate and its own choice of the step. */
#include "plugins/common/implicit/dirk.h"

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_dirk_amplification(&hk_tr_bdf2, hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_dirk_rotation(&hk_tr_bdf2, hw, hg, hb);
}

static void reset(void *self, hk_reason why) { hk_dirk_reset(self, why); }

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  return hk_dirk_adaptive_step(self, &hk_tr_bdf2, s, t_stop, h, out);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 2,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_ADAPTIVE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "tr_bdf2",
    .summary =
        "trapezoidal rule and backward differences in one step with one matrix; order 2, L-stable, chooses its steps",
    .reference = "Bank and others 1985; Hosea and Shampine 1996, Applied Numerical Mathematics 20",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_adaptive_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
