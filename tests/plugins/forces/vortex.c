/* Vortices: their speeds by formula, Jacobians, the path inside a body of air that turns, the selection and threads,
 * and thin cores that steps pass by. */
#include "tests/support/force_check.h"

#include <complex.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double two_pi = 6.283185307179586;

static hk_plugin_spec *open_vortex(test_engine *e, const char *profile, double strength, double core, double rate) {
  hk_plugin_spec *vortex = test_plugin(e, HK_FORCE, "vortex");
  test_text(e, vortex, "profile", profile);
  test_number(e, vortex, "strength", strength);
  test_number(e, vortex, "core", core);
  test_number(e, vortex, "rate", rate);
  e->options.dt = 1e-3;
  return vortex;
}

/* The force on 2 kg at rest, 2 m above the axis along x, whose air moves to -y: strength 3, core 0.8, rate 5. */
static void check_speed(const char *profile, double r, double speed) {
  test_engine e;
  double F[3];
  test_engine_open(&e);
  test_particle(&e, 7, 1, -1 + r, 2);
  hk_plugin_spec *spec = open_vortex(&e, profile, 3, 0.8, 5);
  test_vector(&e, spec, "axis", 4, 0, 0);
  test_vector(&e, spec, "center", 2, 1, -1);
  test_run(&e);
  hk_instance *vortex = test_instance(&e, spec);
  hk_view view = force_view(&e, vortex);
  force_evaluate(vortex, &view, F);
  double wanted[3] = {0, -10 * speed, 0};
  for (int c = 0; c < 3; c++) /* some roundings of numbers up to 10 */
    if (!(fabs(F[c] - wanted[c]) < 2e-14)) fail_msg("%s at %g m: F[%d] = %.17g", profile, r, c, F[c]);
  test_engine_close(&e);
}

static void speeds_are_those_of_rankine_and_of_lamb_and_oseen(void **state) {
  (void)state;
  const double at[] = {1e-9, 1e-3, 0.01, 0.3, 0.79, 0.81, 2, 40};
  for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
    double r = at[k], outside = 3 / (two_pi * r), q = r * r / 0.64;
    check_speed("rankine", r, r < 0.8 ? 3 * r / (two_pi * 0.64) : outside);
    check_speed("lamb_oseen", r, outside * -expm1(-q));
  }
}

static void jacobian_is_that_of_the_force_and_has_no_divergence(void **state) {
  (void)state;
  const char *const profiles[] = {"rankine", "lamb_oseen"};
  for (int k = 0; k < 4; k++) {
    test_engine e;
    double K[81], D[81];
    test_engine_open(&e);
    test_particle(&e, 0.1, 0.2, 0.3, 2), test_particle(&e, 2, -1, 0.5, 1), test_particle(&e, 0.01, -0.02, 0.01, 0.5);
    for (size_t c = 0; c < 9; c++) e.scene->particles.velocity[c] = sin(1.3 * (double)c);
    hk_plugin_spec *spec = open_vortex(&e, profiles[k % 2], -2, 0.6, 3);
    test_vector(&e, spec, "axis", 1, 2, -0.5);
    if (k / 2) test_boolean(&e, spec, "relative", false);
    test_run(&e);
    hk_instance *vortex = test_instance(&e, spec);
    hk_view view = force_view(&e, vortex);
    double stiffness = force_stiffness_error(vortex, &view), damping = force_damping_error(vortex, &view);
    /* Of F = d u alone there is no D: the differences of nothing. */
    if (!(stiffness < FORCE_DIFFERENCES && (damping < FORCE_DIFFERENCES)))
      fail_msg("%s: K %g, D %g", profiles[k % 2], stiffness, damping);
    force_matrices(vortex, &view, K, D);
    for (int i = 0; i < 3; i++)
      assert_true(fabs(K[30 * i] + K[30 * i + 10] + K[30 * i + 20]) < 1e-15 * fabs(K[30 * i + 1]) + 1e-15);
    test_engine_close(&e);
  }
}

/* Inside Rankine's core z = x + i y obeys z'' = g (i W z - z'), with the roots of l^2 + g l - i g W = 0. rk4 with 2000
 * steps of 1/1000 s leaves (h |l|)^4 times some of the path's length: 1e-11 of 2 m. */
static void path_in_air_that_turns_like_a_body_is_its_closed_form(void **state) {
  (void)state;
  const double g = 3, W = 2, core = 10, T = 2;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 1, 0, 0.5, 0.3);
  memcpy(e.scene->particles.velocity, (double[]){0.2, -0.4, 0.1}, 3 * sizeof(double));
  open_vortex(&e, "rankine", two_pi * core * core * W, core, g);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->duration = T;
  test_run(&e);
  test_advance(&e, T);
  double complex root = csqrt(g * g / 4 + I * g * W), a = -g / 2 + root, b = -g / 2 - root, z0 = 1, v0 = 0.2 - 0.4 * I;
  double complex A = (v0 - b * z0) / (a - b), z = A * cexp(a * T) + (z0 - A) * cexp(b * T);
  double along = 0.5 + 0.1 * (1 - exp(-g * T)) / g;
  const double *x = test_position(&e, 1), wanted[3] = {creal(z), cimag(z), along};
  for (int c = 0; c < 3; c++)
    if (!(fabs(x[c] - wanted[c]) < 1e-10)) fail_msg("x[%d] = %.15g instead of %.15g", c, x[c], wanted[c]);
  test_engine_close(&e);
}

/* Particles of a selection, and on 1 to 3 threads, the same bits. */
static void force_and_power_are_the_same_for_a_selection_and_for_any_threads(void **state) {
  (void)state;
  enum { PARTICLES = 9001 };
  static double F[3 * PARTICLES], first[3 * PARTICLES], x[3 * PARTICLES], v[3 * PARTICLES];
  double power = 0;
  for (size_t k = 0; k < 3 * PARTICLES; k++) x[k] = sin((double)k), v[k] = cos(3 * (double)k);
  for (int run = 0; run < 4; run++) {
    test_engine e;
    uint32_t id;
    test_engine_open(&e);
    e.scene->threads = run % 3 + 1;
    assert_int_equal(hk_scene_add_particles(e.scene, PARTICLES, x, v, NULL, 0.1, 0, &id, &e.error), HK_OK);
    hk_plugin_spec *spec = open_vortex(&e, "lamb_oseen", 2, 0.3, 4);
    if (run == 3) {
      spec->only = malloc(PARTICLES * sizeof *spec->only);
      for (uint32_t i = 0; i < PARTICLES; i += 2) spec->only[spec->only_count++] = i;
    }
    test_run(&e);
    hk_instance *vortex = test_instance(&e, spec);
    hk_view view = force_view(&e, vortex);
    double done = force_evaluate(vortex, &view, F);
    if (run == 0) memcpy(first, F, sizeof F), power = done;
    for (size_t k = 0; k < 3 * PARTICLES; k++) assert_true(F[k] == (run == 3 && k / 3 % 2 ? 0 : first[k]));
    assert_true(run == 3 || done == power);
    test_engine_close(&e);
  }
}

/* A particle goes through the core of a thin vortex between two steps; half the step does so as well. */
static void a_core_that_steps_pass_by_is_noticed(void **state) {
  (void)state;
  for (int thin = 0; thin < 2; thin++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0.05, 2e-4, 0, 1);
    memcpy(e.scene->particles.velocity, (double[]){-30, 0, 0}, 3 * sizeof(double));
    open_vortex(&e, "lamb_oseen", 1, thin ? 1e-4 : 0.5, 5);
    e.options.dt = 1. / 60;
    e.options.compare = HK_COMPARE_ALWAYS; /* encounters are looked at where a run is judged */
    e.scene->duration = 0.1;
    test_run(&e);
    test_advance(&e, 0.1);
    assert_true(thin == (e.run->record.passed_most > 0));
    test_engine_close(&e);
  }
}

static void nonsense_is_refused(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 1, 0, 0, 1);
    hk_plugin_spec *vortex = test_plugin(&e, HK_FORCE, "vortex");
    test_number(&e, vortex, "strength", 1);
    if (k < 2) test_number(&e, vortex, "d", 1);
    if (k == 0) test_vector(&e, vortex, "axis", 0, 0, 0);
    if (k == 1) test_number(&e, vortex, "rate", 1);
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    assert_non_null(strstr(e.error.text, k == 0 ? "axis: it has no direction" : "give either d"));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(speeds_are_those_of_rankine_and_of_lamb_and_oseen),
      cmocka_unit_test(jacobian_is_that_of_the_force_and_has_no_divergence),
      cmocka_unit_test(path_in_air_that_turns_like_a_body_is_its_closed_form),
      cmocka_unit_test(force_and_power_are_the_same_for_a_selection_and_for_any_threads),
      cmocka_unit_test(a_core_that_steps_pass_by_is_noticed),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
