/* The corrector untangle in runs: tangled starts of all kinds become free and stay so, what it says, vertices between
 * bodies that close, threads and checkpoints. */
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

/* Two sheets, the upper one with a bump through the lower one. */
#define HEAD(options) "local scene = hooke.scene { fps = 60, " options " }\n"
static const char *const bump =
    "local n = 16\nlocal function sheet(place)\n  local x, faces = {}, {}\n"
    "  for j = 0, n - 1 do for i = 0, n - 1 do x[#x + 1] = place(i / (n - 1), j / (n - 1)) end end\n"
    "  for j = 0, n - 2 do for i = 1, n - 1 do\n    local k = j * n + i\n"
    "    faces[#faces + 1] = { k, k + 1, k + n + 1 }\n    faces[#faces + 1] = { k, k + n + 1, k + n }\n  end end\n"
    "  local m = scene:mesh { vertices = x, faces = faces, density = 0.2 }\n"
    "  scene:force('springs', { edges = m:edges(), k = 50, damping = 0.02, label = 'sheet' .. m:at(1) })\n"
    "  return m\nend\n"
    "local low = sheet(function(u, v) return { u, v, 0 } end)\n"
    "local high = sheet(function(u, v)\n"
    "  return { u + 0.013, v + 0.007, 0.03 - 0.12 * math.exp(-((u - 0.5) ^ 2 + (v - 0.5) ^ 2) / 0.03) } end)\n";

static void write_scene(const char *name, const char *const *parts) {
  static char text[1 << 14];
  text[0] = 0;
  for (; *parts; parts++) strncat(text, *parts, sizeof text - strlen(text) - 1);
  test_write(name, text);
}

static void run(const char *arguments) {
  char all[512];
  snprintf(all, sizeof all, "run %s --json", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.err, r.out);
}

/* The verdict counts a frame on which there are more than before, or any again; so none of the starts' ever rose. */
static void expect_freed(double at_start) {
  assert_true(test_json(r.out, "intersections_first") >= at_start);
  assert_true(test_json(r.out, "intersections") == 0);
  assert_non_null(strstr(r.out, "\"verdict\":\"ok\""));
}

static void a_tangled_start_becomes_free(void **state) {
  (void)state;
  write_scene("bump.lua",
              (const char *const[]){HEAD("duration = 0.3"), bump,
                                    "scene:corrector('contact')\nscene:corrector('untangle')\nreturn scene\n", NULL});
  run("bump.lua --no-output --integrator leapfrog");
  expect_freed(60);
  assert_non_null(
      strstr(r.err, "1 closed, 0 from border to border, 0 to the tip of a fold, 0 others) are gone at t = "));
}

/* Without it the start is refused. */
static void without_it_the_start_is_refused(void **state) {
  (void)state;
  write_scene("bump.lua",
              (const char *const[]){HEAD("duration = 0.1"), bump, "scene:corrector('contact')\nreturn scene\n", NULL});
  test_hooke(&r, NULL, "run bump.lua --no-output --integrator leapfrog");
  assert_true(r.code != 0);
  assert_non_null(strstr(r.err, "surfaces intersect at the start"));
  assert_non_null(strstr(r.err, " m, all from (0.307, 0.301, "));
  assert_non_null(strstr(r.err, ") m: start them apart; or scene:corrector(\"untangle\""));
}

/* What is not whole at the start of contact: a corner through a sheet, strips across each other, cloth around a ball.
 */
static void other_tangles_become_free(void **state) {
  (void)state;
  const char *const scenes[] = {
      "local a = scene:grid { nx = 12, ny = 12, density = 0.2 }\n"
      "local b = scene:grid { nx = 12, ny = 12, density = 0.2, origin = { 0.8, 0.83, -0.08 }, u = { 1, 0, 0.5 } }\n"
      "scene:force('springs', { edges = a:structural() .. a:shear() .. b:structural() .. b:shear(), k = 50, damping = "
      "0.02 })\n",
      "local a = scene:grid { nx = 21, ny = 5, height = 0.2, origin = { -0.5, -0.1, 0 }, density = 0.2 }\n"
      "local b = scene:grid { nx = 21, ny = 5, height = 0.2, origin = { 0.01, -0.507, -0.0931 }, u = { 0, 1, 0 },\n"
      "  v = { 0, 0.1, 0.9949 }, density = 0.2 }\n"
      "scene:force('springs', { edges = a:structural() .. a:shear() .. b:structural() .. b:shear(), k = 50, damping = "
      "0.02 })\n",
      "local a = scene:grid { nx = 25, ny = 25, origin = { -0.5, -0.5, 0.12 }, density = 0.2 }\n"
      "scene:body { shape = 'sphere', radius = 0.2, detail = 0.02, position = { 0.013, 0.011, 0 } }\n"
      "scene:force('springs', { edges = a:structural() .. a:shear(), k = 50, damping = 0.02 })\n",
      "local x, faces, nx, ny = {}, {}, 41, 11\n"
      "for j = 0, ny - 1 do for i = 0, nx - 1 do\n  local s, y = i / (nx - 1), j / (ny - 1) * 0.4\n"
      "  local r = 0.15 + 0.02 * math.cos(9 * y) * (s - 0.5)\n"
      "  x[#x + 1] = { r * math.cos(2.3 * math.pi * s), y, r * math.sin(2.3 * math.pi * s) }\nend end\n"
      "for j = 0, ny - 2 do for i = 1, nx - 1 do\n  local k = j * nx + i\n"
      "  faces[#faces + 1] = { k, k + 1, k + nx + 1 }\n  faces[#faces + 1] = { k, k + nx + 1, k + nx }\nend end\n"
      "local m = scene:mesh { vertices = x, faces = faces, density = 0.2 }\n"
      "scene:force('springs', { edges = m:edges(), k = 50, damping = 0.02 })\n"};
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    write_scene("other.lua",
                (const char *const[]){HEAD("duration = 0.1"), scenes[k],
                                      "scene:corrector('contact')\nscene:corrector('untangle')\nreturn scene\n", NULL});
    run("other.lua --no-output --integrator leapfrog");
    expect_freed(4);
  }
}

/* A square sheet that is folded without strain as a cone, whose section on the unit sphere is a figure of eight of the
 * length 2 pi: it passes through itself along one line, from the cone's tip inside of it to its border. */
static const char *const fold =
    "local n, L, steps, ratio = 13, 0.4, 1000, param('ratio', 0.5)\n"
    "local function eight(a, t)\n  local y, z = a * math.sin(t), a * ratio * math.sin(2 * t)\n"
    "  local l = math.sqrt(1 + y * y + z * z)\n  return 1 / l, y / l, z / l\nend\n"
    "local sums = { [0] = 0 }\n"
    "local function measure(a)\n  local px, py, pz = eight(a, 0)\n  for k = 1, steps do\n"
    "    local x, y, z = eight(a, 2 * math.pi * k / steps)\n"
    "    sums[k] = sums[k - 1] + math.sqrt((x - px) ^ 2 + (y - py) ^ 2 + (z - pz) ^ 2)\n"
    "    px, py, pz = x, y, z\n  end\n  return sums[steps]\nend\n"
    "local low, high = 0.1, 50\nfor _ = 1, 40 do\n  local a = (low + high) / 2\n"
    "  if measure(a) < 2 * math.pi then low = a else high = a end\nend\n"
    "local x, faces, flat = {}, {}, {}\n"
    "for j = 0, n - 1 do for i = 0, n - 1 do\n"
    "  local u, v = L * (i / (n - 1) - 0.4871), L * (j / (n - 1) - 0.4637)\n"
    "  local r, at, k = math.sqrt(u * u + v * v), (math.atan(v, u) + 0.3) % (2 * math.pi), 0\n"
    "  while k < steps - 1 and sums[k + 1] < at do k = k + 1 end\n"
    "  local a, b, c = eight(low, 2 * math.pi * (k + (at - sums[k]) / (sums[k + 1] - sums[k])) / steps)\n"
    "  x[#x + 1], flat[#flat + 1] = { r * a, r * b, r * c }, { u, v }\nend end\n"
    "for j = 0, n - 2 do for i = 1, n - 1 do\n  local k = j * n + i\n"
    "  faces[#faces + 1] = { k, k + 1, k + n + 1 }\n  faces[#faces + 1] = { k, k + n + 1, k + n }\nend end\n"
    "local m = scene:mesh { vertices = x, faces = faces, density = 0.2 }\n"
    "local edges, rest = m:edges(), {}\nfor e = 1, #edges do\n  local a, b = flat[edges[e][1]], flat[edges[e][2]]\n"
    "  rest[e] = math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2)\nend\n"
    "scene:force('springs', { edges = edges, rest = rest, k = 10, damping = 0.02 })\nscene:force('drag', { rate = 5 "
    "})\n"
    "scene:corrector('contact', { thickness = 2e-5 })\nscene:corrector('untangle', { thickness = 2e-5 })\n"
    "return scene\n";

static void an_open_path_to_the_tip_of_a_fold_becomes_free(void **state) {
  (void)state;
  write_scene("fold.lua", (const char *const[]){HEAD("duration = 0.05"), fold, NULL});
  for (int k = 3; k < 9; k += 2) {
    char arguments[128];
    snprintf(arguments, sizeof arguments, "fold.lua ratio=0.%d --no-output --integrator leapfrog", k);
    run(arguments);
    expect_freed(20);
    assert_non_null(
        strstr(r.err, "0 closed, 0 from border to border, 1 to the tip of a fold, 0 others) are gone at t = "));
  }
}

/* ---- between bodies ---- */

/* A sheet between two squares that close from 0.1 m on both sides at 0.1 m/s, past each other at 1 s, and its middle's
 * height and speed. */
static const char *const press =
    "local a = scene:grid { nx = 7, ny = 7, origin = { -0.5, -0.5, 0 }, density = 0.2 }\n"
    "scene:force('springs', { edges = a:structural() .. a:shear(), k = 50, damping = 0.02 })\n"
    "local stop = param('stop', 0.97)\n"
    "local function closed(t) return 0.1 * math.min(t, stop) end\n"
    "scene:body { shape = 'plane', size = 2, position = { 0, 0.01, -0.1 }, path = function(t) return 0, 0, closed(t) "
    "end }\n"
    "scene:body { shape = 'plane', size = 2, position = { 0.01, 0, 0.1 }, path = function(t) return 0, 0, -closed(t) "
    "end }\n"
    "scene:force('gravity')\n"
    "scene:corrector('contact', { thickness = 0.005, body_thickness = 0.005 })\n"
    "scene:corrector('untangle', { thickness = 0.005, body_thickness = 0.005 })\n"
    "local turns, last, furthest = 0, 0, 0\n"
    "scene:measure('turns', function(s)\n"
    "  local v = s:velocity(a:at(4, 4))[3]\n"
    "  if s.t > 0.96 and v * last < 0 then turns = turns + 1 end\n"
    "  last = v\n  return turns\nend)\n"
    "scene:measure('furthest', function(s)\n"
    "  furthest = s.t > 0.96 and math.max(furthest, math.abs(s:position(a:at(4, 4))[3])) or 0\n  return "
    "furthest\nend)\n";

/* Planes 6 mm apart leave no room for 10 mm: the sheet sticks, and stays between them. */
static void a_vertex_between_closing_planes_sticks(void **state) {
  (void)state;
  write_scene("press.lua", (const char *const[]){HEAD("duration = 1.2"), press, "return scene\n", NULL});
  run("press.lua --integrator leapfrog --no-output");
  assert_true(test_json(r.out, "intersections") == 0);
  assert_true(test_json(r.out, "furthest") < 0.005);
  assert_true(test_json(r.out, "turns") == 0);
  assert_non_null(strstr(r.err, "between bodies that leave no room for them"));
}

/* Planes that pass through each other: the run ends or is told inaccurate, and nothing is NaN. */
static void bodies_that_close_altogether_are_survived(void **state) {
  (void)state;
  write_scene("press.lua", (const char *const[]){HEAD("duration = 1.2"), press, "return scene\n", NULL});
  test_hooke(&r, NULL, "run press.lua stop=1.1 --integrator leapfrog --no-output --json");
  if (r.code != 0 && r.code != 3 && r.code != 5) fail_msg("exit %d: %s%s", r.code, r.err, r.out);
  assert_null(strstr(r.out, "nan"));
  assert_true(test_json(r.out, "furthest") < 0.02);
}

/* ---- the same bits ---- */

static void read_state(const char *name, char *into, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  size_t got = fread(into, 1, size - 1, file);
  into[got] = 0;
  fclose(file);
  assert_true(got > 1000);
}

static void run_to(const char *format, ...) {
  char arguments[256];
  va_list list;
  va_start(list, format);
  vsnprintf(arguments, sizeof arguments, format, list);
  va_end(list);
  run(arguments);
}

/* A run with one thread, one with two, and one that goes on from `middle`. */
static void expect_same_bits(const char *name, const char *middle, const char *end) {
  enum { SIZE = 1 << 18 };
  char *text[3];
  for (int k = 0; k < 2; k++)
    run_to("%s.lua --integrator leapfrog --threads %d --until %s --state %d.csv --out %s%d", name, k + 1, end, k, name,
           k);
  run_to("%s.lua --integrator leapfrog --until %s --out %s-part", name, middle, name);
  run_to("%s.lua --resume %s-part/newest.checkpoint --until %s --state 2.csv", name, name, end);
  for (int k = 0; k < 3; k++) {
    char file[16];
    snprintf(file, sizeof file, "%d.csv", k);
    text[k] = malloc(SIZE);
    read_state(file, text[k], SIZE);
    assert_string_equal(text[0], text[k]);
  }
  for (int k = 0; k < 3; k++) free(text[k]);
}

/* After a tangled start, and while vertices stick. */
static void threads_and_checkpoints_leave_the_same_bits(void **state) {
  (void)state;
  const char *keep = "scene:output('checkpoint', { every = 1 })\nreturn scene\n";
  write_scene("bump.lua",
              (const char *const[]){HEAD("duration = 0.1"), bump,
                                    "scene:corrector('contact')\nscene:corrector('untangle')\n", keep, NULL});
  expect_same_bits("bump", "0.05", "0.1");
  write_scene("press.lua", (const char *const[]){HEAD("duration = 1.2"), press, keep, NULL});
  expect_same_bits("press", "0.96", "1.05");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tangled_start_becomes_free),
      cmocka_unit_test(without_it_the_start_is_refused),
      cmocka_unit_test(other_tangles_become_free),
      cmocka_unit_test(an_open_path_to_the_tip_of_a_fold_becomes_free),
      cmocka_unit_test(a_vertex_between_closing_planes_sticks),
      cmocka_unit_test(bodies_that_close_altogether_are_survived),
      cmocka_unit_test(threads_and_checkpoints_leave_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
