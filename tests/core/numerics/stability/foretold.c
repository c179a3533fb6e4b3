/* The foretold largest stable step against the truth (foretold.h). Charges on springs, which take longest, are
 * foretold_long.c's. */
#include "tests/core/numerics/stability/foretold.h"

static void of_springs(void **state) {
  (void)state;
  survey(SPRINGS, NULL);
}

static void of_damped_springs(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING, NULL);
}

static void of_springs_in_a_drag(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING | DRAG, NULL);
}

static void of_springs_in_a_pull(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING | CENTRAL, NULL);
}

/* Methods that are stable farther from the imaginary axis than on it: that the fastest modes are damped is known though
 * some forces damp nothing. */
static void of_damped_springs_with_undamped_joints(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING | BENDING, NULL);
  assert_int_equal(tally_of("midpoint")->none, 0);                                               /* without that, 7 */
  assert_true(tally_of("stoermer5")->ratio[0] > 0.5 && tally_of("blanes_moan")->ratio[0] > 0.7); /* 0.18, 0.54 */
}

static void of_charges(void **state) {
  (void)state;
  survey(MAGNETIC, NULL);
}

static void of_charges_in_a_drag(void **state) {
  (void)state;
  survey(MAGNETIC | DRAG, NULL);
}

/* What is not looked for, as it would not lengthen the step of that method, does not: a thousandth is the tolerance of
 * none, a twentieth what is not worth an iteration. */
static void nothing_is_lost_where_a_method_is_named(void **state) {
  (void)state;
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names), sharper = 0;
  for (unsigned scene = 0; scene < SCENES / 2; scene++) {
    test_engine e;
    hk_spectrum every, own;
    state_of_random = (uint64_t)(SPRINGS | DAMPING | BENDING) << 32 | scene;
    build(&e, SPRINGS | DAMPING | BENDING);
    hk_system *system = &e.run->dynamics.system;
    linear_scene q = linear_scene_of(&e);
    assert_int_equal(hk_spectrum_estimate(system, &every, &e.error), HK_OK);
    for (size_t k = 0; k < count; k++) {
      fake_method m = linear_scene_open(names[k], &q, 1);
      const hk_integrator *method = m.plugin->integrator;
      if (fake_method_explicit(&m) && method->growth) {
        assert_int_equal(hk_spectrum_estimate_for(system, method, m.self, NAN, &own, &e.error), HK_OK);
        double whole = hk_stable_step(method, m.self, &every).limit, part = hk_stable_step(method, m.self, &own).limit;
        if (!(part >= 0.95 * whole && part <= 1.001 * whole))
          fail_msg("%s: %g s where all bounds give %g s", names[k], part, whole);
        sharper += own.damped[0].slope > 0;
        if (strcmp(names[k], "leapfrog") == 0) assert_true(own.damped[0].slope == 0);
      }
      linear_scene_close(&m);
    }
    test_engine_close(&e);
  }
  assert_true(sharper > 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_springs),
      cmocka_unit_test(of_damped_springs),
      cmocka_unit_test(of_springs_in_a_drag),
      cmocka_unit_test(of_springs_in_a_pull),
      cmocka_unit_test(of_damped_springs_with_undamped_joints),
      cmocka_unit_test(nothing_is_lost_where_a_method_is_named),
      cmocka_unit_test(of_charges),
      cmocka_unit_test(of_charges_in_a_drag),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
