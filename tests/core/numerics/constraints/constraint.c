/* Constraints: pendulums against their known figures, pins, equations that follow from others or contradict each other,
 * that fail, come and go. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81;

/* A quarter period of the pendulum is K(sin(angle/2)) sqrt(L/g); K by the arithmetic-geometric mean. */
static double period(double length, double gravity, double angle) {
  double a = 1, b = cos(angle / 2);
  for (int k = 0; k < 8; k++) {
    double mean = (a + b) / 2;
    b = sqrt(a * b);
    a = mean;
  }
  return 2 * acos(-1) / a * sqrt(length / gravity);
}

static void open(test_engine *e, const char *integrator) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, integrator);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -g, 0);
}

static hk_plugin_spec *bars(test_engine *e, const uint32_t (*edge)[2], size_t count) {
  hk_plugin_spec *bar = test_plugin(e, HK_CONSTRAINT, "fixture:bar");
  test_edges(e, bar, edge, count);
  return bar;
}

/* `frames` frames up to T, each of `steps` steps. */
static void time_grid(test_engine *e, double T, size_t frames, size_t steps) {
  e->scene->fps = (double)frames / T;
  e->scene->duration = T;
  e->options.dt = T / (double)(frames * steps);
}

static double distance(test_engine *e, uint32_t i, uint32_t j) {
  const double *a = test_position(e, i), *b = test_position(e, j);
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double energy(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential;
}

/* Where a pendulum let go at 120 degrees is after one period, away from its start. */
static double period_error(const char *integrator, size_t steps) {
  test_engine e;
  double angle = 2 * acos(-1) / 3, L = 0.7;
  open(&e, integrator);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, L * sin(angle), -L * cos(angle), 0, 0.3);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}}, 1);
  double T = period(L, g, angle);
  time_grid(&e, T, 1, steps);
  test_run(&e);
  test_advance(&e, T);
  const double *x = test_position(&e, 2), *v = test_velocity(&e, 2);
  assert_true(fabs(distance(&e, 1, 2) - L) < 1e-12); /* the tolerance of the projection, 1e-12 of the size */
  assert_true(fabs(x[0] * v[0] + x[1] * v[1]) < 1e-12);
  double error = hypot(hypot(x[0] - L * sin(angle), x[1] + L * cos(angle)), hypot(v[0], v[1]));
  test_engine_close(&e);
  return error;
}

/* The period is exact, so the error is the method's: halving the step divides it by 2^order, up to the next term of the
 * error. Leapfrog does better here, for its leading term passes through zero near a whole period. */
static void pendulum_has_the_period_of_the_elliptic_integral(void **state) {
  (void)state;
  double coarse = period_error("leapfrog", 800), fine = period_error("leapfrog", 1600);
  assert_true(fine < 1e-4 && log2(coarse / fine) > 1.8);
  coarse = period_error("rk4", 800), fine = period_error("rk4", 1600);
  assert_true(fine < 1e-8 && fabs(log2(coarse / fine) - 4) < 0.3);
}

/* Both arms above the horizontal: chaotic, so only the energy is known. Its error is of the method's order, here 1e-4 s
 * to the fourth times some 1/s^4 of derivatives: 1e-9 leaves room for those of a whip crack. */
static void double_pendulum_keeps_its_energy(void **state) {
  (void)state;
  test_engine e;
  open(&e, "rk4");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0.2, 0, 1);
  test_particle(&e, 1.3, 1.1, 0.2, 0.5);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  time_grid(&e, 5, 50, 200);
  test_run(&e);
  double L[2] = {distance(&e, 1, 2), distance(&e, 2, 3)}, first = energy(&e);
  test_advance(&e, 5);
  assert_true(fabs(distance(&e, 1, 2) - L[0]) < 1e-11 && fabs(distance(&e, 2, 3) - L[1]) < 1e-11);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.constraint_violation < 1e-11);
  assert_true(fabs(energy(&e) - first) < 1e-9 * s.kinetic_max);
  test_engine_close(&e);
}

/* A bead of mass M on a horizontal line with a bob m below it: momentum along the line and energy are kept, and small
 * swings have w^2 = g (M + m)/(M L); the amplitude a changes the period by a^2/16 or so. */
static void bead_on_a_line_carries_a_pendulum(void **state) {
  (void)state;
  test_engine e;
  double L = 0.5, M = 2, m = 0.7, a = 1e-3, T = 2 * acos(-1) / sqrt(g * (M + m) / (M * L));
  open(&e, "rk4");
  test_particle(&e, 0, 0, 0, M);
  test_particle(&e, L * sin(a), -L * cos(a), 0, m);
  test_pin(&e, HK_PIN_LINE, 1, (double[]){1, 0, 0});
  bars(&e, (const uint32_t[][2]){{1, 2}}, 1);
  time_grid(&e, T, 1, 400);
  test_run(&e);
  double first = energy(&e);
  test_advance(&e, T);
  const double *bead = test_position(&e, 1), *bob = test_position(&e, 2);
  assert_true(bead[1] == 0 && bead[2] == 0);
  assert_true(fabs(distance(&e, 1, 2) - L) < 1e-12);
  assert_true(fabs(M * test_velocity(&e, 1)[0] + m * test_velocity(&e, 2)[0]) < 1e-13);
  assert_true(fabs(energy(&e) - first) < 1e-12);
  assert_true(fabs(bob[0] - L * sin(a)) < 1e-8 && fabs(bead[0]) < 1e-8);
  test_engine_close(&e);
}

static hk_status lift(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  (void)caller, (void)n_in, (void)max_out, (void)error;
  double acceleration = *(const double *)f->context;
  out[0] = out[2] = 0;
  out[1] = acceleration * in[0] * in[0] / 2;
  *n_out = 3;
  return HK_OK;
}

static double lift_error(size_t steps) {
  test_engine e;
  double up = 4, angle = 1.5, L = 0.6;
  uint32_t pivot = 1;
  open(&e, "rk4");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, L * sin(angle), -L * cos(angle), 0, 1);
  hk_pin_spec pin = {
      .kind = HK_PIN_PATH, .count = 1, .id = &pivot, .release = INFINITY, .path = {.call = lift, .context = &up}};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  bars(&e, (const uint32_t[][2]){{1, 2}}, 1);
  double T = period(L, g + up, angle);
  time_grid(&e, T, 1, steps);
  test_run(&e);
  test_advance(&e, T);
  const double *x = test_position(&e, 2), *p = test_position(&e, 1);
  assert_true(fabs(distance(&e, 1, 2) - L) < 1e-11);
  double error = hypot(x[0] - p[0] - L * sin(angle), x[1] - p[1] + L * cos(angle));
  test_engine_close(&e);
  return error;
}

/* In a lift that accelerates upwards by a, g is g + a. The order of the method must survive the moving pin. */
static void pendulum_in_a_lift_swings_faster(void **state) {
  (void)state;
  double coarse = lift_error(100), fine = lift_error(200);
  assert_true(fine < 1e-5 && log2(coarse / fine) > 3.5);
}

/* No outer force: a spinning dumbbell turns by exactly v t / r, and momentum stays. */
static void dumbbell_turns_uniformly(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  test_particle(&e, -0.5, 0, 0, 2);
  test_particle(&e, 0.5, 0, 0, 2);
  e.scene->particles.velocity[1] = -1.5;
  e.scene->particles.velocity[4] = 1.5;
  bars(&e, (const uint32_t[][2]){{1, 2}}, 1);
  time_grid(&e, 1, 1, 500);
  test_run(&e);
  test_advance(&e, 1);
  const double *x = test_position(&e, 2);
  assert_true(fabs(x[0] - 0.5 * cos(3)) < 1e-10 && fabs(x[1] - 0.5 * sin(3)) < 1e-10); /* (w h)^4 = 1e-9, /120 */
  const double *v = test_velocity(&e, 1), *w = test_velocity(&e, 2);
  for (int c = 0; c < 3; c++) assert_true(fabs(v[c] + w[c]) < 1e-13);
  test_engine_close(&e);
}

static void long_chain_keeps_its_lengths_and_a_bar_between_pins_is_no_trouble(void **state) {
  (void)state;
  enum { LINKS = 300 };
  test_engine e;
  uint32_t edge[LINKS + 1][2];
  open(&e, "rk4");
  for (uint32_t i = 0; i <= LINKS; i++) test_particle(&e, 0.01 * i, 0, 0, 0.01);
  test_particle(&e, 0, 1, 0, 1);
  for (uint32_t i = 0; i < LINKS; i++) edge[i][0] = i + 1, edge[i][1] = i + 2;
  edge[LINKS][0] = 1, edge[LINKS][1] = LINKS + 2;
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, LINKS + 2, NULL);
  bars(&e, (const uint32_t(*)[2])edge, LINKS + 1);
  time_grid(&e, 0.2, 4, 100);
  test_run(&e);
  double first = energy(&e);
  test_advance(&e, 0.2);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.constraint_violation < 1e-11);
  assert_true(test_position(&e, LINKS + 1)[1] <
              -0.15); /* it fell: the free end faster than g t^2/2 = 0.196 m at most */
  assert_true(fabs(energy(&e) - first) < 1e-8 * s.kinetic_max);
  test_engine_close(&e);
}

/* A chain of three bars, the last given `more` times again by a second constraint; where its end is after a second. */
static void chain_end(const char *method, size_t more, double end[3]) {
  test_engine e;
  open(&e, method);
  for (int i = 0; i < 4; i++) test_particle(&e, i, 0.1 * i * i, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3);
  for (size_t k = 0; k < more; k++) bars(&e, (const uint32_t[][2]){{4, 3}}, 1);
  time_grid(&e, 1, 10, 20);
  test_run(&e);
  test_advance(&e, 1);
  memcpy(end, test_position(&e, 4), 3 * sizeof *end);
  test_engine_close(&e);
}

/* What follows from others has the multiplier 0: the motion is the same up to rounding, which this double pendulum of
 * three arms amplifies by less than 1e4 in a second. */
static void a_bar_that_is_given_twice_changes_nothing(void **state) {
  (void)state;
  static const char *const methods[] = {"rk4", "leapfrog", "bdf2", "implicit_midpoint"};
  for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
    double once[3], twice[3], often[3];
    chain_end(methods[m], 0, once);
    chain_end(methods[m], 1, twice);
    chain_end(methods[m], 4, often);
    for (int c = 0; c < 3; c++) assert_true(fabs(once[c] - twice[c]) < 1e-11 && fabs(once[c] - often[c]) < 1e-11);
  }
}

static void copies_of_one_bar_fall_together(void **state) {
  (void)state;
  test_engine e;
  open(&e, "leapfrog");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0.3, 0.4, 0.5, 0.7);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}}, 1), "copies", 3);
  time_grid(&e, 0.5, 1, 100);
  test_run(&e);
  test_advance(&e, 0.5);
  assert_true(fabs(test_position(&e, 1)[1] + g / 8) < 1e-12); /* leapfrog is exact for a parabola */
  assert_true(fabs(distance(&e, 1, 2) - sqrt(0.5)) < 1e-12);
  test_engine_close(&e);
}

/* Ten bars between five particles, of which the tenth closes exactly: 9 would do. A free rigid body, spun; the order of
 * rk4 must survive stages at which the loop does not close. Errors against a run with a sixteenth of the step. */
static double brace_error(size_t links, size_t steps, double *end, const double *known) {
  static const double at[5][3] = {{0, 0, 0}, {1, 0.1, 0}, {0.2, 1.1, 0.3}, {0.3, 0.2, 0.9}, {-0.5, 0.4, 0.6}};
  uint32_t edge[10][2];
  size_t count = 0;
  double sum = 0;
  test_engine e;
  open(&e, "rk4");
  for (uint32_t i = 0; i < 5; i++) {
    test_particle(&e, at[i][0], at[i][1], at[i][2], 1 + 0.3 * i);
    for (uint32_t j = 0; j < i; j++, count++) edge[count][0] = j + 1, edge[count][1] = i + 1;
  }
  for (size_t i = 0; i < 5; i++) { /* w x r with w = (1, 2, -1.5) */
    double *v = e.scene->particles.velocity + 3 * i;
    const double *r = at[i];
    v[0] = 2 * r[2] + 1.5 * r[1], v[1] = -1.5 * r[0] - r[2], v[2] = r[1] - 2 * r[0];
  }
  bars(&e, (const uint32_t(*)[2])edge, links);
  time_grid(&e, 1, 1, steps);
  test_run(&e);
  test_advance(&e, 1);
  for (uint32_t i = 0; i < 15; i++) {
    end[i] = test_position(&e, i / 3 + 1)[i % 3];
    if (known) sum += pow(end[i] - known[i], 2);
  }
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.constraint_violation < 1e-11);
  test_engine_close(&e);
  return sqrt(sum);
}

static void a_loop_of_bars_that_closes_exactly_keeps_the_order(void **state) {
  (void)state;
  double known[15], end[15];
  brace_error(9, 1600, known, NULL);
  double coarse = brace_error(10, 50, end, known), fine = brace_error(10, 100, end, known);
  assert_true(fine < 1e-5 && log2(coarse / fine) > 3.7);
}

static void bars_that_contradict_each_other_are_refused_by_name(void **state) {
  (void)state;
  test_engine e;
  open(&e, "rk4");
  for (int i = 0; i < 4; i++) test_particle(&e, i, 0.1 * i * i, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3);
  test_number(&e, bars(&e, (const uint32_t[][2]){{4, 3}}, 1), "length", 1.3); /* the third is 1.118 m long */
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_NOT_CONVERGED);
  assert_non_null(strstr(e.error.text, "contradict each other"));
  assert_true(strstr(e.error.text, "bar: the position of equation 3") ||
              strstr(e.error.text, "bar#2: the position of equation 1"));
  test_engine_close(&e);
}

/* Straight between two pins a bar chain is held along itself by both bars, of which one would do at this state alone.
 */
static void a_chain_that_is_stretched_between_pins_stays(void **state) {
  (void)state;
  test_engine e;
  open(&e, "rk4");
  for (int i = 0; i < 3; i++) test_particle(&e, 0, -i, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, 3, NULL);
  bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  e.scene->particles.velocity[4] = 0.5; /* along itself: taken away at the start */
  time_grid(&e, 0.1, 1, 20);
  test_run(&e);
  assert_true(fabs(test_velocity(&e, 2)[1]) < 1e-12);
  test_advance(&e, 0.1);
  assert_true(fabs(test_position(&e, 2)[1] + 1) < 1e-12 && fabs(test_velocity(&e, 2)[1]) < 1e-12);
  test_engine_close(&e);
}

/* A pendulum that is drawn in and let out, L = 1 + 0.3 sin 2t: the work of its pull is in the energy balance, to the
 * order of rk4. */
static double telescope_drift(size_t steps) {
  test_engine e;
  hk_summary s;
  open(&e, "rk4");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, sin(1.1), -cos(1.1), 0, 0.8);
  e.scene->particles.velocity[3] = 0.6 * sin(1.1); /* J v = -dg/dt: the length begins to grow at 0.6 m/s */
  e.scene->particles.velocity[4] = -0.6 * cos(1.1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *bar = test_plugin(&e, HK_CONSTRAINT, "fixture:telescope");
  test_edges(&e, bar, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, bar, "amplitude", 0.3);
  test_number(&e, bar, "rate", 2);
  time_grid(&e, 2, 1, steps);
  test_run(&e);
  double first = energy(&e);
  test_advance(&e, 2);
  hk_run_summary(e.run, &s);
  assert_true(fabs(distance(&e, 1, 2) - 1 - 0.3 * sin(4)) < 1e-12);
  assert_true(fabs(energy(&e) - first) > 0.1); /* J: it is no small thing */
  test_engine_close(&e);
  return fabs(s.energy_drift);
}

static void a_bar_that_changes_its_length_does_work(void **state) {
  (void)state;
  double coarse = telescope_drift(100), fine = telescope_drift(200);
  assert_true(fine < 1e-6 && log2(coarse / fine) > 3.5);
}

/* ---- what fails says so; counts that change ---- */

static hk_plugin_spec *latches(test_engine *e, const double *from, const double *to) {
  open(e, "rk4");
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1, 0, 0, 1);
  test_particle(e, 2, 0, 0, 1);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *latch = test_plugin(e, HK_CONSTRAINT, "fixture:latch");
  test_edges(e, latch, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2);
  test_list(e, latch, "from", from, 2);
  test_list(e, latch, "to", to, 2);
  return latch;
}

static void a_constraint_that_fails_ends_the_run_with_its_message(void **state) {
  (void)state;
  static const char *const functions[] = {"value", "jacobian", "curvature", "update"};
  for (size_t k = 0; k < 4; k++) {
    test_engine e;
    hk_plugin_spec *latch = latches(&e, (double[]){0, 0}, (double[]){9, 9});
    test_text(&e, latch, "fails", functions[k]);
    test_number(&e, latch, "fails_at", 0.5);
    time_grid(&e, 1, 10, 10);
    test_run(&e);
    assert_int_equal(hk_run_advance(e.run, 1, &e.error), HK_FAILED);
    assert_non_null(strstr(e.error.text, "latch"));
    assert_non_null(strstr(e.error.text, "the latch broke"));
    double t = hk_run_view(e.run)->t;
    assert_true(t > 0.48 && t < 0.52);
    test_engine_close(&e);
  }
}

/* The outer bar acts from 0.2 to 0.4 s: before and after its mass is in free fall, and rk4 is exact for a parabola. The
 * inner one is let go at 0.6 s. */
static void bars_come_and_go_from_step_to_step(void **state) {
  (void)state;
  test_engine e;
  latches(&e, (double[]){0, 0.2}, (double[]){0.6, 0.4});
  time_grid(&e, 1, 10, 20);
  test_run(&e);
  test_advance(&e, 0.2);
  assert_true(fabs(test_position(&e, 3)[1] + g * 0.02) < 1e-12 && fabs(distance(&e, 1, 2) - 1) < 1e-12);
  double length = distance(&e, 2, 3);
  test_advance(&e, 0.4);
  assert_true(fabs(distance(&e, 2, 3) - length) < 1e-11 && fabs(distance(&e, 1, 2) - 1) < 1e-12);
  for (uint32_t id = 3; id >= 2; id--) {
    double t = id == 3 ? 0.4 : 0.6, fall = 1 - t, x[3], v[3];
    test_advance(&e, t);
    memcpy(x, test_position(&e, id), sizeof x);
    memcpy(v, test_velocity(&e, id), sizeof v);
    if (id == 2) {
      test_advance(&e, 1);
      assert_true(fabs(test_position(&e, id)[0] - x[0] - v[0] * fall) < 1e-11);
      assert_true(fabs(test_position(&e, id)[1] - x[1] - v[1] * fall + g * fall * fall / 2) < 1e-11);
    } else {
      test_advance(&e, 0.5);
      assert_true(fabs(test_position(&e, id)[1] - x[1] - v[1] * 0.1 + g * 0.005) < 1e-11);
    }
  }
  test_engine_close(&e);
}

static void lengths_that_cannot_be_met_end_the_run(void **state) {
  (void)state;
  test_engine e;
  open(&e, "leapfrog");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0.5, 0, 1);
  test_particle(&e, 2, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, 3, NULL);
  test_number(&e, bars(&e, (const uint32_t[][2]){{1, 2}, {2, 3}}, 2), "length", 0.5); /* 1 m for a gap of 2 m */
  e.options.dt = 1e-3;
  hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
  if (status == HK_OK) status = hk_run_advance(e.run, 0.1, &e.error);
  assert_int_equal(status, HK_NOT_CONVERGED);
  assert_non_null(strstr(e.error.text, "bar"));
  test_engine_close(&e);
}

static void released_pin_lets_the_pendulum_fall(void **state) {
  (void)state;
  test_engine e;
  uint32_t pivot = 1;
  open(&e, "rk4");
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0, -1, 0, 3);
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &pivot, .release = 0.25};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  bars(&e, (const uint32_t[][2]){{1, 2}}, 1);
  time_grid(&e, 1, 4, 100);
  test_run(&e);
  test_advance(&e, 1);
  double fallen = g * 0.75 * 0.75 / 2; /* rk4 is exact for a parabola */
  assert_true(fabs(test_position(&e, 1)[1] + fallen) < 1e-12 && fabs(test_position(&e, 2)[1] + 1 + fallen) < 1e-12);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pendulum_has_the_period_of_the_elliptic_integral),
      cmocka_unit_test(double_pendulum_keeps_its_energy),
      cmocka_unit_test(bead_on_a_line_carries_a_pendulum),
      cmocka_unit_test(pendulum_in_a_lift_swings_faster),
      cmocka_unit_test(dumbbell_turns_uniformly),
      cmocka_unit_test(long_chain_keeps_its_lengths_and_a_bar_between_pins_is_no_trouble),
      cmocka_unit_test(a_bar_that_is_given_twice_changes_nothing),
      cmocka_unit_test(copies_of_one_bar_fall_together),
      cmocka_unit_test(a_loop_of_bars_that_closes_exactly_keeps_the_order),
      cmocka_unit_test(bars_that_contradict_each_other_are_refused_by_name),
      cmocka_unit_test(a_chain_that_is_stretched_between_pins_stays),
      cmocka_unit_test(a_bar_that_changes_its_length_does_work),
      cmocka_unit_test(a_constraint_that_fails_ends_the_run_with_its_message),
      cmocka_unit_test(bars_come_and_go_from_step_to_step),
      cmocka_unit_test(lengths_that_cannot_be_met_end_the_run),
      cmocka_unit_test(released_pin_lets_the_pendulum_fall),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
