/* How much memory a scene takes for each of its springs: a cloth of three springs forces by leapfrog, until after its
 * first step. The difference of two sizes leaves out what every process takes. */
#include "tests/support/resources.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#if defined(__SANITIZE_ADDRESS__)
enum { MEASURED = 0 };
#else
enum { MEASURED = 1 };
#endif

enum { SMALL = 128, LARGE = 384 };

static double springs(double n) { return 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2); }

static double bytes(int side) {
  char parameter[16];
  snprintf(parameter, sizeof parameter, "N=%d", side);
  const char *arguments[] = {HK_ROOT "/scripts/scenes/cloth.lua",
                             parameter,
                             "--no-output",
                             "--quiet",
                             "--until",
                             "1e-6",
                             "--threads",
                             "1",
                             NULL};
  test_resources r = test_resources_of(arguments);
  assert_int_equal(r.code, 0);
  return r.bytes;
}

/* A spring takes 8 bytes for its ends, and two numbers for its rest length where those differ by their rounding; each
 * of its particles has six springs, and takes 6 doubles in the state, in the method's next state and in the last good
 * one, 3 in each of two slopes, 2 for its masses, and 20 and 9 bytes for edges and triangles, id, group and pin: */
static const double most = 8 + 16 + (3 * 6 * 8 + 2 * 3 * 8 + 2 * 8 + 20 + 25) / 6.0 + 8 /* what building left behind */;

static void a_spring_takes_so_many_bytes(void **state) {
  (void)state;
  if (!MEASURED) skip();
  double each = (bytes(LARGE) - bytes(SMALL)) / (springs(LARGE) - springs(SMALL));
  if (!(each > 0 && each < most)) fail_msg("a spring takes %.1f bytes; %.1f are allowed", each, most);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_spring_takes_so_many_bytes)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
