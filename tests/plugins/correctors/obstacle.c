/* Obstacles against closed forms, for explicit methods of several orders and an implicit one: bounces, slopes, rests,
 * moving and turning obstacles, curved ones, corners.
 *
 * Under constant forces a particle's path in a step is a parabola, which methods of order 2 and more follow exactly,
 * and on which impacts are found exactly: what is left is rounding, some 1e-16 of the extent a step, each of which a
 * bounce may amplify (a time that is off by dt puts the next landing off by 2 e dt). 1e-12 of 1 m covers it with room.
 * Methods of order 1 are off by g h/2 in velocity. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, exact = 1e-12;

static const struct method {
  const char *name;
  int order;
} methods[] = {{"symplectic_euler", 1}, {"leapfrog", 2}, {"rk4", 4}, {"dopri5", 5}, {"bdf2", 2}, {"stoermer", 2}};
enum { METHODS = sizeof methods / sizeof *methods, UP_TO_TWO = 2 };

typedef struct bench {
  test_engine e;
  hk_plugin_spec *obstacle, *gravity;
} bench;

static void open_bench(bench *b, const char *method, double h) {
  test_engine_open(&b->e);
  b->e.options.integrator = method;
  b->e.options.dt = h;
  b->e.scene->duration = 100;
  b->e.scene->fps = 1 / h < 60 ? 1 / h : 60;
}

static uint32_t put(bench *b, const double x[3], const double v[3]) {
  uint32_t id = test_particle(&b->e, x[0], x[1], x[2], 2);
  memcpy(b->e.scene->particles.velocity + 3 * (size_t)(id - 1), v, 3 * sizeof *v);
  return id;
}

static void fall(bench *b) {
  b->gravity = test_plugin(&b->e, HK_FORCE, "gravity");
  test_vector(&b->e, b->gravity, "g", 0, 0, -g);
}

static hk_plugin_spec *add(bench *b, const char *shape, double restitution, double friction) {
  b->obstacle = test_plugin(&b->e, HK_CORRECTOR, "obstacle");
  test_text(&b->e, b->obstacle, "shape", shape);
  test_number(&b->e, b->obstacle, "restitution", restitution);
  test_number(&b->e, b->obstacle, "friction", friction);
  return b->obstacle;
}

static double distance(const double *a, const double *b) {
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* What the verdict rests on. */
static hk_summary balanced(bench *b, double most) {
  hk_summary s;
  hk_run_summary(b->e.run, &s);
  if (s.kinetic_max > 0 && !(fabs(s.energy_drift) < most)) fail_msg("energy drift %g", s.energy_drift);
  if (!(s.constraint_violation < 1e-12)) fail_msg("inside by %g m", s.constraint_violation);
  return s;
}

/* ---- bounces ---- */

/* A ball dropped from H on a floor: height and speed at t. */
static double bouncing(double H, double e, double t, double *speed) {
  double v = sqrt(2 * g * H), fallen = v / g;
  *speed = -g * t;
  if (t < fallen) return H - g * t * t / 2;
  for (t -= fallen;; t -= 2 * v / g) {
    v *= e;
    *speed = v - g * t;
    if (t < 2 * v / g) return v * t - g * t * t / 2;
    if (v < 1e-6) return *speed = 0, 0;
  }
}

/* The error after ten bounces (the tenth is at 3.61 s with e = 0.8, the eleventh at 3.71 s). */
static double after_ten_bounces(const char *method, double h, double *energy_drift) {
  bench b;
  double v, z;
  open_bench(&b, method, h);
  put(&b, (double[]){0, 0, 1}, (double[]){0, 0, 0});
  fall(&b);
  add(&b, "plane", 0.8, 0);
  test_run(&b.e);
  test_advance(&b.e, 3.65);
  z = bouncing(1, 0.8, 3.65, &v);
  double off = fmax(fabs(test_position(&b.e, 1)[2] - z), fabs(test_velocity(&b.e, 1)[2] - v));
  hk_summary s = balanced(&b, 0.1);
  *energy_drift = s.energy_drift;
  test_engine_close(&b.e);
  return off;
}

static void ten_bounces_against_the_closed_form(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    double drift, coarse = after_ten_bounces(methods[k].name, 1.0 / 60, &drift),
                  fine = after_ten_bounces(methods[k].name, 1.0 / 960, &drift);
    print_message("ten bounces, %-18s off by %.1e, %.1e (h = 1/60, 1/960 s), drift %.1e\n", methods[k].name, coarse,
                  fine, drift);
    double bound =
        strcmp(methods[k].name, "bdf2") == 0 ? 1e-8 : 1e-11; /* iterates to 1e-6 of a step's change of speed */
    if (methods[k].order > 1 && !(coarse < bound && fine < bound)) fail_msg("%s is off", methods[k].name);
    if (methods[k].order == 1 && !(log2(coarse / fine) / 4 > 0.7)) fail_msg("%s: not of order 1", methods[k].name);
    if (methods[k].order > 1) assert_true(fabs(drift) < bound / 10);
  }
}

/* With drag forces after a bounce are others than before it. Steps are divided at the landing, so that methods keep
 * their order, down to 1e-5 to 1e-4 of a step after each of two landings with the acceleration of before: c (1 + e) v h
 * times that, up to 4e-6 m in all at h = 1/60 s, in proportion to h. With `divide` 0 it is the whole step, order 1.
 * Against rk4 in steps of 1/245760 s. */
static double with_drag(const char *method, double h, double divide) {
  bench b;
  open_bench(&b, method, h);
  put(&b, (double[]){0, 0, 1}, (double[]){0, 0, 0});
  fall(&b);
  test_number(&b.e, test_plugin(&b.e, HK_FORCE, "drag"), "rate", 0.3);
  test_number(&b.e, add(&b, "plane", 0.8, 0), "divide", divide);
  test_run(&b.e);
  test_advance(&b.e, 1);
  double z = test_position(&b.e, 1)[2];
  test_engine_close(&b.e);
  return z;
}

static void bounces_with_drag_converge(void **state) {
  (void)state;
  static const struct method names[] = {{"symplectic_euler", 1}, {"leapfrog", 2}, {"rk4", 4}, {"bdf2", 2}};
  double reference = with_drag("rk4", 1.0 / 60 / 4096, 4);
  for (size_t k = 0; k < 8; k++) {
    double divide = k < 4 ? 4 : 0;
    double a = fabs(with_drag(names[k % 4].name, 1.0 / 60, divide) - reference),
           c = fabs(with_drag(names[k % 4].name, 1.0 / 960, divide) - reference), order = log2(a / c) / 4;
    print_message("with drag,   %-18s %s off by %.1e, %.1e: order %.2f\n", names[k % 4].name,
                  divide > 0 ? "divided," : "whole,  ", a, c, order);
    bool second = divide > 0 && names[k % 4].order > 1;
    bool high = second && names[k % 4].order > 2;
    assert_true(a < (high ? 4e-6 : second ? 1e-3 : 0.02) && (high || order > (second ? 1.7 : 0.7)));
  }
}

/* ---- friction ---- */

/* A block on a slope with tan = 1/2, and what it slid in 1 s. */
static double slid(const char *method, double friction, double h, double *speed) {
  bench b;
  open_bench(&b, method, h);
  put(&b, (double[]){0, 0, 0}, (double[]){0, 0, 0});
  fall(&b);
  test_vector(&b.e, add(&b, "plane", 0.5, friction), "normal", 1, 0, 2);
  test_run(&b.e);
  test_advance(&b.e, 1);
  const double *x = test_position(&b.e, 1), *v = test_velocity(&b.e, 1);
  assert_true(fabs(x[0] + 2 * x[2]) < exact && fabs(v[0] + 2 * v[2]) < exact && x[1] == 0);
  balanced(&b, 0.1);
  *speed = copysign(hypot(v[0], v[2]), v[0]);
  double way = copysign(hypot(x[0], x[2]), x[0]);
  test_engine_close(&b.e);
  return way;
}

static void a_block_on_a_slope_slides_below_half_and_holds_above(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++)
    for (double mu = 0; mu < 0.495; mu += 0.07) {
      double v, a = g * (1 - 2 * mu) / sqrt(5), way = slid(methods[k].name, mu, 1.0 / 60, &v);
      if (!(fabs(way - a / 2) < exact && fabs(v - a) < exact))
        fail_msg("%s, mu = %g: %.17g m instead of %.17g", methods[k].name, mu, way, a / 2);
    }
  for (size_t k = 0; k < METHODS; k++) {
    double v, below = slid(methods[k].name, 0.49, 1.0 / 60, &v), above = slid(methods[k].name, 0.51, 1.0 / 60, &v);
    print_message("slope,       %-18s %.9f m at mu = 0.49, %.1e m at 0.51\n", methods[k].name, below, above);
    assert_true(fabs(below - 0.0877433 / 2) < 1e-7); /* the published number has six digits */
    assert_true(fabs(above) < exact && v == 0);
  }
}

/* On the flat, from 3 m/s: v^2/(2 mu g), inside a step. */
static void a_sliding_block_stops_where_it_should(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){0, 0, 0}, (double[]){1.8, 2.4, 0});
    fall(&b);
    add(&b, "plane", 0, 0.7);
    test_run(&b.e);
    test_advance(&b.e, 2);
    double way = 9 / (2 * 0.7 * g);
    assert_true(distance(test_position(&b.e, 1), (double[]){0.6 * way, 0.8 * way, 0}) < exact);
    assert_true(distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}) == 0);
    hk_summary s = balanced(&b, 1e-12);
    assert_true(fabs(s.energy_work + 9) < exact); /* 2 kg at 3 m/s */
    test_engine_close(&b.e);
  }
}

/* Across a slope at 2 m/s: friction turns with the motion. Against steps of 1/960 s: order 2. */
static void across(const char *method, double h, double x[3]) {
  bench b;
  open_bench(&b, method, h);
  put(&b, (double[]){0, 0, 0}, (double[]){0, 2, 0});
  fall(&b);
  test_vector(&b.e, add(&b, "plane", 0, 0.7), "normal", 1, 0, 2);
  test_run(&b.e);
  test_advance(&b.e, 0.4);
  memcpy(x, test_position(&b.e, 1), 3 * sizeof *x);
  balanced(&b, 0.01);
  test_advance(&b.e, 3); /* tan = 1/2 below mu: it stops, and stays */
  assert_true(distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}) == 0);
  test_engine_close(&b.e);
}

static void friction_turns_with_the_motion(void **state) {
  (void)state;
  double fine[3], a[3], c[3];
  across("leapfrog", 1.0 / 15360, fine);
  for (size_t k = 0; k < METHODS; k++) {
    across(methods[k].name, 1.0 / 60, a);
    across(methods[k].name, 1.0 / 240, c);
    double off = distance(a, fine), less = distance(c, fine);
    print_message("across,      %-18s off by %.1e, %.1e m\n", methods[k].name, off, less);
    assert_true(off < 5e-4 && (methods[k].order == 5 || log2(off / less) / 2 > 1.7));
  }
}

/* ---- restitution ---- */

/* An impact by hand: w' = e |w.n| n + (1 - mu (1 + e) |w.n|/|w_t|) w_t, for a speed of (3, 0, -4). */
static void an_impact_obeys_its_law(void **state) {
  (void)state;
  static const double es[] = {0, 0.3, 0.8, 1}, mus[] = {0, 0.1, 0.37, 2};
  for (size_t k = 0; k < METHODS; k++)
    for (size_t q = 0; q < 16; q++) {
      double e = es[q / 4], mu = mus[q % 4];
      bench b;
      open_bench(&b, methods[k].name, 0.01);
      put(&b, (double[]){0, 0, 0.02}, (double[]){3, 0, -4});
      add(&b, "plane", e, mu);
      test_run(&b.e);
      test_advance(&b.e, 0.02);
      double across = 3 * fmax(0, 1 - mu * (1 + e) * 4 / 3), after = 0.015; /* s, since the impact */
      assert_true(distance(test_velocity(&b.e, 1), (double[]){across, 0, 4 * e}) < exact);
      assert_true(distance(test_position(&b.e, 1), (double[]){0.015 + across * after, 0, 4 * e * after}) < exact);
      hk_summary s = balanced(&b, 1e-12);
      assert_true(fabs(s.energy_work - (across * across + 16 * e * e - 25)) < exact);
      test_engine_close(&b.e);
    }
}

/* ---- rest ---- */

/* 10 s after a drop, on a floor away from the origin: it is at the floor to rounding and stands still. The bound: the
 * floor's height is a difference of numbers near 7 m, rounded to 1e-15 m; speeds are set to 0 in contact, so there is
 * nothing else. */
static void a_resting_ball_does_not_jitter(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    double fastest = 0, farthest = 0;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){0.3, -0.2, 7.4}, (double[]){0.1, 0, 0});
    fall(&b);
    hk_plugin_spec *floor = add(&b, "plane", 0.6, 0.3);
    test_vector(&b.e, floor, "position", 0, 0, 7);
    test_vector(&b.e, floor, "normal", 0.02, 0.01, 1);
    test_number(&b.e, floor, "radius", 0.05);
    test_run(&b.e);
    test_advance(&b.e, 5);
    double at[3];
    memcpy(at, test_position(&b.e, 1), sizeof at);
    for (int frame = 301; frame <= 900; frame++) {
      test_advance(&b.e, frame / 60.0);
      fastest = fmax(fastest, distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}));
      farthest = fmax(farthest, distance(test_position(&b.e, 1), at));
    }
    print_message("rest,        %-18s speed up to %.1e m/s, %.1e m away in 10 s\n", methods[k].name, fastest, farthest);
    assert_true(fastest == 0 && farthest < 600 * 4e-15);
    balanced(&b, methods[k].order > 1 ? 1e-11 : 0.1); /* 900 roundings of heights near 7 m, times the weight */
    test_engine_close(&b.e);
  }
}

/* ---- moving obstacles ---- */

static double lift(double t) { return 0.3 * sin(2 * t); }

static hk_status lifted(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                        size_t room, size_t *got, hk_error *error) {
  (void)f, (void)caller, (void)count, (void)room, (void)error;
  out[0] = out[1] = 0;
  out[2] = lift(*t);
  *got = 3;
  return HK_OK;
}

/* A damped spring presses a ball on a floor, where it rests: the force that a step begins with is that of rest, the one
 * that it ends with is not, in each of 2000 steps of h w = 1.2. All is linear, so that nothing but rounding is left: 5
 * J in the spring, 2000 times. */
static void what_presses_on_a_floor_takes_no_energy(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    bench b;
    const double k = 1000, h = 1.2 / sqrt(k / 2);
    open_bench(&b, "leapfrog", h);
    put(&b, (double[]){0, 0, 0}, (double[]){0, 0, 0});
    put(&b, (double[]){0, 0, -0.1}, (double[]){0, 0, 0});
    test_pin(&b.e, HK_PIN_FIXED, 2, NULL);
    hk_plugin_spec *spring = test_plugin(&b.e, HK_FORCE, "springs");
    test_edges(&b.e, spring, (const uint32_t[][2]){{1, 2}}, 1);
    test_number(&b.e, spring, "k", k);
    test_number(&b.e, spring, "rest", 1e-3);
    test_number(&b.e, spring, "damping", damped ? 8 : 0);
    hk_plugin_spec *floor = add(&b, "plane", 0.5, 0.3);
    test_vector(&b.e, floor, "normal", 0, 0, 1);
    test_run(&b.e);
    test_advance(&b.e, 2000 * h);
    hk_summary s;
    hk_run_summary(b.e.run, &s);
    double lost = s.energy_last - s.energy_first - s.energy_work;
    assert_true(fabs(test_position(&b.e, 1)[2]) < 1e-12 && s.energy_last > 4);
    if (!(fabs(lost) < 2000 * 5 * 2e-16)) fail_msg("damped %d: %g J are lost", damped, lost);
    test_engine_close(&b.e);
  }
}

/* 0.3 m at 2 1/s: 1.2 m/s^2 at most, so that what lies on it stays. Its height is the floor's, exactly; its speed that
 * of a parabola through three of the floor's heights, off by h^2/3 times the third derivative, 2.4 m/s^3. */
static void a_lift_carries_what_lies_on_it(void **state) {
  (void)state;
  double h = 1.0 / 60;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, h);
    put(&b, (double[]){0, 0, 0}, (double[]){0, 0, 0.6});
    fall(&b);
    test_function(&b.e, add(&b, "plane", 0, 0), "position", (hk_function){.call = lifted});
    test_run(&b.e);
    double off = 0, speed_off = 0;
    for (int frame = 3; frame <= 180; frame++) {
      test_advance(&b.e, frame / 60.0);
      off = fmax(off, fabs(test_position(&b.e, 1)[2] - lift(frame / 60.0)));
      speed_off = fmax(speed_off, fabs(test_velocity(&b.e, 1)[2] - 0.6 * cos(frame / 30.0)));
    }
    print_message("lift,        %-18s off by %.1e m, %.1e m/s\n", methods[k].name, off, speed_off);
    balanced(&b, 0.1);
    assert_true(off < exact && speed_off < 1.2 * h * h / 3 * 2.4);
    test_engine_close(&b.e);
  }
}

/* A plate that moves at 2 m/s is a wall at rest in its own frame: v' = (1 + e) V - e v, wherever in the step. */
static hk_status pushed(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                        size_t room, size_t *got, hk_error *error) {
  (void)f, (void)caller, (void)count, (void)room, (void)error;
  out[0] = 2 * *t;
  out[1] = out[2] = 0;
  *got = 3;
  return HK_OK;
}

static void a_plate_that_moves_throws_back(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){1, 0, 0}, (double[]){-1, 0, 0});
    hk_plugin_spec *plate = add(&b, "box", 0.5, 0);
    test_vector(&b.e, plate, "size", 0.02, 3, 3);
    test_function(&b.e, plate, "position", (hk_function){.call = pushed});
    test_run(&b.e);
    test_advance(&b.e, 1);
    double met = 0.99 / 3, there = 1 - met;
    assert_true(fabs(test_velocity(&b.e, 1)[0] - 3.5) < exact);
    assert_true(fabs(test_position(&b.e, 1)[0] - (there + 3.5 * (1 - met))) < exact);
    balanced(&b, 1e-12);
    test_engine_close(&b.e);
  }
}

static hk_status turned(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                        size_t room, size_t *got, hk_error *error) {
  (void)caller, (void)count, (void)room, (void)error;
  out[0] = out[1] = 0;
  out[2] = *(const double *)f->context * *t;
  *got = 3;
  return HK_OK;
}

/* On a turntable at 2 rad/s with mu g = 5.9 m/s^2 above w^2 r = 2.8: 0.7 m from the axis it is carried, exactly. */
static void a_turntable_carries_what_does_not_slide(void **state) {
  (void)state;
  double w = 2;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){0.7, 0, 0}, (double[]){0, 1.4, 0});
    fall(&b);
    hk_plugin_spec *table = add(&b, "cylinder", 0, 0.6);
    test_vector(&b.e, table, "size", 2, 2, 0.1);
    test_vector(&b.e, table, "position", 0, 0, -0.05);
    test_function(&b.e, table, "rotation", (hk_function){.call = turned, .context = &w});
    test_run(&b.e);
    double off = 0;
    for (int frame = 2; frame <= 300; frame++) {
      double angle = w * frame / 60.0;
      test_advance(&b.e, frame / 60.0);
      off = fmax(off, distance(test_position(&b.e, 1), (double[]){0.7 * cos(angle), 0.7 * sin(angle), 0}));
      off = fmax(off, distance(test_velocity(&b.e, 1), (double[]){-1.4 * sin(angle), 1.4 * cos(angle), 0}));
    }
    print_message("turntable,   %-18s off by %.1e\n", methods[k].name, off);
    assert_true(off < exact);
    balanced(&b, 0.1);
    test_engine_close(&b.e);
  }
}

/* A bar that turns at w hits a particle at rest at the distance r from its axis: (1 + e) w r. The impact is on a path
 * that curves in the bar's frame: order 2. */
static double batted(const char *method, double h) {
  bench b;
  double w = 3;
  open_bench(&b, method, h);
  put(&b, (double[]){0.4, 0.5, 0}, (double[]){0, 0, 0});
  hk_plugin_spec *bar = add(&b, "box", 0.5, 0);
  test_vector(&b.e, bar, "size", 4, 1e-3, 1);
  test_function(&b.e, bar, "rotation", (hk_function){.call = turned, .context = &w});
  test_run(&b.e);
  test_advance(&b.e, 0.45);
  double r = hypot(0.4, 0.5), s = sqrt(r * r - 0.25e-6), speed = 1.5 * w * s,
         v = hypot(test_velocity(&b.e, 1)[0], test_velocity(&b.e, 1)[1]);
  balanced(&b, 0.1);
  test_engine_close(&b.e);
  return fabs(v - speed);
}

static void a_turning_bar_bats(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    double a = batted(methods[k].name, 1.0 / 60), c = batted(methods[k].name, 1.0 / 960);
    print_message("bat,         %-18s off by %.1e, %.1e m/s\n", methods[k].name, a, c);
    assert_true(a < 1e-8 && c < 1e-11 + (methods[k].order == 5 ? 1e-8 : 0));
  }
}

/* ---- shapes in motion ---- */

/* 100 m/s through a plate of 1 mm in steps of 1/60 s, 1.7 m each: never. */
static void a_fast_particle_does_not_pass_a_thin_box(void **state) {
  (void)state;
  static const char *const shapes[] = {"box", "sphere", "cylinder", "capsule"};
  for (size_t k = 0; k < METHODS; k++)
    for (size_t q = 0; q < 4; q++) {
      bench b;
      open_bench(&b, methods[k].name, 1.0 / 60);
      for (int i = 0; i < 7; i++) put(&b, (double[]){-1 - 0.37 * i, 1e-4 * i, 2e-4}, (double[]){100, 0, 0});
      hk_plugin_spec *plate = add(&b, shapes[q], 0.9, 0);
      if (q == 0)
        test_vector(&b.e, plate, "size", 1e-3, 1, 1);
      else
        test_vector(&b.e, plate, "size", 4e-3, 4e-3, 4e-3);
      test_run(&b.e);
      test_advance(&b.e, 0.2);
      for (uint32_t i = 1; i <= 7; i++)
        if (!(test_velocity(&b.e, i)[0] < -50))
          fail_msg("%s: particle %u passed the %s", methods[k].name, i, shapes[q]);
      balanced(&b, 1e-12);
      test_engine_close(&b.e);
    }
}

/* A mesh of a box is a box: the same bounces, among them a chain of them with a moving and turning one, to rounding;
 * and what flies at 100 m/s does not pass its plate of 1 mm. Its distance is searched by halves, to rounding of 1e-15
 * m. */
static const double faces[] = {1, 3, 4, 1, 4, 2, 5, 6, 8, 5, 8, 7, 1, 2, 6, 1, 6, 5,
                               3, 7, 8, 3, 8, 4, 1, 5, 7, 1, 7, 3, 2, 4, 8, 2, 8, 6};

static void thrown(const char *method, bool mesh, const double size[3], double turning, double speed, double out[60]) {
  bench b;
  open_bench(&b, method, 1.0 / 60);
  for (int i = 0; i < 10; i++) put(&b, (double[]){-1 - 0.31 * i, 0.3 * sin(i), 0.02 * i}, (double[]){speed, 0, 0});
  hk_plugin_spec *o = add(&b, mesh ? "mesh" : "box", 0.7, 0.1);
  double vertices[24];
  for (int k = 0; k < 24; k++) vertices[k] = (k / 3 >> k % 3 & 1 ? 0.5 : -0.5) * size[k % 3];
  test_vector(&b.e, o, "size", size[0], size[1], size[2]);
  if (mesh) test_list(&b.e, o, "vertices", vertices, 24);
  if (mesh) test_list(&b.e, o, "faces", faces, 36);
  test_function(&b.e, o, "rotation", (hk_function){.call = turned, .context = &turning});
  test_run(&b.e);
  test_advance(&b.e, 1);
  memcpy(out, b.e.run->state.X, 60 * sizeof *out);
  balanced(&b, 1e-12);
  test_engine_close(&b.e);
}

static void a_mesh_of_a_box_acts_as_a_box(void **state) {
  (void)state;
  double a[60], c[60];
  for (size_t k = 0; k < METHODS; k++)
    for (int q = 0; q < 3; q++) {
      static const double size[3][3] = {{0.3, 1, 1}, {0.3, 1, 1}, {1e-3, 1, 1}}, turning[] = {0, 1.3, 0},
                          speed[] = {5, 5, 100};
      thrown(methods[k].name, false, size[q], turning[q], speed[q], a);
      thrown(methods[k].name, true, size[q], turning[q], speed[q], c);
      for (int i = 0; i < 60; i++)
        if (!(fabs(a[i] - c[i]) < 1e-9))
          fail_msg("%s, case %d: %d: %g instead of %g", methods[k].name, q, i, c[i], a[i]);
      for (int i = 0; q == 2 && i < 10; i++) assert_true(c[30 + 3 * i] < 0);
    }
}

/* From the top of a smooth sphere a particle slides off and leaves it where it has sunk by R/3; it lands beside, on the
 * plane through the centre, where the parabola from there meets it. Started with 0.1 m/s; cos = 2/3 + v^2/(3 g R). */
static double leaves(const char *method, double h) {
  bench b;
  double R = 0.5, v0 = 0.1, cosine = 2.0 / 3 + v0 * v0 / (3 * g * R), sine = sqrt(1 - cosine * cosine);
  open_bench(&b, method, h);
  put(&b, (double[]){0, 0, R}, (double[]){v0, 0, 0});
  fall(&b);
  test_vector(&b.e, add(&b, "sphere", 0, 0), "size", 2 * R, 2 * R, 2 * R);
  test_run(&b.e);
  double v = sqrt(g * R * cosine), vx = v * cosine, vz = -v * sine;
  for (int k = 1; k < 200; k++) {
    test_advance(&b.e, k / 60.0);
    const double *x = test_position(&b.e, 1);
    if (x[2] > 0) continue;
    double fallen = (vz + sqrt(vz * vz + 2 * g * (R * cosine - x[2]))) / g, wanted = R * sine + vx * fallen;
    double off = fabs(x[0] - wanted);
    balanced(&b, 0.1);
    test_engine_close(&b.e);
    return off;
  }
  fail_msg("it stays on the sphere");
  return NAN;
}

/* Contact on a curved surface is of order 2. */
static void a_particle_leaves_a_smooth_sphere_at_two_thirds(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    double a = leaves(methods[k].name, 1.0 / 60), c = leaves(methods[k].name, 1.0 / 960);
    print_message("sphere,      %-18s lands %.1e, %.1e m off\n", methods[k].name, a, c);
    bool adaptive = strcmp(methods[k].name, "dopri5") == 0; /* by itself it takes steps of 1/60 s in both runs */
    assert_true(a < (methods[k].order > 1 ? 1e-4 : 4e-3) &&
                (adaptive || log2(a / c) / 4 > (methods[k].order > 1 ? 1.7 : 0.6)));
  }
}

/* In a hollow box of 1 m with gravity, e = 1: a long chain of bounces that keeps its energy, in steps of 5 m. */
static void a_closed_box_keeps_its_particles_and_their_energy(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    for (int i = 0; i < 20; i++)
      put(&b, (double[]){0.4 * sin(i), 0.4 * cos(2 * i), 0.4 * sin(3 * i)},
          (double[]){16.0 * i * sin(5 * i), 7.0 * i, -9.0 * i});
    fall(&b);
    test_boolean(&b.e, add(&b, "box", 1, 0), "hollow", true);
    test_run(&b.e);
    test_advance(&b.e, 1);
    for (uint32_t i = 1; i <= 20; i++)
      for (int c = 0; c < 3; c++) assert_true(fabs(test_position(&b.e, i)[c]) <= 0.5 + 1e-15);
    balanced(&b, methods[k].order == 1 ? 0.01 : 1e-11);
    test_engine_close(&b.e);
  }
}

/* Two walls and a floor, e = 0: into the corner, and to rest in it. */
static void a_corner_stops_what_slides_into_it(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){1, 1, 0.5}, (double[]){-3, -2, 0});
    fall(&b);
    for (int c = 0; c < 3; c++) test_vector(&b.e, add(&b, "plane", 0.3, 0.02), "normal", c == 0, c == 1, c == 2);
    test_run(&b.e);
    test_advance(&b.e, 20);
    const double *x = test_position(&b.e, 1);
    assert_true(x[0] > -exact && x[1] > -exact && fabs(x[2]) < exact);
    assert_true(distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}) == 0);
    balanced(&b, methods[k].order == 1 ? 0.1 : 1e-12);
    test_engine_close(&b.e);
  }
}

/* A wedge of two planes that are not at right angles: it comes to rest at the bottom. */
static void a_wedge_holds(void **state) {
  (void)state;
  for (size_t k = 0; k < METHODS; k++) {
    bench b;
    open_bench(&b, methods[k].name, 1.0 / 60);
    put(&b, (double[]){0.1, 0, 1}, (double[]){0, 0, 0});
    fall(&b);
    test_vector(&b.e, add(&b, "plane", 0.2, 0.1), "normal", 1, 0, 0.4);
    test_vector(&b.e, add(&b, "plane", 0.2, 0.1), "normal", -1, 0, 1);
    test_run(&b.e);
    test_advance(&b.e, 10);
    print_message("wedge,       %-18s %.1e m from the bottom, %.1e m/s\n", methods[k].name,
                  distance(test_position(&b.e, 1), (double[]){0, 0, 0}),
                  distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}));
    assert_true(distance(test_position(&b.e, 1), (double[]){0, 0, 0}) < 1e-9);
    assert_true(distance(test_velocity(&b.e, 1), (double[]){0, 0, 0}) < 1e-9);
    balanced(&b, 0.1);
    test_engine_close(&b.e);
  }
}

/* Plates that close on a ball at 0.475 m/s each from 1 m meet at 1.0526 s, before which bounces have no end. The run
 * says so there. */
static hk_status closing(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                         size_t room, size_t *got, hk_error *error) {
  (void)caller, (void)count, (void)room, (void)error;
  out[0] = out[1] = 0;
  out[2] = *(const double *)f->context * (0.5 - 0.475 * *t);
  *got = 3;
  return HK_OK;
}

static void a_ball_between_closed_plates_ends_the_run(void **state) {
  (void)state;
  double sides[] = {-1, 1};
  for (size_t k = 0; k < 2 * METHODS; k++) {
    bench b;
    open_bench(&b, methods[k / 2].name, 1.0 / 60);
    put(&b, (double[]){0, 0, 0.1}, (double[]){0, 0, 1});
    for (int q = 0; q < 2; q++) {
      hk_plugin_spec *plate = add(&b, "plane", k % 2 ? 1 : 0.5, 0);
      test_vector(&b.e, plate, "normal", 0, 0, -sides[q]);
      test_function(&b.e, plate, "position", (hk_function){.call = closing, .context = &sides[q]});
    }
    test_run(&b.e);
    assert_int_equal(hk_run_advance(b.e.run, 1.2, &b.e.error), HK_NOT_CONVERGED);
    if (!strstr(b.e.error.text, "takes every step back")) fail_msg("%s: %s", methods[k / 2].name, b.e.error.text);
    assert_true(fabs(hk_run_view(b.e.run)->t - 0.5 / 0.475) < 1e-3);
    test_engine_close(&b.e);
  }
}

/* Particles lie as high as their own radius, from a channel that grows or from a number. */
static void particles_have_their_radius(void **state) {
  (void)state;
  static test_result r;
  static const char *const scenes[] = {
      "radius = 0.2", "radius_channel = 'size'",
      "radius_channel = 'size', shape = 'box', size = {9, 9, 2}, position = {0, 0, -1}"};
  for (int k = 0; k < 3; k++) {
    char scene[1024];
    snprintf(scene, sizeof scene,
             "local scene = hooke.scene { duration = 1, fps = 50, dt = 0.01 }\n"
             "scene:channel('size', { initial = 0, rate = function(t) return 0.05 end })\n"
             "scene:particle { position = {0, 0, 1}, size = 0.05, mass = 1 }\n"
             "local p = scene:particle { position = {1, 0, 1}, size = 0.15, mass = 1 }\n"
             "scene:force('gravity')\nscene:corrector('obstacle', { %s })\n"
             "scene:measure('m', function(s) return s:position(p)[3] + 10 * s:position(1)[3] end)\nreturn scene\n",
             scenes[k]);
    test_write("radius.lua", scene);
    test_hooke(&r, NULL, "run radius.lua --json --quiet --no-output");
    if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
    assert_true(fabs(test_json(r.out, "m") - (k ? 0.2 + 10 * 0.1 : 0.2 + 10 * 0.2)) < 1e-12);
  }
}

/* ---- what a scene may get wrong ---- */

static void particles_inside_at_the_start_are_counted(void **state) {
  (void)state;
  bench b;
  open_bench(&b, "leapfrog", 0.01);
  for (int i = 0; i < 5; i++) put(&b, (double[]){i, 0, i < 3 ? -0.1 * (i + 1) : 1}, (double[]){0, 0, 0});
  add(&b, "plane", 0, 0);
  test_run(&b.e);
  assert_int_equal(b.e.run->warnings.count, 1);
  assert_non_null(
      strstr(b.e.run->warnings.text[0], "3 particles start inside the obstacle, by up to 0.3 m (particle 3)"));
  test_advance(&b.e, 0.01);
  for (uint32_t i = 1; i <= 3; i++) assert_true(test_position(&b.e, i)[2] == 0);
  test_engine_close(&b.e);
}

static void refused(const char *name, const char *text, const double *v, const char *wanted) {
  bench b;
  open_bench(&b, "leapfrog", 0.01);
  put(&b, (double[]){0, 0, 3}, (double[]){0, 0, 0});
  hk_plugin_spec *o = add(&b, "capsule", 0, 0);
  if (text) test_text(&b.e, o, name, text);
  if (v) test_vector(&b.e, o, name, v[0], v[1], v[2]);
  assert_int_equal(hk_run_open(b.e.scene, &b.e.options, &b.e.run, &b.e.error), HK_BAD_PARAM);
  if (!strstr(b.e.error.text, wanted)) fail_msg("%s", b.e.error.text);
  test_engine_close(&b.e);
}

static void what_is_no_shape_is_refused(void **state) {
  (void)state;
  refused("normal", NULL, (double[]){0, 0, 0}, "normal: it has no length");
  refused("size", NULL, (double[]){1, 1, 0}, "size: 0 m along axis 3 must be above 0");
  refused("size", NULL, (double[]){1, 2, 3}, "size: a capsule is round, but its diameters are 1 and 2 m");
  refused("size", NULL, (double[]){1, 1, 0.5}, "shorter than its diameter");
  refused("radius_channel", "width", NULL, "the scene has no channel 'width'");
}

static void a_sliding_pin_is_refused_where_it_meets_something(void **state) {
  (void)state;
  bench b;
  open_bench(&b, "leapfrog", 0.01);
  put(&b, (double[]){0, 0, 0.01}, (double[]){0, 0, 0});
  test_pin(&b.e, HK_PIN_LINE, 1, (const double[]){sqrt(0.5), 0, sqrt(0.5)});
  fall(&b);
  add(&b, "plane", 0, 0);
  test_run(&b.e);
  assert_int_equal(hk_run_advance(b.e.run, 1, &b.e.error), HK_FAILED);
  assert_non_null(strstr(b.e.error.text, "particle 1 slides on a pin and meets an obstacle"));
  test_engine_close(&b.e);
}

/* ---- bits ---- */

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { N = 3000 };
  double *first = malloc(6 * N * sizeof *first);
  for (int threads = 1; threads <= 3; threads++) {
    bench b;
    open_bench(&b, "leapfrog", 0.01);
    b.e.scene->threads = threads;
    for (int i = 0; i < N; i++) put(&b, (double[]){sin(i), cos(i), 1 + sin(3 * i) / 2}, (double[]){sin(5 * i), 0, 0});
    fall(&b);
    add(&b, "plane", 0.7, 0.2);
    test_vector(&b.e, add(&b, "sphere", 0.9, 0.1), "size", 0.6, 0.6, 0.6);
    test_run(&b.e);
    test_advance(&b.e, 1);
    const hk_state *s = &b.e.run->state;
    if (threads == 1) memcpy(first, s->X, 6 * N * sizeof *first);
    assert_memory_equal(first, s->X, 6 * N * sizeof *first);
    test_engine_close(&b.e);
  }
  free(first);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ten_bounces_against_the_closed_form),
      cmocka_unit_test(bounces_with_drag_converge),
      cmocka_unit_test(a_block_on_a_slope_slides_below_half_and_holds_above),
      cmocka_unit_test(a_sliding_block_stops_where_it_should),
      cmocka_unit_test(friction_turns_with_the_motion),
      cmocka_unit_test(an_impact_obeys_its_law),
      cmocka_unit_test(a_resting_ball_does_not_jitter),
      cmocka_unit_test(what_presses_on_a_floor_takes_no_energy),
      cmocka_unit_test(a_lift_carries_what_lies_on_it),
      cmocka_unit_test(a_plate_that_moves_throws_back),
      cmocka_unit_test(a_turntable_carries_what_does_not_slide),
      cmocka_unit_test(a_turning_bar_bats),
      cmocka_unit_test(a_fast_particle_does_not_pass_a_thin_box),
      cmocka_unit_test(a_mesh_of_a_box_acts_as_a_box),
      cmocka_unit_test(a_particle_leaves_a_smooth_sphere_at_two_thirds),
      cmocka_unit_test(a_closed_box_keeps_its_particles_and_their_energy),
      cmocka_unit_test(a_corner_stops_what_slides_into_it),
      cmocka_unit_test(a_wedge_holds),
      cmocka_unit_test(a_ball_between_closed_plates_ends_the_run),
      cmocka_unit_test(particles_have_their_radius),
      cmocka_unit_test(particles_inside_at_the_start_are_counted),
      cmocka_unit_test(what_is_no_shape_is_refused),
      cmocka_unit_test(a_sliding_pin_is_refused_where_it_meets_something),
      cmocka_unit_test(threads_give_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
