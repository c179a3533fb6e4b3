/* What happens between the evaluations of a function of time is found by random samples, or it is said what was
 * assumed; a function that the run follows is none of it. The functions are those of gravity and of a pin's path. */
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.141592653589793;

typedef struct wave { /* of the first of three numbers */
  double (*at)(const struct wave *, double t);
  double a, b, c;
} wave;

static hk_status call(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                      size_t max_out, size_t *n_out, hk_error *error) {
  const wave *w = f->context;
  (void)caller, (void)n_in, (void)max_out, (void)error;
  memcpy(out, (double[]){w->at(w, in[0]), 0, 0}, 3 * sizeof *out);
  *n_out = 3;
  return HK_OK;
}

typedef struct setting {
  const char *method;
  double dt, end, fastest;
  bool path; /* of a pin, in place of gravity */
} setting;

static hk_sampling sampled(const setting *how, wave *w, double *cuts, size_t *cut_count) {
  test_engine e;
  hk_function f = {.call = call, .context = w};
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 1, 0, 0, 1);
  if (how->path) {
    test_pin(&e, HK_PIN_PATH, 1, NULL);
    e.scene->particles.pin[0].path = f;
    e.scene->particles.pin[0].fastest = how->fastest;
    test_plugin(&e, HK_FORCE, "gravity");
  } else {
    hk_plugin_spec *gravity = test_plugin(&e, HK_FORCE, "gravity");
    test_function(&e, gravity, "g", f);
    gravity->fastest = how->fastest;
  }
  test_plugin(&e, HK_INTEGRATOR, how->method);
  e.scene->duration = how->end;
  e.scene->fps = 60;
  e.options.dt = how->dt;
  test_run(&e);
  test_advance(&e, how->end);
  hk_sampling s = hk_under_sampled(&e.run->loop, NULL, 200000);
  if (cuts) *cut_count = hk_sampling_cuts(&s, cuts, *cut_count);
  s.where = s.where ? "" : NULL; /* it dies with the scene */
  test_engine_close(&e);
  return s;
}

static const setting usual = {"leapfrog", 1.0 / 120, 10, 0, false};

static double pulse(const wave *w, double t) { return t >= w->a && t < w->a + w->b ? w->c : 0; }
static double bump(const wave *w, double t) { return w->c * exp(-(t - w->a) * (t - w->a) / (2 * w->b * w->b)); }
static double sine(const wave *w, double t) { return w->c * sin(2 * pi * w->a * t) + w->b * t; }
static double square(const wave *w, double t) { return fmod(t + w->b, w->a) < w->c * w->a ? 1 : -1; }
static double jump(const wave *w, double t) { return t < w->a ? 1 : t < w->b ? 3 : -2; }
static double corner(const wave *w, double t) { return fabs(t - w->a) + w->b; }
static double bow(const wave *w, double t) { return (t - w->a) * (t - w->a); }

/* Of a hundredth of a step, late in the run, on a slope or not: with twice the longest distance of samples it is hit
 * surely, and then measured to 1e-11 of the run. */
static void a_pulse_is_found_and_measured(void **state) {
  const char *methods[] = {"leapfrog", "rk4", "implicit_midpoint", "bdf2"};
  (void)state;
  for (size_t k = 0; k < 4; k++) {
    setting how = usual;
    double cuts[8];
    size_t count = 8;
    how.method = methods[k];
    wave w = {pulse, 9.8761234, 3e-4, 50};
    hk_sampling s = sampled(&how, &w, cuts, &count);
    assert_true(s.varies && s.pieces >= 1 && !s.more && s.where);
    assert_string_equal(s.name, "g");
    assert_true(s.assumed < 3e-4);
    if (!(fabs(s.shortest - 3e-4) < 1e-9 && fabs(s.begin - w.a) < 1e-9 && fabs(s.end - w.a - w.b) < 1e-9))
      fail_msg("%s: %.12g from %.12g to %.12g", methods[k], s.shortest, s.begin, s.end);
    assert_int_equal(count, 4); /* before and after either jump */
    assert_true(cuts[0] <= w.a && w.a <= cuts[1] && cuts[2] <= w.a + w.b && w.a + w.b <= cuts[3]);
    assert_true(w.a - cuts[0] < 1e-9 && cuts[1] - w.a < 1e-9 && w.a + w.b - cuts[2] < 1e-9 &&
                cuts[3] - w.a - w.b < 1e-9);
    assert_true(s.calls <= 200000);
  }
}

static void what_was_assumed_is_said(void **state) {
  (void)state;
  wave w = {pulse, 7.123456, 1e-5, 50};
  hk_sampling s = sampled(&usual, &w, NULL, NULL);
  assert_true(s.assumed > 1e-5 && s.assumed < 2.1 * 10 / 100000);
  for (int k = 1; k < 6; k++) { /* sure to be found where it is declared, wherever it is */
    setting how = usual;
    how.fastest = 1e-5;
    how.end = 2;
    w.a = 0.0987654321 * k;
    s = sampled(&how, &w, NULL, NULL);
    assert_true(s.varies && s.steps_too_long && !s.too_dear);
    assert_true(s.assumed == 1e-5 && s.declared == 1e-5);
    assert_true(fabs(s.begin - w.a) < 1e-9 && fabs(s.shortest - 1e-5) < 1e-9);
  }
}

static void a_declared_time_that_is_too_short_is_said(void **state) {
  setting how = usual;
  wave w = {sine, 1, 0, 1};
  (void)state;
  how.fastest = 1e-7;
  hk_sampling s = sampled(&how, &w, NULL, NULL);
  assert_true(s.too_dear && !s.varies && s.assumed > 1e-7 && s.assumed < 2.1 * 10 / 2000000);
}

static bool varies(const setting *how, wave w) { return sampled(how, &w, NULL, NULL).varies; }

static void pulses_of_any_shape_are_found(void **state) {
  setting path = usual;
  (void)state;
  path.path = true;
  assert_true(varies(&usual, (wave){bump, 5.0123, 5e-4, 1}));
  assert_true(varies(&usual, (wave){bump, 5.0123, 5e-4, -1e-6}));
  assert_true(varies(&path, (wave){bump, 3.0123, 5e-4, 1e-3}));
  assert_true(varies(&path, (wave){pulse, 3.0123, 1e-3, 1e-3}));
}

/* In phase with the steps, their halves and quarters; at the frequency of the steps and far above. */
static void vibrations_are_found_in_any_phase(void **state) {
  (void)state;
  for (double f = 120; f <= 240 * 960; f *= 2) {
    hk_sampling s = sampled(&usual, &(wave){sine, f, 0.3, 1}, NULL, NULL);
    if (!s.varies) fail_msg("%g Hz", f);
    /* half a period; less where a window has not all of its range, and where samples are a tenth of it apart */
    if (f < 1e3 && !(s.shortest > 0.3 / f && s.shortest < 0.6 / f)) fail_msg("%g Hz: %g s", f, s.shortest);
  }
  assert_true(varies(&usual, (wave){square, 1.0 / 240, 0, 0.5}));
  assert_true(varies(&usual, (wave){square, 1.0 / 120, 0.001, 0.1}));
  assert_true(varies(&(setting){"implicit_midpoint", 1.0 / 60, 10, 0, false}, (wave){sine, 60, 0, 1}));
}

static void what_the_run_follows_is_no_alarm(void **state) {
  (void)state;
  assert_false(varies(&usual, (wave){sine, 0.1, 0, 1}));
  assert_false(varies(&usual, (wave){sine, 1, 5, 1}));
  assert_false(varies(&usual, (wave){sine, 30, 0, 1}));
  assert_false(varies(&usual, (wave){jump, 3.00123, 3.5, 0}));
  assert_false(varies(&usual, (wave){square, 0.5, 0.1, 0.5}));
  assert_false(varies(&usual, (wave){corner, 5.0012, 3, 0}));
  assert_false(varies(&usual, (wave){bow, 5.0012, 0, 0}));
  assert_false(varies(&usual, (wave){bump, 5.0123, 0.05, 1}));
  assert_false(varies(&usual, (wave){sine, 0, 0, 0}));
  assert_false(varies(&(setting){"leapfrog", 1e-4, 2, 0, false}, (wave){sine, 1000, 0, 1}));
  assert_false(varies(&(setting){"dopri5", NAN, 1, 0, false}, (wave){sine, 200, 0, 100}));
  assert_false(varies(&(setting){"leapfrog", 1e-3, 2, 0, true}, (wave){sine, 10, 0, 0.1}));
}

/* Where a particle of 1 m/s ends that gets a pulse: c b more, so that the way is 1 + c b (end - a - b/2). */
static double way_under(const char *method, double dt, const double *cuts, size_t count) {
  test_engine e;
  wave w = {pulse, 0.3003, 4e-4, 1000};
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  e.scene->particles.velocity[0] = 1;
  test_function(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", (hk_function){.call = call, .context = &w});
  test_plugin(&e, HK_INTEGRATOR, method);
  e.scene->duration = 1;
  e.options.dt = dt;
  e.options.cut = cuts;
  e.options.cuts = count;
  e.options.refine = count ? 1 : 0;
  test_run(&e);
  test_advance(&e, 1);
  double way = test_position(&e, 1)[0] - 1;
  if (count) assert_true(e.run->record.dt_min <= 4e-4 / 2);
  test_engine_close(&e);
  return way;
}

/* A second run that is cut there sees it, also one of a method that chooses its steps and passed over it. */
static void a_run_that_is_cut_at_a_pulse_does_not_pass_over_it(void **state) {
  const char *methods[] = {"leapfrog", "implicit_midpoint", "dopri5"};
  double right = 1000 * 4e-4 * (1 - 0.3003 - 2e-4);
  (void)state;
  for (size_t k = 0; k < 3; k++) {
    setting how = {methods[k], k == 2 ? NAN : 1.0 / 120, 1, 0, false};
    double cuts[8];
    size_t count = 8;
    wave w = {pulse, 0.3003, 4e-4, 1000};
    assert_true(sampled(&how, &w, cuts, &count).varies && count == 4);
    assert_true(fabs(way_under(methods[k], how.dt, NULL, 0)) < 0.1 * right);
    double way = way_under(methods[k], how.dt, cuts, count);
    /* the jumps are between cuts 1e-12 s apart */
    if (!(fabs(way - right) < 1e-6 * right)) fail_msg("%s: %g m, right is %g m", methods[k], way, right);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pulse_is_found_and_measured),
      cmocka_unit_test(what_was_assumed_is_said),
      cmocka_unit_test(a_declared_time_that_is_too_short_is_said),
      cmocka_unit_test(pulses_of_any_shape_are_found),
      cmocka_unit_test(vibrations_are_found_in_any_phase),
      cmocka_unit_test(what_the_run_follows_is_no_alarm),
      cmocka_unit_test(a_run_that_is_cut_at_a_pulse_does_not_pass_over_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
