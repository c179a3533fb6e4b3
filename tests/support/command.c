#include "tests/support/command.h"

#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64];

static void remove_folder(void) {
  char command[128];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  if (system(command) != 0) fprintf(stderr, "cannot remove %s\n", folder);
}

const char *test_folder(void) {
  if (!*folder) {
    strcpy(folder, "/tmp/hooke-test-XXXXXX");
    if (!mkdtemp(folder)) fail_msg("cannot make a folder in /tmp");
    atexit(remove_folder);
  }
  return folder;
}

static void slurp(const char *name, char *into, size_t size) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "rb");
  size_t got = file ? fread(into, 1, size - 1, file) : 0;
  into[got] = 0;
  if (file) fclose(file);
}

void test_hooke(test_result *r, const char *before, const char *arguments) {
  char command[4096];
  snprintf(command, sizeof command, "cd '%s' && { %s '%s/hooke' %s; } >.out 2>.err </dev/null", test_folder(),
           before ? before : "", HK_BUILD, arguments);
  int status = system(command);
  r->code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  slurp(".out", r->out, sizeof r->out);
  slurp(".err", r->err, sizeof r->err);
}

const char *test_write(const char *name, const char *text) {
  static char paths[8][PATH_MAX];
  static int next;
  char *path = paths[next++ % 8];
  snprintf(path, PATH_MAX, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "w");
  if (!file || fputs(text, file) < 0 || fclose(file) != 0) fail_msg("cannot write %s", path);
  return path;
}

bool test_exists(const char *name) {
  char path[PATH_MAX];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  return access(path, F_OK) == 0;
}

double test_json(const char *json, const char *key) {
  char quoted[64];
  snprintf(quoted, sizeof quoted, "\"%s\":", key);
  const char *at = strstr(json, quoted);
  char *end;
  if (!at) return NAN;
  at += strlen(quoted);
  double value = strtod(at, &end);
  return end == at || strncmp(at, "null", 4) == 0 ? NAN : value;
}

void test_scene(test_result *r, const char *name, const char *options) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s/scripts/scenes/%s.lua --json --quiet --no-output %s", HK_ROOT, name,
           options);
  test_hooke(r, NULL, arguments);
  if (r->code != 0) fail_msg("%s %s: exit %d: %s", name, options, r->code, r->err);
}

void test_refused(const char *scene, const char *arguments, int code, const char *text) {
  static test_result r;
  char all[1024];
  test_write("bad.lua", scene);
  snprintf(all, sizeof all, "run bad.lua %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("exit %d instead of %d; it said: %s", r.code, code, r.err);
  if (!strstr(r.err, text)) fail_msg("expected '%s' in: %s", text, r.err);
}
