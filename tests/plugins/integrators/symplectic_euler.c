/* Symplectic Euler with constraints: a free top and a pendulum for long. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double moment[3] = {1.5, 2, 3}, spin[3] = {0.5, 2, 0.5}; /* kg m^2, 1/s */

/* Four particles of a quarter of a kilogram with these moments, on six bars. */
static void add_top(test_engine *e) {
  static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  static const uint32_t edge[6][2] = {{1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  for (int k = 0; k < 4; k++) {
    double x[3], *v = NULL;
    for (int c = 0; c < 3; c++) x[c] = corner[k][c] * sqrt((moment[(c + 1) % 3] + moment[(c + 2) % 3] - moment[c]) / 2);
    uint32_t id = test_particle(e, x[0], x[1], x[2], 0.25);
    v = e->scene->particles.velocity + 3 * (id - 1);
    for (int c = 0; c < 3; c++) v[c] = spin[(c + 1) % 3] * x[(c + 2) % 3] - spin[(c + 2) % 3] * x[(c + 1) % 3];
  }
  hk_plugin_spec *bar = test_plugin(e, HK_CONSTRAINT, "fixture:bar");
  test_edges(e, bar, edge, 6);
  test_number(e, bar, "copies", 1);
}

/* J, and kg m^2/s. */
static double energy_and_momentum(test_engine *e, double L[3]) {
  const hk_view *view = hk_run_view(e->run);
  double energy = 0;
  memset(L, 0, 3 * sizeof *L);
  for (size_t i = 0; i < view->n; i++) {
    const double *x = view->x + 3 * i, *v = view->v + 3 * i, m = view->model->mass[i];
    for (int c = 0; c < 3; c++) {
      energy += m * v[c] * v[c] / 2;
      L[c] += m * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
    }
  }
  return energy;
}

static void open_scene(test_engine *e, double dt, double duration) {
  test_engine_open(e);
  e->options.integrator = "symplectic_euler";
  e->options.dt = dt;
  e->scene->fps = 1;
  e->scene->duration = duration;
}

/* A step keeps the angular momentum, of which 1e4 roundings of 1e-16 are 1e-12. Between places on the constraints it is
 * RATTLE without forces, which keeps the energy of a free top to (h w)^2; 3 (0.01 2)^2 = 1.2e-3 bounds what it is off
 * by on the way. Where only x was brought onto the bars the top got 1,600 times its energy. */
static void a_free_top_keeps_energy_and_momentum(void **state) {
  (void)state;
  test_engine e;
  double L[3], now[3], first, worst = 0;
  open_scene(&e, 0.01, 100);
  add_top(&e);
  test_run(&e);
  first = energy_and_momentum(&e, L);
  for (int k = 1; k <= 20; k++) {
    test_advance(&e, 5.0 * k);
    worst = fmax(worst, fabs(energy_and_momentum(&e, now) / first - 1));
    for (int c = 0; c < 3; c++)
      if (!(fabs(now[c] - L[c]) < 1e-12 * moment[1] * spin[1])) fail_msg("the momentum is off by %g", now[c] - L[c]);
  }
  if (!(worst < 1.2e-3)) fail_msg("the energy is off by %g of itself", worst);
  test_engine_close(&e);
}

/* The energy of order 1, off by up to h |F.v|/2 = 0.005 9.81 4.4 < 0.22 J of the 9.81 J that it is exchanging, is so
 * after 70 swings as well. */
static void a_pendulum_keeps_its_swing(void **state) {
  (void)state;
  test_engine e;
  double most[2] = {0};
  open_scene(&e, 0.01, 200);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  hk_plugin_spec *bar = test_plugin(&e, HK_CONSTRAINT, "fixture:bar");
  test_edges(&e, bar, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, bar, "copies", 1);
  test_run(&e);
  for (int k = 1; k <= 2000; k++) {
    test_advance(&e, 0.1 * k);
    const hk_view *view = hk_run_view(e.run);
    const double *x = view->x + 3, *v = view->v + 3;
    double energy = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + 9.81 * x[2];
    most[k > 1000] = fmax(most[k > 1000], fabs(energy));
  }
  if (!(most[0] < 0.22 && most[1] < 1.02 * most[0])) fail_msg("off by %g J, then by %g J", most[0], most[1]);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_top_keeps_energy_and_momentum),
      cmocka_unit_test(a_pendulum_keeps_its_swing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
