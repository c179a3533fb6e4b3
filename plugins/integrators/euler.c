/* Explicit Euler. The amplitude of an undamped oscillator grows by the factor sqrt(1 + h^2 w^2) per step. */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 1, .b = {1}};

typedef struct euler {
  double *k; /* slopes and the state of a stage */
} euler;

static const hk_field fields[] = {
    {"stages", HK_FIELD_STATE, 1 + 1, offsetof(euler, k), HK_SCRATCH},
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
  const euler *m = self;
  (void)t_stop, (void)out;
  return hk_rk_step(&tableau, s, h, m->k);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 1,
                                         .stages = 1,
                                         .flags = HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "euler",
    .summary = "explicit Euler, X + h f(X); order 1, unstable without damping",
    .reference = "Euler 1768, Institutionum calculi integralis I, II.7",
    .instance_size = sizeof(euler),
    .fields = fields,
    .integrator = &integrator,
};
