/* Conjugate gradients: products against plain loops, solutions against elimination, pins that stay bitwise exact, the
 * same bits for any number of threads, and refusals of what is not positive definite, singular or too ill-conditioned.
 */
#include "core/numerics/matrix/matrix.h"
#include "core/engine/base/base.h"
#include "plugins/common/linear/block_product.h"
#include "plugins/common/linear/incomplete_cholesky.h"
#include "plugins/common/linear/upper_matrix.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const preconditioners[] = {"block_jacobi", "incomplete_cholesky"};

typedef struct fixture {
  test_engine e;
  hk_shared shared; /* the solver's, in place of a run's */
  hk_plugin_spec *spec;
  hk_instance *solver;
  hk_block_matrix pattern;
  hk_matrix A;
} fixture;

static double noise(void) {
  static uint64_t bits = 1;
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

static void open_solver(fixture *f, const char *preconditioner, int threads) {
  memset(f, 0, sizeof *f);
  test_engine_open(&f->e);
  f->shared = (hk_shared){.error = &f->e.error,
                          .threads = hk_threads_create(threads),
                          .allocations_left = -1,
                          .lanes = hk_processor_lanes()};
  f->spec = test_plugin(&f->e, HK_SOLVER, "pcg");
  test_text(&f->e, f->spec, "preconditioner", preconditioner);
}

static void start(fixture *f) {
  f->solver = hk_instance_create(f->spec, &f->shared, &f->e.error);
  assert_non_null(f->solver);
  assert_int_equal(hk_instance_start(f->solver, &(hk_view){.host = &f->solver->host}, 1, &f->e.error), HK_OK);
}

static void close_solver(fixture *f) {
  free(f->A.value);
  hk_block_matrix_free(&f->pattern);
  hk_instance_destroy(f->solver);
  hk_threads_destroy(f->shared.threads);
  test_engine_close(&f->e);
}

static void name_both(fixture *f, uint32_t i, uint32_t j) {
  f->pattern.naming.block(&f->pattern.naming, i, j);
  f->pattern.naming.block(&f->pattern.naming, j, i);
}

static void build(fixture *f, size_t rows, size_t block) {
  hk_block_matrix *p = &f->pattern;
  assert_int_equal(hk_block_matrix_build(p), HK_OK);
  free(f->A.value);
  f->A = (hk_matrix){rows, block, p->row_start, p->column, NULL, true, 0};
  f->A.value = calloc(p->row_start[rows] * block * block, sizeof(double));
}

/* A ring of `rows` with `chords` random further pairs; with `hub`, row 0 is joined with all. */
static void make_pattern(fixture *f, size_t rows, size_t block, size_t chords, bool hub) {
  hk_block_matrix_begin(&f->pattern, rows, rows);
  for (size_t k = 0; k < rows + chords; k++) {
    uint32_t i = (uint32_t)(k % rows), j = (uint32_t)((k + 1) % rows);
    if (k >= rows) j = (uint32_t)((noise() + 0.5) * (double)rows);
    name_both(f, i, i);
    name_both(f, i, j);
    if (hub) name_both(f, 0, i);
  }
  build(f, rows, block);
}

static size_t find(const hk_matrix *A, size_t row, size_t column) {
  size_t low = A->row_start[row], high = A->row_start[row + 1];
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(A->column[middle] <= column ? &low : &high) = middle;
  }
  assert_true(A->column[low] == column);
  return low;
}

/* Random numbers, symmetric; the diagonal exceeds the sum of its row by `margin`, so for margin > 0 it is definite. */
static void fill(fixture *f, double margin) {
  hk_matrix *A = &f->A;
  size_t b = A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t q = 0; q < b * b; q++) {
        double value = noise();
        size_t mirror = find(A, A->column[e], r);
        A->value[b * b * e + q] = value;
        A->value[b * b * mirror + q % b * b + q / b] = value;
      }
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < b; k++) {
      double sum = 0;
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < b; j++)
          if (A->column[e] != r || j != k) sum += fabs(A->value[b * b * e + b * k + j]);
      A->value[b * b * find(A, r, r) + b * k + k] = sum + margin;
    }
}

static void add_block(hk_matrix *A, size_t i, size_t j, const double B[9], double sign) {
  double *to = A->value + 9 * find(A, i, j);
  for (int k = 0; k < 9; k++) to[k] += sign * B[k];
}

/* A spring of stiffness k between i and j, rest length its length: k d d^T, and a tenth of it across. */
static void add_spring(hk_matrix *A, size_t i, size_t j, double k, const double x[2][3]) {
  double B[9], d[3], l2 = 0;
  for (int c = 0; c < 3; c++) d[c] = x[1][c] - x[0][c], l2 += d[c] * d[c];
  for (int c = 0; c < 9; c++) B[c] = k * (0.9 * d[c / 3] * d[c % 3] / l2 + (c % 4 == 0 ? 0.1 : 0));
  add_block(A, i, i, B, 1);
  add_block(A, j, j, B, 1);
  add_block(A, i, j, B, -1);
  add_block(A, j, i, B, -1);
}

static void add_mass(hk_matrix *A, size_t i, double m) {
  add_block(A, i, i, (double[9]){m, 0, 0, 0, m, 0, 0, 0, m}, 1);
}

/* A wavy cloth of side x side: masses `m` plus springs of `k` N/m times h^2. */
static void make_cloth(fixture *f, uint32_t side, double m, double k) {
  static const uint32_t offset[5][2] = {{1, 0}, {0, 1}, {1, 1}, {2, 0}, {0, 2}};
  uint32_t n = side * side;
  double h = 1 / 60.0;
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 0) hk_block_matrix_begin(&f->pattern, n, n);
    for (uint32_t a = 0; a < n; a++) {
      pass == 0 ? name_both(f, a, a) : add_mass(&f->A, a, m);
      for (int o = 0; o < 5; o++) {
        uint32_t i = a % side + offset[o][0], j = a / side + offset[o][1], b = j * side + i;
        if (i >= side || j >= side) continue;
        const double x[2][3] = {{a % side, a / side, sin(a % side * 0.7)}, {i, j, sin(i * 0.7)}};
        pass == 0 ? name_both(f, a, b) : add_spring(&f->A, a, b, k * h * h * (o < 3 ? 1 : 0.1), x);
      }
    }
    if (pass == 0) build(f, n, 3);
  }
}

/* Rows and columns of particle i become those of s I: what the filter of a fixed pin leaves. */
static void fix(hk_matrix *A, size_t i, double s) {
  for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
    size_t j = A->column[e];
    memset(A->value + 9 * e, 0, 9 * sizeof(double));
    memset(A->value + 9 * find(A, j, i), 0, 9 * sizeof(double));
  }
  add_mass(A, i, s);
}

/* y = A x by the definition. */
static void multiply(const hk_matrix *A, const double *x, double *y) {
  size_t w = A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < w; k++) {
      y[w * r + k] = 0;
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < w; j++) y[w * r + k] += A->value[w * w * e + w * k + j] * x[w * A->column[e] + j];
    }
}

/* |b - A x| / |b|: independent of what the solver says. */
static double residual(const hk_matrix *A, const double *b, const double *x) {
  size_t n = A->rows * A->block;
  double left = 0, whole = 0, *y = malloc(n * sizeof *y);
  multiply(A, x, y);
  for (size_t k = 0; k < n; k++) left += (b[k] - y[k]) * (b[k] - y[k]), whole += b[k] * b[k];
  free(y);
  return sqrt(left / whole);
}

static hk_status analyze(fixture *f) { return f->solver->plugin->solver->analyze(f->solver->self, &f->A); }
static hk_status factorize(fixture *f) { return f->solver->plugin->solver->factorize(f->solver->self, &f->A); }
static hk_status solve(fixture *f, const double *b, double *x, hk_solve_info *info) {
  return f->solver->plugin->solver->solve(f->solver->self, b, x, info);
}

static double *random_vector(size_t n) {
  double *b = calloc(n + 1, sizeof *b);
  for (size_t k = 0; k < n; k++) b[k] = noise();
  return b;
}

/* ---- Products -------------------------------------------------------------------------------------------------- */

/* Row sums have fewer than 100 terms below 1 (of the hub: 30000 random ones, whose sum is some 100). */
static void check_products(fixture *f) {
  const hk_host *host = &f->solver->host;
  size_t n = f->A.rows * f->A.block;
  double *x = random_vector(n), *y = calloc(n, sizeof *y), *full = calloc(n, sizeof *y), *upper = calloc(n, sizeof *y);
  hk_upper m;
  double dot = 0, size = 0;
  multiply(&f->A, x, y);
  hk_block_product(host, &f->A, x, full);
  assert_int_equal(hk_upper_analyze(&m, host, &f->A), HK_OK);
  hk_upper_fill(&m, host, &f->A);
  double found = hk_upper_product(&m, host, x, upper);
  for (size_t k = 0; k < n; k++) {
    dot += x[k] * y[k];
    size += fabs(x[k] * y[k]);
    assert_true(fabs(full[k] - y[k]) <= 1e-14 * (1 + fabs(y[k])) * (k < f->A.block ? 100 : 1));
    assert_true(fabs(upper[k] - y[k]) <= 1e-14 * (1 + fabs(y[k])) * (k < f->A.block ? 100 : 1));
  }
  assert_true(fabs(found - dot) <= 1e-13 * size); /* rounding of sums of n products, which average out */
  hk_upper_free(&m, host);
  free(x), free(y), free(full), free(upper);
}

static void products_are_those_of_the_plain_loops(void **state) {
  (void)state;
  static const size_t sizes[][4] = {{1, 1, 0, 0},    {1, 3, 0, 0},      {2, 3, 0, 0},        {7, 3, 9, 0},
                                    {300, 1, 90, 0}, {1030, 3, 0, 0},   {5001, 3, 15000, 0}, {5001, 1, 15000, 0},
                                    {600, 3, 0, 1},  {10000, 3, 50, 1}, {10000, 1, 50, 1}};
  fixture f;
  open_solver(&f, "block_jacobi", 2);
  start(&f);
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2], sizes[k][3]);
    fill(&f, 0.5);
    for (size_t q = 0; sizes[k][3] && q < f.A.block * f.A.block; q++) f.A.value[q] = 1; /* the hub's is large */
    if (f.A.block == 3) f.A.value[1] = f.A.value[3] = 0.25;
    check_products(&f);
  }
  for (uint32_t side = 3; side < 70; side += 13) {
    make_cloth(&f, side, 1, 3600);
    check_products(&f);
  }
  close_solver(&f);
}

/* ---- Solutions ------------------------------------------------------------------------------------------------- */

static void systems_are_solved_to_the_tolerance(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{1, 1, 0}, {1, 3, 0}, {2, 3, 0}, {50, 1, 60}, {40, 3, 80}, {9000, 3, 9000}};
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 2);
    start(&f);
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) { /* new patterns on one instance */
      make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2], false);
      assert_int_equal(analyze(&f), HK_OK);
      size_t n = f.A.rows * f.A.block;
      for (int again = 0; again < 2; again++) { /* new numbers on one pattern */
        fill(&f, 0.5);
        assert_int_equal(factorize(&f), HK_OK);
        double *b = random_vector(n), *x = calloc(n, sizeof *x), asked = again ? 1e-12 : 1e-8;
        hk_solve_info info = {-1, -1, again ? asked : 0};
        assert_int_equal(solve(&f, b, x, &info), HK_OK);
        assert_true(residual(&f.A, b, x) <= asked * (1 + 1e-6)); /* two ways to add up */
        assert_true(info.residual <= asked && info.residual >= 0 && info.iterations >= 1);
        free(b), free(x);
      }
    }
    close_solver(&f);
  }
}

/* Gaussian elimination with pivots; A: n x n, overwritten, b becomes x. */
static void eliminate(double *A, double *b, size_t n) {
  for (size_t k = 0; k < n; k++) {
    size_t best = k;
    for (size_t i = k; i < n; i++)
      if (fabs(A[n * i + k]) > fabs(A[n * best + k])) best = i;
    for (size_t j = 0; j < n; j++) {
      double swap = A[n * k + j];
      A[n * k + j] = A[n * best + j];
      A[n * best + j] = swap;
    }
    double swap = b[k];
    b[k] = b[best];
    b[best] = swap;
    for (size_t i = k + 1; i < n; i++) {
      double factor = A[n * i + k] / A[n * k + k];
      for (size_t j = k; j < n; j++) A[n * i + j] -= factor * A[n * k + j];
      b[i] -= factor * b[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; j++) b[k] -= A[n * k + j] * b[j];
    b[k] /= A[n * k + k];
  }
}

/* Condition numbers are below 1e3 or so: residuals of 1e-12 leave 1e-9 of the solution. */
static void solutions_are_those_of_elimination(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_cloth(&f, 6, 1, 3600 * 10);
    enum { N = 108 };
    double *dense = calloc(N * N, sizeof *dense), *b = random_vector(N), x[N], largest = 0;
    for (size_t r = 0; r < f.A.rows; r++)
      for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++)
        for (size_t q = 0; q < 9; q++) dense[N * (3 * r + q / 3) + 3 * f.A.column[e] + q % 3] = f.A.value[9 * e + q];
    hk_solve_info info = {0, 0, 1e-12};
    assert_int_equal(analyze(&f), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    assert_int_equal(solve(&f, b, x, &info), HK_OK);
    eliminate(dense, b, N);
    for (int k = 0; k < N; k++) largest = fmax(largest, fabs(b[k]));
    for (int k = 0; k < N; k++) assert_true(fabs(b[k] - x[k]) < 1e-9 * largest);
    free(dense), free(b);
    close_solver(&f);
  }
}

static void fixed_particles_stay_bitwise_zero(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 2);
    start(&f);
    make_cloth(&f, 95, 1e-5, 1e5); /* two domains */
    for (uint32_t i = 0; i < 9025; i += 7) fix(&f.A, i, 3.7);
    double *b = random_vector(3 * 9025), *x = random_vector(3 * 9025);
    const double zero[3] = {0};
    for (size_t i = 0; i < 9025; i += 7) memset(b + 3 * i, 0, sizeof zero);
    assert_int_equal(analyze(&f), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    assert_int_equal(solve(&f, b, x, NULL), HK_OK);
    for (size_t i = 0; i < 9025; i += 7) assert_memory_equal(x + 3 * i, zero, sizeof zero);
    assert_true(x[3] != 0);
    free(b), free(x);
    close_solver(&f);
  }
}

static void threads_do_not_show_in_the_bits(void **state) {
  (void)state;
  enum { SIDE = 100, N = 3 * SIDE * SIDE };
  double *b = random_vector(N), *x[3];
  for (int p = 0; p < 2; p++) {
    int iterations[3];
    for (int t = 0; t < 3; t++) {
      fixture f;
      open_solver(&f, preconditioners[p], t + 1);
      start(&f);
      make_cloth(&f, SIDE, 1e-5, 1e4);
      x[t] = calloc(N, sizeof **x);
      hk_solve_info info = {0};
      assert_int_equal(analyze(&f), HK_OK);
      assert_int_equal(factorize(&f), HK_OK);
      assert_int_equal(solve(&f, b, x[t], &info), HK_OK);
      iterations[t] = info.iterations;
      close_solver(&f);
    }
    for (int t = 1; t < 3; t++) {
      assert_memory_equal(x[0], x[t], N * sizeof **x);
      assert_int_equal(iterations[0], iterations[t]);
    }
    for (int t = 0; t < 3; t++) free(x[t]);
  }
  free(b);
}

/* ---- Preconditioners ------------------------------------------------------------------------------------------- */

static int iterations_on_cloth(const char *preconditioner) {
  fixture f;
  hk_solve_info info = {0};
  open_solver(&f, preconditioner, 1);
  start(&f);
  make_cloth(&f, 40, 0.15 / 1600, 1e5);
  double *b = random_vector(4800), *x = calloc(4800, sizeof *x);
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, &info), HK_OK);
  free(b), free(x);
  close_solver(&f);
  return info.iterations;
}

/* On such grids the condition number falls by a factor of some ten, so iterations by three or so. */
static void incomplete_cholesky_halves_the_iterations_on_stiff_cloth(void **state) {
  (void)state;
  int jacobi = iterations_on_cloth("block_jacobi"), cholesky = iterations_on_cloth("incomplete_cholesky");
  assert_true(cholesky > 5 && 2 * cholesky < jacobi);
}

/* A chain has no fill: the factors are exact up to single precision, 6e-8, and so is the first iterate. Two restore
 * what was rounded; a third is for the condition number. */
static void incomplete_cholesky_of_a_chain_is_exact(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "incomplete_cholesky", 1);
  start(&f);
  enum { N = 200 };
  hk_block_matrix_begin(&f.pattern, N, N);
  for (uint32_t i = 0; i < N; i++) name_both(&f, i, i), name_both(&f, i, i + 1 < N ? i + 1 : i);
  build(&f, N, 3);
  fill(&f, 0.1);
  double *b = random_vector(3 * N), x[3 * N];
  hk_solve_info info = {0};
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, &info), HK_OK);
  assert_true(info.iterations <= 3);
  free(b);
  close_solver(&f);
}

/* Definite, but with factors only when the diagonal is raised: the dropped fill of a ring of strong couplings is all on
 * one side (Kershaw's matrix, J. Comp. Phys. 26, 1978, whose last pivot is negative). */
static void incomplete_cholesky_raises_the_diagonal_where_it_must(void **state) {
  (void)state;
  static const double kershaw[4][4] = {{3, -2, 0, 2}, {-2, 3, -2, 0}, {0, -2, 3, -2}, {2, 0, -2, 3}};
  fixture f;
  open_solver(&f, "incomplete_cholesky", 1);
  start(&f);
  make_pattern(&f, 4, 1, 0, false);
  for (size_t r = 0; r < 4; r++)
    for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++) f.A.value[e] = kershaw[r][f.A.column[e]];
  double b[4] = {1, 2, -1, 3}, x[4];
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, NULL), HK_OK);
  assert_true(residual(&f.A, b, x) <= 1e-8);
  hk_incomplete m;
  assert_int_equal(hk_incomplete_analyze(&m, &f.solver->host, &f.A), HK_OK);
  assert_true(hk_incomplete_factorize(&m, &f.solver->host, &f.A) && m.shift[0] > 0 && m.shift[0] < 1);
  hk_incomplete_free(&m, &f.solver->host);
  close_solver(&f);
}

/* ---- Hard cases ------------------------------------------------------------------------------------------------ */

/* Masses from 1e-6 to 1 kg side by side, springs from 1 to 1e8 N/m. Against the residual of 1e-8 stands the rounding of
 * A x: the condition number is 1e14 as it stands, some 1e8 when scaled by the diagonal. */
static void uneven_masses_and_stiffnesses_are_solved(void **state) {
  (void)state;
  enum { SIDE = 12, N = SIDE * SIDE };
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_cloth(&f, SIDE, 0, 1);
    for (uint32_t a = 0; a < N; a++) {
      add_mass(&f.A, a, a % 2 ? 1 : 1e-6);
      const double x[2][3] = {{0, 0, 0}, {1, 0.1, 0.2}};
      if (a % SIDE && a < N / 2) add_spring(&f.A, a - 1, a, 1e8 / 3600, x);
    }
    double *b = random_vector(3 * N), x[3 * N];
    hk_solve_info info = {0};
    assert_int_equal(analyze(&f), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    hk_status status = solve(&f, b, x, &info);
    if (status != HK_OK) fail_msg("%s", f.e.error.text);
    assert_true(residual(&f.A, b, x) <= 1.01e-8);
    free(b);
    close_solver(&f);
  }
}

/* Seen in a diagonal block when the matrix is taken, or along a search direction; x is as it was. */
static void indefinite_matrix_is_refused_and_the_solver_goes_on(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_pattern(&f, 20, 3, 10, false);
    assert_int_equal(analyze(&f), HK_OK);
    double *b = random_vector(60), x[60] = {7}, zero[60] = {7};
    fill(&f, 0.5);
    f.A.value[9 * find(&f.A, 7, 7) + 4] *= -1;
    assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
    assert_non_null(strstr(f.e.error.text, "not positive definite, seen at the 8th particle's y"));
    assert_int_equal(solve(&f, b, x, NULL), HK_FAILED);
    fill(&f, 0.5);
    for (int k = 0; k < 3; k++) { /* diagonal blocks stay definite */
      f.A.value[9 * find(&f.A, 7, 8) + 4 * k] = f.A.value[9 * find(&f.A, 8, 7) + 4 * k] = 1e3;
    }
    f.e.error = (hk_error){0};
    hk_status status = factorize(&f); /* with incomplete Cholesky: the raised diagonal has factors */
    if (status == HK_OK) status = solve(&f, b, x, NULL);
    assert_int_equal(status, HK_NOT_CONVERGED);
    assert_non_null(strstr(f.e.error.text, "not positive definite"));
    assert_memory_equal(x, zero, sizeof x);
    fill(&f, 0.5);
    assert_int_equal(factorize(&f), HK_OK);
    assert_int_equal(solve(&f, b, x, NULL), HK_OK);
    assert_true(residual(&f.A, b, x) <= 1e-8);
    free(b);
    close_solver(&f);
  }
}

/* A free cloth without mass: nothing resists a shift, and b asks for one. */
static void singular_matrix_is_refused(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_cloth(&f, 8, 0, 3600);
    double b[192], x[192] = {7};
    for (int k = 0; k < 192; k++) b[k] = 1;
    assert_int_equal(analyze(&f), HK_OK);
    hk_status status = factorize(&f);
    if (status == HK_OK) status = solve(&f, b, x, NULL);
    assert_int_equal(status, HK_NOT_CONVERGED);
    assert_true(x[0] == 7);
    f.e.error = (hk_error){0};
    memset(f.A.value + 9 * find(&f.A, 3, 3), 0, 9 * sizeof(double)); /* nothing on a diagonal */
    assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
    assert_non_null(strstr(f.e.error.text, "4th particle's x"));
    close_solver(&f);
  }
}

static void what_is_not_finite_is_refused(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_pattern(&f, 20, 3, 10, false);
    fill(&f, 0.5);
    double *b = random_vector(60), x[60];
    assert_int_equal(analyze(&f), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    b[17] = NAN;
    assert_int_equal(solve(&f, b, x, NULL), HK_NOT_FINITE);
    b[17] = 1;
    f.A.value[9 * find(&f.A, 3, 4)] = NAN;
    hk_status status = factorize(&f);
    if (status == HK_OK) status = solve(&f, b, x, NULL);
    assert_true(status == HK_NOT_FINITE || status == HK_NOT_CONVERGED);
    free(b);
    close_solver(&f);
  }
}

static void stopping_early_says_how_far_it_came(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "block_jacobi", 1);
  test_number(&f.e, f.spec, "iterations", 5);
  start(&f);
  make_cloth(&f, 20, 1e-5, 1e5);
  double *b = random_vector(1200), *x = calloc(1200, sizeof *x);
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, NULL), HK_NOT_CONVERGED);
  assert_non_null(strstr(f.e.error.text, "after 5 iterations, asked for was 1e-08"));
  hk_solve_info info = {0, 0, 1e-300}; /* nothing reaches that: rounding is said, or the limit */
  assert_int_equal(solve(&f, b, x, &info), HK_NOT_CONVERGED);
  free(b), free(x);
  close_solver(&f);
}

static void rounding_that_bars_the_tolerance_is_said(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "incomplete_cholesky", 1);
  start(&f);
  make_pattern(&f, 30, 3, 30, false);
  fill(&f, 0.5);
  double *b = random_vector(90), x[90];
  hk_solve_info info = {0, 0, 1e-18};
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, &info), HK_NOT_CONVERGED);
  assert_non_null(strstr(f.e.error.text, "rounding"));
  free(b);
  close_solver(&f);
}

static void no_right_hand_side_has_the_solution_zero(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "block_jacobi", 1);
  start(&f);
  make_pattern(&f, 5, 3, 0, false);
  fill(&f, 0.5);
  double b[15] = {0}, x[15] = {7};
  hk_solve_info info = {-1, -1, 0};
  assert_int_equal(factorize(&f), HK_FAILED); /* never analysed */
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, &info), HK_OK);
  assert_memory_equal(b, x, sizeof x);
  assert_true(info.iterations == 0 && info.residual == 0);
  close_solver(&f);
}

static void no_memory_is_an_error_in_every_part(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    fixture f;
    open_solver(&f, preconditioners[p], 1);
    start(&f);
    make_pattern(&f, 10000, 3, 10, true); /* with a chunk that needs working memory of its own */
    for (long k = 0;; k++) {
      f.shared.allocations_left = k;
      hk_status status = analyze(&f);
      if (status == HK_OK) {
        assert_true(k >= 19);
        break;
      }
      assert_int_equal(status, HK_NO_MEMORY);
      assert_int_equal(factorize(&f), HK_FAILED);
    }
    close_solver(&f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(products_are_those_of_the_plain_loops),
      cmocka_unit_test(systems_are_solved_to_the_tolerance),
      cmocka_unit_test(solutions_are_those_of_elimination),
      cmocka_unit_test(fixed_particles_stay_bitwise_zero),
      cmocka_unit_test(threads_do_not_show_in_the_bits),
      cmocka_unit_test(incomplete_cholesky_halves_the_iterations_on_stiff_cloth),
      cmocka_unit_test(incomplete_cholesky_of_a_chain_is_exact),
      cmocka_unit_test(incomplete_cholesky_raises_the_diagonal_where_it_must),
      cmocka_unit_test(uneven_masses_and_stiffnesses_are_solved),
      cmocka_unit_test(indefinite_matrix_is_refused_and_the_solver_goes_on),
      cmocka_unit_test(singular_matrix_is_refused),
      cmocka_unit_test(what_is_not_finite_is_refused),
      cmocka_unit_test(stopping_early_says_how_far_it_came),
      cmocka_unit_test(rounding_that_bars_the_tolerance_is_said),
      cmocka_unit_test(no_right_hand_side_has_the_solution_zero),
      cmocka_unit_test(no_memory_is_an_error_in_every_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
