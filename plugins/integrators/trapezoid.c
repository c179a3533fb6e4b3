/* Heun's method, the explicit trapezoidal rule. Unstable on undamped oscillators: growth sqrt(1 + (h w)^4/4). */
#include "plugins/common/integrate/runge_kutta.h"

static const hk_tableau tableau = {.stages = 2, .c = {0, 1}, .a = {{0}, {1}}, .b = {0.5, 0.5}};

typedef struct trapezoid {
  double *k; /* slopes and the state of a stage */
} trapezoid;

static const hk_field fields[] = {
    {"stages", HK_FIELD_STATE, 2 + 1, offsetof(trapezoid, k), HK_SCRATCH},
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
  const trapezoid *m = self;
  (void)t_stop, (void)out;
  return hk_rk_step(&tableau, s, h, m->k);
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 2,
                                         .stages = 2,
                                         .flags = HK_USES_SPARE,
                                         .amplification = amplification,
                                         .rotation = rotation,
                                         .step = step};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "trapezoid",
    .summary = "Heun's explicit trapezoidal rule, X + h/2 (f(X) + f(X + h f(X))); order 2",
    .reference = "Heun 1900, Z. Math. Phys. 45",
    .instance_size = sizeof(trapezoid),
    .fields = fields,
    .integrator = &integrator,
};
