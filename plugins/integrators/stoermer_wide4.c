/* Stoermer's multistep method of order 4 with two more differences. Their coefficients are not those of the series
 * (order 6) but those that keep the longest steps stable among those whose limit is everywhere a root of -1, found by a
 * search over oscillators of damping ratio 0 to 1. Stable while 1.456 (h w)^2 + 3.4133 h g <= 4; `stoermer` is stable
 * while 2 (h w)^2 + 13.33 h g <= 4. Its error at the same step is 1.1 times that of `stoermer` for forces that do not
 * depend on the velocity, 2.9 times for those that do.
 *
 * On a curtain of 32 x 32 particles an error of 1e-7 m takes 2,380 evaluations (`stoermer`: 2,911, at its limit of
 * stability), on one of 64 x 64 it takes 4,400 (`stoermer`: 7,900). */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 4, TERMS = 6 };

static const hk_stoermer_method method = {
    ORDER, TERMS, {1, 0, 1.0 / 12, 1.0 / 12, -0.004, -0.015}, {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, -0.67, 0.18}};

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
    .name = "stoermer_wide4",
    .summary = "Stoermer's explicit multistep method with two more differences that widen the range of stable steps; "
               "order 4, one evaluation a step",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9); the last two coefficients are "
                 "hooke's own",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
