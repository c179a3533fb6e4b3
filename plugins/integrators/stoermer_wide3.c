/* Stoermer's multistep method of order 3 with two more differences, whose coefficients keep the longest steps stable,
 * found by a search over oscillators of damping ratio 0 to 1. Stable while 1.1733 (h w)^2 + 2.2133 h g <= 4, where a
 * root reaches -1. Its errors are about a fifth of those of `stoermer_wide2` at nearly the same step: where the limit
 * of stability sets the step of either, it is the more accurate one.
 *
 * On a curtain of 16 x 16 particles 1.3e-6 m with 980 evaluations, stoermer_wide2 6.1e-6 m with 885; to 1e-7 m in 0.2 s
 * it takes 404, where those of order 2 take 1,407 and 1,489 (stoermer.c; --until 0.2 --target 1e-7).
 */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 3, TERMS = 5 };

static const hk_stoermer_method method = {
    ORDER, TERMS, {1, 0, 1.0 / 12, 0, -0.01}, {1, 1.0 / 2, 5.0 / 12, -0.66, 0.17}};

static const hk_field fields[] = HK_STOERMER_FIELDS(TERMS);

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
    .name = "stoermer_wide3",
    .summary = "Stoermer's explicit multistep method with two more differences that widen the range of stable steps; "
               "order 3, one evaluation a step",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9); the last two coefficients are "
                 "hooke's own",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
