/* The Lennard-Jones pair by hand, against its energy and Jacobian, and in motion against quadrature. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* As the formula of the plugin's head, written down once more. */
static double potential(double epsilon, double sigma, double cutoff, double r) {
  double at = 4 * epsilon * (pow(sigma / r, 12) - pow(sigma / r, 6));
  double end = 4 * epsilon * (pow(sigma / cutoff, 12) - pow(sigma / cutoff, 6));
  double slope = -24 * epsilon / cutoff * (2 * pow(sigma / cutoff, 12) - pow(sigma / cutoff, 6));
  return r < cutoff ? at - end - (r - cutoff) * slope : 0;
}

static double push(double epsilon, double sigma, double cutoff, double r) { /* -U' */
  double at = 24 * epsilon / r * (2 * pow(sigma / r, 12) - pow(sigma / r, 6));
  double end = 24 * epsilon / cutoff * (2 * pow(sigma / cutoff, 12) - pow(sigma / cutoff, 6));
  return r < cutoff ? at - end : 0;
}

static hk_plugin_spec *open_pair(test_engine *e, double epsilon, double sigma, double r) {
  test_engine_open(e);
  test_particle(e, 1, 2, 3, 2);
  test_particle(e, 1 + r * 0.6, 2, 3 + r * 0.8, 3);
  e->options.dt = 1e-3;
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "lennard_jones");
  test_number(e, spec, "epsilon", epsilon);
  test_number(e, spec, "sigma", sigma);
  return spec;
}

/* Rounding: the terms of the sum are up to 1e5 at 0.5 sigma, with some ten roundings each. */
static void force_and_energy_by_hand(void **state) {
  (void)state;
  const double at[] = {0.5, 0.9, 1, pow(2, 1. / 6), 1.5, 2.4999, 2.5, 3}, epsilon = 0.7, sigma = 1.3;
  for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
    test_engine e;
    double F[6], r = at[k] * sigma;
    hk_plugin_spec *spec = open_pair(&e, epsilon, sigma, r);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    force_evaluate(force, &view, F);
    double wanted = push(epsilon, sigma, 2.5 * sigma, r), scale = fmax(1, pow(at[k], -13));
    const double n[3] = {0.6, 0, 0.8};
    for (int c = 0; c < 3; c++) {
      assert_true(fabs(F[3 + c] - wanted * n[c]) < 1e-12 * scale);
      assert_true(F[c] == -F[3 + c]);
    }
    double U = force->plugin->force->energy(force->self, &view);
    assert_true(fabs(U - potential(epsilon, sigma, 2.5 * sigma, r)) < 1e-12 * scale);
    test_engine_close(&e);
  }
}

/* A cluster shaken off a lattice, pairs at 0.8 to 2.6 sigma. */
static hk_plugin_spec *open_cluster(test_engine *e, int side, double shake, double speed) {
  uint64_t seed[4];
  hk_random_seed(seed, 4);
  test_engine_open(e);
  e->options.dt = 2e-3;
  for (int i = 0; i < side * side * side; i++) {
    double x[3];
    for (int c = 0, at = i; c < 3; c++, at /= side) x[c] = 1.12 * (at % side) + shake * (hk_random_uniform(seed) - 0.5);
    uint32_t id = test_particle(e, x[0], x[1], x[2], 1 + 0.1 * (i % 3));
    for (int c = 0; c < 3; c++)
      e->scene->particles.velocity[3 * (id - 1) + (uint32_t)c] = speed * (hk_random_uniform(seed) - 0.5);
  }
  return test_plugin(e, HK_FORCE, "lennard_jones");
}

static void force_energy_and_jacobian_belong_together(void **state) {
  (void)state;
  for (int variant = 0; variant < 3; variant++) {
    test_engine e;
    hk_plugin_spec *spec = open_cluster(&e, 2 + variant % 2, 0.2, 0);
    if (variant == 2) test_number(&e, spec, "cutoff", 1.5);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double gradient = force_gradient_error(force, &view), stiffness = force_stiffness_error(force, &view);
    if (!(gradient < FORCE_DIFFERENCES && stiffness < FORCE_DIFFERENCES))
      fail_msg("variant %d: gradient %g, Jacobian %g", variant, gradient, stiffness);
    test_engine_close(&e);
  }
}

/* ---- motion ---- */

/* Two particles of 1 kg start at rest at 1.3 sigma and swing between there and the inner turning point. The period is 2
 * times the integral of dr/sqrt(4 (E - U)), which becomes smooth by r = middle - half cos(theta); the trapezoidal rule
 * then converges faster than any power. */
static double period_by_quadrature(double outer, double *inner) {
  enum { NODES = 400 };
  double E = potential(1, 1, 2.5, outer), low = 0.8, high = pow(2, 1. / 6), sum = 0;
  for (int k = 0; k < 200; k++) {
    double middle = (low + high) / 2;
    *(potential(1, 1, 2.5, middle) > E ? &low : &high) = middle;
  }
  *inner = high;
  double half = (outer - high) / 2;
  for (int k = 0; k < NODES; k++) { /* midpoints: the ends are 0/0 */
    double theta = acos(-1) * (k + 0.5) / NODES, r = (outer + high) / 2 - half * cos(theta);
    sum += half * sin(theta) / sqrt(4 * (E - potential(1, 1, 2.5, r))) * acos(-1) / NODES;
  }
  return 2 * sum;
}

/* At a turning point the speed tells how early or late it is: dt = v'/a. The tolerance of the method is 1e-12 m a step;
 * 1e-8 is what quadrature (cancellation at its ends) and a few hundred steps leave. */
static void a_bound_pair_has_the_period_of_quadrature(void **state) {
  (void)state;
  test_engine e;
  double inner, period = period_by_quadrature(1.3, &inner);
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_particle(&e, 0, 1.3, 0, 1);
  test_plugin(&e, HK_FORCE, "lennard_jones");
  e.options.integrator = "dopri5";
  e.options.dt = NAN;
  e.options.tol = 1e-12;
  e.scene->fps = 2 / period;
  e.scene->duration = 10 * period;
  test_run(&e);
  for (int half = 1; half <= 7; half++) {
    test_advance(&e, half * period / 2);
    double r = test_position(&e, 2)[1] - test_position(&e, 1)[1], v = test_velocity(&e, 2)[1] - test_velocity(&e, 1)[1];
    double late = -v / (2 * push(1, 1, 2.5, r));
    if (!(fabs(late) < 1e-8 * half && fabs(r - (half % 2 ? inner : 1.3)) < 1e-8))
      fail_msg("after %d half periods of %.12g s: %g s late, at %.12g m", half, period / 2, late, r);
  }
  test_engine_close(&e);
}

/* Rounding: 125 particles of momentum about 1, a thousand steps, each with 1e-16 of the forces. */
static void momentum_is_kept_to_rounding(void **state) {
  (void)state;
  test_engine e;
  double before[3] = {0}, after[3] = {0};
  open_cluster(&e, 5, 0.1, 2);
  test_run(&e);
  for (int step = 0; step < 2; step++) {
    const hk_view *view = hk_run_view(e.run);
    for (size_t k = 0; k < 3 * view->n; k++) (step ? after : before)[k % 3] += view->model->mass[k / 3] * view->v[k];
    if (!step) test_advance(&e, 2);
  }
  for (int c = 0; c < 3; c++) assert_true(fabs(after[c] - before[c]) < 1e-12);
  test_engine_close(&e);
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { SIDE = 9, SIZE = 6 * SIDE * SIDE * SIDE };
  const int threads[] = {1, 2, 7};
  double *first = malloc(SIZE * sizeof *first), E = 0;
  for (int k = 0; k < 3; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_cluster(&e, SIDE, 0.1, 3);
    e.scene->threads = threads[k];
    test_run(&e);
    test_advance(&e, 0.2);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double now = force->plugin->force->energy(force->self, &view);
    if (k == 0) memcpy(first, e.run->state.X, SIZE * sizeof *first), E = now;
    assert_memory_equal(first, e.run->state.X, SIZE * sizeof *first);
    assert_true(E == now);
    test_engine_close(&e);
  }
  free(first);
}

/* ---- who acts on whom ---- */

static void groups_choose_the_pairs(void **state) {
  (void)state;
  const char *const scenes[][2] = {{"one", "other"}, {"other", "one"}, {"one", NULL}, {"one", "one"}};
  const bool acts[][3] = {{false, true, true}, {false, true, true}, {true, true, true}, {true, false, false}};
  for (int k = 0; k < 4; k++) {
    test_engine e;
    uint32_t group[2], id;
    double F[9];
    test_engine_open(&e);
    e.options.dt = 1e-3;
    assert_int_equal(hk_scene_add_group(e.scene, "one", &group[0], &e.error), HK_OK);
    assert_int_equal(hk_scene_add_group(e.scene, "other", &group[1], &e.error), HK_OK);
    for (int i = 0; i < 3; i++) /* at the corners of a triangle: 0 and 1 are `one`, 2 is `other` */
      assert_int_equal(hk_scene_add_particles(e.scene, 1, (double[]){1.2 * (i == 1), 1.2 * (i == 2), 0}, NULL, NULL, 1,
                                              group[i == 2], &id, &e.error),
                       HK_OK);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "lennard_jones");
    test_text(&e, spec, "first", scenes[k][0]);
    if (scenes[k][1]) test_text(&e, spec, "second", scenes[k][1]);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    force_evaluate(force, &view, F);
    assert_int_equal(F[0] != 0, acts[k][0]); /* 0 and 1 along x */
    assert_int_equal(F[1] != 0, acts[k][1]); /* 0 and 2 along y */
    assert_int_equal(F[6] != 0, acts[k][2]); /* 1 and 2 */
    test_engine_close(&e);
  }
}

static void a_group_that_is_not_there_is_refused(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_pair(&e, 1, 1, 1);
  test_text(&e, spec, "second", "argon");
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "second: the scene has no group 'argon'"));
  test_engine_close(&e);
}

/* Everything is finite in one place, but a run does not go on from there. */
static void particles_in_one_place_end_the_run(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e, 1, 1, 0);
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 0.1, &e.error), HK_FAILED);
  assert_non_null(strstr(e.error.text, "particles 1 and 2 are 0 m apart"));
  test_engine_close(&e);
}

/* The plugin asks for steps in which a particle goes sigma/8 at most. */
static void fast_particles_take_short_steps(void **state) {
  (void)state;
  test_engine e;
  open_pair(&e, 1, 1, 4);
  e.scene->particles.velocity[0] = 500;
  test_run(&e);
  test_advance(&e, 0.1);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(s.dt_max <= 0.125 / 500 * (1 + 1e-9));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(force_and_energy_by_hand),
      cmocka_unit_test(force_energy_and_jacobian_belong_together),
      cmocka_unit_test(a_bound_pair_has_the_period_of_quadrature),
      cmocka_unit_test(momentum_is_kept_to_rounding),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(groups_choose_the_pairs),
      cmocka_unit_test(a_group_that_is_not_there_is_refused),
      cmocka_unit_test(particles_in_one_place_end_the_run),
      cmocka_unit_test(fast_particles_take_short_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
