/* Cloth and a soft block that are jammed, wrung, crushed, wedged and dragged through gaps (crushed.lua) at the step
 * that hooke chooses: every run ends ok, the energy is balanced to a tenth of the largest kinetic energy, and nothing
 * intersects. Arguments: names of cases, in place of all. Some minutes. */
#include "tests/support/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const cases[] = {"box",  "compactor", "edge",  "ring",  "wring", "wedge",
                                    "slot", "fold",      "stack", "block", "ball"};

static bool is_asked(const char *name, int argc, char **argv) {
  bool asked = argc == 1;
  for (int k = 1; k < argc; k++) asked |= strcmp(argv[k], name) == 0;
  return asked;
}

static bool holds(const char *name) {
  static test_result r;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s/tests/study/crushed.lua case=%s --json --quiet --no-output", HK_ROOT,
           name);
  test_hooke(&r, NULL, arguments);
  double drift = test_json(r.out, "drift");
  bool right = r.code == 0 && fabs(drift) < 0.1 && test_json(r.out, "intersections") == 0;
  printf("%-10s exit %d, balance %8.1e, %6.0f steps of %.1e s and more, largest strain %5.2f: %s\n", name, r.code,
         drift, test_json(r.out, "steps"), test_json(r.out, "dt_min"), test_json(r.out, "max_strain"),
         right ? "ok" : "not ok");
  return right;
}

int main(int argc, char **argv) {
  setvbuf(stdout, NULL, _IOLBF, 0);
  int bad = 0;
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
    if (is_asked(cases[k], argc, argv)) bad += !holds(cases[k]);
  return bad > 0;
}
