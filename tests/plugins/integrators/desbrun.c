/* Desbrun's method against its formulas written out with a dense inverse, and what it must conserve. Reference:
 * Desbrun, Schroeder and Barr 1999. */
#include "tests/support/engine.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 12, FEW = 6, MOST = 2 * FEW };

static void use(test_engine *e, bool correction) {
  hk_plugin_spec *method = test_plugin(e, HK_INTEGRATOR, "desbrun");
  const hk_param *param = hk_spec_param(method, "correction", &e->error);
  hk_value value = {.kind = HK_VALUE_BOOLEAN, .boolean = correction};
  if (!param || hk_spec_set(method, param, &value, 0, &e->error) != HK_OK) fail_msg("%s", e->error.text);
}

static void steps_of(test_engine *e, double h) {
  e->options.dt = h;
  e->scene->fps = 1 / h;
}

static void springs(test_engine *e, const uint32_t (*edge)[2], size_t count, double k, double damping, double rest) {
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, force, edge, count);
  test_number(e, force, "k", k);
  test_number(e, force, "damping", damping);
  test_number(e, force, "rest", rest);
}

static void velocity(test_engine *e, uint32_t id, double x, double y, double z) {
  memcpy(e->scene->particles.velocity + 3 * (id - 1), (double[]){x, y, z}, 3 * sizeof(double));
}

static void gravity(test_engine *e, double x, double y, double z) {
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", x, y, z);
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53 - 0.5;
}

static double largest(const double *a, const double *b, int count) {
  double most = 0;
  for (int k = 0; k < count; k++) most = fmax(most, fabs(a[k] - b[k]));
  return most;
}

/* ---- the filter ---- */

static const uint32_t few_edges[][2] = {{1, 2}, {2, 3}, {3, 4}, {1, 3}, {2, 4}, {4, 5}, {5, 6}, {1, 6}};
enum { FEW_EDGES = sizeof few_edges / sizeof *few_edges };
static const double few_mass[FEW] = {0.3, 1, 0.5, 2, 0.7, 0.1}, few_k = 300, few_c = 0.4, few_rest = 0.8;

static void few(test_engine *e, double x[3 * FEW], double v[3 * FEW]) {
  uint64_t seed = 5;
  for (int k = 0; k < 3 * FEW; k++) {
    x[k] = 2 * noise(&seed);
    v[k] = 2 * noise(&seed);
  }
  for (int i = 0; i < FEW; i++) {
    uint32_t id = test_particle(e, x[3 * i], x[3 * i + 1], x[3 * i + 2], few_mass[i]);
    velocity(e, id, v[3 * i], v[3 * i + 1], v[3 * i + 2]);
  }
  springs(e, few_edges, FEW_EDGES, few_k, few_c, few_rest);
}

static void eliminate(int n, double A[MOST][MOST], double b[MOST]) {
  for (int i = 0; i < n; i++) /* positive definite: no pivots */
    for (int r = i + 1; r < n; r++) {
      double f = A[r][i] / A[i][i];
      for (int c = i; c < n; c++) A[r][c] -= f * A[i][c];
      b[r] -= f * b[i];
    }
  for (int i = n - 1; i >= 0; i--) {
    for (int c = i + 1; c < n; c++) b[i] -= A[i][c] * b[c];
    b[i] /= A[i][i];
  }
}

/* W = (I - h^2 H M^-1)^-1, column by column; what is `fixed` has M^-1 = 0. */
static void dense_filter(double h, int fixed, double W[FEW][FEW]) {
  for (int column = 0; column < FEW; column++) {
    double A[MOST][MOST] = {{0}}, b[MOST] = {0};
    for (int i = 0; i < FEW; i++) A[i][i] = 1;
    for (int q = 0; q < FEW_EDGES; q++) {
      int i = (int)few_edges[q][0] - 1, j = (int)few_edges[q][1] - 1;
      double k = h * h * few_k, wi = i == fixed ? 0 : 1 / few_mass[i], wj = j == fixed ? 0 : 1 / few_mass[j];
      A[i][i] += k * wi, A[j][j] += k * wj;
      A[i][j] -= k * wj, A[j][i] -= k * wi;
    }
    b[column] = 1;
    eliminate(FEW, A, b);
    for (int i = 0; i < FEW; i++) W[i][column] = b[i];
  }
}

/* The paper's force, with the springs' damping. */
static void forces(double h, const double *x, const double *v, double *F) {
  memset(F, 0, 3 * FEW * sizeof *F);
  for (int q = 0; q < FEW_EDGES; q++) {
    int i = 3 * ((int)few_edges[q][0] - 1), j = 3 * ((int)few_edges[q][1] - 1);
    double d[3], l = 0, along = 0;
    for (int c = 0; c < 3; c++) {
      d[c] = x[j + c] - x[i + c];
      l += d[c] * d[c];
      along += d[c] * (v[j + c] - v[i + c]);
    }
    l = sqrt(l);
    for (int c = 0; c < 3; c++) {
      double f = (few_k * (l - few_rest) + few_c * along / l) * d[c] / l + h * few_k * (v[j + c] - v[i + c]);
      F[i + c] += f;
      F[j + c] -= f;
    }
  }
}

/* 1e-12: a condition number of h^2 k/m = 30 times rounding, of velocities of order 1. */
static void step_applies_the_dense_filter(void **state) {
  (void)state;
  for (int fixed = -1; fixed < 3; fixed++) {
    double x[3 * FEW], v[3 * FEW], F[3 * FEW], W[FEW][FEW], h = 0.1, g[3] = {1, 2, 3};
    test_engine e;
    test_engine_open(&e);
    few(&e, x, v);
    if (fixed >= 0) {
      test_pin(&e, HK_PIN_FIXED, (uint32_t)fixed + 1, NULL);
      memset(v + 3 * fixed, 0, 3 * sizeof *v);
    }
    gravity(&e, g[0], g[1], g[2]);
    use(&e, false);
    steps_of(&e, h);
    test_run(&e);
    test_advance(&e, h);
    dense_filter(h, fixed, W);
    forces(h, x, v, F);
    for (int i = 0; i < FEW; i++)
      for (int c = 0; c < 3; c++) {
        double filtered = 0, sum = 0;
        for (int j = 0; j < FEW; j++) {
          filtered += W[i][j] * F[3 * j + c];
          sum += W[j][i];
        }
        assert_true(fabs(sum - 1) < 1e-13); /* columns for general masses: the total force stays */
        double expected = i == fixed ? 0 : v[3 * i + c] + h * (filtered / few_mass[i] + g[c]);
        double off = fabs(test_velocity(&e, (uint32_t)i + 1)[c] - expected) +
                     fabs(test_position(&e, (uint32_t)i + 1)[c] - x[3 * i + c] - h * expected);
        if (!(off < 1e-12)) fail_msg("fixed %d: particle %d is %g off", fixed, i + 1, off);
      }
    test_engine_close(&e);
  }
}

/* ---- the growth factor ---- */

/* Stretch and speed of a spring between two free masses, one step from (1, 0) and one from (0, 1): its 2 x 2 matrix. */
static double measured_growth(double hw, double hg) {
  double M[2][2], h = 0.5, reduced = 0.75, rest = 1e3;
  for (int column = 0; column < 2; column++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, rest + (column == 0), 0, 0, 3);
    velocity(&e, 2, column, 0, 0);
    springs(&e, (const uint32_t[][2]){{1, 2}}, 1, reduced * hw * hw / (h * h), reduced * hg / h, rest);
    test_plugin(&e, HK_INTEGRATOR, "desbrun");
    steps_of(&e, h);
    test_run(&e);
    test_advance(&e, h);
    M[0][column] = test_position(&e, 2)[0] - test_position(&e, 1)[0] - rest;
    M[1][column] = test_velocity(&e, 2)[0] - test_velocity(&e, 1)[0];
    test_engine_close(&e);
  }
  double half = (M[0][0] + M[1][1]) / 2, det = M[0][0] * M[1][1] - M[0][1] * M[1][0], under = half * half - det;
  return under < 0 ? sqrt(det) : fabs(half) + sqrt(under);
}

/* 1e-6: the stretch is read off lengths of 1e3 m, to 1e-13, and a double root takes the square root of that. */
static void stated_growth_is_the_measured_one(void **state) {
  static const double hw[] = {0.1, 1, 3, 10, 100}, hg[] = {0, 0.3, 3, 50};
  (void)state;
  test_engine e;
  test_engine_open(&e);
  const hk_plugin_spec *spec = test_plugin(&e, HK_INTEGRATOR, "desbrun");
  const hk_integrator *method = spec->plugin->integrator;
  assert_true(method->order == 1 && method->flags == (HK_IMPLICIT | HK_NEEDS_SOLVER));
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < 4; j++) {
      double stated = method->growth(spec->values, NULL, hw[i], hg[j], 0), got = measured_growth(hw[i], hg[j]);
      if (!(fabs(stated - got) < 1e-6 * got))
        fail_msg("hw = %g, hg = %g: states %.9g, measured %.9g", hw[i], hg[j], stated, got);
      if (hg[j] == 0) assert_true(fabs(stated - pow(1 + hw[i] * hw[i], -0.5)) < 1e-12);
    }
  for (double g = 0; g < 10; g += 0.5) assert_true(method->growth(spec->values, NULL, 0, g, 0) >= 1);
  test_engine_close(&e);
}

/* ---- momenta ---- */

typedef struct moments {
  double x[3], p[3], l[3], scale; /* l: about the origin */
} moments;

static moments moments_of(const hk_view *view) {
  moments m = {0};
  double mass = 0;
  for (size_t i = 0; i < view->n; i++) {
    const double *x = view->x + 3 * i, *v = view->v + 3 * i;
    double w = view->model->mass[i];
    if (view->model->pin[i] != HK_FREE) continue;
    mass += w;
    for (int c = 0; c < 3; c++) {
      m.x[c] += w * x[c];
      m.p[c] += w * v[c];
      m.scale += fabs(w * v[c]);
      m.l[c] += w * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
    }
  }
  for (int c = 0; c < 3; c++) m.x[c] /= mass;
  return m;
}

/* A deformed, spinning cloth of random masses, flat or in space, its middle at the origin; its first corner is there
 * when it is to be pinned. */
static void cloth(test_engine *e, double k, double damping, double corner) {
  static uint32_t edge[4 * SIDE * SIDE][2];
  size_t edges = 0;
  uint64_t seed = 7;
  for (int i = 0; i < SIDE * SIDE; i++) {
    double x = 0.1 * (i % SIDE) + 0.01 * noise(&seed) - corner, y = 0.1 * (i / SIDE) + 0.01 * noise(&seed) - corner;
    double z = 0.03 * noise(&seed);
    if (i == 0 && corner == 0) x = y = z = 0;
    uint32_t id = test_particle(e, x, y, z, 1e-2 * (1.5 + noise(&seed)));
    velocity(e, id, -3 * y, 3 * x, 0.2 * noise(&seed) * (i > 0));
  }
  for (uint32_t i = 1; i <= SIDE * SIDE; i++) {
    if (i % SIDE) edge[edges][0] = i, edge[edges++][1] = i + 1;
    if (i + SIDE <= SIDE * SIDE) edge[edges][0] = i, edge[edges++][1] = i + SIDE;
    if (i % SIDE && i + SIDE < SIDE * SIDE) edge[edges][0] = i, edge[edges++][1] = i + SIDE + 1;
  }
  springs(e, (const uint32_t(*)[2])edge, edges, k, damping, 0.1);
}

/* Drifts of linear and angular momentum over 0.5 s of 1/60 s, relative to the sums of their parts. */
static void drift(bool correction, double k, double corner, double *linear, double *angular) {
  test_engine e;
  test_engine_open(&e);
  cloth(&e, k, 0.02, corner);
  if (corner == 0) test_pin(&e, HK_PIN_FIXED, 1, NULL);
  use(&e, correction);
  steps_of(&e, 1.0 / 60);
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  test_advance(&e, 0.5);
  moments after = moments_of(hk_run_view(e.run));
  *linear = largest(before.p, after.p, 3) / before.scale;
  *angular = largest(before.l, after.l, 3) / before.scale;
  test_engine_close(&e);
}

/* 30 steps at h w = 30; the solver's residual is rounding, 1e-16 of forces that change speeds by up to a hundred. */
static void free_body_keeps_both_momenta(void **state) {
  (void)state;
  double linear, angular, uncorrected;
  drift(false, 1e4, 0.55, &linear, &uncorrected);
  assert_true(linear < 1e-12);
  drift(true, 1e4, 0.55, &linear, &angular);
  print_message("drift of angular momentum: %.1e corrected, %.1e without\n", angular, uncorrected);
  assert_true(linear < 1e-12 && angular < 1e-12 && uncorrected > 0.1);
}

/* A body that hangs from one pin turns about it; angular momentum about the pin, the origin, stays. */
static void body_on_one_pin_keeps_its_angular_momentum_about_it(void **state) {
  (void)state;
  double linear, angular, uncorrected;
  drift(false, 1e4, 0, &linear, &uncorrected);
  drift(true, 1e4, 0, &linear, &angular);
  print_message("about a pin: %.1e corrected, %.1e without\n", angular, uncorrected);
  assert_true(angular < 1e-12 && uncorrected > 0.1);
}

/* Pinned at two corners it turns about their line: that component stays; at a third corner off the line none can. */
static void body_on_a_line_of_pins_turns_about_it(void **state) {
  (void)state;
  double component[2][2];
  for (int third = 0; third < 2; third++)
    for (int correction = 0; correction < 2; correction++) {
      test_engine e;
      test_engine_open(&e);
      cloth(&e, 1e4, 0, 0);
      for (size_t i = 0; i < e.scene->particles.n; i++) /* the first row is the axis; the cloth swings about it */
        for (int c = 0; c < 3; c++) {
          double *x = e.scene->particles.position + 3 * i, *v = e.scene->particles.velocity + 3 * i;
          if (i < SIDE && c > 0) x[c] = 0;
          v[c] = c == 2 ? 3 * x[1] : c == 1 ? -3 * x[2] : 0;
        }
      test_pin(&e, HK_PIN_FIXED, 1, NULL);
      test_pin(&e, HK_PIN_FIXED, SIDE, NULL);
      if (third) test_pin(&e, HK_PIN_FIXED, SIDE * SIDE, NULL);
      use(&e, correction);
      steps_of(&e, 1.0 / 60);
      test_run(&e);
      double before = moments_of(hk_run_view(e.run)).l[0];
      test_advance(&e, 0.5);
      component[third][correction] = moments_of(hk_run_view(e.run)).l[0] / before - 1;
      test_engine_close(&e);
    }
  assert_true(fabs(component[0][1]) < 1e-12 && fabs(component[0][0]) > 0.1);
  assert_true(component[1][1] == component[1][0]); /* bit by bit: nothing is corrected */
}

/* All on a line that turns end over end: no inertia about it, and none is divided by. Then a body of one spring, and
 * two particles at one point. */
static void bodies_without_inertia_are_no_trouble(void **state) {
  (void)state;
  test_engine e;
  uint32_t edge[8][2] = {{9, 10}, {11, 12}};
  test_engine_open(&e);
  for (int i = 0; i < 8; i++) velocity(&e, test_particle(&e, 0.1 * i, 0.2 * i, -0.1 * i, 1 + i), 0.2 * i, -0.1 * i, 0);
  for (int i = 0; i < 2; i++) velocity(&e, test_particle(&e, 5, i, 0, 1), i, 0, 0);
  for (int i = 0; i < 2; i++) test_particle(&e, -5, 2, 0, 1);
  for (uint32_t q = 2; q < 8; q++) edge[q][0] = q - 1, edge[q][1] = q;
  springs(&e, (const uint32_t(*)[2])edge, 8, 1e5, 0.1, 0.25);
  use(&e, true);
  steps_of(&e, 1.0 / 60);
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  test_advance(&e, 1);
  moments after = moments_of(hk_run_view(e.run));
  assert_true(largest(before.p, after.p, 3) < 1e-11 * before.scale);
  assert_true(largest(before.l, after.l, 3) < 1e-11 * before.scale * 5); /* levers of 5 m */
  test_engine_close(&e);
}

/* The centre of a falling cloth moves as a point does: x0 + t v0 + t (t + h) g/2. 1e-12: the solver's residual. */
static void centre_falls_as_a_point(void **state) {
  (void)state;
  test_engine e;
  const double g[3] = {1, 2, -9.81}, t = 0.5, h = 1.0 / 60;
  test_engine_open(&e);
  cloth(&e, 1e4, 0.02, 0.55);
  gravity(&e, g[0], g[1], g[2]);
  use(&e, true);
  steps_of(&e, h);
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  double mass = 0;
  for (size_t i = 0; i < hk_run_view(e.run)->n; i++) mass += hk_run_view(e.run)->model->mass[i];
  test_advance(&e, t);
  moments after = moments_of(hk_run_view(e.run));
  for (int c = 0; c < 3; c++) {
    double off = after.x[c] - (before.x[c] + t * before.p[c] / mass + t * (t + h) / 2 * g[c]);
    if (!(fabs(off) < 1e-12)) fail_msg("the centre is %g m off", off);
  }
  test_engine_close(&e);
}

/* ---- stability ---- */

static hk_verdict ends(const char *method, bool correction, double k, double *speed) {
  test_engine e;
  test_engine_open(&e);
  cloth(&e, k, 0, 0);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  test_pin(&e, HK_PIN_FIXED, SIDE, NULL);
  gravity(&e, 0, -9.81, 0);
  if (method)
    test_plugin(&e, HK_INTEGRATOR, method);
  else
    use(&e, correction);
  steps_of(&e, 1.0 / 60);
  test_run(&e);
  hk_status status = hk_run_advance(e.run, 5, &e.error);
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  *speed = 0;
  for (size_t i = 0; i < 3 * hk_run_view(e.run)->n; i++) *speed = fmax(*speed, fabs(hk_run_view(e.run)->v[i]));
  test_engine_close(&e);
  return status == HK_OK ? summary.verdict : HK_DIVERGED;
}

/* h w up to sqrt(8 k/m) h = 50 and 5000, where symplectic Euler ends at 2. No part falls faster than by its height, a
 * swing of 1.6 m: 6 m/s; twice that is more than it can have. */
static void stays_bounded_where_symplectic_euler_diverges(void **state) {
  (void)state;
  double speed;
  for (double k = 1e4; k < 1e9; k *= 1e4) {
    for (int correction = 0; correction < 2; correction++) {
      assert_int_not_equal(ends(NULL, correction, k, &speed), HK_DIVERGED);
      if (!(speed < 12)) fail_msg("k = %g: %g m/s", k, speed);
    }
    assert_int_equal(ends("symplectic_euler", true, k, &speed), HK_DIVERGED);
  }
}

/* ---- pins ---- */

static hk_status swing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                       size_t most, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)most, (void)error;
  for (int c = 0; c < 3; c++) {
    out[c] = c == 0 ? 0.2 * sin(3 * *in) : 0;
    out[3 + c] = c == 0 ? 0.6 * cos(3 * *in) : 0;
  }
  *n_out = 6;
  return HK_OK;
}

/* 1 is fixed, 2 follows a path, 3 slides along (1, 1, 0), 4 in the plane z = 0.1, 5 and 6 are free. */
static void pinned_scene(test_engine *e, const char *method, double damping) {
  const double line[3] = {sqrt(0.5), sqrt(0.5), 0}, plane[3] = {0, 0, 1};
  const uint32_t edge[][2] = {{1, 3}, {2, 3}, {3, 4}, {4, 5}, {5, 6}, {1, 2}, {2, 5}, {1, 6}};
  uint32_t two = 2;
  test_engine_open(e);
  test_particle(e, 0.1, -0.3, 0.7, 0);
  test_particle(e, 1.1, 0.3, 0.1, 1);
  test_particle(e, 0.4, 0.4, 0.3, 0.5);
  test_particle(e, 1.3, -0.4, 0.1, 0.7);
  test_particle(e, 0.6, 0.9, -0.2, 0.4);
  test_particle(e, 0.2, 0.8, 0.6, 0.9);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_pin_spec spec = {.kind = HK_PIN_PATH, .count = 1, .id = &two, .release = INFINITY, .path = {.call = swing}};
  if (hk_scene_add_pin(e->scene, &spec, &e->error) != HK_OK) fail_msg("%s", e->error.text);
  test_pin(e, HK_PIN_LINE, 3, line);
  test_pin(e, HK_PIN_PLANE, 4, plane);
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, force, edge, 8);
  test_number(e, force, "k", 40);
  test_number(e, force, "damping", damping);
  test_number(e, force, "rest", 0.5);
  gravity(e, 1, 0, -9.81);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.4);
  if (method) test_plugin(e, HK_INTEGRATOR, method);
}

static void pins_hold_to_the_last_bit(void **state) {
  (void)state;
  test_engine e;
  pinned_scene(&e, "desbrun", 0.5);
  steps_of(&e, 1.0 / 60);
  test_run(&e);
  for (int k = 1; k <= 60; k++) {
    double t = k / 60.0, off;
    test_advance(&e, t);
    assert_memory_equal(test_position(&e, 1), ((const double[]){0.1, -0.3, 0.7}), 3 * sizeof(double));
    assert_memory_equal(test_velocity(&e, 1), ((const double[]){0, 0, 0}), 3 * sizeof(double));
    assert_memory_equal(test_position(&e, 2), ((const double[]){1.1 + 0.2 * sin(3 * t), 0.3, 0.1}), 3 * sizeof(double));
    assert_memory_equal(test_velocity(&e, 2), ((const double[]){0.6 * cos(3 * t), 0, 0}), 3 * sizeof(double));
    assert_true(test_position(&e, 4)[2] == 0.1 && test_velocity(&e, 4)[2] == 0);
    off = fabs(test_position(&e, 3)[0] - test_position(&e, 3)[1]) + fabs(test_position(&e, 3)[2] - 0.3);
    assert_true(off < 1e-15); /* two roundings of the projection */
  }
  test_engine_close(&e);
}

/* Positions of all and the work after 0.5 s. */
static void outcome(const char *method, double h, double out[19]) {
  test_engine e;
  hk_summary summary;
  pinned_scene(&e, method, 0.5);
  steps_of(&e, h);
  test_run(&e);
  test_advance(&e, 0.5);
  hk_run_summary(e.run, &summary);
  memcpy(out, hk_run_view(e.run)->x, 18 * sizeof *out);
  out[18] = summary.energy_work;
  test_engine_close(&e);
}

/* With pins of every kind, drag and damping, against rk4 at a step with an error below 1e-9. The viscosity h H v makes
 * the next term of the expansion large: h T k/m, a tenth at these steps. */
static void order_is_one_in_position_and_work(void **state) {
  (void)state;
  double exact[19], coarse[19], fine[19];
  outcome("rk4", 1e-3, exact);
  outcome("desbrun", 5e-4, coarse);
  outcome("desbrun", 2.5e-4, fine);
  double position = log2(largest(coarse, exact, 18) / largest(fine, exact, 18));
  double work = log2(fabs(coarse[18] - exact[18]) / fabs(fine[18] - exact[18]));
  print_message("order %.2f, of the work %.2f (error %.1e of %.1e J)\n", position, work, fine[18] - exact[18],
                exact[18]);
  assert_true(fabs(exact[18]) > 0.1 && fabs(position - 1) < 0.1 && fabs(work - 1) < 0.1);
}

/* ---- the factorization, failures ---- */

/* Once in a run of equal steps; again for a force that sets in, and for particles of a pin that is released. */
static void factorizes_once_while_nothing_changes(void **state) {
  (void)state;
  for (int events = 0; events < 2; events++) {
    test_engine e;
    hk_summary summary;
    test_engine_open(&e);
    cloth(&e, 1e4, 0.02, 0);
    uint32_t one = 1;
    hk_pin_spec spec = {.kind = HK_PIN_FIXED, .count = 1, .id = &one, .release = events ? 0.25 : INFINITY};
    if (hk_scene_add_pin(e.scene, &spec, &e.error) != HK_OK) fail_msg("%s", e.error.text);
    springs(&e, (const uint32_t[][2]){{1, SIDE}}, 1, 100, 0, 1);
    if (events) e.scene->plugin[HK_FORCE].item[1]->from = 0.5;
    use(&e, true);
    steps_of(&e, 1.0 / 64);
    test_run(&e);
    test_advance(&e, 1);
    hk_run_summary(e.run, &summary);
    assert_int_equal(summary.factorizations, events ? 3 : 1);
    test_engine_close(&e);
  }
}

/* Sources renumber the particles: of five in a row the first two die, strangers are born, and the other three go on as
 * if there were no others. 1e-12: the others change the order of the elimination. */
static void springs_follow_births_and_deaths(void **state) {
  double with[9], without[9];
  (void)state;
  for (int alone = 0; alone < 2; alone++) {
    test_engine e;
    const uint32_t pair[2][2] = {{3, 4}, {4, 5}};
    test_engine_open(&e);
    for (int i = 0; i < 5; i++) test_particle(&e, i * 1.5, 0.1 * i * i, 0, 1 + i);
    hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "springs");
    test_edges(&e, force, pair, 2);
    test_number(&e, force, "k", 500);
    test_number(&e, force, "rest", 1);
    if (!alone) {
      hk_plugin_spec *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
      test_number(&e, emitter, "every", 0.1);
      test_number(&e, emitter, "lifetime", 0.3);
    }
    use(&e, true);
    steps_of(&e, 1.0 / 64);
    test_run(&e);
    test_advance(&e, 0.75);
    assert_int_equal(hk_run_view(e.run)->n, alone ? 5 : 5 + 8 - 2);
    for (uint32_t i = 0; i < 3; i++)
      memcpy((alone ? without : with) + 3 * i, test_position(&e, 3 + i), 3 * sizeof *with);
    test_engine_close(&e);
  }
  assert_true(largest(with, without, 9) < 1e-12);
}

static hk_status failing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                         size_t most, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)most;
  if (*in > 0.108) return hk_error_set(error, HK_SCRIPT, "no gravity at %g", *in);
  out[0] = out[1] = 0, out[2] = -9.81;
  *n_out = 3;
  return HK_OK;
}

static void failed_step_leaves_the_state_as_it_was(void **state) {
  (void)state;
  test_engine e;
  double x[6], v[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0.5, 0, 2);
  springs(&e, (const uint32_t[][2]){{1, 2}}, 1, 1000, 1, 1);
  hk_plugin_spec *g = test_plugin(&e, HK_FORCE, "gravity");
  hk_value function = {.kind = HK_VALUE_FUNCTION, .function = {.call = failing}};
  assert_int_equal(hk_spec_set(g, hk_spec_param(g, "g", &e.error), &function, 2, &e.error), HK_OK);
  use(&e, true);
  steps_of(&e, 0.1);
  test_run(&e);
  test_advance(&e, 0.1);
  test_advance(&e, 0.2);
  memcpy(x, hk_run_view(e.run)->x, sizeof x);
  memcpy(v, hk_run_view(e.run)->v, sizeof v);
  assert_int_equal(hk_run_advance(e.run, 0.3, &e.error), HK_SCRIPT);
  assert_memory_equal(x, hk_run_view(e.run)->x, sizeof x);
  assert_memory_equal(v, hk_run_view(e.run)->v, sizeof v);
  test_engine_close(&e);
}

static void at_rest(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                    double *dy) {
  (void)context, (void)t, (void)x, (void)v, (void)y, (void)a, (void)dy;
}

static void internal_force_without_elements_is_refused_by_name(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){2, 0, 0, at_rest, NULL});
  const hk_force_info force[] = {
      {.label = "springs", .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM, .elements = true},
      {.label = "field", .flags = HK_DEPENDS_ON_X},
      {.label = "glue", .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM}};
  bool takes[] = {true, true, true};
  f->split = (hk_split_table){.forces = 3, .force = force, .takes = takes, .takes_channels = true};
  fake_method m = fake_method_open("desbrun", f);
  assert_int_equal(fake_method_step(&m, 0.1, NULL), HK_FAILED);
  assert_non_null(strstr(f->message, "'glue'"));
  assert_non_null(strstr(f->message, "backward_euler"));
  assert_true(!takes[0] && takes[1]); /* springs are the method's own, a field is evaluated */
  fake_method_close(&m);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(step_applies_the_dense_filter),
      cmocka_unit_test(stated_growth_is_the_measured_one),
      cmocka_unit_test(free_body_keeps_both_momenta),
      cmocka_unit_test(body_on_one_pin_keeps_its_angular_momentum_about_it),
      cmocka_unit_test(body_on_a_line_of_pins_turns_about_it),
      cmocka_unit_test(bodies_without_inertia_are_no_trouble),
      cmocka_unit_test(centre_falls_as_a_point),
      cmocka_unit_test(stays_bounded_where_symplectic_euler_diverges),
      cmocka_unit_test(pins_hold_to_the_last_bit),
      cmocka_unit_test(order_is_one_in_position_and_work),
      cmocka_unit_test(factorizes_once_while_nothing_changes),
      cmocka_unit_test(springs_follow_births_and_deaths),
      cmocka_unit_test(failed_step_leaves_the_state_as_it_was),
      cmocka_unit_test(internal_force_without_elements_is_refused_by_name),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
