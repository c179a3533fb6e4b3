/* Positions are those of Verlet's method; velocities are extrapolated with one difference more than order 2 needs,
 * whose coefficient is chosen for long steps. Stable while (h w)^2 + 2 h g <= 4, like `symplectic_euler` (order 1);
 * `leapfrog` is stable while (h w)^2 + 4 h g <= 4. At a damping ratio of 0.145, as in a curtain of 64 x 64 particles,
 * the stable step is 15 % longer than leapfrog's. Without damping the positions are those of leapfrog, but the error of
 * the velocities is larger, so leapfrog is the better choice. */
#include "plugins/common/integrate/stoermer.h"

enum { ORDER = 2, TERMS = 3 };

static const hk_stoermer_method method = {TERMS, {1, 0, 0}, {1, 1.0 / 2, -1.0 / 4}};

static const hk_field fields[] = {HK_STOERMER_FIELDS(TERMS)};

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_stoermer_amplification(&method, hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_stoermer_rotation(&method, hw, hg, hb);
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  (void)t_stop, (void)out;
  return hk_stoermer_step(self, &method, s, h);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = ORDER,
                                         .stages = 1,
                                         .flags = HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step,
                                         .reset = hk_stoermer_reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "stoermer_wide2",
    .summary = "Verlet's x' - 2x + x_before = h^2 a with velocities extrapolated for damped scenes; order 2, one "
               "evaluation a step",
    .reference =
        "Verlet 1967; Hairer, Norsett and Wanner, Solving ODEs I, (III.10.9); the third coefficient is hooke's "
        "own",
    .instance_size = sizeof(hk_stoermer),
    .fields = fields,
    .integrator = &integrator,
};
