/* The assembled Jacobian against differences of the forces, its pattern, and what is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4 };

/* A stretched, moving tetrahedron with springs and their damping, drag on all and a central pull. */
static void tetrahedron(test_engine *e, double damping) {
  test_engine_open(e);
  test_particle(e, 0.1, 0, 0, 1);
  test_particle(e, 1, 0.2, -0.1, 2);
  test_particle(e, 0.3, 1.1, 0, 0.5);
  test_particle(e, 0.2, 0.3, 0.9, 1.5);
  for (size_t k = 0; k < 3 * N; k++) e->scene->particles.velocity[k] = 0.3 * sin(1.7 * (double)k);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 1}, {1, 4}}, 4);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "rest", 0.8);
  test_number(e, springs, "damping", damping);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "d", 0.4);
  hk_plugin_spec *central = test_plugin(e, HK_FORCE, "central");
  test_number(e, central, "strength", 3);
  test_number(e, central, "power", -2);
  test_vector(e, central, "center", 0.5, -0.7, 0.4);
}

/* F of all particles; the run's state is not touched. */
static void forces(test_engine *e, const double *X, double *F) {
  hk_system *s = &e->run->dynamics.system;
  double state[6 * N + 1], dy[1];
  memcpy(state, X, 6 * N * sizeof *state);
  state[6 * N] = 0;
  assert_int_equal(s->accelerations(s, 0, state, state + 3 * N, state + 6 * N, F, dy), HK_OK);
  for (size_t k = 0; k < 3 * N; k++) F[k] *= s->model->mass[k / 3];
}

/* Full matrix from blocks. */
static void expand(const hk_matrix *A, double full[3 * N][3 * N]) {
  memset(full, 0, 9 * N * N * sizeof(double));
  for (size_t r = 0; r < N; r++)
    for (size_t b = A->row_start[r]; b < A->row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++) full[3 * r + q / 3][3 * A->column[b] + q % 3] = A->value[9 * b + q];
}

/* Central differences of step 1e-5 with forces of some 50 N and curvatures k/L^2 are good to 1e-5^2 50 + 50 eps/1e-5,
 * about 1e-8; ten times that is allowed. */
static void jacobian_is_minus_the_derivative_of_the_forces(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0.7);
  test_run(&e);
  hk_matrix K, D;
  double full[2][3 * N][3 * N], plus[3 * N], minus[3 * N], X[6 * N], h = 1e-5;
  assert_int_equal(e.run->dynamics.system.linear->jacobian(&e.run->dynamics.system, 0, e.run->state.X, 0, &K, &D),
                   HK_OK);
  expand(&K, full[0]);
  expand(&D, full[1]);
  for (size_t k = 0; k < 6 * N; k++) {
    memcpy(X, e.run->state.X, sizeof X);
    X[k] += h;
    forces(&e, X, plus);
    X[k] -= 2 * h;
    forces(&e, X, minus);
    for (size_t r = 0; r < 3 * N; r++)
      assert_true(fabs(full[k / (3 * N)][r][k % (3 * N)] + (plus[r] - minus[r]) / (2 * h)) < 1e-7);
  }
  test_engine_close(&e);
}

static void jacobian_has_the_whole_diagonal_and_one_pattern(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0);
  hk_matrix K, D;
  test_particle(&e, 9, 9, 9, 1);
  test_run(&e);
  assert_int_equal(e.run->dynamics.system.linear->jacobian(&e.run->dynamics.system, 0, e.run->state.X, 0, &K, &D),
                   HK_OK);
  assert_int_equal(K.rows, N + 1);
  assert_int_equal(K.row_start[N + 1], N + 1 + 2 * 4);
  assert_ptr_equal(K.column, D.column);
  for (size_t r = 0; r < K.rows; r++) {
    bool diagonal = false;
    for (size_t b = K.row_start[r]; b < K.row_start[r + 1]; b++) diagonal |= K.column[b] == r;
    assert_true(diagonal);
  }
  assert_int_equal(e.run->dynamics.count.jacobians, 1);
  test_engine_close(&e);
}

static void jacobian_again_is_the_same_and_follows_time(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0.7);
  hk_matrix K, D;
  e.scene->plugin[HK_FORCE].item[0]->to = 0.5; /* the springs let go: what is left is drag and the pull */
  e.options.dt = 1e-3;
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double first[9 * 12], X[6 * N + 1];
  memcpy(X, e.run->state.X, sizeof X);
  assert_int_equal(s->linear->jacobian(s, 0, X, 0, &K, &D), HK_OK);
  memcpy(first, K.value, 9 * K.row_start[N] * sizeof *first);
  assert_int_equal(s->linear->jacobian(s, 0, X, 0, &K, &D), HK_OK);
  assert_memory_equal(first, K.value, 9 * K.row_start[N] * sizeof *first);
  test_advance(&e, 0.6);
  assert_int_equal(s->linear->jacobian(s, 0.6, e.run->state.X, 0, &K, &D), HK_OK);
  assert_int_equal(K.row_start[N], 12); /* the pattern stays */
  for (size_t r = 0; r < N; r++)
    for (size_t b = K.row_start[r]; b < K.row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++)
        if (K.column[b] != r) assert_true(K.value[9 * b + q] == 0 && D.value[9 * b + q] == 0);
  test_engine_close(&e);
}

static void force_without_jacobian_is_refused_by_name(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0);
  test_plugin(&e, HK_FORCE, "fixture:kicker"); /* claims to depend on v */
  test_run(&e);
  hk_matrix K, D;
  assert_int_equal(e.run->dynamics.system.linear->jacobian(&e.run->dynamics.system, 0, e.run->state.X, 0, &K, &D),
                   HK_FAILED);
  assert_string_equal(e.run->error.text, "force 'kicker' offers no Jacobian, which leapfrog needs");
  test_engine_close(&e);
}

/* M + D + K of the scene, as an implicit method would pose it; returns the status of its factorization. */
static hk_status factorize(test_engine *e) {
  hk_system *s = &e->run->dynamics.system;
  hk_matrix K, D;
  assert_int_equal(s->linear->jacobian(s, 0, e->run->state.X, 0, &K, &D), HK_OK);
  for (size_t r = 0; r < N; r++)
    for (size_t b = K.row_start[r]; b < K.row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++)
        K.value[9 * b + q] += D.value[9 * b + q] + (K.column[b] == r && q % 4 == 0 ? 200 : 0);
  return s->linear->factorize(s, &K);
}

static void factors_solve_and_are_counted(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0);                      /* without damping K is symmetric, though springs do not promise it */
  e.options.integrator = "backward_euler"; /* a method that solves systems */
  e.options.solver = "cholmod";
  test_run(&e);
  double b[3 * N], x[3 * N];
  hk_solve_info info;
  for (size_t k = 0; k < 3 * N; k++) b[k] = (double)k;
  assert_int_equal(factorize(&e), HK_OK);
  assert_int_equal(e.run->dynamics.system.linear->solve(&e.run->dynamics.system, b, x, &info), HK_OK);
  assert_true(info.residual < 1e-14); /* some dozen operations of rounding 1e-16, condition near 1 */
  assert_int_equal(factorize(&e), HK_OK);
  assert_int_equal(e.run->dynamics.count.factorizations, 2);
  test_engine_close(&e);
}

static void unsymmetric_matrix_is_refused_for_a_symmetric_solver(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0.7);
  e.options.integrator = "backward_euler"; /* a method that solves systems */
  e.options.solver = "cholmod";
  test_run(&e);
  assert_int_equal(factorize(&e), HK_FAILED);
  assert_non_null(strstr(e.run->error.text, "solver 'cholmod' takes symmetric matrices only"));
  assert_non_null(strstr(e.run->error.text, "the Jacobian of 'springs' is not symmetric"));
  test_engine_close(&e);
}

static void solving_before_factorizing_is_refused(void **state) {
  (void)state;
  test_engine e;
  tetrahedron(&e, 0);
  test_run(&e);
  double b[3 * N] = {0}, x[3 * N];
  assert_int_equal(e.run->dynamics.system.linear->solve(&e.run->dynamics.system, b, x, NULL), HK_FAILED);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(jacobian_is_minus_the_derivative_of_the_forces),
      cmocka_unit_test(jacobian_has_the_whole_diagonal_and_one_pattern),
      cmocka_unit_test(jacobian_again_is_the_same_and_follows_time),
      cmocka_unit_test(force_without_jacobian_is_refused_by_name),
      cmocka_unit_test(factors_solve_and_are_counted),
      cmocka_unit_test(unsymmetric_matrix_is_refused_for_a_symmetric_solver),
      cmocka_unit_test(solving_before_factorizing_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
