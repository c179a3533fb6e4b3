/* Heun's method, the explicit trapezoidal rule. Unstable on undamped oscillators: growth sqrt(1 + (h w)^4/4).
 *
 * One of the textbook methods of order 2, to compare: on that curtain (dopri5.c) it takes 5,100 evaluations to 3.2e-6
 * m, as midpoint does, and leapfrog 931 to 5.6e-6.
 */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 2, .c = {0, 1}, .a = {{0}, {1}}, .b = {0.5, 0.5}};

static const hk_field fields[] = HK_RK_FIELDS(2);

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 2,
                                         .flags = HK_USES_SPARE,
                                         .method = &tableau,
                                         .step = hk_rk_step,
                                         .growth = hk_rk_growth,
                                         .facets = HK_FACETS(HK_STAGES_FACET(.count = 2, .c = {0, 1}, .v = {{0}, {1}},
                                                                             .x_end = {0.5}, .v_end = {0.5, 0.5}))};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "trapezoid",
    .summary = "Heun's explicit trapezoidal rule, X + h/2 (f(X) + f(X + h f(X))); order 2",
    .reference = "Heun 1900, Z. Math. Phys. 45",
    .instance_size = sizeof(hk_runge_kutta),
    .fields = fields,
    .integrator = &integrator,
};
