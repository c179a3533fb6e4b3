/* Births at their times and deaths at theirs, the same for any step, method and number of threads; jets without
 * stripes; shapes and distributions against their means; capacity; what is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e, double rate) {
  test_engine_open(e);
  e->scene->fps = 10;
  hk_plugin_spec *spec = test_plugin(e, HK_SOURCE, "emitter");
  test_number(e, spec, "rate", rate);
  return spec;
}

static const hk_view *view_of(const test_engine *e) { return hk_run_view(e->run); }

/* ---- times ---- */

/* Births at k/rate, k = 0, 1, ...; those of t = 0 are seen after the first step. Deaths a lifetime later. */
static void births_and_deaths_are_at_their_times(void **state) {
  (void)state;
  static const double dts[] = {0.1, 0.03, 1.0 / 240}, rates[] = {0.7, 37, 1000};
  for (size_t d = 0; d < 3; d++)
    for (size_t r = 0; r < 3; r++) {
      test_engine e;
      hk_plugin_spec *spec = open_scene(&e, rates[r]);
      test_number(&e, spec, "lifetime", 0.55);
      test_number(&e, spec, "from", 0.15);
      test_number(&e, spec, "to", 1.45);
      e.options.dt = dts[d];
      e.scene->duration = 3;
      test_run(&e);
      for (int frame = 1; frame <= 30; frame++) {
        double t = frame / 10.0;
        size_t living = 0;
        test_advance(&e, t);
        for (int k = 0; k < 2000; k++) {
          double at = 0.15 + k / rates[r];
          living += at < 1.45 && at <= t && at + 0.55 > t;
        }
        assert_int_equal(view_of(&e)->n, living);
      }
      test_engine_close(&e);
    }
}

/* ---- rates that change ---- */

static double slope, asked_least, asked_most; /* 1/s^2; s, the times that the function was asked for */

static hk_status rising(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                        size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  asked_least = fmin(asked_least, in[0]);
  asked_most = fmax(asked_most, in[0]);
  *out = slope > 0    ? fmax(0, slope * (in[0] - 1))
         : slope == 0 ? 36.7
                      : slope * in[0]; /* from 1 s on; constant; wrong */
  *n_out = 1;
  return HK_OK;
}

static hk_plugin_spec *open_rising(test_engine *e, double of_time, double cell, double dt) {
  hk_plugin_spec *spec = open_scene(e, 5);
  hk_value value = {.kind = HK_VALUE_FUNCTION, .function = {.call = rising}};
  const hk_param *p = hk_spec_param(spec, "rate_of_time", &e->error);
  assert_int_equal(hk_spec_set(spec, p, &value, 0, &e->error), HK_OK);
  test_number(e, spec, "rate_every", cell);
  e->options.dt = dt;
  e->scene->duration = 3;
  slope = of_time;
  asked_least = INFINITY;
  asked_most = -INFINITY;
  return spec;
}

/* rate = a (t - 1) from 1 s on, which is straight where cells end at 1 s: births at 1 + sqrt(2 k/a), whatever the
 * steps; and a function that is constant bears as `rate` does. */
static void births_of_a_rate_that_changes_are_those_of_its_integral(void **state) {
  (void)state;
  static const double dts[] = {0.1, 0.03, 1.0 / 240}, slopes[] = {1.3, 91.7}, cells[] = {0.25, 1e-3, 1};
  for (size_t d = 0; d < 3; d++)
    for (size_t r = 0; r < 3; r++) {
      test_engine e;
      open_rising(&e, r < 2 ? slopes[r] : 0, cells[d], dts[d]);
      test_run(&e);
      for (int frame = 1; frame <= 30; frame++) {
        size_t born = 0;
        test_advance(&e, frame / 10.0);
        for (int k = 0; k < 1000; k++) {
          double at = r < 2 ? 1 + sqrt(2 * k / slopes[r]) : k / 36.7;
          born += at <= frame / 10.0; /* no other birth is at a frame than the first */
        }
        assert_int_equal(view_of(&e)->n, born);
      }
      assert_true(asked_least == 0 && asked_most >= 3 - 1e-9 && asked_most <= 3 + 2 * cells[d] + 1e-9);
      test_engine_close(&e);
    }
}

static void a_rate_below_zero_is_refused(void **state) {
  (void)state;
  test_engine e;
  open_rising(&e, -2, 0.1, 0.05);
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 3, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, "rate_of_time: -0.2 births a second at t = 0.1 s: it has to be 0 at least"))
    fail_msg("%s", e.error.text);
  test_engine_close(&e);
}

/* Everything random, two emitters that take turns, bursts: the same particles at every frame, to the last bit where
 * nothing acts on them but the rounding of their ages. */
static void the_same_particles_for_any_step_method_and_threads(void **state) {
  (void)state;
  static const struct how {
    const char *method;
    double dt;
    int threads;
  } hows[] = {{"leapfrog", 0.1, 1}, {"leapfrog", 0.1, 2}, {"rk4", 1.0 / 130, 1}, {"dopri5", NAN, 2}, {"bdf2", 0.05, 1}};
  double *first = NULL;
  size_t n = 0;
  for (size_t k = 0; k < sizeof hows / sizeof *hows; k++) {
    test_engine e;
    hk_plugin_spec *one = open_scene(&e, 500), *two = test_plugin(&e, HK_SOURCE, "emitter");
    test_text(&e, one, "shape", "ball");
    test_text(&e, one, "distribution", "lognormal");
    test_number(&e, one, "cone", 30);
    test_number(&e, one, "speed_spread", 0.3);
    test_number(&e, one, "lifetime", 0.2);
    test_number(&e, one, "lifetime_spread", 0.9);
    test_number(&e, two, "rate", 333);
    test_number(&e, two, "burst", 20);
    test_list(&e, two, "burst_at", (double[]){0.0312, 0.5, 0.73}, 3);
    test_number(&e, two, "lifetime", 0.003); /* most are born and die within a step */
    test_number(&e, two, "lifetime_spread", 0.5);
    e.options.integrator = hows[k].method;
    e.options.dt = hows[k].dt;
    e.scene->threads = hows[k].threads;
    test_run(&e);
    test_advance(&e, 1);
    const hk_view *view = view_of(&e);
    if (k == 0) {
      n = view->n;
      first = malloc(4 * n * sizeof *first);
      assert_non_null(first);
    }
    assert_int_equal(view->n, n);
    for (size_t i = 0; i < n; i++) {
      const double now[] = {view->model->id[i], view->x[3 * i], view->x[3 * i + 1], view->x[3 * i + 2]};
      if (k == 0) memcpy(first + 4 * i, now, sizeof now);
      assert_true(now[0] == first[4 * i]);
      for (int c = 1; c < 4; c++) assert_true(fabs(now[c] - first[4 * i + c]) < (hows[k].dt == 0.1 ? 1e-300 : 1e-12));
    }
    test_engine_close(&e);
  }
  free(first);
}

/* ---- jets ---- */

/* Particle k is at v (t - k/rate) exactly: steps of 0.1 s move it by rounding, 1e-16 of a metre each. */
static void a_straight_jet_has_no_stripes(void **state) {
  (void)state;
  static const double dts[] = {0.1, 0.0123, 1.0 / 700};
  for (size_t d = 0; d < 3; d++) {
    test_engine e;
    double worst = 0;
    hk_plugin_spec *spec = open_scene(&e, 770);
    test_number(&e, spec, "speed", 3);
    e.options.dt = dts[d];
    test_run(&e);
    test_advance(&e, 1);
    for (size_t i = 0; i < view_of(&e)->n; i++)
      worst = fmax(worst, fabs(view_of(&e)->x[3 * i + 2] - 3 * (1 - (double)i / 770)));
    printf("steps of %.4f s: off by %.2g m\n", dts[d], worst);
    assert_true(view_of(&e)->n == 771 && worst < 1e-13);
    test_engine_close(&e);
  }
}

static const double drag = 2, speed = 4, g = 9.81, w = 7;

static hk_status swing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                       size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  out[0] = out[1] = 0;
  out[2] = -g * cos(w * in[0]);
  *n_out = 3;
  return HK_OK;
}

/* The height at time t of a particle born at `at`, under gravity and drag or under gravity that swings. */
static double height(double t, double at, bool swings) {
  double s = t - at;
  if (swings) return speed * s + g / (w * w) * (cos(w * t) - cos(w * at)) + g / w * s * sin(w * at);
  return (speed + g / drag) * (1 - exp(-drag * s)) / drag - g / drag * s;
}

static double error_of_jet(const char *method, double dt, bool swings) {
  test_engine e;
  double worst = 0;
  test_number(&e, open_scene(&e, 97), "speed", speed);
  hk_plugin_spec *gravity = test_plugin(&e, HK_FORCE, "gravity");
  if (swings)
    test_function(&e, gravity, "g", (hk_function){.call = swing});
  else
    test_number(&e, test_plugin(&e, HK_FORCE, "drag"), "rate", drag);
  e.options.integrator = method;
  e.options.dt = dt;
  test_run(&e);
  test_advance(&e, 0.5);
  for (size_t i = 0; i < view_of(&e)->n; i++)
    worst = fmax(worst, fabs(view_of(&e)->x[3 * i + 2] - height(0.5, (double)i / 97, swings)));
  test_engine_close(&e);
  return worst;
}

/* From h = 1/20 to 1/80, measured to a quarter; births at all times within the steps. */
static void newborns_keep_the_order_of_the_method(void **state) {
  (void)state;
  static const struct method {
    const char *name;
    double order;
  } methods[] = {{"symplectic_euler", 1}, {"leapfrog", 2}, {"implicit_midpoint", 2}, {"rk4", 4}};
  for (size_t k = 0; k < 2 * sizeof methods / sizeof *methods; k++) {
    const struct method *m = &methods[k / 2];
    double coarse = error_of_jet(m->name, 1.0 / 20, k % 2), fine = error_of_jet(m->name, 1.0 / 80, k % 2);
    double order = log2(coarse / fine) / 2;
    printf("%-18s%s error %.3g m at h = 1/80 s, order %.3f\n", m->name, k % 2 ? ", gravity swings:" : "", fine, order);
    assert_true(order > m->order - 0.25);
  }
}

/* A drag 33 times too fast for a step: the newborns fall with g/rate, the oldest and the youngest. */
static void newborns_follow_a_drag_that_the_method_steps_over(void **state) {
  (void)state;
  test_engine e;
  open_scene(&e, 300);
  test_plugin(&e, HK_FORCE, "gravity");
  test_number(&e, test_plugin(&e, HK_FORCE, "drag"), "rate", 1000);
  e.options.integrator = "backward_euler";
  e.options.dt = 1.0 / 30;
  test_run(&e);
  test_advance(&e, 1);
  const hk_view *view = view_of(&e);
  for (size_t i = 0; i < view->n; i++) {
    double s = 1 - (double)i / 300, v = (1 + g / 1000) * exp(-1000 * s) - g / 1000;
    if (s < 1.0 / 30 - 1e-9)
      assert_true(fabs(view->v[3 * i + 2] - v) < 1e-4); /* (1000 h)^4/120 of 1 m/s, h below 0.25/1000 */
    assert_true(view->v[3 * i + 2] < 1 + 1e-15 && view->v[3 * i + 2] > -0.01);
  }
  test_engine_close(&e);
}

/* ---- shapes and distributions ---- */

typedef struct moments {
  double mean[3], square, most, z_most;
} moments;

static moments moments_of(const double *vector, size_t n, const double origin[3]) {
  moments m = {{0}, 0, 0, 0};
  for (size_t i = 0; i < n; i++) {
    double square = 0;
    for (size_t c = 0; c < 3; c++) {
      double d = vector[3 * i + c] - origin[c];
      m.mean[c] += d / (double)n;
      square += d * d;
    }
    m.square += square / (double)n;
    m.most = fmax(m.most, sqrt(square));
    m.z_most = fmax(m.z_most, fabs(vector[3 * i + 2] - origin[2]));
  }
  return m;
}

enum { MANY = 20000 };

/* MANY births at t = 0, at rest; means of MANY numbers are within 4 of their deviations, at most 4/sqrt(MANY) = 0.028
 * of the extent, but for one seed in 10^4. */
static moments places(const char *shape, bool triangles) {
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, 0);
  const double corners[4][3] = {{0, 0, 5}, {3, 0, 5}, {3, 1, 5}, {0, 1, 5}};
  for (int k = 0; k < 4; k++) test_particle(&e, corners[k][0], corners[k][1], corners[k][2], 1);
  test_text(&e, spec, "shape", shape);
  test_number(&e, spec, "burst", MANY);
  test_list(&e, spec, "burst_at", (double[]){0}, 1);
  test_number(&e, spec, "speed", 0);
  test_number(&e, spec, "extent", 2);
  test_vector(&e, spec, "position", 1, 2, 3);
  test_vector(&e, spec, "end", 5, 2, 3);
  if (triangles) test_tuples(&e, spec, "triangles", 3, (const uint32_t[]){1, 2, 3, 1, 3, 4}, 2);
  test_run(&e);
  test_advance(&e, 0.1);
  assert_int_equal(view_of(&e)->n, MANY + 4);
  moments m = moments_of(view_of(&e)->x + 12, MANY, triangles ? corners[0] : (const double[]){1, 2, 3});
  test_engine_close(&e);
  return m;
}

static void near(double value, double wanted, double extent) {
  if (!(fabs(value - wanted) < 4 / sqrt(MANY) * extent)) fail_msg("%g is not near %g", value, wanted);
}

static void shapes_are_uniform(void **state) {
  (void)state;
  moments m = places("point", false);
  assert_true(m.most == 0);
  m = places("line", false); /* of 4 m along x */
  near(m.mean[0], 2, 4);
  near(m.square, 16.0 / 3, 16);
  assert_true(m.most <= 4 && m.z_most == 0);
  m = places("disc", false);
  for (int c = 0; c < 3; c++) near(m.mean[c], 0, 2);
  near(m.square, 2, 4); /* R^2/2 */
  assert_true(m.most <= 2 && m.z_most == 0);
  m = places("sphere", false);
  for (int c = 0; c < 3; c++) near(m.mean[c], 0, 2);
  assert_true(fabs(m.square - 4) < 1e-12);
  m = places("ball", false);
  for (int c = 0; c < 3; c++) near(m.mean[c], 0, 2);
  near(m.square, 4 * 3.0 / 5, 4);
  assert_true(m.most <= 2);
  m = places("triangles", true); /* the rectangle of 3 x 1 m */
  near(m.mean[0], 1.5, 3);
  near(m.mean[1], 0.5, 1);
  near(m.square, (9.0 + 1) / 3, 10);
  assert_true(m.z_most < 1e-14); /* 5 m times weights whose sum is rounded */
}

/* 1000 births on a line of 1 m, or a disc of that radius: of any 100 in a row each tenth of the line has 10 but for 2,
 * and each of ten sectors and of ten rings of equal area 10 but for 5; random ones differ by 3 in the mean, and by 10
 * and more somewhere. */
static void even_places_are_spread_in_turn(void **state) {
  (void)state;
  for (int disc = 0; disc < 2; disc++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, 1000);
    test_text(&e, spec, "shape", disc ? "disc" : "line");
    test_text(&e, spec, "places", "even");
    test_number(&e, spec, "extent", 1);
    test_number(&e, spec, "speed", 0);
    e.scene->duration = 1;
    test_run(&e);
    test_advance(&e, 1);
    for (uint32_t from = 1; from + 100 <= 1000; from += 50) {
      int count[2][10] = {{0}};
      for (uint32_t id = from; id < from + 100; id++) {
        const double *x = test_position(&e, id);
        double part[2] = {x[0], x[0]};
        if (disc) part[0] = x[0] * x[0] + x[1] * x[1], part[1] = atan2(x[1], x[0]) / 6.283185307179586 + 0.5;
        for (int k = 0; k < 2; k++) count[k][(int)fmin(9, 10 * part[k])]++;
      }
      for (int k = 0; k < 20; k++)
        if (abs(count[k / 10][k % 10] - 10) > (disc ? 5 : 2)) fail_msg("%d of 100 in a tenth", count[k / 10][k % 10]);
    }
    test_engine_close(&e);
  }
}

/* In a cone of half-angle a the mean of the cosine is (1 + cos a)/2 by solid angle; the speed is that asked for. */
static void directions_are_uniform_by_solid_angle(void **state) {
  (void)state;
  static const double cones[] = {0, 25, 90, 180};
  for (size_t k = 0; k < 4; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, 0);
    const double axis[3] = {0.6, 0, -0.8};
    test_number(&e, spec, "burst", MANY);
    test_list(&e, spec, "burst_at", (double[]){0}, 1);
    test_number(&e, spec, "speed", 3);
    test_number(&e, spec, "cone", cones[k]);
    test_vector(&e, spec, "direction", 10 * axis[0], 10 * axis[1], 10 * axis[2]);
    test_run(&e);
    test_advance(&e, 0.1);
    double mean[3] = {0}, least = 1, cosine = cos(cones[k] * 3.14159265358979323846 / 180);
    for (size_t i = 0; i < MANY; i++) {
      const double *v = view_of(&e)->v + 3 * i;
      double along = (v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2]) / 3;
      assert_true(fabs(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - 9) < 1e-13);
      for (size_t c = 0; c < 3; c++) mean[c] += v[c] / 3 / MANY;
      least = fmin(least, along);
    }
    assert_true(least > cosine - 1e-15);
    for (size_t c = 0; c < 3; c++) near(mean[c], axis[c] * (1 + cosine) / 2, 1);
    test_engine_close(&e);
  }
}

/* Uniform: value (1 +- spread), of variance (spread value)^2/3; lognormal: of variance (spread value)^2, the mean is
 * the value. The mass of a ball by its radius and density. The variance of a lognormal sample is itself off by its
 * kurtosis: by 5 % with spread 0.5 and MANY numbers. */
static void quantities_have_their_mean_and_spread(void **state) {
  (void)state;
  for (int lognormal = 0; lognormal < 2; lognormal++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, 0);
    const double r0 = 0.01, spread = 0.5, density = 1000;
    assert_int_equal(hk_scene_add_channel(e.scene, "other", 2, (double[]){8, 9}, NAN, NULL, &e.error), HK_OK);
    assert_int_equal(hk_scene_add_channel(e.scene, "radius", 1, (double[]){7}, NAN, NULL, &e.error), HK_OK);
    test_text(&e, spec, "distribution", lognormal ? "lognormal" : "uniform");
    test_number(&e, spec, "burst", MANY);
    test_list(&e, spec, "burst_at", (double[]){0}, 1);
    test_number(&e, spec, "radius", r0);
    test_number(&e, spec, "radius_spread", spread);
    test_number(&e, spec, "density", density);
    test_run(&e);
    test_advance(&e, 0.1);
    const hk_view *view = view_of(&e);
    const double *r = view->y + 2 * view->n;
    double mean = 0, square = 0;
    for (size_t i = 0; i < MANY; i++) {
      mean += r[i] / MANY;
      square += r[i] * r[i] / MANY;
      assert_true(view->y[2 * i] == 8 && view->y[2 * i + 1] == 9); /* the initial value of channels that are not set */
      double mass = 4.0 / 3 * 3.14159265358979 * density * r[i] * r[i] * r[i];
      assert_true(fabs(view->model->mass[i] - mass) < 1e-14 * mass);
      assert_true(lognormal ? r[i] > 0 : fabs(r[i] - r0) <= spread * r0);
    }
    double variance = (square - mean * mean) / (spread * spread * r0 * r0);
    near(mean, r0, spread * r0);
    assert_true(fabs(variance - (lognormal ? 1 : 1.0 / 3)) < 0.05);
    test_engine_close(&e);
  }
}

/* ---- capacity ---- */

/* 10 live for 0.25 s each of 100/s: the first ten are born, then there is room at 0.25 s for one every 0.01 s. With
 * random lifetimes the number is that of a queue followed birth by birth, for any step. */
static void a_full_emitter_bears_when_one_has_died(void **state) {
  (void)state;
  static const double dts[] = {0.1, 0.007, 0.001};
  size_t n[2] = {0};
  for (size_t k = 0; k < 6; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, 100);
    test_number(&e, spec, "lifetime", 0.25);
    test_number(&e, spec, "lifetime_spread", k % 2 ? 0.8 : 0);
    test_number(&e, spec, "capacity", 25);
    test_number(&e, spec, "burst", 100);
    test_list(&e, spec, "burst_at", (double[]){0.111, 0.52}, 2);
    e.options.dt = dts[k / 2];
    test_run(&e);
    test_advance(&e, 1);
    const hk_view *view = view_of(&e);
    if (k < 2) n[k] = view->model->id[view->n - 1];
    assert_int_equal(view->model->id[view->n - 1], n[k % 2]);
    assert_true(view->n <= 25);
    assert_int_equal(e.run->warnings.count, 1);
    assert_non_null(strstr(e.run->warnings.text[0], "its capacity of 25 particles is reached at t = 0.111 s"));
    test_engine_close(&e);
  }
}

/* ---- what is refused ---- */

static void refuses(const char *sentence, void (*set)(test_engine *, hk_plugin_spec *)) {
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, 1000);
  set(&e, spec);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e.error.text);
  test_engine_close(&e);
}

static void too_many(test_engine *e, hk_plugin_spec *spec) {
  test_number(e, spec, "lifetime", 2);
  test_number(e, spec, "capacity", 1999);
}
static void nowhere(test_engine *e, hk_plugin_spec *spec) { test_vector(e, spec, "direction", 0, 0, 0); }
static void no_mesh(test_engine *e, hk_plugin_spec *spec) { test_text(e, spec, "shape", "triangles"); }
static void unknown_channel(test_engine *e, hk_plugin_spec *spec) { test_text(e, spec, "channel", "temperature"); }
static void no_radius(test_engine *e, hk_plugin_spec *spec) { test_number(e, spec, "radius", 1); }
static void only_density(test_engine *e, hk_plugin_spec *spec) { test_number(e, spec, "density", 1); }
static void some_burst(test_engine *e, hk_plugin_spec *spec) { test_number(e, spec, "burst", 5); }
static void ends_first(test_engine *e, hk_plugin_spec *spec) {
  test_number(e, spec, "from", 2);
  test_number(e, spec, "to", 1);
}

static void what_makes_no_sense_is_refused(void **state) {
  (void)state;
  refuses("capacity: 1999 particles are too few for 1000/s that live 2 s, which are 2000", too_many);
  refuses("direction: must not be zero", nowhere);
  refuses("shape 'triangles' needs triangles of particles", no_mesh);
  refuses("channel: the scene has no channel 'temperature'", unknown_channel);
  refuses("radius: the scene has no channel 'radius'", no_radius);
  refuses("density: the mass follows from a radius", only_density);
  refuses("burst: when?", some_burst);
  refuses("to: 1 s is not after from: 2 s", ends_first);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(births_and_deaths_are_at_their_times),
      cmocka_unit_test(births_of_a_rate_that_changes_are_those_of_its_integral),
      cmocka_unit_test(a_rate_below_zero_is_refused),
      cmocka_unit_test(the_same_particles_for_any_step_method_and_threads),
      cmocka_unit_test(a_straight_jet_has_no_stripes),
      cmocka_unit_test(newborns_keep_the_order_of_the_method),
      cmocka_unit_test(newborns_follow_a_drag_that_the_method_steps_over),
      cmocka_unit_test(shapes_are_uniform),
      cmocka_unit_test(even_places_are_spread_in_turn),
      cmocka_unit_test(directions_are_uniform_by_solid_angle),
      cmocka_unit_test(quantities_have_their_mean_and_spread),
      cmocka_unit_test(a_full_emitter_bears_when_one_has_died),
      cmocka_unit_test(what_makes_no_sense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
