/* hooke check: every force and integrator of the build passes, and each fault that is put into one that is right is
 * found, in the sentence that names it. The wrong plugins are compiled here, as a user compiles one. */
#include "tests/support/command.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void check_all(const char *kind, size_t least) {
  char folder[512], arguments[1024];
  size_t count = 0;
  snprintf(folder, sizeof folder, "%s/plugins/%s", HK_BUILD, kind);
  DIR *directory = opendir(folder);
  assert_non_null(directory);
  for (struct dirent *entry; (entry = readdir(directory));) {
    if (!strstr(entry->d_name, ".so")) continue;
    snprintf(arguments, sizeof arguments, "check %s/%s", folder, entry->d_name);
    test_hooke(&r, NULL, arguments);
    if (r.code != 0) fail_msg("%s: exit %d: %s%s", entry->d_name, r.code, r.out, r.err);
    count++;
  }
  closedir(directory);
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

/* ---- faults: tests/fixtures/wrong/NAME.c is a plugin that is right with -DBUG=NONE, and NAME.txt has a line for each
 * fault: its BUG, the property that finds it, and the sentence that names it ---- */

static void compile_and_check(const char *name, const char *bug, const char *options) {
  char before[1024], arguments[512];
  snprintf(before, sizeof before,
           "cc -O1 -w -shared -fPIC -DBUG=%s $(%s/hooke --cflags) %s/tests/fixtures/wrong/%s.c -o %s.so -lm && ", bug,
           HK_BUILD, HK_ROOT, name, name);
  snprintf(arguments, sizeof arguments, "check %s.so %s", name, options);
  test_hooke(&r, before, arguments);
}

/* Whether a line that starts with WRONG has the sentence in it. */
static bool says(const char *out, const char *sentence) {
  for (const char *at = out; (at = strstr(at, "  WRONG ")); at++) {
    const char *end = strchr(at, '\n'), *found = strstr(at, sentence);
    if (found && end && found < end) return true;
  }
  return false;
}

static void right_and_wrong(const char *name, size_t least) {
  char path[512], line[512], options[256];
  size_t count = 0;
  compile_and_check(name, "NONE", "");
  if (r.code != 0) fail_msg("%s without a fault: exit %d: %s%s", name, r.code, r.out, r.err);
  snprintf(path, sizeof path, "%s/tests/fixtures/wrong/%s.txt", HK_ROOT, name);
  FILE *table = fopen(path, "r");
  assert_non_null(table);
  while (fgets(line, sizeof line, table)) {
    char *bug = strtok(line, " "), *property = strtok(NULL, "|"), *sentence = strtok(NULL, "\n");
    assert_non_null(sentence);
    sentence += strspn(sentence, " ");
    property += strspn(property, " ");
    property[strcspn(property, "|") - 1] = 0;
    snprintf(options, sizeof options, "--seconds 3 --only '%s'", property);
    compile_and_check(name, bug, options);
    if (r.code != 1 || !says(r.out, sentence))
      fail_msg("%s, %s: exit %d, not '%s': %s%s", name, bug, r.code, sentence, r.out, r.err);
    count++;
  }
  fclose(table);
  assert_true(count >= least);
}

static void faults_of_forces_are_named(void **state) {
  (void)state;
  right_and_wrong("force", 59);
}

/* Its right one takes memory of malloc in `create` and frees it in `destroy`. */
static void faults_of_habits_are_named(void **state) {
  (void)state;
  right_and_wrong("habits", 13);
}

static void faults_of_parts_are_named(void **state) {
  (void)state;
  right_and_wrong("parts", 10);
}

static void faults_of_contact_are_named(void **state) {
  (void)state;
  right_and_wrong("contact", 14);
}

static void faults_of_explicit_methods_are_named(void **state) {
  (void)state;
  right_and_wrong("integrator", 42);
}

static void faults_of_histories_are_named(void **state) {
  (void)state;
  right_and_wrong("multistep", 7);
}

static void faults_of_adaptive_methods_are_named(void **state) {
  (void)state;
  right_and_wrong("adaptive", 10);
}

static void faults_of_tiles_are_named(void **state) {
  (void)state;
  right_and_wrong("tiles", 7);
}

static void faults_of_implicit_methods_are_named(void **state) {
  (void)state;
  right_and_wrong("implicit", 5);
}

static void faults_of_neighbours_are_named(void **state) {
  (void)state;
  right_and_wrong("neighbours", 13);
}

static void faults_of_octrees_are_named(void **state) {
  (void)state;
  right_and_wrong("octree", 10);
}

static void faults_of_trees_of_boxes_are_named(void **state) {
  (void)state;
  right_and_wrong("bvh", 5);
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
      cmocka_unit_test(every_force_passes),
      cmocka_unit_test(every_integrator_passes),
      cmocka_unit_test(faults_of_forces_are_named),
      cmocka_unit_test(faults_of_habits_are_named),
      cmocka_unit_test(faults_of_parts_are_named),
      cmocka_unit_test(faults_of_contact_are_named),
      cmocka_unit_test(faults_of_explicit_methods_are_named),
      cmocka_unit_test(faults_of_histories_are_named),
      cmocka_unit_test(faults_of_adaptive_methods_are_named),
      cmocka_unit_test(faults_of_tiles_are_named),
      cmocka_unit_test(faults_of_implicit_methods_are_named),
      cmocka_unit_test(faults_of_neighbours_are_named),
      cmocka_unit_test(faults_of_octrees_are_named),
      cmocka_unit_test(faults_of_trees_of_boxes_are_named),
      cmocka_unit_test(what_cannot_be_checked_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
