/* Stoermer's multistep method of order 4: one evaluation per step, constant h, restarted by six-stage steps after
 * events. Stable up to h w = sqrt 2 without damping, and up to h k = 0.3 for decay at the rate k.
 *
 * For what is damped and is to be right to nine digits: a curtain of 16 x 16 particles, 0.5 s, each method with its
 * longest stable step: off by 1.3e-8 m with 1,455 evaluations; stoermer5 4.3e-10 with 2,030, stoermer_wide4 4.2e-8 with
 * 1,105, stoermer_wide3 1.3e-6 with 980, stoermer_wide2 6.1e-6 with 885, leapfrog 5.6e-6 with 931 (hooke bench
 * scripts/scenes/curtain.lua N=16 --until 0.5 --target 1e-5 --integrators ...).
 */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 4 };

static const hk_stoermer_method method = {ORDER, ORDER, {1, 0, 1.0 / 12, 1.0 / 12}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8}};

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
    .name = "stoermer",
    .summary = "Stoermer's explicit multistep method, x' - 2x + x_before = h^2 sum sigma_j D^j a, in summed form with "
               "Adams-Bashforth 4 for v; order 4, one evaluation a step",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9)",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
