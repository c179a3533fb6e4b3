/* Stoermer's multistep method of order 5: one evaluation per step, constant h, restarted by six-stage steps after
 * events. It is meant for damped scenes: without damping, oscillations grow by 2e-5 per step at h w = 0.3 (order 4 has
 * no such growth), by 2e-3 at 0.74, so that without damping its step is kept below h w = 0.13. For decay at the rate k
 * it is stable up to h k = 0.163.
 *
 * Better than stoermer below 1e-8 m on that curtain (2,030 evaluations, 4.3e-10 m, where stoermer by its order needs
 * some 3,400), and the cheapest of all for planets to 1e-4 of the earth's distance: 320 evaluations for 20,000 days,
 * blanes_moan 601 (hooke bench scripts/scenes/solar.lua duration=20000 --target 1e-3).
 */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 5 };

static const hk_stoermer_method method = {
    ORDER, ORDER, {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720}};

static const hk_field fields[] = HK_STOERMER_FIELDS(ORDER);

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = ORDER,
                                         .stages = 1,
                                         .flags = HK_USES_SPARE,
                                         .method = &method,
                                         .step = hk_stoermer_step,
                                         .reset = hk_stoermer_reset,
                                         .growth = hk_stoermer_growth,
                                         .facets = hk_stoermer_facets};

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
