/* Explicit Euler. The amplitude of an undamped oscillator grows by the factor sqrt(1 + h^2 w^2) per step.
 *
 * The first method of every textbook, to compare: a curtain of 8 x 8 particles, 0.2 s to 1e-3 m, takes it 22,224
 * evaluations, symplectic_euler 180, leapfrog 181 (hooke bench scripts/scenes/curtain.lua N=8 --until 0.2 --target
 * 1e-3).
 */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 1, .b = {1}};

static const hk_field fields[] = HK_RK_FIELDS(1);

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_USES_SPARE,
                                         .method = &tableau,
                                         .step = hk_rk_step,
                                         .growth = hk_rk_growth,
                                         .facets = HK_FACETS(HK_STAGES_FACET(.count = 1, .v_end = {1}))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "euler",
    .summary = "explicit Euler, X + h f(X); order 1, unstable without damping",
    .reference = "Euler 1768, Institutionum calculi integralis I, II.7",
    .instance_size = sizeof(hk_runge_kutta),
    .fields = fields,
    .integrator = &integrator,
};
