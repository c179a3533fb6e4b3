/* Gravitation in single precision, against the sum in doubles: errors of the rounding of floats wherever the bodies are
 * and however near each other, what it says of them, and everything that must not depend on how it is summed. */
#include "tests/support/command.h"
#include "tests/support/force_check.h"
#include "tests/support/nbody_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 3000 };

/* RMS of a body's error, relative to its acceleration. Terms are off by some 1e-7, sums by less. */
static const double single = 4e-7;

typedef struct bodies {
  double x[3 * N], m[N], softening;
} bodies;

static hk_plugin_spec *open_bodies(test_engine *e, const bodies *b, const char *precision, int threads) {
  uint32_t id;
  test_engine_open(e);
  assert_int_equal(hk_scene_add_particles(e->scene, N, b->x, NULL, b->m, 0, 0, &id, &e->error), HK_OK);
  e->scene->threads = threads;
  e->options.dt = 1e-3;
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, spec, "G", 1);
  test_number(e, spec, "softening", b->softening);
  test_text(e, spec, "method", "direct");
  test_text(e, spec, "precision", precision);
  return spec;
}

/* *said: the errors that the force reports of itself, where it reports any. */
static void forces(const bodies *b, const char *precision, int threads, double *F, hk_force_errors *said) {
  test_engine e;
  hk_plugin_spec *spec = open_bodies(&e, b, precision, threads);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force_evaluate(force, &view, F);
  bool approximate = force->plugin->force->errors(force->self, &view, said);
  assert_true(approximate == (strcmp(precision, "single") == 0));
  test_engine_close(&e);
}

/* A Plummer sphere of radius `size` at (away, 0, 0). */
static bodies *sphere(double size, double away) {
  bodies *b = calloc(1, sizeof *b);
  uint64_t seed[4];
  hk_random_seed(seed, 9);
  for (size_t i = 0; i < N; i++) {
    double r = size / sqrt(pow(hk_random_uniform(seed) * 0.995, -2.0 / 3) - 1), z = 2 * hk_random_uniform(seed) - 1;
    double angle = 6.283185307179586 * hk_random_uniform(seed), s = sqrt(1 - z * z);
    b->x[3 * i] = away + r * s * cos(angle), b->x[3 * i + 1] = r * s * sin(angle), b->x[3 * i + 2] = r * z;
    b->m[i] = 1 / (double)N;
  }
  return b;
}

typedef struct errors {
  double rms, largest;
} errors;

/* Relative to doubles; and that what it says of itself is of that size. */
static errors errors_of(const bodies *b, const char *name) {
  static double F[3 * N], exact[3 * N];
  hk_force_errors said = {0};
  errors found = {0};
  forces(b, "double", 1, exact, &said);
  forces(b, "single", 2, F, &said);
  for (size_t i = 0; i < N; i++) {
    double d2 = 0, f2 = 0;
    for (size_t c = 0; c < 3; c++) {
      d2 += (F[3 * i + c] - exact[3 * i + c]) * (F[3 * i + c] - exact[3 * i + c]);
      f2 += exact[3 * i + c] * exact[3 * i + c];
    }
    found.rms += d2 / f2 / N;
    found.largest = fmax(found.largest, sqrt(d2 / f2));
  }
  found.rms = sqrt(found.rms);
  print_message("%s: off by %.2g RMS, %.2g at most; it says %.2g of %zu\n", name, found.rms, found.largest, said.rms,
                said.particles);
  assert_true(said.particles >= 128 && said.largest <= found.largest * (1 + 1e-6));
  assert_true(said.rms >= found.rms / 3 && said.rms <= 3 * found.rms);
  return found;
}

static void errors_are_those_of_floats(void **state) {
  (void)state;
  for (int soft = 0; soft < 2; soft++) {
    bodies *b = sphere(1, 0);
    b->softening = soft ? 0.01 : 0;
    errors e = errors_of(b, soft ? "sphere, softening 0.01 m" : "sphere");
    assert_true(e.rms > 0 && e.rms < single && e.largest < 20 * single);
    free(b);
  }
}

/* Floats of the places themselves would be 0.06 and 64 m apart. And floats it is: relative to the origin, 1e9 m away,
 * two floats would not do, and all would be summed in doubles. */
static void it_does_not_matter_where_the_origin_is(void **state) {
  (void)state;
  const double away[] = {1e6, 1e9};
  for (size_t q = 0; q < 2; q++) {
    bodies *b = sphere(10, away[q]);
    errors e = errors_of(b, "sphere far away");
    assert_true(e.rms > single / 40 && e.rms < single);
    free(b);
  }
}

/* Clusters of ten bodies, spread over 1e6 m: those 1 m across are held by two floats, the smaller ones are summed in
 * doubles. */
static void clusters_far_from_each_other_keep_their_digits(void **state) {
  (void)state;
  const double sizes[] = {1, 1e-3, 1e-6};
  for (size_t q = 0; q < 3; q++) {
    bodies *b = sphere(1e6, 1e6);
    uint64_t seed[4];
    hk_random_seed(seed, 4);
    for (size_t i = 300; i < N; i++)
      for (size_t c = 0; c < 3; c++) b->x[3 * i + c] = b->x[3 * (i % 300) + c] + sizes[q] * hk_random_uniform(seed);
    assert_true(errors_of(b, "clusters").rms < single);
    free(b);
  }
}

/* Pairs down to a rounding of doubles, in blocks of their own and of others. */
static void bodies_very_near_each_other_keep_their_digits(void **state) {
  (void)state;
  const size_t other[] = {1, 40, 2000};
  for (size_t q = 0; q < 3; q++)
    for (double near = 1e-3; near > 1e-14; near /= 50) {
      bodies *b = sphere(1, 0);
      memcpy(b->x + 3 * other[q], b->x, 3 * sizeof *b->x);
      b->x[3 * other[q]] += near;
      assert_true(errors_of(b, "a close pair").largest < 30 * single);
      free(b);
    }
}

/* Units and ratios of masses that floats do not hold. */
static void any_units_will_do(void **state) {
  (void)state;
  const double lengths[] = {1e-100, 1e-30, 3e19, 1e140}, masses[] = {1e-200, 1e-27, 2e30, 1e200};
  for (size_t q = 0; q < 4; q++)
    for (int dust = 0; dust < 2; dust++) {
      bodies *b = sphere(1, 0);
      static double F[3 * N], exact[3 * N];
      hk_force_errors said;
      for (size_t k = 0; k < 3 * N; k++) b->x[k] *= lengths[q];
      for (size_t k = 0; k < N; k++) b->m[k] *= masses[q] * (dust && k % 2 ? 1e-40 : 1);
      forces(b, "double", 1, exact, &said);
      forces(b, "single", 1, F, &said);
      for (size_t k = 0; k < 3 * N; k++) {
        const double *a = exact + k / 3 * 3;
        assert_true(fabs(F[k] - exact[k]) <= 30 * single * hypot(hypot(a[0], a[1]), a[2]) && isfinite(F[k]));
        if (dust) assert_true(F[k] == exact[k]);
      }
      assert_true(said.rms < single);
      free(b);
    }
}

/* Both forces of a pair are rounded apart, so they cancel to their errors, whose sum over N bodies grows as the root of
 * N: 1/55 of that of all going one way. */
static void momentum_is_kept_to_the_rounding_of_floats(void **state) {
  (void)state;
  static double F[3 * N];
  bodies *b = sphere(1, 0);
  hk_force_errors said;
  double sum[3] = {0}, size = 0;
  forces(b, "single", 1, F, &said);
  for (size_t k = 0; k < 3 * N; k++) sum[k % 3] += F[k], size += fabs(F[k]);
  print_message("momentum: %.2g, %.2g, %.2g of the forces\n", sum[0] / size, sum[1] / size, sum[2] / size);
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < single / 55 * size);
  free(b);
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  static double F[3 * N], first[3 * N];
  bodies *b = sphere(1, 0);
  hk_force_errors said, one = {0};
  b->x[3 * 2000] = b->x[0] + 1e-12, b->x[3 * 2000 + 1] = b->x[1], b->x[3 * 2000 + 2] = b->x[2]; /* one in doubles */
  for (int threads = 1; threads <= 3; threads++) {
    forces(b, "single", threads, F, threads == 1 ? &one : &said);
    if (threads == 1) memcpy(first, F, sizeof F);
    assert_memory_equal(first, F, sizeof F);
    assert_true(threads == 1 || (said.rms == one.rms && said.power == one.power));
  }
  free(b);
}

/* For the comparison with finer steps it is double, to the bit. */
static void sharpened_it_is_double(void **state) {
  (void)state;
  static double F[3 * N], exact[3 * N];
  bodies *b = sphere(1, 0);
  hk_force_errors said;
  test_engine e;
  forces(b, "double", 1, exact, &said);
  hk_plugin_spec *spec = open_bodies(&e, b, "single", 1);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  force->plugin->force->sharpen(force->self, 0.5);
  force_evaluate(force, &view, F);
  assert_memory_equal(F, exact, sizeof F);
  assert_false(force->plugin->force->errors(force->self, &view, &said));
  test_engine_close(&e);
  free(b);
}

/* Every third body is a source, with the others or also with its like; numbers below, at and above blocks. */
static void sources_are_those_of_double(void **state) {
  (void)state;
  const size_t counts[] = {1, 2, 31, 32, 33, 200};
  static double F[2][3 * 200];
  for (int variant = 0; variant < 12; variant++)
    for (size_t q = 0; q < 6; q++) {
      bodies *b = sphere(1, 0);
      size_t n = counts[q];
      for (int p = 0; p < 2; p++) {
        test_engine e;
        double ids[100], largest = 0;
        size_t count = 0;
        uint32_t id;
        test_engine_open(&e);
        assert_int_equal(hk_scene_add_particles(e.scene, n, b->x, NULL, b->m, 0, 0, &id, &e.error), HK_OK);
        e.options.dt = 1e-3;
        hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "nbody");
        for (uint32_t k = 1; k <= n && count < 100; k += 3) ids[count++] = k;
        test_number(&e, spec, "G", 1);
        test_number(&e, spec, "softening", variant & 1 ? 0.1 : 0);
        test_text(&e, spec, "method", "direct");
        test_text(&e, spec, "precision", p ? "single" : "double");
        if (variant / 2 % 3) test_list(&e, spec, "sources", ids, count);
        if (variant / 2 % 3) test_boolean(&e, spec, "among", variant / 2 % 3 == 1);
        test_run(&e);
        hk_instance *force = test_instance(&e, spec);
        hk_view view = force_view(&e, force);
        force_evaluate(force, &view, F[p]);
        for (size_t k = 0; k < 3 * n; k++) largest = fmax(largest, fabs(F[p][k]));
        for (size_t k = 0; k < 3 * n && p; k++) assert_true(fabs(F[1][k] - F[0][k]) <= single * largest);
        test_engine_close(&e);
      }
      free(b);
    }
}

static void says(const bodies *b, const char *method, const char *wanted) {
  test_engine e;
  hk_plugin_spec *spec = open_bodies(&e, b, "single", 2);
  test_text(&e, spec, "method", method);
  hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
  if (status == HK_OK) status = hk_run_advance(e.run, 1e-3, &e.error);
  assert_int_not_equal(status, HK_OK);
  if (!strstr(e.error.text, wanted)) fail_msg("\"%s\" is not in: %s", wanted, e.error.text);
  test_engine_close(&e);
}

static void bodies_at_one_place_are_an_error_that_names_them(void **state) {
  (void)state;
  const size_t other[] = {1, 40, 2000};
  for (size_t q = 0; q < 3; q++) {
    char wanted[64];
    bodies *b = sphere(1, 0);
    memcpy(b->x + 3 * other[q], b->x, 3 * sizeof *b->x);
    snprintf(wanted, sizeof wanted, "particles 1 and %zu are both at", other[q] + 1);
    says(b, "direct", wanted);
    free(b);
  }
}

static void a_tree_is_not_for_it(void **state) {
  (void)state;
  bodies *b = sphere(1, 0);
  says(b, "tree", "set method = \"direct\"");
  says(b, "auto", "set method = \"direct\"");
  free(b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(errors_are_those_of_floats),
      cmocka_unit_test(it_does_not_matter_where_the_origin_is),
      cmocka_unit_test(clusters_far_from_each_other_keep_their_digits),
      cmocka_unit_test(bodies_very_near_each_other_keep_their_digits),
      cmocka_unit_test(any_units_will_do),
      cmocka_unit_test(momentum_is_kept_to_the_rounding_of_floats),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(sharpened_it_is_double),
      cmocka_unit_test(sources_are_those_of_double),
      cmocka_unit_test(bodies_at_one_place_are_an_error_that_names_them),
      cmocka_unit_test(a_tree_is_not_for_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
