/* hooke stability: linear limits of all methods against theory. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;
static char text[1 << 16];

static void read_file(const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("%s was not written: %s", name, r.err);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
}

/* The number in that column (from 0) of the line of the CSV read that begins with `line`; NAN: empty. */
static double column(const char *line, int number) {
  const char *at = strstr(text, line);
  if (!at) fail_msg("no line '%s' in: %s", line, text);
  for (; number > 0 && *at && *at != '\n'; at++) number -= *at == ',';
  char *end;
  double value = strtod(at, &end);
  return end == at ? NAN : value;
}

static void near(double value, double expected, double tolerance) {
  print_message("%.9g, expected %.9g\n", value, expected);
  assert_true(fabs(value - expected) <= tolerance * fabs(expected));
}

/* The search stops within 1e-5; where growth sets in with its square, the 1e-10 a step that it takes for none add 1e-5.
 */
static void linear_limits_are_those_of_theory(void **state) {
  (void)state;
  static const double precise = 1e-4;
  test_hooke(&r, NULL,
             "stability --quiet --out linear --integrators leapfrog,rk4,euler,stoermer,backward_euler,midpoint");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  read_file("linear/linear.csv");
  near(column("leapfrog,0,", 2), 2, precise);
  near(column("leapfrog,0.5,", 2), 2 * (sqrt(2) - 1), precise);
  near(column("leapfrog,10,", 2), 2 * (sqrt(401) - 20), precise);
  near(column("rk4,0,", 2), 2 * sqrt(2), precise);
  near(column("rk4,1,", 2), 2.785293563405282,
       precise); /* root of z^3/24 - z^2/6 + z/2 - 1 (Hairer and Wanner, IV.2) */
  near(column("euler,0.5,", 2), 1, precise);
  near(column("stoermer,0,", 2), sqrt(2), precise);
  assert_true(column("euler,0,", 2) == 0);
  assert_true(column("midpoint,0,", 2) == 0);
  assert_true(isinf(column("backward_euler,10,", 2)));
  assert_true(test_exists("linear/linear.png") && test_exists("linear/linear.svg"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_limits_are_those_of_theory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
