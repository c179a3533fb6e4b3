/* Stoermer's multistep method of order 8: one evaluation per step, constant h, restarted by extrapolated steps after
 * events. It is meant for orbits and other undamped motion to many digits: stable up to h w = 0.459 without damping,
 * and for decay at the rate k up to h k = 0.0244 only. The error at the same number of evaluations is far below that of
 * the compositions of order 6 and 8, which take 9 and 17 of them a step; they keep the energy over longer times than it
 * does.
 *
 * The outer planets for 20,000 days to 1e-9 of the earth's distance: 712 evaluations, kahan_li8 3,401, blanes_moan
 * 4,801, stoermer5 4,820, dopri5 7,712 (hooke bench scripts/scenes/solar.lua duration=20000 --target 1e-9).
 */
#include "plugins/common/multistep/stoermer.h"

enum { ORDER = 8 };

static const hk_stoermer_method method = {
    ORDER,
    ORDER,
    {1, 0, 1.0 / 12, 1.0 / 12, 19.0 / 240, 3.0 / 40, 863.0 / 12096, 275.0 / 4032},
    {1, 1.0 / 2, 5.0 / 12, 3.0 / 8, 251.0 / 720, 95.0 / 288, 19087.0 / 60480, 5257.0 / 17280}};

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
    .name = "stoermer8",
    .summary = "Stoermer's explicit multistep method, x' - 2x + x_before = h^2 sum sigma_j D^j a, in summed form with "
               "Adams-Bashforth 8 for v; order 8, one evaluation a step; for orbits and undamped motion",
    .reference = "Stoermer 1907; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9)",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
