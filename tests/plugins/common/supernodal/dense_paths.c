/* The dense loops for every processor against Cholesky's factorization by its definition, and against each other: the
 * paths with fused multiply-add give the same bits, the narrow one differs by rounding. */
#include "core/engine/base/base.h"
#include "plugins/common/supernodal/dense_front.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 80 };

/* A front of one supernode with blocks of one number; `inner` columns and `below` rows. */
typedef struct front {
  size_t inner, below, top, ld, ldu;
  void *panel, *update, *inverse, *work;
} front;

static double A[MOST][MOST], L[MOST][MOST]; /* in doubles, on and below the diagonal */

static double noise(void) { return (double)rand() / RAND_MAX - 0.5; }

static void make_matrix(size_t n) {
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) A[i][j] = i == j ? (double)n : noise();
}

/* The first `inner` columns of L; what is left of the others is in L too. */
static void factorize_plainly(size_t n, size_t inner) {
  memcpy(L, A, sizeof L);
  for (size_t k = 0; k < inner; k++) {
    L[k][k] = sqrt(L[k][k]);
    for (size_t i = k + 1; i < n; i++) L[i][k] /= L[k][k];
    for (size_t j = k + 1; j < n; j++)
      for (size_t i = j; i < n; i++) L[i][j] -= L[i][k] * L[j][k];
  }
}

static void set(void *numbers, size_t number, size_t at, double value) {
  if (number == sizeof(double))
    ((double *)numbers)[at] = value;
  else
    ((float *)numbers)[at] = (float)value;
}

static double get(const void *numbers, size_t number, size_t at) {
  return number == sizeof(double) ? ((const double *)numbers)[at] : (double)((const float *)numbers)[at];
}

static void *numbers_of(size_t count) {
  void *memory = aligned_alloc(HK_FRONT_VECTOR, (count * sizeof(double) / HK_FRONT_VECTOR + 1) * HK_FRONT_VECTOR);
  memset(memory, 0, count * sizeof(double));
  return memory;
}

static front open_front(const hk_dense_path *path, size_t inner, size_t below) {
  size_t vector = HK_FRONT_VECTOR / path->number;
  front f = {inner, below, (vector - inner % vector) % vector, 0, (below + vector - 1) / vector * vector, 0, 0, 0, 0};
  f.ld = f.top + inner + f.ldu;
  f.panel = numbers_of(f.ld * inner);
  f.update = numbers_of(f.ldu * below + 1);
  f.inverse = numbers_of(inner);
  f.work = numbers_of(hk_dense_front_work(inner, below));
  for (size_t j = 0; j < inner; j++)
    for (size_t i = j; i < inner + below; i++) set(f.panel, path->number, f.ld * j + f.top + i, A[i][j]);
  return f;
}

static void close_front(front *f) {
  free(f->panel);
  free(f->update);
  free(f->inverse);
  free(f->work);
}

/* Returns the number of columns with good pivots. */
static size_t run(const hk_dense_path *path, front *f) {
  hk_dense_front d = {.path = path, .panel = f->panel, .inverse = f->inverse, .update = f->update, .work = f->work};
  d.ld = f->ld, d.top = f->top, d.ldu = f->ldu;
  d.columns = f->inner, d.outer = f->below;
  return hk_dense_front_factorize(&d);
}

/* Rounding of one number is eps, of sums of up to MOST products of numbers below 1 some MOST eps. */
static void check_front(const hk_dense_path *path, const front *f) {
  double eps = path->number == sizeof(double) ? 0x1p-53 : 0x1p-24, limit = 4 * MOST * eps;
  for (size_t j = 0; j < f->inner + f->below; j++)
    for (size_t i = j; i < f->inner + f->below; i++) {
      bool in_panel = j < f->inner;
      double got = in_panel ? get(f->panel, path->number, f->ld * j + f->top + i)
                            : get(f->update, path->number, f->ldu * (j - f->inner) + i - f->inner) + A[i][j];
      if (!(fabs(got - L[i][j]) <= limit * (1 + fabs(L[i][j]))))
        fail_msg("%s, %zu bytes, %zu + %zu: row %zu, column %zu: %.17g, not %.17g", path->name, path->number, f->inner,
                 f->below, i, j, got, L[i][j]);
    }
}

static bool same(const hk_dense_path *path, const front *f, const front *g) {
  bool equal = memcmp(f->inverse, g->inverse, f->inner * path->number) == 0;
  for (size_t j = 0; j < f->inner; j++)
    for (size_t i = j; i < f->inner + f->below; i++)
      equal = equal && get(f->panel, path->number, f->ld * j + f->top + i) ==
                           get(g->panel, path->number, g->ld * j + g->top + i);
  for (size_t j = 0; j < f->below; j++)
    for (size_t i = j; i < f->below; i++)
      equal = equal && get(f->update, path->number, f->ldu * j + i) == get(g->update, path->number, g->ldu * j + i);
  return equal;
}

/* NULL: not of this processor. */
static const hk_dense_path *path_of(bool single, int lanes) {
  if (lanes > hk_processor_lanes()) return NULL;
  return single ? hk_dense_single(lanes) : hk_dense_double(lanes);
}

static void check_size(bool single, size_t inner, size_t below) {
  const hk_dense_path *paths[] = {path_of(single, 8), path_of(single, 4), path_of(single, 2)};
  front fused = {0};
  make_matrix(inner + below);
  factorize_plainly(inner + below, inner);
  for (size_t k = 0; k < 3; k++) {
    if (!paths[k]) continue;
    front f = open_front(paths[k], inner, below);
    assert_int_equal(run(paths[k], &f), inner);
    check_front(paths[k], &f);
    if (k == 1 && fused.panel) assert_true(same(paths[k], &fused, &f));
    if (k == 0)
      fused = f;
    else
      close_front(&f);
  }
  if (fused.panel) close_front(&fused);
}

/* All widths of strips, and rows and columns that end anywhere in a vector. */
static void every_path_factorizes_fronts(void **state) {
  (void)state;
  static const size_t inner[] = {1, 2, 3, 5, 6, 9, 12, 16, 21, 24, 33, 40}, below[] = {0, 1, 3, 8, 15, 16, 17, 24, 36};
  for (size_t i = 0; i < sizeof inner / sizeof *inner; i++)
    for (size_t b = 0; b < sizeof below / sizeof *below; b++) {
      check_size(false, inner[i], below[b]);
      check_size(true, inner[i], below[b]);
    }
}

static void a_pivot_that_is_not_positive_is_counted(void **state) {
  (void)state;
  for (int single = 0; single < 2; single++) {
    const hk_dense_path *paths[] = {path_of(single, 8), path_of(single, 4), path_of(single, 2)};
    for (size_t k = 0; k < 3; k++)
      for (size_t at = 0; paths[k] && at < 31; at += 5) {
        make_matrix(40);
        A[at][at] = at % 2 ? NAN : -1;
        front f = open_front(paths[k], 31, 9);
        assert_int_equal(run(paths[k], &f), at);
        close_front(&f);
      }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_path_factorizes_fronts),
      cmocka_unit_test(a_pivot_that_is_not_positive_is_counted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
