/* The polynomials of Everhart's method: they go through the slopes at the nodes, are exact for polynomials of degree 7
 * in a first sweep and of degree 14 in the integral over a step, and continue themselves. */
#include "plugins/common/integrate/radau.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { LENGTH = 4, ROWS = HK_RADAU_ROWS, SIZE = 7 }; /* one particle: a, and the power of the work */

static double value(const double *c, int degree, double s) {
  double sum = 0;
  for (int k = degree; k >= 0; k--) sum = sum * s + c[k];
  return sum;
}

/* B and G of the slopes c(s), e more in number e. */
static void sweep(const double *c, int degree, double *B, double *G) {
  double slope[LENGTH];
  for (int k = 0; k < ROWS; k++) {
    for (int e = 0; e < LENGTH; e++) slope[e] = value(c, degree, hk_radau_node[k]) + e;
    if (k == 0)
      memcpy(B, slope, sizeof slope);
    else
      hk_radau_refine(B, G, LENGTH, k, slope);
  }
}

/* Differences over gaps of 0.06 to 1 leave some 1e4 roundings in the coefficients. */
static void a_sweep_finds_polynomials_of_degree_seven(void **state) {
  (void)state;
  const double c[ROWS] = {1, -2, 0.5, 3, -1, 0.25, 2, -3};
  double B[ROWS * LENGTH] = {0}, G[ROWS * LENGTH] = {0}, again[ROWS * LENGTH];
  sweep(c, 7, B, G);
  for (int j = 0; j < ROWS; j++)
    for (int e = 0; e < LENGTH; e++) assert_true(fabs(B[j * LENGTH + e] - c[j] - (j ? 0 : e)) < 2e-11);
  hk_radau_divide(B, LENGTH, again);
  for (int k = 0; k < (ROWS - 1) * LENGTH; k++) assert_true(fabs(again[k] - G[k]) < 1e-13);
}

/* Radau's formula with eight points, of which one is the start, has degree 14: a wrong digit of a node shows. */
static void a_step_integrates_polynomials_of_degree_fourteen(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  for (int degree = 0; degree <= 15; degree++) {
    double c[16] = {0}, B[ROWS * LENGTH] = {0}, G[ROWS * LENGTH] = {0}, X[SIZE] = {0}, lost[SIZE] = {0};
    c[degree] = 1;
    sweep(c, degree, B, G);
    hk_radau_finish(B, &f->system, 1, X, lost);
    double off = fabs(X[3] - 1.0 / (degree + 1));
    print_message("degree %d: off by %.1e\n", degree, off);
    assert_true(degree <= 14 ? off < 4e-15 : off > 1e-10);
    for (int e = 0; e < LENGTH; e++) assert_true(fabs(X[3 + e] - e - 1.0 / (degree + 1)) < 1e-8);
  }
  fake_system_destroy(f);
}

/* From x = 5, v = 2 by a = c(t/h): the state at every node and at the end, and the place of the work. */
static void positions_are_integrals_of_velocities(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  const double c[ROWS] = {1, -2, 0.5, 3, -1, 0.25, 2, -3}, h = 0.3;
  double B[ROWS * LENGTH] = {0}, G[ROWS * LENGTH] = {0}, X[SIZE] = {5, 5, 5, 2, 2, 2, 1}, at[SIZE], lost[SIZE] = {0};
  sweep(c, 7, B, G);
  for (int k = 1; k <= ROWS; k++) {
    double s = k < ROWS ? hk_radau_node[k] : 1, v[9] = {2}, x[10] = {5};
    for (int j = 0; j < 8; j++) v[j + 1] = h * c[j] / (j + 1);
    for (int j = 0; j < 9; j++) x[j + 1] = h * v[j] / (j + 1);
    memcpy(at, X, sizeof at);
    if (k < ROWS)
      hk_radau_place(B, &f->system, h, k, X, lost, at);
    else
      hk_radau_finish(B, &f->system, h, at, lost);
    assert_true(fabs(at[0] - value(x, 9, s)) < 2e-15 && fabs(at[3] - value(v, 8, s)) < 2e-15);
    assert_true(fabs(at[6] - 1 - (value(v, 8, s) - 2 + 3 * h * s)) < 2e-15);
  }
  fake_system_destroy(f);
}

/* The polynomial of the next step, q times as long, is the same function. */
static void polynomials_continue_themselves(void **state) {
  (void)state;
  const double c[ROWS] = {1, -2, 0.5, 3, -1, 0.25, 2, -3}, q = 0.7;
  double B[ROWS * LENGTH] = {0}, G[ROWS * LENGTH] = {0}, next[ROWS * LENGTH] = {0};
  sweep(c, 7, B, G);
  hk_radau_foretell(B + LENGTH, LENGTH, q, next);
  next[0] = value(c, 7, 1);
  for (double s = 0; s <= 1; s += 0.125) {
    double found = 0;
    for (int j = ROWS - 1; j >= 0; j--) found = found * s + next[j * LENGTH];
    assert_true(fabs(found - value(c, 7, 1 + q * s)) < 1e-10); /* values up to 100 */
  }
}

/* A million steps that each add a third of a rounding error of x. */
static void what_rounding_takes_is_kept(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  double B[ROWS * LENGTH] = {0}, X[SIZE] = {0, 0, 0, 1}, lost[SIZE] = {0}, small = 0x1p-52 / 3;
  B[0] = small;
  for (int k = 0; k < 1000000; k++) hk_radau_finish(B, &f->system, 1, X, lost);
  assert_true(fabs(X[3] - 1 - 1e6 * small) < 0x1p-52);
  fake_system_destroy(f);
}

/* Equal steps have equal roundings, all of one sign: those of the integrals themselves may not be among them. With
 * those of double precision v is off by up to 1e-16 of itself, however often x and v are compensated. */
static void integrals_are_not_rounded_before_they_are_added(void **state) {
  (void)state;
  enum { COUNT = 4096 };
  fake_system *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  const double h = 0.1;
  double worst = 0;
  for (int which = 3; which < 40; which += 2) {
    double B[ROWS * LENGTH] = {0}, X[SIZE] = {0}, lost[SIZE] = {0};
    long double exact = 0;
    for (int j = 0; j < ROWS; j++) {
      B[j * LENGTH] = 1.0 / (which + j);
      exact += (long double)B[j * LENGTH] / (j + 1) * h;
    }
    for (int k = 0; k < COUNT; k++) hk_radau_finish(B, &f->system, h, X, lost);
    long double v = (long double)X[3] - lost[3];
    worst = fmax(worst, fabs((double)(v / (COUNT * exact) - 1)));
  }
  print_message("off by %.1e\n", worst);
  assert_true(worst < 1e-18);
  fake_system_destroy(f);
}

/* Places of a step are those of x less what rounding took from it. */
static void places_know_what_rounding_took(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  double B[ROWS * LENGTH] = {0}, X[SIZE] = {1, 1, 1, 0, 0, 0, 0}, lost[SIZE] = {0x1p-53}, at[SIZE];
  hk_radau_place(B, &f->system, 1, 3, X, lost, at);
  assert_true(at[0] == 1 - 0x1p-53 && at[1] == 1);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sweep_finds_polynomials_of_degree_seven),
      cmocka_unit_test(a_step_integrates_polynomials_of_degree_fourteen),
      cmocka_unit_test(positions_are_integrals_of_velocities),
      cmocka_unit_test(polynomials_continue_themselves),
      cmocka_unit_test(what_rounding_takes_is_kept),
      cmocka_unit_test(integrals_are_not_rounded_before_they_are_added),
      cmocka_unit_test(places_know_what_rounding_took),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
