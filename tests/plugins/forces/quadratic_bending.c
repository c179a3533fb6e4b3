/* Quadratic bending against hinges at small angles and 2 sin(theta/2) at large ones; flat sheets, turned; derivatives;
 * the Jacobian is constant. */
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_instance *open_sheet(test_engine *e, sheet_kind kind, const double h[3], const char *force, hk_view *view) {
  sheet s = sheet_make(kind, 6, h);
  test_engine_open(e);
  hk_plugin_spec *spec = sheet_add(e, &s, force);
  test_number(e, spec, "rigidity", 2);
  if (strcmp(force, "hinges") == 0) test_number(e, spec, "rest", 0);
  sheet_free(&s);
  test_run(e);
  hk_instance *instance = test_instance(e, spec);
  *view = force_view(e, instance);
  return instance;
}

/* Energies and forces of a sheet bent by 1e-4 per m agree but for terms of that squared. */
static void small_angles_are_those_of_hinges(void **state) {
  (void)state;
  for (int kind = SHEET_ONE_WAY; kind <= SHEET_IRREGULAR; kind++) {
    const double h[3] = {1e-4, 5e-5, -7e-5};
    test_engine e, f;
    hk_view view, same;
    hk_instance *quadratic = open_sheet(&e, (sheet_kind)kind, h, "quadratic_bending", &view),
                *hinges = open_sheet(&f, (sheet_kind)kind, h, "hinges", &same);
    double F[3 * 49], G[3 * 49], most = 0;
    force_evaluate(quadratic, &view, F), force_evaluate(hinges, &same, G);
    for (int k = 0; k < 3 * 49; k++) most = fmax(most, fabs(G[k]));
    for (int k = 0; k < 3 * 49; k++)
      assert_true(fabs(F[k] - G[k]) < 1e-3 * most); /* forces along the sheet: second order */
    double E = quadratic->plugin->force->energy(quadratic->self, &view);
    assert_true(E > 0 && fabs(E / hinges->plugin->force->energy(hinges->self, &same) - 1) < 1e-7);
    test_engine_close(&e), test_engine_close(&f);
  }
}

/* A sheet that is flat at the start, folded along a line of its squares by an angle: lengths keep. */
static void a_fold_has_two_sines(void **state) {
  (void)state;
  for (double angle = 0.5; angle < 3.2; angle += 0.5) {
    test_engine e;
    hk_view view;
    hk_instance *bending = open_sheet(&e, SHEET_ALTERNATING, (double[3]){0}, "quadratic_bending", &view);
    double x[3 * 49], expected = 6 * (4.0 / 3 * 2) * (2 * sin(angle / 2)) * (2 * sin(angle / 2)) / 2; /* six hinges */
    memcpy(x, view.x, sizeof x);
    for (int i = 0; i < 49; i++) {
      double past = x[3 * i] - 0.5;
      if (past > 1e-9) x[3 * i] = 0.5 + past * cos(angle), x[3 * i + 2] = past * sin(angle);
    }
    view.x = x;
    assert_true(fabs(bending->plugin->force->energy(bending->self, &view) - expected) < 1e-12 * expected);
    test_engine_close(&e);
  }
}

/* Turned, moved by 1000 m: forces of rounding only, of 1e3 m with weights of some 1e2 1/m and k of 2 J, twice. */
static void flat_sheets_are_at_rest_anywhere(void **state) {
  (void)state;
  test_engine e;
  hk_view view;
  hk_instance *bending = open_sheet(&e, SHEET_IRREGULAR, (double[3]){0}, "quadratic_bending", &view);
  double x[3 * 49], F[3 * 49];
  for (size_t i = 0; i < 49; i++) {
    const double *from = view.x + 3 * i;
    x[3 * i] = 0.6 * from[0] - 0.8 * from[1] + 1000;
    x[3 * i + 1] = 0.48 * from[0] + 0.36 * from[1];
    x[3 * i + 2] = 0.64 * from[0] + 0.48 * from[1];
  }
  view.x = x;
  force_evaluate(bending, &view, F);
  for (int k = 0; k < 3 * 49; k++) assert_true(fabs(F[k]) < 1e-8);
  test_engine_close(&e);
}

static void force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  test_engine e;
  hk_view view, bent;
  hk_instance *bending = open_sheet(&e, SHEET_IRREGULAR, (double[3]){0.5, 0.3, -1}, "quadratic_bending", &view);
  enum { SIZE = 3 * 49 };
  double *K = malloc(4 * SIZE * SIZE * sizeof *K), *D = K + SIZE * SIZE, *L = D + SIZE * SIZE, *M = L + SIZE * SIZE;
  double x[SIZE];
  assert_true(force_gradient_error(bending, &view) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(bending, &view) < FORCE_DIFFERENCES);
  for (int k = 0; k < SIZE; k++) x[k] = view.x[k] + sin(k);
  bent = view, bent.x = x;
  force_matrices(bending, &view, K, D), force_matrices(bending, &bent, L, M);
  assert_memory_equal(K, L, SIZE * SIZE * sizeof *K);
  free(K);
  test_engine_close(&e);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    sheet s = sheet_make(SHEET_ONE_WAY, 2, (double[3]){0});
    test_engine_open(&e);
    test_number(&e, sheet_add(&e, &s, "quadratic_bending"), "rigidity", 1);
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    sheet_free(&s);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 8);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(small_angles_are_those_of_hinges),
      cmocka_unit_test(a_fold_has_two_sines),
      cmocka_unit_test(flat_sheets_are_at_rest_anywhere),
      cmocka_unit_test(force_and_jacobian_are_derivatives),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
