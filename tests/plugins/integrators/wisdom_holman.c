/* Orbits about a heavy body: two bodies at any step, planets to many digits in few evaluations, the powers of the ratio
 * of the masses, energy over ten thousand orbits, and what it does with all that is no orbit. */
#include "tests/support/fake_system.h"
#include "tests/support/nbody_scenes.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double turn = 6.283185307179586;

/* ---- a system of three bodies, by hand ---- */

enum { N = 3, WIDTH = 1 };

typedef struct force {
  const double *mass;
  double G, field, drag; /* m^3/(kg s^2), m/s^2, 1/s */
} force;

static void add(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                double *dy) {
  const force *f = context;
  (void)t, (void)y;
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < i; j++) {
      double d[3], square = 0;
      for (size_t c = 0; c < 3; c++) d[c] = x[3 * j + c] - x[3 * i + c], square += d[c] * d[c];
      for (size_t c = 0; c < 3; c++) {
        double pull = f->G * d[c] / (square * sqrt(square));
        a[3 * i + c] += f->mass[j] * pull, a[3 * j + c] -= f->mass[i] * pull;
      }
    }
  for (size_t e = 0; e < 3 * N; e++) a[e] -= f->drag * v[e];
  for (size_t i = 0; i < N; i++) a[3 * i + 2] += f->field, dy[i] = x[3 * i];
  for (size_t e = 0; e < 3 * N; e++) dy[N * WIDTH] -= f->mass[e / 3] * f->drag * v[e] * v[e];
}

typedef struct trio {
  fake_system *system;
  fake_method method;
} trio;

/* A sun of 1 kg and planets at 1 and 2.1 m, of eccentricities of some tenths, G = 1; their centre of mass is at rest.
 */
static trio open_trio(const char *method, force *f, const double *mass) {
  static const double x[3 * N] = {0.1, 0.2, 0.3, 1.1, 0.2, 0.35, 0.1, -1.9, 0.3};
  static const double v[3 * N] = {0, 0, 0, 0.02, 1.1, 0.01, 0.75, 0, 0.05};
  trio t;
  f->mass = mass;
  t.system = fake_system_create(
      &(fake_problem){N, WIDTH, HK_DEPENDS_ON_X | (f->drag > 0 ? (unsigned)HK_DEPENDS_ON_V : 0), add, f});
  memcpy(t.system->mass, mass, N * sizeof *mass);
  memcpy(t.system->system.X, x, sizeof x);
  memcpy(t.system->system.X + 3 * N, v, sizeof v);
  for (size_t e = 3; e < 3 * N; e++) t.system->system.X[3 * N + e % 3] -= mass[e / 3] * v[e] / mass[0];
  t.method = fake_method_open(method, t.system);
  return t;
}

static void close_trio(trio *t) {
  fake_method_close(&t->method);
  fake_system_destroy(t->system);
}

/* The end after T s in `steps`, all of X, into `end`. */
static void run_trio(const char *method, force f, const double *mass, double T, size_t steps, double *end) {
  trio t = open_trio(method, &f, mass);
  fake_method_run(&t.method, T, steps);
  memcpy(end, t.system->system.X, t.system->system.size * sizeof *end);
  close_trio(&t);
}

enum { SIZE = (6 + WIDTH) * N + 1 };

/* Beside kahan_li8 with 4,000 steps, whose error is rounding here; of the places, or of the numbers from `first` on. */
static double off(force f, const double *mass, double T, size_t steps, size_t first, size_t count) {
  double end[SIZE], right[SIZE], most = 0;
  run_trio("wisdom_holman", f, mass, T, steps, end);
  run_trio(f.drag > 0 ? "rk4" : "kahan_li8", f, mass, T, f.drag > 0 ? 40000 : 4000, right);
  for (size_t e = first; e < first + count; e++) most = fmax(most, fabs(end[e] - right[e]));
  return most;
}

static void without_other_masses_any_step_is_exact(void **state) {
  (void)state;
  static const double mass[N] = {1, 1e-30, 1e-30};
  for (size_t steps = 1; steps <= 3; steps++) {
    double error = off((force){.G = 1}, mass, 20, steps, 0, 3 * N);
    print_message("%zu steps: %.2e\n", steps, error);
    assert_true(error < 3e-12);
  }
}

/* In steps of a half and a quarter of the inner turn: at a ratio of 1e-6 what is left is e h^10; at 1e-2, of powers of
 * h from 4 to 6, it is the square of the ratio that matters. */
static void errors_fall_with_the_ratio_of_the_masses(void **state) {
  (void)state;
  static const double small[N] = {1, 1e-6, 2e-6}, large[N] = {1, 0.01, 0.02};
  force f = {.G = 1};
  double light[2], heavy[2];
  for (size_t k = 0; k < 2; k++) {
    light[k] = off(f, small, 30, k ? 18 : 10, 0, 3 * N);
    heavy[k] = off(f, large, 30, k ? 36 : 18, 0, 3 * N);
  }
  print_message("ratio 1e-6: %.2e, %.2e; ratio 1e-2: %.2e, %.2e\n", light[0], light[1], heavy[0], heavy[1]);
  assert_true(log(light[0] / light[1]) / log(1.8) > 9 && light[1] < 1e-5 * heavy[0]);
  assert_true(log2(heavy[0] / heavy[1]) > 3.8);
}

/* A field on all is a kick that moves the centre of mass as a fall does, and channels and drag are integrated with it.
 */
static void further_forces_are_kicks(void **state) {
  (void)state;
  static const double mass[N] = {1, 1e-3, 3e-4};
  force field = {.G = 1, .field = 0.01};
  double places = off(field, mass, 10, 60, 0, 3 * N), channels = off(field, mass, 10, 60, 6 * N, N);
  print_message("field %.2e, channels %.2e\n", places, channels);
  force drag = {.G = 1, .drag = 0.01};
  double coarse = off(drag, mass, 10, 60, 0, SIZE), fine = off(drag, mass, 10, 120, 0, SIZE);
  print_message("drag %.2e and %.2e\n", coarse, fine);
  assert_true(places < 1e-8 && channels < 1e-7);
  assert_true(coarse < 1e-5 && fabs(log2(coarse / fine) - 2) < 0.2);
}

/* What a checkpoint holds, and a step that fails. */
static void fields_carry_a_run_on(void **state) {
  (void)state;
  static const double mass[N] = {1, 1e-3, 3e-4};
  force f = {.G = 1, .drag = 0.01}, g = f;
  trio a = open_trio("wisdom_holman", &f, mass), b = open_trio("wisdom_holman", &g, mass);
  double *from[256], *to[256];
  char numbers[256];
  for (int k = 0; k < 5; k++) assert_int_equal(fake_method_step(&a.method, 0.3, NULL), HK_OK);
  fake_system_fail(a.system, 3, HK_FAILED);
  double before = a.system->system.X[3];
  assert_int_equal(fake_method_step(&a.method, 0.3, NULL), HK_FAILED);
  assert_true(a.system->system.X[3] == before);
  fake_system_fail(a.system, 0, HK_OK);
  assert_int_equal(fake_method_step(&a.method, 0.3, NULL), HK_OK);
  size_t count = fake_method_memory(&a.method, from, 256);
  assert_int_equal(count, fake_method_memory(&b.method, to, 256));
  for (size_t e = 0; e < count; e++) *to[e] = *from[e];
  fake_method_save(&a.method, numbers);
  fake_method_load(&b.method, numbers);
  for (int k = 0; k < 5; k++) {
    assert_int_equal(fake_method_step(&a.method, 0.3, NULL), HK_OK);
    assert_int_equal(fake_method_step(&b.method, 0.3, NULL), HK_OK);
  }
  assert_memory_equal(a.system->system.X, b.system->system.X, SIZE * sizeof(double));
  close_trio(&a);
  close_trio(&b);
}

static void totals(const trio *t, double sum[4]) {
  const double *x = t->system->system.X, *v = x + 3 * N, *m = t->system->mass;
  memset(sum, 0, 4 * sizeof *sum);
  for (size_t i = 0; i < N; i++) {
    sum[0] += m[i] * v[3 * i], sum[1] += m[i] * (x[3 * i] * v[3 * i + 1] - x[3 * i + 1] * v[3 * i]);
    for (size_t c = 0; c < 3; c++) sum[2] += m[i] * v[3 * i + c] * v[3 * i + c] / 2;
    for (size_t j = 0; j < i; j++) {
      double square = 0;
      for (size_t c = 0; c < 3; c++) square += pow(x[3 * i + c] - x[3 * j + c], 2);
      sum[2] -= m[i] * m[j] / sqrt(square);
    }
  }
  sum[3] = fabs(sum[2]);
}

/* Over ten thousand turns of the inner planet: of the energy what it is off in the first tenth and in the last, of the
 * angular momentum what it is off at the end, and of the momentum. */
static void walk(double steps_of_a_turn, double *first, double *last, double *turning, double *moving) {
  static const double mass[N] = {1, 1e-3, 3e-4};
  force f = {.G = 1};
  trio t = open_trio("wisdom_holman", &f, mass);
  size_t steps = (size_t)(1e4 * steps_of_a_turn);
  double start[4], now[4], part[10] = {0};
  totals(&t, start);
  for (size_t k = 0; k < steps; k++) {
    assert_int_equal(fake_method_step(&t.method, turn / steps_of_a_turn, NULL), HK_OK);
    totals(&t, now);
    part[10 * k / steps] = fmax(part[10 * k / steps], fabs(now[2] - start[2]) / start[3]);
  }
  *first = part[0], *last = part[9], *turning = fabs(now[1] / start[1] - 1), *moving = fabs(now[0] - start[0]);
  print_message("%g steps a turn: energy %.2e and %.2e, momenta %.1e, %.1e\n", steps_of_a_turn, *first, *last, *turning,
                *moving);
  close_trio(&t);
}

/* With four steps a turn the energy is off by the method's own error, and no farther in the end. With twelve all is
 * roundings, which walk at random: 1e-16 for each of a million drifts is 1e-13. */
static void energy_does_not_drift_over_ten_thousand_orbits(void **state) {
  (void)state;
  double first, last, turning, moving;
  walk(4, &first, &last, &turning, &moving);
  assert_true(first > 1e-11 && first < 1e-5 && last < 1.5 * first && turning < 1e-12 && moving < 1e-14);
  walk(12, &first, &last, &turning, &moving);
  assert_true(last < 5e-12 && turning < 1e-12 && moving < 1e-14);
}

/* ---- scenes ---- */

/* Hairer, Lubich and Wanner's planets: 4,000 evaluations end some 3e-9 of the earth's distance off, where kahan_li8
 * takes 13,600 to 2.5e-5. */
static void planets_end_where_they_are_known_to(void **state) {
  (void)state;
  size_t evaluations;
  double coarse = nbody_error(&nbody_solar, "wisdom_holman", 800, 0, &evaluations);
  double fine = nbody_error(&nbody_solar, "wisdom_holman", 400, 0, NULL);
  double other = nbody_error(&nbody_solar, "kahan_li8", 250, 0, NULL);
  print_message("%.2e in %zu evaluations, %.2e; kahan_li8 %.2e\n", coarse, evaluations, fine, other);
  assert_true(evaluations < 2020 && fine < 2e-8 && coarse / fine > 64 && other > 100 * fine);
}

static const char *only_warning(test_engine *e) { return e->run->warnings.count == 1 ? e->run->warnings.text[0] : ""; }

/* Three stars of like masses. */
static void where_no_body_is_heavy_it_says_so(void **state) {
  (void)state;
  test_engine e;
  nbody_open(&e, &nbody_pythagorean, "wisdom_holman");
  e.options.dt = 1e-3;
  test_run(&e);
  test_advance(&e, 1);
  assert_non_null(strstr(only_warning(&e), "no orbits about a heavy body"));
  test_engine_close(&e);
}

/* Particles with pins move as their pins say and pull as they do: a planet of fixed place, and one on a line. */
static void pins_are_kept(void **state) {
  static const char *const method[2] = {"wisdom_holman", "kahan_li8"};
  double end[2][6];
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine e;
    test_engine_open(&e);
    test_plugin(&e, HK_INTEGRATOR, method[k]);
    test_number(&e, test_plugin(&e, HK_FORCE, "nbody"), "G", 1);
    test_particle(&e, 0, 0, 0, 1);
    uint32_t planet = test_particle(&e, 1, 0, 0, 1e-3), fixed = test_particle(&e, 0, 5, 0, 1e-3);
    uint32_t slides = test_particle(&e, 3, 0, 3, 1e-3);
    e.scene->particles.velocity[3 * (planet - 1) + 1] = 1;
    test_pin(&e, HK_PIN_FIXED, fixed, NULL);
    test_pin(&e, HK_PIN_LINE, slides, (const double[]){1, 0, 0});
    e.options.dt = 0.02;
    test_run(&e);
    test_advance(&e, 2);
    assert_true(test_position(&e, fixed)[1] == 5 && test_position(&e, slides)[2] == 3);
    memcpy(end[k], test_position(&e, planet), 3 * sizeof **end);
    memcpy(end[k] + 3, test_position(&e, slides), 3 * sizeof **end);
    test_engine_close(&e);
  }
  for (int c = 0; c < 6; c++)
    if (!(fabs(end[0][c] - end[1][c]) < 1e-11)) fail_msg("%d: %.3e", c, end[0][c] - end[1][c]);
}

/* A planet that is let go after 1 s falls along its own conic section, from 3 m to below 1 m in steps of 1.05 s. In
 * straight lines between kicks it ends 2.6e-6 m off. */
static void released_pins_fall_along_orbits(void **state) {
  (void)state;
  double end[2][3];
  for (int k = 0; k < 2; k++) {
    test_engine e;
    test_engine_open(&e);
    test_plugin(&e, HK_INTEGRATOR, k ? "gauss_radau" : "wisdom_holman");
    test_number(&e, test_plugin(&e, HK_FORCE, "nbody"), "G", 1);
    test_particle(&e, 0, 0, 0, 1);
    uint32_t id = test_particle(&e, 3, 0, 0, 1e-6);
    test_particle(&e, 0, 7, 0, 1e-6);
    hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 1, .id = &id, .release = 1};
    assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
    e.scene->duration = 6.25;
    e.scene->fps = 1 / 6.25;
    if (k == 0) e.options.dt = 1.05;
    test_run(&e);
    test_advance(&e, 6.25);
    memcpy(end[k], test_position(&e, id), sizeof *end);
    test_engine_close(&e);
  }
  print_message("%.10f, %.2e off\n", end[0][0], end[0][0] - end[1][0]);
  assert_true(end[0][0] < 1 && fabs(end[0][0] - end[1][0]) < 1e-9);
}

/* A planet that is born at the end of a step goes round as others do, inside of one that was there before. */
static void newborns_go_round(void **state) {
  (void)state;
  double end[2][6];
  for (int k = 0; k < 2; k++) {
    test_engine e;
    test_engine_open(&e);
    test_plugin(&e, HK_INTEGRATOR, k ? "kahan_li8" : "wisdom_holman");
    test_number(&e, test_plugin(&e, HK_FORCE, "nbody"), "G", 1);
    test_particle(&e, 0, 0, 0, 1);
    uint32_t planet = test_particle(&e, 2, 0, 0, 1e-4);
    e.scene->particles.velocity[3 * (planet - 1) + 1] = 0.7;
    hk_plugin_spec *source = test_plugin(&e, HK_SOURCE, "emitter");
    test_number(&e, source, "burst", 1);
    test_list(&e, source, "burst_at", (const double[]){1}, 1);
    test_number(&e, source, "rate", 0);
    test_vector(&e, source, "position", 0, -1, 0);
    test_vector(&e, source, "direction", 1, 0, 0);
    test_number(&e, source, "speed", 1);
    test_number(&e, source, "mass", 1e-4);
    e.scene->duration = 7;
    e.scene->fps = 1;
    e.options.dt = k ? 1.0 / 128 : 0.25;
    test_run(&e);
    test_advance(&e, 7);
    memcpy(end[k], test_position(&e, planet), 3 * sizeof **end);
    memcpy(end[k] + 3, test_position(&e, 3), 3 * sizeof **end);
    test_engine_close(&e);
  }
  double most = 0;
  for (int c = 0; c < 6; c++) most = fmax(most, fabs(end[0][c] - end[1][c]));
  print_message("newborn at %g, %g; %.2e off\n", end[0][3], end[0][4], most);
  assert_true(most < 1e-10);
}

static void constraints_are_refused_with_a_sentence(void **state) {
  (void)state;
  test_engine e;
  nbody_open(&e, &nbody_kepler, "wisdom_holman");
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}}, 1);
  hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
  print_message("%s\n", e.error.text);
  assert_true(status != HK_OK && strstr(e.error.text, "know no multipliers"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(without_other_masses_any_step_is_exact),
      cmocka_unit_test(errors_fall_with_the_ratio_of_the_masses),
      cmocka_unit_test(further_forces_are_kicks),
      cmocka_unit_test(fields_carry_a_run_on),
      cmocka_unit_test(energy_does_not_drift_over_ten_thousand_orbits),
      cmocka_unit_test(planets_end_where_they_are_known_to),
      cmocka_unit_test(where_no_body_is_heavy_it_says_so),
      cmocka_unit_test(pins_are_kept),
      cmocka_unit_test(released_pins_fall_along_orbits),
      cmocka_unit_test(newborns_go_round),
      cmocka_unit_test(constraints_are_refused_with_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
