/* Rods by hand, against their energy, against known rest shapes and known twist, under refinement, folded, after deaths
 * and without memory. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 9 };

static const double pi = 3.14159265358979323846;

/* A rod through N particles that wind through space; a ring where the last edge goes back to the first. */
static hk_plugin_spec *open_winding(test_engine *e, bool ring) {
  uint32_t edge[N][2];
  test_engine_open(e);
  for (uint32_t i = 0; i < N; i++) {
    double angle = (ring ? 2 * pi / N : 0.5) * i;
    test_particle(e, cos(angle) + 0.03 * sin(5. * i), sin(angle) + 0.04 * cos(3. * i),
                  0.1 * i * !ring + 0.1 * sin(2. * i), 1 + 0.1 * i);
    edge[i][0] = i + 1;
    edge[i][1] = (i + 1) % N + 1;
  }
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t(*)[2])edge, ring ? N : N - 1);
  test_number(e, rods, "EI", 2);
  e->options.dt = 1e-3;
  return rods;
}

static void pin_both_ends(test_engine *e) {
  for (uint32_t i = 1; i <= N; i++)
    if (i <= 2 || i >= N - 1) test_pin(e, HK_PIN_FIXED, i, NULL);
}

/* Random displacements of up to `size` m, the same in every run. */
static void displace(double *x, const double *from, double size) {
  for (int k = 0; k < 3 * N; k++) x[k] = from[k] + size * sin(12.9898 * k + 4.1);
}

/* ---- force and energy ---- */

/* Two edges of 0.5 m at a right angle: kb = 2, l = 0.5, E = 3/2 2^2/0.5 = 12 J; dE/d(cos) = -4 3/0.5 = -24, and each
 * end is pushed across its edge by 24/0.5 N. Exact in binary. */
static void one_joint_by_hand(void **state) {
  (void)state;
  test_engine e;
  double F[9], E;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 0.5, 0, 0, 1), test_particle(&e, 0.5, 0.5, 0, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "rods");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  test_number(&e, spec, "EI", 3);
  test_text(&e, spec, "rest", "straight");
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *rods = test_instance(&e, spec);
  hk_view view = force_view(&e, rods);
  force_evaluate(rods, &view, F);
  E = rods->plugin->force->energy(rods->self, &view);
  assert_true(E == 12);
  assert_memory_equal(F, ((double[]){0, -48, 0, -48, 48, 0, 48, 0, 0}), sizeof F);
  test_engine_close(&e);
}

typedef struct rod_case {
  const char *name;
  bool ring, clamped;
  double EI2, GJ, curvature, torsion, turn;
  const char *rest;
} rod_case;

static const rod_case rod_cases[] = {
    {"straight", false, false, 0, 0, 0, 0, 0, "straight"},
    {"straight ring", true, false, 0, 0, 0, 0, 0, "straight"},
    {"curved", false, false, 0, 1.5, 0, 0, 0, "initial"},
    {"curved ring", true, false, 0, 1.5, 0, 0, 0, "initial"},
    {"ribbon", false, false, 0.4, 1.5, 0, 0, 0, "straight"},
    {"ribbon, curved at rest", false, true, 7, 1.5, 0, 0, 0, "initial"},
    {"helix", false, false, 0, 1.5, 0.7, 0.4, 0, NULL},
    {"helix of ribbon", false, false, 3, 1.5, -0.7, 1.4, 0, NULL},
    {"ring with torsion", true, false, 3, 1.5, 0.7, 0.4, 1.1, NULL},
    {"twisted between clamps", false, true, 0, 1.5, 0, 0, 2.5, "straight"},
    {"twisted by eleven turns", false, true, 0, 1.5, 0, 0, 22 * 3.14159265358979323846, "straight"},
    {"twisted ring", true, false, 0, 1.5, 0, 0, -7.5, "straight"},
    {"twisted ribbon between clamps", false, true, 3, 1.5, 0, 0, 9, "initial"},
};

static hk_plugin_spec *open_case(test_engine *e, const rod_case *c) {
  hk_plugin_spec *rods = open_winding(e, c->ring);
  if (c->EI2 > 0) test_number(e, rods, "EI2", c->EI2);
  test_number(e, rods, "GJ", c->GJ);
  test_number(e, rods, "turn", c->turn);
  if (c->rest) test_text(e, rods, "rest", c->rest);
  if (!c->rest) test_number(e, rods, "curvature", c->curvature);
  if (!c->rest) test_number(e, rods, "torsion", c->torsion);
  if (c->clamped) pin_both_ends(e);
  return rods;
}

static void forces_are_minus_the_gradient(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof rod_cases / sizeof *rod_cases; k++)
    for (int far = 0; far < 3; far++) {
      test_engine e;
      double x[3 * N], size[] = {0.005, 0.02, 0.15};
      hk_plugin_spec *spec = open_case(&e, &rod_cases[k]);
      test_run(&e);
      hk_instance *rods = test_instance(&e, spec);
      hk_view view = force_view(&e, rods);
      displace(x, view.x, size[far]);
      view.x = x;
      double off = force_gradient_error(rods, &view);
      if (!(off < 10 * FORCE_DIFFERENCES)) print_error("%s, %g m: %g\n", rod_cases[k].name, size[far], off);
      assert_true(off < 10 * FORCE_DIFFERENCES);
      test_engine_close(&e);
    }
}

/* Clamps are displaced with everything else here, and their blocks are those of the place where they were accepted; so
 * only rods without clamps are compared, and those between clamps where they were. */
static void exact_blocks_are_minus_the_derivative(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof rod_cases / sizeof *rod_cases; k++)
    for (int far = 0; far < 3; far++) {
      test_engine e;
      double x[3 * N], size[] = {0, 0.02, 0.15};
      hk_plugin_spec *spec = open_case(&e, &rod_cases[k]);
      test_text(&e, spec, "jacobian", "exact");
      test_run(&e);
      hk_instance *rods = test_instance(&e, spec);
      hk_view view = force_view(&e, rods);
      displace(x, view.x, size[far]);
      view.x = x;
      double off = rod_cases[k].clamped && far > 0 ? 0 : force_stiffness_error(rods, &view);
      if (!(off < 10 * FORCE_DIFFERENCES)) print_error("%s, %g m: %g\n", rod_cases[k].name, size[far], off);
      assert_true(off < 10 * FORCE_DIFFERENCES);
      test_engine_close(&e);
    }
}

/* ---- shapes of rest ---- */

/* `edges` edges on a circle through space, of total length 1. */
static hk_plugin_spec *open_arc(test_engine *e, uint32_t edges, double angle) {
  uint32_t(*edge)[2] = malloc(edges * sizeof *edge);
  double radius = 1 / (2 * edges * sin(angle / (2 * edges)));
  test_engine_open(e);
  for (uint32_t k = 0; k <= edges; k++)
    test_particle(e, radius * sin(angle * k / edges), radius * cos(angle * k / edges), 0, 1);
  for (uint32_t k = 0; k < edges; k++) edge[k][0] = k + 1, edge[k][1] = k + 2;
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t(*)[2])edge, edges);
  test_number(e, rods, "EI", 3);
  e->options.dt = 1e-3;
  free(edge);
  return rods;
}

static double energy_of(test_engine *e, const hk_plugin_spec *spec) {
  hk_instance *rods = test_instance(e, spec);
  hk_view view = force_view(e, rods);
  return rods->plugin->force->energy(rods->self, &view);
}

/* A straight rod of rest curvature 2 pi/L is without energy where it closes to a circle, whatever the number of its
 * edges, and so is one that was given that shape; without rest curvature the energy is EI/2 (2 pi)^2/L, less the half
 * cells at both ends, of second order otherwise: between the energies of 20 and 40 edges there is 1/40 of it. */
static void a_rod_of_rest_curvature_is_a_circle(void **state) {
  (void)state;
  const double whole = 3. / 2 * 4 * pi * pi;
  for (uint32_t edges = 20; edges <= 40; edges *= 2) {
    test_engine e;
    hk_plugin_spec *spec = open_arc(&e, edges, 2 * pi);
    test_number(&e, spec, "GJ", 1);
    test_number(&e, spec, "curvature", 2 * pi);
    test_vector(&e, spec, "axis", 0, -1, 0);
    test_run(&e);
    assert_true(energy_of(&e, spec) < 1e-26 * whole);
    test_engine_close(&e);
    spec = open_arc(&e, edges, 2 * pi);
    test_number(&e, spec, "GJ", 1);
    test_run(&e);
    assert_true(energy_of(&e, spec) < 1e-26 * whole);
    test_engine_close(&e);
    spec = open_arc(&e, edges, 2 * pi);
    test_text(&e, spec, "rest", "straight");
    test_run(&e);
    double joints = (edges - 1.) / edges, tangent = tan(pi / edges) / (pi / edges);
    assert_true(fabs(energy_of(&e, spec) / (whole * joints * tangent * tangent) - 1) < 1e-12);
    test_engine_close(&e);
  }
}

/* `edges` edges of a rod of length 1 bent by 1 rad, and one in the wall at each end, along the arc's ends. */
static hk_plugin_spec *open_clamped_arc(test_engine *e, uint32_t edges) {
  uint32_t edge[64][2];
  double x = 0, y = 0, direction = 0, turn = 1. / edges;
  test_engine_open(e);
  for (uint32_t k = 0; k < edges + 3; k++) {
    test_particle(e, x, y, 0, 1);
    x += cos(direction) / edges, y += sin(direction) / edges;
    direction += k == 0 || k == edges ? turn / 2 : turn;
  }
  for (uint32_t k = 0; k < edges + 2; k++) edge[k][0] = k + 1, edge[k][1] = k + 2;
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t(*)[2])edge, edges + 2);
  test_number(e, rods, "EI", 3);
  test_text(e, rods, "rest", "straight");
  for (uint32_t k = 0; k < 4; k++) test_pin(e, HK_PIN_FIXED, k < 2 ? k + 1 : edges + k, NULL);
  e->options.dt = 1e-3;
  return rods;
}

/* EI/2 (1 rad)^2/L up to second order, that of the tangents, and nothing is left out at the walls: off by
 * 1/(6 n^2) - 1/(8 n^3), the latter since turns at walls are halves. */
static void refinement_changes_nothing_but_second_order(void **state) {
  (void)state;
  double last = 0;
  for (uint32_t edges = 10; edges <= 40; edges *= 2) {
    test_engine e;
    hk_plugin_spec *spec = open_clamped_arc(&e, edges);
    test_run(&e);
    double off = energy_of(&e, spec) / 1.5 - 1;
    assert_true(off < 0.2 / edges / edges && (last == 0 || (off > last / 4.05 && off < last / 3.8)));
    last = off;
    test_engine_close(&e);
  }
}

/* ---- twist ---- */

/* A straight rod between clamps, turned by many turns: E = GJ angle^2/(2 L), L without the two edges in the walls. */
static void twist_of_many_turns_is_uniform(void **state) {
  (void)state;
  for (int turns = -40; turns <= 40; turns += 16) {
    test_engine e;
    uint32_t edge[20][2];
    test_engine_open(&e);
    for (uint32_t k = 0; k <= 20; k++) test_particle(&e, 0.05 * k, 0, 0, 1);
    for (uint32_t k = 0; k < 20; k++) edge[k][0] = k + 1, edge[k][1] = k + 2;
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "rods");
    test_edges(&e, spec, (const uint32_t(*)[2])edge, 20);
    test_number(&e, spec, "EI", 1);
    test_number(&e, spec, "GJ", 0.7);
    test_number(&e, spec, "turn", 2 * pi * turns + 0.3);
    for (uint32_t k = 0; k < 4; k++) test_pin(&e, HK_PIN_FIXED, k < 2 ? k + 1 : 18 + k, NULL);
    e.options.dt = 1e-3;
    test_run(&e);
    double angle = 2 * pi * turns + 0.3;
    assert_true(fabs(energy_of(&e, spec) / (0.7 * angle * angle / (2 * 0.9)) - 1) < 1e-12);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_joint_by_hand),
      cmocka_unit_test(forces_are_minus_the_gradient),
      cmocka_unit_test(exact_blocks_are_minus_the_derivative),
      cmocka_unit_test(a_rod_of_rest_curvature_is_a_circle),
      cmocka_unit_test(refinement_changes_nothing_but_second_order),
      cmocka_unit_test(twist_of_many_turns_is_uniform),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
