/* Angle springs by hand; against their energy and differences of themselves, in space and in a plane; at joints whose
 * angle has no direction; EI, walls and rings; what is refused. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 5, JOINTS = 3 };

static const double pi = 3.14159265358979323846;

typedef struct bent {
  test_engine e;
  hk_plugin_spec *spec;
  hk_instance *force;
  hk_view view;
} bent;

static const uint32_t chain[JOINTS][3] = {{1, 2, 3}, {2, 3, 4}, {3, 4, 5}};

/* A chain of N particles with a joint at each of its inner ones. */
static void start(bent *b, double x[N][3], bool plane, const double *rest) {
  static const double v[3 * N] = {0.3, -1, 0.5, 1, 0, 2, -1, 1, 0.2, 0, 0.5, 1, 2, 1, -1};
  test_engine_open(&b->e);
  for (int i = 0; i < N; i++) test_particle(&b->e, x[i][0], x[i][1], x[i][2], 1 + i);
  memcpy(b->e.scene->particles.velocity, v, sizeof v);
  b->spec = test_plugin(&b->e, HK_FORCE, "angle_springs");
  test_tuples(&b->e, b->spec, "joints", 3, &chain[0][0], JOINTS);
  test_list(&b->e, b->spec, "k", (double[]){2, 3, 5}, JOINTS);
  test_list(&b->e, b->spec, "damping", (double[]){0.5, 0, 0.7}, JOINTS);
  if (plane) test_vector(&b->e, b->spec, "normal", 0, 0.6, 1.6); /* it is made a unit vector */
  if (rest) test_list(&b->e, b->spec, "rest", rest, JOINTS);
  b->e.options.dt = 1e-3;
  test_run(&b->e);
  b->force = test_instance(&b->e, b->spec);
  b->view = force_view(&b->e, b->force);
}

static double crooked[N][3] = {{0, 0, 0}, {1, 0.2, -0.1}, {0.9, 1.1, 0}, {0.2, 0.3, 0.9}, {1.2, 1.3, 1.1}};
static double straight[N][3] = {{0, 0, 0}, {1, 0.5, 0.25}, {2, 1, 0.5}, {3, 1.5, 0.75}, {4, 2, 1}};

/* A right angle between edges of 1 m and 2 m: k pi/2 = pi N m, so pi/1 m and pi/2 m as forces. */
static void a_right_angle_by_hand(void **state) {
  (void)state;
  bent b;
  double x[N][3] = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, 4, 0}, {1, 6, 0}}, F[3 * N], still[3 * N] = {0};
  start(&b, x, false, (double[]){0, 0, 0});
  b.view.v = still;
  force_evaluate(b.force, &b.view, F);
  const double known[3 * N] = {0, -pi, 0, -pi / 2, pi, 0, pi / 2, 0, 0};
  for (int k = 0; k < 3 * N; k++)
    if (!(fabs(F[k] - known[k]) < 1e-15 * 4 * pi)) fail_msg("F[%d] = %.17g, known %.17g", k, F[k], known[k]);
  assert_true(fabs(b.force->plugin->force->energy(b.force->self, &b.view) - pi * pi / 4) < 1e-14);
  test_engine_close(&b.e);
}

static void derivatives(double x[N][3], bool plane, const double *rest) {
  bent b;
  double still[3 * N] = {0};
  start(&b, x, plane, rest);
  hk_view resting = b.view;
  resting.v = still;
  assert_true(force_gradient_error(b.force, &resting) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(b.force, &b.view) < FORCE_DIFFERENCES);
  assert_true(force_damping_error(b.force, &b.view) < FORCE_DIFFERENCES);
  test_engine_close(&b.e);
}

static void force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  derivatives(crooked, false, (double[]){0, 0.4, 1.5});
  derivatives(crooked, false, (double[]){3, 0, 0});
  derivatives(crooked, true, (double[]){-1, 0.4, 3});
  derivatives(straight, true, (double[]){-1, 0, 0.7});
}

/* A straight rod resists bending in every plane alike: K u for u across it is k/l^2 times the second difference of u.
 */
static void a_straight_joint_resists_in_all_planes(void **state) {
  (void)state;
  bent b;
  double still[3 * N] = {0}, K[9 * N * N], D[9 * N * N], off = 0;
  const double across[2][3] = {{-0.5, 1, 0}, {-1.0 / 4, -1.0 / 8, 1.25}}, l2 = 1 + 0.25 + 0.0625;
  start(&b, straight, false, (double[]){0, 0, 0});
  b.view.v = still;
  force_matrices(b.force, &b.view, K, D);
  for (int a = 0; a < 2; a++)
    for (int r = 0; r < 3 * N; r++) {
      const double k[] = {2, 3, 5}, u[N] = {0.3, -1, 0.2, 2, 0.7};
      double Ku = 0, known = 0;
      for (int i = 0; i < 3 * N; i++) Ku += K[3 * N * r + i] * u[i / 3] * across[a][i % 3];
      for (int j = 0; j < JOINTS; j++) {
        double second = (u[j] - 2 * u[j + 1] + u[j + 2]) * k[j] / l2 * across[a][r % 3];
        known += r / 3 == j || r / 3 == j + 2 ? second : r / 3 == j + 1 ? -2 * second : 0;
      }
      off = fmax(off, fabs(Ku - known));
    }
  test_engine_close(&b.e);
  if (!(off < 1e-14 * 100)) fail_msg("off by %g", off); /* rounding of sums of some tens */
}

/* E and -grad E are finite everywhere; where there is no direction there is no force. */
static void joints_without_a_direction_exert_no_force(void **state) {
  (void)state;
  double places[4][N][3] = {
      {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {1.5, 0, 0}, {0, 0, 0}}, /* folded back and forth */
      {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}},     /* coincident */
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
      {{0, 0, 0}, {1e-200, 0, 0}, {1, 0, 0}, {1, 1e-170, 0}, {2, 0, 0}},
  };
  for (int p = 0; p < 4; p++)
    for (int plane = 0; plane < 2; plane++) {
      bent b;
      double F[3 * N], K[9 * N * N], D[9 * N * N];
      start(&b, places[p], plane, (double[]){0, 0.5, 1});
      force_evaluate(b.force, &b.view, F);
      force_matrices(b.force, &b.view, K, D);
      for (int k = 0; k < 3 * N; k++)
        if (!(plane ? isfinite(F[k]) : F[k] == 0)) fail_msg("case %d, plane %d: F[%d] = %g", p, plane, k, F[k]);
      for (int k = 0; k < 9 * N * N; k++) assert_true(isfinite(K[k]) && isfinite(D[k]));
      assert_true(isfinite(b.force->plugin->force->energy(b.force->self, &b.view)));
      test_engine_close(&b.e);
    }
}

/* Near folded and near straight: no loss of digits. The force of the first joint is k (theta - rest)/l at both ends. */
static void the_force_is_exact_near_straight_and_folded(void **state) {
  (void)state;
  for (double small = 1e-1; small > 1e-150; small *= 1e-7)
    for (int folded = 0; folded < 2; folded++) {
      bent b;
      double x[N][3] = {{-1, 0, 0}, {0, 0, 0}, {folded ? -1 : 1, small, 0}, {5, 5, 5}, {7, 7, 7}};
      double F[3 * N], still[3 * N] = {0}, angle = folded ? pi - atan(small) : atan(small);
      start(&b, x, false, (double[]){0, 0, 0});
      b.view.v = still;
      force_evaluate(b.force, &b.view, F);
      if (!(fabs(F[1] + 2 * angle) <= 1e-15 * 8 * angle)) fail_msg("%g, folded %d: %.17g", small, folded, F[1] / angle);
      test_engine_close(&b.e);
    }
}

/* In a plane the sign counts, and beyond half a turn the angle goes on from its rest. */
static void in_a_plane_angles_have_a_sign(void **state) {
  (void)state;
  const double rest = 3, turned[] = {2.9, 3.1, -3.1}, known[] = {-0.1, 0.1, 2 * pi - 6.1};
  for (int k = 0; k < 3; k++) {
    bent b;
    double x[3][3] = {{-1, 0, 0}, {0, 0, 0}, {cos(turned[k]), sin(turned[k]), 0}}, E, other;
    test_engine_open(&b.e);
    for (int i = 0; i < 3; i++) test_particle(&b.e, x[i][0], x[i][1], 0, 1);
    b.spec = test_plugin(&b.e, HK_FORCE, "angle_springs");
    test_tuples(&b.e, b.spec, "joints", 3, &chain[0][0], 1);
    test_number(&b.e, b.spec, "k", 2);
    test_number(&b.e, b.spec, "rest", rest);
    test_vector(&b.e, b.spec, "normal", 0, 0, 3);
    b.e.options.dt = 1e-3;
    test_run(&b.e);
    b.force = test_instance(&b.e, b.spec);
    b.view = force_view(&b.e, b.force);
    E = b.force->plugin->force->energy(b.force->self, &b.view);
    other = known[k] * known[k];
    if (!(fabs(E - other) < 1e-14)) fail_msg("%g rad: %.17g J, known %.17g", turned[k], E, other);
    test_engine_close(&b.e);
  }
}

/* The joints of the elements, and their stiffness. */
static hk_elements made(bent *b, const uint32_t (*edge)[2], size_t edges, size_t n, double EI, uint32_t pins) {
  hk_elements out = {.values = 0};
  test_engine_open(&b->e);
  for (size_t i = 0; i < n; i++) test_particle(&b->e, (double)(i * i), 0, 0, 1); /* edges of 1, 3, 5, ... m */
  for (uint32_t i = 1; i <= pins; i++) test_pin(&b->e, HK_PIN_FIXED, i, NULL);
  b->spec = test_plugin(&b->e, HK_FORCE, "angle_springs");
  test_edges(&b->e, b->spec, edge, edges);
  test_number(&b->e, b->spec, "EI", EI);
  b->e.options.dt = 1e-3;
  test_run(&b->e);
  b->force = test_instance(&b->e, b->spec);
  b->view = force_view(&b->e, b->force);
  hk_force_of(b->force->plugin)->elements.list(b->force->self, &b->view, &out);
  return out;
}

static bool close_to(double value, double known) { return fabs(value - known) < 1e-15 * known; } /* a few roundings */

static void EI_is_shared_by_the_lengths_and_walls_do_not_yield(void **state) {
  (void)state;
  bent b;
  const uint32_t edge[][2] = {{1, 2}, {2, 3}, {3, 4}};
  hk_elements out = made(&b, edge, 3, 4, 6, 0);
  assert_true(out.node.count == 2);
  assert_true(close_to(out.stiffness.value[0], 3) && close_to(out.stiffness.value[1], 1.5)); /* EI/l, l = 2 m and 4 m */
  test_engine_close(&b.e);
  out = made(&b, edge, 3, 4, 6, 2);
  assert_true(close_to(out.stiffness.value[0], 4) && close_to(out.stiffness.value[1], 1.5)); /* 2 EI/l_2, l_2 = 3 m */
  test_engine_close(&b.e);
}

/* Edges of 1, 3 and 5 m with an EI each: the halves yield one after the other. Curvature is an angle per length, and
 * retardation a damping in proportion to the stiffness. */
static void every_edge_may_have_its_EI(void **state) {
  (void)state;
  bent b;
  hk_elements out = {.values = 0};
  double C, dC[3][3];
  test_engine_open(&b.e);
  for (int i = 0; i < 4; i++) test_particle(&b.e, i * i, 0, 0, 1);
  b.spec = test_plugin(&b.e, HK_FORCE, "angle_springs");
  test_edges(&b.e, b.spec, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3);
  test_list(&b.e, b.spec, "EI", (double[]){1, 2, 10}, 3);
  test_number(&b.e, b.spec, "k", 0.5);
  test_number(&b.e, b.spec, "damping", 3);
  test_number(&b.e, b.spec, "retardation", 2);
  test_number(&b.e, b.spec, "curvature", 0.1);
  b.e.options.dt = 1e-3;
  test_run(&b.e);
  b.force = test_instance(&b.e, b.spec);
  b.view = force_view(&b.e, b.force);
  hk_force_of(b.force->plugin)->elements.list(b.force->self, &b.view, &out);
  assert_true(close_to(out.stiffness.value[0], 0.5 + 1 / (1. / 2 + 3. / 4)));
  assert_true(close_to(out.stiffness.value[1], 0.5 + 1 / (3. / 4 + 5. / 20)));
  assert_true(close_to(out.damping.value[1], 3 + 2 * out.stiffness.value[1]));
  out.evaluate(out.self, b.view.x, 1, 2, &C, dC);
  assert_true(close_to(-C, 0.4)); /* 0.1/m on 4 m, and it is straight */
  test_engine_close(&b.e);
}

static void joints_are_where_consecutive_edges_meet(void **state) {
  (void)state;
  bent b;
  hk_elements out = made(&b, (const uint32_t[][2]){{1, 2}, {3, 2}, {4, 5}, {5, 6}}, 4, 6, 1, 0);
  assert_true(out.node.count == 2); /* two strands */
  assert_memory_equal(out.node.index, ((uint32_t[]){0, 1, 2, 3, 4, 5}), 6 * sizeof(uint32_t));
  test_engine_close(&b.e);
  out = made(&b, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}, {4, 1}, {5, 6}, {6, 4}}, 6, 6, 1, 0);
  assert_true(out.node.count == 5); /* a ring, and a strand that ends at it */
  assert_memory_equal(out.node.index + 9, ((uint32_t[]){3, 0, 1, 4, 5, 3}), 6 * sizeof(uint32_t));
  test_engine_close(&b.e);
  out = made(&b, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}, {4, 2}}, 4, 4, 1, 0);
  assert_true(out.node.count == 3); /* a loop at the end of a stem is no ring */
  test_engine_close(&b.e);
}

/* Particle 3 of 6 dies: of the joints at 2, 3, 4 and 5 the last is left, with its stiffness and its angle at rest. None
 * appears at the edges that follow one another now. */
static void joints_die_with_their_particles(void **state) {
  (void)state;
  bent b;
  const uint32_t map[6] = {0, 1, UINT32_MAX, 2, 3, 4};
  hk_elements out = made(&b, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}}, 5, 6, 8, 0);
  double x[3 * 6];
  assert_true(out.node.count == 4 && close_to(out.stiffness.value[3], 1)); /* edges of 7 and 9 m */
  memcpy(x, b.view.x, sizeof x);
  memmove(x + 6, x + 9, 9 * sizeof *x);
  x[13] = 1; /* it bends now: its edges are (7, 0) and (9, 1) m */
  b.view.x = x;
  b.view.n = b.view.acting = 5;
  assert_int_equal(hk_instance_remap(b.force, map, 6, &b.view, 6 * 5 + 1, &b.e.error), HK_OK);
  hk_force_of(b.force->plugin)->elements.list(b.force->self, &b.view, &out);
  double C, dC[3][3];
  out.evaluate(out.self, x, 0, 1, &C, dC);
  assert_true(out.node.count == 1 && close_to(out.stiffness.value[0], 1));
  assert_true(out.rest.count == 0); /* no strain for pictures */
  assert_true(close_to(C, atan2(1, 9)));
  assert_memory_equal(out.node.index, ((uint32_t[]){2, 3, 4}), 3 * sizeof(uint32_t));
  test_engine_close(&b.e);
}

static void angles_in_space_keep_both_momenta(void **state) {
  (void)state;
  bent b;
  double F[3 * N], p[3] = {0}, L[3] = {0};
  start(&b, crooked, false, (double[]){0, 0.4, 1.5});
  force_evaluate(b.force, &b.view, F);
  for (int k = 0; k < 3 * N; k++) {
    const double *x = crooked[k / 3];
    int c = k % 3, d = (c + 1) % 3, e = (c + 2) % 3;
    p[c] += F[k];
    L[c] += x[d] * F[k - c + e] - x[e] * F[k - c + d];
  }
  for (int c = 0; c < 3; c++) assert_true(fabs(p[c]) < 1e-14 && fabs(L[c]) < 1e-13); /* forces are up to 20 N */
  test_engine_close(&b.e);
}

#define STRAND "local scene = hooke.scene { duration = 0.1, fps = 10 }\nlocal s = scene:strand { n = 4, mass = 1 }\n"
#define END "return scene\n"

static void nonsense_is_refused(void **state) {
  (void)state;
  test_refused(STRAND "scene:force('angle_springs', { EI = 1 })\n" END, "", 1,
               "bad.lua:3: angle_springs: edges or joints are required");
  test_refused(STRAND "scene:force('angle_springs', { edges = s:edges() })\n" END, "", 1,
               "bad.lua:3: angle_springs: no joint has a stiffness: give EI, or k");
  test_refused(STRAND "scene:force('angle_springs', { edges = {{1, 2}, {3, 4}}, EI = 1 })\n" END, "", 1,
               "none shares an end with the one before it");
  test_refused(STRAND "scene:force('angle_springs', { edges = s:edges(), EI = 1, rest = -0.1 })\n" END, "", 1,
               "rest: -0.1 rad: an angle in space has no sign; give the normal of a plane");
  test_refused(STRAND "scene:force('angle_springs', { edges = s:edges(), EI = 1, rest = 0, curvature = 1 })\n" END, "",
               1, "give rest or curvature, not both");
  test_refused(STRAND "scene:force('angle_springs', { edges = s:edges(), EI = 1, normal = {0, 0, 0} })\n" END, "", 1,
               "normal: must not be zero");
  test_refused(STRAND "scene:force('angle_springs', { joints = {{1, 2, 2}}, EI = 1 })\n" END, "", 1, "bad.lua:3");
  test_refused(STRAND "scene:force('angle_springs', { joints = {{1, 2, 9}}, EI = 1 })\n" END, "", 1,
               "there is no particle 9");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_right_angle_by_hand),
      cmocka_unit_test(force_and_jacobian_are_derivatives),
      cmocka_unit_test(a_straight_joint_resists_in_all_planes),
      cmocka_unit_test(joints_without_a_direction_exert_no_force),
      cmocka_unit_test(the_force_is_exact_near_straight_and_folded),
      cmocka_unit_test(in_a_plane_angles_have_a_sign),
      cmocka_unit_test(EI_is_shared_by_the_lengths_and_walls_do_not_yield),
      cmocka_unit_test(every_edge_may_have_its_EI),
      cmocka_unit_test(joints_are_where_consecutive_edges_meet),
      cmocka_unit_test(joints_die_with_their_particles),
      cmocka_unit_test(angles_in_space_keep_both_momenta),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
