/* Copies of gravity, springs and leapfrog that are built outside the tree, with the files of `make install` alone,
 * beside the shipped ones: the time of a step of a net, in one thread. Runs of both take turns, and each figure is the
 * least of its runs. */
#include "tests/support/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 12, SIZES = 3 };

static const char scene[] =
    "local n = param('n', 32, 'particles along a side')\n"
    "local where = param('where', '', 'of the plugins')\n"
    "local function plugin(name) return where == '' and name or where .. name .. '.so' end\n"
    "local dt = 0.01 / n / n\n"
    "local scene = hooke.scene { duration = 1000000 // (n * n) * dt, dt = dt }\n"
    "scene:integrator(plugin('leapfrog'))\n"
    "local s = scene:grid { nx = n, ny = n, width = 1, height = 1, mass = 1 }\n"
    "scene:pin { s:at(1, 1), s:at(n, 1) }\n"
    "scene:force(plugin('gravity'))\n"
    "scene:force(plugin('springs'), { edges = s:structural(), k = 100, damping = 1e-3, label = 'structural' })\n"
    "scene:force(plugin('springs'), { edges = s:shear(), k = 50, damping = 1e-3, label = 'shear' })\n"
    "return scene\n";

static void say(const char *command) {
  if (system(command) != 0) exit(1);
}

static void build(const char *folder) {
  static const char *const copies[][2] = {{"forces", "gravity"}, {"forces", "springs"}, {"integrators", "leapfrog"}};
  char command[2048];
  snprintf(command, sizeof command,
           "make -C '%s' --no-print-directory install CHECKED=1 DESTDIR='%s' PREFIX=/usr >/dev/null", HK_ROOT, folder);
  say(command);
  for (size_t k = 0; k < sizeof copies / sizeof *copies; k++) {
    snprintf(command, sizeof command,
             "cd '%s' && cp '%s/plugins/%s/%s.c' . && cc -O3 -shared -fPIC $(usr/bin/hooke --cflags) %s.c -o %s.so -lm",
             folder, HK_ROOT, copies[k][0], copies[k][1], copies[k][1], copies[k][1]);
    say(command);
  }
}

/* ns a particle and step. */
static double once(int n, const char *where) {
  static test_result result;
  char arguments[256];
  snprintf(arguments, sizeof arguments, "run net.lua n=%d where=%s --trust --threads 1 --no-output --json", n, where);
  test_hooke(&result, NULL, arguments);
  return 1e9 * test_json(result.out, "step_wall_s") / test_json(result.out, "steps") / (n * n);
}

int main(void) {
  static const int sizes[SIZES] = {10, 64, 256};
  test_write("net.lua", scene);
  build(test_folder());
  puts("ns a particle and step      inside    outside   ratio");
  for (int k = 0; k < SIZES; k++) {
    double inside = INFINITY, outside = INFINITY;
    for (int r = 0; r < RUNS; r++) {
      inside = fmin(inside, once(sizes[k], ""));
      outside = fmin(outside, once(sizes[k], "./"));
    }
    printf("%3d x %3d particles      %9.3f  %9.3f  %6.3f\n", sizes[k], sizes[k], inside, outside, outside / inside);
  }
  return 0;
}
