/* The V-cycle of a liquid's pressure, by what conjugate gradients make of it: the solution is that of the incomplete
 * factors, iterations do not grow with the size, walls inside and a box without a surface do no harm, threads do not
 * change bits, and what is not finite is no solution. */
#include "plugins/common/mac_grid/pressure.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct fixture {
  test_solver s; /* its host */
  hk_liquid_grid grid;
  uint32_t *unknown; /* of the cells of the grid */
  hk_pressure p;
} fixture;

static bool is_wall(size_t n, const size_t at[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += pow((double)at[c] - 0.4 * (double)n, 2);
  return sqrt(sum) < 0.25 * (double)n;
}

/* The rows of a cube of n^3 cells with walls all round; `ball`: and one in the middle; `open`: a surface above. */
static void fill(fixture *f, size_t n, bool ball, bool open) {
  hk_pressure *p = &f->p;
  size_t m = n + 2, count = 0;
  for (size_t i = 0; i < m * m * m; i++) {
    const size_t at[3] = {i % m, i / m % m, i / m / m};
    bool inside = true;
    for (int c = 0; c < 3; c++) inside &= at[c] >= 1 && at[c] <= n;
    f->unknown[i] = UINT32_MAX;
    if (!inside || (ball && is_wall(n, at))) continue;
    p->cell[count] = (uint32_t)i;
    f->unknown[i] = (uint32_t)count++;
  }
  p->rows = count;
  for (size_t k = 0; k < count; k++) {
    const size_t i = p->cell[k], step[3] = {1, m, m * m};
    p->diagonal[k] = open && i / m / m == n ? 2 : 0;
    for (int c = 0; c < 3; c++) {
      uint32_t prior = f->unknown[i - step[c]], next = f->unknown[i + step[c]];
      p->prior[c][k] = prior < count ? prior : (uint32_t)count;
      p->next[c][k] = next < count ? next : (uint32_t)count;
      p->side[c][k] = next < count;
      p->diagonal[k] += (prior < count) + (next < count);
    }
  }
}

static void open_fixture(fixture *f, size_t n, int threads) {
  test_solver_open(&f->s, "pcg", threads);
  f->grid = (hk_liquid_grid){.cells = {n, n, n}, .slab = 2};
  assert_int_equal(hk_pressure_open(&f->p, &f->s.solver->host, &f->grid), HK_OK);
  f->unknown = calloc((n + 2) * (n + 2) * (n + 2), sizeof *f->unknown);
  assert_non_null(f->unknown);
}

static void close_fixture(fixture *f) {
  free(f->unknown);
  hk_pressure_close(&f->p);
  test_solver_close(&f->s);
}

static bool solve(fixture *f, hk_pressure_way way, double tolerance) {
  f->p.way = way;
  hk_pressure_prepare(&f->p);
  for (size_t k = 0; k < f->p.rows; k++) {
    f->p.b[k] = sin(7 * (double)k) + 0.1;
    f->p.x[k] = 0;
  }
  return hk_pressure_solve(&f->p, tolerance, 0);
}

/* Incomplete factors take 22 at 16^3 and 35 at 32^3; 7 were found with the cycle at all sizes, without the ball 6. */
static void iterations_do_not_grow_with_the_size(void **state) {
  (void)state;
  for (size_t n = 10; n <= 40; n *= 2) {
    fixture f;
    open_fixture(&f, n, 1);
    for (int ball = 0; ball < 2; ball++) {
      fill(&f, n, ball, true);
      assert_true(solve(&f, HK_PRESSURE_VCYCLE, 1e-6));
      if (f.p.iterations > 9) fail_msg("%zu^3, ball %d: %d iterations", n, ball, f.p.iterations);
    }
    close_fixture(&f);
  }
}

/* To 1e-10 of residuals, whose pressures are some hundred times as large. */
static void the_solution_is_that_of_factors(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, 13, 1);
  fill(&f, 13, true, true);
  double *factors = calloc(f.p.rows, sizeof *factors), most = 0;
  assert_true(solve(&f, HK_PRESSURE_FACTORS, 1e-10));
  memcpy(factors, f.p.x, f.p.rows * sizeof *factors);
  assert_true(solve(&f, HK_PRESSURE_VCYCLE, 1e-10));
  for (size_t k = 0; k < f.p.rows; k++) most = fmax(most, fabs(f.p.x[k] - factors[k]));
  if (!(most < 1e-7)) fail_msg("%.3g", most);
  free(factors);
  close_fixture(&f);
}

/* The matrix of a box that is full is singular, and its right-hand side has a mean, which no pressure takes away. */
static void a_box_without_a_surface_is_solved(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, 17, 1);
  for (int ball = 0; ball < 2; ball++) {
    fill(&f, 17, ball, false);
    assert_true(solve(&f, HK_PRESSURE_VCYCLE, 1e-8));
    if (f.p.iterations > 14) fail_msg("ball %d: %d iterations", ball, f.p.iterations);
  }
  close_fixture(&f);
}

/* r.(M s) = s.(M r), to the rounding of single precision, and r.(M r) > 0. */
static void the_cycle_is_symmetric_and_positive(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, 12, 1);
  fill(&f, 12, true, true);
  f.p.way = HK_PRESSURE_VCYCLE;
  hk_pressure_prepare(&f.p);
  hk_vcycle_level *l = &f.p.vcycle.level[0];
  float *r = calloc(l->size, sizeof *r), *Mr = calloc(l->size, sizeof *r);
  double rMr = 0, sMr = 0, rMs = 0, size = 0;
  for (size_t k = 0; k < f.p.rows; k++) l->b[f.p.cell[k]] = r[f.p.cell[k]] = (float)test_noise();
  hk_vcycle_run(&f.p.vcycle);
  memcpy(Mr, l->x, l->size * sizeof *Mr);
  for (size_t k = 0; k < f.p.rows; k++) l->b[f.p.cell[k]] = (float)test_noise();
  hk_vcycle_run(&f.p.vcycle);
  for (size_t k = 0; k < f.p.rows; k++) {
    size_t i = f.p.cell[k];
    rMr += (double)(r[i] * Mr[i]);
    rMs += (double)(r[i] * l->x[i]);
    sMr += (double)(l->b[i] * Mr[i]);
    size += fabs((double)(r[i] * l->x[i]));
  }
  assert_true(rMr > 0);
  if (!(fabs(rMs - sMr) < 1e-6 * size)) fail_msg("%.9g and %.9g of %.3g", rMs, sMr, size);
  free(r);
  free(Mr);
  close_fixture(&f);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  double *first = NULL;
  for (int t = 0; t < 3; t++) {
    fixture f;
    open_fixture(&f, 24, threads[t]);
    fill(&f, 24, true, true);
    assert_true(solve(&f, HK_PRESSURE_VCYCLE, 1e-8));
    if (t == 0) {
      first = calloc(f.p.rows, sizeof *first);
      memcpy(first, f.p.x, f.p.rows * sizeof *first);
    }
    assert_memory_equal(first, f.p.x, f.p.rows * sizeof *first);
    close_fixture(&f);
  }
  free(first);
}

static void what_is_not_finite_is_no_solution(void **state) {
  (void)state;
  fixture f;
  open_fixture(&f, 8, 1);
  for (int way = HK_PRESSURE_FACTORS; way <= HK_PRESSURE_VCYCLE; way++) {
    fill(&f, 8, false, true);
    f.p.diagonal[100] = NAN;
    assert_false(solve(&f, (hk_pressure_way)way, 1e-8));
  }
  close_fixture(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(iterations_do_not_grow_with_the_size), cmocka_unit_test(the_solution_is_that_of_factors),
      cmocka_unit_test(a_box_without_a_surface_is_solved),    cmocka_unit_test(the_cycle_is_symmetric_and_positive),
      cmocka_unit_test(threads_do_not_change_bits),           cmocka_unit_test(what_is_not_finite_is_no_solution),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
