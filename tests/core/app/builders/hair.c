/* Hair: roots on the surface, evenly, along its normals; the same from the same seed; strands, edges and numbers; and
 * what is refused. */
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

/* The value of the measure m in a scene with the hair h made of `keys`; body returns it. */
static double measured(const char *keys, const char *body) {
  char scene[4096];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0, seed = 7 }\n"
           "local sheet = scene:grid { nx = 4, ny = 3, width = 2, height = 1, mass = 1, origin = { 0, 0, 3 } }\n"
           "local h = scene:hair { %s }\nscene:measure('m', function(state)\n"
           "  local function x(i, k) return state:position(h:at(i, k)) end\n"
           "  local function mass(i, k) return state:mass(h:at(i, k)) end\n"
           "  local function gap(a, b) return math.sqrt((a[1] - b[1])^2 + (a[2] - b[2])^2 + (a[3] - b[3])^2) end\n"
           "  assert(x and mass and gap and sheet)\n  %s end)\nreturn scene\n",
           keys, body);
  test_write("hair.lua", scene);
  test_hooke(&r, NULL, "run hair.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s\n%s", r.code, r.err, scene);
  return test_json(r.out, "m");
}

static void expect(const char *keys, const char *body, double known, double within) {
  double found = measured(keys, body);
  if (!(fabs(found - known) <= within)) fail_msg("hair { %s }: %s gives %.17g, known %.17g", keys, body, found, known);
}

#define ROUNDING 1e-14

#define SPHERE "on = { radius = 2, centre = { 1, 0, 0 }, axis = { 0, 1, 0 }, cap = 1 }, strands = 200, n = 4"

static void roots_lie_on_the_surface_and_strands_leave_it_straight(void **state) {
  (void)state;
  const char *farthest =
      "local off = 0 for k = 1, 200 do off = math.max(off, math.abs(gap(x(2, k), { 1, 0, 0 }) - 2)) end "
      "return off";
  expect(SPHERE, farthest, 0, ROUNDING);
  const char *cap = "local least = 2 for k = 1, 200 do least = math.min(least, x(2, k)[2]) end return least";
  assert_true(measured(SPHERE, cap) >= 2 * cos(1) - ROUNDING);
  assert_true(measured(SPHERE, cap) < 2 * cos(0.9)); /* the cap is filled to its border */
  expect(SPHERE ", length = 1",
         "local off = 0 for k = 1, 200 do off = math.max(off, math.abs(gap(x(4, k), { 1, 0, 0 }) - 3), "
         "math.abs(gap(x(1, k), { 1, 0, 0 }) - 1.5)) end return off",
         0, ROUNDING);
  const char *flat =
      "local off = 0 for k = 1, 50 do local a, b = x(2, k), x(4, k) off = math.max(off, math.abs(a[3] - 3), "
      "math.abs(b[3] - 4), math.abs(a[1] - b[1]), -a[1], a[1] - 2, -a[2], a[2] - 1) end return off";
  expect("on = sheet, strands = 50, n = 4", flat, 0, ROUNDING);
  expect("on = { origin = { 0, 0, 3 }, u = { 2, 0, 0 }, v = { 0, 1, 0 } }, strands = 50, n = 4", flat, 0, ROUNDING);
  expect(
      "on = { vertices = { 0, 0, 3, 2, 0, 3, 2, 1, 3, 0, 1, 3 }, faces = { 1, 2, 3, 1, 3, 4 } }, strands = 50, n = 4",
      flat, 0, ROUNDING);
}

/* Darts end near 0.7 of the distance in a hexagonal lattice; places drawn one by one would come as close as 0.01. */
static void roots_are_even(void **state) {
  (void)state;
  const char *least = "local least = math.huge for i = 1, 300 do for j = 1, i - 1 do "
                      "least = math.min(least, gap(x(1, i), x(1, j))) end end return least";
  double area = 2 * 3.14159265358979323846, hexagonal = sqrt(2 * area / (sqrt(3) * 300));
  assert_true(measured("on = { cap = math.pi / 2 }, strands = 300, n = 2, clamped = false", least) > 0.6 * hexagonal);
  hexagonal = sqrt(2 * 2 / (sqrt(3) * 300));
  assert_true(measured("on = sheet, strands = 300, n = 2, clamped = false", least) > 0.6 * hexagonal);
  /* halves of equal area get equal shares, whatever their triangles: 300 +- border effects of some */
  const char *left = "local left = 0 for k = 1, 600 do left = left + (x(1, k)[1] < 1 and 1 or 0) end return left";
  expect("on = { vertices = { 0, 0, 0, 0.1, 0, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0, 0.1, 1, 0 }, "
         "faces = { 1, 2, 3, 2, 6, 3, 2, 4, 5, 2, 5, 6 } }, strands = 600, n = 2, clamped = false",
         left, 300, 12);
}

static void a_seed_gives_the_same_hair(void **state) {
  (void)state;
  const char *sum =
      "local sum = 0 for k = 1, 50 do local a = x(3, k) sum = sum + a[1] * k + a[2] + a[3] / k end return sum";
  const char *keys =
      "on = {}, strands = 50, n = 4, spread = 0.3, vary_length = 0.2, curl = { radius = 0.1, pitch = 1 }";
  char other[300];
  double first = measured(keys, sum);
  assert_true(measured(keys, sum) == first);
  snprintf(other, sizeof other, "%s, seed = 7", keys); /* the scene's own */
  assert_true(measured(other, sum) == first);
  snprintf(other, sizeof other, "%s, seed = 8", keys);
  assert_true(measured(other, sum) != first);
}

static void strands_vary_within_what_is_asked(void **state) {
  (void)state;
  const char *keys =
      "on = {}, strands = 200, n = 5, length = 2, spread = 0.3, vary_length = 0.25, radius = 1e-3, E = 1e9";
  expect(keys,
         "local low, high = 9, 0 for k = 1, 200 do local l = gap(x(2, k), x(5, k)) low, high = math.min(low, l), "
         "math.max(high, l) end return low < 1.55 and low >= 1.5 and high > 2.45 and high <= 2.5 and 1 or 0",
         1, 0);
  expect(keys,
         "local off = 0 for k = 1, 200 do local s, e = h:strand(k), h.stiffness[(k - 1) * 4 + 3] "
         "off = math.max(off, math.abs(s.length - gap(x(2, k), x(5, k))), math.abs(s.stiffness / e - 1), "
         "math.abs(s.EA / s.segment / e - 1)) end return off",
         0, 1e-13);
  expect(
      keys,
      "local most = 0 for k = 1, 200 do local a, b = x(2, k), x(5, k) local c = (a[1] * (b[1] - a[1]) + "
      "a[2] * (b[2] - a[2]) + a[3] * (b[3] - a[3])) / gap(a, b) most = math.max(most, math.acos(math.min(1, c))) end "
      "return most > 0.28 and most <= 0.3 + 1e-9 and 1 or 0",
      1, 0);
}

static void strands_follow_one_another(void **state) {
  (void)state;
  const char *keys = "on = {}, strands = 3, n = 4, radius = 1e-3, density = 1000";
  expect(keys, "return #h:edges()", 9, 0);
  expect(keys, "return h:edges()[4][1] - h:at(1, 2) + h:edges()[4][2] - h:at(2, 2)", 0, 0);
  expect(keys, "return #h:flexion() * 100 + #h:strand(2):edges()", 603, 0);
  expect(keys, "return h:strand(3):at(2) - h:at(2, 3) + h:roots()[6] - h:at(2, 3) + #h:roots()", 6, 0);
  expect(keys, "return mass(1, 2) + mass(2, 2) / mass(3, 2) + mass(4, 2) / mass(3, 2)", 1, ROUNDING);
  expect("on = {}, strands = 3, n = 4, mass = 6, clamped = false", "return mass(1, 2)", 0.5, ROUNDING);
}

#define SCENE "local scene = hooke.scene {}\nlocal a = scene:particles { positions = { {0,0,0} } }\nscene:hair { "
#define END " }\nreturn scene\n"

static void nonsense_is_refused_with_its_line(void **state) {
  (void)state;
  static const char *const cases[][2] = {
      {"strands = 3, n = 4", "bad.lua:3: hair: on is required"},
      {"on = {}, n = 4", "hair: strands is required"},
      {"on = {}, strands = 3, n = 2", "hair: n: 2 is not a whole number from 3"},
      {"on = { radius = 0 }, strands = 3, n = 4", "hair: on: radius: 0 must be above 0"},
      {"on = { cap = 4 }, strands = 3, n = 4", "hair: on: cap: 4 rad is above pi"},
      {"on = { axis = { 0, 0, 0 } }, strands = 3, n = 4", "hair: on: axis: must not be zero"},
      {"on = { u = { 0, 2, 0 } }, strands = 3, n = 4", "hair: the surface has no area"},
      {"on = a, strands = 3, n = 4", "hair: on: the surface has no triangles"},
      {"on = { vertices = { 0, 0, 0 }, faces = { 1, 2, 3 } }, strands = 3, n = 4",
       "hair: on: faces[2]: there is no vertex 2"},
      {"on = { vertices = { 0, 0 }, faces = { 1, 1, 1 } }, strands = 3, n = 4", "hair: on: vertices: expected a list"},
      {"on = {}, strands = 1e5, n = 1e5", "hair: 100000 strands of 100000 particles are too many: at most 20000000"},
      {"on = {}, strands = 3, n = 4, vary_length = 1", "hair: vary_length: 1 is not from 0 to 0.99"},
      {"on = {}, strands = 3, n = 4, spread = -1", "hair: spread: -1 is not from 0 to"},
      {"on = {}, strands = 3, n = 4, radius = -1", "hair: radius: -1 m must be above 0"},
  };
  char scene[400];
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    snprintf(scene, sizeof scene, SCENE "%s" END, cases[k][0]);
    test_refused(scene, "", 1, cases[k][1]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(roots_lie_on_the_surface_and_strands_leave_it_straight),
      cmocka_unit_test(roots_are_even),
      cmocka_unit_test(a_seed_gives_the_same_hair),
      cmocka_unit_test(strands_vary_within_what_is_asked),
      cmocka_unit_test(strands_follow_one_another),
      cmocka_unit_test(nonsense_is_refused_with_its_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
