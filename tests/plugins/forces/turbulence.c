/* Turbulence: without divergence, of the speed asked for, with the spectrum asked for, the same for equal seeds however
 * it is asked, carried by its drift; and steps that its waves ask for. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <complex.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { PARTICLES = 20000 };

typedef struct air {
  test_engine e;
  hk_plugin_spec *spec;
  hk_instance *force;
  hk_view view;
  double *F; /* n x 3: of particles at rest with d = 1, the air's velocity */
} air;

static void open_air(air *a, size_t n, const double *x) {
  uint32_t id;
  test_engine_open(&a->e);
  assert_int_equal(hk_scene_add_particles(a->e.scene, n, x, NULL, NULL, 1, 0, &id, &a->e.error), HK_OK);
  a->e.options.dt = 1e-3;
  a->spec = test_plugin(&a->e, HK_FORCE, "turbulence");
  a->F = calloc(3 * n + 1, sizeof *a->F);
  test_number(&a->e, a->spec, "d", 1);
  test_number(&a->e, a->spec, "speed", 2);
  test_number(&a->e, a->spec, "largest", 1);
  test_number(&a->e, a->spec, "smallest", 0.1);
}

static void evaluate(air *a, double t) {
  if (!a->force) {
    test_run(&a->e);
    a->force = test_instance(&a->e, a->spec);
    a->view = force_view(&a->e, a->force);
  }
  a->view.t = t;
  force_evaluate(a->force, &a->view, a->F);
}

static void close_air(air *a) {
  free(a->F);
  test_engine_close(&a->e);
  *a = (air){.F = NULL};
}

static double *scattered(size_t count, double size) {
  double *x = malloc(3 * count * sizeof *x);
  uint64_t random[4];
  hk_random_seed(random, 7);
  for (size_t k = 0; k < 3 * count; k++) x[k] = size * (hk_random_uniform(random) - 0.5);
  return x;
}

/* The trace of du/dx, from the plugin's own blocks and by differences of the air. Blocks: some roundings of 48 waves of
 * up to 2 pi 10 1/m. Differences over h: (2 pi 10 h)^2/6 of each of the three slopes of up to 100 1/s. */
static void divergence_is_zero(void **state) {
  (void)state;
  enum { PLACES = 3 };
  const double h = 1e-5, *const at = (const double[]){0.3, -0.7, 0.2, 5, 1, -2, 0, 0, 0};
  double x[3 * 7 * PLACES], K[441 * PLACES * PLACES], D[441 * PLACES * PLACES];
  air a = {.F = NULL};
  for (size_t p = 0; p < PLACES; p++)
    for (size_t k = 0; k < 7; k++)
      for (size_t c = 0; c < 3; c++)
        x[3 * (7 * p + k) + c] = at[3 * p + c] + (k / 2 == c && k < 6 ? (k % 2 ? h : -h) : 0);
  open_air(&a, 7 * PLACES, x);
  evaluate(&a, 0.4);
  for (size_t p = 0; p < PLACES; p++) {
    double divergence = 0;
    for (size_t c = 0; c < 3; c++)
      divergence += (a.F[3 * (7 * p + 2 * c + 1) + c] - a.F[3 * (7 * p + 2 * c) + c]) / (2 * h);
    if (!(fabs(divergence) < 3 * 100 * 39 * 39 * 4 * h * h / 6)) fail_msg("divergence %g 1/s", divergence);
  }
  assert_int_equal(force_matrices(a.force, &a.view, K, D), 7 * PLACES);
  size_t row = 3 * 7 * PLACES;
  for (size_t i = 0; i < 7 * PLACES; i++) {
    double trace = 0;
    for (size_t c = 0; c < 3; c++) trace += K[(3 * i + c) * row + 3 * i + c];
    assert_true(fabs(trace) < 1e-12);
  }
  assert_true(force_stiffness_error(a.force, &a.view) < FORCE_DIFFERENCES);
  close_air(&a);
}

/* Over a cube of a hundred wavelengths the mean square is speed^2 but for the sampling: 48 waves, of which the energies
 * add up to it exactly, at 20,000 places, leave about 1/sqrt(20,000) = 0.7 %; four times that. The mean velocity has
 * the spread speed/sqrt(3 20,000). */
static void mean_square_is_that_of_the_speed(void **state) {
  (void)state;
  double *x = scattered(PARTICLES, 100), square = 0, mean[3] = {0};
  air a = {.F = NULL};
  open_air(&a, PARTICLES, x);
  evaluate(&a, 12);
  for (size_t k = 0; k < 3 * PARTICLES; k++) square += a.F[k] * a.F[k] / PARTICLES, mean[k % 3] += a.F[k] / PARTICLES;
  if (!(fabs(square / 4 - 1) < 0.03)) fail_msg("mean square %g", square);
  for (int c = 0; c < 3; c++) assert_true(fabs(mean[c]) < 4 * 2 / sqrt(PARTICLES));
  close_air(&a);
  free(x);
}

/* Along a line of 64 wavelengths of the largest eddies, with a window (of Blackman and Harris, whose side lobes are
 * below -92 dB), there is nothing beyond 1/smallest = 10 1/m: of a window of 64 m the main lobe reaches 4/64 further.
 */
static void nothing_changes_within_less_than_the_smallest_length(void **state) {
  (void)state;
  enum { LINE = 4096 };
  const double length = 64, pi = 3.141592653589793;
  double *x = calloc(3 * LINE, sizeof *x), inside = 0, outside = 0;
  for (size_t k = 0; k < LINE; k++) x[3 * k] = length * (double)k / LINE;
  air a = {.F = NULL};
  open_air(&a, LINE, x);
  evaluate(&a, 0);
  for (size_t q = 1; q < LINE / 2; q += 7) { /* 1/64 1/m each */
    double complex sum = 0;
    for (size_t k = 0; k < LINE; k++) {
      double w = 2 * pi * (double)k / LINE,
             window = 0.35875 - 0.48829 * cos(w) + 0.14128 * cos(2 * w) - 0.01168 * cos(3 * w);
      sum += window * a.F[3 * k] * cexp(-I * w * (double)q);
    }
    *((double)q / length < 10.1 ? &inside : &outside) += creal(sum * conj(sum));
  }
  if (!(outside < 1e-9 * inside)) fail_msg("%g of the energy is at shorter waves", outside / inside);
  close_air(&a);
  free(x);
}

static void equal_seeds_give_equal_air_in_any_order_and_on_any_threads(void **state) {
  (void)state;
  double *x = scattered(PARTICLES, 3), *first = malloc(3 * PARTICLES * sizeof *first);
  for (int run = 0; run < 4; run++) {
    air a = {.F = NULL};
    open_air(&a, PARTICLES, x);
    a.e.scene->threads = run % 3 + 1;
    test_number(&a.e, a.spec, "seed", run == 3 ? 6 : 5);
    if (run == 1) evaluate(&a, 3), evaluate(&a, 0.5); /* other times before */
    evaluate(&a, 1.7);
    if (run == 0) memcpy(first, a.F, 3 * PARTICLES * sizeof *first);
    assert_true((memcmp(first, a.F, 3 * PARTICLES * sizeof *first) == 0) == (run < 3));
    close_air(&a);
  }
  free(first);
  free(x);
}

/* Frozen air that drifts is the same air elsewhere: some roundings of a phase of some turns, over waves of 2 m/s. */
static void drift_carries_the_pattern(void **state) {
  (void)state;
  double x[6] = {0.3, 0.2, -0.1, 0.3 + 2 * 1.5, 0.2 - 2 * 0.5, -0.1 + 2 * 0.25};
  air a = {.F = NULL};
  open_air(&a, 2, x);
  test_number(&a.e, a.spec, "evolution", 0);
  test_vector(&a.e, a.spec, "drift", 1.5, -0.5, 0.25);
  evaluate(&a, 0);
  double before[3] = {a.F[0], a.F[1], a.F[2]};
  evaluate(&a, 2);
  for (int c = 0; c < 3; c++) assert_true(fabs(a.F[3 + c] - before[c]) < 1e-12);
  close_air(&a);
}

/* A quarter of 0.1 m at 5 m/s through the pattern. */
static void no_step_jumps_over_an_eddy(void **state) {
  (void)state;
  air a = {.F = NULL};
  open_air(&a, 2, (double[6]){0});
  memcpy(a.e.scene->particles.velocity, (double[]){1, 0, 0, 3, 4, 2}, 6 * sizeof(double));
  test_vector(&a.e, a.spec, "drift", 0, 0, 2);
  evaluate(&a, 0);
  assert_true(fabs(hk_force_of(a.force->plugin)->bounds.longest_step(a.force->self, &a.view) - 0.005) < 1e-17);
  close_air(&a);
}

static void nonsense_is_refused(void **state) {
  (void)state;
  air a = {.F = NULL};
  open_air(&a, 1, (double[3]){0});
  test_number(&a.e, a.spec, "smallest", 3);
  assert_int_equal(hk_run_open(a.e.scene, &a.e.options, &a.e.run, &a.e.error), HK_BAD_PARAM);
  assert_non_null(strstr(a.e.error.text, "smallest: 3 m is longer than largest, 1 m"));
  close_air(&a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(divergence_is_zero),
      cmocka_unit_test(mean_square_is_that_of_the_speed),
      cmocka_unit_test(nothing_changes_within_less_than_the_smallest_length),
      cmocka_unit_test(equal_seeds_give_equal_air_in_any_order_and_on_any_threads),
      cmocka_unit_test(drift_carries_the_pattern),
      cmocka_unit_test(no_step_jumps_over_an_eddy),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
