/* Gravitation by the sum over all pairs: by hand, against a plain loop, its energy and its Jacobian; and what it says
 * of bodies at one place. The tree is in nbody_tree.c, long motions in nbody_motion.c. */
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_bodies(test_engine *e, size_t count, double softening) {
  uint64_t seed[4];
  hk_random_seed(seed, 3);
  test_engine_open(e);
  for (size_t k = 0; k < count; k++)
    test_particle(e, hk_random_uniform(seed), hk_random_uniform(seed), hk_random_uniform(seed),
                  0.5 + hk_random_uniform(seed));
  e->options.dt = 1e-3;
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, spec, "G", 1.5);
  test_number(e, spec, "softening", softening);
  return spec;
}

/* The sources are every third body. */
static void choose_sources(test_engine *e, hk_plugin_spec *spec, bool among) {
  double ids[64];
  size_t count = 0;
  for (uint32_t id = 1; id <= e->scene->particles.n && count < 64; id += 3) ids[count++] = id;
  test_list(e, spec, "sources", ids, count);
  test_boolean(e, spec, "among", among);
}

/* 3 and 5 kg, 5 m apart: 1.5 * 15/25 = 0.9 N along (3, 4, 0)/5. */
static void a_pair_by_hand(void **state) {
  (void)state;
  test_engine e;
  double F[6], wanted[6] = {0.54, 0.72, 0, -0.54, -0.72, 0};
  hk_plugin_spec *spec = open_bodies(&e, 0, 0);
  test_particle(&e, 1, -1, 2, 3);
  test_particle(&e, 4, 3, 2, 5);
  test_run(&e);
  hk_instance *nbody = test_instance(&e, spec);
  hk_view view = force_view(&e, nbody);
  force_evaluate(nbody, &view, F);
  for (int c = 0; c < 6; c++) assert_true(fabs(F[c] - wanted[c]) < 1e-15);
  assert_true(fabs(nbody->plugin->force->energy(nbody->self, &view) + 4.5) < 1e-14); /* -1.5 * 15/5 */
  test_engine_close(&e);
}

static bool acts(size_t i, size_t j, int variant) {
  bool first = i % 3 == 0, second = j % 3 == 0;
  return i != j && (variant == 0 || (variant == 1 ? first || second : first != second));
}

/* All pairs; pairs with a source; pairs of a source and another one. For numbers of bodies below, at and above blocks
 * of vectors. Sums of 70 terms: 70 roundings at most. */
static void forces_and_energy_are_those_of_a_plain_loop(void **state) {
  (void)state;
  const size_t counts[] = {2, 3, 15, 16, 17, 33, 70};
  for (int variant = 0; variant < 6; variant++)
    for (size_t q = 0; q < sizeof counts / sizeof *counts; q++) {
      test_engine e;
      size_t n = counts[q];
      double F[3 * 70], E = 0, soft = variant & 1 ? 0.1 : 0;
      hk_plugin_spec *spec = open_bodies(&e, n, soft);
      if (variant >= 2) choose_sources(&e, spec, variant < 4);
      test_run(&e);
      hk_instance *nbody = test_instance(&e, spec);
      hk_view view = force_view(&e, nbody);
      force_evaluate(nbody, &view, F);
      for (size_t i = 0; i < n; i++) {
        double wanted[3] = {0}, size = 0;
        for (size_t j = 0; j < n; j++) {
          const double *a = view.x + 3 * i, *b = view.x + 3 * j, *m = view.model->mass;
          double s2 = soft * soft, f;
          if (!acts(i, j, variant / 2)) continue;
          for (int c = 0; c < 3; c++) s2 += (b[c] - a[c]) * (b[c] - a[c]);
          f = 1.5 * m[i] * m[j] / s2;
          for (int c = 0; c < 3; c++) wanted[c] += f * (b[c] - a[c]) / sqrt(s2);
          size += f;
          E -= f * sqrt(s2) / 2;
        }
        for (int c = 0; c < 3; c++) assert_true(fabs(F[3 * i + c] - wanted[c]) <= 2e-14 * size);
      }
      assert_true(fabs(nbody->plugin->force->energy(nbody->self, &view) - E) <= 2e-14 * fabs(E));
      test_engine_close(&e);
    }
}

static void force_energy_and_jacobian_belong_together(void **state) {
  (void)state;
  for (int variant = 0; variant < 6; variant++) {
    test_engine e;
    hk_plugin_spec *spec = open_bodies(&e, 7, variant & 1 ? 0.3 : 0);
    if (variant >= 2) choose_sources(&e, spec, variant < 4);
    test_run(&e);
    hk_instance *nbody = test_instance(&e, spec);
    hk_view view = force_view(&e, nbody);
    double gradient = force_gradient_error(nbody, &view), stiffness = force_stiffness_error(nbody, &view);
    if (!(gradient < FORCE_DIFFERENCES && stiffness < FORCE_DIFFERENCES))
      fail_msg("variant %d: gradient %g, Jacobian %g", variant, gradient, stiffness);
    test_engine_close(&e);
  }
}

/* The forces of a pair are summed apart, so they cancel to rounding: the roundings of 500 sums of 500 terms. */
static void momentum_is_kept_to_rounding(void **state) {
  (void)state;
  enum { N = 500 };
  static double F[3 * N];
  for (int soft = 0; soft < 2; soft++) {
    test_engine e;
    double sum[3] = {0}, size = 0;
    hk_plugin_spec *spec = open_bodies(&e, N, soft ? 0.05 : 0);
    test_run(&e);
    hk_instance *nbody = test_instance(&e, spec);
    hk_view view = force_view(&e, nbody);
    force_evaluate(nbody, &view, F);
    for (size_t k = 0; k < 3 * N; k++) sum[k % 3] += F[k], size += fabs(F[k]);
    for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-15 * size);
    test_engine_close(&e);
  }
}

/* Places and masses whose squares are beyond the range of floats: kiloparsecs and atoms in metres, bodies nearer to
 * each other than a float's square can be. */
static void any_units_will_do(void **state) {
  (void)state;
  const double units[] = {1e-100, 1e-30, 1, 3e19, 1e140};
  for (size_t u = 0; u < sizeof units / sizeof *units; u++) {
    test_engine e;
    double F[9], near = 1e-25 * units[u];
    hk_plugin_spec *spec = open_bodies(&e, 0, 0);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, near, 0, 0, 2);
    test_particle(&e, 0, units[u], 0, 3);
    test_run(&e);
    hk_instance *nbody = test_instance(&e, spec);
    hk_view view = force_view(&e, nbody);
    force_evaluate(nbody, &view, F);
    assert_true(fabs(F[0] / (3 / near / near) - 1) < 2e-15); /* some roundings */
    assert_true(fabs(F[7] / (-13.5 / units[u] / units[u]) - 1) < 2e-15);
    test_engine_close(&e);
  }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  enum { N = 3000 };
  static double F[3 * N], first[3 * N], energies[2];
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    hk_plugin_spec *spec = open_bodies(&e, N, 0.01);
    e.scene->threads = threads;
    test_run(&e);
    hk_instance *nbody = test_instance(&e, spec);
    hk_view view = force_view(&e, nbody);
    force_evaluate(nbody, &view, F);
    energies[threads > 1] = nbody->plugin->force->energy(nbody->self, &view);
    if (threads == 1) memcpy(first, F, sizeof F);
    assert_memory_equal(first, F, sizeof F);
    assert_true(threads == 1 || energies[0] == energies[1]);
    test_engine_close(&e);
  }
}

static void says(const char *text, const char *wanted) {
  if (!strstr(text, wanted)) fail_msg("\"%s\" is not in: %s", wanted, text);
}

static void run_script(test_result *r, const char *body, const char *options) {
  char path[] = "/tmp/hooke-nbody-XXXXXX.lua", arguments[256];
  int file = mkstemps(path, 4);
  FILE *f = fdopen(file, "w");
  assert_non_null(f);
  fputs(body, f);
  fclose(f);
  snprintf(arguments, sizeof arguments, "run %s --no-output --quiet %s", path, options);
  test_hooke(r, NULL, arguments);
  remove(path);
}

/* Two of a row of bodies fall onto each other: at once, and at t = 0.5 s, where pins bring them together. */
static void bodies_at_one_place_are_an_error_that_names_them(void **state) {
  (void)state;
  test_result r;
  run_script(&r,
             "local s = hooke.scene { duration = 1, dt = 1/60, integrator = 'leapfrog' }\n"
             "s:particles { positions = { {0,0,0}, {1,0,0}, {0,2,0}, {1,0,0} }, mass = 1 }\n"
             "s:force('nbody', { G = 1 })\n"
             "return s\n",
             "");
  assert_true(r.code != 0);
  says(r.err, ".lua:3");
  says(r.err, "particles 2 and 4 are both at (1, 0, 0) m at t = 0 s");
  says(r.err, "softening");
  run_script(&r,
             "local s = hooke.scene { duration = 1, fps = 4, dt = 1/4, integrator = 'leapfrog' }\n"
             "s:particles { positions = { {0,0,0}, {1,0,0}, {0,2,0} }, mass = 1 }\n"
             "s:pin({ 1 }, { path = function(t) return { 2 * t, 0, 0 } end })\n"
             "s:pin({ 2 })\n"
             "s:force('nbody', { G = 1 })\n"
             "return s\n",
             "");
  assert_true(r.code != 0);
  says(r.err, ".lua:5");
  says(r.err, "particles 1 and 2 are both at (1, 0, 0) m at t = 0.5 s");
}

static void with_softening_bodies_may_be_at_one_place(void **state) {
  (void)state;
  test_engine e;
  double F[9];
  hk_plugin_spec *spec = open_bodies(&e, 0, 0.5);
  for (int k = 0; k < 3; k++) test_particle(&e, 1, 2, 3, 1);
  test_run(&e);
  hk_instance *nbody = test_instance(&e, spec);
  hk_view view = force_view(&e, nbody);
  force_evaluate(nbody, &view, F);
  for (int c = 0; c < 9; c++) assert_true(F[c] == 0);
  assert_true(fabs(nbody->plugin->force->energy(nbody->self, &view) + 3 * 1.5 / 0.5) < 1e-14);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pair_by_hand),
      cmocka_unit_test(forces_and_energy_are_those_of_a_plain_loop),
      cmocka_unit_test(force_energy_and_jacobian_belong_together),
      cmocka_unit_test(momentum_is_kept_to_rounding),
      cmocka_unit_test(any_units_will_do),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(bodies_at_one_place_are_an_error_that_names_them),
      cmocka_unit_test(with_softening_bodies_may_be_at_one_place),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
