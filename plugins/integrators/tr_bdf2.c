/* TR-BDF2: the trapezoidal rule to t + (2 - sqrt 2) h, then the backward difference formula of order 2 to t + h, both
 * with the same matrix. Order 2, L-stable, with an error estimate and its own choice of the step.
 *
 * For few digits: cloth with k = 1e6 N/m to 1e-3 m takes it 265 evaluations, off by 1.4e-4 m, esdirk4 289 at 1.7e-4
 * (the command is in linear_bdf2.c). It is the first step of bdf2.
 */
#include "plugins/common/implicit/dirk.h"

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 2,
                                         .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_ADAPTIVE,
                                         .method = &hk_tr_bdf2,
                                         .step = hk_dirk_adaptive_step,
                                         .reset = hk_dirk_reset,
                                         .growth = hk_dirk_growth};

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
