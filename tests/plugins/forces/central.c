/* The pull by hand, against its energy and Jacobian for many powers, and at the centre. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e, double strength, double power, double softening) {
  test_engine_open(e);
  test_particle(e, 3, 4, 0, 2);
  test_particle(e, -0.7, 0.9, 0.5, 0.5);
  test_particle(e, 0.8, -1.1, 1.4, 1);
  e->options.dt = 1e-3;
  hk_plugin_spec *central = test_plugin(e, HK_FORCE, "central");
  test_number(e, central, "strength", strength);
  test_number(e, central, "power", power);
  test_number(e, central, "softening", softening);
  return central;
}

/* The force on the particle of 2 kg at (3, 4, 0); a handful of roundings. */
static void first_is(test_engine *e, const hk_plugin_spec *spec, double x, double y, double z) {
  double F[9], wanted[3] = {x, y, z};
  test_run(e);
  hk_instance *central = test_instance(e, spec);
  hk_view view = force_view(e, central);
  force_evaluate(central, &view, F);
  for (int c = 0; c < 3; c++)
    if (!(fabs(F[c] - wanted[c]) < 1e-14)) fail_msg("component %d: %.17g instead of %.17g", c, F[c], wanted[c]);
  test_engine_close(e);
}

static void harmonic_pull_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *central = open_scene(&e, 0.5, 1, 0);
  first_is(&e, central, -3, -4, 0);
}

/* GM = 50 at distance 5: 2 m/s^2, so 4 N on 2 kg. */
static void kepler_pull_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *central = open_scene(&e, 50, -2, 0);
  first_is(&e, central, -4 * 0.6, -4 * 0.8, 0);
}

/* s = sqrt(5^2 + 12^2) = 13: F = -2 strength r/13^3. */
static void softened_pull_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *central = open_scene(&e, 2197, -2, 12);
  first_is(&e, central, -6, -8, 0);
}

/* Distance 3 from the line x = 0, y = 4 along z, whatever the length of the axis; per particle, power 0: 7 N outward.
 */
static void push_from_a_line_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *central = open_scene(&e, -7, 0, 0);
  test_vector(&e, central, "center", 0, 4, -9);
  test_vector(&e, central, "axis", 0, 0, 5);
  test_text(&e, central, "per", "particle");
  first_is(&e, central, 7, 0, 0);
}

static void energy_by_hand(void **state) {
  (void)state;
  const double powers[] = {1, -2, -1}, wanted[] = {3. * 25 / 2, -3. / 5, 3 * 1.6094379124341003}; /* the last: ln 5 */
  for (int k = 0; k < 3; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, 3, powers[k], 0);
    test_text(&e, spec, "per", "particle");
    spec->only = calloc(1, sizeof *spec->only);
    spec->only_count = 1;
    test_run(&e);
    hk_instance *central = test_instance(&e, spec);
    hk_view view = force_view(&e, central);
    assert_true(fabs(central->plugin->force->energy(central->self, &view) - wanted[k]) < 1e-14 * fabs(wanted[k]));
    test_engine_close(&e);
  }
}

static void force_energy_and_jacobian_belong_together(void **state) {
  (void)state;
  const double powers[] = {1, -2, -1, 0, 3, -3.5, 0.5};
  for (size_t k = 0; k < sizeof powers / sizeof *powers; k++)
    for (int variant = 0; variant < 8; variant++) {
      test_engine e;
      hk_plugin_spec *spec = open_scene(&e, variant & 1 ? -2 : 3, powers[k], variant & 1 ? 0.4 : 0);
      test_vector(&e, spec, "center", 0.1, -0.2, 0.15);
      if (variant & 2) test_vector(&e, spec, "axis", 1, 2, -0.5);
      if (variant & 4) test_text(&e, spec, "per", "particle");
      test_run(&e);
      hk_instance *central = test_instance(&e, spec);
      hk_view view = force_view(&e, central);
      double gradient = force_gradient_error(central, &view), stiffness = force_stiffness_error(central, &view);
      if (!(gradient < FORCE_DIFFERENCES && stiffness < FORCE_DIFFERENCES))
        fail_msg("power %g, variant %d: gradient %g, Jacobian %g", powers[k], variant, gradient, stiffness);
      test_engine_close(&e);
    }
}

/* Within the range F and its energy belong together, up to the end and across it; behind it there is nothing. The
 * particles are 2 to 5 m away, softened by 0.4 m or not. */
static void a_force_with_a_range_ends_smoothly(void **state) {
  (void)state;
  const double powers[] = {1, -2, -1, 0, 3, -3, -5, 0.5}, ranges[] = {1e3, 2.5, 2, 1.3};
  for (size_t k = 0; k < sizeof powers / sizeof *powers; k++)
    for (size_t r = 0; r < 2 * sizeof ranges / sizeof *ranges; r++) {
      test_engine e;
      hk_plugin_spec *spec = open_scene(&e, 3, powers[k], r % 2 ? 0.4 : 0);
      test_number(&e, spec, "range", ranges[r / 2]);
      test_run(&e);
      hk_instance *central = test_instance(&e, spec);
      hk_view view = force_view(&e, central);
      double F[9], gradient = force_gradient_error(central, &view), stiffness = force_stiffness_error(central, &view);
      /* The energy is a difference of integrals, of up to 1e3^(power + 1): its roundings divided by steps of 1e-5. */
      double rounding = 1e-11 * fmax(1, pow(ranges[r / 2], powers[k] + 1));
      /* Where the only particle inside is near the end, as with 1.3 m, F is small beside its derivatives. */
      double small = ranges[r / 2] == 1.3 ? 10 * FORCE_DIFFERENCES : FORCE_DIFFERENCES;
      if (!(gradient < small + rounding && stiffness < small))
        fail_msg("power %g, range %g: gradient %g, Jacobian %g", powers[k], ranges[r / 2], gradient, stiffness);
      force_evaluate(central, &view, F);
      for (int i = 0; i < 3; i++) {
        const double *x = view.x + 3 * i;
        bool near = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) < ranges[r / 2];
        assert_true(near == (F[3 * i] != 0));
      }
      test_engine_close(&e);
    }
}

/* W = (1 - 9/25)^2 at 3 m of a range of 5: F = 4 W/9 N. */
static void a_force_with_a_range_by_hand(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *central = open_scene(&e, 2, -2, 0);
  test_number(&e, central, "range", 5);
  memcpy(e.scene->particles.position, (double[]){0, 0, 3}, 3 * sizeof(double));
  first_is(&e, central, 0, 0, -4 * 0.64 * 0.64 / 9);
}

/* Where the square of the distance overflows a pull without a range is no number to go on with. */
static void a_pull_from_beyond_the_range_of_doubles_is_not_zero(void **state) {
  (void)state;
  for (int ends = 0; ends < 2; ends++) {
    test_engine e;
    double F[9], x[9] = {1e200, 0, 0};
    hk_plugin_spec *spec = open_scene(&e, 3, 2, 0);
    if (ends) test_number(&e, spec, "range", 5);
    test_run(&e);
    hk_instance *central = test_instance(&e, spec);
    hk_view view = force_view(&e, central);
    view.x = x;
    force_evaluate(central, &view, F);
    assert_true(ends ? F[0] == 0 : !isfinite(F[0]));
    test_engine_close(&e);
  }
}

/* A push that ends 1 mm around a point, even one that grows with the distance, lies between two steps. */
static void a_range_that_steps_pass_by_is_noticed(void **state) {
  (void)state;
  const double powers[] = {-2, 1};
  for (int k = 0; k < 4; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, -1e4, powers[k % 2], 1e-4);
    test_number(&e, spec, "range", k < 2 ? 1e-3 : 2);
    for (size_t i = 0; i < 3; i++) {
      memcpy(e.scene->particles.position + 3 * i, (double[]){-0.33, 1e-4 * (double)i, 0}, 3 * sizeof(double));
      memcpy(e.scene->particles.velocity + 3 * i, (double[]){1, 0, 0}, 3 * sizeof(double));
    }
    e.options.dt = k < 2 ? 1. / 60 : 1e-4;
    e.options.compare = HK_COMPARE_ALWAYS; /* encounters are looked at where a run is judged */
    e.scene->duration = 0.5;
    test_run(&e);
    test_advance(&e, k < 2 ? 0.5 : 0.01);
    assert_true((k < 2) == (e.run->record.passed_most > 0));
    test_engine_close(&e);
  }
}

static void nothing_at_the_centre_is_nan(void **state) {
  (void)state;
  const double powers[] = {1, -2, -1, 0, 3, -0.5}, near[] = {0, 4e-324, 1e-155, 1e-110, 1e-90};
  for (size_t k = 0; k < sizeof powers / sizeof *powers; k++)
    for (size_t d = 0; d < sizeof near / sizeof *near; d++) {
      test_engine e;
      hk_plugin_spec *spec = open_scene(&e, 3, powers[k], 0);
      memcpy(e.scene->particles.position, (double[]){near[d], 0, 0}, 3 * sizeof(double));
      test_run(&e);
      hk_instance *central = test_instance(&e, spec);
      hk_view view = force_view(&e, central);
      double F[9], K[81], D[81];
      force_evaluate(central, &view, F);
      force_matrices(central, &view, K, D);
      for (int c = 0; c < 3; c++) assert_true(isfinite(F[c]) && (near[d] > 0 || F[c] == 0));
      for (int c = 0; c < 81; c++) assert_true(!isnan(K[c]));
      assert_true(isfinite(central->plugin->force->energy(central->self, &view)));
      test_engine_close(&e);
    }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { PARTICLES = 5000 };
  double *F = malloc(3 * PARTICLES * sizeof *F), *first = malloc(3 * PARTICLES * sizeof *first);
  double *x = malloc(3 * PARTICLES * sizeof *x);
  for (size_t k = 0; k < 3 * PARTICLES; k++) x[k] = sin((double)k);
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    uint32_t id;
    test_engine_open(&e);
    e.scene->threads = threads;
    e.options.dt = 1e-3;
    assert_int_equal(hk_scene_add_particles(e.scene, PARTICLES, x, NULL, NULL, 0.1, 0, &id, &e.error), HK_OK);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "central");
    test_number(&e, spec, "strength", 3);
    test_number(&e, spec, "power", -1.5);
    test_run(&e);
    hk_instance *central = test_instance(&e, spec);
    hk_view view = force_view(&e, central);
    force_evaluate(central, &view, F);
    if (threads == 1) memcpy(first, F, 3 * PARTICLES * sizeof *F);
    assert_memory_equal(first, F, 3 * PARTICLES * sizeof *F);
    assert_true(F[3 * PARTICLES - 1] != 0);
    test_engine_close(&e);
  }
  free(F);
  free(first);
  free(x);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(harmonic_pull_by_hand),
      cmocka_unit_test(kepler_pull_by_hand),
      cmocka_unit_test(softened_pull_by_hand),
      cmocka_unit_test(push_from_a_line_by_hand),
      cmocka_unit_test(energy_by_hand),
      cmocka_unit_test(force_energy_and_jacobian_belong_together),
      cmocka_unit_test(a_force_with_a_range_ends_smoothly),
      cmocka_unit_test(a_force_with_a_range_by_hand),
      cmocka_unit_test(a_pull_from_beyond_the_range_of_doubles_is_not_zero),
      cmocka_unit_test(a_range_that_steps_pass_by_is_noticed),
      cmocka_unit_test(nothing_at_the_centre_is_nan),
      cmocka_unit_test(threads_give_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
