/* What a run says of forces by the tree: how large their errors are, that they are no fault of its steps, and, where an
 * accuracy is asked for, whether they let it be reached. The truth is a run over all pairs with the same steps. */
#include "tests/support/nbody_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 600 };
static const double end = 0.3; /* s; sqrt(a^3/GM) is 1 s */
static const char *integrator = "leapfrog";
static double step = 0.01; /* s */

static void open_sphere(test_engine *e, const char *method, double alpha, double accuracy) {
  test_engine_open(e);
  nbody_add_sphere(e, N, 4);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, spec, "G", 1);
  test_number(e, spec, "softening", 0.1);
  test_number(e, spec, "alpha", alpha);
  test_text(e, spec, "method", method);
  e->options.integrator = integrator;
  e->options.dt = step; /* the steps of half the length show its error */
  e->options.accuracy = accuracy;
  e->options.compare = HK_COMPARE_ASKED;
  e->scene->fps = 10;
  e->scene->duration = end;
}

static hk_status open_again(void *context, const hk_run_options *options, hk_run **again, hk_error *error) {
  return hk_run_open(((test_engine *)context)->scene, options, again, error);
}

static void close_again(void *context, hk_run *again) {
  (void)context;
  hk_run_destroy(again);
}

/* The verdict of a run; its places are copied. */
static void run(const char *method, double alpha, double accuracy, hk_summary *s, double *x) {
  test_engine e, other;
  hk_error error = {0};
  open_sphere(&e, method, alpha, accuracy);
  open_sphere(&other, method, alpha, accuracy);
  test_run(&e);
  test_advance(&e, end);
  assert_int_equal(hk_run_close(e.run, &error), HK_OK);
  hk_run_summary(e.run, s);
  hk_scene_loader loader = {open_again, close_again, &other};
  if (accuracy > 0) assert_int_equal(hk_verify(&loader, &e.options, false, e.run, s, &error), HK_OK);
  memcpy(x, hk_run_view(e.run)->x, 3 * N * sizeof *x);
  test_engine_close(&other);
  test_engine_close(&e);
}

static double distance(const double *a, const double *b) {
  double sum = 0;
  for (size_t k = 0; k < 3 * N; k++) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sqrt(sum / N);
}

static double exact[3 * N], x[3 * N];

static int find_truth(void **state) {
  (void)state;
  hk_summary s;
  run("direct", 0, NAN, &s, exact);
  return 0;
}

static void the_sum_over_all_pairs_has_no_such_errors(void **state) {
  (void)state;
  hk_summary s;
  run("direct", 0.005, NAN, &s, x);
  assert_int_equal(s.verdict, HK_VERDICT_OK);
  assert_true(isnan(s.force_rms) && isnan(s.force_largest) && s.force_work == 0);
}

static void errors_of_forces_stand_in_the_summary(void **state) {
  (void)state;
  hk_summary strict, usual;
  run("tree", 1e-4, NAN, &strict, x);
  run("tree", 5e-3, NAN, &usual, x);
  assert_true(usual.verdict == HK_VERDICT_OK && strict.verdict == HK_VERDICT_OK);
  assert_true(strict.force_rms > 0 && strict.force_rms < usual.force_rms);
  assert_true(usual.force_rms < usual.force_p99 && usual.force_p99 <= usual.force_largest);
  assert_true(usual.force_rms > 1e-4 && usual.force_rms < 2e-3);
  assert_true(strict.force_work > 0 && strict.force_work < usual.force_work);
}

/* With crude forces the motion is off by far more than the steps make it, which half the step alone would not show. */
static void no_run_is_ok_beyond_its_accuracy(void **state) {
  (void)state;
  const double alphas[] = {0.5, 0.005}, accuracies[] = {1e-3, 3e-5, 3e-6, 3e-7};
  int fine = 0, refused = 0;
  for (size_t a = 0; a < sizeof alphas / sizeof *alphas; a++)
    for (size_t q = 0; q < sizeof accuracies / sizeof *accuracies; q++) {
      hk_summary s;
      run("tree", alphas[a], accuracies[q], &s, x);
      double error = distance(x, exact);
      print_message("alpha %g, asked %g m: %s, off by %.2g m, estimated %.2g m\n", alphas[a], accuracies[q],
                    s.verdict_name, error, s.error_estimate);
      if (s.verdict == HK_VERDICT_OK) assert_true(error <= accuracies[q]);
      fine += s.verdict == HK_VERDICT_OK;
      refused += s.verdict == HK_INACCURATE;
      if (error < accuracies[q] / 20) assert_int_equal(s.verdict, HK_VERDICT_OK);
    }
  assert_true(fine > 2 && refused > 2);
}

static int take_finer_steps(void **state) {
  (void)state;
  integrator = "blanes_moan";
  step = 0.005;
  return find_truth(state);
}

static void the_sum_over_all_pairs_is_right_to_rounding(void **state) {
  (void)state;
  hk_summary s;
  run("direct", 0, 1e-11, &s, x);
  print_message("asked 1e-11 m: %s, estimated %.2g m\n", s.verdict_name, s.error_estimate);
  assert_int_equal(s.verdict, HK_VERDICT_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_sum_over_all_pairs_has_no_such_errors),
      cmocka_unit_test(errors_of_forces_stand_in_the_summary),
      cmocka_unit_test(no_run_is_ok_beyond_its_accuracy),
      cmocka_unit_test_setup(the_sum_over_all_pairs_is_right_to_rounding, take_finer_steps),
  };
  return cmocka_run_group_tests(tests, find_truth, NULL);
}
