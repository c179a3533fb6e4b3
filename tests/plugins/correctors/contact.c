/* The correctors of contact against closed forms and invariants: impacts of every kind of pair, slopes, falls, sheets
 * that fall on each other and on a ball, fast impacts.
 *
 * An impact without other forces changes velocities by impulses along a line: momentum is kept to the rounding of a few
 * additions of numbers of order 1, 1e-15 each, and the speed along the normal is turned by e to the same. 1e-12 covers
 * both with room. Positions before and after differ from the law's by nothing else either, as paths are straight. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, exact = 1e-12, radius = 0.01;

static void open_world(test_engine *e, double h) {
  test_engine_open(e);
  e->options.integrator = "leapfrog";
  e->options.dt = h;
  e->scene->duration = 1000;
  e->scene->fps = fmax(1, fmin(50, floor(1 / h)));
}

static uint32_t put(test_engine *e, const double x[3], const double v[3], double mass) {
  uint32_t id = test_particle(e, x[0], x[1], x[2], mass);
  if (v) memcpy(e->scene->particles.velocity + 3 * (size_t)(id - 1), v, 3 * sizeof *v);
  return id;
}

static hk_plugin_spec *add_contact(test_engine *e, const char *name, double restitution, double friction) {
  hk_plugin_spec *spec = test_plugin(e, HK_CORRECTOR, name);
  test_number(e, spec, "restitution", restitution);
  test_number(e, spec, "friction", friction);
  test_number(e, spec, "radius", radius);
  test_number(e, spec, "thickness", 2 * radius);
  return spec;
}

static void fall(test_engine *e) { test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -g); }

static void add_triangle(test_engine *e, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t triangle[1][3] = {{a, b, c}};
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, triangle, &e->error), HK_OK);
}

static void add_edge(test_engine *e, uint32_t a, uint32_t b) {
  const uint32_t edge[1][2] = {{a, b}};
  assert_int_equal(hk_scene_add_edges(e->scene, 1, edge, &e->error), HK_OK);
}

static hk_summary summary_of(test_engine *e) {
  hk_summary s;
  hk_run_summary(e->run, &s);
  return s;
}

typedef struct momenta {
  double p[3], l[3], kinetic;
} momenta;

static momenta momenta_of(test_engine *e) {
  momenta m = {0};
  for (uint32_t id = 1; id <= e->scene->particles.n; id++) {
    const double *x = test_position(e, id), *v = test_velocity(e, id);
    double mass = e->scene->particles.mass[id - 1];
    for (int c = 0; c < 3; c++) {
      int a = (c + 1) % 3, b = (c + 2) % 3;
      m.p[c] += mass * v[c];
      m.l[c] += mass * (x[a] * v[b] - x[b] * v[a]);
      m.kinetic += mass * v[c] * v[c] / 2;
    }
  }
  return m;
}

static void assert_kept(const momenta *a, const momenta *b, double turning) {
  for (int c = 0; c < 3; c++) {
    if (!(fabs(a->p[c] - b->p[c]) < exact)) fail_msg("momentum %d: %g, was %g", c, b->p[c], a->p[c]);
    if (!(fabs(a->l[c] - b->l[c]) < turning)) fail_msg("angular momentum %d: off by %g", c, b->l[c] - a->l[c]);
  }
}

/* ---- single impacts ---- */

static void two_particles(test_engine *e) {
  put(e, (double[]){-0.3, 0, 0}, (double[]){1.3, 0, 0}, 1);
  put(e, (double[]){0.4, 0, 0}, (double[]){-1, 0, 0}, 2);
}

static void particle_and_triangle(test_engine *e) {
  put(e, (double[]){0.1, 0.05, 0.3}, (double[]){0, 0, -1}, 1);
  put(e, (double[]){-1, -1, 0}, (double[]){0, 0, 0.5}, 2);
  put(e, (double[]){1, -1, 0}, (double[]){0, 0, 0.5}, 3);
  put(e, (double[]){0, 1, 0}, (double[]){0, 0, 0.5}, 1);
  add_triangle(e, 2, 3, 4);
}

static void two_edges(test_engine *e) {
  put(e, (double[]){-1, 0.1, 0.3}, (double[]){0, 0, -1}, 1);
  put(e, (double[]){1, 0.2, 0.3}, (double[]){0, 0, -1}, 3);
  put(e, (double[]){0, -1, 0}, (double[]){0, 0, 0.5}, 2);
  put(e, (double[]){0.3, 1, 0}, (double[]){0, 0, 0.5}, 1);
  add_edge(e, 1, 2);
  add_edge(e, 3, 4);
}

/* Along its normal the pair is two bodies of the masses 1/sum w^2/m, which keep (1 - e^2) of the energy of approach.
 * Without a bounce they stay together and turn, and the contact's normal with them: by 0.01 in a step, of which the
 * square is what each step may be off. */
static void assert_impact(void (*build)(test_engine *), double reduced_mass, double approach, double e) {
  test_engine t;
  double turning = e > 0 ? exact : 1e-4;
  open_world(&t, 0.01);
  build(&t);
  add_contact(&t, "contact", e, 0);
  test_run(&t);
  momenta before = momenta_of(&t);
  test_advance(&t, 1);
  momenta after = momenta_of(&t);
  hk_summary s = summary_of(&t);
  assert_kept(&before, &after, turning);
  double lost = reduced_mass * approach * approach / 2 * (1 - e * e), off = before.kinetic - after.kinetic - lost;
  if (!(fabs(off) < turning)) fail_msg("e = %g: lost %g J, expected %g", e, before.kinetic - after.kinetic, lost);
  assert_true(fabs(s.impact_energy - lost) < turning);
  if (e > 0) assert_true(fabs(s.impulse - reduced_mass * approach * (1 + e)) < exact);
  assert_true(s.intersections == 0 && fabs(s.energy_drift) < exact);
  test_engine_close(&t);
}

/* 1/sum w^2/m at the place of contact. */
static double mass_of_triangle_pair(void) {
  double c = (0.05 + 1) / 2, b = (0.1 + 1 - c) / 2, a = 1 - b - c;
  return 1 / (1 + a * a / 2 + b * b / 3 + c * c);
}

static double mass_of_edge_pair(void) {
  /* (-1 + 2 s, 0.1 + 0.1 s) = (0.3 t, -1 + 2 t) */
  double t = 1.15 / 1.985, s = (1 + 0.3 * t) / 2;
  return 1 / ((1 - s) * (1 - s) + s * s / 3 + (1 - t) * (1 - t) / 2 + t * t);
}

static void impacts_keep_momentum_and_turn_the_speed(void **state) {
  (void)state;
  for (double e = 0; e <= 1; e += 0.25) {
    assert_impact(two_particles, 2.0 / 3, 2.3, e);
    assert_impact(particle_and_triangle, mass_of_triangle_pair(), 1.5, e);
    assert_impact(two_edges, mass_of_edge_pair(), 1.5, e);
  }
}

/* ---- on a fixed floor ---- */

static void add_floor(test_engine *e, double slope) {
  uint32_t id[3] = {put(e, (double[]){-50, -50, -50 * slope}, NULL, 1),
                    put(e, (double[]){50, -50, 50 * slope}, NULL, 1), put(e, (double[]){0, 80, 0}, NULL, 1)};
  for (int k = 0; k < 3; k++) test_pin(e, HK_PIN_FIXED, id[k], NULL);
  add_triangle(e, id[0], id[1], id[2]);
}

/* Bouncing for 3 s of a ball dropped from 1 m with e = 0.8, and its height and speed then: five bounces. */
static double bounced(double h) {
  test_engine t;
  open_world(&t, h);
  uint32_t ball = put(&t, (double[]){0, 0, 1 + radius}, NULL, 2);
  add_floor(&t, 0);
  fall(&t);
  add_contact(&t, "contact", 0.8, 0);
  test_run(&t);
  test_advance(&t, 2.5);
  double speed = sqrt(2 * g), at = sqrt(2 / g);
  for (speed *= 0.8; at + 2 * speed / g < 2.5; speed *= 0.8) at += 2 * speed / g;
  double left = 2.5 - at, z = speed * left - g * left * left / 2;
  double off = fabs(test_position(&t, ball)[2] - radius - z) + fabs(test_velocity(&t, ball)[2] - speed + g * left);
  assert_true(fabs(summary_of(&t).energy_drift) < 1e-3);
  test_engine_close(&t);
  return off;
}

/* The velocity and the place after an impact are those of the parabola of the step, on which the instant of impact is
 * found: nothing is left but rounding, of which each bounce makes 2 e times as much. */
static void bounces_on_a_floor_are_exact(void **state) {
  (void)state;
  double coarse = bounced(1.0 / 60), fine = bounced(1.0 / 480);
  print_message("five bounces off by %.1e, %.1e (h = 1/60, 1/480 s)\n", coarse, fine);
  assert_true(coarse < 1e-11 && fine < 1e-11);
}

/* What slid down a slope of tan = 1/2 in 1 s; a = g (sin - mu cos). */
static double slid(bool sheet, double friction, double h) {
  test_engine t;
  open_world(&t, h);
  double n[2] = {-0.5 / sqrt(1.25), 1 / sqrt(1.25)};
  uint32_t id = put(&t, (double[]){radius * n[0], 0, radius * n[1]}, NULL, 2);
  if (sheet) {
    uint32_t b = put(&t, (double[]){0.2 + radius * n[0], 0, 0.1 + radius * n[1]}, NULL, 2),
             c = put(&t, (double[]){0.1 + radius * n[0], 0.2, 0.05 + radius * n[1]}, NULL, 2);
    add_triangle(&t, id, b, c);
  }
  add_floor(&t, 0.5);
  fall(&t);
  add_contact(&t, "contact", 0, friction);
  test_run(&t);
  test_advance(&t, 1);
  const double *x = test_position(&t, id);
  double along = hypot(x[0] - radius * n[0], x[2] - radius * n[1]);
  assert_true(fabs(n[0] * x[0] + n[1] * x[2] - radius) < 1e-9);
  hk_summary s = summary_of(&t);
  if (s.kinetic_max > 1e-6) assert_true(fabs(s.energy_drift) < 0.01);
  test_engine_close(&t);
  return along;
}

/* Rounding of the gap, some 1e-18 m, opens it for up to 1e-6 of a step, in which it slides by as much of g h^2/2. */
static void friction_on_a_slope_brackets_its_tangent(void **state) {
  (void)state;
  for (int sheet = 0; sheet < 2; sheet++) {
    double a = g * (1 - 2 * 0.49) / sqrt(5), way = slid(sheet, 0.49, 1e-3), stuck = slid(sheet, 0.501, 1e-3);
    print_message("%s: mu 0.49 slid %.6f m (%.6f), mu 0.501 slid %.1e m\n", sheet ? "sheet" : "grain", way, a / 2,
                  stuck);
    assert_true(fabs(way - a / 2) < 0.01 * a / 2);
    assert_true(stuck < 1e-8);
  }
}

/* ---- sheets ---- */

enum { SIDE = 16 };

/* A sheet of springs, `size` m wide, with its lower left corner at x; returns its first id. */
static uint32_t add_sheet(test_engine *e, const double at[3], double size, const double v[3]) {
  enum { EDGES = 2 * SIDE * (SIDE - 1) + (SIDE - 1) * (SIDE - 1) };
  uint32_t edge[EDGES][2], first = 0;
  size_t edges = 0;
  for (int k = 0; k < SIDE * SIDE; k++) {
    double x[3] = {at[0] + size * (k % SIDE) / (SIDE - 1), at[1] + size * (k / SIDE) / (SIDE - 1), at[2]};
    uint32_t id = put(e, x, v, 0.2 / (SIDE * SIDE));
    first = first ? first : id;
  }
  for (uint32_t k = 0; k < SIDE * SIDE; k++) {
    uint32_t a = first + k;
    bool right = k % SIDE + 1 < SIDE, up = k / SIDE + 1 < SIDE;
    if (right) memcpy(edge[edges++], (uint32_t[]){a, a + 1}, sizeof *edge);
    if (up) memcpy(edge[edges++], (uint32_t[]){a, a + SIDE}, sizeof *edge);
    if (!right || !up) continue;
    memcpy(edge[edges++], (uint32_t[]){a, a + SIDE + 1}, sizeof *edge);
    add_triangle(e, a, a + 1, a + SIDE + 1);
    add_triangle(e, a, a + SIDE + 1, a + SIDE);
  }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "damping", 0.02);
  return first;
}

/* A pinned octahedron. */
static void add_rock(test_engine *e, double size) {
  uint32_t id[6];
  for (int k = 0; k < 6; k++) {
    double x[3] = {0.013, 0.007, 0};
    x[k / 2] += k % 2 ? size : -size;
    id[k] = put(e, x, NULL, 1);
    test_pin(e, HK_PIN_FIXED, id[k], NULL);
  }
  for (int k = 0; k < 8; k++) add_triangle(e, id[k & 1], id[2 + (k >> 1 & 1)], id[4 + (k >> 2 & 1)]);
}

/* A particle that comes to 0.1 mm from a triangle in a step of 10 ms, and would go 2.9 mm into it in the next one, of 3
 * ms: the way of the long step has used up what the pair was known to be apart. */
static void a_short_step_after_a_long_one_is_examined(void **state) {
  test_engine t;
  uint32_t id[3];
  (void)state;
  open_world(&t, 0.01);
  t.scene->fps = 1;
  for (int k = 0; k < 3; k++) {
    id[k] = put(&t, (double[]){5 * cos(2.1 * k), 5 * sin(2.1 * k), 0}, NULL, 1);
    test_pin(&t, HK_PIN_FIXED, id[k], NULL);
  }
  add_triangle(&t, id[0], id[1], id[2]);
  uint32_t ball = put(&t, (double[]){0, 0, radius + 0.0101}, (double[]){0, 0, -1}, 0.2);
  add_contact(&t, "contact", 1, 0);
  test_run(&t);
  test_advance(&t, 0.01);
  test_advance(&t, 0.013);
  assert_true(fabs(test_position(&t, ball)[2] - radius - 0.0029) < exact);
  assert_true(fabs(test_velocity(&t, ball)[2] - 1) < exact);
  test_engine_close(&t);
}

/* A sheet falls on a rock and over it onto itself. Frames are steps: intersections are counted at each. */
static void drape(test_engine *e, const char *corrector, int threads) {
  open_world(e, 1e-3);
  e->scene->fps = 1000;
  e->scene->threads = threads;
  add_sheet(e, (double[]){-0.5, -0.5, 0.32}, 1, NULL);
  add_rock(e, 0.25);
  fall(e);
  add_contact(e, corrector, 0, 0.3);
  test_run(e);
}

static void draped_sheets_never_intersect(void **state) {
  (void)state;
  const char *names[] = {"contact", "impact_zones"};
  for (int k = 0; k < 2; k++) {
    test_engine t;
    drape(&t, names[k], 2);
    test_advance(&t, 1);
    hk_summary s = summary_of(&t);
    print_message("%s: %.0f frames, %.0f intersections, least gap %.1e m, energy drift %.1e\n", names[k],
                  s.contact_frames, s.intersections, s.closest, s.energy_drift);
    assert_true(s.contact_frames > 1000 && s.intersections == 0);
    /* One hundredth of the thickness is what a step may leave; the repulsion of the other takes a tenth of an overlap
     * a step. */
    assert_true(s.closest > (k == 0 ? -0.05 : -1) * 2 * radius);
    test_engine_close(&t);
  }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  test_engine t[3];
  for (int k = 0; k < 3; k++) {
    drape(&t[k], "contact", k + 1);
    test_advance(&t[k], 0.45);
  }
  for (int k = 1; k < 3; k++)
    assert_memory_equal(t[0].run->state.X, t[k].run->state.X, t[0].run->state.size * sizeof(double));
  for (int k = 0; k < 3; k++) test_engine_close(&t[k]);
}

static void resumed_runs_go_on_bit_by_bit(void **state) {
  (void)state;
  const char *names[] = {"contact", "impact_zones"};
  for (int k = 0; k < 2; k++) {
    test_engine a, b;
    char path[512];
    snprintf(path, sizeof path, "%s/drape.checkpoint", test_folder());
    drape(&a, names[k], 1);
    test_advance(&a, 0.35);
    assert_int_equal(hk_run_save(a.run, path, &a.error), HK_OK);
    open_world(&b, 1e-3);
    test_engine_close(&b);
    open_world(&b, 1e-3);
    b.scene->fps = 1000;
    add_sheet(&b, (double[]){-0.5, -0.5, 0.32}, 1, NULL);
    add_rock(&b, 0.25);
    fall(&b);
    add_contact(&b, names[k], 0, 0.3);
    b.scene->start_file = strdup(path);
    test_run(&b);
    test_advance(&a, 0.45);
    test_advance(&b, 0.45);
    assert_memory_equal(a.run->state.X, b.run->state.X, a.run->state.size * sizeof(double));
    assert_true(summary_of(&a).impulse == summary_of(&b).impulse);
    test_engine_close(&a);
    test_engine_close(&b);
  }
}

/* 100 m/s in frames of 1/30 s with steps as long: 3.3 m a step, through a layer of 2 cm. */
static void fast_impacts_do_not_pass(void **state) {
  (void)state;
  const char *names[] = {"contact", "impact_zones"};
  for (int k = 0; k < 2; k++)
    for (int m = 0; m < 2; m++) {
      test_engine t;
      open_world(&t, 1.0 / 30);
      t.options.integrator = m ? "symplectic_euler" : "leapfrog";
      uint32_t ball = put(&t, (double[]){0.3, 0.2, 7}, (double[]){0, 0, -100}, 1);
      add_floor(&t, 0);
      uint32_t sheet[3];
      for (int c = 0; c < 3; c++)
        sheet[c] = put(&t, (double[]){cos(2.1 * c), sin(2.1 * c), 9}, (double[]){0, 0, -100}, 1);
      add_triangle(&t, sheet[0], sheet[1], sheet[2]);
      add_contact(&t, names[k], 0, 0);
      test_run(&t);
      test_advance(&t, 1);
      assert_true(test_position(&t, ball)[2] > 0);
      for (int c = 0; c < 3; c++) assert_true(test_position(&t, sheet[c])[2] > 0);
      assert_true(summary_of(&t).intersections == 0);
      test_engine_close(&t);
    }
}

static void add_plate(test_engine *e, double z) {
  uint32_t id[4];
  for (int k = 0; k < 4; k++) {
    id[k] = put(e, (double[]){k & 1 ? 1 : -1, k & 2 ? 1 : -1, z}, NULL, 1);
    test_pin(e, HK_PIN_FIXED, id[k], NULL);
  }
  add_triangle(e, id[0], id[1], id[2]);
  add_triangle(e, id[1], id[3], id[2]);
}

/* Steps of 3.3 m through a plate of two triangles end far behind it, where the nearest point of either is on its rim.
 * The path is straight there and straight back. Rounding: of places of metres, in 3 steps. */
static void fast_particles_leave_as_they_came(void **state) {
  (void)state;
  const double v = 100, end = 0.1;
  for (int k = 0; k < 40; k++) {
    test_engine t;
    double x = 0.8 * sin(k + 1.0), y = 0.8 * cos(2.3 * k + 1), z0 = 0.3 + 0.25 * k, e = k % 3 / 2.0;
    open_world(&t, 1.0 / 30);
    uint32_t ball = put(&t, (double[]){x, y, z0}, (double[]){0, 0, -v}, 1);
    add_plate(&t, 0);
    add_contact(&t, "contact", e, 0);
    test_run(&t);
    test_advance(&t, end);
    double z = z0 - v * end > radius ? z0 - v * end : radius + e * (v * end - z0 + radius);
    const double *at = test_position(&t, ball);
    double off = fabs(at[0] - x) + fabs(at[1] - y) + fabs(at[2] - z);
    if (!(off < exact)) fail_msg("(%g, %g, %g), e = %g: off by %g m", x, y, z0, e, off);
    test_engine_close(&t);
  }
}

/* A particle of the speed v between two plates with 8 cm to go, over 0.2 s in steps of 1/30 s. */
static void open_thin_gap(test_engine *t, double v, double e) {
  open_world(t, 1.0 / 30);
  put(t, (double[]){0.1, 0.2, 0.05}, (double[]){0, 0, -v}, 1);
  add_plate(t, 0);
  add_plate(t, 0.1);
  add_contact(t, "contact", e, 0);
  test_run(t);
}

/* The height after a time and some bounces, of which each leaves e of the speed. */
static double height_in_gap(double v, double e, double time) {
  double z = 0.05, side = -1;
  for (;;) {
    double end = side < 0 ? radius : 0.1 - radius, needed = fabs(end - z) / v;
    if (needed > time) return z + side * v * time;
    time -= needed, v *= e, z = end, side = -side;
  }
}

/* Up to 42 bounces a step: the step is divided until each can be told. Every bounce adds to the error of the time the
 * rounding of one, and 250 of them stay far below 1e-9 m. */
static void no_bounce_in_a_thin_gap_is_lost(void **state) {
  (void)state;
  for (int k = 0; k < 12; k++) {
    test_engine t;
    double v = 100 - 8.1 * k, e = k % 2 ? 0.95 : 1, end = 0.2;
    open_thin_gap(&t, v, e);
    test_advance(&t, end);
    const double *at = test_position(&t, 1);
    double off = fabs(at[0] - 0.1) + fabs(at[1] - 0.2) + fabs(at[2] - height_in_gap(v, e, end));
    if (!(off < 1e-9)) fail_msg("v = %g, e = %g: off by %g m", v, e, off);
    test_engine_close(&t);
  }
}

/* 400,000 bounces a step are more than twelve halvings can part: the run ends and says so. */
static void bounces_that_no_step_can_tell_end_the_run(void **state) {
  (void)state;
  test_engine t;
  open_thin_gap(&t, 1e6, 1);
  assert_int_equal(hk_run_advance(t.run, 0.2, &t.error), HK_NOT_CONVERGED);
  assert_non_null(strstr(t.error.text, "contact takes every step back"));
  test_engine_close(&t);
}

/* Surfaces that start nearer than their thickness are told once; those that start just so far apart are not. */
static void a_start_nearer_than_the_thickness_is_told(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine t;
    open_world(&t, 0.01);
    put(&t, (double[]){0.1, 0.2, k ? radius : 0.004}, NULL, 1);
    put(&t, (double[]){0.5, -0.2, k ? -radius : -0.007}, NULL, 1);
    put(&t, (double[]){0.5, -0.2 + 2 * radius, k ? -radius : -0.008}, NULL, 1);
    add_plate(&t, 0);
    add_contact(&t, "contact", 0, 0);
    test_run(&t);
    test_advance(&t, 0.1);
    assert_int_equal(t.run->warnings.count, k ? 0 : 1);
    if (k == 0)
      assert_non_null(strstr(t.run->warnings.text[0], "3 pairs start nearer than their thickness, by up to 0.006 m "
                                                      "(particle 1 and triangle 5 7 6)"));
    test_engine_close(&t);
  }
}

/* Grains are born above a floor, fall, lie, and die; those that lie stay where they are. */
static void births_and_deaths_leave_the_rest_alone(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, 2e-3);
  add_floor(&t, 0);
  fall(&t);
  add_contact(&t, "contact", 0, 0.5);
  hk_plugin_spec *emitter = test_plugin(&t, HK_SOURCE, "emitter");
  test_vector(&t, emitter, "position", 0, 0, 0.3);
  test_number(&t, emitter, "rate", 20);
  test_number(&t, emitter, "lifetime", 1);
  test_number(&t, emitter, "mass", 0.1);
  test_run(&t);
  test_advance(&t, 2.5);
  const hk_view *view = hk_run_view(t.run);
  assert_true(view->n > 15);
  for (size_t i = 3; i < view->n; i++) assert_true(view->x[3 * i + 2] > radius * 0.99);
  assert_true(summary_of(&t).intersections == 0);
  test_engine_close(&t);
}

/* Five sheets lie on each other: nothing moves, and contact adds no energy. */
static void a_stack_at_rest_stays(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, 1e-3);
  add_floor(&t, 0);
  for (int k = 0; k < 3; k++) add_sheet(&t, (double[]){0, 0, (2 * k + 1) * radius}, 1, NULL);
  fall(&t);
  add_contact(&t, "contact", 0, 0.3);
  test_run(&t);
  test_advance(&t, 0.05);
  hk_summary s = summary_of(&t);
  momenta m = momenta_of(&t);
  print_message("stack: kinetic %.1e J, least gap %.1e m, drift %.1e\n", m.kinetic, s.closest, s.energy_drift);
  assert_true(m.kinetic < 1e-6 && s.intersections == 0);
  test_engine_close(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(impacts_keep_momentum_and_turn_the_speed),
      cmocka_unit_test(bounces_on_a_floor_are_exact),
      cmocka_unit_test(friction_on_a_slope_brackets_its_tangent),
      cmocka_unit_test(fast_impacts_do_not_pass),
      cmocka_unit_test(fast_particles_leave_as_they_came),
      cmocka_unit_test(no_bounce_in_a_thin_gap_is_lost),
      cmocka_unit_test(bounces_that_no_step_can_tell_end_the_run),
      cmocka_unit_test(a_start_nearer_than_the_thickness_is_told),
      cmocka_unit_test(births_and_deaths_leave_the_rest_alone),
      cmocka_unit_test(a_stack_at_rest_stays),
      cmocka_unit_test(a_short_step_after_a_long_one_is_examined),
      cmocka_unit_test(draped_sheets_never_intersect),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(resumed_runs_go_on_bit_by_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
