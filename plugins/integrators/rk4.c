/* The classical Runge-Kutta method. Stable up to h w = 2 sqrt 2 (oscillators), h k = 2.785 (decay at rate k). */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 4,
                                   .c = {0, 0.5, 0.5, 1},
                                   .a = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}},
                                   .b = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}};

typedef struct rk4 {
  double *k; /* slopes and the state of a stage */
} rk4;

static const hk_field fields[] = {
    {"stages", HK_FIELD_STATE, 4 + 1, offsetof(rk4, k), HK_SCRATCH},
    {0},
};

static double amplification(const void *self, double hw, double hg) {
  (void)self;
  return hk_rk_amplification(&tableau, hw, hg);
}

static double rotation(const void *self, double hw, double hg, double hb) {
  (void)self;
  return hk_rk_rotation(&tableau, hw, hg, hb);
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  const rk4 *m = self;
  (void)t_stop, (void)out;
  return hk_rk_step(&tableau, s, h, m->k);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 4,
                                         .stages = 4,
                                         .flags = HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "rk4",
    .summary = "the classical Runge-Kutta method, X + h/6 (k1 + 2 k2 + 2 k3 + k4); order 4",
    .reference = "Kutta 1901, Z. Math. Phys. 46; Hairer, Norsett and Wanner, Solving ODEs I, table II.1.2",
    .instance_size = sizeof(rk4),
    .fields = fields,
    .integrator = &integrator,
};
