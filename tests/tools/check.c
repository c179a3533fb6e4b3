/* hooke check: faults that are put into plugins that are right are found, in the sentence that names them
 * (check_faults.h). Every eighth of them: check_faults_long.c tries all, and tables that take longer; check_long.c
 * checks the plugins of the build. Without a fault a plugin is checked here whole where check_faults_long.c has it not,
 * and the others with the properties that find the faults which are tried. */
#include "tests/tools/check_faults.h"

static void right_and_wrong(const char *name, size_t least) { right_and_wrong_of(name, least, 8); }

static void some_right_and_wrong(const char *name, size_t least) { right_with_and_wrong(name, NULL, least, 8); }

/* Its right one takes memory of malloc in `create` and frees it in `destroy`. */
static void faults_of_habits_are_named(void **state) {
  (void)state;
  some_right_and_wrong("habits", 13);
}

static void faults_of_parts_are_named(void **state) {
  (void)state;
  some_right_and_wrong("parts", 10);
}

static void faults_of_contact_are_named(void **state) {
  (void)state;
  some_right_and_wrong("contact", 14);
}

/* Its sums over all pairs are slow in large scenes, which have no part in this. */
static void a_claim_to_know_periodic_boxes_is_tried(void **state) {
  (void)state;
  right_with_and_wrong("periodic", "--only periodic", 2, 1);
}

static void faults_of_histories_are_named(void **state) {
  (void)state;
  some_right_and_wrong("multistep", 7);
}

static void faults_of_adaptive_methods_are_named(void **state) {
  (void)state;
  some_right_and_wrong("adaptive", 10);
}

static void faults_of_tiles_are_named(void **state) {
  (void)state;
  some_right_and_wrong("tiles", 7);
}

static void faults_of_implicit_methods_are_named(void **state) {
  (void)state;
  some_right_and_wrong("implicit", 5);
}

static void faults_of_internal_variables_are_named(void **state) {
  (void)state;
  right_and_wrong("internal", 9);
}

static void faults_of_octrees_are_named(void **state) {
  (void)state;
  some_right_and_wrong("octree", 10);
}

static void faults_of_services_that_keep_are_named(void **state) {
  (void)state;
  right_and_wrong("grip", 10);
  right_and_wrong("obstacles", 8);
}

/* Of a force that is infinite by itself no part is suspected, and what a fixture does wrong on purpose is all that is
 * found: see their heads. */
static void no_fault_is_found_that_is_none(void **state) {
  (void)state;
  test_hooke(&r, NULL, "check " HK_BUILD "/tests/fixtures/burst.so --only 'its parts'");
  if (r.code != 0) fail_msg("burst: exit %d: %s%s", r.code, r.out, r.err);
  test_hooke(&r, NULL, "check " HK_BUILD "/tests/fixtures/weak_central.so");
  if (r.code != 0) fail_msg("weak_central: exit %d: %s%s", r.code, r.out, r.err);
  test_hooke(&r, NULL, "check " HK_BUILD "/tests/fixtures/latch.so");
  const char *first = strstr(r.out, "  WRONG ");
  if (r.code != 1 || !says(r.out, "the latch broke in function 1") || !first || strstr(first + 1, "  WRONG "))
    fail_msg("latch: exit %d: %s%s", r.code, r.out, r.err);
}

static void what_cannot_be_checked_is_said(void **state) {
  (void)state;
  char arguments[1024];
  static const char *const bad[][2] = {
      {"check", "no plugin given"},
      {"check none.so", "none.so"},
      {"check %s/tests/fixtures/no_symbol.so", "exports no hk_plugin_main"},
      {"check %s/tests/fixtures/wrong_abi.so", "built for plugin interface 4.0"},
      {"check %s/plugins/forces/springs.so stiffnes=3", "no parameter 'stiffnes'"},
      {"check %s/plugins/forces/springs.so k=soft", "'soft' is not a number"},
      {"check %s/plugins/forces/springs.so k=-1", "k: -1 N/m is not at least 0"},
      {"check %s/plugins/forces/springs.so k=nan", "is not a number"},
      {"check %s/plugins/forces/springs.so --only cheese", "no property has 'cheese' in its name"},
      {"check %s/plugins/forces/springs.so --seconds none", "'none' is not a positive number"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    snprintf(arguments, sizeof arguments, bad[k][0], HK_BUILD);
    test_hooke(&r, NULL, arguments);
    if (r.code != 1 || !strstr(r.err, bad[k][1])) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_claim_to_know_periodic_boxes_is_tried),
      cmocka_unit_test(faults_of_services_that_keep_are_named),
      cmocka_unit_test(no_fault_is_found_that_is_none),
      cmocka_unit_test(faults_of_habits_are_named),
      cmocka_unit_test(faults_of_parts_are_named),
      cmocka_unit_test(faults_of_contact_are_named),
      cmocka_unit_test(faults_of_histories_are_named),
      cmocka_unit_test(faults_of_adaptive_methods_are_named),
      cmocka_unit_test(faults_of_tiles_are_named),
      cmocka_unit_test(faults_of_internal_variables_are_named),
      cmocka_unit_test(faults_of_implicit_methods_are_named),
      cmocka_unit_test(faults_of_octrees_are_named),
      cmocka_unit_test(what_cannot_be_checked_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
