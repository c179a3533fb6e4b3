/* Forces made of elements, as the fixtures area_springs and volume_springs are: against their energy, differences of
 * themselves and what blocks are promised to be. */
#include "core/engine/contract/contract.h"
#include "tests/support/element_scenes.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The largest component of the sums of forces and torques, over the size of the forces. */
static double net(const hk_view *view, const double *F) {
  double force[3] = {0}, torque[3] = {0}, scale = 0;
  for (size_t i = 0; i < view->n; i++)
    for (size_t c = 0, p = 1, q = 2; c < 3; c++, p = (c + 1) % 3, q = (c + 2) % 3) {
      force[c] += F[3 * i + c];
      torque[c] += view->x[3 * i + p] * F[3 * i + q] - view->x[3 * i + q] * F[3 * i + p];
      scale += fabs(F[3 * i + c]);
    }
  double most = 0;
  for (int c = 0; c < 3; c++) most = fmax(most, fmax(fabs(force[c]), fabs(torque[c])));
  return most / scale;
}

static void check_force(test_engine *e, const hk_plugin_spec *spec) {
  test_plugin(e, HK_INTEGRATOR, "leapfrog");
  test_run(e);
  const hk_instance *force = test_instance(e, spec);
  hk_view view = force_view(e, force), rest = view;
  double *F = calloc(6 * view.n, sizeof *F), *still = F + 3 * view.n;
  rest.v = still;
  assert_true(force_gradient_error(force, &rest) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(force, &view) < FORCE_DIFFERENCES);
  assert_true(force_damping_error(force, &view) < FORCE_DIFFERENCES);
  double power = force_evaluate(force, &view, F);
  assert_true(power < 0);
  assert_true(net(&view, F) < 1e-14); /* rounding of sums over some hundred terms of coordinates below 1 */
  free(F);
}

static void forces_are_gradients_with_exact_jacobians_and_keep_momenta(void **state) {
  (void)state;
  test_engine e;
  elements_open(&e, 1e-4);
  hk_plugin_spec *force = elements_sheet(&e, 3, 0.02);
  elements_stiffen(&e, force, 1e5, 100, 100);
  check_force(&e, force);
  test_engine_close(&e);
  elements_open(&e, 1e-4);
  check_force(&e, elements_blob(&e, 2, 0.02, 1.5, 1e9, 1e6));
  test_engine_close(&e);
}

typedef struct names {
  hk_pattern pattern; /* first member */
  size_t count;
  uint32_t at[16 * 64][2];
} names;

static void name(hk_pattern *pattern, uint32_t row, uint32_t column) {
  names *list = (names *)(void *)pattern;
  list->at[list->count][0] = row;
  list->at[list->count++][1] = column;
}

/* The least u.K u/|u|^2 over many u, of the blocks wanted. */
static double least_curvature(const hk_instance *force, const hk_view *view, unsigned want, double *asymmetry) {
  static names list;
  static double K[9 * 16 * 64], D[9 * 16 * 64];
  static size_t slot[16 * 64];
  list = (names){.pattern = {name}};
  memset(K, 0, sizeof K);
  for (size_t b = 0; b < 16 * 64; b++) slot[b] = b;
  hk_force_of(force->plugin)->implicit.pattern(force->self, view, &list.pattern);
  hk_force_of(force->plugin)
      ->implicit.jacobian(force->self, view, &(hk_blocks){.slot = slot, .K = K, .D = D, .want = want});
  double least = INFINITY;
  *asymmetry = 0;
  for (int trial = 0; trial < 200; trial++) {
    double u[24], w[24], uu = 0, uKu = 0, wKu = 0, uKw = 0;
    for (int k = 0; k < 24; k++) u[k] = elements_noise(), w[k] = elements_noise(), uu += u[k] * u[k];
    for (size_t b = 0; b < list.count; b++)
      for (size_t q = 0; q < 9; q++) {
        size_t r = 3 * list.at[b][0] + q / 3, c = 3 * list.at[b][1] + q % 3;
        uKu += u[r] * K[9 * b + q] * u[c], wKu += w[r] * K[9 * b + q] * u[c], uKw += u[r] * K[9 * b + q] * w[c];
      }
    least = fmin(least, uKu / uu);
    *asymmetry = fmax(*asymmetry, fabs(wKu - uKw) / uu);
  }
  return least;
}

static void jacobians_are_symmetric_and_definite_where_that_is_wanted(void **state) {
  (void)state;
  test_engine e;
  double off;
  elements_open(&e, 1e-4);
  hk_plugin_spec *spec = elements_blob(&e, 2, 0.02, 3, 1e6, 1e3); /* rest 3 times the volume: pressed, so indefinite */
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  test_run(&e);
  const hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  assert_true(least_curvature(force, &view, 0, &off) < -1e-3);
  assert_true(off > 1e-6);
  assert_true(least_curvature(force, &view, HK_WANT_SYMMETRIC, &off) < -1e-3);
  assert_true(off < 1e-12); /* rounding of entries of some N/m */
  assert_true(least_curvature(force, &view, HK_WANT_DEFINITE, &off) > 0);
  assert_true(off < 1e-12);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forces_are_gradients_with_exact_jacobians_and_keep_momenta),
      cmocka_unit_test(jacobians_are_symmetric_and_definite_where_that_is_wanted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
