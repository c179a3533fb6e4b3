/* Forces whose partners change, on spheres with a barrier energy: that no integrator's move leads through a contact,
 * that matrices follow their patterns, and that nothing is forgotten. A step of 1/60 s moves a sphere by more than the
 * gap at which the barrier begins. */
#include "tests/support/fake_system.h"
#include "tests/support/spheres.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static bool keeps_clear(const hk_integrator *method) { return method->flags & HK_NEEDS_JACOBIAN; }

/* Every method whose steps are solved with the contact's Jacobian; `check` gets an engine that is open to be run. */
static void for_all_implicit(void (*check)(const char *integrator)) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names), checked = 0;
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  for (size_t k = 0; k < count; k++) {
    fake_method m = fake_method_open(names[k], f);
    bool fits = keeps_clear(m.plugin->integrator);
    fake_method_close(&m);
    if (fits) check(names[k]);
    checked += fits;
  }
  fake_system_destroy(f);
  assert_true(checked >= 9); /* Newton's, Baraff and Witkin's, CVODE */
  check("arkode:method=dirk");
}

/* ---- two spheres ---- */

static void bounce(const char *integrator) {
  test_engine e;
  hk_plugin_spec *spheres = test_two_spheres(&e);
  e.options.integrator = integrator;
  e.scene->fps = 30;
  test_run(&e);
  test_advance(&e, 0.5);
  const double *x = test_position(&e, 1), *v = test_velocity(&e, 1);
  print_message("%-20s least gap %.1e m, momentum off by %.1e\n", integrator, test_field(&e, spheres, "least_gap"),
                test_momentum(&e, 0) + 1);
  assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
  assert_true(test_field(&e, spheres, "least_gap") > 0);
  assert_true(x[3] - x[0] > 0.2 && v[3] > v[0]); /* apart again, on their own sides */
  /* -1 kg m/s of parts of 1 and 2; each of at most 500 steps rounds at 1e-16 of them. */
  for (int axis = 0; axis < 3; axis++) assert_true(fabs(test_momentum(&e, axis) + (axis == 0)) < 1e-13);
  test_engine_close(&e);
}

static void no_implicit_method_moves_spheres_through_each_other(void **state) {
  (void)state;
  for_all_implicit(bounce);
}

/* The largest drift of the energy at frames of 1/100 s, J, against a soft barrier: 0.1 m wide, stopped at half of it,
 * where its frequency is about 90/s. */
static double worst_drift(const char *integrator, double dt) {
  test_engine e;
  hk_plugin_spec *spheres = test_two_spheres(&e);
  test_number(&e, spheres, "distance", 0.1);
  test_number(&e, spheres, "stiffness", 800);
  e.options.integrator = integrator;
  e.options.dt = dt;
  e.scene->fps = 100;
  test_run(&e);
  double kinetic, potential, work, first = 1.5, worst = 0;
  for (int k = 1; k <= 20; k++) {
    test_advance(&e, k / 100.0);
    hk_run_energy(e.run, &kinetic, &potential, &work);
    worst = fmax(worst, fabs(kinetic + potential - first));
  }
  assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
  test_engine_close(&e);
  return worst;
}

/* Halving the step divides the drift by 2^order; the next term, of one power of h w = 0.05 more, changes what is
 * measured by less than 0.3. */
static void energy_of_a_bounce_drifts_by_the_order_of_the_method(void **state) {
  (void)state;
  static const struct {
    const char *name;
    int order;
  } fixed[] = {{"backward_euler", 1}, {"implicit_midpoint", 2}, {"implicit_trapezoid", 2}, {"bdf2", 2}, {"imex", 2}};
  for (size_t k = 0; k < sizeof fixed / sizeof *fixed; k++) {
    double coarse = worst_drift(fixed[k].name, 1.0 / 2000), fine = worst_drift(fixed[k].name, 1.0 / 4000);
    print_message("%-20s order %.2f, drift %.1e J\n", fixed[k].name, log2(coarse / fine), fine);
    assert_true(fabs(log2(coarse / fine) - fixed[k].order) < 0.3);
  }
}

/* ---- ten spheres ---- */

static void settle(const char *integrator) {
  test_engine e;
  hk_plugin_spec *spheres = test_heap(&e);
  test_boolean(&e, spheres, "floor", true);
  e.options.integrator = integrator;
  e.scene->fps = 30;
  test_run(&e);
  test_advance(&e, 0.5);
  print_message("%-20s least gap %.1e m, %ld patterns in %zu steps\n", integrator, test_field(&e, spheres, "least_gap"),
                (long)test_counter(&e, spheres, "changes"), e.run->record.steps);
  assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
  assert_true(test_field(&e, spheres, "least_gap") > 0);
  assert_true(test_counter(&e, spheres, "changes") > 10);
  assert_int_equal(test_counter(&e, spheres, "accepted"), e.run->record.steps);
  assert_true(fabs(test_field(&e, spheres, "time") - 0.5) < 1e-12); /* a sum of 3000 steps at most */
  for (uint32_t id = 1; id <= 10; id++) assert_true(test_position(&e, id)[2] > 0.1);
  test_engine_close(&e);
}

static void no_implicit_method_moves_a_heap_through_itself(void **state) {
  (void)state;
  for_all_implicit(settle);
}

static bool clear(test_engine *e) {
  const hk_view *view = hk_run_view(e->run);
  bool fine = true;
  for (size_t i = 0; i < view->n; i++)
    for (size_t j = 0; j < i; j++) {
      const double *a = view->x + 3 * i, *b = view->x + 3 * j;
      fine &= hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]) > 0.2;
    }
  return fine;
}

/* What treats contact explicitly may fail, and must then say so: an overlap is never believed. */
static void explicit_contact_is_refused_or_clear(void **state) {
  (void)state;
  static const char *const names[] = {"local_global", "xpbd", "desbrun", "symplectic_euler"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    test_engine e;
    hk_plugin_spec *spheres = test_heap(&e);
    test_boolean(&e, spheres, "floor", true);
    e.options.integrator = names[k];
    e.options.dt = 1.0 / 30;
    e.scene->fps = 30;
    test_run(&e);
    hk_status status = hk_run_advance(e.run, 0.5, &e.error);
    print_message("%-20s %s\n", names[k], status == HK_OK ? "clear" : e.error.text);
    if (status == HK_OK) assert_true(clear(&e));
    if (status != HK_OK) assert_true(status == HK_NOT_CONVERGED || status == HK_NOT_FINITE || status == HK_FAILED);
    assert_true(status == HK_OK || *e.error.text);
    test_engine_close(&e);
  }
}

/* In one step of 0.1 s the spheres would change places, and no evaluation would see them meet. */
static void no_step_jumps_over_a_contact(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "symplectic_euler", "rk4", "local_global", "xpbd"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    test_engine e;
    hk_plugin_spec *spheres = test_two_spheres(&e);
    e.scene->particles.velocity[0] = 3;
    e.scene->particles.velocity[3] = -3;
    test_number(&e, spheres, "stiffness", 1e6);
    e.options.integrator = names[k];
    e.options.dt = 0.1;
    e.scene->fps = 10;
    test_run(&e);
    hk_status status = hk_run_advance(e.run, 0.2, &e.error);
    print_message("%-20s %zu steps, %zu taken back; %s\n", names[k], e.run->record.steps, e.run->record.rejected,
                  status == HK_OK ? "clear" : e.error.text);
    assert_true(e.run->record.rejected > 0);
    if (status == HK_OK) assert_true(test_position(&e, 2)[0] - test_position(&e, 1)[0] > 0.2);
    test_engine_close(&e);
  }
}

/* ---- patterns ---- */

static void a_pattern_is_analysed_when_it_is_new_and_only_then(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spheres = test_heap(&e), *solver = test_plugin(&e, HK_SOLVER, "fixture:counting_solver");
  test_boolean(&e, spheres, "floor", true);
  e.options.integrator = "backward_euler:reuse=false";
  e.scene->fps = 30;
  test_run(&e);
  test_advance(&e, 0.5);
  int64_t analyses = test_counter(&e, solver, "analyses");
  print_message("%ld analyses, %ld factorizations, %ld changes\n", (long)analyses,
                (long)test_counter(&e, solver, "factorizations"), (long)test_counter(&e, spheres, "changes"));
  assert_true(analyses > 10 && analyses < test_counter(&e, solver, "factorizations"));
  assert_int_equal(test_counter(&e, solver, "needless"), 0);
  assert_int_equal(test_counter(&e, solver, "mistaken"), 0);
  test_engine_close(&e);
}

static void factors_serve_across_a_change_of_pattern(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spheres = test_heap(&e);
  test_boolean(&e, spheres, "floor", true);
  e.options.integrator = "backward_euler";
  e.options.dt = 1.0 / 480;
  e.scene->fps = 60;
  test_run(&e);
  test_advance(&e, 0.5);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true((int64_t)s.factorizations < test_counter(&e, spheres, "changes"));
  test_engine_close(&e);
}

/* ---- time ---- */

/* 1e4 (1 + t) */
static hk_status growing(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                         size_t max, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max, (void)error;
  out[0] = 1e4 * (1 + in[0]);
  *n_out = 1;
  return HK_OK;
}

/* A barrier that grows while spheres lean on it: Newton has to see the potential of the stage's time. */
static void timed_contact_is_kept_clear_as_well(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spheres = test_heap(&e);
  test_boolean(&e, spheres, "floor", true);
  test_function(&e, spheres, "stiffness", (hk_function){.call = growing});
  e.options.integrator = "backward_euler";
  e.scene->fps = 30;
  test_run(&e);
  test_advance(&e, 0.5);
  assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
  test_engine_close(&e);
}

/* x = 0.35 sin(pi t) */
static hk_status ram(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out, size_t max,
                     size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max, (void)error;
  out[0] = 0.35 * sin(3.14159265358979 * in[0]);
  out[1] = out[2] = 0;
  *n_out = 3;
  return HK_OK;
}

/* At 1.1 m/s it moves by twice the gap in a step of 1/60 s: such steps have to be halved. */
static void scripted_spheres_push_and_never_pass(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  uint32_t id = test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0.21, 0, 0, 1);
  hk_plugin_spec *spheres = test_plugin(&e, HK_FORCE, "fixture:barrier_spheres");
  hk_pin_spec pin = {.kind = HK_PIN_PATH, .count = 1, .id = &id, .path = {.call = ram}, .release = INFINITY};
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  e.options.integrator = "backward_euler";
  e.scene->fps = 30;
  test_run(&e);
  test_advance(&e, 0.5);
  assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
  assert_true(test_position(&e, 2)[0] > 0.35 + 0.2);
  assert_int_equal(test_counter(&e, spheres, "accepted"), e.run->record.steps);
  assert_int_equal(e.run->record.steps,
                   30); /* two a frame, none of them divided: the ram moves by up to 1.8 reaches in one */
  test_engine_close(&e);
}

/* Drops fall on a heap and the oldest vanish: indices change, and the pairs with them. */
static void contact_follows_births_and_deaths(void **state) {
  (void)state;
  static const char *const names[] = {"backward_euler", "leapfrog"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    test_engine e;
    hk_plugin_spec *spheres = test_heap(&e), *emitter = test_plugin(&e, HK_SOURCE, "fixture:spout");
    test_boolean(&e, spheres, "floor", true);
    test_boolean(&e, spheres, "cautious", true);
    test_number(&e, test_plugin(&e, HK_FORCE, "fixture:lagged_friction"), "speed", 0.5);
    test_number(&e, emitter, "every", 0.4); /* a drop rises at first; by then it has left its place */
    test_number(&e, emitter, "lifetime", 0.17);
    test_vector(&e, emitter, "position", 0.02, 0, 1.2);
    e.options.integrator = names[k];
    e.scene->fps = 30;
    test_run(&e);
    test_advance(&e, 0.7);
    assert_true(test_counter(&e, emitter, "born") == 2 && test_counter(&e, emitter, "died") == 4);
    assert_int_equal(test_counter(&e, spheres, "overlaps"), 0);
    test_engine_close(&e);
  }
}

/* ---- the line search ---- */

static size_t potential_calls;
static hk_status (*real_potential)(hk_system *, double, const double *, double *);

static hk_status watch(hk_system *s, double t, const double *X, double *joule) {
  hk_status status = real_potential(s, t, X, joule);
  potential_calls++;
  return status;
}

static size_t potentials(const char *integrator, bool rub) {
  test_engine e;
  hk_plugin_spec *spheres = test_heap(&e);
  test_boolean(&e, spheres, "floor", true);
  if (rub) test_plugin(&e, HK_FORCE, "fixture:lagged_friction");
  e.options.integrator = integrator;
  e.scene->fps = 30;
  test_run(&e);
  potential_calls = 0;
  hk_contact_table watched = *e.run->dynamics.system.contact;
  real_potential = watched.potential;
  watched.potential = watch;
  e.run->dynamics.system.contact = &watched;
  test_advance(&e, 0.3);
  test_engine_close(&e);
  return potential_calls;
}

static void the_potential_is_looked_at_where_a_stage_minimises_it(void **state) {
  (void)state;
  static const char *const names[] = {"backward_euler", "bdf2", "imex", "implicit_midpoint", "tr_bdf2"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    assert_true(potentials(names[k], false) > 0);
    if (strcmp(names[k], "imex") != 0) /* which leaves friction out of its implicit part */
      assert_int_equal(potentials(names[k], true), 0);
  }
}

/* ---- friction ---- */

/* Off the line of centres, so that they rub. */
static void rub(test_engine *e, hk_plugin_spec **spheres, hk_plugin_spec **friction) {
  *spheres = test_two_spheres(e);
  e->scene->particles.position[1] = 0.08;
  test_boolean(e, *spheres, "cautious", true);
  *friction = test_plugin(e, HK_FORCE, "fixture:lagged_friction");
  test_number(e, *friction, "speed", 0.5); /* explicit methods bear its damping, 4 mu lambda/(speed m) h < 1 */
  e->scene->fps = 50;
}

/* What `accepted` sums over its steps is the loss to order 1; the balance is the method's own. Momentum as above. */
static void lagged_friction_takes_energy_and_says_so(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "implicit_midpoint"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    test_engine e;
    hk_plugin_spec *spheres, *friction;
    rub(&e, &spheres, &friction);
    e.options.integrator = names[k];
    e.options.dt = 1.0 / 20000;
    test_run(&e);
    test_advance(&e, 0.5);
    double kinetic, potential, work, lost = test_field(&e, friction, "lost");
    hk_run_energy(e.run, &kinetic, &potential, &work);
    print_message("%-20s lost %.4f J, work %.4f J, balance %.1e J\n", names[k], lost, work,
                  kinetic + potential - 1.5 - work);
    assert_true(lost > 0.02);
    assert_true(fabs(work + lost) < 0.02 * lost);
    assert_true(fabs(kinetic + potential - 1.5 - work) < 0.01 * lost);
    for (int axis = 0; axis < 3; axis++) assert_true(fabs(test_momentum(&e, axis) + (axis == 0)) < 1e-11);
    test_engine_close(&e);
  }
}

/* ---- runs that stop and go on; threads ---- */

static void open_rubbing_heap(test_engine *e, const char *integrator, int threads) {
  hk_plugin_spec *spheres = test_heap(e);
  test_boolean(e, spheres, "floor", true);
  test_boolean(e, spheres, "cautious", true);
  test_plugin(e, HK_FORCE, "fixture:lagged_friction");
  e->options.integrator = integrator;
  e->options.threads = threads;
  e->scene->fps = 50;
}

static size_t final_state(const char *integrator, int threads, double *X) {
  test_engine e;
  open_rubbing_heap(&e, integrator, threads);
  test_run(&e);
  test_advance(&e, 0.4);
  size_t size = e.run->state.size;
  memcpy(X, e.run->state.X, size * sizeof *X);
  test_engine_close(&e);
  return size;
}

static void contact_goes_on_bit_by_bit_from_a_checkpoint(void **state) {
  (void)state;
  char path[] = "/tmp/hooke-contact-XXXXXX";
  double whole[128];
  size_t size = final_state("leapfrog", 1, whole);
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  test_engine e;
  open_rubbing_heap(&e, "leapfrog", 1);
  test_run(&e);
  test_advance(&e, 0.2); /* in contact: see the next line */
  assert_true(test_counter(&e, e.scene->plugin[HK_FORCE].item[1], "changes") > 0);
  if (hk_run_save(e.run, path, &e.error) != HK_OK) fail_msg("%s", e.error.text);
  test_engine_close(&e);
  open_rubbing_heap(&e, "leapfrog", 1);
  e.scene->start_file = strdup(path);
  test_run(&e);
  test_advance(&e, 0.4);
  assert_memory_equal(e.run->state.X, whole, size * sizeof *whole);
  test_engine_close(&e);
  remove(path);
}

static void contact_is_bitwise_the_same_on_two_threads(void **state) {
  (void)state;
  static const char *const names[] = {"leapfrog", "backward_euler", "tr_bdf2"};
  double one[128], two[128];
  for (size_t k = 0; k < 3; k++) {
    size_t size = final_state(names[k], 1, one);
    assert_int_equal(final_state(names[k], 2, two), size);
    assert_memory_equal(one, two, size * sizeof *one);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(no_implicit_method_moves_spheres_through_each_other),
      cmocka_unit_test(energy_of_a_bounce_drifts_by_the_order_of_the_method),
      cmocka_unit_test(no_implicit_method_moves_a_heap_through_itself),
      cmocka_unit_test(explicit_contact_is_refused_or_clear),
      cmocka_unit_test(no_step_jumps_over_a_contact),
      cmocka_unit_test(a_pattern_is_analysed_when_it_is_new_and_only_then),
      cmocka_unit_test(factors_serve_across_a_change_of_pattern),
      cmocka_unit_test(timed_contact_is_kept_clear_as_well),
      cmocka_unit_test(scripted_spheres_push_and_never_pass),
      cmocka_unit_test(contact_follows_births_and_deaths),
      cmocka_unit_test(the_potential_is_looked_at_where_a_stage_minimises_it),
      cmocka_unit_test(lagged_friction_takes_energy_and_says_so),
      cmocka_unit_test(contact_goes_on_bit_by_bit_from_a_checkpoint),
      cmocka_unit_test(contact_is_bitwise_the_same_on_two_threads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
