/* Grains and walls (soft_spheres, soft_walls) against closed forms: collisions, sticking, sliding and rolling; what a
 * contact remembers through searches, births, deaths and checkpoints; momenta, threads. */
#include "core/numerics/step_choice/step_choice.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double G = 9.81, R = 0.1, K = 1e4; /* m/s^2, m, N/m */

static hk_plugin_spec *grains(test_engine *e, const char *name, double restitution, double friction) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, name);
  test_number(e, spec, "radius", R);
  test_number(e, spec, "stiffness", K);
  test_number(e, spec, "restitution", restitution);
  test_number(e, spec, "friction", friction);
  return spec;
}

static void add_spin(test_engine *e, hk_plugin_spec *spec) {
  const double none[3] = {0};
  bool there = false;
  for (size_t k = 0; k < e->scene->particles.channels; k++)
    there |= strcmp(e->scene->particles.channel[k].name, "spin") == 0;
  if (!there) assert_int_equal(hk_scene_add_channel(e->scene, "spin", 3, none, NAN, NULL, &e->error), HK_OK);
  test_text(e, spec, "spin", "spin");
}

static void launch(test_engine *e, uint32_t id, double x, double y, double z) {
  double *v = e->scene->particles.velocity + 3 * (size_t)(id - 1);
  v[0] = x, v[1] = y, v[2] = z;
}

/* Every step is a frame. */
static void run_steps(test_engine *e, double dt) {
  e->options.dt = dt;
  e->scene->fps = 1 / dt;
  e->scene->duration = 1e6 * dt;
  test_run(e);
}

/* ---- collisions ---- */

/* Spheres of m and 2m meet with 1 m/s: the effective mass is 2m/3. The force begins with a jump, which a step sees up
 * to h too late: relative errors of z w h, here 1e-3 z; the end of the contact is between two looks. */
static void a_collision_has_its_restitution_and_duration(void **state) {
  (void)state;
  const double wanted[] = {1, 0.9, 0.5, 0.1, 0.02};
  for (size_t k = 0; k < sizeof wanted / sizeof *wanted; k++) {
    test_engine e;
    double w = sqrt(K / (2. / 3)), dt = 1e-3 / w, touch_end = 0;
    test_engine_open(&e);
    launch(&e, test_particle(&e, 0, 0, 0, 1), 1, 0, 0);
    test_particle(&e, 2 * R * (1 + 1e-12), 0, 0, 2);
    hk_plugin_spec *spec = grains(&e, "soft_spheres", wanted[k], 0.5);
    run_steps(&e, dt);
    hk_instance *force = test_instance(&e, spec);
    for (int step = 1; step <= 6000; step += 20) { /* pi/1e-3 steps without damping, more with it */
      double F[6];
      test_advance(&e, step * dt);
      hk_view view = force_view(&e, force);
      force_evaluate(force, &view, F);
      if (F[0] < 0) touch_end = step * dt;
    }
    double e_measured = test_velocity(&e, 2)[0] - test_velocity(&e, 1)[0];
    double z = 0, low = 0, high = 10; /* e = exp(-2 z acos(z)/sqrt(1 - z^2)), by bisection over both branches */
    for (int b = 0; b < 200; b++) {
      z = (low + high) / 2;
      double s = z < 1 ? acos(z) / sqrt(1 - z * z) : acosh(z) / sqrt(z * z - 1);
      *(exp(-2 * z * s) > wanted[k] ? &low : &high) = z;
    }
    double duration = 2 * (z < 1 ? acos(z) / sqrt(1 - z * z) : acosh(z) / sqrt(z * z - 1)) / w;
    if (!(fabs(e_measured - wanted[k]) < 5e-3 * (1 + z)))
      fail_msg("restitution %g instead of %g", e_measured, wanted[k]);
    if (duration < 6000 * dt && !(fabs(touch_end - duration) < 21 * dt))
      fail_msg("restitution %g: contact of %g s instead of %g s", wanted[k], touch_end, duration);
    test_engine_close(&e);
  }
}

/* A fast grazing blow slips all the time: the impulse across the normal is mu times that along it, (1 + e) m v. */
static void a_grazing_blow_gives_the_impulse_of_friction(void **state) {
  (void)state;
  test_engine e;
  double mu = 0.3, restitution = 0.6, dt = 1e-6;
  test_engine_open(&e);
  launch(&e, test_particle(&e, 0, 0, R * (1 + 1e-12), 1), 10, 0, -1);
  grains(&e, "soft_walls", restitution, mu);
  run_steps(&e, dt);
  test_advance(&e, 0.04);
  const double *v = test_velocity(&e, 1);
  assert_true(fabs(v[2] - restitution) < 1e-3);
  assert_true(fabs(10 - v[0] - mu * (1 + restitution)) < 1e-3); /* as above, h w = 1e-4 */
  test_engine_close(&e);
}

/* The energy of the springs and what dashpots and friction took make up what was there; order 1 where forces jump. */
static void what_dashpots_and_friction_take_is_accounted_for(void **state) {
  (void)state;
  for (int turning = 0; turning < 2; turning++) {
    double drift[2];
    for (int half = 0; half < 2; half++) {
      test_engine e;
      hk_summary s;
      test_engine_open(&e);
      e.scene->fps = 100;
      launch(&e, test_particle(&e, 0, 0, 0, 1), 2, 0.5, 0);
      launch(&e, test_particle(&e, 0.21, 0.07, 0.05, 2), -1, 0, 0.3);
      hk_plugin_spec *spec = grains(&e, "soft_spheres", 0.5, 0.4);
      if (turning) add_spin(&e, spec);
      e.options.dt = half ? 1e-5 : 4e-5;
      e.scene->duration = 0.1;
      test_run(&e);
      test_advance(&e, 0.1);
      hk_run_summary(e.run, &s);
      drift[half] = fabs(s.energy_last - s.energy_work - s.energy_first) / s.energy_first;
      assert_true(s.energy_work < -0.1 * s.energy_first);
      test_engine_close(&e);
    }
    if (!(drift[0] < 1e-3 && drift[1] < drift[0] / 2)) fail_msg("turning %d: %g, then %g", turning, drift[0], drift[1]);
  }
}

/* ---- friction ---- */

static void tilt(test_engine *e, double slope) {
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", G * sin(slope), 0, -G * cos(slope));
}

/* On a plane at the angle a a sphere that does not turn stays where tan a < mu, held by the tangential spring, and
 * slides with g (sin a - mu cos a) where tan a > mu. It starts at its overlap, so that it does not bounce; the spring
 * swings at first, to twice its rest at most, and slips a little on the way where tan a > mu/2. */
static void a_sphere_sticks_below_mu_and_slides_above(void **state) {
  (void)state;
  const double mu = 0.5, dt = 2e-4, slopes[] = {0.2, 0.45, 0.48, 0.6};
  for (size_t k = 0; k < 4; k++) {
    test_engine e;
    double a = slopes[k], t = 2, kt = 2. / 7 * K, slides = G * (sin(a) - mu * cos(a));
    test_engine_open(&e);
    test_particle(&e, 0, 0, R - G * cos(a) / K, 1);
    tilt(&e, a);
    grains(&e, "soft_walls", 0.5, mu);
    run_steps(&e, dt);
    test_advance(&e, t);
    double x = test_position(&e, 1)[0], v = test_velocity(&e, 1)[0];
    if (tan(a) < mu) { /* at rest where the spring bears the weight; a slip begins at the end of the first step */
      assert_true(fabs(v) < 1e-6);
      double rest = G * sin(a) / kt;
      /* Its speed is at most that of the swing, v^2 = g sin a rest; what it slips by then stops it. */
      double slips = G * sin(a) * rest / (-2 * slides);
      bool fine = tan(a) < mu / 2 ? fabs(x - rest) < G * sin(a) * dt * dt : x > rest && x < 2 * rest + slips;
      if (!fine) fail_msg("slope %g: at %g m instead of %g", a, x, rest);
    } else { /* but for the time until it slips, of the order of 1/w */
      assert_true(fabs(v - slides * t) < 0.02 * G * t * sin(a) / 2);
      assert_true(x > 0.9 * slides * t * t / 2);
    }
    test_engine_close(&e);
  }
}

/* A ball that turns rolls down with 5/7 g sin a where tan a < 7/2 mu (the friction that rolling needs is 2/7 of the
 * weight), and spins with v/R; R less half the overlap is the lever. */
static void a_ball_rolls(void **state) {
  (void)state;
  test_engine e;
  double a = 0.3, t = 1.5, wanted = 5. / 7 * G * sin(a) * t;
  test_engine_open(&e);
  test_particle(&e, 0, 0, R - G * cos(a) / K, 1);
  tilt(&e, a);
  add_spin(&e, grains(&e, "soft_walls", 0.5, 0.5));
  run_steps(&e, 2e-4);
  test_advance(&e, t);
  double v = test_velocity(&e, 1)[0], spin = hk_run_view(e.run)->y[1];
  if (!(fabs(v - wanted) < 5e-3 * wanted && fabs(spin * R - v) < 1e-2 * v))
    fail_msg("%g m/s instead of %g, %g rad/s", v, wanted, spin);
  test_engine_close(&e);
}

/* A ball that slips begins to roll: of 1/2 m v^2 then 25/49 is left in v, 10/49 in the spin and 14/49 is taken by
 * friction, whichever forces of grains there are, with the spin as a channel of each. The swing of the tangential
 * spring that is left over has 1e-4 of it. */
static void the_energy_of_a_spin_is_counted_once(void **state) {
  (void)state;
  static const char *const forces[][3] = {{"soft_walls"},
                                          {"soft_spheres", "soft_walls"},
                                          {"soft_walls", "soft_spheres"},
                                          {"soft_spheres", "soft_walls", "soft_spheres"}};
  for (size_t k = 0; k < sizeof forces / sizeof *forces; k++) {
    test_engine e;
    hk_summary s;
    test_engine_open(&e);
    e.scene->fps = 100;
    launch(&e, test_particle(&e, 0, 0, R - G / K, 1), 1, 0, 0);
    tilt(&e, 0);
    for (size_t j = 0; j < 3 && forces[k][j]; j++) add_spin(&e, grains(&e, forces[k][j], 0.5, 0.5));
    e.options.dt = 2e-4;
    e.scene->duration = 0.5;
    test_run(&e);
    test_advance(&e, 0.5);
    hk_run_summary(e.run, &s);
    double heat = -s.energy_work, lost = s.energy_first - s.energy_last, lever = 1 - G / K / (2 * R),
           wanted = 0.5 / (1 + 2.5 * lever * lever);
    if (!(fabs(heat - wanted) < 1e-3 * wanted && fabs(lost - wanted) < 1e-3 * wanted))
      fail_msg("case %zu: heat %g J, lost %g J instead of %g", k, heat, lost, wanted);
    test_engine_close(&e);
  }
}

/* What the dashpot across the contact makes of a spin, 2 z sqrt(k_t m/q) l^2/I, is the rate of the channel by which the
 * step is chosen; the radius, on which all forces depend, is a channel as well, and no rate. Differences of 1e-6. */
static void the_spin_has_its_rate(void **state) {
  (void)state;
  test_engine e;
  double kt = 2. / 7 * K, lever = R - G / K / 2, radius = R, z = 0.2552756376486517;
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "size", 1, &radius, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, R - G / K, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "soft_walls");
  test_number(&e, spec, "stiffness", K);
  test_number(&e, spec, "restitution", 0.5);
  test_text(&e, spec, "radii", "size");
  add_spin(&e, spec);
  e.options.dt = 1e-4;
  test_run(&e);
  double wanted = 2 * z * sqrt(kt / 3.5) * lever * lever / (0.4 * R * R), rate = e.run->step->spectrum.channel_rate;
  if (!(fabs(rate / wanted - 1) < 1e-3)) fail_msg("%.9g instead of %.9g", rate, wanted);
  test_engine_close(&e);
}

/* ---- what is remembered ---- */

/* A sphere rests on a fixed one, 20 degrees from its top: friction alone holds it, tan 20 = 0.36 < 0.5, with a slip of
 * m g sin/k_t = 1.2 mm. Where the slip is forgotten it starts anew, and the sphere creeps down by as much. */
static void perch(test_engine *e, double skin) {
  double a = 0.35, reach = 2 * R - G * cos(a) / K;
  test_engine_open(e);
  for (int k = 0; k < 30; k++) test_particle(e, 5 + k, 0, 0, 1); /* bystanders, who die first */
  test_pin(e, HK_PIN_FIXED, test_particle(e, 0, 0, 0, 1), NULL);
  test_particle(e, reach * sin(a), 0, reach * cos(a), 1);
  e->options.dt = 2e-4;
  e->scene->fps = 100;
  e->scene->duration = 10;
  hk_plugin_spec *gravity = test_plugin(e, HK_FORCE, "gravity");
  test_vector(e, gravity, "g", 0, 0, -G);
  grains(e, "soft_spheres", 0.3, 0.5);
  test_number(e, test_plugin(e, HK_SERVICE, "neighbours"), "skin", skin);
}

static void the_slip_outlives_searches_births_and_deaths(void **state) {
  (void)state;
  double rest[3];
  for (int way = 0; way < 3; way++) {
    test_engine e;
    perch(&e, way == 1 ? 0 : 0.1); /* 1: pairs are searched for at every evaluation */
    if (way == 2) {                /* births and deaths at every tenth step */
      hk_plugin_spec *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
      test_number(&e, emitter, "every", 2e-3);
      test_number(&e, emitter, "lifetime", 0.07);
      test_vector(&e, emitter, "position", 0, 50, 0);
    }
    test_run(&e);
    test_advance(&e, 2);
    const double *x = test_position(&e, 32);
    if (way == 0) memcpy(rest, x, sizeof rest);
    double moved = hypot(x[0] - rest[0], x[2] - rest[2]), speed = test_velocity(&e, 32)[0];
    /* Births and deaths make leapfrog evaluate again, which the motion forgets as it comes to rest. */
    if (!(moved < (way == 2 ? 1e-6 : 1e-300) && fabs(speed) < 1e-6))
      fail_msg("way %d: %g m, %g m/s", way, moved, speed);
    if (way == 2) assert_true(hk_run_view(e.run)->model->id[0] > 20);
    test_engine_close(&e);
  }
}

static void a_resumed_heap_goes_on_bit_by_bit(void **state) {
  (void)state;
  test_engine a, b;
  char path[512];
  snprintf(path, sizeof path, "%s/perch.checkpoint", test_folder());
  perch(&a, 0.1);
  test_run(&a);
  test_advance(&a, 0.13);
  assert_int_equal(hk_run_save(a.run, path, &a.error), HK_OK);
  perch(&b, 0.1);
  b.scene->start_file = strdup(path);
  test_run(&b);
  test_advance(&a, 0.5);
  test_advance(&b, 0.5);
  assert_memory_equal(a.run->state.X, b.run->state.X, a.run->state.size * sizeof(double));
  test_engine_close(&a);
  test_engine_close(&b);
}

/* ---- many ---- */

static void box_of_grains(test_engine *e, int side, bool turning, hk_plugin_spec *spec[2]) {
  uint64_t seed[4];
  hk_random_seed(seed, 8);
  test_engine_open(e);
  e->options.dt = 1e-4;
  e->scene->fps = 100;
  for (int i = 0; i < side * side * side; i++) {
    double x[3];
    for (int c = 0, at = i; c < 3; c++, at /= side) x[c] = 1.9 * R * (at % side) + 0.3 * R * hk_random_uniform(seed);
    uint32_t id = test_particle(e, x[0] + R, x[1] + R, x[2] + R, 1 + hk_random_uniform(seed));
    launch(e, id, 4 * hk_random_uniform(seed) - 2, 4 * hk_random_uniform(seed) - 2, 4 * hk_random_uniform(seed) - 2);
  }
  spec[0] = grains(e, "soft_spheres", 0.5, 0.4);
  spec[1] = grains(e, "soft_walls", 0.5, 0.4);
  test_list(e, spec[1], "planes", (const double[]){0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 12);
  for (int k = 0; k < 2 && turning; k++) add_spin(e, spec[k]);
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { SIDE = 10 };
  const int threads[] = {1, 2, 7};
  double *first = NULL;
  for (int k = 0; k < 3; k++) {
    test_engine e;
    hk_plugin_spec *spec[2];
    box_of_grains(&e, SIDE, true, spec);
    e.scene->threads = threads[k];
    test_run(&e);
    test_advance(&e, 0.02);
    size_t bytes = e.run->state.size * sizeof *first;
    if (!first) first = malloc(bytes), memcpy(first, e.run->state.X, bytes);
    assert_memory_equal(first, e.run->state.X, bytes);
    test_engine_close(&e);
  }
  free(first);
}

/* Forces and torques at one state, in the middle of a motion: their sums are those of rounding. */
static void momentum_and_angular_momentum_are_kept(void **state) {
  (void)state;
  enum { N = 125 };
  test_engine e;
  hk_plugin_spec *spec[2];
  double F[3 * N], dy[3 * N] = {0}, force[3] = {0}, moment[3] = {0}, size = 0;
  box_of_grains(&e, 5, true, spec);
  test_run(&e);
  test_advance(&e, 0.03);
  hk_instance *one = test_instance(&e, spec[0]);
  hk_view view = force_view(&e, one);
  force_evaluate(one, &view, F);
  assert_int_equal(one->plugin->force->rates(one->self, &view, dy), HK_OK);
  for (size_t i = 0; i < N; i++)
    for (size_t c = 0; c < 3; c++) {
      size_t a = 3 * i + (c + 1) % 3, b = 3 * i + (c + 2) % 3;
      force[c] += F[3 * i + c];
      moment[c] += view.x[a] * F[b] - view.x[b] * F[a] + 0.4 * view.model->mass[i] * R * R * dy[3 * i + c];
      size += fabs(F[3 * i + c]);
    }
  assert_true(size > 100);
  for (int c = 0; c < 3; c++) assert_true(fabs(force[c]) < 1e-14 * size && fabs(moment[c]) < 1e-13 * size);
  test_engine_close(&e);
}

/* The scene `sand` with 120 grains. Without friction a heap runs apart; with 0.6 it keeps the slope of a cone within
 * the few degrees that so few grains show. tests/study/repose.c has the whole curve. */
static void a_heap_is_as_steep_as_friction_allows(void **state) {
  (void)state;
  static test_result r;
  const double friction[] = {0.02, 0.6};
  double slope[2];
  for (int k = 0; k < 2; k++) {
    char arguments[512];
    snprintf(arguments, sizeof arguments,
             "run %s/scripts/scenes/sand.lua n=120 friction=%g --until 0.7 --threads 1 --json --quiet --no-output",
             HK_ROOT, friction[k]);
    test_hooke(&r, NULL, arguments);
    assert_int_equal(r.code, 0);
    slope[k] = test_json(r.out, "slope");
  }
  if (!(slope[0] < 3 && slope[1] > 15 && slope[1] < 35)) fail_msg("slopes of %g and %g degrees", slope[0], slope[1]);
}

/* ---- refusals ---- */

static void spheres_in_one_place_end_the_run(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  for (int k = 0; k < 2; k++) test_particle(&e, 1, 2, 3, 1);
  grains(&e, "soft_spheres", 0.5, 0.5);
  e.options.dt = 1e-4;
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 0.1, &e.error), HK_FAILED);
  assert_non_null(strstr(e.error.text, "particle 2 has the same centre as another one"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_collision_has_its_restitution_and_duration),
      cmocka_unit_test(a_grazing_blow_gives_the_impulse_of_friction),
      cmocka_unit_test(what_dashpots_and_friction_take_is_accounted_for),
      cmocka_unit_test(a_sphere_sticks_below_mu_and_slides_above),
      cmocka_unit_test(a_ball_rolls),
      cmocka_unit_test(the_energy_of_a_spin_is_counted_once),
      cmocka_unit_test(the_spin_has_its_rate),
      cmocka_unit_test(the_slip_outlives_searches_births_and_deaths),
      cmocka_unit_test(a_resumed_heap_goes_on_bit_by_bit),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(momentum_and_angular_momentum_are_kept),
      cmocka_unit_test(a_heap_is_as_steep_as_friction_allows),
      cmocka_unit_test(spheres_in_one_place_end_the_run),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
