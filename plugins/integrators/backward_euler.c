/* Backward Euler, X' = X + h f(t + h, X'), solved by Newton's method to its tolerance. Order 1; it damps fast motion:
 * |R| = (1 + (h w)^2)^(-1/2) on an undamped oscillator.
 *
 * Where motion is to be damped rather than right: cloth of 8 x 8 particles to 1e-2 m takes it 138 evaluations and 33
 * factorizations, baraff_witkin, which solves once a step, 38 and 38, bdf2 101 and 21 for a fifth of the error,
 * linear_bdf2 51 and 24 (hooke bench scripts/scenes/stiff_cloth.lua N=8 k=1e6 --until 0.15 --target 1e-2).
 */
#include "plugins/common/implicit/dirk.h"

static const hk_dirk_tableau tableau = {.stages = 1, .c = {1}, .a = {{1}}, .b = {1}};

static const hk_integrator integrator = {
    .size = sizeof(hk_integrator),
    .order = 1,
    .stages = 1,
    .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN,
    .method = &tableau,
    .step = hk_dirk_step,
    .reset = hk_dirk_reset,
    .growth = hk_dirk_growth,
    .facets = HK_FACETS(HK_STAGES_FACET(.count = 1, .c = {1}, .x = {{1}}, .v = {{1}}, .x_end = {1}, .v_end = {1}))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "backward_euler",
    .summary = "backward Euler, x' = x + h v', v' = v + h a(x', v'), by Newton's method; order 1, damps what is stiff",
    .reference = "Hairer and Wanner, Solving ODEs II, IV.3; Baraff and Witkin 1998 take one iteration of it",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
