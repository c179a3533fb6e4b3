/* hooke check of constraints, correctors, sources, solvers, outputs and services: every plugin of the project and every
 * fixture that is right passes, and each fault of tests/fixtures/wrong/KIND.c is found with the sentence of KIND.txt.
 * The wrong plugins are compiled here, as a user compiles one. */
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

static void passes(const char *path, const char *options) {
  char arguments[2048];
  snprintf(arguments, sizeof arguments, "check %s %s", path, options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", path, r.code, r.out, r.err);
}

static const char *options_of(const char *file) {
  /* small pictures without a video: what is checked does not depend on it, and takes seconds */
  if (strcmp(file, "frames.so") == 0) return "width=64 height=48 video=false --seconds 100";
  /* a box about the particles of the check's scenes, which it cannot guess, and cells so large that a busy machine with
   * sanitizers stays far below the time that a scene may take */
  if (strcmp(file, "liquid.so") == 0) return "low=-10,-10,-10 high=10,10,10 cell=2.5 density=1";
  if (strcmp(file, "gas.so") == 0) return "low=-10,-10,-10 high=10,10,10 cell=5";
  /* a rectangle on no particle, which it cannot guess */
  if (strcmp(file, "inflow.so") == 0) return "low=0,5,0 high=0,6,1 speed=1 cell=0.5";
  /* a liquid as dense as the check's particles of 1 kg some tenths of a metre apart, or nothing is compressed */
  if (strcmp(file, "incompressible.so") == 0) return "spacing=0.5 density=1";
  return "";
}

static void every_plugin_of_the_project_passes(void **state) {
  (void)state;
  static const char *const kinds[] = {"constraints", "correctors", "sources", "solvers", "outputs", "services"};
  char folder[512], path[1024];
  size_t count = 0;
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    snprintf(folder, sizeof folder, "%s/plugins/%s", HK_BUILD, kinds[k]);
    DIR *directory = opendir(folder);
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
      if (!strstr(entry->d_name, ".so")) continue;
      snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
      passes(path, options_of(entry->d_name));
      count++;
    }
    if (directory) closedir(directory);
  }
  assert_true(count >= 5); /* cholmod, pcg, umfpack, table, neighbours */
}

static void every_fixture_that_is_right_passes(void **state) {
  (void)state;
  static const char *const fixtures[][2] = {
      {"bar", ""},     {"ground", ""},          {"telescope", ""},     {"stretching_bar", "rate=0"},
      {"floor", ""},   {"sower", ""},           {"rejecter", ""},      {"spout", "every=0.25"},
      {"witness", ""}, {"counting_solver", ""}, {"lennard_jones", ""}, {"triples", ""},
  };
  char path[512];
  for (size_t k = 0; k < sizeof fixtures / sizeof *fixtures; k++) {
    snprintf(path, sizeof path, "%s/tests/fixtures/%s.so", HK_BUILD, fixtures[k][0]);
    passes(path, fixtures[k][1]);
  }
}

/* `sentence` NULL: the plugin is right. */
static void try_fault(const char *kind, const char *fault, const char *sentence) {
  char before[1024];
  snprintf(before, sizeof before,
           "cc -O1 -w -shared -fPIC $('%s/hooke' --cflags) -DBUG=%s '%s/tests/fixtures/wrong/%s.c' -o wrong.so && ",
           HK_BUILD, fault, HK_ROOT, kind);
  test_hooke(&r, before, "check ./wrong.so --seconds 4");
  if (r.code != (sentence ? 1 : 0)) fail_msg("%s %s: exit %d: %s%s", kind, fault, r.code, r.out, r.err);
  if (!sentence) return;
  if (!strstr(r.out, "  WRONG ") || !strstr(r.out, sentence))
    fail_msg("%s %s: expected '%s' in: %s%s", kind, fault, sentence, r.out, r.err);
}

/* Lines of KIND.txt: the fault, spaces, the sentence. */
static void each_fault_has_its_sentence(const char *kind, size_t least) {
  char path[512], line[512];
  size_t count = 0, step = strstr(HK_BUILD, "sanitize") ? 9 : 1; /* what is found is the same there */
  snprintf(path, sizeof path, "%s/tests/fixtures/wrong/%s.txt", HK_ROOT, kind);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  try_fault(kind, "NONE", NULL);
  while (fgets(line, sizeof line, file)) {
    char *end = line + strcspn(line, " ");
    char *sentence = end + strspn(end, " ");
    *end = 0;
    sentence[strcspn(sentence, "\n")] = 0;
    assert_true(*line && *sentence);
    if (count++ % step == 0) try_fault(kind, line, sentence);
  }
  fclose(file);
  assert_true(count >= least);
}

static void faults_of_constraints_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("constraint", 21);
}

static void faults_of_correctors_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("corrector", 24);
}

static void faults_of_sources_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("source", 21);
}

static void faults_of_solvers_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("solver", 18);
}

static void faults_of_outputs_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("output", 18);
}

static void faults_of_services_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("service", 6);
}

static void faults_of_products_are_found(void **state) {
  (void)state;
  each_fault_has_its_sentence("products", 12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_plugin_of_the_project_passes), cmocka_unit_test(every_fixture_that_is_right_passes),
      cmocka_unit_test(faults_of_constraints_are_found),    cmocka_unit_test(faults_of_correctors_are_found),
      cmocka_unit_test(faults_of_sources_are_found),        cmocka_unit_test(faults_of_solvers_are_found),
      cmocka_unit_test(faults_of_outputs_are_found),        cmocka_unit_test(faults_of_services_are_found),
      cmocka_unit_test(faults_of_products_are_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
