/* The speed of waves that a liquid's steps follow: that of shallow water where it has little viscosity, that of
 * creeping where it has much, and of layers the sum over those that flow. */
#include "plugins/common/liquid/liquid_pace.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIDE = 16, HIGH = 10 };

static const double g = 9.81, cell = 0.1, density = 800, depth = HIGH * 0.1 - 0.05; /* between the outermost rows */

typedef struct fixture {
  test_solver s;
  hk_liquid l;
  hk_liquid_particles p;
  hk_liquid_pace pace;
  uint32_t index[4 * SIDE * HIGH];
  double mass[4 * SIDE * HIGH], x[12 * SIDE * HIGH], v[12 * SIDE * HIGH], viscosity[4 * SIDE * HIGH];
} fixture;

/* A plane pool of `HIGH` cells, four particles a cell at rest. */
static fixture *open_pool(void) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  test_solver_open(&f->s, "pcg", 1);
  const hk_host *host = &f->s.solver->host;
  f->l = (hk_liquid){.host = host, .density = density};
  const double low[3] = {0}, high[3] = {SIDE * cell, 0, SIDE * cell};
  assert_int_equal(hk_liquid_grid_open(&f->l.grid, host, low, high, cell, 1e9), HK_OK);
  for (uint32_t i = 0; i < 4 * SIDE * HIGH; i++) {
    f->index[i] = i;
    f->mass[i] = density * cell * cell * cell / 4;
    f->x[3 * i] = (i % (2 * SIDE) + 0.5) * cell / 2;
    f->x[3 * i + 2] = (i / (2 * SIDE) + 0.5) * cell / 2;
  }
  f->p = (hk_liquid_particles){4 * SIDE * HIGH, f->index, f->mass, f->x, f->v, NULL, 0};
  f->pace = (hk_liquid_pace){.pull = {0, 0, -g}, .gain = INFINITY};
  f->pace.column = calloc(2 * hk_liquid_columns(&f->l.grid), sizeof(double));
  assert_non_null(f->pace.column);
  return f;
}

static void close_pool(fixture *f) {
  free(f->pace.column);
  hk_liquid_grid_free(&f->l.grid, f->l.host);
  test_solver_close(&f->s);
  free(f);
}

static double wave(fixture *f, hk_liquid_thickness t) { return hk_liquid_wave(&f->l, &f->pace, &f->p, t); }

/* Of each the same number as of all, but for the depth: a column's is that of its volume, half a row more. */
static void creeping_follows_the_viscosity(void **state) {
  (void)state;
  fixture *f = open_pool();
  const double plain = sqrt(g * depth), turn = sqrt(g * depth * depth * depth) / 2 * density; /* Pa s */
  assert_true(fabs(wave(f, (hk_liquid_thickness){0}) / plain - 1) < 1e-12);
  for (double mu = turn / 1024; mu < 1025 * turn; mu *= 4) {
    const double whole = depth + cell / 2, nu = mu / density;
    const double all = fmin(plain, g * depth * depth / (2 * nu));
    const double each = fmin(fmin(plain, sqrt(g * whole)), g * whole * whole / (2 * nu));
    for (int i = 0; i < 4 * SIDE * HIGH; i++) f->viscosity[i] = mu;
    if (!(fabs(wave(f, (hk_liquid_thickness){NULL, mu}) / all - 1) < 1e-12) ||
        !(fabs(wave(f, (hk_liquid_thickness){f->viscosity, 0}) / each - 1) < 1e-12))
      fail_msg("with %g Pa s: %g and %g m/s, expected %g and %g", mu, wave(f, (hk_liquid_thickness){NULL, mu}),
               wave(f, (hk_liquid_thickness){f->viscosity, 0}), all, each);
  }
  close_pool(f);
}

/* Three cells of melt on seven of a solid: waves are those of the three. */
static void melt_on_a_solid_is_shallow(void **state) {
  (void)state;
  fixture *f = open_pool();
  for (int i = 0; i < 4 * SIDE * HIGH; i++) f->viscosity[i] = f->x[3 * i + 2] > 0.7 ? 1e-3 : 1e8;
  assert_true(fabs(wave(f, (hk_liquid_thickness){f->viscosity, 0}) / sqrt(g * 0.3) - 1) < 1e-9);
  close_pool(f);
}

/* What stands on a floor and has a viscosity does not fall: its steps end with its creeping. */
static void what_stands_does_not_fall(void **state) {
  (void)state;
  fixture *f = open_pool();
  const double creep = 1e-3, courant = 0.5, falling = sqrt(courant * cell / g);
  assert_true(fabs(hk_liquid_longest_step(&f->l, &f->pace, &f->p, courant, 0, creep, true) / falling - 1) < 1e-12);
  hk_liquid_gain(&f->pace, &f->p, f->v, 0.01);
  assert_true(f->pace.gain == 0);
  assert_true(fabs(hk_liquid_longest_step(&f->l, &f->pace, &f->p, courant, 0, creep, false) / falling - 1) < 1e-12);
  double step = hk_liquid_longest_step(&f->l, &f->pace, &f->p, courant, 0, creep, true);
  assert_true(fabs(step / (courant * cell / creep) - 1) < 1e-12);
  close_pool(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(creeping_follows_the_viscosity),
      cmocka_unit_test(melt_on_a_solid_is_shallow),
      cmocka_unit_test(what_stands_does_not_fall),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
