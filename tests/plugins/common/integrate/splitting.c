/* Splitting methods in scenes with constraints, as compositions of RATTLE: order, energy, the way back, what is left of
 * the constraints. The references are in angles and share no code with hooke. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 5, REFERENCE_STEPS = 20000 };
static const double gravity = 9.81, length = 0.7;

/* ---- chains of bars of equal lengths and weights below a pin, in the angles from the vertical ---- */

/* sum_j w_ij (cos(p_i - p_j) p_j'' + sin(p_i - p_j) p_j'^2) = -w_ii g/L sin p_i, w_ij the weights below both i and j;
 * the gravity of a pin that is accelerated is another one, (gx, -gy). */
static void chain_slope(int n, const double g[2], const double *X, double *dX) {
  double A[MOST][MOST], b[MOST];
  for (int i = 0; i < n; i++) {
    b[i] = (n - i) * (g[0] * cos(X[i]) - g[1] * sin(X[i])) / length;
    for (int j = 0; j < n; j++) {
      double w = n - (i > j ? i : j);
      A[i][j] = w * cos(X[i] - X[j]);
      b[i] -= w * sin(X[i] - X[j]) * X[n + j] * X[n + j];
    }
  }
  for (int k = 0; k < n; k++)
    for (int r = k + 1; r < n; r++) {
      double factor = A[r][k] / A[k][k];
      for (int c = k; c < n; c++) A[r][c] -= factor * A[k][c];
      b[r] -= factor * b[k];
    }
  for (int k = n - 1; k >= 0; k--) {
    for (int c = k + 1; c < n; c++) b[k] -= A[k][c] * dX[n + c];
    dX[n + k] = b[k] / A[k][k];
    dX[k] = X[n + k];
  }
}

/* By the classical method of Runge and Kutta, right to 1e-13 here. */
static void reference(int n, const double g[2], double T, double *X) {
  static const double c[4] = {0, 0.5, 0.5, 1}, w[4] = {1, 2, 2, 1};
  double h = T / REFERENCE_STEPS, k[4][2 * MOST], at[2 * MOST];
  for (int step = 0; step < REFERENCE_STEPS; step++) {
    for (int s = 0; s < 4; s++) {
      for (int e = 0; e < 2 * n; e++) at[e] = X[e] + (s ? h * c[s] * k[s - 1][e] : 0);
      chain_slope(n, g, at, k[s]);
    }
    for (int s = 0; s < 4; s++)
      for (int e = 0; e < 2 * n; e++) X[e] += h / 6 * w[s] * k[s][e];
  }
}

static double start_angle(int i) { return 0.9 + 0.35 * i - 0.12 * i * i; }

static const double lift[3] = {0.8, 1.7, 0}; /* m/s^2, of the pin that moves */

static hk_status path(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  for (int c = 0; c < 3; c++) out[c] = lift[c] * in[0] * in[0] / 2, out[3 + c] = lift[c] * in[0];
  *n_out = 6;
  return HK_OK;
}

static void pin(test_engine *e, bool moves) {
  uint32_t pivot = 1;
  hk_pin_spec spec = {.kind = HK_PIN_PATH, .count = 1, .id = &pivot, .release = INFINITY, .path = {.call = path}};
  if (moves)
    assert_int_equal(hk_scene_add_pin(e->scene, &spec, &e->error), HK_OK);
  else
    test_pin(e, HK_PIN_FIXED, 1, NULL);
}

static void open_chain(test_engine *e, const char *method, int n, bool moves, double dt) {
  uint32_t edge[MOST][2];
  double x = 0, y = 0;
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, method);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -gravity, 0);
  test_particle(e, 0, 0, 0, 1);
  for (int i = 0; i < n; i++) {
    x += length * sin(start_angle(i)), y -= length * cos(start_angle(i));
    test_particle(e, x, y, 0, 1.3);
    edge[i][0] = (uint32_t)i + 1, edge[i][1] = (uint32_t)i + 2;
  }
  pin(e, moves);
  hk_plugin_spec *bars = test_plugin(e, HK_CONSTRAINT, "bars");
  test_edges(e, bars, (const uint32_t(*)[2])edge, (size_t)n);
  test_number(e, bars, "length", length);
  e->scene->duration = 1000;
  e->scene->fps = 1 / dt; /* a frame is a step */
  e->options.dt = dt * (1 + 1e-9);
}

/* The largest distance from the reference, which is relative to the pin, and what is left of the constraints. */
static double chain_error(const char *method, int n, bool moves, double T, int steps) {
  double X[2 * MOST] = {0}, at[2] = {0}, worst = 0;
  const double g[2] = {moves ? -lift[0] : 0, gravity + (moves ? lift[1] : 0)};
  test_engine e;
  hk_summary s;
  open_chain(&e, method, n, moves, T / steps);
  test_run(&e);
  test_advance(&e, T);
  for (int i = 0; i < n; i++) X[i] = start_angle(i);
  reference(n, g, T, X);
  const double *pivot = test_position(&e, 1);
  for (int i = 0; i < n; i++) {
    const double *x = test_position(&e, (uint32_t)i + 2);
    at[0] += length * sin(X[i]), at[1] -= length * cos(X[i]);
    worst = fmax(worst, hypot(x[0] - pivot[0] - at[0], x[1] - pivot[1] - at[1]));
  }
  hk_run_summary(e.run, &s);
  assert_int_equal(s.steps, steps);
  assert_true(s.constraint_violation < 1e-13 * (n + 1));
  test_engine_close(&e);
  return worst;
}

typedef struct problem {
  const char *name;
  int n;
  bool moves;
  double T;
  int steps[3]; /* of leapfrog, blanes_moan and kahan_li8 */
} problem;

static const struct method {
  const char *name;
  int order;
} methods[] = {{"leapfrog", 2}, {"blanes_moan", 4}, {"kahan_li8", 8}};

/* 0.3 is what the next term of the error leaves of the order at these steps. */
static void splittings_keep_their_order_on_chains_of_bars(void **state) {
  static const problem problems[] = {
      {"double pendulum", 2, false, 1, {400, 100, 25}},
      {"double pendulum on a moving pin", 2, true, 1, {400, 100, 25}},
      {"five bars", 5, false, 0.6, {400, 100, 20}}}; /* an error of 7e-14 in 50 is the reference's */
  (void)state;
  for (size_t p = 0; p < sizeof problems / sizeof *problems; p++)
    for (size_t k = 0; k < 3; k++) {
      const problem *q = &problems[p];
      double coarse = chain_error(methods[k].name, q->n, q->moves, q->T, q->steps[k]);
      double fine = chain_error(methods[k].name, q->n, q->moves, q->T, 2 * q->steps[k]), order = log2(coarse / fine);
      print_message("%-12s %-32s order %.2f, error %.1e\n", methods[k].name, q->name, order, fine);
      if (!(order > methods[k].order - 0.3)) fail_msg("%s: order %.2f", methods[k].name, order);
    }
}

/* ---- a bar of length l = 1 + 0.3 sin 2t, in the angle: p'' = -(2 l' p' + g sin p)/l ---- */

static void swing_slope(double t, const double *X, double *dX) {
  double l = 1 + 0.3 * sin(2 * t), speed = 0.6 * cos(2 * t);
  dX[0] = X[1];
  dX[1] = -(2 * speed * X[1] + gravity * sin(X[0])) / l;
}

static double swing_error(const char *method, int steps) {
  static const double c[4] = {0, 0.5, 0.5, 1}, w[4] = {1, 2, 2, 1};
  double T = 1.5, h = T / REFERENCE_STEPS, X[2] = {1.1, 0}, k[4][2];
  for (int step = 0; step < REFERENCE_STEPS; step++) {
    for (int s = 0; s < 4; s++)
      swing_slope((step + c[s]) * h,
                  (double[]){X[0] + (s ? h * c[s] * k[s - 1][0] : 0), X[1] + (s ? h * c[s] * k[s - 1][1] : 0)}, k[s]);
    for (int s = 0; s < 4; s++) X[0] += h / 6 * w[s] * k[s][0], X[1] += h / 6 * w[s] * k[s][1];
  }
  test_engine e;
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, method);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, -gravity, 0);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, sin(1.1), -cos(1.1), 0, 0.8);
  e.scene->particles.velocity[3] = 0.6 * sin(1.1), e.scene->particles.velocity[4] = -0.6 * cos(1.1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *bar = test_plugin(&e, HK_CONSTRAINT, "fixture:telescope");
  test_edges(&e, bar, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(&e, bar, "amplitude", 0.3);
  test_number(&e, bar, "rate", 2);
  e.scene->duration = T;
  e.scene->fps = steps / T;
  e.options.dt = T / steps * (1 + 1e-9);
  test_run(&e);
  test_advance(&e, T);
  const double *x = test_position(&e, 2);
  double l = 1 + 0.3 * sin(2 * T), error = hypot(x[0] - l * sin(X[0]), x[1] + l * cos(X[0]));
  test_engine_close(&e);
  return error;
}

static void splittings_keep_their_order_on_a_bar_that_changes_its_length(void **state) {
  static const int steps[] = {400, 100, 25};
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    double fine = swing_error(methods[k].name, 2 * steps[k]),
           order = log2(swing_error(methods[k].name, steps[k]) / fine);
    print_message("%-12s order %.2f, error %.1e\n", methods[k].name, order, fine);
    if (!(order > methods[k].order - 0.3)) fail_msg("%s: order %.2f", methods[k].name, order);
  }
}

/* ---- what they keep ---- */

/* The energy of a symplectic method swings and does not drift: the largest error of 10,000 steps is that of the first
 * 1,000, up to what a chaotic motion still finds. */
static void the_energy_of_bars_does_not_drift_over_10000_steps(void **state) {
  static const double dt[] = {1.0 / 480, 1.0 / 120, 1.0 / 40}, bound[] = {1e-5, 2e-8, 1e-11};
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    test_engine e;
    hk_summary s;
    double worst[2] = {0}, scale = 0;
    open_chain(&e, methods[k].name, 2, false, dt[k]);
    test_run(&e);
    for (int piece = 1; piece <= 100; piece++) {
      test_advance(&e, 100 * piece * dt[k]);
      hk_run_summary(e.run, &s);
      scale = 1.3 * gravity * 3 * length;
      worst[piece > 10] = fmax(worst[piece > 10], fabs(s.energy_last - s.energy_first) / scale);
    }
    print_message("%-12s energy %.1e in 1,000 steps, %.1e in 10,000; constraints %.1e m\n", methods[k].name, worst[0],
                  worst[1], s.constraint_violation);
    assert_true(worst[1] < 5 * worst[0] && worst[0] < bound[k]);
    assert_true(s.constraint_violation < 1e-13);
    test_engine_close(&e);
  }
}

/* Where a chain of five bars ends that goes on for `steps` from `x` and `v`, which it leaves reversed in time. */
static void go_on(const char *method, int steps, double *x, double *v) {
  const size_t count = 3 * (MOST + 1);
  const double dt = 1.0 / 128;
  test_engine e;
  open_chain(&e, method, MOST, false, dt);
  memcpy(e.scene->particles.position, x, count * sizeof *x);
  memcpy(e.scene->particles.velocity, v, count * sizeof *v);
  test_run(&e);
  test_advance(&e, steps * dt);
  const hk_view *view = hk_run_view(e.run);
  memcpy(x, view->x, count * sizeof *x);
  for (size_t k = 0; k < count; k++) v[k] = -view->v[k];
  test_engine_close(&e);
}

/* Rounding of 1e-16 a step, which the motion of half a second carries on some hundred times. */
static void splittings_return_on_bars_when_velocities_are_reversed(void **state) {
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    double x[3 * (MOST + 1)] = {0}, v[3 * (MOST + 1)] = {0}, begin[3 * (MOST + 1)], worst = 0;
    for (int i = 0; i < MOST; i++) {
      x[3 * i + 3] = x[3 * i] + length * sin(start_angle(i));
      x[3 * i + 4] = x[3 * i + 1] - length * cos(start_angle(i));
    }
    memcpy(begin, x, sizeof x);
    go_on(methods[k].name, 64, x, v);
    double went = fabs(x[3 * MOST] - begin[3 * MOST]);
    go_on(methods[k].name, 64, x, v);
    for (size_t i = 0; i < sizeof x / sizeof *x; i++) worst = fmax(worst, fabs(x[i] - begin[i]));
    print_message("%-12s went %.2g m and came back to %.1e m\n", methods[k].name, went, worst);
    assert_true(went > 0.1 && worst < 1e-12);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(splittings_keep_their_order_on_chains_of_bars),
      cmocka_unit_test(splittings_keep_their_order_on_a_bar_that_changes_its_length),
      cmocka_unit_test(the_energy_of_bars_does_not_drift_over_10000_steps),
      cmocka_unit_test(splittings_return_on_bars_when_velocities_are_reversed),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
