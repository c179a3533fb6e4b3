/* Bars that melt: what hangs on them falls when the channel says, from the link that says so, and the others hold. */
#include "tests/support/melting.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { LINKS = 4 };

static const double g = 10, melts = 270, growth = 40, dt = 1e-3; /* m/s^2; K; K/s; s */

/* A chain of bars of 1 m that hangs from particle 1; particle k is at T[k] K at the start and warms. */
static hk_plugin_spec *chain(test_engine *e, uint32_t links, const double *T) {
  uint32_t edge[LINKS][2];
  test_engine_open(e);
  melting_channel(e, 0);
  for (uint32_t k = 0; k <= links; k++) {
    uint32_t id = test_particle(e, 0, 0, -(double)k, 1);
    assert_int_equal(hk_scene_set_channel(e->scene, "temperature", id, &T[k], 1, &e->error), HK_OK);
    if (k < links) edge[k][0] = id, edge[k][1] = id + 1;
  }
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -g);
  melting_warms(e, growth);
  hk_plugin_spec *spec = test_plugin(e, HK_CONSTRAINT, "melting_bars");
  test_edges(e, spec, (const uint32_t(*)[2])edge, links);
  test_text(e, spec, "channel", "temperature");
  test_number(e, spec, "melts", melts);
  e->options.integrator = "leapfrog";
  e->options.dt = dt;
  e->scene->fps = 100;
  e->scene->duration = 10;
  return spec;
}

static double length(test_engine *e, uint32_t k) { return test_position(e, k)[2] - test_position(e, k + 1)[2]; }

/* One bar, from 250 and 254 K: the mean has come to 270 K after 0.45 s, known to a step. */
static void a_weight_falls_when_its_bar_melts(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  const double end = 1, fall = end - 0.45;
  chain(&e, 1, (double[]){250, 254});
  test_run(&e);
  test_advance(&e, 0.45 - 2 * dt);
  assert_true(fabs(length(&e, 1) - 1) < 1e-12);
  test_advance(&e, end);
  double fell = length(&e, 1) - 1, exact = g * fall * fall / 2;
  if (!(fabs(fell - exact) < g * fall * 1.01 * dt)) fail_msg("%g m of %g m", fell, exact);
  hk_run_summary(e.run, &s);
  assert_true(fabs(s.energy_drift) < 1e-9);
  test_engine_close(&e);
}

/* The third of four is the first to be warm enough: by its ends' mean, not by one end. After 0.2 s it is gone; the two
 * below fall together, and all others keep their lengths until theirs come. */
static void the_warmest_link_fails_alone(void **state) {
  (void)state;
  test_engine e;
  const double T[] = {250, 200, 260, 264, 250}, t = 0.3, fall = t - 0.2;
  chain(&e, LINKS, T);
  test_run(&e);
  test_advance(&e, t);
  for (uint32_t k = 1; k <= LINKS; k++) {
    double exact = k == 3 ? g * fall * fall / 2 : 0;
    if (!(fabs(length(&e, k) - 1 - exact) < (k == 3 ? g * fall * 1.01 * dt : 1e-12)))
      fail_msg("link %u: %g m", (unsigned)k, length(&e, k));
  }
  test_engine_close(&e);
}

/* It is gone from the start on, and stays so when it cools. */
static void what_is_warm_at_the_start_never_holds(void **state) {
  (void)state;
  test_engine e;
  chain(&e, 1, (double[]){270, 270});
  test_run(&e);
  test_advance(&e, 0.5);
  assert_true(fabs(length(&e, 1) - 1 - g / 8) < 1e-12);
  test_engine_close(&e);
}

static size_t joined(test_engine *e) { return hk_run_view(e->run)->model->join[0]->count; }

/* A chain of four hanging bars and particles of 1 kg: bar k bears (5 - k) m g = 10 (5 - k) N. Of the limits that two
 * bars exceed, 0.9 and 0.75 of their tensions, that of the second is exceeded more: it breaks alone and at once, and
 * what the others bear then is nothing more than before. */
static void the_bar_that_is_overloaded_most_breaks(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = chain(&e, LINKS, (double[]){0, 0, 0, 0, 0});
  test_list(&e, spec, "breaking", (double[]){36, 22.5, 21, 11}, LINKS);
  test_run(&e);
  test_advance(&e, 0.1);
  for (uint32_t k = 1; k <= LINKS; k++) {
    double exact = k == 2 ? g * 0.1 * 0.1 / 2 : 0;
    if (!(fabs(length(&e, k) - 1 - exact) < 1e-9)) fail_msg("bar %u: %.12g m", (unsigned)k, length(&e, k));
  }
  assert_int_equal(joined(&e), LINKS - 1);
  test_engine_close(&e);
}

/* A pendulum of 1 m let go level bears 3 m g cos a, a the angle from below, of which 24 N are reached after
 * integral da'/sqrt(2 g cos a') from acos 0.8 to pi/2. It flies on along its tangent. */
static void a_swinging_weight_breaks_its_bar(void **state) {
  (void)state;
  test_engine e;
  const double limit = 24, c = limit / (3 * g), speed = sqrt(2 * g * c);
  test_number(&e, chain(&e, 1, (double[]){0, 0}), "breaking", limit);
  e.scene->particles.position[3] = 1, e.scene->particles.position[5] = 0;
  test_run(&e);
  double t = 0, a = acos(c), step = 1e-5; /* with a = pi/2 - s^2 the integral has no singular end */
  for (double s = step / 2, end = sqrt(acos(0) - a); s < end; s += step) t += 2 * s * step / sqrt(2 * g * sin(s * s));
  test_advance(&e, t - 2 * dt);
  assert_int_equal(joined(&e), 1);
  test_advance(&e, t + 2 * dt);
  assert_int_equal(joined(&e), 0);
  const double *v = test_velocity(&e, 2);
  if (!(fabs(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) - speed) < 3 * g * dt)) fail_msg("%g, %g m/s", v[0], v[2]);
  assert_true(fabs(v[0] + speed * c) < 3 * g * dt); /* towards the middle */
  test_engine_close(&e);
}

/* Below the limit nothing breaks, and what breaks and what melts are two things. */
static void bars_hold_below_their_limit_until_they_melt(void **state) {
  (void)state;
  test_engine e;
  test_number(&e, chain(&e, 1, (double[]){250, 254}), "breaking", 1.001 * g);
  test_run(&e);
  test_advance(&e, 0.44);
  assert_true(fabs(length(&e, 1) - 1) < 1e-12);
  test_advance(&e, 0.5);
  assert_true(length(&e, 1) > 1.005);
  test_engine_close(&e);
}

static void no_channel_is_refused(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = chain(&e, 1, (double[]){0, 0});
  melting_needs_its_channel(&e, spec);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_weight_falls_when_its_bar_melts),
      cmocka_unit_test(the_warmest_link_fails_alone),
      cmocka_unit_test(what_is_warm_at_the_start_never_holds),
      cmocka_unit_test(the_bar_that_is_overloaded_most_breaks),
      cmocka_unit_test(a_swinging_weight_breaks_its_bar),
      cmocka_unit_test(bars_hold_below_their_limit_until_they_melt),
      cmocka_unit_test(no_channel_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
