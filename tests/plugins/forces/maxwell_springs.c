/* Springs with a branch that relaxes: relaxation and moduli in closed form, with steps far above and below tau; orders
 * of methods and of their energy balance; derivatives within a step, events, deaths, checkpoints. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double K = 30, K_M = 50; /* N/m */

static hk_plugin_spec *maxwell(test_engine *e, const uint32_t (*edge)[2], size_t count, double tau) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "maxwell_springs");
  test_edges(e, spec, edge, count);
  test_number(e, spec, "k", K);
  test_number(e, spec, "k_m", K_M);
  test_number(e, spec, "tau", tau);
  return spec;
}

static void launch(test_engine *e, uint32_t id, double x) { e->scene->particles.velocity[3 * (size_t)(id - 1)] = x; }

/* One spring along x from the origin, led by the test. */
typedef struct bench {
  test_engine e;
  hk_instance *springs;
  hk_view view;
  double x[6], v[6];
} bench;

static void open_bench(bench *b, double tau) {
  *b = (bench){.x = {0, 0, 0, 1, 0, 0}};
  test_engine_open(&b->e);
  test_particle(&b->e, 0, 0, 0, 1), test_particle(&b->e, 1, 0, 0, 1);
  hk_plugin_spec *spec = maxwell(&b->e, (const uint32_t[][2]){{1, 2}}, 1, tau);
  b->e.options.dt = 1e-3;
  test_run(&b->e);
  b->springs = test_instance(&b->e, spec);
  b->view = force_view(&b->e, b->springs);
  b->view.x = b->x;
  b->view.v = b->v;
}

/* To the time t; returns what was dissipated. */
static double lead(bench *b, double t, double length, double rate) {
  hk_evolution report = {0};
  double h = t - b->view.t;
  b->x[3] = length;
  b->v[3] = rate;
  b->view.t = t;
  assert_int_equal(hk_force_of(b->springs->plugin)->internal.evolve(b->springs->self, &b->view, h, &report), HK_OK);
  b->e.run->state.model.t = t;
  assert_false(report.changed || report.pattern_changed);
  return report.dissipated;
}

static double tension(bench *b) {
  double F[6];
  force_evaluate(b->springs, &b->view, F);
  return F[0];
}

/* Pulled by s at once and held: f = k s + k_m s exp(-t/tau), and what is missing of k_m s^2/2 is dissipated. 1e-12:
 * rounding in some hundred steps; 1e-6 of what is dissipated: Gauss' rule on pieces of tau. */
static void a_held_spring_relaxes_by_exp_of_t_over_tau(void **state) {
  (void)state;
  const double s = 0.1, step[] = {1e-5, 0.01, 0.3, 0.999, 1.001, 7, 55, 1e9};
  for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
    bench b;
    double lost = 0, tau = 0.2;
    open_bench(&b, tau);
    lead(&b, 0, 1 + s, 0);
    assert_true(fabs(tension(&b) - (K + K_M) * s) < 1e-12);
    for (int n = 1; n <= 100; n++) {
      lost += lead(&b, n * step[k] * tau, 1 + s, 0);
      double left = exp(-n * step[k]);
      assert_true(fabs(tension(&b) - (K + K_M * left) * s) < 1e-12 * K_M);
      assert_true(fabs(lost - K_M * s * s / 2 * (1 - left * left)) < 1e-6 * K_M * s * s / 2);
    }
    test_engine_close(&b.e);
  }
}

/* l = 1 + a sin w t, after the start has gone by exp(-20): the parts of the force in phase and out of phase with it
 * over a period, as stiffnesses; their largest distance from the closed forms. And the loss of a period, pi a^2 k''. */
static double error_of_moduli(double wtau, int steps) {
  const double a = 0.1, w = 5, tau = wtau / w, pi = acos(-1);
  const double q = wtau / (1 + wtau * wtau), stored = K + K_M * wtau * q, loss = K_M * q;
  const int before = (int)ceil(20 * wtau / (2 * pi)) * steps;
  double in_phase = 0, out_of_phase = 0, lost = 0;
  bench b;
  open_bench(&b, tau);
  lead(&b, 0, 1, a * w);
  for (int n = 1; n <= before + steps; n++) {
    double angle = 2 * pi * n / steps, given = lead(&b, angle / w, 1 + a * sin(angle), a * w * cos(angle));
    if (n <= before) continue;
    lost += given;
    in_phase += tension(&b) * sin(angle) * 2 / steps / a;
    out_of_phase += tension(&b) * cos(angle) * 2 / steps / a;
  }
  test_engine_close(&b.e);
  double off = fmax(fabs(in_phase - stored), fabs(out_of_phase - loss));
  assert_true(fabs(lost / (pi * a * a) - loss) < 10 * off + 1e-6 * loss);
  return off / K_M;
}

/* The cubic is off by h^4/384 of the fourth derivative: order 4. Where a step is longer than tau the force follows the
 * rate and, times tau^2, the second derivative of the cubic, which is off by h^2: order 2 of something small. */
static void moduli_have_their_closed_forms_to_order_4(void **state) {
  (void)state;
  const double wtau[] = {0.02, 0.3, 1, 5};
  for (size_t k = 0; k < sizeof wtau / sizeof *wtau; k++) {
    double coarse = error_of_moduli(wtau[k], 20), fine = error_of_moduli(wtau[k], 40);
    print_message("w tau %-5g moduli off by %.2e of k_m with 20 steps a period, %.2e with 40: order %.2f\n", wtau[k],
                  coarse, fine, log2(coarse / fine));
    assert_true(coarse < (k ? 1e-4 : 3e-6) && log2(coarse / fine) > (k ? 3.6 : 1.9));
  }
}

/* When the time t of a step has gone the blocks are those of the force, on particles in motion, also where t is above
 * tau; at its beginning the force is the derivative of its energy, and later of a potential for given rates. */
static void force_and_blocks_are_derivatives_within_a_step(void **state) {
  (void)state;
  enum { N = 5 };
  static const uint32_t edge[][2] = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {4, 5}};
  test_engine e;
  double x[3 * N], v[3 * N];
  test_engine_open(&e);
  for (int i = 0; i < N; i++) test_particle(&e, i, 0.3 * i * i, cos(i), 1 + i);
  hk_plugin_spec *spec = maxwell(&e, edge, 5, 0.1);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *springs = test_instance(&e, spec);
  hk_view view = force_view(&e, springs);
  view.x = x, view.v = v;
  for (int q = 0; q < 3 * N; q++) x[q] = e.run->state.X[q] + 0.2 * sin(1.7 * q), v[q] = cos(2.3 * q);
  const double t[] = {0, 0.01, 0.099, 0.101, 0.5};
  for (size_t k = 0; k < sizeof t / sizeof *t; k++) {
    view.t = t[k];
    if (t[k] == 0) assert_true(force_gradient_error(springs, &view) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(springs, &view) < FORCE_DIFFERENCES);
    if (t[k] > 0) assert_true(force_damping_error(springs, &view) < FORCE_DIFFERENCES);
  }
  test_engine_close(&e);
}

/* ---- runs ---- */

/* x' = v, v' = -K x - m, m' = k_m v - m/tau from (x, 1, m) for the time t, by Taylor's series in pieces of t/1000. */
static double exact(double x, double m, double tau, double t) {
  double y[3] = {x, 1, m}, h = t / 1000;
  for (int n = 0; n < 1000; n++) {
    double term[3] = {y[0], y[1], y[2]};
    for (int q = 1; q < 15; q++) {
      double next[3] = {term[1], -K * term[0] - term[2], K_M * term[1] - term[2] / tau};
      for (int c = 0; c < 3; c++) y[c] += term[c] = h / q * next[c];
    }
  }
  return y[0];
}

/* The error of a mass of 1 kg on the spring after 1 s, thrown at 1 m/s; *drift: of the energy. */
static double error_of_run(const char *method, double tau, double dt, double *drift) {
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  launch(&e, 2, 1);
  maxwell(&e, (const uint32_t[][2]){{1, 2}}, 1, tau);
  test_plugin(&e, HK_INTEGRATOR, method);
  e.scene->duration = 1;
  e.scene->fps = 10;
  e.options.dt = dt;
  test_run(&e);
  test_advance(&e, 1);
  double error = fabs(test_position(&e, 2)[0] - 1 - exact(0, 0, tau, 1));
  hk_run_close(e.run, &e.error);
  hk_run_summary(e.run, &s);
  *drift = fabs(s.energy_drift);
  assert_true(s.energy_work < -0.01);
  test_engine_close(&e);
  return error;
}

/* Steps of tau/5 and tau/10: the leading term rules to a third of the exponent. */
static void methods_and_their_balance_keep_their_order_up_to_4(void **state) {
  (void)state;
  static const struct {
    const char *method;
    double order;
  } cases[] = {{"leapfrog", 2}, {"implicit_midpoint", 2}, {"rk4", 4}, {"stoermer8", 4}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double drift[2], coarse = error_of_run(cases[k].method, 0.1, 0.02, &drift[0]),
                     fine = error_of_run(cases[k].method, 0.1, 0.01, &drift[1]);
    print_message("%-18s error %.2e m, %.2e m: order %.2f; drift %.1e, %.1e\n", cases[k].method, coarse, fine,
                  log2(coarse / fine), drift[0], drift[1]);
    assert_true(log2(coarse / fine) > cases[k].order - 0.34);
    assert_true(log2(drift[0] / drift[1]) > cases[k].order - 0.34);
  }
}

/* 20 times longer than tau, the steps of a dashpot k_m tau of 0.05 N s/m: nothing is unstable, and the error is that of
 * the frequency, (h w)^2/24 w t = 7e-4 of 0.18 m. */
static void a_tau_far_below_the_step_asks_for_no_shorter_one(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "rk4", "implicit_midpoint"};
  for (int k = 0; k < 3; k++) {
    double drift, error = error_of_run(methods[k], 1e-3, 0.02, &drift);
    print_message("%-18s error %.2e m, drift %.1e\n", methods[k], error, drift);
    assert_true(error < 1e-3 && drift < 5e-3);
  }
}

/* At 0.35 s the spring is 0.35 m too long, which its branch answers as a spring: an event, whose 4.9 J are work. */
static void a_spring_that_begins_later_keeps_the_balance(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1);
  test_pin(&e, HK_PIN_FIXED, 1, NULL);
  launch(&e, 2, 1);
  maxwell(&e, (const uint32_t[][2]){{1, 2}}, 1, 0.1)->from = 0.35;
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->duration = 1;
  e.scene->fps = 10;
  e.options.dt = 0.005;
  test_run(&e);
  test_advance(&e, 1);
  double error = fabs(test_position(&e, 2)[0] - 1 - exact(0.35, 0.35 * K_M, 0.1, 0.65)),
         lost = e.run->record.dissipated;
  hk_run_close(e.run, &e.error);
  hk_run_summary(e.run, &s);
  print_message("error %.1e m, dissipated %.4f J, drift %.1e\n", error, lost, s.energy_drift);
  assert_true(error < 1e-6 && fabs(s.energy_drift) < 1e-6);
  assert_true(lost > 4 && fabs(s.energy_work + lost - (K + K_M) * 0.35 * 0.35 / 2) < 1e-9);
  test_engine_close(&e);
}

/* A chain of spheres that meet, in implicit steps of the size of tau. Within a step the force has no potential in which
 * the velocities follow from the positions, so Newton's method must not ask that one falls: it would divide the steps
 * some hundred times. */
static void implicit_steps_in_contact_are_not_divided(void **state) {
  (void)state;
  static const uint32_t edge[][2] = {{1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}};
  static const char *const methods[] = {"backward_euler", "implicit_midpoint", "bdf2"};
  for (int k = 0; k < 3; k++) {
    test_engine e;
    test_engine_open(&e);
    for (int i = 1; i <= 6; i++) test_particle(&e, 0.5 * i, 0.02 * i, 0, 1);
    test_pin(&e, HK_PIN_FIXED, 1, NULL);
    launch(&e, 6, -3);
    hk_plugin_spec *spec = maxwell(&e, edge, 5, 0.02);
    test_number(&e, spec, "k", 300);
    test_number(&e, spec, "k_m", 5000);
    test_number(&e, test_plugin(&e, HK_FORCE, "fixture:barrier_spheres"), "radius", 0.2);
    test_plugin(&e, HK_INTEGRATOR, methods[k]);
    e.scene->fps = 10;
    e.options.dt = 0.02;
    test_run(&e);
    test_advance(&e, 1);
    print_message("%-18s %zu steps, %zu evaluations\n", methods[k], e.run->record.steps,
                  e.run->dynamics.count.evaluations);
    assert_true(e.run->record.steps <= 60 && e.run->dynamics.count.evaluations < 500);
    test_engine_close(&e);
  }
}

static void open_pairs(test_engine *e, bool dies, const char *method) {
  test_engine_open(e);
  for (int i = 0; i < 6; i++) test_particle(e, i % 2, i / 2, 0, 1 + 0.1 * i);
  for (uint32_t id = 2; id <= 6; id += 2) launch(e, id, 1 + 0.5 * id);
  hk_plugin_spec *spec = maxwell(e, (const uint32_t[][2]){{1, 2}, {3, 4}, {5, 6}}, 3, 0.1);
  test_list(e, spec, "tau", (double[]){0.1, 0.2, 0.3}, 3);
  if (dies) {
    hk_plugin_spec *reaper = test_plugin(e, HK_SOURCE, "fixture:reaper");
    test_number(e, reaper, "id", 3);
    test_number(e, reaper, "at", 0.2);
  }
  test_plugin(e, HK_INTEGRATOR, method);
  e->options.dt = 1e-3;
}

/* Way 1 is without the death, at which leapfrog evaluates forces of the rate anew, to (h w)^2; way 2 has three threads,
 * way 3 goes on from where way 0 was, before the death or behind.
 */
static void deaths_checkpoints_and_threads_leave_no_trace(void **state) {
  (void)state;
  char path[512];
  snprintf(path, sizeof path, "%s/pairs.checkpoint", test_folder());
  for (int k = 0; k < 4; k++) {
    const char *method = k / 2 ? "rk4" : "leapfrog";
    test_engine e[4];
    for (int way = 0; way < 4; way++) {
      open_pairs(&e[way], way != 1, method);
      if (way == 2) e[way].scene->threads = 3;
      if (way == 3) e[way].scene->start_file = strdup(path);
      test_run(&e[way]);
      test_advance(&e[way], way < 3 ? (k % 2 ? 0.35 : 0.15) : 0.6);
      if (way == 0) assert_int_equal(hk_run_save(e[0].run, path, &e[0].error), HK_OK);
      test_advance(&e[way], 0.6);
    }
    for (int way = 1; way < 4; way++) {
      const uint32_t ids[] = {1, 2, 5, 6};
      for (int m = 0; m < 4; m++)
        for (int c = 0; c < 3; c++) {
          double off = fabs(test_position(&e[0], ids[m])[c] - test_position(&e[way], ids[m])[c]);
          assert_true(off <= (way == 1 ? 1e-6 : 0));
        }
      assert_true(way == 1 || e[way].run->record.dissipated == e[0].run->record.dissipated);
    }
    for (int way = 0; way < 4; way++) test_engine_close(&e[way]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_held_spring_relaxes_by_exp_of_t_over_tau),
      cmocka_unit_test(moduli_have_their_closed_forms_to_order_4),
      cmocka_unit_test(force_and_blocks_are_derivatives_within_a_step),
      cmocka_unit_test(methods_and_their_balance_keep_their_order_up_to_4),
      cmocka_unit_test(a_tau_far_below_the_step_asks_for_no_shorter_one),
      cmocka_unit_test(a_spring_that_begins_later_keeps_the_balance),
      cmocka_unit_test(implicit_steps_in_contact_are_not_divided),
      cmocka_unit_test(deaths_checkpoints_and_threads_leave_no_trace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
