/* Strain limiting: one sweep against a plain one of the same rule to the last bit, chains and sheets against their
 * limits, momenta, pins of all kinds, and the motion that it converges to.
 *
 * Rounding: a length of some edges of 1 m, from coordinates of a few m, is known to some 1e-15 m; 1e-13 covers it, and
 * the sums of some hundred moves. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double exact = 1e-13;

static uint64_t bits = 7;

/* -1 to 1. */
static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

/* ---- a corrector alone, on positions and velocities of the test's ---- */

enum { MOST = 600, EDGES = 4000 };

typedef struct bench {
  test_engine e;
  hk_plugin_spec *spec;
  uint32_t edge[EDGES][2]; /* ids */
  size_t n, edges;
  double x[3 * MOST], v[3 * MOST], mass[MOST], rest[EDGES];
} bench;

static double length_of(const bench *b, size_t e) {
  const double *p = b->x + 3 * (b->edge[e][0] - 1), *q = b->x + 3 * (b->edge[e][1] - 1);
  return sqrt(pow(q[0] - p[0], 2) + pow(q[1] - p[1], 2) + pow(q[2] - p[2], 2));
}

static void open_bench(bench *b) {
  memset(b, 0, sizeof *b);
  test_engine_open(&b->e);
  b->e.options.integrator = "leapfrog";
  b->e.options.dt = 1e-3;
}

static void particle(bench *b, double x, double y, double z, double mass) {
  test_particle(&b->e, x, y, z, mass);
  b->mass[b->n] = mass;
  memcpy(b->x + 3 * b->n++, (double[]){x, y, z}, 3 * sizeof(double));
}

static void join(bench *b, size_t i, size_t j) {
  b->edge[b->edges][0] = (uint32_t)i + 1;
  b->edge[b->edges++][1] = (uint32_t)j + 1;
}

/* Rest lengths are those of the particles as they are now. */
static void limit(bench *b, double tau, const char *order) {
  b->spec = test_plugin(&b->e, HK_CORRECTOR, "strain_limit");
  test_edges(&b->e, b->spec, (const uint32_t(*)[2])b->edge, b->edges);
  test_number(&b->e, b->spec, "limit", tau);
  test_number(&b->e, b->spec, "tolerance", 0);
  test_text(&b->e, b->spec, "order", order);
  for (size_t k = 0; k < b->edges; k++) b->rest[k] = length_of(b, k);
}

static void shake(bench *b, double by) {
  for (size_t k = 0; k < 3 * b->n; k++) b->x[k] += by * noise(), b->v[k] = noise();
}

static bool correct(bench *b) {
  hk_instance *c = test_instance(&b->e, b->spec);
  hk_view view = *hk_run_view(b->e.run);
  hk_correction correction = {.h = 1e-3, .x = b->x, .v = b->v};
  view.host = &c->host;
  view.x = b->x;
  view.v = b->v;
  assert_int_equal(c->plugin->corrector->correct(c->self, &view, &correction), HK_OK);
  return correction.changed;
}

/* The largest strain. */
static double strain(const bench *b) {
  double most = -1;
  for (size_t k = 0; k < b->edges; k++) most = fmax(most, length_of(b, k) / b->rest[k] - 1);
  return most;
}

static void make_chain(bench *b, size_t n) {
  for (size_t i = 0; i < n; i++) {
    particle(b, (double)i, 0, 0, pow(10, noise()));
    if (i) join(b, i - 1, i);
  }
}

static void make_grid(bench *b, size_t N) {
  static const size_t step[6][2] = {{1, 0}, {0, 1}, {1, 1}, {0, 0}, {2, 0}, {0, 2}};
  for (size_t i = 0; i < N * N; i++) particle(b, (double)(i % N), (double)(i / N), 0, pow(10, noise()));
  for (int s = 0; s < 6; s++)
    for (size_t j = 0; j + step[s][1] < N; j++)
      for (size_t i = 0; i + step[s][0] < N; i++)
        if (s == 3 && (i == 0 || j + 1 == N)) /* the other diagonal */
          continue;
        else if (s == 3)
          join(b, j * N + i, (j + 1) * N + i - 1);
        else
          join(b, j * N + i, (j + step[s][1]) * N + i + step[s][0]);
}

/* ---- one sweep ---- */

/* A tree hung at one particle, swept from the pin outwards. The edges are given from the far end. */
static void a_chain_swept_outwards_is_within_its_limits_at_once(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  for (size_t i = 0; i < 40; i++) particle(&b, (double)i, 0.1 * noise(), 0, pow(10, noise()));
  for (size_t i = 39; i > 0; i--) join(&b, i, i > 20 ? i - 2 : i - 1); /* two branches from the 20th on */
  limit(&b, 0.1, "outwards");
  test_number(&b.e, b.spec, "sweeps", 1);
  test_pin(&b.e, HK_PIN_FIXED, 1, NULL);
  test_run(&b.e);
  shake(&b, 2);
  double pinned[3];
  memcpy(pinned, b.x, sizeof pinned);
  assert_true(strain(&b) > 1);
  assert_true(correct(&b));
  if (!(strain(&b) <= 0.1 + exact)) fail_msg("strain %.17g after one sweep", strain(&b));
  assert_memory_equal(pinned, b.x, sizeof pinned);
  assert_false(correct(&b));
  test_engine_close(&b.e);
}

/* The rule as it stands: every edge in turn. The same operations, so the same bits. */
static void plain_sweep(bench *b, double tau) {
  for (size_t k = 0; k < b->edges; k++) {
    size_t i = b->edge[k][0] - 1, j = b->edge[k][1] - 1;
    double d[3], most = (1 + tau) * b->rest[k], l2;
    for (int c = 0; c < 3; c++) d[c] = b->x[3 * j + c] - b->x[3 * i + c];
    l2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (l2 <= most * (1 + 1e-14) * (most * (1 + 1e-14))) continue;
    double l = sqrt(l2), wi = 1 / b->mass[i], wj = 1 / b->mass[j], move = (l - most) / (wi + wj),
           back = (most - l) / (wi + wj);
    for (int c = 0; c < 3; c++) {
      b->x[3 * i + c] += move * wi * (d[c] / l);
      b->x[3 * j + c] += back * wj * (d[c] / l);
    }
  }
}

/* Grids have runs of edges, random nets have none; few of the edges are beyond their limits. */
static void compare_with_plain_sweeps(bench *b) {
  enum { SWEEPS = 5 };
  double start[3 * MOST], plain[3 * MOST];
  limit(b, 0.1, "given");
  test_text(&b->e, b->spec, "velocity", "kept");
  test_number(&b->e, b->spec, "sweeps", SWEEPS);
  b->e.scene->threads = 2;
  test_run(&b->e);
  shake(b, 0.08);
  memcpy(start, b->x, sizeof start);
  for (int k = 0; k < SWEEPS; k++) plain_sweep(b, 0.1);
  memcpy(plain, b->x, sizeof plain);
  memcpy(b->x, start, sizeof start);
  assert_true(correct(b));
  assert_memory_equal(plain, b->x, sizeof plain);
  test_engine_close(&b->e);
}

static void what_is_not_visited_would_not_have_moved(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  make_grid(&b, 20);
  compare_with_plain_sweeps(&b);
  open_bench(&b);
  for (size_t i = 0; i < MOST; i++) particle(&b, 4 * noise(), 4 * noise(), 4 * noise(), pow(10, noise()));
  for (size_t k = 0; k < EDGES; k++) {
    size_t i = (size_t)((noise() + 1) / 2 * MOST), j = (size_t)((noise() + 1) / 2 * (MOST - 1));
    join(&b, i, j < i ? j : j + 1);
  }
  compare_with_plain_sweeps(&b);
}

/* ---- many sweeps ---- */

static void none_is_above_the_limit_in_the_end(void **state) {
  (void)state;
  static const char *const orders[] = {"given", "sorted"};
  for (int k = 0; k < 2; k++) {
    bench b;
    open_bench(&b);
    make_grid(&b, 17);
    limit(&b, 0.1, orders[k]);
    test_number(&b.e, b.spec, "tolerance", 1e-9);
    test_number(&b.e, b.spec, "sweeps", 1e6);
    test_run(&b.e);
    shake(&b, 0.4);
    double before = strain(&b);
    correct(&b);
    print_message("17 x 17, %s: strain %.3g, then %.10g\n", orders[k], before, strain(&b));
    assert_true(before > 0.5 && strain(&b) <= 0.1 + 2e-9);
    assert_false(correct(&b));
    test_engine_close(&b.e);
  }
}

static void lengths_are_limited_below_too(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  make_chain(&b, 30);
  limit(&b, 0.1, "given");
  test_number(&b.e, b.spec, "compression", 0.05);
  test_number(&b.e, b.spec, "sweeps", 1e6);
  test_number(&b.e, b.spec, "tolerance", 1e-9);
  test_run(&b.e);
  shake(&b, 0.4);
  correct(&b);
  for (size_t k = 0; k < b.edges; k++) assert_true(length_of(&b, k) > 0.95 - 1e-8 && length_of(&b, k) < 1.1 + 1e-8);
  test_engine_close(&b.e);
}

/* What is left is a violation, and a warning. */
static void what_is_left_is_said(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  make_grid(&b, 17);
  limit(&b, 0.1, "given");
  test_number(&b.e, b.spec, "sweeps", 1);
  test_run(&b.e);
  shake(&b, 0.4);
  correct(&b);
  hk_instance *c = test_instance(&b.e, b.spec);
  hk_view view = *hk_run_view(b.e.run);
  view.x = b.x;
  double worst = 0;
  for (size_t k = 0; k < b.edges; k++) worst = fmax(worst, length_of(&b, k) - 1.1 * b.rest[k]);
  assert_true(worst > 0.01);
  assert_true(fabs(c->plugin->corrector->violation(c->self, &view) - worst) < exact);
  hk_summary s;
  hk_run_summary(b.e.run, &s);
  assert_int_equal(s.warnings, 1);
  assert_non_null(strstr(s.warning[0], "after 1 sweeps"));
  test_engine_close(&b.e);
}

/* ---- momenta ---- */

static void sums(const bench *b, double centre[3], double momentum[3], double angular[3]) {
  for (int c = 0; c < 3; c++) centre[c] = momentum[c] = angular[c] = 0;
  for (size_t i = 0; i < b->n; i++)
    for (size_t c = 0; c < 3; c++) {
      const double *x = b->x + 3 * i, *v = b->v + 3 * i;
      centre[c] += b->mass[i] * x[c];
      momentum[c] += b->mass[i] * v[c];
      angular[c] += b->mass[i] * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
    }
}

/* Masses from 0.1 to 10 kg, of some 900 kg m in all: relative to that sums of some thousand moves are exact. So is
 * angular momentum, also where the sweeps stop before their end, as long as no energy is gained. */
static void momenta_stay(void **state) {
  (void)state;
  for (int way = 0; way < 3; way++) {
    bool kept = way == 1, stopped = way == 2; /* before the sweeps' end */
    bench b;
    double before[3][3], after[3][3];
    open_bench(&b);
    make_grid(&b, 17);
    limit(&b, 0.1, "sorted");
    test_text(&b.e, b.spec, "velocity", kept ? "kept" : "corrected");
    test_number(&b.e, b.spec, "sweeps", stopped ? 3 : 1e6);
    test_number(&b.e, b.spec, "tolerance", 1e-6);
    test_run(&b.e);
    shake(&b, stopped ? 0.08 : 0.4); /* more of it than velocities account for gains energy */
    sums(&b, before[0], before[1], before[2]);
    assert_true(correct(&b));
    sums(&b, after[0], after[1], after[2]);
    for (int q = 0; q < (kept ? 2 : 3); q++)
      for (int c = 0; c < 3; c++)
        if (!(fabs(after[q][c] - before[q][c]) < 1e4 * exact))
          fail_msg("sum %d, component %d: %.17g, then %.17g", q, c, before[q][c], after[q][c]);
    test_engine_close(&b.e);
  }
}

/* A mass whirls about a pin on a spring of almost no stiffness, at its limit: its speed stays, and the time of a turn
 * is 2 pi 1.1/v to order 2. With velocities kept as they are it does not turn at all. */
static double whirl(const char *velocity, double h, double *speed) {
  test_engine e;
  test_engine_open(&e);
  e.options.integrator = "leapfrog";
  e.options.dt = h;
  e.scene->duration = 10;
  test_particle(&e, 0, 0, 0, 1);
  uint32_t id = test_particle(&e, 1.1, 0, 0, 2);
  e.scene->particles.velocity[3 * (id - 1) + 1] = 3;
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *spec = test_plugin(&e, HK_CORRECTOR, "strain_limit");
  test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, spec, "rest", 1);
  test_number(&e, spec, "tolerance", 0);
  test_text(&e, spec, "velocity", velocity);
  test_run(&e);
  test_advance(&e, 2);
  const double *x = test_position(&e, id), *v = test_velocity(&e, id);
  *speed = sqrt(v[0] * v[0] + v[1] * v[1]);
  double off = hypot(x[0] - 1.1 * cos(6 / 1.1), x[1] - 1.1 * sin(6 / 1.1));
  test_engine_close(&e);
  return off;
}

static void a_mass_whirls_at_its_limit(void **state) {
  (void)state;
  double speed, coarse = whirl("corrected", 1.0 / 60, &speed);
  assert_true(fabs(speed - 3) < exact);
  double fine = whirl("corrected", 1.0 / 240, &speed), order = log2(coarse / fine) / 2;
  print_message("whirl: off by %.2e, %.2e: order %.2f, speed %.17g\n", coarse, fine, order, speed);
  assert_true(fabs(speed - 3) < exact && order > 1.9);
  assert_true(whirl("kept", 1.0 / 240, &speed) > 0.5);
}

/* ---- pins ---- */

static void pins_stay(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  make_chain(&b, 3);
  limit(&b, 0.1, "given");
  test_pin(&b.e, HK_PIN_FIXED, 1, NULL);
  test_pin(&b.e, HK_PIN_FIXED, 2, NULL);
  test_run(&b.e);
  double start[9] = {0, 0, 0, 0, 3, 0, 0, 3, 2}, *x = b.x;
  memcpy(x, start, sizeof start);
  assert_true(correct(&b)); /* the third is free and moves by the whole */
  assert_memory_equal(x, start, 6 * sizeof *x);
  assert_true(fabs(x[8] - 1.1) < exact && x[6] == 0 && fabs(x[7] - 3) < exact);
  assert_false(correct(&b)); /* the first edge is too long, with both of its ends pinned */
  hk_instance *c = test_instance(&b.e, b.spec);
  hk_view view = *hk_run_view(b.e.run);
  view.x = x;
  assert_true(fabs(c->plugin->corrector->violation(c->self, &view) - 1.9) < exact);
  test_engine_close(&b.e);
}

/* A bead that slides on a line, or in a plane, joined to a free mass: both come to the limit with the bead on its pin,
 * and what is along the pin of the momentum stays. */
static void beads_move_along_their_pins(void **state) {
  (void)state;
  for (int plane = 0; plane < 2; plane++) {
    test_engine e;
    double axis[3] = {0.6, 0.8, 0}, normal[3] = {0, 0, 1};
    test_engine_open(&e);
    e.options.integrator = "leapfrog";
    e.options.dt = 1e-2;
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 1, 0.3, 0.5, 3);
    memcpy(e.scene->particles.velocity, (double[]){0, 0, 0, 9, 2, 8}, 6 * sizeof(double));
    test_pin(&e, plane ? HK_PIN_PLANE : HK_PIN_LINE, 1, plane ? normal : axis);
    hk_plugin_spec *spec = test_plugin(&e, HK_CORRECTOR, "strain_limit");
    test_edges(&e, spec, (const uint32_t[][2]){{1, 2}}, 1);
    test_number(&e, spec, "limit", 0);
    test_number(&e, spec, "tolerance", 0);
    test_run(&e);
    test_advance(&e, 0.1);
    const double *x = test_position(&e, 1), *y = test_position(&e, 2), *v = test_velocity(&e, 1),
                 *u = test_velocity(&e, 2);
    double rest = sqrt(1 + 0.09 + 0.25), l = sqrt(pow(y[0] - x[0], 2) + pow(y[1] - x[1], 2) + pow(y[2] - x[2], 2));
    assert_true(x[0] > 0.1); /* drawn along */
    assert_true(fabs(l - rest) < exact);
    assert_true(plane ? x[2] == 0 : fabs(0.8 * x[0] - 0.6 * x[1]) < exact);
    double along = plane ? v[0] + 3 * u[0] - 27 : 0.6 * (v[0] + 3 * u[0] - 27) + 0.8 * (v[1] + 3 * u[1] - 6);
    assert_true(fabs(along) < exact * 100);
    test_engine_close(&e);
  }
}

/* A chain of links of at most 0.11 m between pins that go 1.5 m apart: nothing can bring it to its limits. It says so,
 * is as long as its pins ask, and gains no energy from the sweeps. */
static void pins_too_far_apart_are_a_violation_and_no_explosion(void **state) {
  (void)state;
  static const char *const orders[] = {"given", "outwards", "sorted"};
  for (int k = 0; k < 3; k++) {
    bench b;
    open_bench(&b);
    for (size_t i = 0; i <= 10; i++) {
      particle(&b, 0.1 * (double)i, 0.01 * noise(), 0.01 * noise(), 1);
      if (i) join(&b, i - 1, i);
    }
    b.e.scene->particles.position[30] = 1.5;
    for (int c = 3; c < 30; c++) b.e.scene->particles.velocity[c] = noise();
    limit(&b, 0.1, orders[k]);
    double rest[10];
    for (int e = 0; e < 10; e++) rest[e] = 0.1;
    test_list(&b.e, b.spec, "rest", rest, 10);
    test_number(&b.e, b.spec, "sweeps", 200);
    test_pin(&b.e, HK_PIN_FIXED, 1, NULL);
    test_pin(&b.e, HK_PIN_FIXED, 11, NULL);
    test_run(&b.e);
    test_advance(&b.e, 0.5);
    hk_summary s;
    hk_run_summary(b.e.run, &s);
    double start = 0;
    for (int c = 3; c < 30; c++) start += b.e.scene->particles.velocity[c] * b.e.scene->particles.velocity[c] / 2;
    print_message("pins too far apart, %s: violated by %.3g m, %.3g of %.3g J at most\n", orders[k],
                  s.constraint_violation, s.kinetic_max, start);
    assert_true(s.constraint_violation > 0.03 && s.warnings > 0);
    assert_true(s.kinetic_max <= start * (1 + 1e-12));
    test_engine_close(&b.e);
  }
}

/* ---- motion ---- */

/* Provot's sheet: 17 x 17 particles of 0.1 kg in all on the unit square, all springs of 1 N/m, hung by two corners. */
static void hang(bench *b, const char *method, double h, bool limited) {
  enum { N = 17 };
  open_bench(b);
  make_grid(b, N);
  for (size_t k = 0; k < 3 * b->n; k++) b->e.scene->particles.position[k] = b->x[k] /= N - 1;
  for (size_t i = 0; i < b->n; i++) b->e.scene->particles.mass[i] = b->mass[i] = 0.1 / (N * N);
  test_pin(&b->e, HK_PIN_FIXED, N * (N - 1) + 1, NULL);
  test_pin(&b->e, HK_PIN_FIXED, N * N, NULL);
  test_plugin(&b->e, HK_FORCE, "gravity");
  test_number(&b->e, test_plugin(&b->e, HK_FORCE, "drag"), "rate", 2);
  hk_plugin_spec *springs = test_plugin(&b->e, HK_FORCE, "springs");
  test_edges(&b->e, springs, (const uint32_t(*)[2])b->edge, b->edges);
  test_number(&b->e, springs, "k", 1);
  test_number(&b->e, springs, "damping", 2e-3);
  if (limited) limit(b, 0.1, "given");
  for (size_t k = 0; k < b->edges; k++) b->rest[k] = length_of(b, k);
  if (limited) test_number(&b->e, b->spec, "tolerance", 1e-6);
  b->e.options.integrator = method;
  b->e.options.dt = h;
  b->e.scene->duration = 2;
  test_run(&b->e);
}

static double hung_strain(bench *b, double t) {
  test_advance(&b->e, t);
  memcpy(b->x, hk_run_view(b->e.run)->x, 3 * b->n * sizeof *b->x);
  return strain(b);
}

static bool touches(const bench *b, size_t e, uint32_t id) { return b->edge[e][0] == id || b->edge[e][1] == id; }

static void a_hung_sheet_stretches_most_at_its_corners(void **state) {
  (void)state;
  bench b;
  hang(&b, "symplectic_euler", 1e-3, false);
  double most = hung_strain(&b, 0.6), elsewhere = 0;
  for (size_t k = 0; k < b.edges; k++)
    if (!touches(&b, k, 17 * 16 + 1) && !touches(&b, k, 17 * 17))
      elsewhere = fmax(elsewhere, length_of(&b, k) / b.rest[k] - 1);
  test_engine_close(&b.e);
  hang(&b, "symplectic_euler", 1e-3, true);
  double limited = hung_strain(&b, 0.6);
  test_engine_close(&b.e);
  print_message("hung sheet: strain %.3g at the corners, %.3g elsewhere; limited %.10g\n", most, elsewhere, limited);
  assert_true(most > 1 && elsewhere < 0.8 * most);
  assert_true(limited <= 0.1 + 1.2e-6);
}

/* After any step of any explicit method, to the tolerance. */
static void every_explicit_method_keeps_the_limit(void **state) {
  (void)state;
  static const char *const methods[] = {
      "euler",  "symplectic_euler", "leapfrog",  "midpoint",       "trapezoid",      "rk4",
      "dopri5", "stoermer",         "stoermer5", "stoermer_wide2", "stoermer_wide4", "blanes_moan"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    bench b;
    hang(&b, methods[k], strcmp(methods[k], "dopri5") ? 1e-3 : NAN, true);
    for (int step = 1; step <= 5; step++) {
      double most = hung_strain(&b, 0.12 + 0.01 * step);
      if (!(most <= 0.1 + 1.2e-6)) fail_msg("%s: strain %.10g", methods[k], most);
    }
    assert_true(strain(&b) > 0.0999); /* it is at work */
    hk_summary s;
    hk_run_summary(b.e.run, &s);
    assert_int_equal(s.warnings, 0);
    assert_true(isnan(s.energy_drift) && isnan(s.momentum_drift));
    test_engine_close(&b.e);
  }
}

/* One spring of 100 N/m and 1 kg, w = 10/s, free of damping: symplectic Euler is stable for steps below 2/w, and
 * its swing grows in every step above. */
static double swing(double h) {
  test_engine e;
  test_engine_open(&e);
  e.options.integrator = "symplectic_euler";
  e.options.dt = h;
  e.scene->duration = 1000 * h;
  e.scene->fps = 1 / h;
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1.1, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, springs, "k", 100);
  test_number(&e, springs, "rest", 1);
  double most = 0;
  test_run(&e);
  for (int k = 1; k <= 100; k++) {
    test_advance(&e, k * h);
    most = fmax(most, fabs(test_position(&e, 2)[0] - 1));
  }
  test_engine_close(&e);
  return most;
}

static void steps_beyond_the_limit_diverge_and_below_do_not(void **state) {
  (void)state;
  double below = swing(0.198), above = swing(0.202);
  print_message("dt = 0.99 and 1.01 of 2/w: swings of 0.1 m become %.3g m, %.3g m\n", below, above);
  assert_true(below < 2); /* the ellipse of symplectic Euler is 1/sqrt(1 - (h w/2)^2) = 7 times as long, at most */
  assert_true(above > 1e3);
}

/* ---- what is refused ---- */

static void edges_without_a_length_are_refused(void **state) {
  (void)state;
  bench b;
  open_bench(&b);
  particle(&b, 1, 2, 3, 1);
  particle(&b, 1, 2, 3, 1);
  join(&b, 0, 1);
  limit(&b, 0.1, "given");
  assert_int_equal(hk_run_open(b.e.scene, &b.e.options, &b.e.run, &b.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(b.e.error.text, "particles 1 and 2 are in one place"));
  test_engine_close(&b.e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_chain_swept_outwards_is_within_its_limits_at_once),
      cmocka_unit_test(what_is_not_visited_would_not_have_moved),
      cmocka_unit_test(none_is_above_the_limit_in_the_end),
      cmocka_unit_test(lengths_are_limited_below_too),
      cmocka_unit_test(what_is_left_is_said),
      cmocka_unit_test(momenta_stay),
      cmocka_unit_test(a_mass_whirls_at_its_limit),
      cmocka_unit_test(pins_stay),
      cmocka_unit_test(beads_move_along_their_pins),
      cmocka_unit_test(pins_too_far_apart_are_a_violation_and_no_explosion),
      cmocka_unit_test(a_hung_sheet_stretches_most_at_its_corners),
      cmocka_unit_test(every_explicit_method_keeps_the_limit),
      cmocka_unit_test(steps_beyond_the_limit_diverge_and_below_do_not),
      cmocka_unit_test(edges_without_a_length_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
