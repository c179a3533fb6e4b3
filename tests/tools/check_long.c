/* hooke check: every force and integrator of the build passes, and the faults of forces and explicit methods are
 * named. */
#include "tests/tools/check_faults.h"

#include <dirent.h>

static void check_all(const char *kind, size_t least) {
  char folder[512], arguments[1024];
  size_t count = 0;
  snprintf(folder, sizeof folder, "%s/plugins/%s", HK_BUILD, kind);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory));) {
    if (!strstr(entry->d_name, ".so")) continue;
    /* Sanitizers take ten times as long as the time that a property has by itself is made for. */
    snprintf(arguments, sizeof arguments, "check %s/%s --seconds 200", folder, entry->d_name);
    test_hooke(&r, NULL, arguments);
    if (r.code != 0) break;
    count++;
  }
  closedir(directory);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", arguments, r.code, r.out, r.err);
  assert_true(count >= least);
}

static void every_force_passes(void **state) {
  (void)state;
  check_all("forces", 9);
}

static void every_integrator_passes(void **state) {
  (void)state;
  check_all("integrators", 24);
}

static void faults_of_forces_and_explicit_methods_are_named(void **state) {
  (void)state;
  right_and_wrong_of("force", 59, 1);
  right_and_wrong_of("integrator", 42, 1);
}

/* check.c tries some of these. */
static void other_faults_are_named(void **state) {
  (void)state;
  static const char *const tables[] = {"habits", "parts",    "contact",    "multistep", "adaptive",
                                       "tiles",  "implicit", "neighbours", "octree",    "bvh"};
  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) right_and_wrong_of(tables[k], 1, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_force_passes), cmocka_unit_test(every_integrator_passes),
                                     cmocka_unit_test(faults_of_forces_and_explicit_methods_are_named),
                                     cmocka_unit_test(other_faults_are_named)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
