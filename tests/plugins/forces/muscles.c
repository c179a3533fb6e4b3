/* Muscles by hand: a tension pulls both ends together with one force and no moment; a function of time; power,
 * Jacobian, chosen particles, and ends at one point. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4, S = 3 };

/* A chain of three edges under a tension of 10 N. */
static hk_plugin_spec *open_scene(test_engine *e) {
  static const double x[N][3] = {{0, 0, 0}, {3, 4, 0}, {3.3, 4.2, 1}, {2, 5, 2}};
  static const double v[3 * N] = {1, -2, 3, 0.5, 1, -1, 0, 2, 1, -1, -1, 0.5};
  test_engine_open(e);
  for (int i = 0; i < N; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  memcpy(e->scene->particles.velocity, v, sizeof v);
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "muscles");
  test_edges(e, force, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, S);
  test_number(e, force, "tension", 10);
  e->options.dt = 1e-3;
  return force;
}

/* 10 N along (3, 4, 0)/5 is (6, 8, 0) N on the first end, of the power 6 (1 - 0.5) + 8 (-2 - 1) W; 1e-14: the roundings
 * of a division by 5. */
static void a_tension_pulls_both_ends_together_by_hand(void **state) {
  (void)state;
  test_engine e;
  double F[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 3, 4, 0, 2);
  memcpy(e.scene->particles.velocity, (double[]){1, -2, 3, 0.5, 1, -1}, 6 * sizeof(double));
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "muscles");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "tension", 10);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  assert_true(fabs(force_evaluate(force, &view, F) - (6 * 0.5 + 8 * -3)) < 1e-13);
  const double wanted[6] = {6, 8, 0, -6, -8, 0};
  for (int k = 0; k < 6; k++) assert_true(fabs(F[k] - wanted[k]) < 1e-14);
  test_engine_close(&e);
}

static void muscles_change_no_momentum_and_no_angular_momentum(void **state) {
  (void)state;
  test_engine e;
  double F[3 * N], sum[3] = {0}, moment[3] = {0};
  hk_plugin_spec *spec = open_scene(&e);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  for (int i = 0; i < N; i++)
    for (int c = 0; c < 3; c++) {
      const int a = 3 * i + (c + 1) % 3, b = 3 * i + (c + 2) % 3;
      sum[c] += F[3 * i + c];
      moment[c] += view.x[a] * F[b] - view.x[b] * F[a];
    }
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-14 && fabs(moment[c]) < 1e-13);
  test_engine_close(&e);
}

static void muscles_jacobian_is_the_derivative(void **state) {
  (void)state;
  test_engine e;
  double K[9 * N * N], D[9 * N * N];
  hk_plugin_spec *spec = open_scene(&e);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  assert_true(force_stiffness_error(force, &view) < FORCE_DIFFERENCES && force_damping_error(force, &view) == 0);
  assert_int_equal(force_matrices(force, &view, K, D), 4 * S);
  for (int r = 0; r < 3 * N; r++)
    for (int c = 0; c < r; c++) assert_true(fabs(K[3 * N * r + c] - K[3 * N * c + r]) < 1e-14);
  test_engine_close(&e);
}

/* Only particles 2 and 3: of the three edges the middle one. */
static void muscles_act_when_both_ends_do(void **state) {
  (void)state;
  test_engine e;
  double F[3 * N], size = 0;
  hk_plugin_spec *spec = open_scene(&e);
  spec->only = malloc(2 * sizeof *spec->only);
  spec->only[0] = 1, spec->only[1] = 2;
  spec->only_count = 2;
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  for (int c = 0; c < 3; c++) {
    assert_true(F[c] == 0 && F[9 + c] == 0 && F[3 + c] == -F[6 + c]);
    size += F[3 + c] * F[3 + c];
  }
  assert_true(fabs(size - 100) < 1e-12);
  test_engine_close(&e);
}

static void ends_at_one_point_get_no_force_and_no_nan(void **state) {
  (void)state;
  const double near[] = {0, 4e-324, 1e-163, 1e-140};
  for (size_t d = 0; d < sizeof near / sizeof *near; d++) {
    test_engine e;
    double F[6], K[36], D[36];
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1), test_particle(&e, 0, near[d], 0, 1);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "muscles");
    test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
    test_number(&e, spec, "tension", 10);
    e.options.dt = 1e-300; /* the ends stay where they are */
    e.options.until = 0;
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    force_evaluate(force, &view, F);
    force_matrices(force, &view, K, D);
    for (int q = 0; q < 6; q++) assert_true(isfinite(F[q]) && fabs(F[q]) == (q % 3 == 1 && d == 3 ? 10 : 0));
    for (int q = 0; q < 36; q++) assert_true(isfinite(K[q]));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tension_pulls_both_ends_together_by_hand),
      cmocka_unit_test(muscles_change_no_momentum_and_no_angular_momentum),
      cmocka_unit_test(muscles_jacobian_is_the_derivative),
      cmocka_unit_test(muscles_act_when_both_ends_do),
      cmocka_unit_test(ends_at_one_point_get_no_force_and_no_nan),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
