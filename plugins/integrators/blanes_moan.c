/* Blanes and Moan's splitting SRKN(6, 4): six evaluations a step, order 4 for forces F(x, t) (splitting.h).
 *
 * Its place is undamped motion over long times, kahan_li8.c has the figures; with damping it has order 2 (rk4.c).
 */
#include "plugins/common/integrate/splitting.h"

/* b_1 a_1 b_2 ... a_6 b_7, Blanes and Moan 2002, table 3, SRKN_6^b. */
#define A1 0.245298957184271
#define A2 0.604872665711080
#define B1 0.0829844064174052
#define B2 0.396309801498368
#define B3 -0.0390563049223486
/* McLachlan 1995, SIAM J. Sci. Comput. 16, table 2: five leapfrog steps, for constraints, whose free motion is no drift
 * of one stage; they are stable up to h w = 3.02, the list above to 3.16. Suzuki's five end at 2.72, which is below
 * nine tenths of the latter, the step that a run chooses. */
#define G1 0.28
#define G2 0.62546642846767004501
static const hk_splitting_method method = {6,
                                           {B1, B2, B3, 1 - 2 * (B1 + B2 + B3), B3, B2, B1},
                                           {A1, A2, 0.5 - (A1 + A2), 0.5 - (A1 + A2), A2, A1},
                                           5,
                                           {G1, G2, 1 - 2 * (G1 + G2), G2, G1}};

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 4,
                                         .stages = 6,
                                         .flags = HK_SYMPLECTIC | HK_REVERSIBLE | HK_USES_SPARE,
                                         .method = &method,
                                         .step = hk_splitting_step,
                                         .reset = hk_splitting_reset,
                                         .growth = hk_splitting_growth,
                                         .facets = hk_splitting_facets};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "blanes_moan",
    .summary =
        "Runge-Kutta-Nystroem splitting of kicks v += b h a and drifts x += a h v, six evaluations a step; order "
        "4 for forces F(x, t), 2 in what depends on the velocity",
    .reference = "Blanes and Moan 2002, J. Comput. Appl. Math. 142, table 3, SRKN_6^b",
    .instance_size = sizeof(hk_splitting),
    .fields = hk_splitting_fields,
    .integrator = &integrator,
};
