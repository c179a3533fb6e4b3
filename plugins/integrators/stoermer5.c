/* Stoermer's multistep method of order 5: one evaluation per step, constant h, restarted by six-stage steps after
 * events. It is meant for damped scenes: without damping, oscillations grow by 2e-5 per step at h w = 0.3 (order 4 has
 * no such growth), by 2e-3 at 0.74, so that without damping its step is kept below h w = 0.13. For decay at the rate k
 * it is stable up to h k = 0.163. */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 5 };

static const hk_stoermer_method method = {
    ORDER, ORDER, {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720}};

HK_STOERMER_INTEGRATOR(ORDER);

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "stoermer5",
    .summary = "Stoermer's explicit multistep method, x' - 2x + x_before = h^2 sum sigma_j D^j a, in summed form with "
               "Adams-Bashforth 5 for v; order 5, one evaluation a step; needs some damping",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9)",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
