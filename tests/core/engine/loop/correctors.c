/* Correctors that take steps back and that report their work: what the host does with the step, the integrator's
 * history, the energy balance, and those who wait for the word that a step was accepted. */
#include "tests/support/fake_system.h"
#include "tests/support/spheres.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double way = 0.04, g = 9.81, t_end = 0.6, tol = 1e-6; /* m, m/s^2, s: up to 5.9 m/s */

/* A particle that falls freely from rest, and a corrector that lets it move by `way` in a step. */
static hk_plugin_spec *falling(test_engine *e, const char *integrator) {
  test_engine_open(e);
  test_particle(e, 0, 0, 10, 2);
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *rejecter = test_plugin(e, HK_CORRECTOR, "fixture:rejecter");
  test_number(e, rejecter, "way", way);
  e->options.integrator = integrator;
  e->scene->fps = 10;
  return rejecter;
}

/* Methods of order 2 and more are exact, to rounding or to their algebraic tolerance, 1e-6 of speeds; order 1 is off by
 * g h t/2 with steps no longer than those let through at the start, 0.1 s; an adaptive one by tol of the way in a step.
 */
static void fall(const char *integrator, int order, bool adaptive) {
  test_engine e;
  hk_plugin_spec *rejecter = falling(&e, integrator);
  if (adaptive)
    e.options.tol = tol;
  else
    e.options.dt = 1.0 / 40;
  test_run(&e);
  test_advance(&e, t_end);
  double z = test_position(&e, 1)[2], exact = 10 - g * t_end * t_end / 2;
  print_message("%-20s off by %.1e m, %zu steps, %zu taken back\n", integrator, z - exact, e.run->record.steps,
                e.run->record.rejected);
  assert_true(test_counter(&e, rejecter, "rejections") > 0);
  assert_int_equal(test_counter(&e, rejecter, "rejections"), e.run->record.rejected);
  assert_true(test_field(&e, rejecter, "longest") <= way);
  if (!adaptive) assert_true(2 * e.run->record.dt_min * g * t_end > way); /* halved as often as needed and no more */
  double adapted = adaptive ? (double)e.run->record.steps * tol * 27 : 0;
  assert_true(fabs(z - exact) < (order == 1 ? g * t_end / 2 * 0.1 : fmax(1e-5, adapted)));
  test_engine_close(&e);
}

static void steps_are_halved_until_they_are_let_through(void **state) {
  (void)state;
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names);
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  for (size_t k = 0; k < count; k++) {
    fake_method m = fake_method_open(names[k], f);
    int order = m.plugin->integrator->order;
    bool adaptive = m.plugin->integrator->flags & HK_ADAPTIVE;
    fake_method_close(&m);
    fall(names[k], order, adaptive);
  }
  fake_system_destroy(f);
}

static void who_takes_every_step_back_is_named(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "dopri5"};
  for (size_t k = 0; k < 2; k++) {
    test_engine e;
    hk_plugin_spec *rejecter = falling(&e, names[k]);
    e.scene->particles.velocity[0] = 1;
    test_number(&e, rejecter, "way", 1e-9);
    test_run(&e);
    assert_int_equal(hk_run_advance(e.run, t_end, &e.error), HK_NOT_CONVERGED);
    assert_non_null(strstr(e.error.text, "rejecter takes every step back"));
    assert_true(hk_run_view(e.run)->t == 0 && test_position(&e, 1)[0] == 0); /* as it was */
    test_engine_close(&e);
  }
}

/* One step is 4,096 then, each as short as the host makes them: a corrector sees that and lets it through. */
static void a_step_that_cannot_be_shorter_is_known_to_be_the_last(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *rejecter = falling(&e, "leapfrog");
  e.scene->particles.velocity[0] = 1;
  test_number(&e, rejecter, "way", 1e-9);
  test_boolean(&e, rejecter, "yields", true);
  e.options.dt = 1.0 / 40;
  test_run(&e);
  test_advance(&e, 1.0 / 40);
  assert_true(hk_run_view(e.run)->t == 1.0 / 40 && e.run->record.steps == 4096);
  test_engine_close(&e);
}

/* Halves of 2.4e-8 s at 8 s: the difference of two times is off by 2e-8 of them, which is no breach of contract. */
static void the_shortest_halves_are_believed(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  hk_plugin_spec *gravity = test_plugin(&e, HK_FORCE, "gravity");
  hk_plugin_spec *rejecter = test_plugin(&e, HK_CORRECTOR, "fixture:rejecter");
  gravity->from = 7.9998;
  test_vector(&e, gravity, "g", 5e5, 0, 0); /* to 100 m/s in the last two frames */
  test_number(&e, rejecter, "way", 3e-6);
  e.options.integrator = "leapfrog";
  e.options.dt = 1e-4;
  e.scene->fps = 1e4;
  test_run(&e);
  test_advance(&e, 8);
  assert_true(e.run->record.dt_min < 3e-8);
  test_engine_close(&e);
}

/* Gravity is integrated exactly by these and the floor changes speeds alone: the balance is off by rounding, some 100
 * steps of 1e-16 of 200 J. */
static void reported_work_keeps_the_balance_known(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "rk4", "stoermer", "dopri5"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    test_engine e;
    hk_plugin_spec *rejecter = falling(&e, names[k]);
    test_number(&e, rejecter, "height", 9.5);
    test_run(&e);
    test_advance(&e, 2);
    hk_summary s;
    hk_run_summary(e.run, &s);
    print_message("%-20s drift %.1e, work %.3f J, %ld bounces\n", names[k], s.energy_drift, s.energy_work,
                  (long)test_counter(&e, rejecter, "bounces"));
    assert_true(test_counter(&e, rejecter, "bounces") > 2);
    assert_true(s.energy_work < -1);
    assert_true(fabs(s.energy_last - s.energy_first - s.energy_work) < 1e-11);
    assert_true(fabs(s.energy_drift) < 1e-11);
    test_engine_close(&e);
  }
}

/* The floor's corrector comes first and does its work before the second takes the step back. */
static void work_of_a_step_taken_back_does_not_count(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "dopri5"};
  for (size_t k = 0; k < 2; k++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 10, 2);
    test_plugin(&e, HK_FORCE, "gravity");
    hk_plugin_spec *bouncing = test_plugin(&e, HK_CORRECTOR, "fixture:rejecter");
    hk_plugin_spec *limiting = test_plugin(&e, HK_CORRECTOR, "fixture:rejecter");
    test_number(&e, bouncing, "height", 9.5);
    test_number(&e, bouncing, "restitution", 1);
    test_number(&e, limiting, "way", way);
    test_number(&e, bouncing, "restitution", 0.9);
    e.options.integrator = names[k];
    e.scene->fps = 10;
    test_run(&e);
    test_advance(&e, 2);
    hk_summary s;
    hk_run_summary(e.run, &s);
    double all = test_field(&e, bouncing, "work"), counted = e.run->record.correction_work;
    print_message("%-20s all %.3f J, counted %.3f J, drift %.1e\n", names[k], all, counted, s.energy_drift);
    assert_true(test_counter(&e, limiting, "rejections") > 0);
    assert_true(all < counted - 1e-3); /* a bounce was taken back, or this would prove nothing */
    assert_true(fabs(s.energy_last - s.energy_first - counted) < 1e-11);
    assert_true(fabs(s.energy_drift) < 1e-11);
    test_engine_close(&e);
  }
}

/* Spheres fall on a floor; steps are taken back for the way, and by Newton's iteration of one step for its failure. */
static void accepted_is_said_once_per_step_and_of_no_other(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double way; /* m, less than the steps that it would take move the spheres */
  } method[] = {{"leapfrog", 1e-4}, {"backward_euler:iterations=6", 0.005}, {"dopri5", 1e-3}, {"tr_bdf2", 1e-3}};
  for (size_t k = 0; k < sizeof method / sizeof *method; k++) {
    test_engine e;
    hk_plugin_spec *spheres = test_heap(&e), *rejecter = test_plugin(&e, HK_CORRECTOR, "fixture:rejecter");
    test_boolean(&e, spheres, "floor", true);
    test_boolean(&e, spheres, "cautious", k == 0);
    test_number(&e, rejecter, "way", method[k].way);
    e.options.integrator = method[k].name;
    e.scene->fps = 30;
    test_run(&e);
    test_advance(&e, 0.3);
    size_t steps = e.run->record.steps;
    print_message("%-30s %zu steps, %zu taken back, %ld updates\n", method[k].name, steps, e.run->record.rejected,
                  (long)test_counter(&e, spheres, "updates"));
    assert_true(e.run->record.rejected > 0);
    assert_int_equal(test_counter(&e, spheres, "accepted"), steps);
    assert_true(fabs(test_field(&e, spheres, "time") - 0.3) < 1e-12); /* a sum of some 1000 steps */
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_are_halved_until_they_are_let_through),
      cmocka_unit_test(who_takes_every_step_back_is_named),
      cmocka_unit_test(a_step_that_cannot_be_shorter_is_known_to_be_the_last),
      cmocka_unit_test(the_shortest_halves_are_believed),
      cmocka_unit_test(reported_work_keeps_the_balance_known),
      cmocka_unit_test(work_of_a_step_taken_back_does_not_count),
      cmocka_unit_test(accepted_is_said_once_per_step_and_of_no_other),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
