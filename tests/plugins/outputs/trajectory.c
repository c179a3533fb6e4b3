/* The output trajectory: a file of the same run has the same bytes, whenever that was. The clock of the library that
 * writes it is set by a `gettimeofday` of the test's own, which the linker finds first. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char *const clock_source = "#include <stdlib.h>\n#include <sys/time.h>\n"
                                        "int gettimeofday(struct timeval *restrict at, void *restrict zone) {\n"
                                        "  at->tv_sec = atol(getenv(\"NOW\"));\n  at->tv_usec = 0;\n  return 0;\n}\n";

static const char *const scene =
    "local s = hooke.scene { duration = 0.1, fps = 20, dt = 0.01, integrator = 'leapfrog' }\n"
    "for i = 1, 5 do s:particle { position = { i, 0, 0 }, mass = 1 } end\n"
    "s:force('gravity', {})\ns:output('trajectory', {})\nreturn s\n";

static void a_run_has_the_same_file_at_any_time(void **state) {
  (void)state;
  static const char *const before = "cc -shared -fPIC now.c -o now.so && LD_PRELOAD=$PWD/now.so NOW=100000 \"$HOOKE\" "
                                    "run s.lua --trust --quiet --out a &&"
                                    " LD_PRELOAD=$PWD/now.so NOW=900000 \"$HOOKE\" run s.lua --trust --quiet --out b &&"
                                    " cmp a/trajectory.h5 b/trajectory.h5 && ";
  char all[2048];
  test_result r;
  test_write("now.c", clock_source);
  test_write("s.lua", scene);
  snprintf(all, sizeof all, "%s/plugins/outputs/trajectory.so", HK_BUILD);
  if (access(all, R_OK) != 0) skip(); /* built without HDF5 */
  snprintf(all, sizeof all, "export ASAN_OPTIONS=verify_asan_link_order=0; HOOKE='%s/hooke'; %s", HK_BUILD, before);
  test_hooke(&r, all, "--version");
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.out, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_run_has_the_same_file_at_any_time)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
