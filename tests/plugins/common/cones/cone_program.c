/* Convex programs of impacts against systems by hand: a table on four feet, which three would hold, a block that is
 * pushed along the floor below and above its friction. The program has 1e-7 of the diagonal added to the matrix, which
 * is what it may be off. */
#include "plugins/common/cones/cone_program.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { FEET = 4, MOST = 3 * FEET };

static const double off = 1e-6;

static double matrix[MOST * MOST], room[7 * MOST];

/* A plate of mass 1 and moments 1/6 about x and y, 1/3 about z, on feet at (+-1/2, +-1/2): the impulse at one foot
 * moves another one along n by 1 + 6 (x x' + y y'), and across it like the plate without turning. */
static hk_cone_program table_of(double D[MOST * MOST], const double mu[FEET], const size_t first[FEET],
                                size_t unknowns) {
  static const double at[FEET][2] = {{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}};
  size_t size = unknowns * FEET;
  memset(D, 0, size * size * sizeof *D);
  for (size_t a = 0; a < FEET; a++)
    for (size_t b = 0; b < FEET; b++) {
      double *block = D + unknowns * a * size + unknowns * b;
      block[0] = 1 + 6 * (at[a][0] * at[b][0] + at[a][1] * at[b][1]);
      for (size_t c = 1; c < unknowns; c++) block[c * size + c] = 1;
    }
  return (hk_cone_program){
      .size = size, .count = FEET, .first = first, .mu = mu, .D = D, .matrix = matrix, .room = room};
}

static void a_table_stands_on_four_feet(void **state) {
  static const size_t first[FEET] = {0, 1, 2, 3};
  static const double mu[FEET] = {0}, u_0[FEET] = {-1, -1, -1, -1};
  double D[MOST * MOST], z[FEET] = {3, 0, 0, 0}, sum = 0, turn = 0;
  (void)state;
  hk_cone_program p = table_of(D, mu, first, 1);
  p.u_0 = u_0, p.z = z;
  assert_true(hk_cone_program_solve(&p));
  for (int k = 0; k < FEET; k++) {
    double u = u_0[k];
    for (int j = 0; j < FEET; j++) u += D[FEET * k + j] * z[j];
    assert_true(fabs(u) < off && z[k] > -off);
    sum += z[k];
    turn += k == 0 || k == 3 ? z[k] : -z[k];
  }
  assert_true(fabs(sum - 1) < off && fabs(turn) < off); /* the weight, and no moment */
}

/* Lifted at one side, it is off those feet. */
static void feet_that_leave_do_not_pull(void **state) {
  static const size_t first[FEET] = {0, 1, 2, 3};
  static const double mu[FEET] = {0}, u_0[FEET] = {1, -1, -1, 1};
  double D[MOST * MOST], z[FEET] = {0};
  (void)state;
  hk_cone_program p = table_of(D, mu, first, 1);
  p.u_0 = u_0, p.z = z;
  assert_true(hk_cone_program_solve(&p));
  assert_true(fabs(z[0]) < off && fabs(z[3]) < off && fabs(z[1] - 0.2) < off && fabs(z[2] - 0.2) < off);
}

/* Pushed at 0.4 and 0.6 of its weight, at mu = 0.5: it sticks, or keeps 0.1 and is held down to 0 along n. Each program
 * leaves mu^2 of what the one before left of what slides: 0.05/4^6 after six. */
static void a_block_sticks_below_its_friction_and_slides_above(void **state) {
  static const size_t first[FEET] = {0, 3, 6, 9};
  static const double mu[FEET] = {0.5, 0.5, 0.5, 0.5};
  (void)state;
  for (int slides = 0; slides < 2; slides++) {
    double D[MOST * MOST], z[MOST] = {0}, u_0[MOST], pushed = slides ? 0.6 : 0.4, normal = 0, across = 0, u = 0;
    double left = slides ? 2e-5 : off;
    hk_cone_program p = table_of(D, mu, first, 3);
    for (int k = 0; k < FEET; k++) u_0[3 * k] = -1, u_0[3 * k + 1] = pushed, u_0[3 * k + 2] = 0;
    p.u_0 = u_0, p.z = z;
    assert_true(hk_cone_program_solve(&p));
    for (int j = 0; j < MOST; j++) u += D[j] * z[j];
    for (int k = 0; k < FEET; k++) {
      normal += z[3 * k], across += z[3 * k + 1];
      assert_true(hypot(z[3 * k + 1], z[3 * k + 2]) <= mu[k] * z[3 * k] + off);
    }
    assert_true(fabs(normal - 1) < left && fabs(across + fmin(pushed, 0.5)) < left && fabs(u - 1) < left);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_table_stands_on_four_feet),
      cmocka_unit_test(feet_that_leave_do_not_pull),
      cmocka_unit_test(a_block_sticks_below_its_friction_and_slides_above),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
