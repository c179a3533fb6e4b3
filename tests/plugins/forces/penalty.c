/* The soft obstacle against closed forms of a mass on a one-sided spring. hooke check has its gradient and its blocks.
 */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, k = 1e4, mass = 2;

typedef struct bench {
  test_engine e;
  hk_plugin_spec *floor;
} bench;

static void open_bench(bench *b, const char *method, double h, const double x[3], const double v[3]) {
  test_engine_open(&b->e);
  b->e.options.integrator = method;
  b->e.options.dt = h;
  b->e.scene->duration = 10;
  b->e.scene->fps = 1 / h < 50 ? 1 / h : 50; /* NAN: the step is chosen */
  test_particle(&b->e, x[0], x[1], x[2], mass);
  memcpy(b->e.scene->particles.velocity, v, 3 * sizeof *v);
  b->floor = test_plugin(&b->e, HK_FORCE, "penalty");
}

static void fall(bench *b) { test_vector(&b->e, test_plugin(&b->e, HK_FORCE, "gravity"), "g", 0, 0, -g); }

/* Thrown at 3 m/s: pi sqrt(m/k) in contact, 3 sqrt(m/k) deep, and 3 m/s back. The jump of the stiffness at
 * both ends errs by k/m h^2 v/12 each. */
static void an_elastic_bounce_takes_half_a_period(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "rk4", "dopri5", "bdf2", "implicit_midpoint"};
  double w = sqrt(k / mass), v = 3, contact = acos(-1) / w;
  for (size_t q = 0; q < 5; q++) {
    double off[2];
    for (int fine = 0; fine < 2; fine++) {
      bench b;
      double h = fine ? 1.0 / 16000 : 1.0 / 4000;
      open_bench(&b, names[q], h, (double[]){0, 0, 0.0311}, (double[]){0, 0, -v});
      test_number(&b.e, b.floor, "k", k);
      b.e.options.tol = fine ? 1e-9 : 1e-7;
      test_run(&b.e);
      test_advance(&b.e, 0.1);
      double back = v * (0.1 - contact) - 0.0311;
      off[fine] = fabs(test_position(&b.e, 1)[2] - back);
      hk_summary s;
      hk_run_summary(b.e.run, &s);
      assert_true(fabs(s.energy_drift) < 1e-3);
      test_engine_close(&b.e);
    }
    print_message("elastic,  %-18s off by %.1e, %.1e m\n", names[q], off[0], off[1]);
    for (int fine = 0; fine < 2;
         fine++) /* over the 0.1 s of the run; bdf2's phase, (h w)^2/3 of the swing, is four times that */
      assert_true(off[fine] < (q == 3 ? 8 : 2) * v * pow(w * (fine ? 1.0 / 16000 : 1.0 / 4000), 2) / 12 * 0.1);
  }
}

/* What bounces for 1.5 s, at the step that is chosen, keeps its energy: each end of a contact, within a step, changes
 * it by (h w)^2/4 of what the spring takes up at most (largest_step.c), and a fall from 0.2 m, the lowest, begins and
 * ends fewer than five contacts in that time. */
static void bounces_keep_their_energy_at_the_step_chosen(void **state) {
  (void)state;
  double h_w = acos(-1) / 20, most = 0;
  for (int q = 0; q < 8; q++) {
    bench b;
    hk_summary s;
    open_bench(&b, "leapfrog", NAN, (double[]){0, 0, 0.2 + 0.05 * q}, (double[]){0, 0, 0});
    test_number(&b.e, b.floor, "k", k);
    fall(&b);
    test_run(&b.e);
    test_advance(&b.e, 1.5);
    hk_run_summary(b.e.run, &s);
    most = fmax(most, fabs(s.energy_drift));
    test_engine_close(&b.e);
  }
  print_message("bounces at the step chosen: energy off by %.2g of the largest kinetic one\n", most);
  assert_true(most < 10 * h_w * h_w / 4);
}

/* e = 1 - 2/3 b v + O((b v)^2), b v = 0.03 to 0.12. */
static void damping_gives_its_restitution(void **state) {
  (void)state;
  for (double v = 0.5; v < 3; v *= 2) {
    bench b;
    double damping = 0.06;
    open_bench(&b, "rk4", 1e-4, (double[]){0, 0, 0.01}, (double[]){0, 0, -v});
    test_number(&b.e, b.floor, "k", k);
    test_number(&b.e, b.floor, "damping", damping);
    test_run(&b.e);
    test_advance(&b.e, 0.2);
    double e = test_velocity(&b.e, 1)[2] / v, wanted = 1 - 2.0 / 3 * damping * v;
    print_message("damped,   e = %.6f at %g m/s, %.6f\n", e, v, wanted);
    assert_true(fabs(e - wanted) < pow(damping * v, 2));
    hk_summary s;
    hk_run_summary(b.e.run, &s);
    assert_true(fabs(s.energy_drift) < 1e-4 &&
                fabs(s.energy_work - mass / 2 * v * v * (e * e - 1)) < 1e-4 * mass * v * v);
    test_engine_close(&b.e);
  }
}

/* At rest m g/k deep, for explicit and implicit steps; there is damping by the depth alone, so it rings for a while. */
static void what_lies_sinks_by_its_weight_over_k(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "rk4", "bdf2", "implicit_midpoint", "tr_bdf2"};
  for (size_t q = 0; q < 5; q++) {
    bench b;
    open_bench(&b, names[q], 1e-3, (double[]){0, 0, 0.003 - mass * g / k}, (double[]){0, 0, 0});
    test_number(&b.e, b.floor, "k", k);
    test_number(&b.e, b.floor, "damping", 100);
    test_number(&b.e, b.floor, "radius", 0.003);
    fall(&b);
    test_run(&b.e);
    test_advance(&b.e, 0.5);
    assert_true(fabs(test_position(&b.e, 1)[2] - 0.003 + mass * g / k) < 1e-9);
    test_engine_close(&b.e);
  }
}

/* On a slope of tan = 1/2 a block creeps at the speed at which friction bears it, s (1/2)/sqrt(mu^2 - 1/4), and slides
 * freely below mu = 1/2. */
static void a_block_on_a_slope_creeps_above_half_and_slides_below(void **state) {
  (void)state;
  for (int q = 0; q < 2; q++) {
    bench b;
    double mu = q ? 0.4 : 0.6, c = 2 / sqrt(5), slip = 1e-2, depth = mass * g * c / k;
    open_bench(&b, "rk4", 1e-4, (double[]){-depth / sqrt(5), 0, -depth * c}, (double[]){0, 0, 0});
    test_number(&b.e, b.floor, "k", k);
    test_number(&b.e, b.floor, "friction", mu);
    test_number(&b.e, b.floor, "slip", slip);
    test_vector(&b.e, b.floor, "normal", 1, 0, 2);
    fall(&b);
    test_run(&b.e);
    test_advance(&b.e, 0.5);
    const double *v = test_velocity(&b.e, 1);
    double speed = hypot(v[0], v[2]), creep = slip * 0.5 / sqrt(mu * mu - 0.25),
           free = g * (1 - 2 * mu) / sqrt(5) * 0.5;
    print_message("slope,    %.6f m/s at mu = %g, %.6f\n", speed, mu, q ? free : creep);
    if (q)
      assert_true(speed > free &&
                  speed < free + slip * 2 * mu /
                                     (1 - 2 * mu)); /* less friction at first: integral of 1 - u/sqrt(u^2 + s^2) */
    else
      assert_true(fabs(speed - creep) < 1e-6 * slip);
    test_engine_close(&b.e);
  }
}

/* Steps of 1 m past a plate of 1 mm: the verdict says that they miss it. (Explicit methods are told that their
 * steps are unstable, or k is so small that the plate would hardly slow the particle down.) */
static void a_plate_that_steps_pass_by_is_named(void **state) {
  (void)state;
  static const char *const shapes[] = {"box", "sphere", "cylinder", "capsule"};
  for (int q = 0; q < 4; q++) {
    bench b;
    hk_summary s;
    open_bench(&b, "bdf2", 1.0 / 60, (double[]){-1.3, 1e-4, 0}, (double[]){100, 0, 0});
    test_text(&b.e, b.floor, "shape", shapes[q]);
    test_number(&b.e, b.floor, "k", 1e12); /* 125 kJ to the middle of 1 mm, of 10 kJ that it has */
    if (q)
      test_vector(&b.e, b.floor, "size", 1e-2, 1e-2, 1e-2);
    else
      test_vector(&b.e, b.floor, "size", 1e-3, 1, 1);
    b.e.scene->duration = 0.1;
    b.e.options.compare = HK_COMPARE_ALWAYS;
    test_run(&b.e);
    test_advance(&b.e, 0.1);
    assert_true(test_velocity(&b.e, 1)[0] == 100);
    assert_int_equal(hk_run_close(b.e.run, &b.e.error), HK_OK);
    hk_run_summary(b.e.run, &s);
    print_message("%s: %s\n", shapes[q], s.reason);
    assert_true(s.verdict == HK_INACCURATE && strstr(s.reason, "penalty"));
    test_engine_close(&b.e);
  }
}

static hk_status lifted(const hk_function *f, const void *caller, const double *t, size_t count, double *out,
                        size_t room, size_t *got, hk_error *error) {
  (void)caller, (void)count, (void)room, (void)error;
  out[0] = out[1] = 0;
  out[2] = f->context ? 0.4 * cos(2 * *t) : 0.2 * sin(2 * *t);
  *got = 3;
  return HK_OK;
}

/* A floor that moves and brakes has to say how fast it is. */
static void a_moving_obstacle_needs_its_velocity(void **state) {
  (void)state;
  for (int given = 0; given < 2; given++) {
    bench b;
    open_bench(&b, "rk4", 1e-3, (double[]){0, 0, -mass * g / k}, (double[]){0, 0, 0.4});
    test_number(&b.e, b.floor, "k", k);
    test_number(&b.e, b.floor, "damping", 20);
    test_function(&b.e, b.floor, "position", (hk_function){.call = lifted});
    if (given) test_function(&b.e, b.floor, "velocity", (hk_function){.call = lifted, .context = &b});
    fall(&b);
    test_run(&b.e);
    hk_status status = hk_run_advance(b.e.run, 1, &b.e.error);
    if (given) {
      /* m (g + a)/k below the floor, a = -0.8 sin 2t, as far as that changes slowly: w^2 = 5000 against 4 */
      double depth = mass * (g - 0.8 * sin(2)) / k;
      assert_true(status == HK_OK && fabs(test_position(&b.e, 1)[2] - 0.2 * sin(2) + depth) < 1e-2 * depth);
    } else {
      assert_int_equal(status, HK_BAD_PARAM);
      assert_non_null(strstr(b.e.error.text, "need its velocity"));
    }
    test_engine_close(&b.e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_elastic_bounce_takes_half_a_period),
      cmocka_unit_test(bounces_keep_their_energy_at_the_step_chosen),
      cmocka_unit_test(damping_gives_its_restitution),
      cmocka_unit_test(what_lies_sinks_by_its_weight_over_k),
      cmocka_unit_test(a_block_on_a_slope_creeps_above_half_and_slides_below),
      cmocka_unit_test(a_plate_that_steps_pass_by_is_named),
      cmocka_unit_test(a_moving_obstacle_needs_its_velocity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
