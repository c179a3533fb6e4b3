/* Stoermer's multistep method of order 4: one evaluation per step, constant h, restarted by six-stage steps after
 * events. Stable up to h w = sqrt 2 without damping, and up to h k = 0.3 for decay at the rate k. */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 4 };

static const hk_stoermer_method method = {ORDER, ORDER, {1, 0, 1.0 / 12, 1.0 / 12}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8}};

HK_STOERMER_INTEGRATOR(ORDER);

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "stoermer",
    .summary = "Stoermer's explicit multistep method, x' - 2x + x_before = h^2 sum sigma_j D^j a, in summed form with "
               "Adams-Bashforth 4 for v; order 4, one evaluation a step",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9)",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
