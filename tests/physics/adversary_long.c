/* The verdict on random scenes (tests/adversary): 60 runs, of which none may be called ok and be beyond its accuracy.
 * Before that, the reference against closed forms, and the harness against an error of known size. The seed can be
 * given: build/tests/physics/all adversary_long SEED. `make study` does more of it (tests/study/adversary.c). */
#include "tests/adversary/build.h"
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

/* Positions are of the size of metres, 5e-20 is their rounding, and 1e-15 the tolerance of a step of the reference. */
static const adv_real close_to_exact = 1e-14L;
static const double needed = 1e-8; /* a hundredth of the smallest accuracy that is asked for */
static const double pi = 3.14159265358979324;
static uint64_t first_seed = 1;

static void set_end(adv_scene *s, double fps, int frames) { s->fps = fps, s->frames = frames; }

static adv_scene empty_scene(void) { return (adv_scene){.dt = NAN, .tol = NAN, .units = {1, 1, 1, {0}}}; }

/* One particle, or the second one, is at exact(t). */
static void compare(const adv_scene *s, int particle, void (*exact)(const adv_scene *, adv_real, adv_real[3])) {
  adv_answer a;
  assert_true(adv_answer_make(&a, s));
  assert_true(a.uncertainty < needed);
  for (int k = 0; k <= s->frames; k++) {
    adv_real x[3], square = 0;
    exact(s, k / (adv_real)s->fps, x);
    for (int c = 0; c < 3; c++) x[c] -= a.x[3 * (k * s->n + particle) + c], square += x[c] * x[c];
    if (!(sqrtl(square) < close_to_exact)) fail_msg("frame %d is %Lg m off", k, sqrtl(square));
  }
  adv_answer_free(&a);
}

/* From the apocentre on x, upwards in y. */
static void kepler(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real gm = s->force[0].strength.b, r = s->x[0][0], v = s->v[0][1], a = 1 / (2 / r - v * v / gm), e = r / a - 1;
  adv_real mean = acosl(-1.0L) + sqrtl(gm / (a * a * a)) * t, E = mean;
  for (int k = 0; k < 100; k++) E -= (E - e * sinl(E) - mean) / (1 - e * cosl(E));
  x[0] = a * (e - cosl(E)), x[1] = -a * sqrtl(1 - e * e) * sinl(E), x[2] = 0;
}

static void reference_follows_kepler(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double x[3] = {1.8}, v[3] = {0, 2 * pi * sqrt(0.2 / 1.8)}; /* e = 0.8, period 1 s */
  adv_add_particle(&s, 2, x, v);
  adv_force *f = adv_add_force(&s, ADV_CENTRAL);
  f->per_mass = true, f->power = -2, f->strength.b = 4 * pi * pi;
  set_end(&s, 37, 48);
  compare(&s, 0, kepler);
}

static void oscillator(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real k = s->force[0].k, c = s->force[0].damping / 2.0L, w = sqrtl(k - c * c), L = s->force[0].rest[0];
  adv_real a = s->x[1][0] - L;
  x[0] = L + a * expl(-c * t) * (cosl(w * t) + c / w * sinl(w * t)), x[1] = x[2] = 0;
}

static void reference_follows_an_oscillator(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double at[3] = {0}, x[3] = {1};
  adv_add_particle(&s, 1, at, NULL), adv_add_particle(&s, 1, x, NULL);
  adv_add_pin(&s, 0, ADV_FIXED);
  adv_add_spring(&s, ADV_SPRINGS, 0, 1, 1e4, 3, -0.25);
  set_end(&s, 60, 60);
  compare(&s, 1, oscillator);
}

static void braked_fall(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real g = s->force[0].vector.base[2], from = s->force[1].from, rate = s->force[1].amount;
  adv_real free = fminl(t, from), u = fmaxl(0, t - from), v = g * free, last = g / rate;
  x[0] = x[1] = 0, x[2] = g * free * free / 2 + last * u - (v - last) * expm1l(-rate * u) / rate;
}

static void reference_follows_a_fall_that_is_braked_late(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double x[3] = {0};
  adv_add_particle(&s, 0.3, x, NULL);
  adv_add_gravity(&s, 0, 0, -9.81);
  adv_add_drag(&s, 40);
  s.force[1].from = 0.4519;
  set_end(&s, 60, 60);
  compare(&s, 0, braked_fall);
}

static void gyration(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real w = s->force[0].vector.base[2], v = s->v[0][0];
  x[0] = v / w * sinl(w * t), x[1] = v / w * (cosl(w * t) - 1), x[2] = s->v[0][2] * t;
}

static void reference_follows_a_gyration(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double x[3] = {0}, v[3] = {2, 0, 0.5};
  adv_add_particle(&s, 1, x, v);
  adv_force *f = adv_add_force(&s, ADV_MAGNETIC);
  f->per_mass = true, f->amount = 1;
  adv_set_constant(&f->vector, 0, 0, 50);
  set_end(&s, 60, 60);
  compare(&s, 0, gyration);
}

/* A fall into a rope and the throw out of it; the same formulas as in tests/hard/slack_by_the_clock.lua. */
static void bounce(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real k = s->force[0].k, L = s->force[0].rest[0], g = -(adv_real)s->force[1].vector.base[2], z0 = s->x[1][2];
  adv_real w = sqrtl(k), t1 = sqrtl(2 * (L + z0) / g), v1 = g * t1, rest = g / k;
  adv_real size = sqrtl(rest * rest + v1 / w * (v1 / w)), phase = atan2l(v1 / w, -rest), t2 = t1 + 2 * phase / w;
  x[0] = x[1] = 0;
  x[2] = -L - rest - size * cosl(w * (t - t1) - phase);
  if (t < t1) x[2] = z0 - g * t * t / 2;
  if (t >= t2) x[2] = -L + v1 * (t - t2) - g * (t - t2) * (t - t2) / 2;
}

static void reference_follows_a_fall_into_a_rope(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double at[3] = {0}, x[3] = {0, 0, -0.2};
  adv_add_particle(&s, 1, at, NULL), adv_add_particle(&s, 1, x, NULL);
  adv_add_pin(&s, 0, ADV_FIXED);
  adv_add_spring(&s, ADV_ROPES, 0, 1, 400, 0, 0.8);
  adv_add_gravity(&s, 0, 0, -9.81);
  set_end(&s, 50, 45);
  compare(&s, 1, bounce);
}

static adv_real answer_to_ramp(adv_real w, adv_real v, adv_real t) { return t > 0 ? v * (t - sinl(w * t) / w) : 0; }

/* A spring without a rest length behind a pin that is snatched aside. */
static void snatched(const adv_scene *s, adv_real t, adv_real x[3]) {
  const adv_wave *f = &s->pin[0].path.wave;
  adv_real w = sqrtl(s->force[0].k);
  x[0] = answer_to_ramp(w, f->a, t - f->t0) - answer_to_ramp(w, f->a, t - f->t1), x[1] = x[2] = 0;
}

static void reference_follows_a_pin_that_is_snatched(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double at[3] = {0};
  adv_add_particle(&s, 1, at, NULL), adv_add_particle(&s, 1, at, NULL);
  adv_pin *p = adv_add_pin(&s, 0, ADV_PATH);
  p->path.along[0] = 1, p->path.wave = (adv_wave){ADV_RAMP, 20, 0, 0, 0.50371, 0.50871};
  adv_add_spring(&s, ADV_SPRINGS, 0, 1, 100, 0, 0);
  set_end(&s, 60, 60);
  compare(&s, 1, snatched);
}

/* Two masses on a bar in free flight turn about their centre steadily. */
static void dumbbell(const adv_scene *s, adv_real t, adv_real x[3]) {
  adv_real m1 = s->mass[0], m2 = s->mass[1], L = s->x[1][0], w = s->v[1][1] / L, centre = m2 / (m1 + m2) * L;
  adv_real r = L - centre, drift = m2 * s->v[1][1] / (m1 + m2);
  x[0] = centre + r * cosl(w * t), x[1] = drift * t + r * sinl(w * t), x[2] = 0;
}

static void reference_follows_a_dumbbell(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  double at[3] = {0}, x[3] = {0.75}, v[3] = {0, 4.5};
  adv_add_particle(&s, 3, at, NULL), adv_add_particle(&s, 0.5, x, v);
  adv_add_edge(&s, adv_add_force(&s, ADV_BARS), 0, 1, 0);
  set_end(&s, 50, 60);
  compare(&s, 1, dumbbell);
}

/* ---- The harness ---- */

/* Powers of two round nothing, so a run in other units has the same error to the last bit. */
static void other_units_leave_the_error_as_it_is(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  adv_answer a;
  adv_run r[2] = {{.method = "leapfrog", .accuracy = 1e-3}, {.method = "leapfrog", .accuracy = 1e-3}};
  double at[3] = {0}, x[3] = {1};
  adv_add_particle(&s, 1, at, NULL), adv_add_particle(&s, 0.5, x, NULL);
  adv_add_pin(&s, 0, ADV_FIXED);
  adv_add_spring(&s, ADV_SPRINGS, 0, 1, 100, 0.25, -0.25);
  adv_add_gravity(&s, 0, 0, -2), adv_add_drag(&s, 0.5);
  s.dt = 0x1p-10, s.units = (adv_units){1, 1, 1, {0}};
  set_end(&s, 64, 32);
  assert_true(adv_answer_make(&a, &s));
  adv_run_make(&r[0], HK_BUILD "/hooke", test_folder(), &s, &a);
  s.units = (adv_units){0x1p-30, 0x1p20, 0x1p-10, {0}};
  adv_run_make(&r[1], HK_BUILD "/hooke", test_folder(), &s, &a);
  assert_true(r[0].end == ADV_OK && r[1].end == ADV_OK && r[0].error > 1e-8);
  assert_true(fabs(r[0].error - r[1].error) < 1e-13);
  adv_answer_free(&a);
}

/* Free flight is right to rounding; the answer is moved by 0.3 m in one frame. */
static void the_largest_error_of_all_frames_counts(void **state) {
  (void)state;
  adv_scene s = empty_scene();
  adv_answer a;
  adv_run r = {.method = "leapfrog", .accuracy = 0.1};
  double x[3] = {0}, v[3] = {1, 2, 3};
  adv_add_particle(&s, 1, x, v);
  set_end(&s, 30, 10);
  assert_true(adv_answer_make(&a, &s));
  adv_run_make(&r, HK_BUILD "/hooke", test_folder(), &s, &a);
  assert_int_equal(r.end, ADV_OK);
  assert_true(adv_run_certain(&r) && !adv_run_wrong(&r) && r.error < 1e-14);
  a.x[3 * 4 + 1] += 0.3L;
  adv_run_make(&r, HK_BUILD "/hooke", test_folder(), &s, &a);
  assert_true(r.end == ADV_OK && adv_run_wrong(&r));
  assert_true(fabs(r.error - 0.3) < 1e-14);
  adv_answer_free(&a);
}

static void nothing_wrong_is_called_ok(void **state) {
  (void)state;
  adv_options o = {.hooke = HK_BUILD "/hooke", .seed = first_seed, .cases = 60, .runs = 1, .jobs = 1};
  adv_tally t;
  o.accuracies = "1e-2,1e-4,1e-6", o.dt = o.tol = NAN;
  print_message("seed %llu\n", (unsigned long long)first_seed);
  assert_true(adv_measure(&o, &t));
  assert_true(t.right > 0 && t.rightly > 0); /* both kinds were there */
  assert_int_equal(t.broken, 0);
  assert_int_equal(t.wrong, 0);
}

int main(int argc, char **argv) {
  if (argc > 1) first_seed = strtoull(argv[1], NULL, 0);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(reference_follows_kepler),
      cmocka_unit_test(reference_follows_an_oscillator),
      cmocka_unit_test(reference_follows_a_fall_that_is_braked_late),
      cmocka_unit_test(reference_follows_a_gyration),
      cmocka_unit_test(reference_follows_a_fall_into_a_rope),
      cmocka_unit_test(reference_follows_a_pin_that_is_snatched),
      cmocka_unit_test(reference_follows_a_dumbbell),
      cmocka_unit_test(other_units_leave_the_error_as_it_is),
      cmocka_unit_test(the_largest_error_of_all_frames_counts),
      cmocka_unit_test(nothing_wrong_is_called_ok),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
