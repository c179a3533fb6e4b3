/* Periodic boxes against what is known: the lattice sum of a crystal, a gas that does not know where the faces are, its
 * momentum and energy, contacts of grains across a face. */
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void near(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance)) fail_msg("%.17g instead of %.17g", found, wanted);
}

static void set_box(test_engine *e, double length, const char *axes) {
  const double low[3] = {0}, high[3] = {length, length, length};
  assert_int_equal(hk_scene_set_box(e->scene, low, high, axes, &e->error), HK_OK);
}

/* ---- a crystal ---- */

/* Shells of the face-centred cubic lattice: at sqrt(n) nearest distances there are so many (OEIS A004015). */
static const double shell[] = {0, 12, 6, 24, 12, 24, 8, 48, 6, 36, 24, 24, 24, 72, 0, 48, 12, 48, 30, 72, 24};
enum { SHELLS = sizeof shell / sizeof *shell };

/* U of the plugin's head, epsilon = sigma = 1. */
static double potential(double cutoff, double r) {
  double at = 4 * (pow(r, -12) - pow(r, -6)), end = 4 * (pow(cutoff, -12) - pow(cutoff, -6));
  double slope = -24 / cutoff * (2 * pow(cutoff, -12) - pow(cutoff, -6));
  return r < cutoff ? at - end - (r - cutoff) * slope : 0;
}

/* 4 M^3 particles. The nearest distance of least energy is 1.0902, where whole sums are A12 = 12.13188 and A6
 * = 14.45392 (Kittel, Introduction to Solid State Physics, chapter 3): shells here are checked by the first, which
 * converges. */
static void a_crystal_has_the_energy_of_its_lattice_sum(void **state) {
  (void)state;
  enum { M = 4 };
  static const double corner[4][3] = {{0, 0, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}, {0.5, 0.5, 0}};
  double d = 1.0902, a = d * sqrt(2), A12 = 0;
  for (int n = 1; n < SHELLS; n++) A12 += shell[n] * pow(n, -6);
  near(A12, 12.13188, 1e-5);
  for (double cutoff = 1.2; cutoff < 3.1; cutoff += 0.6) {
    test_engine e;
    double F[3 * 4 * M * M * M], one = 0;
    test_engine_open(&e);
    for (int k = 0; k < 4 * M * M * M; k++) {
      const double *q = corner[k % 4];
      test_particle(&e, a * (k / 4 % M + q[0]), a * (k / 4 / M % M + q[1]), a * (k / 4 / M / M + q[2]), 1);
    }
    set_box(&e, a * M, "xyz");
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "lennard_jones");
    test_number(&e, spec, "cutoff", cutoff);
    e.options.dt = 1e-3;
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    for (int n = 1; n < SHELLS; n++) one += shell[n] / 2 * potential(cutoff, d * sqrt(n));
    double U = force->plugin->force->energy(force->self, &view);
    near(U / (double)view.n, one, 1e-12); /* rounding of some hundred terms */
    force_evaluate(force, &view, F);
    for (size_t c = 0; c < 3 * view.n; c++) assert_true(fabs(F[c]) < 1e-11); /* it is in equilibrium by its symmetry */
    test_engine_close(&e);
  }
}

/* ---- a gas ---- */

enum { SIDE = 5, GAS = SIDE * SIDE * SIDE };

static const double length = 7; /* m */

/* Each particle shifted by `shift` along all axes and, with `images`, into some image of its own. */
static hk_plugin_spec *open_gas(test_engine *e, const char *method, double shift, bool images, int threads) {
  uint64_t seed[4];
  double mean[3] = {0};
  hk_random_seed(seed, 9);
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, method);
  for (int i = 0; i < GAS; i++) {
    double x[3];
    for (int c = 0, at = i; c < 3; c++, at /= SIDE) {
      x[c] = length / SIDE * (at % SIDE + 0.2 * hk_random_uniform(seed)) + shift;
      if (images) x[c] -= length * floor(x[c] / length) + length * ((i >> c) % 3 - 1);
    }
    uint32_t id = test_particle(e, x[0], x[1], x[2], 1);
    for (int c = 0; c < 3; c++) {
      e->scene->particles.velocity[3 * (id - 1) + (uint32_t)c] = 4 * (hk_random_uniform(seed) - 0.5);
      mean[c] += e->scene->particles.velocity[3 * (id - 1) + (uint32_t)c] / GAS;
    }
  }
  for (int k = 0; k < 3 * GAS; k++) e->scene->particles.velocity[k] -= mean[k % 3];
  set_box(e, length, "xyz");
  e->options.dt = 2e-3;
  e->options.threads = threads;
  return test_plugin(e, HK_FORCE, "lennard_jones");
}

/* How far each has gone, and how many have left the box. */
static int move(test_engine *e, double to, double gone[3 * GAS]) {
  double start[3 * GAS];
  int outside = 0;
  test_run(e);
  memcpy(start, hk_run_view(e->run)->x, sizeof start);
  test_advance(e, to);
  const double *x = hk_run_view(e->run)->x;
  for (int k = 0; k < 3 * GAS; k++) {
    gone[k] = x[k] - start[k];
    outside += x[k] < 0 || x[k] > length;
  }
  return outside;
}

/* To rounding, which grows by collisions: 1e-15 m to 1e-12 m in the time. With a box shorter by a thousandth 1e-3 m. */
static void a_gas_does_not_know_where_the_faces_are(void **state) {
  (void)state;
  static double here[3 * GAS], there[3 * GAS];
  for (int images = 0; images < 2; images++) {
    test_engine e;
    open_gas(&e, "leapfrog", 0, false, 1);
    assert_true(move(&e, 0.6, here) > 20);
    test_engine_close(&e);
    open_gas(&e, "leapfrog", length / 2, images, 1);
    move(&e, 0.6, there);
    test_engine_close(&e);
    double most = 0;
    for (int k = 0; k < 3 * GAS; k++) most = fmax(most, fabs(here[k] - there[k]));
    if (!(most < 1e-11)) fail_msg("ways differ by %g m", most);
  }
}

static void threads_leave_no_trace(void **state) {
  (void)state;
  static double one[3 * GAS], other[3 * GAS];
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    open_gas(&e, "leapfrog", 1, false, threads);
    move(&e, 0.3, threads == 1 ? one : other);
    if (threads > 1) assert_memory_equal(one, other, sizeof one);
    test_engine_close(&e);
  }
}

/* Rows are those of images found for positions of long ago, and particles have crossed faces since. */
static void a_resumed_run_goes_on_bit_by_bit(void **state) {
  (void)state;
  static double X[6 * GAS];
  test_engine e;
  char path[512];
  snprintf(path, sizeof path, "%s/gas.checkpoint", test_folder());
  open_gas(&e, "leapfrog", 2, false, 1);
  test_run(&e);
  test_advance(&e, 0.31);
  assert_int_equal(hk_run_save(e.run, path, &e.error), HK_OK);
  test_advance(&e, 0.6);
  memcpy(X, e.run->state.X, sizeof X);
  test_engine_close(&e);
  open_gas(&e, "leapfrog", 2, false, 2);
  e.scene->start_file = strdup(path);
  test_run(&e);
  test_advance(&e, 0.6);
  assert_memory_equal(X, e.run->state.X, sizeof X);
  test_engine_close(&e);
}

/* Rounding of momenta of some hundred kg m/s; leapfrog's energy error is of order 2 in 2e-3 s, of 1e-5 parts. */
static void momentum_and_energy_are_kept(void **state) {
  (void)state;
  test_engine e;
  double gone[3 * GAS], momentum[3] = {0};
  hk_summary summary;
  open_gas(&e, "leapfrog", 0, false, 1);
  move(&e, 1, gone);
  const double *v = hk_run_view(e.run)->v;
  for (int k = 0; k < 3 * GAS; k++) momentum[k % 3] += v[k];
  for (int c = 0; c < 3; c++) assert_true(fabs(momentum[c]) < 1e-12);
  hk_run_summary(e.run, &summary);
  assert_true(fabs(summary.energy_drift) < 1e-3);
  test_engine_close(&e);
}

/* The energy is some hundred times that of a pair, and the forces are small: its rounding is 1e-13 in 6e-6 m. */
static void force_energy_and_jacobian_belong_together(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_gas(&e, "leapfrog", 3, true, 1);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  double gradient = force_gradient_error(force, &view), stiffness = force_stiffness_error(force, &view);
  if (!(gradient < 1e-7 && stiffness < FORCE_DIFFERENCES)) fail_msg("gradient %g, Jacobian %g", gradient, stiffness);
  test_engine_close(&e);
}

/* ---- grains ---- */

/* Two spheres meet off centre, with friction, at `middle`: inside, across a face, or each in another image. */
static void meet(double middle, double image, double gone[6]) {
  test_engine e;
  test_engine_open(&e);
  for (int k = 0; k < 2; k++) {
    test_particle(&e, middle + (k ? 0.6 + image : -0.6), 0.2 * k, 0.1, 1 + k);
    e.scene->particles.velocity[3 * k] = k ? -1 : 1;
  }
  const double low[3] = {-3, -4, -5}, high[3] = {3, 4, 5};
  assert_int_equal(hk_scene_set_box(e.scene, low, high, "xyz", &e.error), HK_OK);
  hk_plugin_spec *grains = test_plugin(&e, HK_FORCE, "soft_spheres");
  test_number(&e, grains, "radius", 0.5);
  test_number(&e, grains, "stiffness", 500);
  e.options.dt = 1e-3;
  test_run(&e);
  double start[6];
  memcpy(start, hk_run_view(e.run)->x, sizeof start);
  test_advance(&e, 1);
  for (int c = 0; c < 6; c++) gone[c] = hk_run_view(e.run)->x[c] - start[c];
  test_engine_close(&e);
}

static void grains_touch_across_a_face_as_anywhere(void **state) {
  (void)state;
  double inside[6], across[6], apart[6];
  meet(0, 0, inside);
  meet(3, 0, across);
  meet(3, -12, apart);
  assert_true(inside[0] < 0.5 && inside[4] > 0.01); /* it is thrown back, and aside */
  for (int c = 0; c < 6; c++) {
    near(inside[c], across[c], 1e-12);
    near(inside[c], apart[c], 1e-12);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_crystal_has_the_energy_of_its_lattice_sum),
      cmocka_unit_test(a_gas_does_not_know_where_the_faces_are),
      cmocka_unit_test(threads_leave_no_trace),
      cmocka_unit_test(a_resumed_run_goes_on_bit_by_bit),
      cmocka_unit_test(momentum_and_energy_are_kept),
      cmocka_unit_test(force_energy_and_jacobian_belong_together),
      cmocka_unit_test(grains_touch_across_a_face_as_anywhere),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
