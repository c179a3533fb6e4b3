/* Linear systems that a force solves by "solvers/1": against closed forms, beside an implicit method that has a solver
 * of its own, with every solver, the same bits for any number of threads; and what is said of matrices that have no
 * solution. The force is tests/fixtures/screened.c. */
#include "core/numerics/matrix/matrix.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 24, MODE = 5 };

static const double pi = 3.14159265358979323846, k = 40, a = 0.7, end = 1;

static void near(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance)) fail_msg("%.17g instead of %.17g", found, wanted);
}

/* Component MODE of a chain with free ends: (L x)_i = mu x_i, mu = 2 - 2 cos(pi MODE / N). */
static double shape(uint32_t i) { return cos(pi * MODE * (i + 0.5) / N); }
static double eigenvalue(void) { return 2 - 2 * cos(pi * MODE / N); }

/* The chain, displaced along z by that mode, and the force on it. */
static hk_plugin_spec *open(test_engine *e, const char *integrator, int block, const char *solver, double g) {
  uint32_t edge[N - 1][2];
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, integrator);
  for (uint32_t i = 0; i < N; i++) {
    test_particle(e, 0, 0, shape(i), 2);
    if (i) edge[i - 1][0] = i, edge[i - 1][1] = i + 1;
  }
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "fixture:screened");
  test_edges(e, force, (const uint32_t(*)[2])edge, N - 1);
  test_number(e, force, "k", k);
  test_number(e, force, "a", a);
  test_number(e, force, "g", g);
  test_number(e, force, "block", block);
  if (solver) test_text(e, force, "solver", solver);
  e->options.dt = 1e-2;
  e->scene->fps = 10;
  return force;
}

/* w h = 2 sin(t / 2) for leapfrog, 2 tan(t / 2) for the midpoint: both keep the mode and turn it by t a step. */
static void swings(test_engine *e, double w, bool implicit, double tolerance) {
  double h = 1e-2, turn = implicit ? 2 * atan(w * h / 2) : 2 * asin(w * h / 2);
  test_run(e);
  test_advance(e, end);
  for (uint32_t i = 0; i < N; i++) near(test_position(e, i + 1)[2], shape(i) * cos(turn * end / h), tolerance);
}

/* Tolerance: a hundred steps of some roundings, and what an iteration leaves. */
static void every_solver_gives_the_frequency_of_the_mode(void **state) {
  (void)state;
  static const char *const solvers[] = {NULL, "banded", "supernodal", "cholmod", "umfpack", "pcg", "multigrid"};
  for (size_t s = 0; s < sizeof solvers / sizeof *solvers; s++)
    for (int block = 1; block <= 3; block += 2) {
      test_engine e;
      open(&e, "leapfrog", block, solvers[s], 1.5);
      swings(&e, sqrt(k / (1.5 + a * eigenvalue()) / 2), false, solvers[s] && s > 4 ? 1e-6 : 1e-12);
      test_engine_close(&e);
    }
}

/* Springs without a rest length add ks L: the method has a matrix of its own, of another pattern, with the same solver.
 * The force's blocks are too stiff, so Newton's iteration ends by its tolerance. */
static void an_implicit_method_has_its_own_solver_beside_it(void **state) {
  (void)state;
  static const char *const solvers[] = {NULL, "cholmod", "supernodal", "umfpack"};
  for (size_t s = 0; s < sizeof solvers / sizeof *solvers; s++) {
    test_engine e;
    uint32_t edge[N - 1][2];
    open(&e, "implicit_midpoint", 3, solvers[s], 1.5);
    for (uint32_t i = 1; i < N; i++) edge[i - 1][0] = i, edge[i - 1][1] = i + 1;
    hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
    test_edges(&e, springs, (const uint32_t(*)[2])edge, N - 1);
    test_number(&e, springs, "k", 30);
    test_number(&e, springs, "rest", 0);
    e.options.solver = solvers[s];
    e.options.tol = 1e-10;
    swings(&e, sqrt((k / (1.5 + a * eigenvalue()) + 30 * eigenvalue()) / 2), true, 1e-7);
    test_engine_close(&e);
  }
}

/* A network of 900 places with edges over all lengths, by the solver that is chosen. */
static void threads_leave_no_trace(void **state) {
  (void)state;
  enum { PLACES = 900, EDGES = 1500 };
  static double first[3 * PLACES];
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    uint32_t edge[EDGES][2];
    test_engine_open(&e);
    test_plugin(&e, HK_INTEGRATOR, "leapfrog");
    for (uint32_t i = 0; i < PLACES; i++) test_particle(&e, cos(i), sin(3.0 * i), i % 7, 1);
    for (uint32_t j = 0; j < EDGES; j++) {
      edge[j][0] = 1 + j * 7919 % PLACES;
      edge[j][1] = 1 + (j * 7919 + 1 + j * j % 60) % PLACES;
    }
    hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "fixture:screened");
    test_edges(&e, force, (const uint32_t(*)[2])edge, EDGES);
    test_number(&e, force, "k", 300);
    test_number(&e, force, "block", 3);
    e.options.dt = 0.01;
    e.options.threads = threads;
    test_run(&e);
    test_advance(&e, 0.1);
    if (threads == 1)
      memcpy(first, hk_run_view(e.run)->x, sizeof first);
    else
      assert_memory_equal(first, hk_run_view(e.run)->x, sizeof first);
    test_engine_close(&e);
  }
}

static void refused(test_engine *e, const char *const *words) {
  hk_status status = hk_run_open(e->scene, &e->options, &e->run, &e->error);
  if (status == HK_OK) status = hk_run_advance(e->run, end, &e->error);
  assert_int_not_equal(status, HK_OK);
  for (; *words; words++)
    if (!strstr(e->error.text, *words)) fail_msg("'%s' is not in: %s", *words, e->error.text);
  test_engine_close(e);
}

/* The whole chain may move along x = const: with or without a part in that direction, which rounding might hide. */
static void a_singular_matrix_is_answered_with_the_name_of_who_asked(void **state) {
  (void)state;
  static const char *const solvers[] = {NULL, "banded", "supernodal", "cholmod", "umfpack"};
  for (size_t s = 0; s < sizeof solvers / sizeof *solvers; s++)
    for (int implicit = 0; implicit < 2; implicit++) {
      test_engine e;
      open(&e, implicit ? "implicit_midpoint" : "leapfrog", 1, solvers[s], 0);
      refused(&e, (const char *const[]){"screened: its linear system of 24 unknowns: ", NULL});
    }
}

static void what_is_not_symmetric_is_not_solved_as_if_it_were(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *force = open(&e, "leapfrog", 1, NULL, 1.5);
  test_number(&e, force, "skew", 0.2);
  refused(&e, (const char *const[]){"screened: its linear system", "symmetric matrices only", NULL});
  force = open(&e, "leapfrog", 1, "cholmod", 1.5);
  test_boolean(&e, force, "unsymmetric", true);
  refused(&e, (const char *const[]){"screened: the solver 'cholmod' takes no unsymmetric matrices", NULL});
  open(&e, "leapfrog", 1, "cholmode", 1.5);
  refused(&e, (const char *const[]){"screened", "cholmode", "cholmod", NULL});
}

/* Two places: ((g + a, -a + s), (-a - s, g + a)) u = x, by Cramer's rule. */
static void an_unsymmetric_one_is_solved_where_that_is_said(void **state) {
  (void)state;
  test_engine e;
  double g = 1.5, s = 0.2, x[2] = {1, 3}, det = (g + a) * (g + a) - (a * a - s * s), F[6] = {0};
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  for (int i = 0; i < 2; i++) test_particle(&e, x[i], 0, 0, 1);
  hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "fixture:screened");
  test_edges(&e, force, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, force, "a", a);
  test_number(&e, force, "g", g);
  test_number(&e, force, "skew", s);
  test_boolean(&e, force, "unsymmetric", true);
  e.options.dt = 1e-2;
  test_run(&e);
  assert_true(hk_query_force(&e.run->dynamics, 0, e.run->state.X, 2, F));
  near(-F[0], ((g + a) * x[0] + (a - s) * x[1]) / det, 1e-14); /* rounding */
  near(-F[3], ((a + s) * x[0] + (g + a) * x[1]) / det, 1e-14);
  test_engine_close(&e);
}

/* ---- the table itself, with a solver that counts ---- */

static int analyses, factorizations;

static hk_status count_analysis(void *self, const hk_matrix *A) {
  (void)self, (void)A;
  analyses++;
  return HK_OK;
}

static double diagonal[2];
static size_t diagonal_rows;

static hk_status keep_diagonal(void *self, const hk_matrix *A) {
  (void)self;
  factorizations++;
  diagonal_rows = A->rows;
  for (size_t r = 0; r < A->rows; r++) diagonal[r] = A->value[A->row_start[r]];
  return HK_OK;
}

static hk_status divide(void *self, const double *b, double *x, hk_solve_info *info) {
  (void)self, (void)info;
  for (size_t r = 0; r < diagonal_rows; r++) x[r] = b[r] / diagonal[r];
  return HK_OK;
}

static const hk_solver counting = {
    .size = sizeof counting, .analyze = count_analysis, .factorize = keep_diagonal, .solve = divide};
static const hk_plugin counter = {
    .abi = HK_ABI, .kind = HK_SOLVER, .name = "counter", .instance_size = 1, .solver = &counting};

static void patterns_are_analysed_when_they_change_and_after_checkpoints(void **state) {
  (void)state;
  test_engine e;
  open(&e, "leapfrog", 1, NULL, 1.5);
  test_run(&e);
  hk_plugin_spec *spec = hk_spec_create(hk_registry_add(&e.registry, &counter, &e.error), "counter", "", &e.error);
  hk_dynamics *d = &e.run->dynamics;
  const hk_solvers *table = hk_asked_solvers(d, spec);
  const hk_host *host = &d->plugins->kind[HK_FORCE].item[0]->host;
  hk_linear *linear = NULL, *other = NULL;
  double value[] = {2, 4}, b[2] = {2, 2}, x[2];
  hk_matrix A = {2, 1, (size_t[]){0, 1, 2}, (uint32_t[]){0, 1}, value, true, 77};
  assert_int_equal(table->open(table->self, host, NULL, 0, &linear), HK_OK);
  assert_int_equal(table->open(table->self, host, NULL, 0, &other), HK_OK);
  for (int time = 0; time < 3; time++, value[0] *= 2) {
    assert_int_equal(table->factorize(linear, &A), HK_OK);
    assert_int_equal(table->solve(linear, b, x, NULL), HK_OK);
    assert_true(x[0] == 2 / value[0] && x[1] == 0.5);
  }
  assert_true(analyses == 1 && factorizations == 3);
  hk_asked_solvers_forget(d);
  assert_int_equal(table->solve(linear, b, x, NULL), HK_OK); /* the factors stay */
  assert_int_equal(table->factorize(linear, &A), HK_OK);
  assert_int_equal(table->factorize(other, &A), HK_OK); /* has a pattern of its own */
  assert_int_equal(analyses, 3);
  hk_matrix one = {1, 1, (size_t[]){0, 1}, (uint32_t[]){0}, value, true, 77}; /* another, under the same number */
  assert_int_equal(table->factorize(linear, &one), HK_OK);
  assert_int_equal(analyses, 4);
  value[0] = NAN;
  assert_int_equal(table->factorize(linear, &one), HK_NOT_FINITE);
  e.error = (hk_error){0};
  *d->error = (hk_error){0};
  one.column = (uint32_t[]){1};
  assert_int_equal(table->factorize(linear, &one), HK_FAILED);
  assert_non_null(strstr(d->error->text, "a column lies outside of the matrix"));
  test_engine_close(&e);
  hk_spec_destroy(spec);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_solver_gives_the_frequency_of_the_mode),
      cmocka_unit_test(an_implicit_method_has_its_own_solver_beside_it),
      cmocka_unit_test(threads_leave_no_trace),
      cmocka_unit_test(a_singular_matrix_is_answered_with_the_name_of_who_asked),
      cmocka_unit_test(what_is_not_symmetric_is_not_solved_as_if_it_were),
      cmocka_unit_test(an_unsymmetric_one_is_solved_where_that_is_said),
      cmocka_unit_test(patterns_are_analysed_when_they_change_and_after_checkpoints),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
