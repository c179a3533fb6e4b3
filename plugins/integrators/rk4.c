/* The classical Runge-Kutta method. Stable up to h w = 2 sqrt 2 (oscillators), h k = 2.785 (decay at rate k).
 *
 * For forces that depend on velocities, to six digits and more: on that curtain (dopri5.c) 2,400 evaluations for 4e-7
 * m, midpoint 5,100 for 3.4e-6, blanes_moan 1,981 for 7e-7, which is order 2 there, leapfrog 931 for 5.6e-6.
 */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 4,
                                   .c = {0, 0.5, 0.5, 1},
                                   .a = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}},
                                   .b = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}};

static const hk_field fields[] = HK_RK_FIELDS(4);

static const hk_integrator integrator = {
    .size = sizeof(hk_integrator),
    .order = 4,
    .stages = 4,
    .flags = HK_USES_SPARE,
    .method = &tableau,
    .step = hk_rk_step,
    .growth = hk_rk_growth,
    .facets = HK_FACETS(HK_STAGES_FACET(.count = 4, .c = {0, 0.5, 0.5, 1}, .x = {{0}, {0}, {0.25}, {0, 0.5}},
                                        .v = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}}, .x_end = {1.0 / 6, 1.0 / 6, 1.0 / 6},
                                        .v_end = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "rk4",
    .summary = "the classical Runge-Kutta method, X + h/6 (k1 + 2 k2 + 2 k3 + k4); order 4",
    .reference = "Kutta 1901, Z. Math. Phys. 46; Hairer, Norsett and Wanner, Solving ODEs I, table II.1.2",
    .instance_size = sizeof(hk_runge_kutta),
    .fields = fields,
    .integrator = &integrator,
};
