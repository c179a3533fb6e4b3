/* The force of a liquid by particles: its energy by hand, its gradient, waves on a lattice, walls, threads, what it
 * says of scenes that it does not suit. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double dx = 0.1, rho0 = 1000, c = 20, kernel = 2.5; /* m, kg/m^3, m/s, spacings */

static hk_plugin_spec *liquid(test_engine *e, const char *law, bool cavitates) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "sph");
  test_number(e, spec, "c", c);
  test_number(e, spec, "spacing", dx);
  test_number(e, spec, "reach", kernel);
  test_text(e, spec, "law", law);
  test_boolean(e, spec, "cavitates", cavitates);
  e->options.dt = 1e-4;
  return spec;
}

/* side^3 particles on a lattice, shaken; those of the lowest layer are walls. */
static void fill(test_engine *e, int side, double shake, bool walls) {
  uint64_t seed[4];
  const double none[3] = {0};
  hk_random_seed(seed, 3);
  for (int i = 0; i < side * side * side; i++) {
    double x[3];
    for (int k = 0, at = i; k < 3; k++, at /= side) x[k] = dx * (at % side + shake * (hk_random_uniform(seed) - 0.5));
    uint32_t id = test_particle(e, x[0], x[1], x[2], rho0 * dx * dx * dx);
    if (walls && i < side * side) test_pin(e, HK_PIN_FIXED, id, none);
  }
}

static void repeat(test_engine *e, double length) {
  const double low[3] = {0}, high[3] = {length, length, length};
  assert_int_equal(hk_scene_set_box(e->scene, low, high, "xyz", &e->error), HK_OK);
}

static hk_view view_of(test_engine *e, const hk_plugin_spec *spec, hk_instance **force) {
  test_run(e);
  *force = test_instance(e, spec);
  return force_view(e, *force);
}

static void close_to(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance * fabs(wanted))) fail_msg("%.17g instead of %.17g", found, wanted);
}

/* ---- the law ---- */

static double shape(double r) { /* the kernel by its value at 0 */
  double t = r / (kernel * dx);
  return t < 1 ? pow(1 - t, 4) * (1 + 4 * t) : 0;
}

/* Value at 0 of the kernel of which the sum over the cubic lattice is the density of the lattice. */
static double peak(void) {
  double sum = 0;
  for (int i = 0; i < 343; i++) sum += shape(dx * sqrt(pow(i % 7 - 3, 2) + pow(i / 7 % 7 - 3, 2) + pow(i / 49 - 3, 2)));
  return 1 / (sum * dx * dx * dx);
}

/* Eight particles of 20 times the usual mass at the corners of a cube: all have the same density. */
static void energy_and_force_by_hand(void **state) {
  (void)state;
  for (int tait = 0; tait < 2; tait++) {
    test_engine e;
    hk_instance *force;
    double F[24], m = 20 * rho0 * dx * dx * dx, a = 1.3 * dx, h = 1e-6 * dx, E[3];
    test_engine_open(&e);
    for (int i = 0; i < 8; i++) test_particle(&e, a * (i & 1), a * (i >> 1 & 1), a * (i >> 2), m);
    hk_plugin_spec *spec = liquid(&e, tait ? "tait" : "quadratic", true);
    hk_view view = view_of(&e, spec, &force);
    for (int k = 0; k < 3; k++) {
      double b = a + (k - 1) * h;
      double s = m / rho0 * peak() * (1 + 3 * shape(b) + 3 * shape(sqrt(2) * b) + shape(sqrt(3) * b));
      E[k] = 8 * m * c * c * (tait ? (pow(s, 6) / 6 + 1 / s - 7. / 6) / 7 : pow(s - 1, 2) / 2);
    }
    close_to(force->plugin->force->energy(force->self, &view), E[1], 1e-13);
    force_evaluate(force, &view, F);
    /* -dE/da = 8 corners x 3 axes x F/2; differences of E leave 1e-16/1e-6 */
    close_to(F[3], -(E[2] - E[0]) / (2 * h) / 12, 1e-8);
    assert_true(F[0] == -F[3] && F[0] == F[1] && F[0] == F[2]);
    test_engine_close(&e);
  }
}

/* A lattice in a periodic box has its density, no force and no energy: the sum of the kernel over it is rounding. */
static void a_liquid_on_its_lattice_is_at_rest(void **state) {
  (void)state;
  test_engine e;
  hk_instance *force;
  enum { SIDE = 6, N = SIDE * SIDE * SIDE };
  double F[3 * N];
  test_engine_open(&e);
  fill(&e, SIDE, 0, false);
  repeat(&e, SIDE * dx);
  hk_plugin_spec *spec = liquid(&e, "tait", false);
  hk_view view = view_of(&e, spec, &force);
  force_evaluate(force, &view, F);
  double scale = rho0 * c * c * dx * dx; /* N, of the bulk modulus on a face of a particle */
  for (int k = 0; k < 3 * N; k++) assert_true(fabs(F[k]) < 1e-12 * scale);
  assert_true(fabs(force->plugin->force->energy(force->self, &view)) < 1e-20 * N * scale * dx);
  test_engine_close(&e);
}

static void force_and_energy_belong_together(void **state) {
  (void)state;
  for (int variant = 0; variant < 4; variant++) {
    test_engine e;
    hk_instance *force;
    test_engine_open(&e);
    fill(&e, variant % 2 ? 6 : 3, 0.4, variant > 1);
    if (variant % 2) repeat(&e, 6 * dx);
    hk_plugin_spec *spec = liquid(&e, variant % 2 ? "quadratic" : "tait", false);
    hk_view view = view_of(&e, spec, &force);
    double off = variant % 2 ? 0 : force_gradient_error(force, &view), F[3 * 216], sum[3] = {0}, most = 0;
    force_evaluate(force, &view, F);
    for (size_t k = 0; k < 3 * view.n; k++) sum[k % 3] += F[k], most = fmax(most, fabs(F[k]));
    if (!(off < FORCE_DIFFERENCES)) fail_msg("variant %d: gradient off by %g", variant, off);
    /* also what acts on walls; 216 numbers of which each is rounded */
    for (int k = 0; k < 3; k++) assert_true(fabs(sum[k]) < 1e-14 * 216 * most);
    test_engine_close(&e);
  }
}

/* Neighbours of neighbours act on each other: 4 particles in a row of which each reaches the next two. Of what presses
 * and of what pulls, with walls, and in a box that repeats. */
static void blocks_are_the_stiffness(void **state) {
  (void)state;
  for (int variant = 0; variant < 4; variant++) {
    test_engine e;
    hk_instance *force;
    test_engine_open(&e);
    fill(&e, 3, 0.4, variant % 2);
    for (int i = 0; i < 4; i++) test_particle(&e, dx * (3 + 1.3 * i), 0.1 * dx, 0, rho0 * dx * dx * dx);
    if (variant > 1) repeat(&e, 7 * dx);
    hk_plugin_spec *spec = liquid(&e, variant % 2 ? "quadratic" : "tait", variant > 1);
    if (variant == 1) test_number(&e, spec, "wall_volume", dx * dx * dx);
    hk_view view = view_of(&e, spec, &force);
    double off = force_stiffness_error(force, &view);
    if (!(off < FORCE_DIFFERENCES)) fail_msg("variant %d: blocks off by %g", variant, off);
    test_engine_close(&e);
  }
}

/* A wave in a plane at ten times the step that leapfrog could take: the implicit midpoint rule keeps its energy, which
 * is nearly quadratic for moves of a thousandth of the spacing, to the tolerance of its iterations. */
static void implicit_methods_step_over_sound(void **state) {
  (void)state;
  enum { LONG = 16, WIDE = 6 };
  const double low[3] = {0}, high[3] = {LONG * dx, WIDE * dx, 1};
  hk_summary s;
  test_engine e;
  test_engine_open(&e);
  for (int i = 0; i < LONG * WIDE; i++) {
    double x = dx * (i % LONG) + 1e-3 * dx * sin(2 * acos(-1) / LONG * (i % LONG));
    test_particle(&e, x, dx * (i / LONG), 0, rho0 * dx * dx * dx);
  }
  assert_int_equal(hk_scene_set_box(e.scene, low, high, "xy", &e.error), HK_OK);
  test_number(&e, liquid(&e, "quadratic", false), "dimensions", 2);
  e.options.integrator = "implicit_midpoint";
  e.options.dt = 10 * 2 * kernel * dx / (2.1 * c);
  e.scene->fps = 1 / e.options.dt;
  e.scene->duration = 8 * e.options.dt;
  test_run(&e);
  test_advance(&e, e.scene->duration);
  hk_run_summary(e.run, &s);
  if (!(s.steps == 8 && s.energy_first > 0 && fabs(s.energy_last / s.energy_first - 1) < 1e-4))
    fail_msg("%g J become %g in %g steps", s.energy_first, s.energy_last, (double)s.steps);
  test_engine_close(&e);
}

static void threads_leave_no_trace(void **state) {
  (void)state;
  enum { SIDE = 8, N = SIDE * SIDE * SIDE };
  double F[2][3 * N];
  for (int many = 0; many < 2; many++) {
    test_engine e;
    hk_instance *force;
    test_engine_open(&e);
    e.options.threads = many ? 3 : 1;
    fill(&e, SIDE, 0.3, false);
    hk_plugin_spec *spec = liquid(&e, "tait", true);
    hk_view view = view_of(&e, spec, &force);
    force_evaluate(force, &view, F[many]);
    test_engine_close(&e);
  }
  assert_memory_equal(F[0], F[1], sizeof *F);
}

/* ---- waves and steps ---- */

/* 1/m: sum of m/rho0 W' sin(k d) over the lattice, along x. */
static double gain_of(double k) {
  double gain = 0, h = 1e-6 * dx;
  for (int i = 0; i < 343; i++) {
    double x = dx * (i % 7 - 3), r = dx * sqrt(pow(i % 7 - 3, 2) + pow(i / 7 % 7 - 3, 2) + pow(i / 49 - 3, 2));
    if (r > 0) gain += dx * dx * dx * peak() * (shape(r + h) - shape(r - h)) / (2 * h) * x / r * sin(k * x);
  }
  return fabs(gain);
}

/* A plane wave u sin(k x) of a lattice is pushed back by m w^2 u, w = c gain. w of the longest is c k but for the width
 * of the kernel, a third of a wave here, which takes 15 %. The bound of the stiffness is above m w^2 of every wave, and
 * below twice that of the fastest one. */
static void waves_have_the_frequency_of_the_lattice_sum(void **state) {
  (void)state;
  enum { SIDE = 8, N = SIDE * SIDE * SIDE };
  test_engine e;
  hk_instance *force;
  static double F[3 * N], block[N][6];
  double k = 2 * acos(-1) / (SIDE * dx), u = 1e-7 * dx, m = rho0 * dx * dx * dx, most = 0;
  assert_true(fabs(gain_of(k) / k - 1) < 0.2);
  for (int q = 1; q <= 40; q++) most = fmax(most, gain_of(acos(-1) / dx * q / 40));
  test_engine_open(&e);
  fill(&e, SIDE, 0, false);
  for (size_t i = 0; i < N; i++) e.scene->particles.position[3 * i] += u * sin(k * dx * (double)(i % SIDE));
  repeat(&e, SIDE * dx);
  hk_plugin_spec *spec = liquid(&e, "quadratic", false);
  hk_view view = view_of(&e, spec, &force);
  force_evaluate(force, &view, F);
  close_to(F[3 * 2], -m * pow(c * gain_of(k), 2) * u, 1e-5); /* at a quarter of the wave; u/dx, differences of shape */
  memset(block, 0, sizeof block);
  hk_force_of(force->plugin)->bounds.stiffness_bound(force->self, &view, HK_STIFFNESS_WHOLE, block);
  assert_true(block[0][0] > m * pow(c * most, 2) && block[0][0] < 2 * m * pow(c * most, 2));
  test_engine_close(&e);
}

/* A cube of 27 falls with 1 m/s on a single layer of pinned particles, and comes off again: no particle passes it, and
 * what it had of energy it has, but for what a step of half the stable one leaves. */
static void one_layer_of_walls_holds_what_falls(void **state) {
  (void)state;
  const double none[3] = {0};
  test_engine e;
  hk_summary s;
  double lowest = 1;
  test_engine_open(&e);
  for (int i = 0; i < 27; i++) {
    uint32_t id = test_particle(&e, dx * (i % 3), dx * (i / 3 % 3), dx * (2 + i / 9), rho0 * dx * dx * dx);
    e.scene->particles.velocity[3 * (id - 1) + 2] = -1;
  }
  for (int i = 0; i < 121; i++)
    test_pin(&e, HK_PIN_FIXED, test_particle(&e, dx * (i % 11 - 4), dx * (i / 11 - 4), 0, 1), none);
  liquid(&e, "tait", true);
  e.options.dt = 5e-4;
  e.scene->fps = 200;
  e.scene->duration = 0.4;
  test_run(&e);
  for (int k = 1; k <= 80; k++) {
    test_advance(&e, k / 200.);
    for (uint32_t id = 1; id <= 27; id++) lowest = fmin(lowest, test_position(&e, id)[2]);
  }
  hk_run_summary(e.run, &s);
  if (!(lowest > 0.2 * dx && fabs(s.energy_last / s.energy_first - 1) < 1e-2))
    fail_msg("down to %g m; %g J of %g J are left", lowest, s.energy_last, s.energy_first);
  test_engine_close(&e);
}

/* Shaken, at the step that hooke chooses: the energy swings by a part that falls with the step, and does not grow. */
static void the_step_foretold_is_stable(void **state) {
  (void)state;
  hk_summary s;
  test_engine e;
  test_engine_open(&e);
  fill(&e, 6, 0.2, false);
  repeat(&e, 6 * dx);
  liquid(&e, "tait", true);
  e.options.dt = NAN;
  e.scene->fps = 10;
  e.scene->duration = 0.5;
  test_run(&e);
  test_advance(&e, 0.5);
  hk_run_summary(e.run, &s);
  if (!(s.dt_max > 0.1 * kernel * dx / c && fabs(s.energy_last - s.energy_first) < 0.05 * s.energy_first))
    fail_msg("%g J become %g in steps of %g s", s.energy_first, s.energy_last, s.dt_max);
  test_engine_close(&e);
}

/* ---- what it says ---- */

static const char *const head =
    "local s = hooke.scene { duration = 0.1, fps = 10, dt = 1e-3, integrator = 'leapfrog' }\n";

static const char *scene_of(const char *lines) {
  static char script[2048];
  snprintf(script, sizeof script, "%s%s\nreturn s\n", head, lines);
  return script;
}

static void warned(const char *lines, const char *wanted) {
  test_result r;
  char call[512];
  snprintf(call, sizeof call, "run %s", test_write("warned.lua", scene_of(lines)));
  test_hooke(&r, NULL, call);
  if (r.code != 0 || !strstr(r.err, wanted)) fail_msg("%s\ninstead of: %s", r.err, wanted);
}

static void what_does_not_suit_is_said(void **state) {
  (void)state;
  test_refused(scene_of("s:particles { positions = { { 0, 0, 0 }, { 0, 0, 0 } }, mass = 1 }\n"
                        "s:force('sph', { c = 10, spacing = 0.1 })"),
               "", 2, "particles 1 and 2 are in the same place at t = 0 s, where pressure has no direction: put them");
  test_refused(scene_of("s:particle { position = { 0, 0, 0 } } s:force('sph', { c = 10, spacing = 0 })"), "", 1,
               "spacing");
  warned("s:particles { positions = { { 0, 0, 0 }, { 1, 0, 0 } }, mass = 3 } s:force('sph', { c = 10, spacing = 0.1 })",
         "particles of this mass are 0.144 m apart at the density of 1000 kg/m^3, not 0.1 m");
  warned("s:particle { position = { 0, 0, 0 }, mass = 1 } s:force('sph', { c = 10, spacing = 0.1, dimensions = 2 })",
         "a liquid that nothing keeps in its plane buckles");
  warned("for k = 0, 19 do s:particle { position = { 0.01 * k, 0, 0 }, mass = 1 } end\n"
         "s:force('sph', { c = 0.1, spacing = 0.1 })",
         "more than a liquid is: a speed of sound of ");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_and_force_by_hand),
      cmocka_unit_test(a_liquid_on_its_lattice_is_at_rest),
      cmocka_unit_test(force_and_energy_belong_together),
      cmocka_unit_test(blocks_are_the_stiffness),
      cmocka_unit_test(implicit_methods_step_over_sound),
      cmocka_unit_test(threads_leave_no_trace),
      cmocka_unit_test(waves_have_the_frequency_of_the_lattice_sum),
      cmocka_unit_test(one_layer_of_walls_holds_what_falls),
      cmocka_unit_test(the_step_foretold_is_stable),
      cmocka_unit_test(what_does_not_suit_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
