/* Bounds of frequencies and damping rates against the exact eigenvalues: never below, and above by at most 6 % of the
 * frequency (12 % of its square is where the iteration stops; for damping rates, at 12 % and 0.03 w_max), for lattices,
 * strings and single oscillators with every kind of contrast. */
#include "core/engine/contract/contract.h"
#include "core/numerics/stability/stability.h"
#include "tests/support/network.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* Accelerations are differenced with a relative error below 1e-8, which the bounds are raised by. */
static const double below = 1e-9, above_w = 1.06, above_g = 1.125;

static hk_spectrum bounds(spring_network *w, bool covered) {
  hk_spectrum s;
  hk_error error = {0};
  w->covered = covered;
  assert_int_equal(hk_spectrum_estimate(&w->system, &s, &error), HK_OK);
  return s;
}

static void assert_between(const char *what, double value, double low, double high) {
  print_message("%-44s %.6f (%.4f .. %.4f)\n", what, value, low, high);
  assert_true(value >= low);
  assert_true(value <= high);
}

static void assert_bounds(const char *what, spring_network *w) {
  double exact_w = sqrt(network_largest_stiffness(w)), exact_g = network_largest_damping(w);
  for (int covered = 0; covered < 2; covered++) {
    hk_spectrum s = bounds(w, covered);
    assert_between(what, s.w_max / exact_w, 1 - below, above_w);
    assert_true(s.w_reached <= exact_w * (1 + 1e-8) && s.rigorous && s.covered == (bool)covered);
    if (exact_g > 0) assert_between("  damping", s.g_max / exact_g, 1 - below, above_g + 0.03 * s.w_max / exact_g);
  }
}

/* An n x n grid of unit mass in the plane turned by 0.3, its rows' springs `contrast` times as stiff as the columns',
 * every third particle `ratio` times as heavy; corners of the first row fixed. */
static spring_network *lattice(size_t n, double contrast, double ratio, double damping, bool diagonals) {
  spring_network *w = network_create(n * n, 4 * n * n, false);
  for (size_t i = 0; i < n * n; i++) {
    double x = 0.03 * (double)(i % n), y = 0.03 * (double)(i / n);
    network_place(w, i, cos(0.3) * x - sin(0.3) * y, sin(0.3) * x + cos(0.3) * y, 0.01 * (double)(i % 2));
    network_mass(w, i, i % 3 == 0 ? 0.001 * ratio : 0.001);
  }
  network_fix(w, 0);
  network_fix(w, n - 1);
  for (size_t i = 0; i < n * n; i++) {
    bool right = i % n + 1 < n, up = i + n < n * n;
    if (right) network_join(w, i, i + 1, 1000, 1000 * damping);
    if (up) network_join(w, i, i + n, 1000 / contrast, 1000 / contrast * damping);
    if (diagonals && right && up) network_join(w, i, i + n + 1, 300, 300 * damping);
    if (diagonals && right && up) network_join(w, i + 1, i + n, 300, 300 * damping);
  }
  return w;
}

static void bounds_hold_on_lattices(void **state) {
  (void)state;
  for (size_t n = 2; n <= 9; n += n == 2 ? 1 : 3) {
    spring_network *w[] = {lattice(n, 1, 1, 0, false), lattice(n, 1, 1, 1e-4, true), lattice(n, 1e4, 1, 0, false),
                           lattice(n, 1, 1e6, 1e-5, true), lattice(n, 1e4, 1e6, 1e-4, false)};
    static const char *name[] = {"square lattice", "lattice with diagonals, damped", "stiffness ratio 1e4",
                                 "mass ratio 1e6, damped", "stiffness ratio 1e4, mass ratio 1e6, damped"};
    for (size_t k = 0; k < 5; k++) {
      assert_bounds(name[k], w[k]);
      network_destroy(w[k]);
    }
  }
}

static void bounds_hold_under_tension_and_compression(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    spring_network *w = lattice(6, 1, 1, 0, true);
    for (size_t e = 0; e < w->edges; e++) w->rest[e] *= k == 0 ? 0.5 : 1.3;
    assert_bounds(k == 0 ? "springs twice their rest length" : "compressed springs", w);
    network_destroy(w);
  }
}

/* Particles on a line between two fixed ends, w = 2 sqrt(k/m) sin(N pi / (2 (N + 1))). */
static void bounds_hold_on_strings(void **state) {
  (void)state;
  static const size_t count[] = {1, 2, 3, 10, 100, 1000};
  for (size_t k = 0; k < sizeof count / sizeof *count; k++) {
    size_t n = count[k];
    double largest = 2 * sqrt(1e5 / 0.01) * sin(acos(-1) * (double)n / (2 * (double)n + 2));
    spring_network *w = network_create(n + 2, n + 1, false);
    for (size_t i = 0; i < n + 2; i++) {
      network_place(w, i, 0.6 * (double)i, 0.8 * (double)i, 5);
      network_mass(w, i, 0.01);
      if (i > 0) network_join(w, i - 1, i, 1e5, 1);
    }
    network_fix(w, 0);
    network_fix(w, n + 1);
    for (int covered = 0; covered < 2; covered++) {
      hk_spectrum s = bounds(w, covered);
      assert_between("string", s.w_max / largest, 1 - below, above_w);
      assert_between("  damping", s.g_max / (1e-5 * largest * largest), 1 - below, above_g + 0.03 / (1e-5 * largest));
      /* The truth about the least damping: c/k times w^2, to the error of the differences. */
      if (covered) assert_true(fabs(s.beta - 1e-5) < 1e-15 && s.w_undamped < 1e-6 * largest);
    }
    network_destroy(w);
  }
}

/* The cases whose spectrum is one number. A spring's other directions are zero but for the differences' rounding,
 * 1e-10, which the doubt of 1e-6 about the start vector (lanczos.c) enlarges to some 1e-5. */
static void single_oscillators_are_exact(void **state) {
  (void)state;
  spring_network *w = network_create(2, 1, false);
  network_place(w, 1, 0, 2, 0);
  network_mass(w, 1, 4);
  network_fix(w, 0);
  network_join(w, 0, 1, 100, 8);
  hk_spectrum s = bounds(w, false);
  assert_between("mass on a spring, w", s.w_max / 5, 1 - below, 1 + 1e-5);
  assert_between("mass on a spring, g", s.g_max / 2, 1 - below, 1 + 1e-5);
  network_destroy(w);
  w = network_create(1, 0, false);
  w->extra = 9;
  s = bounds(w, false);
  assert_between("particle in a well", s.w_max / 3, 1 - below, 1 + 2e-8);
  w->extra = -9; /* an unstable rest is no oscillation */
  assert_true(bounds(w, false).w_max == 0);
  w->extra = 0;
  s = bounds(w, true);
  assert_true(s.w_max == 0 && s.g_max == 0 && s.alpha == 0);
  network_fix(w, 0);
  s = bounds(w, true);
  assert_true(s.w_max == 0 && s.g_max == 0);
  network_destroy(w);
}

static void drag_is_the_least_damping(void **state) {
  (void)state;
  spring_network *w = lattice(5, 1, 10, 1e-5, true);
  w->drag = 0.25;
  hk_spectrum s = bounds(w, true);
  assert_between("drag", s.alpha / 0.25, 1 - 1e-6, 1); /* rounding of the springs' 1e6 m/s^2 in the differences */
  w->drag = 0;
  assert_true(bounds(w, true).alpha == 0);
  /* One spring from a pin, askew to the axes: it damps one direction, the others not at all. */
  network_destroy(w);
  w = network_create(2, 1, false);
  network_place(w, 1, 1, 1, 1);
  network_fix(w, 0);
  network_join(w, 0, 1, 100, 8);
  assert_true(bounds(w, true).alpha == 0);
  network_destroy(w);
}

static void slides_confine_the_modes(void **state) {
  (void)state;
  spring_network *w = network_create(2, 1, false);
  network_place(w, 1, 3, 0, 4);
  network_fix(w, 0);
  w->pin[1] = HK_PIN_LINE;
  network_join(w, 0, 1, 100, 2);
  w->drag = 1;
  hk_spectrum s = bounds(w, false);
  assert_between("slide, w", s.w_max / 8, 1 - below, 1 + 2e-8);       /* sqrt(100) 4/5 */
  assert_between("slide, g", s.g_max / 2.28, 1 - below, 1 + 2e-8);    /* 1 + 2 (4/5)^2 */
  assert_between("slide, alpha", s.alpha / 2.28, 1 - 1e-6, 1 + 2e-8); /* all of it */
  network_destroy(w);
}

static void false_elements_are_found_out(void **state) {
  (void)state;
  spring_network *w = lattice(4, 1, 1, 1e-4, true);
  w->extra = 1e8;
  double exact = sqrt(network_largest_stiffness(w));
  hk_spectrum s = bounds(w, true);
  assert_between("a force that no element knows", s.w_max / exact, 1 - below, above_w);
  assert_true(!s.covered && s.beta == 0);
  network_destroy(w);
}

/* v' = G v x e_z turns velocities at the rate G, whatever else acts; 1e-6: the differences' rounding of the springs'
 * accelerations. Without it nothing turns. */
static void gyration_is_told_from_damping(void **state) {
  (void)state;
  spring_network *w = lattice(5, 1, 10, 1e-5, true);
  double exact = network_largest_damping(w);
  assert_true(bounds(w, true).b_max == 0);
  w->gyration = 40;
  w->drag = 0.25;
  hk_spectrum s = bounds(w, true);
  assert_between("gyration", s.b_max / 40, 1 - below, 1 + 1e-6);
  assert_between("  damping", s.g_max / (exact + 0.25), 1 - below, above_g + 0.03 * s.w_max / exact);
  assert_between("  drag", s.alpha / 0.25, 1 - 1e-6, 1);
  assert_true(s.rigorous && s.beta > 0);
  network_destroy(w);
}

static void channels_have_their_rate(void **state) {
  (void)state;
  spring_network *w = network_create(4, 0, true);
  w->decay = 7;
  hk_spectrum s = bounds(w, true);
  assert_between("channel", s.channel_rate / 7, 1 - 1e-8, 1 + 1e-8); /* rounding 1e-16/1e-6 */
  network_destroy(w);
}

static void the_state_is_not_touched_and_failures_change_nothing(void **state) {
  (void)state;
  spring_network *w = lattice(4, 1, 1, 1e-4, true);
  double *before = malloc(w->system.size * sizeof *before);
  memcpy(before, w->X, w->system.size * sizeof *before);
  hk_spectrum s = bounds(w, true), kept = s;
  hk_error error = {0};
  size_t whole = s.evaluations;
  for (size_t k = 1; k <= whole; k++) {
    w->fails_at = w->evaluations + k;
    assert_int_equal(hk_spectrum_estimate(&w->system, &s, &error), HK_NOT_FINITE);
  }
  assert_memory_equal(&s, &kept, sizeof s);
  assert_memory_equal(before, w->X, w->system.size * sizeof *before);
  free(before);
  network_destroy(w);
}

/* The line above all modes in the plane of w^2 and g, against the exact largest eigenvalue of D - slope K; the springs
 * are at rest, so K has no part across them. The bound may be above by 12 % and 0.03 g_max, where the iteration stops.
 */
static void strongly_damped_modes_are_below_a_line(void **state) {
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    spring_network *w = lattice(6, 1, kind == 3 ? 1e4 : 1, 2e-3, true);
    w->drag = kind == 1 ? 50 : 0;
    for (size_t e = 0; kind >= 2 && e < w->edges; e += 3) w->damping[e] *= 5;
    double g = network_largest_damping(w);
    hk_spectrum s = bounds(w, true);
    assert_true(s.damping_slope > 0);
    for (size_t e = 0; e < w->edges; e++) w->damping[e] -= s.damping_slope * w->stiffness[e];
    double exact = fmax(0, network_largest_damping(w));
    assert_between("aside over the largest rate", s.damping_offset / g, exact / g, 1.12 * exact / g + 0.035);
    assert_true(hk_spectrum_ceiling(&s, 0) == fmin(s.damping_offset, s.g_max) &&
                hk_spectrum_ceiling(&s, s.w_max) == s.g_max);
    network_destroy(w);
  }
}

static double stable_to_two(const void *self, const void *method, double hw, double hg, double hb) {
  (void)self, (void)method, (void)hg, (void)hb;
  return hw <= 2 ? 1 : hw;
}

/* As leapfrog: a step of 1.9/w of what the springs state is allowed by that alone, one of 2.1/w is looked at. */
static void a_given_step_that_forces_allow_costs_nothing(void **state) {
  (void)state;
  const hk_integrator_tables method = {.own = {.size = sizeof(hk_integrator), .order = 2, .growth = stable_to_two}};
  spring_network *w = lattice(65, 1, 1, 0, false);
  hk_error error = {0};
  hk_spectrum near, given, above;
  w->covered = true;
  w->queries.flags &= ~(unsigned)HK_DEPENDS_ON_V;
  assert_int_equal(hk_spectrum_estimate_for(&w->system, &method.own, NULL, NAN, &near, &error), HK_OK);
  assert_int_equal(hk_spectrum_estimate_for(&w->system, &method.own, NULL, 1e-6, &given, &error), HK_OK);
  assert_true(near.evaluations > 2 && given.evaluations == 1);
  assert_true(given.w_max >= near.w_max && given.rigorous);
  assert_int_equal(hk_spectrum_estimate_for(&w->system, &method.own, NULL, 1.9 / given.w_max, &above, &error), HK_OK);
  assert_true(above.evaluations == 1);
  assert_int_equal(hk_spectrum_estimate_for(&w->system, &method.own, NULL, 2.1 / given.w_max, &above, &error), HK_OK);
  assert_true(above.evaluations > 2 && above.w_max == near.w_max);
  network_destroy(w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bounds_hold_on_lattices),
      cmocka_unit_test(bounds_hold_under_tension_and_compression),
      cmocka_unit_test(bounds_hold_on_strings),
      cmocka_unit_test(single_oscillators_are_exact),
      cmocka_unit_test(drag_is_the_least_damping),
      cmocka_unit_test(slides_confine_the_modes),
      cmocka_unit_test(false_elements_are_found_out),
      cmocka_unit_test(gyration_is_told_from_damping),
      cmocka_unit_test(channels_have_their_rate),
      cmocka_unit_test(the_state_is_not_touched_and_failures_change_nothing),
      cmocka_unit_test(strongly_damped_modes_are_below_a_line),
      cmocka_unit_test(a_given_step_that_forces_allow_costs_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
