/* Springs against their own energy, power and Jacobian; on chosen particles; after deaths; next to coincidence; and
 * without memory. (springs.c holds the kernel against the plain loop.) */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A tetrahedron and a tail, every spring another one, none at rest; one has no rest length and one pair is doubled. */
static hk_plugin_spec *open_scene(test_engine *e, bool damped, bool rest) {
  static const double x[6][3] = {{0, 0, 0}, {1, 0.2, -0.1}, {0.3, 1.1, 0}, {0.2, 0.3, 0.9}, {1.2, 1.3, 1.1}, {2, 1, 1}};
  static const uint32_t edge[8][2] = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {4, 2}, {4, 5}, {5, 4}, {5, 6}};
  test_engine_open(e);
  for (int i = 0; i < 6; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  for (size_t k = 0; k < 18; k++) e->scene->particles.velocity[k] = sin(1.7 * (double)k);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, edge, 8);
  test_list(e, springs, "k", (double[]){50, 60, 70, 20, 30, 80, 10, 40}, 8);
  if (damped) test_list(e, springs, "damping", (double[]){5, 6, 0, 2, 3, 8, 1, 4}, 8);
  if (rest) test_list(e, springs, "rest", (double[]){0.8, 0.9, 1.5, 0, 1.1, 2, 1.7, 0.4}, 8);
  e->options.dt = 1e-3;
  return springs;
}

static void springs_force_is_minus_energy_gradient(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, false, true);
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  double F[18];
  assert_true(force_gradient_error(springs, &view) < FORCE_DIFFERENCES);
  assert_true(force_evaluate(springs, &view, F) == 0);
  test_engine_close(&e);
}

static void springs_jacobian_is_exact_with_and_without_damping(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, damped, true);
    test_run(&e);
    hk_instance *springs = test_instance(&e, spec);
    hk_view view = force_view(&e, springs);
    double K[18 * 18], D[18 * 18], skew = 0;
    assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
    assert_true(force_damping_error(springs, &view) < FORCE_DIFFERENCES);
    assert_int_equal(force_matrices(springs, &view, K, D), 4 * 8);
    for (int r = 0; r < 18; r++)
      for (int c = 0; c < r; c++) skew = fmax(skew, fabs(K[18 * r + c] - K[18 * c + r]));
    assert_true(damped ? skew > 0.1 : skew < 1e-13); /* 13: roundings of some 100 N/m */
    test_engine_close(&e);
  }
}

/* F.v of the damped springs less that of the same springs without damping. Sums of some 20 terms below 100 W. */
static void springs_power_is_that_of_the_damping_alone(void **state) {
  (void)state;
  double F[2][18], power[2], known = 0;
  for (int damped = 0; damped < 2; damped++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, damped, true);
    test_run(&e);
    hk_instance *springs = test_instance(&e, spec);
    hk_view view = force_view(&e, springs);
    power[damped] = force_evaluate(springs, &view, F[damped]);
    for (int k = 0; k < 18 && damped; k++) known += (F[1][k] - F[0][k]) * view.v[k];
    test_engine_close(&e);
  }
  assert_true(power[0] == 0 && power[1] < -1 && fabs(power[1] - known) < 1e-12);
}

/* Only particles 1, 2 and 4: the springs 1-2, 1-4 and 4-2 are left, here alone in a scene of their own. */
static void springs_act_when_both_ends_do(void **state) {
  (void)state;
  test_engine e, wanted;
  double F[18], G[18], K[18 * 18], D[18 * 18];
  hk_plugin_spec *springs_spec = open_scene(&e, true, true), *others_spec = open_scene(&wanted, true, true);
  springs_spec->only = malloc(3 * sizeof *springs_spec->only);
  memcpy(springs_spec->only, (uint32_t[]){0, 1, 3}, 3 * sizeof(uint32_t));
  springs_spec->only_count = 3;
  test_edges(&wanted, others_spec, (const uint32_t[][2]){{1, 2}, {1, 4}, {4, 2}}, 3);
  test_list(&wanted, others_spec, "k", (double[]){50, 20, 30}, 3);
  test_list(&wanted, others_spec, "damping", (double[]){5, 2, 3}, 3);
  test_list(&wanted, others_spec, "rest", (double[]){0.8, 0, 1.1}, 3);
  test_run(&e);
  hk_instance *springs = test_instance(&e, springs_spec);
  test_run(&wanted);
  hk_instance *others = test_instance(&wanted, others_spec);
  hk_view view = force_view(&e, springs), all = force_view(&wanted, others);
  double power = force_evaluate(springs, &view, F);
  assert_true(power == force_evaluate(others, &all, G) && power < 0);
  assert_memory_equal(F, G, sizeof F);
  assert_true(springs->plugin->force->energy(springs->self, &view) ==
              others->plugin->force->energy(others->self, &all));
  assert_int_equal(force_matrices(springs, &view, K, D), 4 * 3);
  assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
  test_engine_close(&wanted);
}

/* Particle 3 dies: its springs go, the others keep their coefficients and their own initial lengths. */
static void springs_follow_deaths(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, true, false);
  const uint32_t map[6] = {0, 1, UINT32_MAX, 2, 3, 4};
  double F[2][18], x[18], v[18], energy[2];
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  memcpy(x, view.x, sizeof x);
  memcpy(v, view.v, sizeof v);
  for (int k = 0; k < 18; k++) x[k] *= 1 + 0.01 * k;
  memcpy(x + 6, (double[]){1e3, 0, 0}, 3 * sizeof *x); /* far away, so that its springs would be felt */
  view.x = x;
  view.v = v;
  double before = force_evaluate(springs, &view, F[0]);
  energy[0] = springs->plugin->force->energy(springs->self, &view);
  memmove(x + 6, x + 9, 9 * sizeof *x);
  memmove(v + 6, v + 9, 9 * sizeof *v);
  view.n = view.acting = 5;
  assert_int_equal(hk_instance_remap(springs, map, 6, &view, 31, &e.error), HK_OK);
  double after = force_evaluate(springs, &view, F[1]);
  energy[1] = springs->plugin->force->energy(springs->self, &view);
  assert_true(energy[1] < energy[0] / 100 && after > before);
  assert_memory_equal(F[0] + 12, F[1] + 9, 6 * sizeof(double)); /* the tail did not know the dead */
  assert_true(force_gradient_error(springs, &view) > 1e-3);     /* damped */
  assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

/* Nine springs or more are taken four at a time, fewer one by one: all from every distance whose square underflows. */
static void springs_of_almost_coincident_particles_are_finite(void **state) {
  (void)state;
  const double near[] = {0, 4e-324, 1e-163, 1e-158, 1e-155, 1e-150, 1e-140, 1e-20};
  const size_t counts[] = {2, 10, 30};
  for (size_t d = 0; d < sizeof near / sizeof *near; d++)
    for (size_t c = 0; c < 3; c++) {
      size_t n = counts[c];
      test_engine e;
      uint32_t edge[29][2];
      double F[90], K[90 * 90], D[90 * 90];
      test_engine_open(&e);
      for (size_t i = 0; i < n; i++) test_particle(&e, near[d] * (double)i, 0, 0, 1);
      for (size_t k = 0; k < 3 * n; k++) e.scene->particles.velocity[k] = sin((double)k);
      for (uint32_t i = 0; i + 1 < n; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
      hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "springs");
      test_edges(&e, spec, (const uint32_t(*)[2])edge, n - 1);
      test_number(&e, spec, "k", 1000);
      test_number(&e, spec, "damping", 3);
      test_number(&e, spec, "rest", 0.1);
      e.options.dt = 1e-3;
      test_run(&e);
      hk_instance *springs = test_instance(&e, spec);
      hk_view view = force_view(&e, springs);
      assert_true(isfinite(force_evaluate(springs, &view, F)));
      force_matrices(springs, &view, K, D);
      for (size_t k = 0; k < 3 * n; k++) assert_true(isfinite(F[k]) && (near[d] > 0 || F[k] == 0));
      for (size_t k = 0; k < 9 * n * n; k++) assert_true(isfinite(K[k]) && isfinite(D[k]));
      test_engine_close(&e);
    }
}

static const uint64_t STRIDE = 1009; /* prime to 50 x 50: a permutation of the ids far from any order */

/* Shuffled and large enough for an order of its own. */
static void no_memory_is_an_error_in_every_part_of_the_layout(void **state) {
  (void)state;
  enum { SIDE = 50, N = SIDE * SIDE };
  uint32_t(*edge)[2] = malloc(N * sizeof *edge);
  for (uint32_t i = 0; i < N; i++)
    edge[i][0] = (uint32_t)(i * STRIDE % N) + 1, edge[i][1] = (uint32_t)((i + 1) * STRIDE % N) + 1;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    uint32_t id;
    double *x = calloc(3 * N, sizeof *x);
    test_engine_open(&e);
    assert_int_equal(hk_scene_add_particles(e.scene, N, x, NULL, NULL, 1, 0, &id, &e.error), HK_OK);
    free(x);
    hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
    test_edges(&e, springs, (const uint32_t(*)[2])edge, N);
    test_number(&e, springs, "k", 1);
    e.options.dt = 1e-3;
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures > 10);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
  free(edge);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(springs_force_is_minus_energy_gradient),
      cmocka_unit_test(springs_jacobian_is_exact_with_and_without_damping),
      cmocka_unit_test(springs_power_is_that_of_the_damping_alone),
      cmocka_unit_test(springs_act_when_both_ends_do),
      cmocka_unit_test(springs_follow_deaths),
      cmocka_unit_test(springs_of_almost_coincident_particles_are_finite),
      cmocka_unit_test(no_memory_is_an_error_in_every_part_of_the_layout),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
