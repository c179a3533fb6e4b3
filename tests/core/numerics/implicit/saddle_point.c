/* The linear system of implicit steps with constraints: what hk_system.solve promises, and steps that need the
 * stiffness of constraint forces. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4 };
static const double at[N][3] = {{0, 0, 0}, {0.7, 0.2, -0.1}, {1.4, -0.3, 0.2}, {1.9, 0.4, 0.6}};
static const double mass[N] = {1, 0.4, 1.7, 0.2};

/* A pinned particle, one that slides in a plane, two that are free; bars 1-2, 2-3 and 3-4, the first given twice. */
static void open(test_engine *e) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, "backward_euler");
  for (int i = 0; i < N; i++) test_particle(e, at[i][0], at[i][1], at[i][2], mass[i]);
  e->scene->particles.velocity[3 * 3] = 0.5;
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_PLANE, 3, (double[]){0, 0, 1});
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 3}, {2, 4}}, 2);
  test_number(e, springs, "k", 300);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}, {1, 2}}, 4);
  e->options.dt = 1e-3;
  test_run(e);
}

/* J x of bar k, with what the pins hold left out. */
static double rate_of(hk_system *s, int k, const double *x) {
  double sum = 0, l = 0, d[3], part[3 * N];
  memcpy(part, x, sizeof part);
  s->filter(s, part);
  for (int c = 0; c < 3; c++) d[c] = s->X[3 * k + 3 + c] - s->X[3 * k + c];
  for (int c = 0; c < 3; c++) l += d[c] * d[c];
  for (int c = 0; c < 3; c++) sum += d[c] / sqrt(l) * (part[3 * k + 3 + c] - part[3 * k + c]);
  return sum;
}

static void product(const hk_matrix *A, const double *x, double *y) {
  memset(y, 0, 3 * A->rows * sizeof *y);
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t p = 0; p < 9; p++) y[3 * r + p / 3] += A->value[9 * e + p] * x[3 * A->column[e] + p % 3];
}

/* b - A x is a force of the constraints: it does no work on what they allow. Those directions are had from `solve`
 * itself, for right-hand sides with no part along the constraints, and checked to be what they claim. */
static void check(hk_system *s, const hk_matrix *A, const double *b, const double *u, const double *x) {
  double left[3 * N], size = 0;
  product(A, x, left);
  for (int e = 0; e < 3 * N; e++) {
    left[e] = b[e] - left[e];
    size = fmax(size, fabs(b[e]));
  }
  for (int k = 0; k < 3; k++) assert_true(fabs(rate_of(s, k, x) - rate_of(s, k, u)) < 1e-11 * size);
  static const double none[3 * N];
  for (int direction = 0; direction < 3 * N; direction++) {
    double push[3 * N] = {0}, allowed[3 * N], work = 0, length = 0;
    push[direction] = 1;
    s->filter(s, push);
    assert_int_equal(s->linear->solve_along(s, push, none, allowed, NULL), HK_OK);
    for (int k = 0; k < 3; k++) assert_true(fabs(rate_of(s, k, allowed)) < 1e-12);
    for (int e = 0; e < 3 * N; e++) {
      work += left[e] * allowed[e];
      length += fabs(allowed[e]);
    }
    assert_true(fabs(work) < 1e-10 * size * length + 1e-14); /* refinement stops at 1e-12 */
  }
}

static void solutions_are_along_the_constraints_and_balanced_by_their_forces(void **state) {
  (void)state;
  test_engine e;
  open(&e);
  hk_system *s = &e.run->dynamics.system;
  double a[3 * N], dy[1], b[3 * N], u[3 * N], x[3 * N];
  hk_matrix K, D, A;
  unsigned flags;
  assert_int_equal(s->accelerations(s, s->t, s->X, s->X + 3 * N, NULL, a, dy), HK_OK);
  assert_int_equal(hk_system_equations(s), 3); /* the fourth follows from the first */
  assert_int_equal(s->linear->solver_flags(s, &flags), HK_OK);
  assert_true(flags & HK_SOLVES_INDEFINITE);
  assert_int_equal(s->linear->jacobian(s, s->t, s->X, 0, &K, &D), HK_OK);
  assert_int_equal(s->linear->combine(s, 1, 0.02, 0.0004, &A), HK_OK);
  assert_int_equal(s->linear->factorize(s, &A), HK_OK);
  for (int k = 0; k < 3 * N; k++) b[k] = sin(1.3 * k + 0.2);
  s->filter(s, b);
  for (int k = 0; k < 3 * N; k++) u[k] = k < 3 ? 0 : b[k] / mass[k / 3];
  assert_int_equal(s->linear->solve(s, b, x, NULL), HK_OK);
  check(s, &A, b, u, x);
  for (int k = 0; k < 3 * N; k++) u[k] = cos(0.7 * k);
  s->filter(s, u);
  assert_int_equal(s->linear->solve_along(s, b, u, x, NULL), HK_OK);
  check(s, &A, b, u, x);
  test_engine_close(&e);
}

/* Fifty bars of 1 cm and 1 g with 1 kg at the end: the tension makes them swing at up to 1e3/s, where a step is 1/120
 * s. Without the stiffness of the tension in the matrix BDF2 takes 518 steps for these 120, and 60 thousand
 * factorizations. */
static void a_heavy_bob_on_a_light_chain_is_no_trouble(void **state) {
  (void)state;
  enum { LINKS = 50 };
  test_engine e;
  hk_summary s;
  uint32_t edge[LINKS][2];
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, "bdf2");
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, -9.81, 0);
  for (uint32_t i = 0; i <= LINKS; i++) test_particle(&e, 0.01 * i, 0, 0, i == LINKS ? 1 : 0.001);
  for (uint32_t i = 0; i < LINKS; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t(*)[2])edge, LINKS);
  e.scene->fps = 60;
  e.scene->duration = 1;
  e.options.dt = 1.0 / 120;
  test_run(&e);
  test_advance(&e, 1);
  hk_run_summary(e.run, &s);
  assert_true(s.steps < 200 && s.factorizations < 4000);
  assert_true(s.constraint_violation < 1e-12);
  assert_true(fabs(s.energy_drift) < 0.01); /* a method of order 2 with 170 steps a swing: (2 pi/170)^2 = 1.4e-3 */
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(solutions_are_along_the_constraints_and_balanced_by_their_forces),
      cmocka_unit_test(a_heavy_bob_on_a_light_chain_is_no_trouble),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
