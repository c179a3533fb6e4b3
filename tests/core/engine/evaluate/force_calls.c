/* Functions of the system that call all forces: products without a matrix and potentials of a time, with contact,
 * springs, drag and a floor; and the definite blocks of contact. */
#include "tests/support/spheres.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* Three spheres in contact with a spring, drag and a floor. */
static hk_plugin_spec *three(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0.106, 1);
  test_particle(e, 0.2051, 0.01, 0.108, 2);
  test_particle(e, 0.096, 0.182, 0.12, 0.5);
  for (size_t k = 0; k < 9; k++) e->scene->particles.velocity[k] = 0.3 * sin(1.7 * (double)k);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "damping", 2);
  test_number(e, springs, "rest", 0.15);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "d", 0.4);
  hk_plugin_spec *spheres = test_plugin(e, HK_FORCE, "fixture:barrier_spheres");
  test_boolean(e, spheres, "floor", true);
  return spheres;
}

enum { N = 3 };

static void forces(test_engine *e, const double *X, double *F) {
  hk_system *s = &e->run->dynamics.system;
  double state[6 * N + 1] = {0}, dy[1];
  memcpy(state, X, 6 * N * sizeof *state);
  assert_int_equal(s->accelerations(s, 0, state, state + 3 * N, state + 6 * N, F, dy), HK_OK);
  for (size_t k = 0; k < 3 * N; k++) F[k] *= s->model->mass[k / 3];
}

/* The directions of a product. */
static void directions(double *dx, double *dv) {
  for (size_t k = 0; k < 3 * N; k++) {
    dx[k] = cos(1.3 * (double)k);
    dv[k] = sin(0.9 * (double)k + 1);
  }
}

/* Forces change over gaps of 4e-3 m: central differences of h = 1e-7 m are off by (h/4e-3)^2, 6e-10 of the product, and
 * by the rounding of positions, 1e-17 m, over h, 1e-10; a hundred times that is allowed. */
static void product_is_the_derivative_of_the_forces(void **state) {
  (void)state;
  test_engine e;
  three(&e);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double dx[3 * N], dv[3 * N], dF[3 * N], plus[3 * N], minus[3 * N], X[6 * N + 1], h = 1e-7;
  directions(dx, dv);
  assert_int_equal(s->linear->product(s, 0, s->X, dx, dv, dF), HK_OK);
  for (int side = 0; side < 2; side++) {
    for (size_t k = 0; k < 3 * N; k++) {
      X[k] = s->X[k] + (side ? -h : h) * dx[k];
      X[3 * N + k] = s->X[3 * N + k] + (side ? -h : h) * dv[k];
    }
    forces(&e, X, side ? minus : plus);
  }
  double largest = 0;
  for (size_t k = 0; k < 3 * N; k++) largest = fmax(largest, fabs(dF[k]));
  assert_true(largest > 1e4); /* the contacts are in it */
  for (size_t k = 0; k < 3 * N; k++) assert_true(fabs(dF[k] - (plus[k] - minus[k]) / (2 * h)) < 1e-7 * largest);
  test_engine_close(&e);
}

static void product_is_that_of_the_blocks(void **state) {
  (void)state;
  test_engine e;
  three(&e);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double dx[3 * N], dv[3 * N], dF[3 * N], blocks[3 * N] = {0};
  hk_matrix K, D;
  directions(dx, dv);
  assert_int_equal(s->linear->product(s, 0, s->X, dx, dv, dF), HK_OK);
  assert_int_equal(s->linear->jacobian(s, 0, s->X, 0, &K, &D), HK_OK);
  for (size_t r = 0; r < N; r++)
    for (size_t b = K.row_start[r]; b < K.row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++) {
        size_t at = 3 * (size_t)K.column[b] + q % 3;
        blocks[3 * r + q / 3] -= K.value[9 * b + q] * dx[at] + D.value[9 * b + q] * dv[at];
      }
  double largest = 0;
  for (size_t k = 0; k < 3 * N; k++) largest = fmax(largest, fabs(dF[k]));
  for (size_t k = 0; k < 3 * N; k++) assert_true(fabs(dF[k] - blocks[k]) < 1e-13 * largest); /* sums of 30 products */
  test_engine_close(&e);
}

/* Definite blocks differ from exact ones only across the normal, and no direction has negative curvature. */
static void definite_blocks_have_no_negative_curvature(void **state) {
  (void)state;
  test_engine e;
  three(&e);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  hk_matrix K, D;
  double lowest[2] = {INFINITY, INFINITY};
  for (int definite = 0; definite < 2; definite++) {
    unsigned want = definite ? HK_WANT_SYMMETRIC | HK_WANT_DEFINITE : HK_WANT_SYMMETRIC;
    assert_int_equal(s->linear->jacobian(s, 0, s->X, want, &K, &D), HK_OK);
    for (int trial = 0; trial < 2000; trial++) {
      double u[3 * N], sum = 0;
      for (size_t k = 0; k < 3 * N; k++) u[k] = sin(12.9898 * (double)k + 78.233 * trial * (double)(k + 1));
      for (size_t r = 0; r < N; r++)
        for (size_t b = K.row_start[r]; b < K.row_start[r + 1]; b++)
          for (size_t q = 0; q < 9; q++) sum += u[3 * r + q / 3] * K.value[9 * b + q] * u[3 * K.column[b] + q % 3];
      lowest[definite] = fmin(lowest[definite], sum);
    }
  }
  print_message("least curvature found: exact %.3g, definite %.3g\n", lowest[0], lowest[1]);
  assert_true(lowest[1] >= -1e-9); /* rounding of 1e5 N/m */
  test_engine_close(&e);
}

/* 1e4 (1 + t) */
static hk_status growing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                         size_t max, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max, (void)error;
  out[0] = 1e4 * (1 + in[0]);
  *n_out = 1;
  return HK_OK;
}

static void potential_is_that_of_its_time(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spheres = three(&e);
  test_function(&e, spheres, "stiffness", (hk_function){.call = growing});
  e.options.without = (const char *const[]){"springs"};
  e.options.without_count = 1;
  e.options.integrator = "leapfrog";
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  double at[3], a[3 * N], again[3 * N], X[6 * N + 1], dy[1];
  memcpy(X, s->X, sizeof X);
  assert_int_equal(s->accelerations(s, 0, X, X + 3 * N, X + 6 * N, a, dy), HK_OK);
  for (int k = 0; k < 3; k++) assert_int_equal(s->contact->potential(s, k, s->X, &at[k]), HK_OK);
  assert_true(at[0] > 0);
  for (int k = 1; k < 3; k++) assert_true(fabs(at[k] / at[0] - (1 + k)) < 1e-15 * 16); /* one sum, scaled */
  assert_int_equal(s->accelerations(s, 0, X, X + 3 * N, X + 6 * N, again, dy), HK_OK);
  assert_memory_equal(a, again, sizeof a); /* an evaluation after it is of its own time again */
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(product_is_the_derivative_of_the_forces),
      cmocka_unit_test(product_is_that_of_the_blocks),
      cmocka_unit_test(definite_blocks_have_no_negative_curvature),
      cmocka_unit_test(potential_is_that_of_its_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
