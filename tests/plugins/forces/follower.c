/* Follower forces by hand on either end and on both, their power and unsymmetric Jacobian, on chosen particles and
 * where there is no direction. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4, S = 3 };

/* A chain of three edges; the second pulls back. */
static hk_plugin_spec *open_scene(test_engine *e, const char *on) {
  static const double x[N][3] = {{0, 0, 0}, {3, 4, 0}, {3.3, 4.2, 1}, {2, 5, 2}};
  static const double v[3 * N] = {1, -2, 3, 0.5, 1, -1, 0, 2, 1, -1, -1, 0.5};
  test_engine_open(e);
  for (int i = 0; i < N; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  memcpy(e->scene->particles.velocity, v, sizeof v);
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "follower");
  test_edges(e, force, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, S);
  test_list(e, force, "f", (double[]){10, -3, 7}, S);
  if (on) test_text(e, force, "on", on);
  e->options.dt = 1e-3;
  return force;
}

/* 10 N along (3, 4, 0)/5 is (6, 8, 0) N, of the power 6 v_x + 8 v_y; 1e-14: the roundings of a division by 5. */
static void check(const char *on, double first, double second) {
  test_engine e;
  double F[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 3, 4, 0, 2);
  memcpy(e.scene->particles.velocity, (double[]){1, -2, 3, 0.5, 1, -1}, 6 * sizeof(double));
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "follower");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "f", 10);
  if (on) test_text(&e, spec, "on", on);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  assert_true(fabs(force_evaluate(force, &view, F) - first * (6 - 16) - second * (3 + 8)) < 1e-14);
  const double wanted[6] = {6 * first, 8 * first, 0, 6 * second, 8 * second, 0};
  for (int k = 0; k < 6; k++) assert_true(fabs(F[k] - wanted[k]) < 1e-14);
  test_engine_close(&e);
}

static void follower_acts_on_the_end_that_was_chosen_by_hand(void **state) {
  (void)state;
  check(NULL, 0, 1);
  check("second", 0, 1);
  check("first", 1, 0);
  check("both", 0.5, 0.5);
}

static void follower_jacobian_is_the_derivative(void **state) {
  (void)state;
  static const char *const ends[] = {"second", "first", "both"};
  for (int k = 0; k < 3; k++) {
    test_engine e;
    double K[9 * N * N], D[9 * N * N], skew = 0;
    hk_plugin_spec *spec = open_scene(&e, ends[k]);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    assert_true(force_stiffness_error(force, &view) < FORCE_DIFFERENCES && force_damping_error(force, &view) == 0);
    assert_int_equal(force_matrices(force, &view, K, D), k == 2 ? 4 * S : 2 * S);
    for (int r = 0; r < 3 * N; r++)
      for (int c = 0; c < 3 * N; c++) skew = fmax(skew, fabs(K[3 * N * r + c] - K[3 * N * c + r]));
    assert_true(skew > 0.1); /* N/m: it is not symmetric, nor does it say so */
    assert_false(force->plugin->force->flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC));
    test_engine_close(&e);
  }
}

/* Only particles 2 and 3: of the three edges the middle one. */
static void follower_acts_when_both_ends_do(void **state) {
  (void)state;
  test_engine e;
  double F[3 * N], K[9 * N * N], D[9 * N * N], size = 0;
  hk_plugin_spec *spec = open_scene(&e, NULL);
  spec->only = malloc(2 * sizeof *spec->only);
  spec->only[0] = 1, spec->only[1] = 2;
  spec->only_count = 2;
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  for (int k = 0; k < 3 * N; k++) assert_true(k / 3 == 2 || F[k] == 0);
  for (int c = 0; c < 3; c++) size += F[6 + c] * F[6 + c];
  assert_true(fabs(size - 9) < 1e-14 && F[8] < 0); /* 3 N, down the edge */
  assert_int_equal(force_matrices(force, &view, K, D), 2);
  assert_true(force_stiffness_error(force, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

static void ends_at_one_point_get_no_force_and_no_nan(void **state) {
  (void)state;
  const double near[] = {0, 4e-324, 1e-163, 1e-150};
  for (size_t d = 0; d < sizeof near / sizeof *near; d++) {
    test_engine e;
    double F[6], K[36], D[36];
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1), test_particle(&e, 0, near[d], 0, 1);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "follower");
    test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
    test_number(&e, spec, "f", 10);
    e.options.dt = 1e-3;
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    force_evaluate(force, &view, F);
    force_matrices(force, &view, K, D);
    for (int q = 0; q < 6; q++)
      assert_true(isfinite(F[q]) && fabs(F[q]) <= 10 * (1 + 1e-15) && (near[d] > 0 || F[q] == 0));
    for (int q = 0; q < 36; q++) assert_true(isfinite(K[q]) && (near[d] > 0 || K[q] == 0));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(follower_acts_on_the_end_that_was_chosen_by_hand),
      cmocka_unit_test(follower_jacobian_is_the_derivative),
      cmocka_unit_test(follower_acts_when_both_ends_do),
      cmocka_unit_test(ends_at_one_point_get_no_force_and_no_nan),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
