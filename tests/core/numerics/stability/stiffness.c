/* What forces state of their stiffness becomes a bound of the frequencies: against exact eigenvalues and closed forms.
 */
#include "core/numerics/stability/stiffness.h"
#include "tests/support/network.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <cmocka.h>

/* Some tens of operations with numbers up to the largest eigenvalue. */
static const double rounding = 1e-14;

static hk_stiffness stated(spring_network *w) {
  double(*scratch)[6] = calloc(w->n + 1, sizeof *scratch);
  assert_non_null(scratch);
  w->covered = true;
  hk_stiffness found = hk_stiffness_of(&w->system, scratch);
  free(scratch);
  return found;
}

/* R diag(values) R^T with R turned by a about z and then by b about x. */
static void turned(const double value[3], double a, double b, double into[6]) {
  const double R[3][3] = {
      {cos(a), -sin(a), 0}, {cos(b) * sin(a), cos(b) * cos(a), -sin(b)}, {sin(b) * sin(a), sin(b) * cos(a), cos(b)}};
  size_t at = 0;
  for (size_t r = 0; r < 3; r++)
    for (size_t c = r; c < 3; c++, at++) {
      into[at] = 0;
      for (size_t k = 0; k < 3; k++) into[at] += value[k] * R[r][k] * R[c][k];
    }
}

/* The trigonometric formula loses half the digits where eigenvalues meet: sqrt(2.2e-16) of their size. */
static void eigenvalues_are_those_of_a_turned_diagonal(void **state) {
  (void)state;
  static const double values[][3] = {{1, 2, 3}, {-4, 0.5, 1e3}, {0, 0, 7}, {-2, 5, 5}, {3, 3, 3}, {0, 0, 0}};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    for (double angle = 0; angle < 3; angle += 0.37) {
      double matrix[6], found[3], size = fmax(fabs(values[k][0]), fabs(values[k][2]));
      turned(values[k], angle, 2 * angle + 0.1, matrix);
      hk_symmetric_eigenvalues(matrix, found);
      for (size_t e = 0; e < 3; e++) assert_true(fabs(found[e] - values[k][e]) <= 3e-8 * size);
    }
}

static spring_network *lattice(size_t n, double ratio) {
  spring_network *w = network_create(n * n, 4 * n * n, false);
  for (size_t i = 0; i < n * n; i++) {
    network_place(w, i, 0.03 * (double)(i % n), 0.03 * (double)(i / n), 0.01 * (double)(i % 2));
    network_mass(w, i, i % 3 == 0 ? 0.001 * ratio : 0.001);
  }
  network_fix(w, 0);
  for (size_t i = 0; i < n * n; i++) {
    if (i % n + 1 < n) network_join(w, i, i + 1, 1000, 0.1);
    if (i + n < n * n) network_join(w, i, i + n, 700, 0.1);
    if (i % n + 1 < n && i + n < n * n) network_join(w, i, i + n + 1, 300, 0.1);
  }
  return w;
}

static void no_mode_is_faster_than_what_forces_state(void **state) {
  (void)state;
  static const double stretch[] = {1, 2, 0.7}, ratio[] = {1, 100, 1e6};
  for (size_t s = 0; s < 3; s++)
    for (size_t r = 0; r < 3; r++) {
      spring_network *w = lattice(5, ratio[r]);
      for (size_t e = 0; e < w->edges; e++) w->rest[e] /= stretch[s];
      hk_stiffness found = stated(w);
      double exact = network_largest_stiffness(w);
      print_message("stretched %g, masses 1 to %g: %.4f of the exact\n", stretch[s], ratio[r], found.whole / exact);
      assert_true(found.covered && found.whole >= exact * (1 - rounding));
      network_destroy(w);
    }
}

/* w^2 = 4 k/m sin^2(N pi/(2 (N + 1))): the bound 4 k/m is above by tan^2(pi/(2 (N + 1))). */
static void a_long_chain_reaches_the_bound(void **state) {
  (void)state;
  enum { N = 1000 };
  spring_network *w = network_create(N + 2, N + 1, false);
  for (size_t i = 0; i < N + 2; i++) {
    network_place(w, i, 0.6 * (double)i, 0.8 * (double)i, 0);
    network_mass(w, i, 0.01);
    if (i > 0) network_join(w, i - 1, i, 1e5, 1);
  }
  network_fix(w, 0);
  network_fix(w, N + 1);
  double angle = acos(-1) / (2 * (N + 1.0)), exact = 4e7 * cos(angle) * cos(angle);
  assert_true(fabs(stated(w).whole / exact - 1 - tan(angle) * tan(angle)) < rounding);
  network_destroy(w);
}

static void damping_and_lengths_are_the_least_of_the_elements(void **state) {
  (void)state;
  spring_network *w = network_create(4, 3, false);
  assert_true(stated(w).length == INFINITY && stated(w).beta == 0 && stated(w).whole == 0);
  network_place(w, 1, 3, 4, 0);
  network_place(w, 2, 3, 4, 2);
  network_place(w, 3, 3, 4, 2); /* on the third: no length */
  network_join(w, 0, 1, 100, 5);
  network_join(w, 1, 2, 200, 4);
  assert_true(stated(w).length == 2 && stated(w).beta == 0.02);
  network_join(w, 2, 3, 10, 0);
  assert_true(stated(w).length == 2 && stated(w).beta == 0);
  network_destroy(w);
}

/* A spring drawn out to twice its length is half as stiff across as along: k (1 - L/l), by 1/m and the fixed end's 1.
 */
static void the_undamped_part_is_the_tension_across(void **state) {
  (void)state;
  spring_network *w = network_create(2, 1, false);
  network_place(w, 1, 2, 0, 0);
  network_mass(w, 1, 4);
  network_fix(w, 0);
  network_join(w, 0, 1, 100, 8);
  assert_true(stated(w).undamped == 0);
  w->rest[0] = 1;
  hk_stiffness found = stated(w);
  assert_true(fabs(found.whole / 25 - 1) < rounding &&
              fabs(found.undamped / 12.5 - 1) < 1e-7); /* 12.5 twice: they meet */
  network_destroy(w);
}

static void what_may_stiffen_is_stated_apart(void **state) {
  (void)state;
  spring_network *w = network_create(2, 1, false);
  network_place(w, 1, 2, 0, 0);
  network_mass(w, 1, 4);
  network_fix(w, 0);
  network_join(w, 0, 1, 100, 8);
  assert_true(stated(w).stiffening == 0 && stated(w).stiffening_damping == 0);
  w->force.flags |= HK_STIFFENS;
  assert_true(fabs(stated(w).stiffening / 25 - 1) < rounding && fabs(stated(w).stiffening_damping / 2 - 1) < rounding);
  network_destroy(w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(eigenvalues_are_those_of_a_turned_diagonal),
      cmocka_unit_test(no_mode_is_faster_than_what_forces_state),
      cmocka_unit_test(a_long_chain_reaches_the_bound),
      cmocka_unit_test(damping_and_lengths_are_the_least_of_the_elements),
      cmocka_unit_test(the_undamped_part_is_the_tension_across),
      cmocka_unit_test(what_may_stiffen_is_stated_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
