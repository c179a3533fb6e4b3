/* Strands: where their particles are, what they weigh, what their section and material are worth, and what is refused.
 */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;
static const double pi = 3.14159265358979323846;

/* The measures m1, m2, ... of a scene with the strand s made of `keys`, from comma-separated expressions. */
static void measured(const char *keys, const char *list, double *into, int count) {
  char scene[4096], name[16];
  snprintf(
      scene, sizeof scene,
      "local scene = hooke.scene { duration = 0 }\nlocal s = scene:strand { %s }\n"
      "for k = 1, %d do scene:measure('m' .. k, function(state)\n"
      "  local function x(i) return state:position(s:at(i)) end\n  local function m(i) return state:mass(s:at(i)) end\n"
      "  local function gap(i, j) local a, b = x(i), x(j)\n"
      "    return math.sqrt((a[1] - b[1])^2 + (a[2] - b[2])^2 + (a[3] - b[3])^2) end\n"
      "  local all = { %s, x and m and gap and nil }\n  return all[k] end) end\nreturn scene\n",
      keys, count, list);
  test_write("strand.lua", scene);
  test_hooke(&r, NULL, "run strand.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s\n%s", r.code, r.err, scene);
  for (int k = 0; k < count; k++) {
    snprintf(name, sizeof name, "m%d", k + 1);
    into[k] = test_json(r.out, name);
  }
}

static void expect(const char *keys, const char *list, int count, const double *known, double within) {
  double found[8];
  measured(keys, list, found, count);
  for (int k = 0; k < count; k++)
    if (!(fabs(found[k] - known[k]) <= within * fmax(1e-300, fabs(known[k]))))
      fail_msg("strand { %s }: number %d of %s is %.17g, known %.17g", keys, k + 1, list, found[k], known[k]);
}

#define ROUNDING 1e-14 /* of some products */

static void a_section_gives_stiffnesses(void **state) {
  (void)state;
  const double rr = 1e-6 * 1e-6; /* of r = 1 um squared */
  expect("n = 5, length = 2, radius = 1e-3, E = 4e9, nu = 0.25, density = 1300",
         "s.EA, s.EI, s.GJ, s.stiffness, s.length", 5, (double[]){4e3 * pi, 1e-3 * pi, 0.8e-3 * pi, 8e3 * pi, 2},
         ROUNDING);
  /* An ellipse of 2 mm by 1 mm. */
  expect("n = 5, radius = { 2e-3, 1e-3 }, E = 4e9, nu = 0, density = 1", "s.EA, s.EI, s.EI2, s.GJ", 4,
         (double[]){8e3 * pi, 4e9 * pi * 8 * rr / 4, 4e9 * pi * 2 * rr / 4, 2e9 * pi * 8 * rr / 5}, ROUNDING);
  expect("n = 5, radius = 1, E = 4 / math.pi", "s.EI, s.EI2", 2, (double[]){1, 1}, ROUNDING);
  test_refused("local scene = hooke.scene {}\nlocal s = scene:strand { n = 5, radius = 1e-3, E = 1 }\nprint(s.GJ)\n",
               "", 1, "bad.lua:3: a handle has no 'GJ'");
}

static void ends_carry_half_cells(void **state) {
  (void)state;
  const double cell = 1300 * pi * 1e-6 * 0.5;
  expect("n = 5, length = 2, radius = 1e-3, density = 1300", "m(1), m(2), m(5)", 3,
         (double[]){cell / 2, cell, cell / 2}, ROUNDING);
  expect("n = 5, length = 2, radius = 1e-3, mass = 8", "m(1), m(2), m(5)", 3, (double[]){1, 2, 1}, ROUNDING);
  expect("n = 5, length = 2, mass = 10", "m(1), m(2), m(5)", 3, (double[]){2, 2, 2}, ROUNDING);
  expect("n = 6, length = 2, radius = 1e-3, density = 1300, clamped = true", "m(1), m(2), m(3), m(6)", 4,
         (double[]){0, cell / 2, cell, cell / 2}, ROUNDING);
}

static void a_clamped_strand_starts_in_the_wall(void **state) {
  (void)state;
  expect("n = 6, from = { 1, 2, 3 }, direction = { 0, 2, 0 }, length = 2, clamped = true",
         "x(1)[2], x(2)[2], x(6)[2], x(1)[1], #s:roots(), s:roots()[2]", 6, (double[]){1.5, 2, 4, 1, 2, 2}, ROUNDING);
  expect("n = 6, length = 2, curl = { radius = 0.1, pitch = 0 }, clamped = true",
         "gap(1, 2), (x(1)[1]^2 + x(1)[2]^2)^0.5, x(1)[3]", 3, (double[]){0.5, 0.5, 0}, 1e-12);
}

/* A helix: its chords are shorter than l by (kappa l)^2/24, here exactly known. */
static void curls_are_helices(void **state) {
  (void)state;
  /* one turn of radius 0.1 m and pitch 0.3 m in 8 segments */
  const double turn = sqrt(pow(2 * pi * 0.1, 2) + 0.09), chord = sqrt(pow(0.2 * sin(pi / 8), 2) + pow(0.3 / 8, 2));
  char keys[200];
  snprintf(keys, sizeof keys, "n = 9, length = %.17g, direction = { 0, 0, 1 }, curl = { radius = 0.1, pitch = 0.3 }",
           turn);
  expect(keys, "x(9)[3], gap(1, 2), gap(8, 9), gap(1, 5)", 4, (double[]){0.3, chord, chord, hypot(0.2, 0.15)}, 1e-13);
  /* the same by its curvature and torsion: it starts along its direction instead */
  const double rise = 0.3 / (2 * pi), square = 0.01 + rise * rise;
  snprintf(keys, sizeof keys, "n = 9, length = %.17g, curl = { curvature = %.17g, torsion = %.17g }", turn,
           0.1 / square, rise / square);
  expect(keys, "gap(1, 2), gap(8, 9), gap(1, 5), gap(1, 9)", 4, (double[]){chord, chord, hypot(0.2, 0.15), 0.3}, 1e-12);
  snprintf(keys, sizeof keys, "n = 100001, length = 1, curl = { curvature = 2, torsion = 5 }");
  expect(keys, "x(2)[3] * 1e5", 1, (double[]){-1}, 1e-9); /* (kappa l)^2/6 = 7e-11 */
}

/* A right-handed helix has a positive pitch and a positive torsion: (a x b).c > 0 for its first steps. */
static void positive_curls_are_right_handed(void **state) {
  (void)state;
  const char *const hand =
      "(function() local function d(i) local a, b = x(i), x(i + 1) return { b[1] - a[1], b[2] - a[2], b[3] - a[3] } "
      "end\n"
      "local a, b, c = d(1), d(2), d(3) return (a[2]*b[3]-a[3]*b[2])*c[1] + (a[3]*b[1]-a[1]*b[3])*c[2] + "
      "(a[1]*b[2]-a[2]*b[1])*c[3] > 0 and 1 or -1 end)()";
  expect("n = 9, length = 0.5, curl = { radius = 0.1, pitch = 0.3 }", hand, 1, (double[]){1}, 0);
  expect("n = 9, length = 0.5, curl = { radius = 0.1, pitch = -0.3 }", hand, 1, (double[]){-1}, 0);
  expect("n = 9, length = 0.5, curl = { curvature = 3, torsion = 2 }", hand, 1, (double[]){1}, 0);
  expect("n = 9, length = 0.5, curl = { curvature = 3, torsion = -2, phase = 1 }", hand, 1, (double[]){-1}, 0);
}

static void curves_are_divided_by_their_length(void **state) {
  (void)state;
  /* an L of 1 m and 2 m */
  expect("n = 7, curve = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 2, 0 } }", "s.length, x(2)[1], x(3)[1], x(4)[2], x(7)[2]", 5,
         (double[]){3, 0.5, 1, 0.5, 2}, ROUNDING);
  /* a quarter of a circle, badly parametrised; the polygon of the function is short by 1e-8 */
  expect("n = 4, curve = function(s) local a = s * s * math.pi / 2 return math.cos(a), math.sin(a), 0 end",
         "s.length, x(2)[2], x(3)[2], x(4)[2]", 4, (double[]){pi / 2, 0.5, sin(pi / 3), 1}, 1e-6);
  /* the wall goes on against the start of the curve */
  expect("n = 4, clamped = true, curve = { { 0, 0, 0 }, { 0, 0, 0 }, { 2, 0, 0 } }", "x(1)[1], x(2)[1], x(4)[1]", 3,
         (double[]){-1, 0, 2}, ROUNDING);
}

#define SCENE "local scene = hooke.scene {}\nscene:strand { "
#define END " }\nreturn scene\n"

static void nonsense_is_refused_with_its_line(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"n = 1", "bad.lua:2: strand: n: 1 is not a whole number from 2 to a million"},
      {"n = 2, clamped = true", "strand: n: 2 is not a whole number from 3"},
      {"n = 3, to = { 0, 0, 0 }", "strand: to is where it starts: a strand needs a length"},
      {"n = 3, length = 0", "strand: length: 0 must be above 0"},
      {"n = 3, length = -1", "strand: length: -1 must be above 0"},
      {"n = 3, direction = { 0, 0, 0 }", "strand: direction: must not be zero"},
      {"n = 3, radius = -1", "strand: radius: -1 m must be above 0"},
      {"n = 3, radius = { 1, 0 }", "strand: radius: 0 m must be above 0"},
      {"n = 3, radius = { 1, 2, 3 }", "expected a number, or the two half axes of an ellipse"},
      {"n = 3, radius = 1, E = 0", "strand: E: 0 Pa must be above 0"},
      {"n = 3, radius = 1, E = 1, nu = 0.6", "strand: nu: Poisson's ratio 0.6 is not above -1 and at most 0.5"},
      {"n = 3, radius = 1, E = 1, nu = -1", "strand: nu: Poisson's ratio -1 is not above -1 and at most 0.5"},
      {"n = 3, E = 1", "strand: E says nothing without the radius"},
      {"n = 3, radius = 1, nu = 0.3", "strand: nu says nothing without E"},
      {"n = 3, radius = 1, density = 1, mass = 1", "strand: give mass or density, not both"},
      {"n = 3, radius = 1, density = -1", "strand: density: -1 kg/m^3 must be above 0"},
      {"n = 3, curl = { radius = 1, torsion = 1 }", "strand: curl: give radius and pitch, or curvature and torsion"},
      {"n = 3, curl = { curvature = 0, torsion = 1 }", "strand: curl: curvature: 0 must be above 0"},
      {"n = 3, curl = { pitch = 1 }", "strand: curl: give radius and pitch, or curvature and torsion"},
      {"n = 3, curve = { { 0, 0, 0 } }", "strand: curve: needs two points or more"},
      {"n = 3, curve = { { 0, 0, 0 }, { 0, 0, 0 } }", "strand: curve: all its points are one"},
      {"n = 3, curve = function(s) return s, 0/0, 0 end", "nan is not a finite number"},
      {"n = 3, curve = function(s) return s end", "strand: curve: the function gave no point x, y, z at s = 0"},
      {"n = 3, curve = { { 0, 0, 0 }, { 1, 0, 0 } }, length = 2", "strand: a curve has a length of its own"},
      {"n = 3, radios = 1", "strand: unknown key 'radios'; did you mean 'radius'?"},
  };
  char scene[400];
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    snprintf(scene, sizeof scene, SCENE "%s" END, cases[k][0]);
    test_refused(scene, "", 1, cases[k][1]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_section_gives_stiffnesses),         cmocka_unit_test(ends_carry_half_cells),
      cmocka_unit_test(a_clamped_strand_starts_in_the_wall), cmocka_unit_test(curls_are_helices),
      cmocka_unit_test(positive_curls_are_right_handed),     cmocka_unit_test(curves_are_divided_by_their_length),
      cmocka_unit_test(nonsense_is_refused_with_its_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
