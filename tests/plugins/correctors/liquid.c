/* The corrector liquid in whole runs: water at rest stays at rest, a standing wave has the frequency of theory, volume
 * is kept, particles stay out of walls, threads do not change bits, and what cannot be is refused with a sentence. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, pi = 3.14159265358979323846;

static uint64_t bits;

/* 0 to 1. */
static double draw(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53;
}

typedef struct tank {
  test_engine e;
  hk_plugin_spec *liquid;
  size_t n;
  double radius; /* m, of a ball that lies on the floor in the middle; 0: none */
} tank;

/* A plane tank, 1 m wide and `top` high, of cells of the size h, under gravity. */
static void open_scene(tank *k, double dt) {
  bits = 7;
  k->n = 0;
  k->radius = 0;
  test_engine_open(&k->e);
  k->e.options.integrator = "symplectic_euler";
  k->e.options.dt = dt;
  hk_plugin_spec *gravity = test_plugin(&k->e, HK_FORCE, "gravity");
  test_vector(&k->e, gravity, "g", 0, 0, -g);
}

static void hold(tank *k, double h, double top) {
  k->liquid = test_plugin(&k->e, HK_CORRECTOR, "liquid");
  test_vector(&k->e, k->liquid, "low", 0, 0, 0);
  test_vector(&k->e, k->liquid, "high", 1, 0, top);
  test_number(&k->e, k->liquid, "cell", h);
}

static void open_tank(tank *k, double h, double top, double dt) {
  open_scene(k, dt);
  hold(k, h, top);
}

static void put_ball(tank *k) {
  hk_plugin_spec *ball = test_plugin(&k->e, HK_CORRECTOR, "obstacle");
  test_text(&k->e, ball, "shape", "sphere");
  test_vector(&k->e, ball, "size", 0.3, 0.3, 0.3);
  test_vector(&k->e, ball, "position", 0.7, 0, 0);
}

/* Water below depth + amplitude cos(pi x), from `from` on along x. */
static void pour(tank *k, double h, double from, double to, double depth, double amplitude) {
  double s = h / 2;
  for (int i = (int)(from / s + 0.5); i < (int)(to / s + 0.5); i++)
    for (int j = 0; j < (int)((depth + amplitude) / s + 1.5); j++) {
      double x = (i + draw()) * s, z = (j + draw()) * s;
      if (z < depth + amplitude * cos(pi * x) && hypot(x - 0.5, z - k->radius) >= k->radius)
        test_particle(&k->e, x, 0, z, 1000 * s * s * h), k->n++;
    }
}

static double fastest(tank *k) {
  double most = 0;
  for (uint32_t id = 1; id <= k->n; id++)
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(test_velocity(&k->e, id)[c]));
  return most;
}

/* A full box after 1,000 steps, in each of which gravity gives 0.05 m/s. */
static void a_full_box_is_at_rest(void **state) {
  (void)state;
  tank k;
  const double h = 1 / 8.0, dt = 0.005;
  open_tank(&k, h, 0.5, dt);
  test_number(&k.e, k.liquid, "tolerance", 1e-11);
  pour(&k, h, 0, 1, 0.5, 0);
  test_run(&k.e);
  test_advance(&k.e, 1000 * dt);
  double speed = fastest(&k);
  if (!(speed < 1e-10)) fail_msg("%.3g m/s", speed);
  test_engine_close(&k.e);
}

/* With a surface that the random places of particles make uneven by a part of a cell, waves of h, as high as a tenth of
 * it, at first: sqrt(g h) 0.1 = 0.08 m/s. */
static void a_calm_surface_stays_calm(void **state) {
  (void)state;
  tank k;
  const double h = 1 / 16.0;
  open_tank(&k, h, 1, 0.01);
  pour(&k, h, 0, 1, 0.5, 0);
  test_run(&k.e);
  test_advance(&k.e, 3);
  double height = 0;
  for (uint32_t id = 1; id <= k.n; id++) height += test_position(&k.e, id)[2] / (double)k.n;
  assert_true(fastest(&k) < 0.08);
  assert_true(fabs(height - 0.25) < 0.0025); /* 1 % of the volume */
  test_engine_close(&k.e);
}

static double mode_of(tank *k) {
  double sum = 0;
  for (uint32_t id = 1; id <= k->n; id++) sum += cos(pi * test_position(&k->e, id)[0]);
  return sum / (double)k->n;
}

static double height_of(tank *k) {
  double sum = 0;
  for (uint32_t id = 1; id <= k->n; id++) sum += test_position(&k->e, id)[2] / (double)k->n;
  return sum;
}

static void put_ball_on_floor(tank *k, double radius) {
  k->radius = radius;
  hk_plugin_spec *ball = test_plugin(&k->e, HK_CORRECTOR, "obstacle");
  test_text(&k->e, ball, "shape", "sphere");
  test_vector(&k->e, ball, "size", 2 * radius, 2 * radius, 2 * radius);
  test_vector(&k->e, ball, "position", 0.5, 0, radius);
}

/* The wedge between a ball and its floor is walls all round: air there would be a drain, through which half of the
 * water was gone after two seconds. 1 % of the volume. */
static void a_ball_on_the_floor_is_no_drain(void **state) {
  (void)state;
  for (int full = 0; full < 2; full++) {
    tank k;
    const double h = 0.05;
    open_scene(&k, 0.005);
    put_ball_on_floor(&k, 0.2);
    hold(&k, h, 1);
    test_number(&k.e, k.liquid, "tolerance", 1e-10);
    pour(&k, h, 0, 1, full ? 1 : 0.5, 0);
    test_run(&k.e);
    double area = (double)k.n * h * h / 4, ball = pi * 0.04, depth = area + ball;
    double wanted = full ? height_of(&k) : (depth * depth / 2 - ball * 0.2) / area; /* m, of the centre of mass */
    test_advance(&k.e, 1.5);
    if (!(fabs(height_of(&k) / wanted - 1) < 0.01)) fail_msg("%.4f instead of %.4f m", height_of(&k), wanted);
    /* Chance leaves cells by the ball half empty, which fill up; 0.05 m/s is what gravity gives in one step. */
    if (full && !(fastest(&k) < 0.01)) fail_msg("%.3g m/s", fastest(&k));
    test_engine_close(&k.e);
  }
}

/* sqrt(g k tanh(k d)), from the times at which the wave is level, less 0.0972 (k a)^2 of it for its amplitude a at this
 * depth (Tadjbakhsh and Keller 1960, J. Fluid Mech. 8). 32 cells across half a wavelength, particles at random: found
 * were -0.1 and -0.24 %. Faces beyond the surface that carry particles and have no pressure made it -0.6 and -0.7 %, a
 * surface in the centres of cells 4 %. */
static void a_standing_wave_has_the_frequency_of_theory(void **state) {
  (void)state;
  static const char *const transfers[] = {"apic", "flip"};
  for (int t = 0; t < 2; t++) {
    tank k;
    const double h = 1 / 32.0, dt = 0.005, ka = pi * 0.04;
    const double w = sqrt(g * pi * tanh(pi * 0.5)) * (1 - 0.0972 * ka * ka);
    double crossing[8], before = 1;
    size_t count = 0;
    open_tank(&k, h, 1, dt);
    test_text(&k.e, k.liquid, "transfer", transfers[t]);
    pour(&k, h, 0, 1, 0.5, 0.04);
    test_run(&k.e);
    for (int step = 1; count < 5; step++) {
      assert_true(step < 800);
      test_advance(&k.e, step * dt);
      double now = mode_of(&k);
      if (before * now < 0) crossing[count++] = (step - 1 + before / (before - now)) * dt;
      before = now;
    }
    double found = pi * 4 / (crossing[4] - crossing[0]);
    if (!(fabs(found / w - 1) < 0.004)) fail_msg("%s: %.5f instead of %.5f 1/s", transfers[t], found, w);
    test_engine_close(&k.e);
  }
}

/* A column collapses on a ball; the water then sloshes about the level of its volume, and is never lower. It is 0.32
 * m^2 about half a disc of 0.15: 0.3553 m deep, with its centre of mass (0.3553^2/2 - 2/3 0.15^3)/0.32 = 0.1902 m high,
 * which waves come near to when they turn. 1 % of the volume is 1 % of that. */
static void a_dam_break_keeps_volume_and_walls(void **state) {
  (void)state;
  tank k;
  const double h = 1 / 20.0;
  double lowest = 1;
  open_scene(&k, 0.01);
  put_ball(&k);
  hold(&k, h, 1);
  pour(&k, h, 0, 0.4, 0.8, 0);
  test_run(&k.e);
  const hk_instance *liquid = test_instance(&k.e, k.liquid);
  for (int i = 1; i <= 120; i++) {
    test_advance(&k.e, 0.1 * i);
    double beyond = liquid->plugin->corrector->violation(liquid->self, hk_run_view(k.e.run)), height = 0;
    for (uint32_t id = 1; id <= k.n; id++) height += test_position(&k.e, id)[2] / (double)k.n;
    if (!(beyond < 1e-9)) fail_msg("%.3g m in a wall at t = %g s", beyond, 0.1 * i);
    if (i > 40) lowest = fmin(lowest, height);
  }
  if (!(fabs(lowest / 0.1902 - 1) < 0.01)) fail_msg("the lowest centre of mass is at %.4f m", lowest);
  test_engine_close(&k.e);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  double last[2][3];
  for (int t = 0; t < 2; t++) {
    tank k;
    open_tank(&k, 1 / 32.0, 1, 0.005);
    k.e.options.threads = t ? 3 : 1;
    pour(&k, 1 / 32.0, 0, 0.5, 0.9, 0);
    test_run(&k.e);
    test_advance(&k.e, 0.1);
    memcpy(last[t], test_position(&k.e, (uint32_t)k.n / 2), sizeof last[t]);
    test_engine_close(&k.e);
  }
  assert_memory_equal(last[0], last[1], sizeof last[0]);
}

/* A bead on a string, which is of no liquid, falls freely through the water; the water is what its particles are. */
static void cloth_and_strands_are_no_liquid(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.1, 1, 0.01);
  pour(&k, 0.1, 0, 1, 0.5, 0);
  uint32_t a = test_particle(&k.e, 0.5, 0, 0.9, 1), b = test_particle(&k.e, 0.5, 0, 0.8, 1);
  const uint32_t edge[1][2] = {{a, b}};
  assert_int_equal(hk_scene_add_edges(k.e.scene, 1, edge, &k.e.error), HK_OK);
  test_run(&k.e);
  test_advance(&k.e, 0.3);
  assert_true(fabs(test_velocity(&k.e, b)[2] + g * 0.3) < 1e-12); /* rounding of 30 steps */
  test_engine_close(&k.e);
}

/* A box of 1 m x 1 m x 0.05 m among cells of 0.1 m. */
static void thin_walls_are_said(void **state) {
  (void)state;
  tank k;
  open_scene(&k, 0.01);
  hk_plugin_spec *wall = test_plugin(&k.e, HK_CORRECTOR, "obstacle");
  test_text(&k.e, wall, "shape", "box");
  test_vector(&k.e, wall, "size", 1, 1, 0.05);
  hold(&k, 0.1, 1);
  pour(&k, 0.1, 0, 1, 0.3, 0);
  test_run(&k.e);
  bool said = false;
  for (size_t w = 0; w < k.e.run->warnings.count; w++)
    said |= strstr(k.e.run->warnings.text[w], "obstacle 1 is 0.05 m thin near (0, 0, 0), and cells are 0.1 m") != NULL;
  assert_true(said);
  test_engine_close(&k.e);
}

/* Particles with a quarter more mass than fills their places: a cell is too full by a quarter of 0.05 m, less what is
 * evened in the step. */
static void a_density_that_is_off_is_a_violation(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.05, 1, 0.001);
  test_number(&k.e, k.liquid, "density", 800);
  pour(&k, 0.05, 0, 1, 0.8, 0);
  test_run(&k.e);
  test_advance(&k.e, 0.001);
  const hk_instance *liquid = test_instance(&k.e, k.liquid);
  double off = liquid->plugin->corrector->violation(liquid->self, hk_run_view(k.e.run));
  if (!(off > 0.2 * 0.05 && off < 0.3 * 0.05)) fail_msg("%g m", off);
  test_engine_close(&k.e);
}

static double figure_of(tank *k, const char *name) {
  hk_summary s;
  hk_run_summary(k->e.run, &s);
  for (size_t p = 0; p < s.plugins; p++)
    for (size_t f = 0; f < s.plugin[p].figures; f++)
      if (strcmp(s.plugin[p].figure[f].name, name) == 0) return s.plugin[p].figure[f].value;
  fail_msg("there is no figure %s", name);
  return NAN;
}

/* Where nothing moves yet the step is that of the wave on the depth, half a cell / sqrt(g d), by the accelerations of
 * the start; then the speed reached bounds it. Without a bound the first step was a frame of 0.05 s. */
static void steps_are_foretold(void **state) {
  (void)state;
  tank k;
  const double h = 1 / 20.0;
  open_tank(&k, h, 1, NAN);
  k.e.scene->fps = 20;
  pour(&k, h, 0, 0.4, 0.8, 0);
  test_run(&k.e);
  double first = hk_loop_longest_step(&k.e.run->loop), wave = 0.5 * h / sqrt(g * 0.8);
  if (!(fabs(first / wave - 1) < 0.03)) fail_msg("%g instead of %g s", first, wave); /* random places of particles */
  test_advance(&k.e, 0.6);
  hk_summary s;
  hk_run_summary(k.e.run, &s);
  assert_int_equal(s.rejected_steps, 0);
  assert_true(s.dt_max <= first * (1 + 1e-9) && s.dt_min < 0.9 * first);
  double passed = figure_of(&k, "courant");
  if (!(passed > 0.35 && passed < 0.53)) fail_msg("%g cells", passed);
  test_engine_close(&k.e);
}

/* Water at rest has its volume, and its pressure its tolerance, 1e-8 of what gravity gave in a step. Of 512 particles
 * at random the volume is known to 1 %. */
static void figures_say_how_well_it_went(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 1 / 16.0, 1, 0.01);
  pour(&k, 1 / 16.0, 0, 1, 0.5, 0);
  test_run(&k.e);
  test_advance(&k.e, 0.5);
  double drift = figure_of(&k, "volume_drift");
  if (!(fabs(drift) < 0.01)) fail_msg("%g", drift);
  double left = figure_of(&k, "divergence_left");
  if (!(left > 0 && left < 1e-8)) fail_msg("%g", left);
  assert_true(figure_of(&k, "in_walls") == 0);
  test_engine_close(&k.e);
}

/* Particles with a quarter more mass than fills their places have lost a fifth of their volume. */
static void a_volume_that_is_lost_is_not_ok(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.05, 1, 0.001);
  test_number(&k.e, k.liquid, "density", 800);
  test_boolean(&k.e, k.liquid, "even", false);
  pour(&k, 0.05, 0, 1, 1, 0);
  k.e.scene->duration = 0.01;
  test_run(&k.e);
  test_advance(&k.e, 0.01);
  double drift = figure_of(&k, "volume_drift");
  if (!(fabs(drift + 0.2) < 0.01)) fail_msg("%g instead of -0.2", drift);
  assert_int_equal(hk_run_close(k.e.run, &k.e.error), HK_OK);
  hk_summary s;
  hk_run_summary(k.e.run, &s);
  assert_int_equal(s.verdict, HK_INACCURATE);
  if (!strstr(s.reason, "liquid: volume_drift is -0.")) fail_msg("%s", s.reason);
  test_engine_close(&k.e);
}

static void refused(tank *k, const char *sentence) {
  assert_int_equal(hk_run_open(k->e.scene, &k->e.options, &k->e.run, &k->e.error), HK_BAD_PARAM);
  if (!strstr(k->e.error.text, sentence)) fail_msg("'%s' in: %s", sentence, k->e.error.text);
  test_engine_close(&k->e);
}

/* An obstacle after the liquid would strike what pressure has moved: it blew the dam break above to pieces. */
static void obstacles_come_first(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.1, 1, 0.01);
  put_ball(&k);
  pour(&k, 0.1, 0, 0.3, 0.3, 0);
  test_run(&k.e);
  assert_int_equal(hk_run_advance(k.e.run, 0.1, &k.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(k.e.error.text, "put the corrector liquid behind all obstacles"));
  test_engine_close(&k.e);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  tank k;
  open_tank(&k, 0.1, 1, 0.01);
  test_particle(&k.e, 1.5, 0, 0.5, 1);
  refused(&k, "particle 1 is outside the box, at x = 1.5 m where it goes from 0 to 1: move it");
  open_tank(&k, 0.1, -1, 0.01);
  test_particle(&k.e, 0.5, 0, 0, 1);
  refused(&k, "the liquid has no room");
  open_tank(&k, 1e-6, 1, 0.01);
  test_particle(&k.e, 0.5, 0, 0.5, 1);
  refused(&k, "take larger cells or a smaller box");
  open_tank(&k, 0.1, 1, 0.01);
  test_particle(&k.e, 0.5, 0, 0.5, 1);
  test_pin(&k.e, HK_PIN_PLANE, 1, (double[]){0, 1, 0});
  refused(&k, "particle 1 slides on a pin, of which the grid knows nothing");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_full_box_is_at_rest),
      cmocka_unit_test(a_calm_surface_stays_calm),
      cmocka_unit_test(a_standing_wave_has_the_frequency_of_theory),
      cmocka_unit_test(a_ball_on_the_floor_is_no_drain),
      cmocka_unit_test(a_dam_break_keeps_volume_and_walls),
      cmocka_unit_test(threads_do_not_change_bits),
      cmocka_unit_test(cloth_and_strands_are_no_liquid),
      cmocka_unit_test(thin_walls_are_said),
      cmocka_unit_test(a_density_that_is_off_is_a_violation),
      cmocka_unit_test(steps_are_foretold),
      cmocka_unit_test(figures_say_how_well_it_went),
      cmocka_unit_test(a_volume_that_is_lost_is_not_ok),
      cmocka_unit_test(obstacles_come_first),
      cmocka_unit_test(what_cannot_be_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
