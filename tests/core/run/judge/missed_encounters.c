/* What core/run/judge/missed_encounters.c promises. A particle flies by a centre at the distance b and the speed v, so
 * fast that its path stays straight: F = -GM r/s^3, s^2 = r^2 + softening^2, changes its velocity by 2 GM b/(v (b^2 +
 * softening^2)) (impulse approximation), towards the centre. GM = 1, v = 100, b = 0.01: 2 m/s, of the speed a 50th. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double GM = 1, v = 100, b = 0.01;

typedef struct flyby {
  const char *integrator;
  double dt, end, power, softening;
  double phase;  /* part of its step at which the particle is nearest to the centre */
  size_t others; /* particles far off, at rest */
} flyby;

/* The centre is passed in step number 5, or at the same place in steps of another length. */
static hk_plugin_spec *open_scene(test_engine *e, const flyby *f) {
  test_engine_open(e);
  e->options.compare = HK_COMPARE_ALWAYS;
  test_particle(e, -v * (0.4 + 0.1 * f->phase), b, 0, 2);
  e->scene->particles.velocity[0] = v;
  for (size_t k = 0; k < f->others; k++) test_particle(e, 1e6, (double)k, 0, 1);
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "central");
  test_number(e, force, "strength", GM);
  test_number(e, force, "power", f->power);
  test_number(e, force, "softening", f->softening);
  e->options.integrator = f->integrator;
  e->options.dt = f->dt;
  e->scene->fps = 1;
  e->scene->duration = f->end;
  return force;
}

/* The record at the end; x: where the particle is then. */
static hk_record fly(const flyby *f, double *error, double *x) {
  test_engine e;
  open_scene(&e, f);
  test_run(&e);
  test_advance(&e, f->end);
  hk_record r = e.run->record;
  if (error) *error = hk_missed_encounters_error(&e.run->loop);
  if (x) memcpy(x, test_position(&e, 1), 3 * sizeof *x);
  test_engine_close(&e);
  return r;
}

/* The impulse of F = -GM r s^(power-1) on the whole straight line over mass: with q = (1 - power)/2 the integral of
 * (1 + x^2)^-q is sqrt(pi) Gamma(q - 1/2)/Gamma(q). */
static double impulse(double power, double softening) {
  double q = (1 - power) / 2, s = sqrt(b * b + softening * softening);
  return GM * b / v * pow(s, power) * sqrt(3.14159265358979323846) * tgamma(q - 0.5) / tgamma(q);
}

/* A step of 1,000 b. At an end that is 1 m off, GM/(1 m)^2 = 1 m/s^2 acts along the path for 0.1 s, and nothing on the
 * other side outweighs it: 0.1 m/s across an impulse of 0.4 m/s at least, 3.1 % of the sum. GM is 1 in m^(1-p)/s^2, so
 * the steep powers are strong: they turn the particle back at most. */
static void the_estimate_is_the_impulse(void **state) {
  const double phases[] = {0.1, 0.35, 0.5, 0.9}, softenings[] = {0, 0.003, 0.02}, powers[] = {-2, -3, -7, -12, -20};
  (void)state;
  for (size_t p = 0; p < 5; p++)
    for (size_t k = 0; k < 4; k++)
      for (size_t s = 0; s < 3; s++) {
        flyby f = {"leapfrog", 0.1, 1, powers[p], softenings[s], phases[k], 0};
        double expected = fmin(impulse(powers[p], softenings[s]), 2 * v), found = fly(&f, NULL, NULL).passed_most;
        if (fabs(found / expected - 1) > 0.032)
          fail_msg("power %g, softening %g, phase %g: %.17g instead of %.17g", powers[p], softenings[s], phases[k],
                   found, expected);
      }
}

/* Steps from a tenth of b to 1,000 b, and the shorter ones that a repetition takes (2n + 1 for n). Wherever the run is
 * off by more than a tenth of what the flyby does, the repetition shows it or the estimate does. Where the estimate
 * speaks, it is right within a factor of 2, up to errors of five flybys: beyond, a step ends so near the centre that
 * the path bends at once. The truth is that of the straight path: the deflection is a 50th of the speed. */
static void no_step_hides_the_flyby(void **state) {
  (void)state;
  size_t spoke = 0, agreed = 0;
  for (double n = 10; n < 1e5; n = ceil(1.3 * n))
    for (double phase = 0.05; phase < 1; phase += 0.1) {
      double x[2][3], estimate, whole = impulse(-2, 0) * (0.6 - 0.1 * phase);
      flyby f = {"leapfrog", 1 / n, 1, -2, 0, phase, 0}, half = {"leapfrog", 1 / (2 * n + 1), 1, -2, 0, phase, 0};
      fly(&f, &estimate, x[0]);
      fly(&half, NULL, x[1]);
      double off = hypot(x[0][0] - v * (0.6 - 0.1 * phase), x[0][1] - (b - whole));
      double difference = 2 * hypot(x[0][0] - x[1][0], x[0][1] - x[1][1]);
      if (off > 0.1 * whole && fmax(estimate, difference) < 0.1 * whole)
        fail_msg("n %g, phase %g: %g m off, and %g m is said", n, phase, off, estimate);
      if (off < 5 * whole && estimate > 0 && !(estimate > off / 2 && estimate < 2 * off))
        fail_msg("n %g, phase %g: %g m off, not %g", n, phase, off, estimate);
      if (v / n < 1.9 * b && estimate > 0) fail_msg("n %g, phase %g: a false alarm", n, phase);
      spoke += estimate > 0;
      agreed += difference < 0.1 * whole && off > 0.5 * whole;
    }
  if (spoke < 200 || agreed < 20) fail_msg("%zu estimates, %zu times both runs were wrong", spoke, agreed);
}

static void every_kind_of_method_is_watched(void **state) {
  const char *methods[] = {"leapfrog", "rk4", "stoermer5", "implicit_midpoint", "bdf2", "backward_euler"};
  (void)state;
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    flyby f = {methods[k], 0.1, 1, -2, 0, 0.35, 0};
    double found = fly(&f, NULL, NULL).passed_most, expected = impulse(-2, 0);
    if (fabs(found / expected - 1) > 0.032) fail_msg("%s: %g instead of %g", methods[k], found, expected);
  }
}

/* Particles at rest share the error: it is RMS. */
static void the_error_is_that_of_all_particles(void **state) {
  (void)state;
  double alone, among;
  flyby f = {"leapfrog", 0.1, 1, -2, 0, 0.5, 0};
  fly(&f, &alone, NULL);
  f.others = 99;
  fly(&f, &among, NULL);
  assert_true(fabs(10 * among / alone - 1) < 1e-6); /* the record is a sum of squares: rounding of the many zeros */
}

/* Accelerations that fall with the distance no more are nowhere short; the positions are then no longer kept. */
static void a_long_range_costs_nothing(void **state) {
  (void)state;
  test_engine e;
  flyby f = {"leapfrog", 0.1, 1, 1, 0, 0.5, 0};
  open_scene(&e, &f);
  test_run(&e);
  assert_non_null(e.run->loop.hooks.moved);
  test_advance(&e, 0.15);
  assert_null(e.run->loop.hooks.moved);
  test_engine_close(&e);
}

/* A scene may begin empty, with a source that fills it later. */
static void nobody_passes_by(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  e.options.compare = HK_COMPARE_ALWAYS;
  test_number(&e, test_plugin(&e, HK_SOURCE, "fixture:sower"), "every", 100);
  hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "central");
  test_number(&e, force, "strength", 1);
  test_number(&e, force, "power", -2);
  e.options.dt = 0.1;
  test_run(&e);
  test_advance(&e, 0.3);
  assert_true(hk_missed_encounters_error(&e.run->loop) == 0);
  test_engine_close(&e);
}

/* Kepler, e = 0.9: nearest at 0.1 of the half axis, with 4.36 times the mean speed. At 300 steps an orbit the
 * longest is 0.9 times that distance. (At 150, rk4 loses so much energy that it falls into the centre.) */
static void a_slow_orbit_is_no_flyby(void **state) {
  const char *methods[] = {"leapfrog", "rk4", "implicit_midpoint", "dopri5", "esdirk4"};
  (void)state;
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    test_engine_open(&e);
    e.options.compare = HK_COMPARE_ALWAYS;
    test_particle(&e, 0.1, 0, 0, 1);
    e.scene->particles.velocity[1] = sqrt(1.9 / 0.1);
    hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "central");
    test_number(&e, force, "strength", 1);
    test_number(&e, force, "power", -2);
    e.options.integrator = methods[k];
    if (k < 3) e.options.dt = 6.283185307 / 300;
    e.scene->fps = 1;
    e.scene->duration = 19;
    test_run(&e);
    test_advance(&e, 19);
    if (hk_missed_encounters_error(&e.run->loop) > 0)
      fail_msg("%s: %g m/s at %g s", methods[k], e.run->record.passed_most, e.run->record.passed_at);
    test_engine_close(&e);
  }
}

/* Half way of a run that stops and goes on, the flyby is behind: the verdict knows of it. */
static void a_checkpoint_carries_it(void **state) {
  (void)state;
  test_engine e, on;
  char path[512];
  flyby f = {"leapfrog", 0.1, 1, -2, 0, 0.5, 0};
  snprintf(path, sizeof path, "%s/half.checkpoint", test_folder());
  open_scene(&e, &f);
  test_run(&e);
  test_advance(&e, 0.7);
  assert_int_equal(hk_run_save(e.run, path, &e.error), HK_OK);
  test_advance(&e, 1);
  open_scene(&on, &f);
  on.scene->start_file = strdup(path);
  test_run(&on);
  test_advance(&on, 1);
  assert_memory_equal(e.run->record.passed, on.run->record.passed, sizeof e.run->record.passed);
  assert_true(hk_missed_encounters_error(&on.run->loop) > 0.5 && on.run->record.passed_id == 1);
  test_engine_close(&on);
  test_engine_close(&e);
}

/* A corrector takes back what moves further than 5 m in a step, and so every step of 10 m: the flyby counts once, at
 * one half of it, where its step after all misses as much. */
static void a_step_taken_back_leaves_no_trace(void **state) {
  (void)state;
  test_engine e;
  flyby f = {"leapfrog", 0.1, 1, -2, 0, 0.3, 0};
  open_scene(&e, &f);
  test_number(&e, test_plugin(&e, HK_CORRECTOR, "fixture:rejecter"), "way", 5.5);
  test_run(&e);
  test_advance(&e, 1);
  const hk_record *record = &e.run->record;
  assert_int_equal(record->rejected, 10);
  assert_true(fabs(record->passed_most / impulse(-2, 0) - 1) < 0.01);
  assert_true(record->passed[0] == record->passed_most * record->passed_most);
  test_engine_close(&e);
}

/* ---- pairs: the fluid of tests/fixtures, V = 4 ((1/r)^12 - (1/r)^6) up to 2.5 m with the force shifted to 0 there
 * ---- */

static double pair_force(double r) { return r < 2.5 ? 24 * (2 / pow(r, 13) - 1 / pow(r, 7)) : 0; }

/* The impulse across the straight line at a distance d, by the midpoint rule, with what the shift takes away. */
static double pair_impulse(double d, double speed) {
  double sum = 0, h = 1e-4;
  for (double x = h / 2; d * d + x * x < 2.5 * 2.5; x += h) {
    double r = hypot(d, x);
    sum += 2 * (pair_force(r) - pair_force(2.499999999)) * d / r * h;
  }
  return fabs(sum) / speed;
}

/* One of 1 kg goes by one of 3 kg at rest, in steps of 10 m. The rule of the estimate has its nodes a quarter of the
 * range apart, which at the kink of the cut-off costs less than a hundredth. */
static void both_of_a_pair_are_counted(void **state) {
  const double distances[] = {0.9, 1, 1.5, 2.2};
  (void)state;
  for (size_t k = 0; k < 4; k++) {
    test_engine e;
    test_engine_open(&e);
    e.options.compare = HK_COMPARE_ALWAYS;
    test_particle(&e, 0, distances[k], 0, 3);
    test_particle(&e, -43, 0, 0, 1);
    e.scene->particles.velocity[3] = 100;
    test_number(&e, test_plugin(&e, HK_FORCE, "fixture:lennard_jones"), "courant", 1e6);
    e.options.dt = 0.1;
    e.scene->fps = 1;
    e.scene->duration = 1;
    test_run(&e);
    test_advance(&e, 1);
    const hk_record *record = &e.run->record;
    double expected = pair_impulse(distances[k], 100), both = expected * sqrt((1 + 1.0 / 9) / 2) * 0.5;
    if (fabs(record->passed_most / expected - 1) > 0.01 || record->passed_id != 2)
      fail_msg("at %g m: particle %u, %g instead of %g", distances[k], record->passed_id, record->passed_most,
               expected);
    assert_true(fabs(hk_missed_encounters_error(&e.run->loop) / both - 1) < 0.01);
    test_engine_close(&e);
  }
}

/* ---- the verdict ---- */

static test_result r;

static void judged(const char *dt, const char *further, int code) {
  char scene[1024], arguments[128];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 1, fps = 10, dt = %s }\n"
           "scene:particle { position = {1e3, 0, 0}, mass = 1 }\n"
           "scene:particle { position = {-45, 0.01, 0}, velocity = {100, 0, 0}, mass = 1 }\n"
           "scene:force('central', { strength = 1, power = -2, label = 'star' })\nreturn scene\n",
           dt);
  test_write("scene.lua", scene);
  snprintf(arguments, sizeof arguments, "run scene.lua --json --quiet --no-output %s", further);
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("dt %s %s: exit %d instead of %d: %s%s", dt, further, r.code, code, r.err, r.out);
}

/* 2 m/s for 0.55 s, of one particle of two: 0.78 m. Steps of 10 m and 5 m miss it alike; those of b/2 do not. */
static void a_missed_flyby_is_inaccurate(void **state) {
  (void)state;
  judged("0.1", "--accuracy 0.1", 5);
  assert_non_null(strstr(r.out, "particle 2 passes 'star'"));
  assert_non_null(strstr(r.out, "before t = 0.5 s"));
  assert_true(test_json(r.out, "verify_difference") < 0.01);
  judged("5e-5", "--accuracy 0.1", 0);
}

/* A tenth of the motion of 100 m/s and more is not at stake. */
static void without_an_accuracy_the_motion_is_the_measure(void **state) {
  (void)state;
  judged("0.1", "", 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_estimate_is_the_impulse),
      cmocka_unit_test(no_step_hides_the_flyby),
      cmocka_unit_test(every_kind_of_method_is_watched),
      cmocka_unit_test(the_error_is_that_of_all_particles),
      cmocka_unit_test(a_long_range_costs_nothing),
      cmocka_unit_test(nobody_passes_by),
      cmocka_unit_test(a_slow_orbit_is_no_flyby),
      cmocka_unit_test(a_checkpoint_carries_it),
      cmocka_unit_test(a_step_taken_back_leaves_no_trace),
      cmocka_unit_test(both_of_a_pair_are_counted),
      cmocka_unit_test(a_missed_flyby_is_inaccurate),
      cmocka_unit_test(without_an_accuracy_the_motion_is_the_measure),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
