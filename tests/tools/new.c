/* hooke new: of every kind a plugin that compiles without a warning, passes its own test and hooke check; in the tree,
 * and out of it with an installed hooke, by --cflags and by pkg-config, and by the Makefile that it writes, where paths
 * have spaces too. What is written exists once. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *const kinds[] = {"force",      "constraint", "corrector", "source",
                                    "integrator", "solver",     "output",    "service"};
enum { KINDS = sizeof kinds / sizeof *kinds };

static test_result r;

static void says(const char *arguments, int code, const char *text) {
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
  if (!strstr(code ? r.err : r.out, text)) fail_msg("%s: '%s' is not in: %s%s", arguments, text, r.out, r.err);
}

/* A shell command in the test's folder, with $H the hooke. */
static void shell(const char *hooke, const char *command) {
  char all[4096];
  snprintf(all, sizeof all, "cd '%s' && unset MAKEFLAGS && H='%s' && { %s; } >.said 2>&1 </dev/null", test_folder(),
           hooke, command);
  if (system(all) == 0) return;
  snprintf(all, sizeof all, "cat '%s/.said'", test_folder());
  if (system(all) != 0) print_error("and what it said cannot be read\n");
  fail_msg("failed: %s", command);
}

/* The sanitizers' runtime is in hooke; the plugin itself is built as a user builds it. */
#define COMPILE "cc -O2 -Wall -Wextra -Wpedantic -Werror -shared -fPIC "

static void every_kind_compiles_and_passes_its_test(void **state) {
  (void)state;
  char command[512];
  for (size_t k = 0; k < KINDS; k++) {
    snprintf(command, sizeof command,
             "$H new %s my_%s && for c in my_%s*.c; do " COMPILE
             "$($H --cflags) $c -o ${c%%.c}.so || exit; done && $H run --trust my_%s.lua",
             kinds[k], kinds[k], kinds[k], kinds[k]);
    shell(HK_BUILD "/hooke", command);
  }
}

static void a_makefile_says_what_it_lacks_and_one_of_another_kind_is_kept(void **state) {
  (void)state;
  shell(HK_BUILD "/hooke", "mkdir -p other && cd other && echo 'all: mine' >Makefile && $H new force air >said && "
                           "grep -q 'Makefile exists already and is left as it is' said && "
                           "test \"$(cat Makefile)\" = 'all: mine' && rm Makefile && $H new output seen && "
                           "! make HOOKE=/nowhere/hooke >said 2>&1 && "
                           "grep -q \"'/nowhere/hooke' gives no flags of the compiler: put hooke into PATH\" said");
}

static void every_kind_passes_hooke_check(void **state) {
  (void)state;
  char command[512];
  for (size_t k = 0; k < KINDS; k++) {
    snprintf(command, sizeof command, "$H check ./my_%s.so", kinds[k]);
    shell(HK_BUILD "/hooke", command);
  }
}

/* A test that cannot fail is a defect: each is run with a plugin whose formula is off. */
static void the_tests_fail_with_a_wrong_plugin(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"force", "s/p->d \\* (p->wind/p->d * 1.01 * (p->wind/"},
      {"constraint", "s/- along \\* along/+ along * along + 0.01/"},
      {"corrector", "s/= -p->e/= -0.9 * p->e/"},
      {"source", "s/p->age\\[i\\] >= p->life/p->age[i] >= 2 * p->life/"},
      {"integrator", "s/x\\[e\\] += h \\* v\\[e\\]/x[e] += 0.99 * h * v[e]/"},
      {"solver", "s/x\\[e\\] += step/x[e] -= step/"},
      {"output", "s/sum\\[0\\] \\/ mass/sum[0]/"},
      {"service", "s/+ 2] < height/+ 1] < height/"},
  };
  char command[1024];
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    const char *kind = wrong[k][0];
    snprintf(command, sizeof command,
             "rm -rf wrong && mkdir wrong && cd wrong && cp ../my_%s* ../Makefile . && rm *.so && "
             "sed '%s' ../my_%s.c >my_%s.c && ! cmp -s ../my_%s.c my_%s.c && make HOOKE=$H CFLAGS=-O1 && "
             "! timeout 30 $H run --trust my_%s.lua && ! timeout 60 make HOOKE=$H CFLAGS=-O1 test",
             kind, wrong[k][1], kind, kind, kind, kind, kind);
    shell(HK_BUILD "/hooke", command);
  }
}

static void a_scene_runs_and_says_what_to_do_next(void **state) {
  (void)state;
  says("new scene swing", 0, "hooke run swing.lua");
  says("run swing.lua N=5", 0, "verdict           ok");
  says("run swing.lua --help", 0, "stiffness of a spring");
  shell(HK_BUILD "/hooke", "sed '/^-- scene:output/s/^-- //' swing.lua >drawn.lua && ! cmp -s swing.lua drawn.lua");
  /* The line that is left out names an output and its parameters as they are. */
  if (access(HK_BUILD "/plugins/outputs/frames.so", F_OK) == 0) says("explain drawn.lua", 0, "frames");
  says("new scene swing", 1, "swing.lua exists already; it is left as it is");
}

static void what_cannot_be_made_is_said(void **state) {
  (void)state;
  says("new force wind", 0, "hooke check ./wind.so");
  says("new force wind", 1, "wind.c exists already");
  says("new forse x", 1, "did you mean 'force'?");
  says("new universe x", 1,
       "the kinds are scene, force, constraint, corrector, source, integrator, solver, output, service");
  says("new force", 1, "usage: hooke new KIND NAME");
  says("new force 2x", 1, "'2x' is no name for it: use a-z, 0-9 and _, as in my_force");
  shell(HK_BUILD "/hooke", COMPILE "$($H --cflags) wind.c -o wind.so");
  test_hooke(&r, NULL, "run wind.lua");
  assert_int_equal(r.code, 2);
  assert_non_null(strstr(r.err, "run with --trust"));
}

/* The plugins are written, built, tested and run by name with what `make install` put in an empty folder, from a folder
 * outside the tree. */
static void an_installed_hooke_has_all_that_plugins_need(void **state) {
  (void)state;
  char command[1024];
  const char *sanitize = strstr(HK_BUILD, "/sanitize") ? "SANITIZE=1" : "";
  snprintf(command, sizeof command,
           "make -C '%s' --no-print-directory install CHECKED=1 %s PREFIX=\"$PWD/usr\" && test -x usr/bin/hooke",
           HK_ROOT, sanitize);
  shell("", command);
  shell("", "grep -q bench usr/share/man/man1/hooke.1 && test -f usr/share/bash-completion/completions/hooke && "
            "! test -e usr/share/hooke/tools/manual && ! test -e usr/share/hooke/tools/package && "
            "test \"$(usr/bin/hooke --version)\" = \"hooke $(PKG_CONFIG_PATH=usr/lib/pkgconfig pkg-config --modversion "
            "hooke)\"");
  for (size_t k = 0; k < KINDS; k++) {
    snprintf(
        command, sizeof command,
        "$PWD/$H new %s out_%s && " COMPILE "$(PKG_CONFIG_PATH=usr/lib/pkgconfig pkg-config --cflags hooke) out_%s.c "
        "-o out_%s.so && make HOOKE=\"$PWD/$H\" CFLAGS=-O1 out_%s.so $(ls out_%s_*.c 2>/dev/null | sed s/c$/so/) && "
        "$PWD/$H run --trust out_%s.lua",
        kinds[k], kinds[k], kinds[k], kinds[k], kinds[k], kinds[k], kinds[k]);
    shell("usr/bin/hooke", command);
  }
  shell("usr/bin/hooke", "case \"$($PWD/$H --cflags)\" in *\"$PWD/usr/include/hooke\"*) ;; *) exit 1; esac");
  shell("usr/bin/hooke", COMPILE "$($PWD/$H --cflags) out_corrector.c -o out_corrector.so");
  shell("usr/bin/hooke", "d=$(PKG_CONFIG_PATH=usr/lib/pkgconfig pkg-config --variable=plugindir hooke) && "
                         "mkdir -p \"$d/correctors\" && cp out_corrector.so \"$d/correctors\" && "
                         "sed 's,./out_corrector.so,out_corrector,' out_corrector.lua >by_name.lua && "
                         "$PWD/$H run --trust by_name.lua");
}

/* One Makefile for all plugins of a folder, whose name and that of the installation have spaces: `make` builds, without
 * a warning, `make test` passes for all of them, and nothing is built twice. */
static void the_makefile_builds_and_tests_every_kind(void **state) {
  (void)state;
  char command[1024];
  shell("", "mkdir -p 'my plugins' && cp -r usr 'an usr'");
  for (size_t k = 0; k < KINDS; k++) {
    snprintf(command, sizeof command, "cd 'my plugins' && \"../$H\" new %s my_%s | grep -q 'make test-my_%s'", kinds[k],
             kinds[k], kinds[k]);
    shell("an usr/bin/hooke", command);
  }
  shell("an usr/bin/hooke", "cd 'my plugins' && make \"HOOKE=../$H\" CFLAGS='-O1 -Wall -Wextra -Wpedantic -Werror' "
                            "test >said && test $(grep -c 'properties hold' said) = 8 && "
                            "make \"HOOKE=../$H\" -q all && rm -r \"../an usr\"");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_kind_compiles_and_passes_its_test),
      cmocka_unit_test(every_kind_passes_hooke_check),
      cmocka_unit_test(a_makefile_says_what_it_lacks_and_one_of_another_kind_is_kept),
      cmocka_unit_test(the_tests_fail_with_a_wrong_plugin),
      cmocka_unit_test(what_cannot_be_made_is_said),
      cmocka_unit_test(a_scene_runs_and_says_what_to_do_next),
      cmocka_unit_test(an_installed_hooke_has_all_that_plugins_need),
      cmocka_unit_test(the_makefile_builds_and_tests_every_kind),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
