/* Dormand and Prince's embedded pair of order 5(4), with its own choice of the step (embedded.h).
 *
 * For scenes of which nothing is known, as its error is its own choice, and as the reference of others. Where the step
 * is known others are cheaper: a curtain of 16 x 16 particles, 0.5 s to 1e-5 m, takes it 4,310 evaluations, rk4 2,400,
 * leapfrog 931 (hooke bench scripts/scenes/curtain.lua N=16 --until 0.5 --target 1e-5).
 */
#include "plugins/common/integrate/embedded.h"

static const hk_embedded pair = {
    .tableau = &hk_dormand_prince,
    .weight = {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
    .order = 5,
    .safety = 0.9,
    .least = 0.2,
    .most = 10,
    .beta = 0.04,
};

static const hk_field fields[] = HK_EMBEDDED_FIELDS(7);

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 5,
                                         .stages = 6,
                                         .flags = HK_ADAPTIVE,
                                         .method = &pair,
                                         .step = hk_embedded_step,
                                         .reset = hk_embedded_reset,
                                         .growth = hk_embedded_growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "dopri5",
    .summary =
        "Dormand and Prince's Runge-Kutta method of order 5 with an error estimate of order 4; chooses its steps, "
        "six evaluations each",
    .reference =
        "Dormand and Prince 1980, J. Comput. Appl. Math. 6; Hairer, Norsett and Wanner, Solving ODEs I, II.4-5",
    .instance_size = sizeof(hk_embedded_state),
    .fields = fields,
    .integrator = &integrator,
};
