/* Moves of implicit stages past contact, on one particle and a wall at x = 0 that repels by 1/x. */
#include "plugins/common/implicit/safe_move.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { SIZE = 7 };
static const double g = 0.5;

static double told_to; /* m, where the last update said that the particle might go */

static hk_status update(hk_system *s, double t, const double *X, const double *x_to) {
  (void)s, (void)t, (void)X;
  told_to = x_to[0];
  return HK_OK;
}

static double step_limit(hk_system *s, double t, const double *X, const double *dx) {
  (void)s, (void)t;
  assert_true(told_to == X[0] + dx[0]); /* the update was for this move */
  return -dx[0] > 0.9 * X[0] ? 0.9 * X[0] / -dx[0] : 1;
}

static hk_status potential(hk_system *s, double t, const double *X, double *joule) {
  (void)s, (void)t;
  *joule = X[0] > 0 ? 1 / X[0] : INFINITY;
  return X[0] > 0 ? HK_OK : HK_NOT_FINITE;
}

static void walled(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y;
  a[0] = 1 / (x[0] * x[0]);
  a[1] = a[2] = dy[0] = 0;
}

static fake_system *wall(void) {
  fake_system *f = fake_system_create(&(fake_problem){.n = 1, .flags = HK_DEPENDS_ON_X, .f = walled});
  f->contact = (hk_contact_table){.update = update, .step_limit = step_limit, .potential = potential};
  f->system.contact = &f->contact;
  f->system.X[0] = 1;
  return f;
}

/* x* = 1 and the velocity `v`, on the way to x = 1 + g v. */
static void start(fake_system *f, double v, double base[SIZE], double X[SIZE], bool safe) {
  double dx[3], scratch[3];
  memset(base, 0, SIZE * sizeof *base);
  memset(X, 0, SIZE * sizeof *X);
  base[0] = 1;
  X[3] = v;
  hk_stage stage = {.g = g, .base = base, .X = X};
  bool found;
  assert_int_equal(hk_safe_start(&f->system, &stage, dx, scratch, &found), HK_OK);
  assert_int_equal(found, safe);
}

static void a_safe_guess_is_kept(void **state) {
  (void)state;
  fake_system *f = wall();
  double base[SIZE], X[SIZE];
  start(f, -1, base, X, true);
  assert_true(X[0] == 0.5 && X[3] == -1);
  fake_system_destroy(f);
}

static void a_guess_behind_contact_starts_where_the_step_does(void **state) {
  (void)state;
  fake_system *f = wall();
  double base[SIZE], X[SIZE];
  start(f, -4, base, X, true); /* to x = -1 */
  assert_true(X[0] == 1 && X[3] == 0);
  fake_system_destroy(f);
}

static void jump(hk_system *s, double t, double *x, double *v) {
  (void)s, (void)t, (void)v;
  x[0] = -1;
}

static void a_scripted_way_through_contact_is_told_apart(void **state) {
  (void)state;
  fake_system *f = wall();
  double base[SIZE], X[SIZE];
  f->system.impose = jump;
  start(f, -1, base, X, false);
  fake_system_destroy(f);
}

static void an_end_behind_contact_is_refused(void **state) {
  (void)state;
  fake_system *f = wall();
  double stage[3] = {0.5, 0, 0}, X[3] = {0.2, 0, 0}, dx[3], scratch[3];
  assert_int_equal(hk_safe_end(&f->system, 1, stage, X, dx, scratch), HK_OK);
  X[0] = -0.1;
  assert_int_equal(hk_safe_end(&f->system, 1, stage, X, dx, scratch), HK_NOT_CONVERGED);
  fake_system_destroy(f);
}

/* By central differences: M (v - v*) - g F, which is 1 (v + 2) - g/x^2; off by h^2 g^3 of the third derivative 6/x^4,
 * at x = 0.5 1e-10 of 96/8. */
static void potential_has_the_residual_for_its_gradient(void **state) {
  (void)state;
  fake_system *f = wall();
  double base[SIZE] = {1, 0, 0, -2}, X[SIZE] = {0}, value[2], v = -1, h = 1e-5;
  hk_stage stage = {.g = g, .base = base, .X = X};
  for (int side = 0; side < 2; side++) {
    X[3] = v + (side ? -h : h);
    X[0] = base[0] + g * X[3];
    assert_int_equal(hk_stage_potential(&f->system, &stage, &value[side]), HK_OK);
  }
  assert_true(fabs((value[0] - value[1]) / (2 * h) - ((v + 2) - g / 0.25)) < 1e-8);
  X[0] = -1;
  assert_int_equal(hk_stage_potential(&f->system, &stage, &value[0]), HK_OK);
  assert_true(isinf(value[0]));
  fake_system_destroy(f);
}

static void nothing_is_filtered(hk_system *s, double *vector) { (void)s, (void)vector; }

/* Beside the wall of 1/x, at x = 1: -1 m/s in a stage of g = 1/2 s ends at x = 1/2, above rest by 1/2 + 2 - 1; forces
 * that gave 4 W may have lifted it so far. With the velocity that it had it goes on, below. */
static void solutions_above_rest_are_told_apart(void **state) {
  (void)state;
  fake_system *f = wall();
  double base[SIZE] = {1, 0, 0, 0}, X[SIZE] = {0}, rest[3];
  hk_stage stage = {.g = g, .base = base, .X = X};
  bool above;
  f->system.filter = nothing_is_filtered;
  static const struct end {
    double v, start_speed, power;
    bool above;
  } ends[] = {{-1, 0, 0, true}, {-1, 0, 4, false}, {0.2, 0.2, 0, false}, {1, 0, 0, true}};
  for (size_t k = 0; k < sizeof ends / sizeof *ends; k++) {
    base[3] = ends[k].start_speed;
    X[3] = ends[k].v;
    X[0] = base[0] + g * X[3];
    double before[SIZE];
    memcpy(before, X, sizeof X);
    assert_int_equal(hk_stage_above_rest(&f->system, &stage, ends[k].power, rest, &above), HK_OK);
    assert_int_equal(above, ends[k].above);
    for (int e = 0; e < SIZE; e++) assert_true(fabs(X[e] - before[e]) < 1e-15);
    assert_true(rest[0] == 0 && rest[1] == 0 && rest[2] == 0);
  }
  fake_system_destroy(f);
}

static void only_gradients_with_contact_are_minimised(void **state) {
  (void)state;
  fake_system *f = wall();
  hk_force_info force[2] = {{.label = "wall", .gradient = true}, {.label = "drag"}};
  bool takes[2] = {true, true};
  f->split = (hk_split_table){.forces = 2, .force = force, .takes = takes};
  assert_false(hk_stage_minimises(&f->system));
  takes[1] = false;
  assert_true(hk_stage_minimises(&f->system));
  f->system.contact = NULL;
  assert_false(hk_stage_minimises(&f->system));
  fake_system_destroy(f);
}

static void a_search_ends_only_where_the_potential_falls(void **state) {
  (void)state;
  hk_descent d = {.known = true, .start = 1, .slope = -1};
  assert_true(hk_descent_falls(&d, 0.9, 1, false));
  assert_false(hk_descent_falls(&d, 1 - 1e-5, 1, false)); /* less than 1e-4 of the slope, and past the lowest point */
  assert_false(hk_descent_falls(&d, 1.1, 1, true));
  assert_false(hk_descent_falls(&d, INFINITY, 1, true));
  assert_false(hk_descent_falls(&d, NAN, 1, true));
  d.slope = -1e-20; /* below the rounding of the potential, the derivative decides */
  assert_true(hk_descent_falls(&d, 1 + 1e-15, 1, true));
  assert_false(hk_descent_falls(&d, 1 + 1e-15, 1, false));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_safe_guess_is_kept),
      cmocka_unit_test(a_guess_behind_contact_starts_where_the_step_does),
      cmocka_unit_test(a_scripted_way_through_contact_is_told_apart),
      cmocka_unit_test(an_end_behind_contact_is_refused),
      cmocka_unit_test(potential_has_the_residual_for_its_gradient),
      cmocka_unit_test(solutions_above_rest_are_told_apart),
      cmocka_unit_test(only_gradients_with_contact_are_minimised),
      cmocka_unit_test(a_search_ends_only_where_the_potential_falls),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
