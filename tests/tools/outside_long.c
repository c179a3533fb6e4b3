/* Plugins outside the tree have what those inside have: copies of a force on each particle, of one by parts with loops
 * in vectors, and of a method are built against the files of `make install` alone, and give the bits of the shipped. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void shell(const char *command) {
  char all[4096];
  snprintf(all, sizeof all, "cd '%s' && { %s; } >.said 2>&1 </dev/null", test_folder(), command);
  if (system(all) == 0) return;
  snprintf(all, sizeof all, "cat '%s/.said'", test_folder());
  if (system(all) != 0) print_error("and what it said cannot be read\n");
  fail_msg("failed: %s", command);
}

static const char *const copies[] = {"forces/gravity", "forces/springs", "integrators/leapfrog"};

/* A net in which springs are in runs, in lists and alone, with damping; all digits of the end are printed. */
#define SCENE                                                                                                          \
  "local scene = hooke.scene { duration = 0.1, fps = 50, dt = 2e-4 }\n"                                                \
  "scene:integrator('%s')\n"                                                                                           \
  "local s = scene:grid { nx = 50, ny = 60, width = 1, height = 1.2, mass = 1 }\n"                                     \
  "scene:pin { s:at(1, 1), s:at(50, 1) }\n"                                                                            \
  "local some = {}\n"                                                                                                  \
  "for k = 1, 400 do some[k] = { s:at(1 + k * k %% 49, 1 + 7 * k %% 53), s:at(50, 60 - k %% 6) } end\n"                \
  "scene:force('%s', { g = { 0.3, 2, -9.81 } })\n"                                                                     \
  "scene:force('%s', { edges = s:structural(), k = 300, damping = 0.01, label = 'structural' })\n"                     \
  "scene:force('%s', { edges = some, k = 2, rest = 0.3, label = 'some' })\n"                                           \
  "scene:measure('end', function(state)\n"                                                                             \
  "  local p, v = state:position(s:at(30, 40)), state:velocity(s:at(31, 50))\n"                                        \
  "  print(('%%a %%a %%a %%a %%a %%a'):format(p[1], p[2], p[3], v[1], v[2], v[3]))\n"                                  \
  "  return 0\n"                                                                                                       \
  "end)\n"                                                                                                             \
  "return scene\n"

static void scene(const char *name, const char *method, const char *gravity, const char *springs) {
  char text[4096];
  snprintf(text, sizeof text, SCENE, method, gravity, springs, springs);
  test_write(name, text);
}

static void copies_outside_give_the_same_bits(void **state) {
  (void)state;
  char command[2048];
  snprintf(command, sizeof command,
           "make -C '%s' --no-print-directory install CHECKED=1 %s DESTDIR=\"$PWD\" PREFIX=/usr", HK_ROOT,
           strstr(HK_BUILD, "/sanitize") ? "SANITIZE=1" : "");
  shell(command);
  shell("test -f usr/include/hooke/plugins/kit/vector3.h && ! test -e usr/include/hooke/plugins/common");
  for (size_t k = 0; k < sizeof copies / sizeof *copies; k++) {
    snprintf(command, sizeof command,
             "cp '%s/plugins/%s.c' . && cc -O3 -Wall -Wextra -Wpedantic -Werror -shared -fPIC -Wl,-z,defs "
             "$(usr/bin/hooke --cflags) %s.c -o %s.so -lm",
             HK_ROOT, copies[k], strchr(copies[k], '/') + 1, strchr(copies[k], '/') + 1);
    shell(command);
  }
  scene("inside.lua", "leapfrog", "gravity", "springs");
  scene("outside.lua", "./leapfrog.so", "./gravity.so", "./springs.so");
  shell("usr/bin/hooke run inside.lua --no-output --quiet 2>&1 | grep '^-\\?0x' >inside.txt; test $(wc -l <inside.txt) "
        "-ge 5");
  shell("usr/bin/hooke run outside.lua --no-output --quiet --trust 2>&1 | grep '^-\\?0x' >outside.txt");
  shell("cmp inside.txt outside.txt");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(copies_outside_give_the_same_bits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
