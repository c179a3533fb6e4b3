/* Standard output and error that are closed, full, or pipes that nobody reads: an error of writing, with its code and
 * its sentence, after everything else has been done. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char ball[] = "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n"
                           "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                           "scene:measure('z', function(s) return s:position(p)[3] end)\nreturn scene\n";

static test_result r;

static char *contents(const char *name) {
  static char text[4096];
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  return text;
}

/* The number of a file to which nothing can be written: a pipe whose reader has gone. */
static int unread_pipe(void) {
  static int fd[2];
  if (fd[1] == 0 && pipe(fd) == 0) close(fd[0]);
  return fd[1];
}

static void output_that_cannot_be_written_is_said(void **state) {
  (void)state;
  static const char *const commands[] = {"run ball.lua --out o",
                                         "run ball.lua --out o --json",
                                         "run --help",
                                         "explain ball.lua",
                                         "plugins",
                                         "--version",
                                         "--cflags",
                                         "--help"};
  char to[64], all[256];
  test_write("ball.lua", ball);
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++)
    for (int how = 0; how < 3; how++) {
      snprintf(to, sizeof to, how == 0 ? ">&-" : how == 1 ? ">/dev/full" : ">&%d", unread_pipe());
      snprintf(all, sizeof all, "%s %s", commands[k], to);
      test_hooke(&r, NULL, all);
      if (r.code != 4 || !strstr(r.err, "hooke: cannot write to standard output: "))
        fail_msg("%s: exit %d, %s", all, r.code, r.err);
    }
}

/* The number of a closed one must not go to a file, into which the summary would be printed. */
static void files_are_whole_where_standard_files_are_closed(void **state) {
  (void)state;
  test_write("ball.lua", ball);
  test_hooke(&r, NULL, "run ball.lua --out whole");
  assert_int_equal(r.code, 0);
  char whole[4096];
  snprintf(whole, sizeof whole, "%s", contents("whole/measures.csv"));
  test_hooke(&r, NULL, "run ball.lua --out part --state s.csv <&- >&-");
  assert_int_equal(r.code, 4);
  assert_string_equal(contents("part/measures.csv"), whole);
  assert_non_null(strstr(contents("s.csv"), "\n1,0,0,1,"));
  test_hooke(&r, NULL, "run ball.lua --out silent --state t.csv <&- >&- 2>&-");
  assert_int_equal(r.code, 4);
  assert_string_equal(contents("silent/measures.csv"), whole);
}

static void a_run_survives_readers_that_go(void **state) {
  (void)state;
  char all[256];
  test_write("ball.lua", ball);
  snprintf(all, sizeof all, "run ball.lua --state u.csv --out p >&%d 2>&1", unread_pipe());
  test_hooke(&r, NULL, all);
  assert_int_equal(r.code, 4);
  assert_true(test_exists("u.csv") && test_exists("p/measures.csv"));
  snprintf(all, sizeof all, "run ball.lua --dt 0.2 --state v.csv 2>&%d", unread_pipe()); /* it warns of the step */
  test_hooke(&r, NULL, all);
  assert_int_equal(r.code, 0);
  assert_true(test_exists("v.csv"));
}

static void too_few_open_files_are_said(void **state) {
  (void)state;
  test_write("ball.lua", ball);
  test_hooke(&r, "ulimit -n 15;", "run ball.lua --quiet");
  assert_int_equal(r.code, 4);
  assert_non_null(strstr(r.err, "15 files may be open at once (ulimit -n), and hooke needs 16"));
  test_hooke(&r, "ulimit -n 16;", "run ball.lua --quiet --state w.csv --out q");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "ulimit -n 16;", "sweep ball.lua --quiet -j 1");
  assert_int_equal(r.code, 0);
}

/* By the system's signal the process would end without a word. The limit is 512 or 1024 bytes, and a table of 100
 * particles longer. */
static void files_that_reach_the_limit_of_their_size_are_said(void **state) {
  (void)state;
  test_write("sheet.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog' }\n"
                          "scene:grid { nx = 10, ny = 10, width = 1, height = 1, mass = 1 }\nreturn scene\n");
  test_hooke(&r, "ulimit -f 1;", "run sheet.lua --quiet --no-output --state x.csv");
  if (r.code != 4 || !strstr(r.err, "cannot write x.csv: File too large")) fail_msg("exit %d: %s", r.code, r.err);
  assert_true(!test_exists("x.csv") && !test_exists("x.csv.part"));
}

/* Whatever the limit, hooke ends by itself, and not in silence. The loader of programs has a code of its own, 127. */
static void little_memory_is_said(void **state) {
  (void)state;
  static const char *const commands[] = {"run ball.lua --quiet", "run ball.lua --quiet --integrator backward_euler",
                                         "plugins"};
  char before[64];
  if (strstr(HK_BUILD, "sanitize")) skip(); /* whose shadow memory needs terabytes of addresses */
  test_write("ball.lua", ball);
  static const int limits[] = {12000, 30000, 80000}; /* KiB; at the last, OpenBLAS's threads wait for memory for ever */
  for (size_t l = 0; l < sizeof limits / sizeof *limits; l++)
    for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
      snprintf(before, sizeof before, "ulimit -v %d; timeout -s KILL 60", limits[l]);
      test_hooke(&r, before, commands[k]);
      bool known = r.code <= 5 || r.code == 127;
      if (!known || (r.code != 0 && !*r.err)) fail_msg("%s %s: exit %d, %s", before, commands[k], r.code, r.err);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(output_that_cannot_be_written_is_said),
      cmocka_unit_test(files_are_whole_where_standard_files_are_closed),
      cmocka_unit_test(a_run_survives_readers_that_go),
      cmocka_unit_test(too_few_open_files_are_said),
      cmocka_unit_test(files_that_reach_the_limit_of_their_size_are_said),
      cmocka_unit_test(little_memory_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
