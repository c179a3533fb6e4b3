/* Motions whose ends are known, by several methods: the force is right to rounding, so that what is left is the
 * method's error. And a cluster in equilibrium, which stays so. */
#include "tests/support/nbody_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct expectation {
  const nbody_problem *problem;
  const char *method;
  double dt, tol, error; /* s or 0, 0 or a tolerance, m */
  size_t evaluations;    /* at most */
} expectation;

/* Bounds are what is asked for, 1e-8 and 1e-10 m; measured: 6e-9, 1.2e-9, 1.3e-11, 7.4e-10, 1.4e-6, 6.9e-9, 9.5e-13; by
 * methods of high order 9e-10, 5.9e-10, 5.8e-14, 7e-12, 2.7e-12, 2e-15, where rounding errors grow with the motion.
 * The numbers of evaluations are measured ones with a tenth to spare. */
static const expectation expectations[] = {
    {&nbody_pleiades, "rk4", 3e-5, 0, 1e-8, 400100},
    {&nbody_pleiades, "dopri5", 0, 1e-10, 1e-8, 7600},
    {&nbody_pleiades, "dopri5", 0, 1e-12, 1e-10, 19000},
    {&nbody_pythagorean, "dopri5", 0, 1e-13, 1e-9, 42000},
    {&nbody_solar, "blanes_moan", 50, 0, 1e-5, 24100},
    {&nbody_solar, "dopri5", 0, 1e-13, 1e-7, 200000},
    {&nbody_kepler, "dopri5", 0, 1e-13, 1e-11, 9000},
    {&nbody_pleiades, "dop853", 0, 1e-10, 1e-8, 4600},
    {&nbody_solar, "dop853", 0, 1e-13, 1e-8, 34000},
    {&nbody_pleiades, "gauss_radau", 0, 2e-16, 1e-12, 8500},
    {&nbody_pythagorean, "gauss_radau", 0, 2e-16, 1e-10, 15300},
    {&nbody_solar, "gauss_radau", 0, 2e-16, 2e-11, 28500},
    {&nbody_kepler, "gauss_radau", 0, 2e-16, 3e-14, 2400},
};

static void motions_end_where_they_are_known_to(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof expectations / sizeof *expectations; k++) {
    const expectation *w = &expectations[k];
    size_t evaluations;
    double error = nbody_error(w->problem, w->method, w->dt, w->tol, &evaluations);
    if (!(error < w->error && evaluations <= w->evaluations))
      fail_msg("%s by %s: off by %g m after %zu evaluations", w->problem->name, w->method, error, evaluations);
  }
}

/* The order of the method is seen, so nothing else is off: half the step has 1/16 of the error, but for roundings. */
static void errors_have_the_order_of_the_method(void **state) {
  (void)state;
  double coarse = nbody_error(&nbody_kepler, "rk4", 0.02, 0, NULL),
         fine = nbody_error(&nbody_kepler, "rk4", 0.01, 0, NULL);
  assert_true(coarse / fine > 14 && coarse / fine < 40); /* 2^4 or, as energy errors do, 2^5 */
  coarse = nbody_error(&nbody_kepler, "leapfrog", 0.002, 0, NULL);
  fine = nbody_error(&nbody_kepler, "leapfrog", 0.001, 0, NULL);
  assert_true(fabs(coarse / fine - 4) < 0.1);
}

static double energy(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential;
}

/* Relative change of the energy of two bodies after some turns. */
static double drift(const char *method, double turns, double dt) {
  test_engine e;
  nbody_open(&e, &nbody_kepler, method);
  e.options.dt = dt;
  e.scene->duration = 6.283185307179586 * turns;
  e.scene->fps = 1 / e.scene->duration;
  test_run(&e);
  double first = energy(&e);
  test_advance(&e, e.scene->duration);
  double change = energy(&e) / first - 1;
  test_engine_close(&e);
  return change;
}

/* E = -1/8. Leapfrog's energy is off by 7e-4 after 10 turns and after 100; explicit Euler's rises until the bodies
 * part. (10,000 turns: tests/study/nbody.c.) */
static void leapfrog_stays_and_euler_leaves(void **state) {
  (void)state;
  double early = fabs(drift("leapfrog", 10.25, 0.01)), late = fabs(drift("leapfrog", 100.25, 0.01));
  assert_true(early < 1e-3 && late < 1e-3);
  assert_true(drift("euler", 10.25, 0.01) < -0.3); /* nearer to 0 than a third: the orbit has become larger */
}

static double kinetic_by_potential(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return -2 * kinetic / potential;
}

/* The virial theorem, 2 T + W = 0, at the start and after five times sqrt(a^3/GM), by both sums. Of 1000 random speeds
 * T is known to 1/sqrt(1500) = 2.6 %, W likewise; softening by 0.02 takes 1 % of W. */
static void a_sphere_stays_in_equilibrium(void **state) {
  (void)state;
  for (int tree = 0; tree < 2; tree++) {
    test_engine e;
    test_engine_open(&e);
    nbody_add_sphere(&e, 1000, 4);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "nbody");
    test_number(&e, spec, "G", 1);
    test_number(&e, spec, "softening", 0.02);
    test_text(&e, spec, "method", tree ? "tree" : "direct");
    e.options.integrator = "leapfrog";
    e.options.dt = 0.02;
    e.scene->fps = 1;
    e.scene->duration = 5;
    test_run(&e);
    double first = energy(&e);
    assert_true(fabs(kinetic_by_potential(&e) - 1) < 0.08);
    assert_true(fabs(first / (-3 * 3.141592653589793 / 64) - 1) < 0.1);
    test_advance(&e, 5);
    assert_true(fabs(kinetic_by_potential(&e) - 1) < 0.08);
    assert_true(fabs(energy(&e) / first - 1) < 1e-3); /* measured: 3e-4, which is the step's; 1e-6 with dt 0.005 */
    assert_true((e.run->record.force_rms > 0) == tree);
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(motions_end_where_they_are_known_to),
      cmocka_unit_test(errors_have_the_order_of_the_method),
      cmocka_unit_test(leapfrog_stays_and_euler_leaves),
      cmocka_unit_test(a_sphere_stays_in_equilibrium),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
