/* Methods that choose their steps where a force jumps that finds all at rest, or nearly so, and has no scale to be
 * compared with but the motion that it makes: in any units, anywhere. A singular force is refused as ever. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double jump = 1.1, end = 3;

/* 0 until 1.1 s, then a number, which is the context. */
static hk_status pulse(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                       size_t max_out, size_t *n_out, hk_error *error) {
  (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = in[0] >= jump ? *(const double *)f->context : 0;
  out[1] = out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

static const char *const methods[] = {"dopri5",  "dop853",      "gauss_radau", "esdirk4",
                                      "tr_bdf2", "linear_bdf2", "cvode",       "arkode"};

/* The error relative to the way that the force makes, of a particle at x with the speed v. */
static double error_of(const char *method, double acceleration, double x, double v) {
  test_engine e;
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, method);
  test_function(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", (hk_function){.call = pulse, .context = &acceleration});
  test_particle(&e, x, 0, 0, 2);
  e.scene->particles.velocity[0] = v;
  e.scene->duration = end;
  e.scene->fps = 1;
  test_run(&e);
  test_advance(&e, end);
  double way = acceleration * (end - jump) * (end - jump) / 2;
  double error = fabs(test_position(&e, 1)[0] - x - v * end - way) / way;
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  assert_true(summary.steps < 200); /* some 25 from a second to rounding, and back; a uniform motion needs none */
  test_engine_close(&e);
  return error;
}

/* The tolerance of SUNDIALS' methods is 1e-6 a step, that of linear_bdf2 1e-3, of which rounding of x makes some use
 * far from the origin; all but SUNDIALS end a step at the jump. Rounding is that of x. */
static void a_jump_that_finds_all_at_rest_is_passed(void **state) {
  static const double size[] = {1, 1e-9, 1e16}, place[] = {0, 1e8};
  (void)state;
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++)
    for (int k = 0; k < 6; k++) {
      double A = size[k % 3], x = place[k / 3] * A, error = error_of(methods[m], A, x, 0);
      bool others = strcmp(methods[m], "cvode") == 0 || strcmp(methods[m], "arkode") == 0;
      print_message("%-12s %g m/s2 at %g m: error %.1e\n", methods[m], A, x, error);
      double bound = others ? 1e-5 : strcmp(methods[m], "linear_bdf2") == 0 && x > 0 ? 1e-3 : 1e-13 + 1e-15 * x / A;
      assert_true(error < bound);
    }
}

/* What moves by a part of 1e-10 of the speeds to come is nearly at rest. */
static void so_is_one_that_finds_all_nearly_at_rest(void **state) {
  (void)state;
  for (size_t m = 0; m < 6; m++) {
    double error = error_of(methods[m], 10, 0, 1e-9);
    print_message("%-12s error %.1e\n", methods[m], error);
    assert_true(error < 1e-10);
  }
}

/* A fall into the centre of 1/r^2 from 1 m, after pi/(2 sqrt 2) s; what jumps does so once, what is singular goes on.
 */
static void a_fall_into_a_singular_force_is_refused(void **state) {
  (void)state;
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    test_engine e;
    test_engine_open(&e);
    test_plugin(&e, HK_INTEGRATOR, methods[m]);
    hk_plugin_spec *central = test_plugin(&e, HK_FORCE, "central");
    test_number(&e, central, "strength", 1);
    test_number(&e, central, "power", -2);
    test_particle(&e, 1, 0, 0, 1);
    e.scene->duration = end;
    e.scene->fps = 1;
    test_run(&e);
    assert_int_equal(hk_run_advance(e.run, end, &e.error), HK_NOT_CONVERGED);
    assert_true(hk_run_view(e.run)->t < 1.1108);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_jump_that_finds_all_at_rest_is_passed),
      cmocka_unit_test(so_is_one_that_finds_all_nearly_at_rest),
      cmocka_unit_test(a_fall_into_a_singular_force_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
