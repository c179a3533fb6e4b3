/* The distances of a run's evaluations are those of their times in order, of accepted steps alone, however long it is.
 */
#include "core/engine/evaluate/evaluate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static bool near(double a, double b) { return fabs(a - b) < 1e-6 * b; } /* kept with 24 bits */

static void stages_are_put_in_order_and_rejected_steps_forgotten(void **state) {
  hk_evaluations e;
  (void)state;
  assert_true(hk_evaluations_open(&e, 10));
  assert_true(hk_evaluations_distance(&e, 1, 0.25) == 0.25); /* nothing known yet */
  const double stages[] = {0, 0.9, 0.2, 0.5, 0.5, 1};
  for (size_t k = 0; k < 6; k++) hk_evaluations_note(&e, stages[k]);
  hk_evaluations_accept(&e, 1);
  assert_true(near(hk_evaluations_distance(&e, 0.6, 9), 0.4) && near(hk_evaluations_distance(&e, 0.1, 9), 0.2));
  const double tried[] = {3, 2.5, 1.5}; /* a step to 3, then one to 1.5 */
  for (size_t k = 0; k < 3; k++) hk_evaluations_note(&e, tried[k]);
  hk_evaluations_accept(&e, 1.5);
  hk_evaluations_note(&e, 5);
  hk_evaluations_accept(&e, 5);
  assert_true(near(hk_evaluations_distance(&e, 1.2, 9), 0.5) && near(hk_evaluations_distance(&e, 2.5, 9), 3.5));
  assert_true(hk_evaluations_distance(&e, 8, 9) == 9);
  hk_evaluations_close(&e);
}

static void a_run_that_goes_on_gets_longer_cells(void **state) {
  hk_evaluations e;
  (void)state;
  assert_true(hk_evaluations_open(&e, 1));
  for (int k = 0; k <= 100000; k++) {
    hk_evaluations_note(&e, 0.01 * k);
    hk_evaluations_accept(&e, 0.01 * k);
  }
  for (double t = 0.5; t < 999; t += 1.7) assert_true(near(hk_evaluations_distance(&e, t, 9), 0.01));
  assert_true(hk_evaluations_distance(&e, 1e6, 9) == 9);
  hk_evaluations_close(&e);
}

static void a_step_of_very_many_substeps_is_followed(void **state) {
  hk_evaluations e;
  (void)state;
  assert_true(hk_evaluations_open(&e, 1));
  for (int k = 0; k <= 10000; k++) hk_evaluations_note(&e, 1e-4 * k);
  hk_evaluations_accept(&e, 1);
  for (double t = 0.01; t < 1; t += 0.01) assert_true(near(hk_evaluations_distance(&e, t, 9), 1e-4));
  hk_evaluations_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stages_are_put_in_order_and_rejected_steps_forgotten),
      cmocka_unit_test(a_run_that_goes_on_gets_longer_cells),
      cmocka_unit_test(a_step_of_very_many_substeps_is_followed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
