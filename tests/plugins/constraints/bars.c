/* Bars: published figures of the pendulum, periods of large swings, order, reversibility and energy of leapfrog, which
 * is RATTLE here, the work of what moves, and what is refused. */
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

static void open(test_engine *e, const char *method, double g) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, method);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -g, 0);
}

static hk_plugin_spec *bars(test_engine *e, const uint32_t (*edge)[2], size_t count) {
  hk_plugin_spec *spec = test_plugin(e, HK_CONSTRAINT, "bars");
  test_edges(e, spec, edge, count);
  return spec;
}

/* One frame at T, in `steps` steps. */
static void time_grid(test_engine *e, double T, size_t steps) {
  e->scene->fps = 1 / T;
  e->scene->duration = T;
  e->options.dt = T / (double)steps;
}

static double energy(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential;
}

/* ---- one pendulum ---- */

static void pendulum(test_engine *e, const char *method, double angle, double speed) {
  open(e, method, 1);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, sin(angle), -cos(angle), 0, 1);
  e->scene->particles.velocity[3] = speed * cos(angle);
  e->scene->particles.velocity[4] = speed * sin(angle);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  bars(e, (const uint32_t[][2]){{1, 2}}, 1);
}

/* x'' = -l x, y'' = -l y - 1, x^2 + y^2 = 1 from (1, 0) with (0, 1), at t = 1 (Hairer and Wanner, Solving ODEs II; here
 * with the digits of elliptic functions): x, y, u, v and l, which is the force in the bar. */
static const double known[5] = {0.867348640600439322, 0.497701050479672929, -0.0337480180609545196,
                                0.0588130114652500075, -0.493103151439018788};

static void pendulum_at_1(const char *method, size_t steps, double out[5]) {
  test_engine e;
  pendulum(&e, method, pi / 2, 1);
  time_grid(&e, 1, steps);
  test_run(&e);
  test_advance(&e, 1);
  memcpy(out, test_position(&e, 2), 2 * sizeof *out);
  memcpy(out + 2, test_velocity(&e, 2), 2 * sizeof *out);
  assert_int_equal(hk_run_constraint_forces(e.run, "bars", out + 4, &e.error), HK_OK);
  test_engine_close(&e);
}

/* dopri5's own error at its tightest is some 1e-13 a step; rk4 at h = 1/400: h^4/120 of motions of 1 rad/s, 2e-13. The
 * multiplier is lambda of g = L - |d|, positive in tension. */
static void pendulum_has_the_published_digits(void **state) {
  (void)state;
  double got[5];
  pendulum_at_1("rk4", 400, got);
  for (int k = 0; k < 5; k++) assert_true(fabs(got[k] - known[k]) < 1e-11);
}

/* The error of an even method is c h^2 + O(h^4): the order within 0.1, and extrapolated once 1e-9 at h = 1/200. */
static void leapfrog_is_of_order_2_on_the_pendulum(void **state) {
  (void)state;
  double coarse[5], fine[5], error[2] = {0, 0};
  pendulum_at_1("leapfrog", 100, coarse);
  pendulum_at_1("leapfrog", 200, fine);
  for (int k = 0; k < 4; k++) {
    error[0] += pow(coarse[k] - known[k], 2);
    error[1] += pow(fine[k] - known[k], 2);
    assert_true(fabs((4 * fine[k] - coarse[k]) / 3 - known[k]) < 1e-9);
  }
  assert_true(fabs(log2(error[0] / error[1]) / 2 - 2) < 0.1);
}

/* The period is 4 K(sin(angle/2)) for L = g = 1, K by the arithmetic-geometric mean. */
static double period(double angle) {
  double a = 1, b = cos(angle / 2);
  for (int k = 0; k < 12; k++) {
    double mean = (a + b) / 2;
    b = sqrt(a * b);
    a = mean;
  }
  return 2 * pi / a;
}

/* After a period it is at its start. rk4, h < 0.005: (h w)^4/120 T = 1e-11 rad, grown near the top by e^T at most, as
 * 179 degrees is some e^-4 from it: 1e-8. */
static void large_swings_have_their_periods(void **state) {
  (void)state;
  static const double degrees[] = {10, 45, 90, 150, 179};
  for (size_t k = 0; k < sizeof degrees / sizeof *degrees; k++) {
    test_engine e;
    double angle = degrees[k] * pi / 180, T = period(angle);
    pendulum(&e, "rk4", angle, 0);
    time_grid(&e, T, 5000);
    test_run(&e);
    test_advance(&e, T);
    const double *x = test_position(&e, 2), *v = test_velocity(&e, 2);
    assert_true(fabs(x[0] - sin(angle)) < 1e-8 && fabs(x[1] + cos(angle)) < 1e-8);
    assert_true(hypot(v[0], v[1]) < 1e-8);
    test_engine_close(&e);
  }
}

/* A swing of 150 degrees, h = 0.02, two hundred thousand steps: the error of the energy is that of a modified energy,
 * h^2 of it, which returns. In the second half it is no larger than in the first, up to 1 % for where frames fall. */
static void energy_of_a_large_swing_is_bounded_and_the_length_is_kept(void **state) {
  (void)state;
  enum { FRAMES = 2000, STEPS = 100 };
  test_engine e;
  double most[2] = {0, 0}, h = 0.02;
  pendulum(&e, "leapfrog", 150 * pi / 180, 0);
  e.scene->fps = 1 / (STEPS * h);
  e.scene->duration = FRAMES * STEPS * h;
  e.options.dt = h;
  test_run(&e);
  double first = energy(&e);
  for (int frame = 1; frame <= FRAMES; frame++) {
    test_advance(&e, frame * STEPS * h);
    double *here = &most[frame > FRAMES / 2];
    *here = fmax(*here, fabs(energy(&e) - first));
  }
  assert_true(most[0] < 1e-3 && most[1] < 1.01 * most[0]);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.steps == FRAMES * STEPS && s.constraint_violation < 2e-15); /* rounding of a length of 1 */
  test_engine_close(&e);
}

/* ---- bars of many particles ---- */

enum { BALLS = 6 };
static const double place[BALLS][3] = {{0, 0, 0},         {0.8, -0.2, 0.1}, {1.3, -0.9, 0.3},
                                       {2.1, -0.7, -0.2}, {1.9, 0.1, -0.5}, {1.4, 0.6, 0.2}};
static const double weight[BALLS] = {1, 0.7, 1.3, 0.4, 2, 0.6};
/* A bar to a tetrahedron that swings with it, which has one bar more than it needs to be rigid in its neighbourhood. */
static const uint32_t linkage[][2] = {{1, 2}, {2, 3}, {3, 4}, {3, 5}, {3, 6}, {4, 5}, {4, 6}, {5, 6}, {4, 3}};

/* The state X (x and v, `BALLS` x 3 each) after `steps` of h; drag of `rate` where it is above 0. */
static void swing(const char *method, double rate, double h, size_t steps, double *X) {
  test_engine e;
  open(&e, method, 9.81);
  if (rate > 0) test_number(&e, test_plugin(&e, HK_FORCE, "drag"), "rate", rate);
  for (size_t i = 0; i < BALLS; i++) test_particle(&e, X[3 * i], X[3 * i + 1], X[3 * i + 2], weight[i]);
  memcpy(e.scene->particles.velocity, X + 3 * BALLS, 3 * BALLS * sizeof *X);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, linkage, sizeof linkage / sizeof *linkage);
  time_grid(&e, h * (double)steps, steps);
  test_run(&e);
  test_advance(&e, h * (double)steps);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.constraint_violation < 1e-11);
  for (uint32_t i = 0; i < BALLS; i++) {
    memcpy(X + 3 * i, test_position(&e, i + 1), 3 * sizeof *X);
    memcpy(X + 3 * (BALLS + i), test_velocity(&e, i + 1), 3 * sizeof *X);
  }
  test_engine_close(&e);
}

static double swing_error(double rate, size_t steps, const double *right) {
  double X[6 * BALLS] = {0}, sum = 0;
  memcpy(X, place, sizeof place);
  swing("leapfrog", rate, 0.5 / (double)steps, steps, X);
  for (size_t k = 0; k < 6 * BALLS; k++) sum += pow(X[k] - right[k], 2);
  return sqrt(sum);
}

static void leapfrog_is_of_order_2_on_a_linkage(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    double right[6 * BALLS] = {0}, rate = damped ? 0.8 : 0;
    memcpy(right, place, sizeof place);
    swing("rk4", rate, 0.5 / 2000, 2000, right); /* 1e-4 of the errors below */
    double coarse = swing_error(rate, 200, right), fine = swing_error(rate, 400, right);
    assert_true(fine < 1e-3 && fabs(log2(coarse / fine) - 2) < 0.1);
  }
}

/* Rounding of some 1e-16 a step, grown by the motion, which is a chaotic one: 1e3 in half a second. */
static void leapfrog_returns_to_the_start(void **state) {
  (void)state;
  double X[6 * BALLS] = {0};
  memcpy(X, place, sizeof place);
  swing("leapfrog", 0, 2e-3, 250, X);
  for (size_t k = 3 * BALLS; k < 6 * BALLS; k++) X[k] = -X[k];
  swing("leapfrog", 0, 2e-3, 250, X);
  for (size_t k = 0; k < 3 * BALLS; k++) {
    assert_true(fabs(X[k] - ((const double *)place)[k]) < 1e-11);
    assert_true(fabs(X[3 * BALLS + k]) < 1e-11);
  }
}

/* The forces in the bars do no work: J v = 0, so J^T lambda . v = 0, to rounding of their terms. */
static void forces_in_bars_do_no_work(void **state) {
  (void)state;
  test_engine e;
  double lambda[sizeof linkage / sizeof *linkage], power = 0, terms = 0;
  open(&e, "leapfrog", 9.81);
  for (size_t i = 0; i < BALLS; i++) test_particle(&e, place[i][0], place[i][1], place[i][2], weight[i]);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, linkage, sizeof linkage / sizeof *linkage);
  time_grid(&e, 0.4, 100);
  test_run(&e);
  test_advance(&e, 0.4);
  assert_int_equal(hk_run_constraint_forces(e.run, "bars", lambda, &e.error), HK_OK);
  for (size_t b = 0; b < sizeof linkage / sizeof *linkage; b++) {
    const double *x = test_position(&e, linkage[b][0]), *y = test_position(&e, linkage[b][1]);
    const double *u = test_velocity(&e, linkage[b][0]), *w = test_velocity(&e, linkage[b][1]);
    double l = sqrt(pow(y[0] - x[0], 2) + pow(y[1] - x[1], 2) + pow(y[2] - x[2], 2)), along = 0;
    for (int c = 0; c < 3; c++) along += (y[c] - x[c]) / l * (w[c] - u[c]);
    power -= lambda[b] * along;
    terms += fabs(lambda[b]) * sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  }
  assert_true(terms > 1 && fabs(power) < 1e-13 * terms);
  test_engine_close(&e);
}

/* A square with both diagonals, of whose six bars one follows from the others in its plane, hangs by a corner, with a
 * weight F at the lowest and w at either side. Equilibrium leaves one number open: with s in the lower sides, there are
 * s + sqrt2 w in the upper ones, F - sqrt2 s upright and -sqrt2 s - w across. The sum of squares is least at
 * s = sqrt2 (F - 3 w)/8. */
static void a_truss_carries_the_least_squares_of_its_forces(void **state) {
  (void)state;
  test_engine e;
  double g = 10, F = g, w = 0.02 * g, a = sqrt(0.5), s = sqrt(2) * (F - 3 * w) / 8, lambda[6];
  const double right[6] = {s + sqrt(2) * w, s + sqrt(2) * w, s, s, F - sqrt(2) * s, -sqrt(2) * s - w};
  open(&e, "leapfrog", g);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, a, -a, 0, 0.02);
  test_particle(&e, -a, -a, 0, 0.02);
  test_particle(&e, 0, -2 * a, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {1, 3}, {2, 4}, {3, 4}, {1, 4}, {2, 3}}, 6);
  time_grid(&e, 0.01, 10);
  test_run(&e);
  test_advance(&e, 0.01);
  assert_int_equal(hk_run_constraint_forces(e.run, "bars", lambda, &e.error), HK_OK);
  /* Rounding over the shift of a singular system: 1e-16 / 1e-6 of F. */
  for (int k = 0; k < 6; k++)
    if (!(fabs(lambda[k] - right[k]) < 1e-8)) fail_msg("bar %d: %.12g, not %.12g", k, lambda[k], right[k]);
  test_engine_close(&e);
}

/* A weight of 1 kg on 20 bars with joints of 1 mg, let go 53 degrees from the vertical. It swings as if the bars were
 * one, but for the joints' 2e-5 of its mass and what they swing by themselves, by errors: 1e-4 of its path, against rk4
 * with one bar. */
static void a_weight_swings_on_a_chain_a_million_times_lighter(void **state) {
  (void)state;
  enum { LIGHT = 20 };
  double end[2][3], T = 0.8;
  for (int one = 0; one < 2; one++) {
    test_engine e;
    uint32_t edge[LIGHT][2], links = one ? 1 : LIGHT;
    open(&e, one ? "rk4" : "leapfrog", 10);
    for (uint32_t i = 0; i <= links; i++) {
      test_particle(&e, 0.8 * i / links, -0.6 * i / links, 0, i < links ? 1e-6 : 1);
      if (i < links) edge[i][0] = i + 1, edge[i][1] = i + 2;
    }
    test_pin(&e, HK_PIN_FIXED, 1, NULL);
    bars(&e, (const uint32_t(*)[2])edge, links);
    time_grid(&e, T, one ? 2000 : 16000);
    test_run(&e);
    test_advance(&e, T);
    memcpy(end[one], test_position(&e, links + 1), sizeof end[one]);
    test_engine_close(&e);
  }
  for (int c = 0; c < 3; c++) assert_true(fabs(end[0][c] - end[1][c]) < 4e-5);
}

/* Bars of 0.86 m that turn by 0.4 rad and more in a step: rounds with the matrix of the step's start do not meet the
 * lengths at its end, rounds with their own do, and no step is halved. */
static void a_step_may_turn_bars_far(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  open(&e, "leapfrog", 10);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0.8, 0.3, 0.1, 1);
  test_particle(&e, 1.6, 0, 0.2, 1);
  memcpy(e.scene->particles.velocity + 3, (double[]){0, 20, 20, 0, -40, 40}, 6 * sizeof(double));
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  time_grid(&e, 1, 100);
  test_run(&e);
  test_advance(&e, 1);
  hk_run_summary(e.run, &s);
  assert_int_equal(s.steps, 100);
  assert_true(s.constraint_violation < 1e-12);
  assert_non_null(e.run->dynamics.constraints->mixed.any); /* it was needed */
  test_engine_close(&e);
}

/* ---- what moves, and how often there is something to analyse ---- */

static hk_status shake(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                       size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = 0.2 * sin(3 * in[0]);
  out[1] = 0.1 * sin(5 * in[0]);
  out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

static double shaken_drift(const char *method, size_t steps) {
  test_engine e;
  uint32_t pivot = 1;
  open(&e, method, 9.81);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0.6, -0.3, 0, 0.5);
  test_particle(&e, 1, -0.1, 0, 0.8);
  hk_pin_spec pin = {.kind = HK_PIN_PATH, .count = 1, .id = &pivot, .release = INFINITY, .path = {.call = shake}};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  time_grid(&e, 1, steps);
  test_run(&e);
  double first = energy(&e);
  test_advance(&e, 1);
  assert_true(fabs(energy(&e) - first) > 0.1); /* J: the pin does work */
  hk_summary s;
  hk_run_summary(e.run, &s);
  test_engine_close(&e);
  return fabs(s.energy_drift);
}

/* What a moving pin gives through a bar is in the energy balance, to the order of the method. */
static void a_moving_pin_does_work_through_a_bar(void **state) {
  (void)state;
  double coarse = shaken_drift("leapfrog", 200), fine = shaken_drift("leapfrog", 400);
  assert_true(fine < 1e-3 && log2(coarse / fine) > 1.8);
  coarse = shaken_drift("rk4", 400), fine = shaken_drift("rk4", 800);
  assert_true(fine < 1e-8 && log2(coarse / fine) > 3.5);
}

static hk_status round_path(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                            size_t max_out, size_t *n_out, hk_error *error) {
  double angle = in[0] * in[0];
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = 0.3 * (cos(angle) - 1), out[1] = 0.3 * sin(angle), out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

static hk_status turn(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = out[1] = 0, out[2] = in[0] * in[0];
  *n_out = 3;
  return HK_OK;
}

/* A double pendulum whose pivot goes round a circle. */
static void swing_round(hk_pin_spec pin, double end[9]) {
  test_engine e;
  uint32_t pivot = 1;
  open(&e, "rk4", 9.81);
  test_particle(&e, 0.3, 0, 0, 1);
  test_particle(&e, 0.6, -0.3, 0, 0.5);
  test_particle(&e, 1, -0.1, 0, 0.8);
  pin.kind = HK_PIN_PATH, pin.count = 1, pin.id = &pivot, pin.release = INFINITY;
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  time_grid(&e, 1, 400);
  test_run(&e);
  test_advance(&e, 1);
  memcpy(end, e.run->state.X, 9 * sizeof *end);
  test_engine_close(&e);
}

/* As a path and as a rotation about the circle's center it is the same motion; second differences are good for 1e-7 or
 * so of the accelerations, 1 m/s^2. */
static void a_turning_pin_accelerates_bars_as_its_path_does(void **state) {
  double path[9], rotation[9];
  (void)state;
  swing_round((hk_pin_spec){.path = {.call = round_path}}, path);
  swing_round((hk_pin_spec){.rotation = {.call = turn}}, rotation);
  for (int k = 0; k < 9; k++) assert_true(fabs(path[k] - rotation[k]) < 1e-7);
}

/* Of one pattern one analysis, and one factorization a step beside those of the start. */
static void the_pattern_is_analysed_once_and_a_step_factorizes_once(void **state) {
  (void)state;
  test_engine e;
  open(&e, "leapfrog", 9.81);
  for (size_t i = 0; i < BALLS; i++) test_particle(&e, place[i][0], place[i][1], place[i][2], weight[i]);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, linkage, sizeof linkage / sizeof *linkage);
  test_plugin(&e, HK_SOLVER, "fixture:counting_solver");
  time_grid(&e, 0.1, 50);
  test_run(&e);
  e.run->step->length.watch = NULL; /* its samples factorize by themselves */
  const int64_t *count = e.run->dynamics.constraints->linear.solver->self; /* analyses, factorizations */
  int64_t before = count[1];
  test_advance(&e, 0.1);
  assert_int_equal(count[0], 1);
  assert_true(count[1] - before <= 51); /* one for the first step's start */
  test_engine_close(&e);
}

/* ---- what is refused ---- */

static void refused(test_engine *e, hk_status with, const char *const *words) {
  hk_status status = hk_run_open(e->scene, &e->options, &e->run, &e->error);
  if (status != with) fail_msg("status %d: %s", (int)status, e->error.text);
  for (; *words; words++)
    if (!strstr(e->error.text, *words)) fail_msg("'%s' is not in: %s", *words, e->error.text);
  test_engine_close(e);
}

static void four(test_engine *e) {
  open(e, "leapfrog", 9.81);
  for (int i = 0; i < 4; i++) test_particle(e, i, 0.1 * i * i, 0, 1);
}

static void bars_of_no_length_are_refused(void **state) {
  (void)state;
  test_engine e;
  four(&e);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2), "length", 0);
  refused(&e, HK_BAD_PARAM, (const char *const[]){"particles 1 and 2", "edge 1", "weld", NULL});
  four(&e);
  test_particle(&e, 1, 0.1, 0, 1);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {5, 2}}, 2), "length", 1);
  refused(&e, HK_BAD_PARAM, (const char *const[]){"particles 5 and 2", "edge 2", "one place", NULL});
}

static void bars_that_contradict_each_other_are_named(void **state) {
  (void)state;
  test_engine e;
  four(&e);
  test_list(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}, {2, 1}}, 3), "length", (double[]){1, 1, 1.2}, 3);
  refused(
      &e, HK_NOT_CONVERGED,
      (const char *const[]){"equation 1 (particles 1 and 2)", "contradict", "equation 3 (particles 2 and 1)", NULL});
  four(&e); /* 1 + 1 < 3 */
  test_list(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 1}}, 3), "length", (double[]){1, 1, 3}, 3);
  refused(&e, HK_NOT_CONVERGED, (const char *const[]){"equation", "contradict", "(particles", NULL});
}

/* Five particles and all ten bars between them, of which nine are enough. The tenth may be off by what a length loses
 * when it is written with nine digits, but not by more than 1e-7 of the size. */
static void a_loop_may_close_to_the_digits_of_its_lengths(void **state) {
  (void)state;
  for (int far = 0; far < 2; far++) {
    test_engine e;
    uint32_t edge[10][2];
    double length[10];
    size_t count = 0;
    open(&e, "leapfrog", 9.81);
    for (size_t i = 0; i < 5; i++) {
      test_particle(&e, place[i][0], place[i][1], place[i][2], weight[i]);
      for (size_t j = 0; j < i; j++, count++) {
        edge[count][0] = (uint32_t)j + 1, edge[count][1] = (uint32_t)i + 1;
        length[count] = sqrt(pow(place[i][0] - place[j][0], 2) + pow(place[i][1] - place[j][1], 2) +
                             pow(place[i][2] - place[j][2], 2));
      }
    }
    length[9] += far ? 1e-4 : 1e-9;
    test_list(&e, bars(&e, (const uint32_t(*)[2])edge, 10), "length", length, 10);
    time_grid(&e, 0.1, 50);
    if (far) {
      refused(&e, HK_NOT_CONVERGED, (const char *const[]){"contradict", "(particles", NULL});
      continue;
    }
    test_run(&e);
    test_advance(&e, 0.1);
    hk_summary s;
    hk_run_summary(e.run, &s);
    assert_true(s.constraint_violation < 1e-8); /* what is off is said */
    test_engine_close(&e);
  }
}

static void bars_that_contradict_pins_are_named(void **state) {
  (void)state;
  test_engine e;
  four(&e);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, 2, NULL);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}}, 1), "length", 1.3);
  refused(&e, HK_NOT_CONVERGED, (const char *const[]){"equation 1 (particles 1 and 2)", "pins", NULL});
  four(&e); /* 2.7 m between pins that are 3.1 m apart */
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, 4, NULL);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3), "length", 0.9);
  refused(&e, HK_NOT_CONVERGED, (const char *const[]){"contradict", "(particles", NULL});
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pendulum_has_the_published_digits),
      cmocka_unit_test(leapfrog_is_of_order_2_on_the_pendulum),
      cmocka_unit_test(large_swings_have_their_periods),
      cmocka_unit_test(energy_of_a_large_swing_is_bounded_and_the_length_is_kept),
      cmocka_unit_test(leapfrog_is_of_order_2_on_a_linkage),
      cmocka_unit_test(leapfrog_returns_to_the_start),
      cmocka_unit_test(forces_in_bars_do_no_work),
      cmocka_unit_test(a_truss_carries_the_least_squares_of_its_forces),
      cmocka_unit_test(a_weight_swings_on_a_chain_a_million_times_lighter),
      cmocka_unit_test(a_step_may_turn_bars_far),
      cmocka_unit_test(a_moving_pin_does_work_through_a_bar),
      cmocka_unit_test(a_turning_pin_accelerates_bars_as_its_path_does),
      cmocka_unit_test(the_pattern_is_analysed_once_and_a_step_factorizes_once),
      cmocka_unit_test(bars_of_no_length_are_refused),
      cmocka_unit_test(bars_that_contradict_each_other_are_named),
      cmocka_unit_test(a_loop_may_close_to_the_digits_of_its_lengths),
      cmocka_unit_test(bars_that_contradict_pins_are_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
