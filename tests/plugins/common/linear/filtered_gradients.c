/* Filtered conjugate gradients against dense elimination; what is prescribed stays to the last bit; the residual that
 * is left is what constraints push with; matrices that are not definite. */
#include "plugins/common/linear/filtered_gradients.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ROWS = 7, SIZE = 3 * ROWS, BLOCKS = ROWS * ROWS };

static const double H = 0.1;

typedef struct problem {
  double K[9 * BLOCKS], D[9 * BLOCKS], mass[ROWS], b[SIZE], z[SIZE], A[SIZE][SIZE], line[3], normal[3];
  size_t row_start[ROWS + 1];
  uint32_t column[BLOCKS];
  fake_system *host;
} problem;

static uint64_t seed = 9;

static double noise(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) * 0x1.0p-52 - 1;
}

/* R^T R, in blocks. */
static void definite(double *block, double scale) {
  double R[SIZE][SIZE];
  for (int e = 0; e < SIZE * SIZE; e++) R[e / SIZE][e % SIZE] = noise();
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++) {
      double sum = 0;
      for (int k = 0; k < SIZE; k++) sum += R[k][i] * R[k][j];
      block[9 * (ROWS * (i / 3) + j / 3) + 3 * (i % 3) + j % 3] = scale * sum;
    }
}

static void unit(double v[3]) {
  double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (int c = 0; c < 3; c++) v[c] /= length;
}

static problem *make(double stiffness) {
  problem *p = calloc(1, sizeof *p);
  p->host = fake_system_create(&(fake_problem){.n = 1});
  definite(p->K, stiffness);
  definite(p->D, 0.3);
  for (size_t r = 0; r <= ROWS; r++) p->row_start[r] = ROWS * r;
  for (uint32_t e = 0; e < BLOCKS; e++) p->column[e] = e % ROWS;
  for (int r = 0; r < ROWS; r++) p->mass[r] = 1 + 0.2 * r;
  for (int c = 0; c < 3; c++) p->line[c] = noise(), p->normal[c] = noise();
  unit(p->line), unit(p->normal);
  for (int e = 0; e < SIZE; e++) p->b[e] = noise();
  for (int c = 0; c < 3; c++) p->z[c] = noise(), p->z[3 * 4 + c] = c == 2 ? noise() : 0;
  for (int i = 0; i < SIZE; i++)
    for (int j = 0; j < SIZE; j++) {
      int at = 9 * (ROWS * (i / 3) + j / 3) + 3 * (i % 3) + j % 3;
      p->A[i][j] = (i == j ? p->mass[i / 3] : 0) + H * (p->D[at] + H * p->K[at]);
    }
  return p;
}

static void end(problem *p) {
  fake_system_destroy(p->host);
  free(p);
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Particle 0 is prescribed, 1 on a line, 2 in a plane, 4 has a prescribed z. */
static void filter(void *context, double *v) {
  const problem *p = context;
  double along = dot(p->line, v + 3), off = dot(p->normal, v + 6);
  for (int c = 0; c < 3; c++) v[c] = 0, v[3 + c] = along * p->line[c], v[6 + c] -= off * p->normal[c];
  v[14] = 0;
}

static hk_status solve(problem *p, double tolerance, double *dv, double *residual) {
  const hk_matrix K = {
      .rows = ROWS, .block = 3, .symmetric = true, .row_start = p->row_start, .column = p->column, .value = p->K};
  hk_matrix D = K;
  D.value = p->D;
  const hk_filtered_equations e = {&p->host->host, &K, &D, p->mass, H, p->b, filter, p};
  double work[HK_FILTERED_WORK * SIZE];
  const double *left;
  int iterations;
  memcpy(dv, p->z, sizeof p->z);
  hk_status status = hk_filtered_gradients(&e, dv, tolerance, work, &left, &iterations);
  memcpy(residual, left, SIZE * sizeof *residual);
  return status;
}

static void what_is_prescribed_stays_to_the_last_bit(void **state) {
  (void)state;
  for (int k = 0; k < 20; k++) {
    problem *p = make(100);
    double dv[SIZE], residual[SIZE];
    assert_int_equal(solve(p, 1e-12, dv, residual), HK_OK);
    assert_memory_equal(dv, p->z, 3 * sizeof *dv);
    assert_memory_equal(dv + 14, p->z + 14, sizeof *dv);
    double across[3];
    for (int c = 0; c < 3; c++) across[c] = dv[3 + c] - dot(p->line, dv + 3) * p->line[c];
    assert_true(sqrt(dot(across, across)) < 1e-15); /* of 1: slides that are askew are kept to rounding */
    assert_true(fabs(dot(p->normal, dv + 6)) < 1e-15);
    end(p);
  }
}

/* Free directions feel nothing more, and what is left acts across them: dv is the solution, and -residual/h the force
 * of the constraint, whose sign tells whether a surface pushes or would have to pull. */
static void the_residual_is_the_force_of_the_constraints(void **state) {
  (void)state;
  for (int k = 0; k < 20; k++) {
    problem *p = make(100);
    double dv[SIZE], left[SIZE], own[SIZE], largest = 0;
    assert_int_equal(solve(p, 1e-12, dv, left), HK_OK);
    for (int i = 0; i < SIZE; i++) {
      own[i] = p->b[i];
      for (int j = 0; j < SIZE; j++) own[i] -= p->A[i][j] * dv[j];
      largest = fmax(largest, fabs(own[i]));
    }
    assert_true(largest > 0.1);
    for (int i = 0; i < SIZE; i++) assert_true(fabs(own[i] - left[i]) < 1e-13 * 50); /* products of 21 numbers of 50 */
    filter(p, own);
    for (int i = 0; i < SIZE; i++) assert_true(fabs(own[i]) < 1e-10);
    end(p);
  }
}

static void what_is_not_definite_is_said(void **state) {
  (void)state;
  problem *p = make(-100);
  double dv[SIZE], left[SIZE];
  assert_int_equal(solve(p, 1e-12, dv, left), HK_NOT_CONVERGED);
  assert_non_null(strstr(p->host->message, "not positive definite"));
  end(p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_prescribed_stays_to_the_last_bit),
      cmocka_unit_test(the_residual_is_the_force_of_the_constraints),
      cmocka_unit_test(what_is_not_definite_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
