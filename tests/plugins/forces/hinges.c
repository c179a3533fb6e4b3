/* Hinges by hand, through pi, and against their energy and differences of themselves; the plate that they are on four
 * kinds of mesh; what cannot be bent; triangles without area; deaths; no memory. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double PI = 3.14159265358979323846;

static hk_status open_run(test_engine *e) { return hk_run_open(e->scene, &e->options, &e->run, &e->error); }

/* ---- One hinge --------------------------------------------------------------------------------------------------- */

/* The edge from (0, 0, 0) to (0, l, 0); the wing c of height p flat, and d of height q turned down by `angle`. */
static hk_plugin_spec *open_hinge(test_engine *e, double l, double p, double q, double angle) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1), test_particle(e, 0, l, 0, 1);
  test_particle(e, -p, 0.3 * l, 0, 1), test_particle(e, q * cos(angle), 0.6 * l, -q * sin(angle), 1);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "hinges");
  test_tuples(e, spec, "hinges", 4, (uint32_t[]){1, 2, 3, 4}, 1);
  e->options.dt = 1e-3;
  return spec;
}

/* k as bending.c has it, with feet at 0.3 l and 0.6 l; the moment k angle pulls d by moment/q across its wing, and c by
 * moment/p. */
static void a_hinge_by_hand(void **state) {
  (void)state;
  const double l = 2, p = 0.5, q = 1.5, B = 3;
  const double k_c = (l * l * (1 + 0.09 + 0.49) + 2 * p * p) / (3 * l * p),
               k_d = (l * l * (1 + 0.36 + 0.16) + 2 * q * q) / (3 * l * q), k = 2 * B / (1 / k_c + 1 / k_d);
  for (double angle = -3; angle < 3.1; angle += 0.5) {
    test_engine e;
    double F[12];
    hk_plugin_spec *spec = open_hinge(&e, l, p, q, angle);
    test_number(&e, spec, "rigidity", B);
    test_number(&e, spec, "rest", 0);
    test_run(&e);
    hk_instance *hinge = test_instance(&e, spec);
    hk_view view = force_view(&e, hinge);
    force_evaluate(hinge, &view, F);
    double across[3] = {sin(angle), 0, cos(angle)}, pull = 0;
    for (int c = 0; c < 3; c++) pull += F[9 + c] * across[c];
    assert_true(fabs(pull * q - k * angle) < 1e-14 * k * PI); /* the rounding of an angle of up to pi */
    assert_true(fabs(F[8] * p - k * angle) < 1e-14 * k * PI);
    assert_true(fabs(hinge->plugin->force->energy(hinge->self, &view) - k * angle * angle / 2) < 1e-13 * k);
    test_engine_close(&e);
  }
}

static void at_rest_there_is_no_force(void **state) {
  (void)state;
  test_engine e;
  double F[12];
  hk_plugin_spec *spec = open_hinge(&e, 2, 0.5, 1.5, 2.5);
  test_number(&e, spec, "rigidity", 3);
  test_run(&e);
  hk_instance *hinge = test_instance(&e, spec);
  hk_view view = force_view(&e, hinge);
  force_evaluate(hinge, &view, F);
  for (int c = 0; c < 12; c++) assert_true(F[c] == 0);
  test_engine_close(&e);
}

/* Turned on step by step the angle goes beyond pi, and one and a half turns, and back; the energy follows. */
static void angles_go_on_through_pi(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_hinge(&e, 2, 1, 1, 0.1);
  test_number(&e, spec, "rigidity", 1);
  test_number(&e, spec, "rest", 0);
  test_run(&e);
  hk_instance *hinge = test_instance(&e, spec);
  hk_view view = force_view(&e, hinge);
  double x[12], k = 2 / (6 / (4 * 1.58 + 2) + 6 / (4 * 1.52 + 2)); /* as above, p = q = 1, l = 2 */
  memcpy(x, view.x, sizeof x);
  view.x = x;
  for (int n = 1; n <= 120; n++) {
    double angle = 0.1 + 0.15 * (n <= 60 ? n : 120 - n); /* to 9.1 */
    x[9] = cos(angle), x[11] = -sin(angle);
    assert_true(fabs(hinge->plugin->force->energy(hinge->self, &view) - k * angle * angle / 2) < 1e-12);
    assert_int_equal(hk_force_of(hinge->plugin)->steps.accepted(hinge->self, &view, 1e-3), HK_OK);
  }
  test_engine_close(&e);
}

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

/* A crumpled sheet that moves. */
static hk_plugin_spec *open_crumpled(test_engine *e, sheet *s) {
  uint64_t seed = 3;
  *s = sheet_make(SHEET_IRREGULAR, 3, (double[]){0.8, 0.3, -0.5});
  test_engine_open(e);
  hk_plugin_spec *spec = sheet_add(e, s, "hinges");
  for (size_t k = 0; k < 3 * s->particles; k++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    double noise = (double)(seed >> 11) / 9007199254740992.0 - 0.5;
    e->scene->particles.velocity[k] = noise;
    e->scene->particles.position[k] += k % 3 == 2 ? 0.5 * noise : 0;
  }
  test_number(e, spec, "rigidity", 2);
  test_number(e, spec, "rest", 0.2);
  test_number(e, spec, "damping", 0.7);
  return spec;
}

static void force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  test_engine e;
  sheet s;
  hk_plugin_spec *spec = open_crumpled(&e, &s);
  test_run(&e);
  hk_instance *hinges = test_instance(&e, spec);
  hk_view view = force_view(&e, hinges), resting = view;
  double *still = calloc(3 * s.particles, sizeof *still);
  resting.v = still;
  assert_true(force_gradient_error(hinges, &resting) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(hinges, &view) < FORCE_DIFFERENCES);
  assert_true(force_damping_error(hinges, &view) < FORCE_DIFFERENCES);
  free(still);
  sheet_free(&s);
  test_engine_close(&e);
}

/* Forces of some 100 N at arms of 1 m sum to nothing but their rounding. */
static void momentum_is_kept(void **state) {
  (void)state;
  test_engine e;
  sheet s;
  hk_plugin_spec *spec = open_crumpled(&e, &s);
  test_run(&e);
  hk_instance *hinges = test_instance(&e, spec);
  hk_view view = force_view(&e, hinges);
  double *F = malloc(3 * s.particles * sizeof *F), sum[6] = {0}, largest = 0;
  force_evaluate(hinges, &view, F);
  for (size_t i = 0; i < s.particles; i++)
    for (size_t c = 0, d = 1, g = 2; c < 3; c++, d = (d + 1) % 3, g = (g + 1) % 3) {
      sum[c] += F[3 * i + c];
      sum[3 + c] += view.x[3 * i + d] * F[3 * i + g] - view.x[3 * i + g] * F[3 * i + d];
      largest = fmax(largest, fabs(F[3 * i + c]));
    }
  assert_true(largest > 10);
  for (int c = 0; c < 6; c++) assert_true(fabs(sum[c]) < 1e-13 * largest);
  free(F);
  sheet_free(&s);
  test_engine_close(&e);
}

/* ---- The plate --------------------------------------------------------------------------------------------------- */

/* Per area. q: see bending.c; of alternating squares the corners of four triangles move by q a^2/4 up, the others down.
 */
static double energy_of(sheet_kind kind, size_t cells, const double h[3], double q) {
  test_engine e;
  sheet s = sheet_make(kind, cells, h);
  double move = q / (4 * (double)(cells * cells));
  for (size_t k = 0; k < s.particles; k++) s.x[k][2] += (k % (cells + 1) + k / (cells + 1)) % 2 ? move : -move;
  test_engine_open(&e);
  hk_plugin_spec *spec = sheet_add(&e, &s, "hinges");
  test_number(&e, spec, "rigidity", 1);
  test_number(&e, spec, "rest", 0);
  test_run(&e);
  hk_instance *hinges = test_instance(&e, spec);
  hk_view view = force_view(&e, hinges);
  double energy = hinges->plugin->force->energy(hinges->self, &view) / s.area;
  sheet_free(&s);
  test_engine_close(&e);
  return energy;
}

/* Per area, of curvatures h, in units of B/2. Border cells have half their hinges, so that the sum over n cells is that
 * of the plate less a part of order 1/n, which two n remove. */
static double plate(sheet_kind kind, const double h[3], double q) {
  const double small = 1e-4, scaled[3] = {small * h[0], small * h[1], small * h[2]};
  double coarse = energy_of(kind, 8, scaled, small * q), fine = energy_of(kind, 16, scaled, small * q);
  return 2 * (2 * fine - coarse) / (small * small);
}

/* bending.c. Angles of 1e-4 leave relative errors of 1e-8; corners of the rows of equilateral triangles 1/n^2. */
static void regular_meshes_are_the_plates_of_bending_c(void **state) {
  (void)state;
  static const double list[][3] = {{1, 0, 0}, {0, 0, 1},  {0.5, 0.5, 0.5}, {0.5, -0.5, 0.5},
                                   {1, 0, 1}, {1, 0, -1}, {0, 1, 0}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    const double *h = list[k], xx = h[0], xy = h[1], yy = h[2], trace = xx + yy, det = xx * yy - xy * xy;
    const double isotropic = trace * trace - 8 * det / 3;
    double one_way = 4.0 / 3 * ((xx + xy) * (xx + xy) + (yy + xy) * (yy + xy) + 2 * xy * xy);
    assert_true(fabs(plate(SHEET_ONE_WAY, h, 0) - one_way) < 1e-6);
    assert_true(fabs(plate(SHEET_EQUILATERAL, h, 0) - isotropic) < 0.01);
    double rest = plate(SHEET_ALTERNATING, h, trace / 4);
    assert_true(fabs(rest - isotropic) < 1e-6);
    for (double away = -0.1; away < 0.2; away += 0.2) /* a minimum: 4/3 (2 + 2) away^2 more */
      assert_true(fabs(plate(SHEET_ALTERNATING, h, trace / 4 + away) - rest - 16.0 / 3 * away * away) < 1e-6);
  }
}

/* Cylinders across eight lines, whose particles lie on them: at rest they would lie where the energy is less. */
static void irregular_meshes_come_near(void **state) {
  (void)state;
  double least = INFINITY, most = 0;
  for (int k = 0; k < 8; k++) {
    double c = cos(PI * k / 8), s = sin(PI * k / 8), small = 1e-4;
    double e = 2 * energy_of(SHEET_IRREGULAR, 32, (double[]){small * c * c, small * c * s, small * s * s}, 0);
    least = fmin(least, e / (small * small)), most = fmax(most, e / (small * small));
  }
  print_message("cylinders laid on an irregular mesh: %.3f to %.3f of B kappa^2/2\n", least, most);
  assert_true(least > 1.2 && most < 1.55); /* measured: 1.28 to 1.47 */
}

/* ---- What cannot be bent ------------------------------------------------------------------------------------------
 */

static void refused(const double (*x)[3], size_t n, const uint32_t *corner, size_t triangles, const char *text) {
  test_engine e;
  test_engine_open(&e);
  for (size_t k = 0; k < n; k++) test_particle(&e, x[k][0], x[k][1], x[k][2], 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "hinges");
  if (triangles) test_tuples(&e, spec, "triangles", 3, corner, triangles);
  test_number(&e, spec, "rigidity", 1);
  e.options.dt = 1e-3;
  assert_int_equal(open_run(&e), HK_BAD_PARAM);
  if (!strstr(e.error.text, text)) fail_msg("'%s' is not in: %s", text, e.error.text);
  test_engine_close(&e);
}

static void what_cannot_bend_is_named(void **state) {
  (void)state;
  static const double x[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}},
                      line[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {3, 0, 0}};
  refused(x, 5, (uint32_t[]){1, 2, 3, 2, 1, 4, 5, 1, 2}, 3,
          "the edge from particle 1 to particle 2 belongs to 3 triangles, among them 1, 2 and 3");
  refused(x, 5, (uint32_t[]){1, 2, 3, 3, 2, 1}, 2,
          "the triangles 1 and 2 have the same corners, the particles 1, 2 and 3");
  refused(x, 5, (uint32_t[]){1, 2, 3}, 1, "there is nothing to bend: no two triangles share an edge");
  refused(x, 5, NULL, 0, "there is nothing to bend");
  refused(line, 4, (uint32_t[]){1, 2, 3, 2, 1, 4}, 2,
          "the hinge of particles {1, 2, 3, 4} (edge, opposite corners): a triangle of it has no area at the start");
}

/* All four in one point, in a line, the edge of length 0: no force, no NaN, and back with the angle that it had. */
static void a_triangle_without_area_has_no_force(void **state) {
  (void)state;
  static const double flat[3][12] = {{0}, {0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0}, {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0}};
  test_engine e;
  double F[12], K[144], D[144];
  hk_plugin_spec *spec = open_hinge(&e, 2, 1, 1, 0.5);
  test_number(&e, spec, "rigidity", 1);
  test_number(&e, spec, "rest", 0);
  test_run(&e);
  hk_instance *hinge = test_instance(&e, spec);
  hk_view view = force_view(&e, hinge), at = view;
  for (int k = 0; k < 3; k++) {
    at.x = flat[k];
    force_evaluate(hinge, &at, F);
    force_matrices(hinge, &at, K, D);
    for (int c = 0; c < 12; c++) assert_true(F[c] == 0);
    for (int c = 0; c < 144; c++) assert_true(K[c] == 0);
    assert_int_equal(hk_force_of(hinge->plugin)->steps.accepted(hinge->self, &at, 1e-3), HK_OK);
  }
  assert_true(fabs(hinge->plugin->force->energy(hinge->self, &view) -
                   0.25 / (6 / (4 * 1.58 + 2) + 6 / (4 * 1.52 + 2))) < 1e-14);
  test_engine_close(&e);
}

/* ---- Methods that work element by element ------------------------------------------------------------------------ */

/* A crumpled sheet without springs falls for a while from rest. */
static void fall(const char *method, double tolerance, double *x) {
  test_engine e;
  sheet s;
  test_number(&e, open_crumpled(&e, &s), "damping", 0);
  memset(e.scene->particles.velocity, 0, 3 * s.particles * sizeof(double));
  test_pin(&e, HK_PIN_FIXED, 1, NULL), test_pin(&e, HK_PIN_FIXED, 2, NULL), test_pin(&e, HK_PIN_FIXED, 6, NULL);
  test_plugin(&e, HK_FORCE, "gravity");
  hk_plugin_spec *integrator = test_plugin(&e, HK_INTEGRATOR, method);
  if (tolerance > 0) {
    test_number(&e, integrator, "iterations", 2000);
    test_number(&e, integrator, "tolerance", tolerance);
  }
  e.scene->duration = 0.1;
  test_run(&e);
  test_advance(&e, 0.1);
  for (uint32_t i = 0; i < s.particles; i++) memcpy(x + 3 * i, test_position(&e, i + 1), 3 * sizeof *x);
  sheet_free(&s);
  test_engine_close(&e);
}

/* local_global, iterated to the end, is backward Euler: it has force, gradient and weight of every hinge from the
 * elements. Both end their iterations at 1e-10 of what a step moves, and a hundred steps make ten times that or so. */
static void elements_are_the_force(void **state) {
  (void)state;
  double x[48], y[48], off = 0;
  fall("backward_euler", 0, x);
  fall("local_global", 1e-10, y);
  for (int k = 0; k < 48; k++) off = fmax(off, fabs(x[k] - y[k]));
  assert_true(off < 1e-8); /* of 5 cm and more */
}

/* ---- Deaths, memory ------------------------------------------------------------------------------------------------
 */

/* The hinges that are left keep rest angles and rigidities of the start, whatever the shape is now. */
static void hinges_follow_deaths(void **state) {
  (void)state;
  test_engine e;
  sheet s;
  hk_plugin_spec *spec = open_crumpled(&e, &s);
  test_run(&e);
  hk_instance *hinges = test_instance(&e, spec);
  hk_view view = force_view(&e, hinges);
  size_t n = s.particles;
  uint32_t map[16];
  double x[48], v[48], F[48], G[48];
  for (uint32_t i = 0; i < n; i++) map[i] = i == 0 ? UINT32_MAX : i - 1;
  memcpy(x, view.x, sizeof x), memcpy(v, view.v, sizeof v);
  for (size_t k = 0; k < 48; k++) x[k] *= 1.1;
  view.x = x, view.v = v;
  force_evaluate(hinges, &view, F);
  memmove(x, x + 3, 45 * sizeof *x), memmove(v, v + 3, 45 * sizeof *v);
  uint32_t id[15];
  hk_model model = *view.model;
  for (uint32_t i = 0; i < 15; i++) id[i] = i + 2;
  model.id = id, model.n = view.n = view.acting = n - 1, view.model = &model;
  assert_int_equal(hk_instance_remap(hinges, map, n, &view, 6 * n - 5, &e.error), HK_OK);
  force_evaluate(hinges, &view, G);
  for (size_t k = 3 * 10; k < 3 * n; k++)
    assert_true(F[k] == G[k - 3]); /* ids 11 to 16, in no hinge with the dead one */
  sheet_free(&s);
  test_engine_close(&e);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    sheet s;
    open_crumpled(&e, &s);
    e.options.allocations = k + 1;
    hk_status status = open_run(&e);
    sheet_free(&s);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 8);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_hinge_by_hand),
      cmocka_unit_test(at_rest_there_is_no_force),
      cmocka_unit_test(angles_go_on_through_pi),
      cmocka_unit_test(force_and_jacobian_are_derivatives),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(regular_meshes_are_the_plates_of_bending_c),
      cmocka_unit_test(irregular_meshes_come_near),
      cmocka_unit_test(what_cannot_bend_is_named),
      cmocka_unit_test(a_triangle_without_area_has_no_force),
      cmocka_unit_test(elements_are_the_force),
      cmocka_unit_test(hinges_follow_deaths),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
