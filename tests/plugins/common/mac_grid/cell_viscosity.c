/* The viscosity of cells: geometric means of their particles, neighbours' where a cell is empty, harmonic means
 * between. */
#include "plugins/common/liquid/liquid.h"
#include "plugins/common/mac_grid/cell_viscosity.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { COUNT = 4, CELLS = 4 };

/* A plane box of 4 x 4 cells of 1 m; the place of a cell in arrays. */
static size_t cell_at(const hk_liquid_grid *g, size_t i, size_t k) {
  return (i + 1) * g->stride[0] + g->stride[1] + (k + 1) * g->stride[2];
}

static void cells_have_means_of_their_particles(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "pcg", 1);
  const hk_host *host = &s.solver->host;
  hk_liquid l = {.density = 1000};
  assert_int_equal(hk_liquid_grid_open(&l.grid, host, (double[]){0, 0, 0}, (double[]){CELLS, 0, CELLS}, 1, 1e9), HK_OK);
  assert_int_equal(hk_liquid_open(&l, host, COUNT), HK_OK);
  /* two in the first cell, one beside it and one without a viscosity yet, in the second cell of the next layer */
  double x[3 * COUNT] = {0.5, 0, 0.5, 0.6, 0, 0.4, 1.5, 0, 0.5, 1.5, 0, 1.5}, v[3 * COUNT] = {0};
  const double mass[COUNT] = {1, 1, 1, 1}, viscosity[COUNT] = {1e-3, 1e5, 10, 0};
  const uint32_t index[COUNT] = {0, 1, 2, 3};
  const hk_liquid_particles p = {.count = COUNT, .index = index, .mass = mass, .x = x, .v = v};
  double *cell = calloc(l.grid.size, sizeof *cell);
  assert_non_null(cell);
  hk_liquid_sort(&l, &p);
  hk_cell_viscosity(&l.grid, host, &(hk_cell_particles){l.start, l.sorted, index}, viscosity, cell);
  assert_true(fabs(cell[cell_at(&l.grid, 0, 0)] / 10 - 1) < 1e-12); /* sqrt(1e-3 1e5) */
  assert_true(fabs(cell[cell_at(&l.grid, 1, 0)] / 10 - 1) < 1e-12);
  assert_true(fabs(cell[cell_at(&l.grid, 0, 1)] / 10 - 1) < 1e-12); /* from the one below; that beside it has none */
  assert_true(cell[cell_at(&l.grid, 1, 1)] == 0 && cell[cell_at(&l.grid, 3, 3)] == 0);
  free(cell);
  hk_liquid_close(&l);
  test_solver_close(&s);
}

static void layers_are_sheared_by_harmonic_means(void **state) {
  (void)state;
  const double cell[4] = {1, 3, 0, 1};
  assert_true(fabs(hk_viscosity_between(cell, (size_t[]){0, 1, 2, 3}, 4) - 9.0 / 7) < 1e-15);
  assert_true(hk_viscosity_between(cell, (size_t[]){2, 2}, 2) == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cells_have_means_of_their_particles),
      cmocka_unit_test(layers_are_sheared_by_harmonic_means),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
