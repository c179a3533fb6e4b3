/* core/run/judge/verdict.c: the verdict is a function of what a run measured and of what comparisons showed, and of
 * nothing else. The evidence here is written by hand; there is no run. */
#include "core/run/judge/judge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

typedef struct evidence {
  hk_summary figures;
  hk_record record;
  hk_comparisons comparisons;
  hk_evidence given;
} evidence;

/* A run of 1 J in which nothing went wrong, not compared with any other. */
static evidence good(void) {
  return (evidence){.figures = {.energy_first = 1,
                                .energy_last = 1,
                                .kinetic_max = 1,
                                .kinetic_mean = 0.5,
                                .dt_limit = 0.01,
                                .exact_error = NAN,
                                .accuracy = NAN,
                                .hand_work = NAN},
                    .comparisons = {.error = NAN, .position = NAN, .channel_error = NAN, .difference = NAN},
                    .given = {.order = 2, .extent = 1, .motion = 1, .exact_motion = NAN}};
}

static hk_opinion judge(evidence *e) {
  e->given.figures = &e->figures;
  e->given.record = &e->record;
  return hk_verdict_find(&e->given, &e->comparisons);
}

static void has_only(evidence *e, hk_fault fault, double excess) {
  hk_opinion o = judge(e);
  if (o.verdict != HK_INACCURATE || o.count != 1 || o.finding[0].fault != fault)
    fail_msg("fault %d: %zu findings, the first %d", fault, o.count, o.count ? (int)o.finding[0].fault : -1);
  if (isnan(excess))
    assert_true(isnan(o.finding[0].excess));
  else
    assert_float_equal(o.finding[0].excess, excess, 1e-12 * excess);
}

static void is_ok(evidence *e) {
  hk_opinion o = judge(e);
  if (o.verdict != HK_VERDICT_OK || o.count != 0) fail_msg("%zu findings, the first %d", o.count, o.finding[0].fault);
}

static void nothing_found_is_ok(void **state) {
  (void)state;
  evidence e = good();
  is_ok(&e);
  e.record.worst_error = 1; /* each at its limit */
  e.record.violation_max = hk_limit.violation;
  e.given.unresolved = hk_limit.unresolved;
  e.given.missed = hk_limit.visible;
  e.comparisons.tried = true, e.comparisons.error = 1;
  is_ok(&e);
}

/* Bars of 10 nm and of a parsec. */
static void a_violation_is_measured_by_the_scene(void **state) {
  (void)state;
  evidence e = good();
  e.given.extent = e.given.motion = 1e-8, e.record.violation_max = 9e-8, has_only(&e, HK_VIOLATION, NAN);
  e.record.violation_max = 9e-14, is_ok(&e);
  e.given.extent = e.given.motion = 3e16, e.record.violation_max = 1e5, is_ok(&e);
  e.record.violation_max = 1e8, has_only(&e, HK_VIOLATION, NAN);
}

static void each_figure_above_its_limit_is_one_finding(void **state) {
  (void)state;
  evidence e = good();
  e.record.dt_beyond = 0.02, has_only(&e, HK_STEP_UNSTABLE, 2);
  e = good(), e.figures.energy_last = NAN, has_only(&e, HK_ENERGY_NOT_FINITE, NAN);
  e = good(), e.figures.energy_drift = -0.2, has_only(&e, HK_ENERGY_OF_LARGEST, 2);
  e = good(), e.figures.energy_drift = 10, has_only(&e, HK_ENERGY_OF_LARGEST, log1p(10) / 0.1);
  e = good(), e.figures.energy_drift = -0.09, e.figures.kinetic_mean = 0.1, has_only(&e, HK_ENERGY_OF_MEAN, 1.8);
  e = good(), e.record.contact_rise = 0.2, has_only(&e, HK_CONTACT_ENERGY, NAN);
  e = good(), e.given.unresolved = 0.3, has_only(&e, HK_UNRESOLVED, 3);
  e = good(), e.given.missed = 0.3, has_only(&e, HK_ENCOUNTER, NAN);
  e = good(), e.record.worst_error = 3, has_only(&e, HK_ABOVE_TOLERANCE, 3 / hk_limit.tolerance);
  e = good(), e.record.violation_max = 1e-3, has_only(&e, HK_VIOLATION, NAN);
  e = good(), e.record.intersecting = 1, has_only(&e, HK_INTERSECTIONS, NAN);
  e = good(), e.record.intersections[1] = 1, has_only(&e, HK_INTERSECTIONS, NAN);
  e = good(), e.given.exact_failed = true, has_only(&e, HK_EXACT_FAILED, NAN);
  e = good(), e.figures.exact_error = 0.2, e.given.exact_motion = 1;
  has_only(&e, HK_EXACT_VISIBLE, 0.2 / (0.1 + hk_limit.rounding));
}

/* Energy that such a method takes is no fault unless an accuracy is asked for; energy that comes is one. */
static void a_method_that_was_chosen_to_damp_may_damp(void **state) {
  (void)state;
  evidence e = good();
  e.figures.damps_below = 0.1, e.figures.energy_drift = -0.2;
  is_ok(&e);
  e.figures.energy_drift = -0.09, e.figures.kinetic_mean = 0.1;
  is_ok(&e);
  e.comparisons.tried = e.comparisons.reference = true, e.comparisons.error = 4; /* that is measured */
  has_only(&e, HK_ERROR, 4);
  e = good(), e.figures.damps_below = 0.1;
  e.figures.energy_drift = -0.2, e.figures.kinetic_mean = 0.5, e.figures.accuracy = 1, e.figures.accuracies = 1;
  has_only(&e, HK_ENERGY_OF_LARGEST, 2);
  e = good(), e.figures.damps_below = 0.1, e.figures.energy_drift = 10;
  has_only(&e, HK_ENERGY_OF_LARGEST, log1p(10) / 0.1);
}

/* The work of contact is not known well enough where positions and velocities are not those of one time. */
static void what_contact_has_given_may_not_be_lost_as_damping(void **state) {
  (void)state;
  evidence e = good();
  e.figures.energy_drift = -0.5, e.figures.damps_below = 0.1;
  e.record.contact_work = 1.1, is_ok(&e);
  e.record.contact_work = 0.9, has_only(&e, HK_ENERGY_OF_LARGEST, 5);
  e.given.order = 1, is_ok(&e);
  e.given.order = 2, e.record.contact_work = -0.9, is_ok(&e);
}

static void an_accuracy_is_held_against_every_error(void **state) {
  (void)state;
  evidence e = good();
  e.figures.accuracy = 1e-3, e.figures.accuracies = 1;
  evidence asked = e;
  e.figures.exact_error = 2e-3, has_only(&e, HK_EXACT_ABOVE_ACCURACY, 2);
  e = asked, e.given.unresolved = 2e-3, has_only(&e, HK_UNRESOLVED, 2);
  e = asked, e.comparisons.damped = 5e-3, has_only(&e, HK_DAMPED, 5);
  e = asked, e.comparisons.tried = true, has_only(&e, HK_NOT_CHECKED, NAN);
  e.comparisons.error = 4, has_only(&e, HK_ERROR, 4);
  e = asked, e.record.by_hand = e.comparisons.tried = true, has_only(&e, HK_BY_HAND, NAN);
}

/* Damping that acts within a step cannot be summed, and other methods have the same contact and constraints. */
static void a_reference_overrules_what_could_be_inferred_and_no_more(void **state) {
  (void)state;
  evidence e = good();
  e.comparisons.tried = e.comparisons.reference = true, e.comparisons.error = 0.5;
  e.figures.energy_drift = -0.5, e.given.unresolved = 1, e.given.missed = 1, e.record.dt_beyond = 1;
  is_ok(&e);
  e.record.violation_max = 1, has_only(&e, HK_VIOLATION, NAN);
  e.record.violation_max = 0, e.record.contact_rise = 1, has_only(&e, HK_CONTACT_ENERGY, NAN);
  e.record.contact_rise = 0, e.comparisons.error = 2;
  assert_int_equal(judge(&e).count, 5);
}

static void the_same_evidence_is_the_same_verdict(void **state) {
  (void)state;
  evidence e = good();
  e.figures.energy_drift = -0.5, e.record.violation_max = 1, e.comparisons.tried = true, e.comparisons.error = 7;
  evidence before = e;
  hk_opinion first = judge(&e), second = judge(&e);
  assert_memory_equal(&first.finding, &second.finding, sizeof first.finding);
  assert_memory_equal(&before.figures, &e.figures, sizeof e.figures); /* nothing was written */
  assert_memory_equal(&before.record, &e.record, sizeof e.record);
  assert_memory_equal(&before.comparisons, &e.comparisons, sizeof e.comparisons);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(nothing_found_is_ok),
      cmocka_unit_test(a_violation_is_measured_by_the_scene),
      cmocka_unit_test(each_figure_above_its_limit_is_one_finding),
      cmocka_unit_test(a_method_that_was_chosen_to_damp_may_damp),
      cmocka_unit_test(what_contact_has_given_may_not_be_lost_as_damping),
      cmocka_unit_test(an_accuracy_is_held_against_every_error),
      cmocka_unit_test(a_reference_overrules_what_could_be_inferred_and_no_more),
      cmocka_unit_test(the_same_evidence_is_the_same_verdict),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
