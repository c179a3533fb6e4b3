/* The implicit midpoint rule, X' = X + h f(t + h/2, (X + X')/2): order 2, symplectic, reversible; it conserves momenta
 * and quadratic invariants. It damps nothing, so stiff motion that the step does not resolve continues to oscillate, at
 * the wrong frequency (2/h) atan(h w/2).
 *
 * Beside implicit_trapezoid it keeps quadratic invariants, and its error is 0.6 times as large for as many evaluations,
 * 491 and 493 (the command is in esdirk4.c).
 */
#include "plugins/common/implicit/dirk.h"

static const hk_dirk_tableau tableau = {.stages = 1, .c = {0.5}, .a = {{0.5}}, .b = {1}};

static const hk_integrator integrator = {
    .size = sizeof(hk_integrator),
    .order = 2,
    .stages = 1,
    .flags = HK_LIMITS_MOVES | HK_IMPLICIT | HK_NEEDS_JACOBIAN | HK_SYMPLECTIC | HK_REVERSIBLE,
    .method = &tableau,
    .step = hk_dirk_step,
    .reset = hk_dirk_reset,
    .growth = hk_dirk_growth,
    .facets =
        HK_FACETS(HK_STAGES_FACET(.count = 1, .c = {0.5}, .x = {{0.25}}, .v = {{0.5}}, .x_end = {0.5}, .v_end = {1}))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "implicit_midpoint",
    .summary = "implicit midpoint rule, X' = X + h f((X + X')/2); order 2, symplectic, damps nothing",
    .reference = "Hairer, Lubich and Wanner, Geometric Numerical Integration, II.1 and VI.4",
    .instance_size = sizeof(hk_dirk),
    .params = hk_dirk_params,
    .fields = hk_dirk_fields,
    .create = hk_newton_create,
    .destroy = hk_newton_destroy,
    .topology = hk_newton_topology,
    .integrator = &integrator,
};
