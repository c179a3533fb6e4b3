/* Ropes by hand taut, slack and held off by their damping; against their energy and differences of themselves; as
 * springs where all are taut; on chosen particles, after deaths and without memory. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 5, S = 6 };

/* A tetrahedron and a tail. `rest`: NULL for the lengths at the start. */
static hk_plugin_spec *open_scene(test_engine *e, const char *plugin, const double *rest) {
  static const double x[N][3] = {{0, 0, 0}, {1, 0.2, -0.1}, {0.3, 1.1, 0}, {0.2, 0.3, 0.9}, {1.2, 1.3, 1.1}};
  static const double v[3 * N] = {0.3, -1, 0.5, 1, 0, 2, -1, 1, 0.2, 0, 0.5, 1, 2, 1, -1};
  test_engine_open(e);
  for (int i = 0; i < N; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  memcpy(e->scene->particles.velocity, v, sizeof v);
  hk_plugin_spec *ropes = test_plugin(e, HK_FORCE, plugin);
  test_edges(e, ropes, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 1}, {1, 4}, {4, 2}, {4, 5}}, S);
  test_list(e, ropes, "k", (double[]){50, 60, 70, 20, 30, 80}, S);
  test_list(e, ropes, "damping", (double[]){0.5, 0, 2, 1, 3, 0.3}, S);
  if (rest) test_list(e, ropes, "rest", rest, S);
  e->options.dt = 1e-3;
  return ropes;
}

static const double some_taut[S] = {0.4, 2, 0.5, 0, 1.8, 1.1}; /* the second and the fifth are slack */

/* Along x, length 2, k = 8, c = 2. */
static double pull(double rest, double rate, double *power) {
  test_engine e;
  double F[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 2, 0, 0, 1);
  memcpy(e.scene->particles.velocity, (double[]){1, 3, 0, 1 + rate, -2, 0}, 6 * sizeof(double));
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "ropes");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "k", 8);
  test_number(&e, spec, "damping", 2);
  test_number(&e, spec, "rest", rest);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *ropes = test_instance(&e, spec);
  hk_view view = force_view(&e, ropes);
  *power = force_evaluate(ropes, &view, F);
  assert_true(F[0] == -F[3] && F[1] == 0 && F[2] == 0 && F[4] == 0 && F[5] == 0);
  assert_true(ropes->plugin->force->energy(ropes->self, &view) == (rest < 2 ? 4 * (2 - rest) * (2 - rest) : 0));
  assert_null(hk_force_of(ropes->plugin)->elements.list); /* who works spring by spring would push */
  test_engine_close(&e);
  return F[0];
}

/* All exact in binary. A rope that slackens faster than its pull, c u > k s, does not push: what its stretch gives
 * back, 4 N at 3 m/s, is lost. */
static void ropes_by_hand(void **state) {
  (void)state;
  double power;
  assert_true(pull(1.5, 0, &power) == 4 && power == 0);
  assert_true(pull(1.5, 0.5, &power) == 5 && power == -0.5);
  assert_true(pull(1.5, -0.5, &power) == 3 && power == -0.5);
  assert_true(pull(1.5, -3, &power) == 0 && power == -12);
  assert_true(pull(2, 1, &power) == 0 && power == 0);
  assert_true(pull(3, 1, &power) == 0 && power == 0);
}

static void ropes_force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  test_engine e;
  double still[3 * N] = {0};
  hk_plugin_spec *spec = open_scene(&e, "ropes", some_taut);
  test_run(&e);
  hk_instance *ropes = test_instance(&e, spec);
  hk_view view = force_view(&e, ropes), resting = view;
  resting.v = still;
  assert_true(force_gradient_error(ropes, &resting) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(ropes, &view) < FORCE_DIFFERENCES);
  assert_true(force_damping_error(ropes, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

/* Where all are taut they are springs, for forces, energy and blocks; 1e-12: roundings of some 300 N and N/m. */
static void taut_ropes_are_springs(void **state) {
  (void)state;
  static const double short_ones[S] = {0.4, 0.9, 0.5, 0, 0.3, 1.1};
  test_engine e, other;
  double F[3 * N], G[3 * N], K[9 * N * N], D[9 * N * N], L[9 * N * N], E[9 * N * N];
  hk_plugin_spec *ropes_spec = open_scene(&e, "ropes", short_ones),
                 *springs_spec = open_scene(&other, "springs", short_ones);
  test_run(&e);
  hk_instance *ropes = test_instance(&e, ropes_spec);
  test_run(&other);
  hk_instance *springs = test_instance(&other, springs_spec);
  hk_view view = force_view(&e, ropes), same = force_view(&other, springs);
  double power = force_evaluate(ropes, &view, F);
  assert_true(power < -0.1 && fabs(power - force_evaluate(springs, &same, G)) < 1e-12);
  assert_true(fabs(ropes->plugin->force->energy(ropes->self, &view) -
                   springs->plugin->force->energy(springs->self, &same)) < 1e-12);
  assert_int_equal(force_matrices(ropes, &view, K, D), 4 * S);
  force_matrices(springs, &same, L, E);
  for (int q = 0; q < 3 * N; q++) assert_true(fabs(F[q] - G[q]) < 1e-12);
  for (int q = 0; q < 9 * N * N; q++) assert_true(fabs(K[q] - L[q]) < 1e-12 && fabs(D[q] - E[q]) < 1e-12);
  test_engine_close(&e);
  test_engine_close(&other);
}

/* K as a method wants it that takes symmetric matrices alone: symmetric, and no negative energy in random directions.
 */
static void the_symmetric_part_is_definite(void **state) {
  (void)state;
  test_engine e;
  size_t slot[4 * S];
  double K[4 * S][9], D[4 * S][9], skew = 0;
  hk_plugin_spec *spec = open_scene(&e, "ropes", some_taut);
  test_run(&e);
  hk_instance *ropes = test_instance(&e, spec);
  hk_view view = force_view(&e, ropes);
  for (int definite = 0; definite < 2; definite++) {
    memset(K, 0, sizeof K), memset(D, 0, sizeof D);
    for (size_t b = 0; b < 4 * S; b++) slot[b] = b;
    hk_blocks into = {.slot = slot, .K = &K[0][0], .D = &D[0][0]};
    into.want = definite ? HK_WANT_SYMMETRIC | HK_WANT_DEFINITE : 0;
    assert_int_equal(hk_force_of(ropes->plugin)->implicit.jacobian(ropes->self, &view, &into), HK_OK);
    for (int s = 0; s < 4 * S; s += 4)
      for (int q = 0; q < 9; q++) {
        double transposed = K[s][3 * (q % 3) + q / 3];
        if (definite)
          assert_true(fabs(K[s][q] - transposed) < 1e-14 * 100); /* of 100 N/m */
        else
          skew = fmax(skew, fabs(K[s][q] - transposed));
      }
  }
  assert_true(skew > 0.1); /* the damping of ropes that turn is in it where nothing is wanted */
  for (int s = 0; s < 4 * S; s += 4)
    for (int k = 0; k < 50; k++) {
      double z[3] = {sin(k), sin(2.3 * k), cos(1.7 * k)}, sum = 0;
      for (int q = 0; q < 9; q++) sum += z[q / 3] * K[s][q] * z[q % 3];
      assert_true(sum >= -1e-12 && (s / 4 == 1 || s / 4 == 4 ? sum == 0 : sum > 0));
    }
  test_engine_close(&e);
}

/* Only particles 1, 3 and 4, as in a scene where 3-1 and 1-4 are all there is. */
static void ropes_act_when_both_ends_do(void **state) {
  (void)state;
  test_engine e, wanted;
  double F[3 * N], G[3 * N], K[9 * N * N], D[9 * N * N];
  hk_plugin_spec *ropes_spec = open_scene(&e, "ropes", some_taut),
                 *others_spec = open_scene(&wanted, "ropes", some_taut);
  ropes_spec->only = malloc(3 * sizeof *ropes_spec->only);
  memcpy(ropes_spec->only, (uint32_t[]){0, 2, 3}, 3 * sizeof(uint32_t));
  ropes_spec->only_count = 3;
  test_list(&wanted, others_spec, "k", (double[]){0, 0, 70, 20, 0, 0}, S);
  test_list(&wanted, others_spec, "damping", (double[]){0, 0, 2, 1, 0, 0}, S);
  test_run(&e);
  hk_instance *ropes = test_instance(&e, ropes_spec);
  test_run(&wanted);
  hk_instance *others = test_instance(&wanted, others_spec);
  hk_view view = force_view(&e, ropes), all = force_view(&wanted, others);
  assert_true(force_evaluate(ropes, &view, F) == force_evaluate(others, &all, G));
  for (int q = 0; q < 3 * N; q++) assert_true(F[q] == G[q]);
  assert_true(ropes->plugin->force->energy(ropes->self, &view) == others->plugin->force->energy(others->self, &all));
  assert_int_equal(force_matrices(ropes, &view, K, D), 4 * 2);
  assert_true(force_stiffness_error(ropes, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
  test_engine_close(&wanted);
}

/* Lengths left out are those of the start, also after particle 3 died: the tail does not know it. */
static void ropes_follow_deaths_with_their_initial_lengths(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, "ropes", NULL);
  const uint32_t map[N] = {0, 1, UINT32_MAX, 2, 3};
  double F[2][3 * N], x[3 * N], still[3 * N] = {0};
  test_run(&e);
  hk_instance *ropes = test_instance(&e, spec);
  hk_view view = force_view(&e, ropes);
  force_evaluate(ropes, &view, F[0]);
  for (int q = 0; q < 3 * N; q++) assert_true(F[0][q] == 0);
  for (int q = 0; q < 3 * N; q++) x[q] = 1.5 * view.x[q];
  view.x = x, view.v = still;
  force_evaluate(ropes, &view, F[0]);
  memmove(x + 6, x + 9, 6 * sizeof *x);
  view.n = view.acting = N - 1;
  assert_int_equal(hk_instance_remap(ropes, map, N, &view, 6 * N - 5, &e.error), HK_OK);
  force_evaluate(ropes, &view, F[1]);
  assert_true(F[0][12] < -1);
  assert_memory_equal(F[0] + 12, F[1] + 9, 3 * sizeof(double));
  test_engine_close(&e);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    open_scene(&e, "ropes", NULL);
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
      cmocka_unit_test(ropes_by_hand),
      cmocka_unit_test(ropes_force_and_jacobian_are_derivatives),
      cmocka_unit_test(taut_ropes_are_springs),
      cmocka_unit_test(the_symmetric_part_is_definite),
      cmocka_unit_test(ropes_act_when_both_ends_do),
      cmocka_unit_test(ropes_follow_deaths_with_their_initial_lengths),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
