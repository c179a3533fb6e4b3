/* Every width of the screening against one distance at a time: runs of any length, with none, or just one, outside. */
#include "core/engine/base/base.h"
#include "plugins/common/strain/run_screen.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

enum { MOST = 40 };

static uint64_t bits = 3;

/* -1 to 1. */
static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

/* With limits at the least and at the largest square itself nothing is outside; with either one rounding narrower, one
 * is, wherever in the run it stands. */
static void try(int lanes) {
  double x[6][MOST];
  const hk_run_ends ends = {{x[0], x[1]}, {x[2], x[3]}, {x[4], x[5]}};
  for (int round = 0; round < 400; round++) {
    size_t count = 1 + (size_t)round % MOST;
    double least = INFINITY, largest = 0;
    for (int c = 0; c < 6; c++)
      for (size_t k = 0; k < MOST; k++) x[c][k] = noise();
    for (size_t k = 0; k < count; k++) {
      double dx = x[1][k] - x[0][k], dy = x[3][k] - x[2][k], dz = x[5][k] - x[4][k], l2 = dx * dx + dy * dy + dz * dz;
      least = fmin(least, l2);
      largest = fmax(largest, l2);
    }
    assert_false(hk_run_screen(lanes, &ends, count, least, largest));
    assert_true(hk_run_screen(lanes, &ends, count, least, nextafter(largest, 0)));
    assert_true(hk_run_screen(lanes, &ends, count, nextafter(least, INFINITY), largest));
    x[0][count - 1] = NAN;
    assert_false(hk_run_screen(lanes, &ends, count, 0, INFINITY));
  }
}

static void every_width_sees_every_edge(void **state) {
  (void)state;
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) try(lanes);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_width_sees_every_edge)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
