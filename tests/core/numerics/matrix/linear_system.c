/* Which solver a run takes by itself: one for matrices of a kind where it fits the pattern, another where it does not,
 * and again the first when the pattern changes back. */
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/implicit/implicit.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 40, N = SIDE * SIDE, LARGE_SIDE = 317 /* 301,467 unknowns */ };

/* `side` strands of `side` particles, side by side, or the same particles as a grid. */
static void open_sized(test_engine *e, const char *integrator, bool grid, uint32_t side) {
  uint32_t(*edge)[2] = malloc(2 * (size_t)side * side * sizeof *edge);
  size_t count = 0;
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, integrator);
  for (uint32_t i = 0; i < side * side; i++) {
    test_particle(e, i % side, i / side, 0, 1);
    if (i % side) edge[count][0] = i, edge[count++][1] = i + 1;
    if (grid && i >= side) edge[count][0] = i + 1 - side, edge[count++][1] = i + 1;
  }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, count);
  test_number(e, springs, "k", 300);
  e->options.dt = 1e-2;
  free(edge);
}

static void open(test_engine *e, const char *integrator, bool grid) { open_sized(e, integrator, grid, SIDE); }

static const char *in_use(const test_engine *e) { return hk_solver_in_use(&e->run->dynamics)->plugin->name; }

static void strands_have_the_solver_for_bands_and_cloth_another(void **state) {
  (void)state;
  test_engine e;
  for (int grid = 0; grid < 2; grid++) {
    open(&e, "backward_euler", grid);
    test_run(&e);
    assert_int_equal(hk_run_advance(e.run, 0.1, &e.error), HK_OK);
    assert_string_equal(in_use(&e), grid ? "supernodal" : "banded");
    test_engine_close(&e);
  }
}

/* No factor of so many unknowns is worth its memory; strands of any number have theirs. */
static void surfaces_of_many_unknowns_have_multigrid(void **state) {
  (void)state;
  test_engine e;
  for (int grid = 0; grid < 2; grid++) {
    open_sized(&e, "backward_euler", grid, LARGE_SIDE);
    test_run(&e);
    assert_string_equal(in_use(&e), grid ? "multigrid" : "banded");
    test_engine_close(&e);
  }
}

static void a_named_solver_is_kept(void **state) {
  (void)state;
  test_engine e;
  open(&e, "backward_euler", false);
  e.options.solver = "cholmod";
  test_run(&e);
  assert_null(e.run->dynamics.special);
  assert_int_equal(hk_run_advance(e.run, 0.1, &e.error), HK_OK);
  assert_string_equal(in_use(&e), "cholmod");
  test_engine_close(&e);
}

/* The flags are asked for before the first assembly; the other solver is not even opened. */
static void methods_hear_of_the_solver_that_will_solve(void **state) {
  (void)state;
  test_engine e;
  for (int grid = 0; grid < 2; grid++) {
    open(&e, "backward_euler", grid);
    test_run(&e);
    assert_string_equal(in_use(&e), grid ? "supernodal" : "banded");
    assert_int_equal(e.run->dynamics.count.factorizations, 0);
    assert_int_equal(e.run->dynamics.solver != NULL, grid);
    test_engine_close(&e);
  }
}

static void bars_of_a_chain_have_it_whatever_the_forces(void **state) {
  (void)state;
  test_engine e;
  open(&e, "leapfrog", true);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3);
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 0.01, &e.error), HK_OK);
  assert_string_equal(in_use(&e), "banded");
  test_engine_close(&e);
}

/* Ring, full matrix, ring: three patterns of one system. */
static void every_new_pattern_decides_anew(void **state) {
  (void)state;
  static const char *const expected[] = {"banded", "supernodal", "banded"};
  enum { ROWS = 40 };
  double b[ROWS], x[ROWS];
  test_engine e;
  test_solver s;
  open(&e, "backward_euler", false);
  test_run(&e);
  test_solver_open(&s, "cholmod", 1);
  hk_linear_system linear = {.any = e.run->dynamics.solver, .special = e.run->dynamics.special};
  for (int k = 0; k < 3; k++) {
    test_matrix_begin(&s, ROWS);
    for (size_t i = 0; i < ROWS; i++)
      for (size_t j = i + 1; j < (k == 1 ? ROWS : i + 2); j++) test_matrix_pair(&s, i, j % ROWS);
    test_matrix_end(&s, 1);
    test_matrix_fill(&s, 0.5);
    for (size_t i = 0; i < ROWS; i++) b[i] = test_noise();
    assert_int_equal(hk_linear_system_factorize(&e.run->dynamics, &linear, &s.A), HK_OK);
    assert_string_equal(linear.solver->plugin->name, expected[k]);
    assert_int_equal(hk_linear_system_solve(&e.run->dynamics, &linear, b, x, NULL), HK_OK);
    assert_true(test_matrix_residual(&s.A, b, x) < 1e-14);
  }
  test_solver_close(&s);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(strands_have_the_solver_for_bands_and_cloth_another),
      cmocka_unit_test(surfaces_of_many_unknowns_have_multigrid),
      cmocka_unit_test(a_named_solver_is_kept),
      cmocka_unit_test(methods_hear_of_the_solver_that_will_solve),
      cmocka_unit_test(bars_of_a_chain_have_it_whatever_the_forces),
      cmocka_unit_test(every_new_pattern_decides_anew),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
