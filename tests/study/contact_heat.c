/* What a step does to the energy of contacts that open and close: why symplectic methods are granted 0.45 of the step
 * of what always touches (core/numerics/stability/largest_step.c), and grains no more though most have one contact at a
 * time. First a particle that falls onto a spring without loss, by leapfrog, for steps h w; then a gas of 40 smooth
 * grains without loss in a periodic box, 50 s of it, for parts of the stated step. Linear theory allows h w = 2.
 *
 * The gas keeps its energy to a tenth up to the stated step (h w = 0.4 of a pair), and has 4 times as much at 1.8 of
 * it. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

enum { GRAINS = 40 };
static const double R = 0.1, K = 1000, MASS = 0.01; /* m, N/m, kg */

/* The largest energy in 2 10^5 steps of h w, over that at the start, of falls from 10 and 100 times the depth at which
 * the spring carries the weight. */
static double heated(double hw) {
  double most = 0;
  for (double height = 10; height < 200; height *= 10) {
    double x = height, v = 0.05, a = -1, start = 0.5 * v * v + x;
    for (int k = 0; k < 200000; k++) {
      v += hw / 2 * a;
      x += hw * v;
      a = -1 - fmin(0, x);
      v += hw / 2 * a;
      most = fmax(most, (0.5 * v * v + x + (x < 0 ? x * x / 2 : 0)) / start);
    }
  }
  return most;
}

static double kinetic_energy(test_engine *e) {
  double sum = 0;
  for (uint32_t id = 1; id <= GRAINS; id++)
    for (int c = 0; c < 3; c++) sum += MASS / 2 * test_velocity(e, id)[c] * test_velocity(e, id)[c];
  return sum;
}

/* dt, s; NAN: chosen. */
static void open_gas(test_engine *e, double dt) {
  test_engine_open(e);
  for (int i = 0; i < GRAINS; i++) {
    uint32_t id = test_particle(e, 0.23 * (i % 4), 0.23 * (i / 4 % 4), 0.3 + 0.23 * (i / 16), MASS);
    double *v = e->scene->particles.velocity + 3 * (id - 1);
    v[0] = sin(i), v[1] = cos(3 * i), v[2] = sin(7 * i);
  }
  assert_int_equal(hk_scene_set_box(e->scene, (const double[]){0, 0, 0}, (const double[]){1, 1, 1}, "xyz", &e->error),
                   HK_OK);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "soft_spheres");
  test_number(e, s, "radius", R);
  test_number(e, s, "stiffness", K);
  test_number(e, s, "restitution", 1);
  test_number(e, s, "friction", 0);
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  e->options.dt = dt;
  e->scene->fps = 20, e->scene->duration = 51;
  test_run(e);
}

static double heated_gas(double dt) {
  test_engine e;
  open_gas(&e, dt);
  double before = kinetic_energy(&e);
  test_advance(&e, 50);
  double after = kinetic_energy(&e);
  test_engine_close(&e);
  return after / before;
}

int main(void) {
  static const double part[] = {0.5, 1, 1.4, 1.8, 2.7};
  test_engine e;
  for (double hw = 0.3; hw < 1.95; hw += 0.2) printf("one contact, h w = %.1f: %.3g\n", hw, heated(hw));
  open_gas(&e, NAN);
  double limit = e.run->step->dt_limit;
  test_engine_close(&e);
  for (size_t k = 0; k < sizeof part / sizeof *part; k++)
    printf("gas, %.1f of the stated %.3g s, h w = %.2f of a pair: %.3g\n", part[k], limit,
           part[k] * limit * sqrt(2 * K / MASS), heated_gas(part[k] * limit));
  return 0;
}
