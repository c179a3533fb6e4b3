/* Cubic springs by hand, against their energy and against differences of themselves, as an oscillator of known period,
 * projected when pressed, on chosen particles, after deaths, at coincidence and without memory. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 6, S = 8 };

/* A tetrahedron and a tail; some springs pressed, some stretched, one without rest length, one pair doubled. */
static hk_plugin_spec *open_scene(test_engine *e, bool rest) {
  static const double x[N][3] = {{0, 0, 0}, {1, 0.2, -0.1}, {0.3, 1.1, 0}, {0.2, 0.3, 0.9}, {1.2, 1.3, 1.1}, {2, 1, 1}};
  static const uint32_t edge[S][2] = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {4, 2}, {4, 5}, {5, 4}, {5, 6}};
  test_engine_open(e);
  for (int i = 0; i < N; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "cubic_springs");
  test_edges(e, springs, edge, S);
  test_list(e, springs, "k", (double[]){50, 60, 70, 20, 30, 80, 10, 40}, S);
  if (rest) test_list(e, springs, "rest", (double[]){0.4, 0.9, 1.9, 0, 1.8, 2, 1.1, 0.4}, S);
  e->options.dt = 1e-3;
  return springs;
}

/* From (0,0,0) to (2,0,0) with rest 1/2 and k = 4: 4 1.5^3 = 13.5 N; energy 1.5^4 = 5.0625 J. All exact in binary. */
static void cubic_springs_by_hand(void **state) {
  (void)state;
  test_engine e;
  double F[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 2, 0, 0, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "cubic_springs");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "k", 4);
  test_number(&e, spec, "rest", 0.5);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  force_evaluate(springs, &view, F);
  assert_memory_equal(F, ((double[]){13.5, 0, 0, -13.5, 0, 0}), sizeof F);
  assert_true(springs->plugin->force->energy(springs->self, &view) == 5.0625);
  assert_null(hk_force_of(springs->plugin)->elements.list); /* there is no stiffness to offer */
  test_engine_close(&e);
}

static void cubic_springs_force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, true);
  double F[3 * N], K[9 * N * N], D[9 * N * N];
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  assert_true(force_evaluate(springs, &view, F) == 0);
  assert_true(force_gradient_error(springs, &view) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
  assert_int_equal(force_matrices(springs, &view, K, D), 4 * S);
  for (int r = 0; r < 3 * N; r++)
    for (int c = 0; c < 3 * N; c++)
      assert_true(fabs(K[3 * N * r + c] - K[3 * N * c + r]) < 1e-12 && D[3 * N * r + c] == 0); /* 12: of some 300 N/m */
  test_engine_close(&e);
}

/* x'' = -k x^3 / m from rest at amplitude a: period 4 sqrt(2 m / k) / a times the integral of 1/sqrt(1 - s^4) from 0 to
 * 1, 1.3110287771460599 (half the lemniscate's constant). rk4 at 4000 steps a period: (2 pi / 4000)^4 = 6e-12. */
static void the_cubic_oscillator_has_its_period(void **state) {
  (void)state;
  test_engine e;
  double k = 3, m = 0.7, a = 0.4, period = 4 * sqrt(2 * m / k) / a * 1.3110287771460599;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 0, 2 + a, 0, m);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "cubic_springs");
  test_edges(&e, springs, (const uint32_t[][2]){{2, 1}}, 1);
  test_number(&e, springs, "k", k);
  test_number(&e, springs, "rest", 2);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->duration = period;
  e.scene->fps = 4 / period;
  e.options.dt = period / 4000;
  test_run(&e);
  test_advance(&e, period / 4);
  assert_true(fabs(test_position(&e, 2)[1] - 2) < 1e-10 &&
              fabs(test_velocity(&e, 2)[1] + a * a * sqrt(k / m / 2)) < 1e-10);
  test_advance(&e, period);
  assert_true(fabs(test_position(&e, 2)[1] - 2 - a) < 1e-10 && fabs(test_velocity(&e, 2)[1]) < 1e-10);
  test_engine_close(&e);
}

static void blocks(const hk_instance *springs, const hk_view *view, unsigned want, double K[S][4][9]) {
  static double none[S][4][9];
  size_t slot[4 * S];
  for (size_t b = 0; b < 4 * S; b++) slot[b] = b;
  memset(K, 0, S * sizeof *K);
  hk_blocks into = {.slot = slot, .K = &K[0][0][0], .D = &none[0][0][0], .want = want};
  assert_int_equal(hk_force_of(springs->plugin)->implicit.jacobian(springs->self, view, &into), HK_OK);
}

/* Along each spring and across it, from its diagonal block: stretched springs are the same whatever is wanted, pressed
 * ones lose their lateral part alone. 1e-12: roundings of some 300 N/m. */
static void pressed_springs_are_projected_when_that_is_wanted(void **state) {
  (void)state;
  static const uint32_t edge[S][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {3, 1}, {3, 4}, {4, 3}, {4, 5}};
  static const double rest[S] = {0.4, 0.9, 1.9, 0, 1.8, 2, 1.1, 0.4}, k[S] = {50, 60, 70, 20, 30, 80, 10, 40};
  test_engine e;
  double exact[S][4][9], kept[S][4][9], projected[S][4][9];
  hk_plugin_spec *spec = open_scene(&e, true);
  int pressed = 0;
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  blocks(springs, &view, 0, exact);
  blocks(springs, &view, HK_WANT_SYMMETRIC, kept);
  blocks(springs, &view, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE, projected);
  assert_memory_equal(exact, kept, sizeof exact);
  for (int s = 0; s < S; s++) {
    double n[3], l = 0, axial = 0, trace = 0;
    for (int c = 0; c < 3; c++) n[c] = view.x[3 * edge[s][1] + c] - view.x[3 * edge[s][0] + c], l += n[c] * n[c];
    l = sqrt(l);
    for (int q = 0; q < 9; q++) axial += projected[s][0][q] * n[q / 3] * n[q % 3] / (l * l);
    for (int q = 0; q < 9; q += 4) trace += projected[s][0][q];
    double stretch = l - rest[s], lateral = k[s] * pow(stretch, 3) / l;
    pressed += stretch < 0;
    assert_true(fabs(axial - 3 * k[s] * stretch * stretch) < 1e-12);
    assert_true(fabs(trace - axial - 2 * fmax(lateral, 0)) < 1e-12);
    if (stretch > 0) assert_memory_equal(exact[s], projected[s], sizeof exact[s]);
    for (int q = 0; q < 9; q++)
      assert_true(projected[s][0][q] == -projected[s][1][q] && projected[s][0][q] == projected[s][3][q]);
  }
  assert_true(pressed >= 2 && pressed <= S - 2);
  assert_true(springs->plugin->force->flags & HK_OFFERS_DEFINITE);
  test_engine_close(&e);
}

/* Only particles 1, 2 and 4, as in a scene where 1-2, 1-4 and 4-2 are all there is. */
static void cubic_springs_act_when_both_ends_do(void **state) {
  (void)state;
  test_engine e, wanted;
  double F[3 * N], G[3 * N], K[9 * N * N], D[9 * N * N];
  hk_plugin_spec *springs_spec = open_scene(&e, true), *others_spec = open_scene(&wanted, true);
  springs_spec->only = malloc(3 * sizeof *springs_spec->only);
  memcpy(springs_spec->only, (uint32_t[]){0, 1, 3}, 3 * sizeof(uint32_t));
  springs_spec->only_count = 3;
  test_list(&wanted, others_spec, "k", (double[]){50, 0, 0, 20, 30, 0, 0, 0}, S);
  test_run(&e);
  hk_instance *springs = test_instance(&e, springs_spec);
  test_run(&wanted);
  hk_instance *others = test_instance(&wanted, others_spec);
  hk_view view = force_view(&e, springs), all = force_view(&wanted, others);
  force_evaluate(springs, &view, F);
  force_evaluate(others, &all, G);
  for (int q = 0; q < 3 * N; q++) assert_true(F[q] == G[q]);
  assert_true(springs->plugin->force->energy(springs->self, &view) ==
              others->plugin->force->energy(others->self, &all));
  assert_int_equal(force_matrices(springs, &view, K, D), 4 * 3);
  assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
  test_engine_close(&wanted);
}

/* Rest lengths left out are those of the start, also after particle 3 died and the list of springs is a shorter one. */
static void cubic_springs_follow_deaths_with_their_initial_lengths(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, false);
  const uint32_t map[N] = {0, 1, UINT32_MAX, 2, 3, 4};
  double F[2][3 * N], x[3 * N];
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  force_evaluate(springs, &view, F[0]);
  for (int q = 0; q < 3 * N; q++) assert_true(F[0][q] == 0);
  memcpy(x, view.x, sizeof x);
  for (int q = 0; q < 3 * N; q++) x[q] *= 1 + 0.05 * q;
  view.x = x;
  force_evaluate(springs, &view, F[0]);
  memmove(x + 6, x + 9, 9 * sizeof *x);
  view.n = view.acting = N - 1;
  assert_int_equal(hk_instance_remap(springs, map, N, &view, 6 * N - 5, &e.error), HK_OK);
  force_evaluate(springs, &view, F[1]);
  assert_true(F[0][14] != 0);
  assert_memory_equal(F[0] + 12, F[1] + 9, 6 * sizeof(double)); /* the tail did not know the dead */
  assert_true(force_gradient_error(springs, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

static void coincident_ends_get_no_force_and_no_nan(void **state) {
  (void)state;
  const double near[] = {0, 4e-324, 1e-163, 1e-158, 1e-150, 1e-20};
  for (int rest = 0; rest < 2; rest++)
    for (size_t d = 0; d < sizeof near / sizeof *near; d++) {
      test_engine e;
      double F[6], K[36], D[36];
      test_engine_open(&e);
      test_particle(&e, 0, 0, 0, 1), test_particle(&e, 0, near[d], 0, 1);
      hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "cubic_springs");
      test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
      test_number(&e, spec, "k", 1000);
      test_number(&e, spec, "rest", 0.1 * rest);
      e.options.dt = 1e-3;
      test_run(&e);
      hk_instance *springs = test_instance(&e, spec);
      hk_view view = force_view(&e, springs);
      force_evaluate(springs, &view, F);
      force_matrices(springs, &view, K, D);
      for (int q = 0; q < 6; q++) assert_true(isfinite(F[q]) && (near[d] > 0 || F[q] == 0));
      for (int q = 0; q < 36; q++) assert_true(isfinite(K[q]) && (near[d] > 0 || K[q] == 0));
      test_engine_close(&e);
    }
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    open_scene(&e, false);
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 1);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cubic_springs_by_hand),
      cmocka_unit_test(cubic_springs_force_and_jacobian_are_derivatives),
      cmocka_unit_test(the_cubic_oscillator_has_its_period),
      cmocka_unit_test(pressed_springs_are_projected_when_that_is_wanted),
      cmocka_unit_test(cubic_springs_act_when_both_ends_do),
      cmocka_unit_test(cubic_springs_follow_deaths_with_their_initial_lengths),
      cmocka_unit_test(coincident_ends_get_no_force_and_no_nan),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
