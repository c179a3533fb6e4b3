/* Faults that are put into plugins which are right, and the sentences in which `hooke check` has to name them. The
 * wrong plugins are compiled here, as a user compiles one. */
#ifndef HK_TEST_CHECK_FAULTS_H
#define HK_TEST_CHECK_FAULTS_H

#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* What is found, and what is said of it, does not depend on how hooke is built; sanitizers, which take ten times as
 * long, see a ninth of the faults in the long tests. */
static inline size_t long_step(void) { return strstr(HK_BUILD, "sanitize") ? 9 : 1; }

/* ---- faults: tests/fixtures/wrong/NAME.c is a plugin that is right with -DBUG=NONE, and NAME.txt has a line for each
 * fault: its BUG, the property that finds it, and the sentence that names it ---- */

/* Compiles the plugin with that fault, into a folder of its own: a plugin's file has the plugin's name. */
static inline void compile_with(const char *name, const char *bug) {
  char command[1024];
  snprintf(command, sizeof command,
           "mkdir -p %s && cc -O1 -w -shared -fPIC -DBUG=%s $(%s/hooke --cflags) %s/tests/fixtures/wrong/%s.c "
           "-o %s/%s.so -lm && ",
           bug, bug, HK_BUILD, HK_ROOT, name, bug, name);
  test_hooke(&r, command, "--version");
  if (r.code != 0) fail_msg("%s with %s is not compiled: %s%s", name, bug, r.out, r.err);
}

static inline void check_with(const char *name, const char *bug, const char *options) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "check %s/%s.so %s", bug, name, options);
  test_hooke(&r, NULL, arguments);
}

static inline void passes_without_fault(const char *name, const char *options) {
  check_with(name, "NONE", options);
  if (r.code != 0) fail_msg("%s without a fault, %s: exit %d: %s%s", name, options, r.code, r.out, r.err);
}

/* Whether a line that starts with WRONG has the sentence in it. */
static inline bool says(const char *out, const char *sentence) {
  for (const char *at = out; (at = strstr(at, "  WRONG ")); at++) {
    const char *end = strchr(at, '\n'), *found = strstr(at, sentence);
    if (found && end && found < end) return true;
  }
  return false;
}

/* Tries every so many of the faults, of which there are `least` or more. `tried`: options with which the plugin without
 * a fault is checked, "" for all of it; NULL: with the properties that find the faults which are tried. */
static inline void right_with_and_wrong(const char *name, const char *tried, size_t least, size_t every) {
  char path[512], line[512], options[256];
  size_t count = 0;
  compile_with(name, "NONE");
  if (tried) passes_without_fault(name, tried);
  snprintf(path, sizeof path, "%s/tests/fixtures/wrong/%s.txt", HK_ROOT, name);
  FILE *table = fopen(path, "r");
  assert_non_null(table);
  while (fgets(line, sizeof line, table)) {
    char *bug = strtok(line, " "), *property = strtok(NULL, "|"), *sentence = strtok(NULL, "\n");
    assert_non_null(sentence);
    sentence += strspn(sentence, " ");
    property += strspn(property, " ");
    property[strcspn(property, "|") - 1] = 0;
    if (count++ % every != 0) continue;
    snprintf(options, sizeof options, "--seconds 12 --only '%s'", property);
    if (!tried) passes_without_fault(name, options);
    compile_with(name, bug);
    check_with(name, bug, options);
    if (r.code != 1 || !says(r.out, sentence))
      fail_msg("%s, %s: exit %d, not '%s': %s%s", name, bug, r.code, sentence, r.out, r.err);
  }
  fclose(table);
  assert_true(count >= least);
}

static inline void right_and_wrong_of(const char *name, size_t least, size_t every) {
  right_with_and_wrong(name, "", least, every);
}

#endif
