/* The angle of repose of scripts/scenes/sand.lua against the friction between its grains: it rises with the friction,
 * from nothing to that of grains that cannot turn, and is that of heaps of other sizes. */
#include "tests/support/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static double slope(int n, double friction) {
  static test_result r;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s/scripts/scenes/sand.lua n=%d friction=%g --json --quiet --no-output",
           HK_ROOT, n, friction);
  test_hooke(&r, NULL, arguments);
  if (r.code == 0) return test_json(r.out, "slope");
  fprintf(stderr, "exit %d: %s", r.code, r.err);
  exit(1);
}

int main(void) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  static const double friction[] = {0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.8};
  double last = -1;
  int falls = 0;
  for (size_t k = 0; k < sizeof friction / sizeof *friction; k++) {
    double angle = slope(1000, friction[k]);
    printf("friction %4.2f: slope %5.1f degrees\n", friction[k], angle);
    falls += angle < last - 1; /* a heap of 1,000 grains shows its slope to a degree or two */
    last = angle;
  }
  for (int n = 500; n <= 2000; n *= 2) printf("%d grains, friction 0.5: slope %5.1f degrees\n", n, slope(n, 0.5));
  if (falls) fprintf(stderr, "the slope falls with the friction: %d times\n", falls);
  return falls > 0;
}
