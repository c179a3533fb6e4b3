/* Sheets that soften by their channel, melt and tear: the force and its derivatives, the energy that is lost, what
 * stays gone, and what is refused. */
#include "tests/plugins/forces/membranes.h"
#include "tests/support/melting.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double Y = 40, softens = 250, melts = 270, mass = 0.5, reach = 0.2; /* N/m; K; kg; m */

/* A square of 1 m of two triangles at the temperature T; its side at x = 0 is fixed, the other one is 1 + reach away at
 * the start. It is pulled evenly. */
static hk_plugin_spec *square(test_engine *e, double T) {
  test_engine_open(e);
  melting_channel(e, T);
  test_particle(e, 0, 0, 0, mass), test_particle(e, 0, 1, 0, mass);
  test_particle(e, 1 + reach, 0, 0, mass), test_particle(e, 1 + reach, 1, 0, mass);
  for (uint32_t id = 1; id <= 2; id++) test_pin(e, HK_PIN_FIXED, id, NULL);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "melting_membrane");
  test_tuples(e, spec, "triangles", 3, (uint32_t[]){1, 3, 2, 3, 4, 2}, 2);
  test_number(e, spec, "stiffness", Y);
  test_number(e, spec, "rest", 1 / (1 + reach));
  melting_follows(e, spec, softens, melts - softens);
  e->options.integrator = "leapfrog";
  e->options.dt = 1e-3;
  e->scene->fps = 1000;
  return spec;
}

/* `rest` makes the width shorter at rest, too, which lines keep as it is: both masses swing along x about x = 1, with
 * |f_u| = x and the area 1/(1 + reach) m^2 at rest. */
static void softened_sheets_swing_slower(void **state) {
  (void)state;
  for (double T = 240; T < melts; T += 5) {
    test_engine e;
    double s = fmin(1, (melts - T) / (melts - softens)), w = sqrt(s * Y / (1 + reach) / (2 * mass));
    square(&e, T);
    for (uint32_t id = 3; id <= 4; id++) test_pin(&e, HK_PIN_LINE, id, (double[]){1, 0, 0});
    test_run(&e);
    test_advance(&e, 1);
    for (uint32_t id = 3; id <= 4; id++) {
      double off = test_position(&e, id)[0] - 1 - reach * cos(w);
      if (fabs(off) > 1e-5) fail_msg("at %g K: off by %g m", T, off); /* (w h)^2/24 w t reach = 2e-6 */
    }
    test_engine_close(&e);
  }
}

/* Of a sheet that warms by 40 K/s and is gone after 0.5 s the energy balance closes: what it loses is dissipated. Then
 * its particles fly on. */
static void what_melts_is_gone_and_its_energy_is_counted(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  square(&e, softens);
  melting_warms(&e, 40);
  test_run(&e);
  test_advance(&e, 0.6);
  double v[3];
  memcpy(v, test_velocity(&e, 3), sizeof v);
  test_advance(&e, 0.7);
  assert_memory_equal(v, test_velocity(&e, 3), sizeof v);
  assert_true(fabs(v[0]) > 0.1);
  hk_run_summary(e.run, &s);
  printf("%.4g m/s, drift %.2g\n", v[0], s.energy_drift);
  assert_true(fabs(s.energy_drift) < 1e-3);
  test_engine_close(&e);
}

static void what_has_only_softened_is_stiff_again(void **state) {
  (void)state;
  for (int molten = 0; molten < 2; molten++) {
    test_engine e;
    square(&e, melts + (molten ? 1 : -1));
    melting_warms(&e, -100);
    test_run(&e);
    test_advance(&e, 1);
    double before = test_velocity(&e, 3)[0];
    test_advance(&e, 1.5);
    assert_true((test_velocity(&e, 3)[0] == before) == molten);
    test_engine_close(&e);
  }
}

/* Cold, it tears above its strain, 0.2 at the start. */
static void strain_tears(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    test_engine e;
    test_number(&e, square(&e, 0), "breaking", k ? 0.19 : 0.21);
    test_run(&e);
    test_advance(&e, 0.2);
    double v = test_velocity(&e, 3)[0];
    test_advance(&e, 0.3);
    assert_true((test_velocity(&e, 3)[0] == v) == k);
    test_engine_close(&e);
  }
}

/* Of each energy: half as stiff half way, with derivatives that are those of the energy; and nothing where it is gone,
 * with definite blocks, too. */
static void forces_are_those_of_a_sheet_times_its_factor(void **state) {
  (void)state;
  for (int k = 0; k < 2 * MATERIALS; k++) {
    sheet s = sheet_make(SHEET_IRREGULAR, 3, (double[]){0, 0, 0});
    size_t size = 3 * s.particles;
    double *F[2] = {calloc(size, 8), calloc(size, 8)}, *x = malloc(size * 8), *v = calloc(size, 8), largest = 0;
    bool gone = k >= MATERIALS;
    for (int kind = 0; kind < 2; kind++) {
      test_engine e;
      uint64_t seed = 5;
      test_engine_open(&e);
      melting_channel(&e, gone ? melts : (softens + melts) / 2);
      hk_plugin_spec *spec = sheet_add(&e, &s, kind ? "membrane" : "melting_membrane");
      set(&e, spec, &MATERIAL[k % MATERIALS]);
      if (!kind) melting_follows(&e, spec, softens, melts - softens);
      test_run(&e);
      hk_instance *force = test_instance(&e, spec);
      hk_view view = force_view(&e, force);
      for (size_t c = 0; c < size; c++) x[c] = view.x[c] * (1 + 0.1 * (double)(c % 3)) + 0.2 * noise(&seed);
      view.x = x, view.v = v;
      force_evaluate(force, &view, F[kind]);
      if (!kind && !gone) {
        assert_true(force_gradient_error(force, &view) < FORCE_DIFFERENCES);
        assert_true(force_stiffness_error(force, &view) < FORCE_DIFFERENCES);
      }
      if (!kind && gone) {
        double *K = calloc(2 * size * size, 8);
        force_matrices(force, &view, K, K + size * size);
        for (size_t c = 0; c < 2 * size * size; c++) assert_true(K[c] == 0);
        free(K);
      }
      test_engine_close(&e);
    }
    for (size_t c = 0; c < size; c++) largest = fmax(largest, fabs(F[1][c]));
    for (size_t c = 0; c < size; c++)
      if (!(fabs(F[0][c] - (gone ? 0 : F[1][c] / 2)) <= 1e-15 * largest)) fail_msg("material %d, number %zu", k, c);
    free(F[0]), free(F[1]), free(x), free(v);
    sheet_free(&s);
  }
}

static void no_channel_is_refused(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = square(&e, 0);
  melting_needs_its_channel(&e, spec);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(softened_sheets_swing_slower),
      cmocka_unit_test(what_melts_is_gone_and_its_energy_is_counted),
      cmocka_unit_test(what_has_only_softened_is_stiff_again),
      cmocka_unit_test(strain_tears),
      cmocka_unit_test(forces_are_those_of_a_sheet_times_its_factor),
      cmocka_unit_test(no_channel_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
