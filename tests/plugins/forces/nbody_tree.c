/* Gravitation by the tree, against the sum over all pairs: errors within what is asked for, equality where nothing may
 * be left out, and everything that must not depend on how it is summed. */
#include "core/engine/contract/contract.h"
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4000 };

/* A Plummer sphere of radius 1 and mass 1, cut off at 20. */
static void add_sphere(test_engine *e, size_t n) {
  uint64_t seed[4];
  double *x = malloc(3 * n * sizeof *x);
  uint32_t first;
  hk_random_seed(seed, 9);
  for (size_t i = 0; i < n; i++) {
    double r = 1 / sqrt(pow(hk_random_uniform(seed) * 0.995, -2.0 / 3) - 1), z = 2 * hk_random_uniform(seed) - 1;
    double angle = 6.283185307179586 * hk_random_uniform(seed), s = sqrt(1 - z * z);
    x[3 * i] = r * s * cos(angle), x[3 * i + 1] = r * s * sin(angle), x[3 * i + 2] = r * z;
  }
  assert_int_equal(hk_scene_add_particles(e->scene, n, x, NULL, NULL, 1.0 / (double)n, 0, &first, &e->error), HK_OK);
  free(x);
}

static hk_plugin_spec *add_force(test_engine *e, const char *method, double softening) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "nbody");
  test_text(e, spec, "method", method);
  test_number(e, spec, "G", 1);
  test_number(e, spec, "softening", softening);
  return spec;
}

/* Opens the sphere with a tree, whose forces are in F; those over all pairs are in exact. */
static hk_plugin_spec *open_sphere(test_engine *e, double softening, const char *name, double value) {
  test_engine_open(e);
  add_sphere(e, N);
  e->options.dt = 1e-3;
  hk_plugin_spec *spec = add_force(e, "tree", softening);
  if (name) test_number(e, spec, name, value);
  test_run(e);
  return spec;
}

static void direct(double softening, double *F, double *energy) {
  test_engine e;
  test_engine_open(&e);
  add_sphere(&e, N);
  e.options.dt = 1e-3;
  hk_plugin_spec *spec = add_force(&e, "direct", softening);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  *energy = force->plugin->force->energy(force->self, &view);
  test_engine_close(&e);
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

typedef struct errors {
  double rms, p99, largest, energy;
} errors;

static errors errors_of(double softening, const char *name, double value, const double *exact, double energy) {
  static double F[3 * N], off[N];
  test_engine e;
  errors found = {0};
  hk_plugin_spec *spec = open_sphere(&e, softening, name, value);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  for (size_t i = 0; i < N; i++) {
    double d2 = 0, f2 = 0;
    for (size_t c = 0; c < 3; c++) {
      d2 += (F[3 * i + c] - exact[3 * i + c]) * (F[3 * i + c] - exact[3 * i + c]);
      f2 += exact[3 * i + c] * exact[3 * i + c];
    }
    off[i] = sqrt(d2 / f2);
    found.rms += d2 / f2 / N;
  }
  qsort(off, N, sizeof *off, by_size);
  found.rms = sqrt(found.rms);
  found.p99 = off[N * 99 / 100];
  found.largest = off[N - 1];
  found.energy = fabs(force->plugin->force->energy(force->self, &view) / energy - 1);
  test_engine_close(&e);
  return found;
}

/* alpha bounds the first order left out of one cell, and errors of cells partly cancel: the root mean square is a small
 * part of it, and the tail follows. The errors grow with alpha, less than in proportion, since the nearest cells are
 * bounded by R < r. */
static void errors_follow_alpha(void **state) {
  (void)state;
  static double exact[3 * N];
  double energy;
  direct(0.01, exact, &energy);
  errors strict = errors_of(0.01, "alpha", 1e-4, exact, energy), usual = errors_of(0.01, "alpha", 5e-3, exact, energy);
  assert_true(strict.rms > 1e-7 && strict.rms < 1e-4 && strict.largest < 1e-3);
  assert_true(usual.rms > 3 * strict.rms && usual.rms < 1e-3 && usual.p99 < 5e-3 && usual.largest < 2e-2);
  assert_true(usual.energy < 1e-4);
}

static void errors_follow_the_opening_angle(void **state) {
  (void)state;
  static double exact[3 * N];
  double energy;
  direct(0, exact, &energy);
  errors narrow = errors_of(0, "opening_angle", 0.3, exact, energy),
         wide = errors_of(0, "opening_angle", 0.7, exact, energy);
  assert_true(narrow.rms > 0 && narrow.rms < 5e-5);
  assert_true(wide.rms > 5 * narrow.rms && wide.rms < 1e-3); /* (7/3)^3 = 13 */
}

/* Rounding of sums of 4000 terms in another order. */
static void without_tolerance_it_is_the_sum_over_all_pairs(void **state) {
  (void)state;
  static double exact[3 * N];
  for (int soft = 0; soft < 2; soft++) {
    double energy;
    direct(soft ? 0.01 : 0, exact, &energy);
    assert_true(errors_of(soft ? 0.01 : 0, "alpha", 0, exact, energy).largest < 1e-13);
    assert_true(errors_of(soft ? 0.01 : 0, "opening_angle", 0, exact, energy).largest < 1e-13);
    assert_true(errors_of(soft ? 0.01 : 0, "alpha", 0, exact, energy).energy < 1e-13);
  }
}

static void threads_and_repetition_give_the_same_bits(void **state) {
  (void)state;
  static double F[3 * N], first[3 * N], away[3 * N], moved[3 * N];
  double energies[2];
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    test_engine_open(&e);
    add_sphere(&e, N);
    e.scene->threads = threads;
    e.options.dt = 1e-3;
    hk_plugin_spec *spec = add_force(&e, "tree", 0.01);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force), other = view;
    force_evaluate(force, &view, F);
    if (threads == 1) memcpy(first, F, sizeof F);
    assert_memory_equal(first, F, sizeof F);
    energies[threads > 1] = force->plugin->force->energy(force->self, &view);
    assert_true(threads == 1 || energies[0] == energies[1]);
    for (size_t k = 0; k < 3 * N; k++) moved[k] = view.x[k] + 0.1 * sin((double)k);
    other.x = moved;
    force_evaluate(force, &other, away);
    assert_memory_not_equal(first, away, sizeof F);
    force_evaluate(force, &view, F); /* where it has been before */
    assert_memory_equal(first, F, sizeof F);
    test_engine_close(&e);
  }
}

/* The bound is above the stiffness that each body has for the others at rest, and not much: half of it is the factor 2
 * of pairs. */
static void its_stiffness_is_that_of_all_pairs_or_a_little_more(void **state) {
  (void)state;
  static double bound[2][N][6];
  for (int tree = 0; tree < 2; tree++) {
    test_engine e;
    test_engine_open(&e);
    add_sphere(&e, N);
    e.options.dt = 1e-3;
    hk_plugin_spec *spec = add_force(&e, tree ? "tree" : "direct", 0.01);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    hk_force_of(force->plugin)->bounds.stiffness_bound(force->self, &view, HK_STIFFNESS_WHOLE, bound[tree]);
    test_engine_close(&e);
  }
  for (size_t i = 0; i < N; i++) {
    double ratio = bound[1][i][0] / bound[0][i][0];
    assert_true(ratio > 1 - 1e-12 && ratio < 2.4); /* (1 - 1/4)^-3 */
  }
}

/* Many bodies at a few places: with softening any number may be there, without, two are an error. */
static void bodies_at_one_place(void **state) {
  (void)state;
  enum { MANY = 700 };
  static double F[3 * MANY];
  for (int soft = 0; soft < 2; soft++) {
    test_engine e;
    test_engine_open(&e);
    for (int k = 0; k < MANY; k++) test_particle(&e, k < 600 ? 0.5 : k, k < 600 ? 0 : sin(k), 0, 1);
    e.options.dt = 1e-3;
    hk_plugin_spec *spec = add_force(&e, "tree", soft ? 0.1 : 0);
    if (!soft) {
      assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error) == HK_OK
                           ? hk_run_advance(e.run, 1e-3, &e.error)
                           : HK_FAILED,
                       HK_FAILED);
      assert_non_null(strstr(e.error.text, "are both at (0.5, 0, 0) m at t = 0 s"));
      test_engine_close(&e);
      continue;
    }
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    force_evaluate(force, &view, F);
    for (size_t k = 0; k < 3 * MANY; k++) assert_true(isfinite(F[k]) && (k < 3 || k >= 1800 || F[k] == F[k % 3]));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_follow_alpha),
      cmocka_unit_test(errors_follow_the_opening_angle),
      cmocka_unit_test(without_tolerance_it_is_the_sum_over_all_pairs),
      cmocka_unit_test(threads_and_repetition_give_the_same_bits),
      cmocka_unit_test(its_stiffness_is_that_of_all_pairs_or_a_little_more),
      cmocka_unit_test(bodies_at_one_place),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
