/* Scenes of what bends, each with numbers that are known. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* The elastica of w L^3/EI = 0.2, 1, 5 and 20 (shooting, 14 digits). With 20 segments tips are off by 1.2e-3 at most,
 * and with 10 by four times that: order 2. What swings is left is below 1e-5. */
static void cantilevers_rest_on_the_elastica(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double drop;
  } rods[] = {{"w L^3/EI = 0.2", 0.0249875111},
              {"w L^3/EI = 1", 0.1234714020},
              {"w L^3/EI = 5", 0.4959050446},
              {"w L^3/EI = 20", 0.8298814434}};
  double off[2][4];
  for (int level = 0; level < 2; level++) {
    test_scene(&r, "cantilever", level ? "n=20" : "n=10");
    for (int k = 0; k < 4; k++) {
      char key[40];
      snprintf(key, sizeof key, "%s: drop", rods[k].name);
      off[level][k] = test_json(r.out, key) - rods[k].drop;
    }
  }
  for (int k = 0; k < 4; k++) {
    double ratio = off[0][k] / off[1][k];
    if (!(fabs(off[1][k]) < 2e-3)) fail_msg("%s is off by %g m", rods[k].name, off[1][k]);
    if (!(ratio > 3.6 && ratio < 4.4))
      fail_msg("%s: %g and %g m, a ratio of %g", rods[k].name, off[0][k], off[1][k], ratio);
  }
}

/* 1 rad below the critical angle of 10.88 rad a ring lies flat, 1 rad above it has left its plane. */
static void a_twisted_ring_leaves_its_plane(void **state) {
  (void)state;
  test_scene(&r, "michell", "n=24 most=10 --until 22");
  if (!(test_json(r.out, "out of plane") < 2e-3)) fail_msg("out of plane at 10 rad: %s", r.out);
  test_scene(&r, "michell", "n=24 most=12 --until 22");
  if (!(test_json(r.out, "out of plane") > 0.05)) fail_msg("flat at 12 rad: %s", r.out);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cantilevers_rest_on_the_elastica),
                                     cmocka_unit_test(a_twisted_ring_leaves_its_plane)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
