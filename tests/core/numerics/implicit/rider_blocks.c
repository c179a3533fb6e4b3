/* Jacobians of forces on riders, carried over to their carriers, are minus the derivatives of what acts on these. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { CARRIERS = 4, N = 7 };

static void scene(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0.1, 0, 0, 1);
  test_particle(e, 1, 0.2, -0.1, 2);
  test_particle(e, 0.3, 1.1, 0, 0.5);
  test_particle(e, 0.2, 0.3, 0.9, 1.5);
  for (size_t k = 0; k < 3 * CARRIERS; k++) e->scene->particles.velocity[k] = 0.3 * sin(1.7 * (double)k);
  for (int k = 0; k < 2; k++) {
    hk_rider r = {.particle = test_particle(e, 0, 0, 0, 0), .carriers = 4, .carrier = {1, 2, 3, 4}};
    const double weight[2][4] = {{0.7, 0.6, -0.5, 0.2}, {-2, 1, 1.25, 0.75}};
    memcpy(r.weight, weight[k], sizeof r.weight);
    assert_int_equal(hk_scene_add_rider(e->scene, &r, &e->error), HK_OK);
  }
  test_pin(e, HK_PIN_FIXED, test_particle(e, 2, 2, 2, 0), NULL);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{5, 7}, {5, 6}, {6, 1}, {2, 5}}, 4);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "rest", 0.8);
  test_number(e, springs, "damping", 0.7);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "d", 0.4);
}

static void expand(const hk_matrix *A, double full[3 * N][3 * N]) {
  memset(full, 0, 9 * N * N * sizeof(double));
  for (size_t r = 0; r < N; r++)
    for (size_t b = A->row_start[r]; b < A->row_start[r + 1]; b++)
      for (size_t q = 0; q < 9; q++) full[3 * r + q / 3][3 * A->column[b] + q % 3] = A->value[9 * b + q];
}

/* Central differences as in jacobian.c, with weights up to 2: 1e-6 of blocks of some 300 N/m. */
static void blocks_of_carriers_are_the_derivatives(void **state) {
  (void)state;
  test_engine e;
  scene(&e);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  hk_matrix K, D;
  double full[2][3 * N][3 * N], F[2][3 * N], X[6 * N + 1], dy[1], h = 1e-5;
  assert_int_equal(s->linear->jacobian(s, 0, e.run->state.X, 0, &K, &D), HK_OK);
  expand(&K, full[0]);
  expand(&D, full[1]);
  for (size_t k = 0; k < 6 * N; k++) {
    size_t column = k % (3 * N);
    if (column >= 3 * CARRIERS) {
      for (size_t r = 0; r < 3 * N && column < 18; r++) assert_true(full[k / (3 * N)][r][column] == 0); /* riders */
      continue;
    }
    for (int side = 0; side < 2; side++) {
      memcpy(X, e.run->state.X, sizeof X);
      X[k] += side ? h : -h;
      assert_int_equal(s->accelerations(s, 0, X, X + 3 * N, X + 6 * N, F[side], dy), HK_OK);
    }
    for (size_t r = 0; r < 3 * CARRIERS; r++) {
      double slope = s->model->mass[r / 3] * (F[1][r] - F[0][r]) / (2 * h);
      if (!(fabs(full[k / (3 * N)][r][column] + slope) < 1e-6))
        fail_msg("row %zu, column %zu: %.9g, expected %.9g", r, k, full[k / (3 * N)][r][column], -slope);
    }
  }
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(blocks_of_carriers_are_the_derivatives)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
