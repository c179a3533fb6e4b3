/* A viscous liquid in whole runs: a vortex decays as theory says, what is stiffer than pitch stands,
 * and places at random are evened by time, not by steps. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

typedef struct tank {
  test_engine e;
  hk_plugin_spec *liquid;
  size_t n;
} tank;

/* A plane box of 1 m by `top`, with cells of the size h, and liquid in its lower left corner. */
static void open_tank(tank *k, double h, double top, double width, double height, double viscosity) {
  uint64_t bits = 7;
  k->n = 0;
  test_engine_open(&k->e);
  k->e.options.integrator = "symplectic_euler";
  k->liquid = test_plugin(&k->e, HK_CORRECTOR, "liquid");
  test_vector(&k->e, k->liquid, "low", 0, 0, 0);
  test_vector(&k->e, k->liquid, "high", 1, 0, top);
  test_number(&k->e, k->liquid, "cell", h);
  test_number(&k->e, k->liquid, "viscosity", viscosity);
  for (int i = 0; i < (int)(2 * width / h + 0.5); i++)
    for (int j = 0; j < (int)(2 * height / h + 0.5); j++) {
      double at[2] = {i, j};
      for (int c = 0; c < 2; c++) {
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        at[c] = (at[c] + (double)(bits >> 11) * 0x1p-53) * h / 2;
      }
      test_particle(&k->e, at[0], 0, at[1], 1000 * h * h * h / 4), k->n++;
    }
}

static double vortex(const double x[3], int a) {
  return a == 0 ? sin(pi * x[0]) * cos(pi * x[2]) : -cos(pi * x[0]) * sin(pi * x[2]);
}

/* m/s, by least squares. */
static double amplitude(tank *k) {
  double sum = 0, norm = 0;
  for (uint32_t id = 1; id <= k->n; id++)
    for (int a = 0; a < 3; a += 2) {
      double mode = vortex(test_position(&k->e, id), a);
      sum += mode * test_velocity(&k->e, id)[a];
      norm += mode * mode;
    }
  return sum / norm;
}

/* exp(-2 pi^2 nu t), with nu = 0.05 m^2/s: e^-0.493. Implicit steps of 0.005 s are off by 0.25 % of the exponent, 16
 * cells by 0.3 %, and particles at random, of which gradients are not those of the mode, by some more: 2 %. */
static void a_vortex_decays_as_theory_says(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 1 / 16.0, 1, 1, 1, 50);
  test_text(&k.e, k.liquid, "walls", "free_slip");
  k.e.options.dt = 0.005;
  for (size_t i = 0; i < k.n; i++)
    for (int a = 0; a < 3; a += 2)
      k.e.scene->particles.velocity[3 * i + (size_t)a] = 0.01 * vortex(k.e.scene->particles.position + 3 * i, a);
  test_run(&k.e);
  test_advance(&k.e, 0.05); /* what the places of particles make uneven at first */
  double before = amplitude(&k);
  test_advance(&k.e, 0.5);
  double rate = log(before / amplitude(&k)) / 0.45, theory = 2 * pi * pi * 0.05;
  if (!(fabs(rate / theory - 1) < 0.02)) fail_msg("%.4f instead of %.4f 1/s", rate, theory);
  test_engine_close(&k.e);
}

/* Pitch of 1e8 Pa s: its own weight, 5 kPa, shears it by 5e-5 1/s. A column of water would be on the floor. */
static void what_is_stiff_stands(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.1, 1, 0.4, 0.8, 1e8);
  hk_plugin_spec *gravity = test_plugin(&k.e, HK_FORCE, "gravity");
  test_vector(&k.e, gravity, "g", 0, 0, -9.81);
  k.e.options.dt = 0.02;
  test_run(&k.e);
  double height[2] = {0};
  for (int t = 0; t < 2; t++) {
    for (uint32_t id = 1; id <= k.n; id++) height[t] += test_position(&k.e, id)[2] / (double)k.n;
    if (t == 0) test_advance(&k.e, 0.5);
  }
  if (!(fabs(height[1] / height[0] - 1) < 0.01)) fail_msg("%g m, then %g", height[0], height[1]);
  test_engine_close(&k.e);
}

/* m: how far particles go on the mean in 0.07 s in a full box at rest, where nothing but evening moves them. */
static double evened(double dt) {
  tank k;
  double sum = 0;
  open_tank(&k, 1 / 16.0, 1, 1, 1, 1000);
  hk_plugin_spec *gravity = test_plugin(&k.e, HK_FORCE, "gravity");
  test_vector(&k.e, gravity, "g", 0, 0, -9.81);
  k.e.options.dt = dt;
  test_run(&k.e);
  test_advance(&k.e, 0.07);
  for (uint32_t id = 1; id <= k.n; id++) {
    const double *x = test_position(&k.e, id), *start = k.e.scene->particles.position + 3 * (size_t)(id - 1);
    sum += hypot(x[0] - start[0], x[2] - start[2]);
  }
  test_engine_close(&k.e);
  return sum / (double)k.n;
}

/* A quarter is evened in the time in which a wave passes half a cell, 10 ms: with 10 steps it is 1 - (1 - 0.175)^10, of
 * what the grid sees as even, or 85 %, with 80 steps 1 - (1 - 0.0219)^80, or 83 %. By steps it would be 1 - 0.75^10 and
 * 1 - 0.75^80, or 94 and 100 %, and beyond that as many times more as the steps mix the particles. */
static void evening_goes_by_time(void **state) {
  (void)state;
  double few = evened(0.007), many = evened(0.000875);
  if (!(fabs(many / few - 1) < 0.05)) fail_msg("%g m in 10 steps, %g m in 80", few, many);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_vortex_decays_as_theory_says),
      cmocka_unit_test(what_is_stiff_stands),
      cmocka_unit_test(evening_goes_by_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
