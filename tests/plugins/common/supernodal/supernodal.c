/* Factors in doubles and floats of one grid, by every path: what they solve, whether paths give the same bits, and
 * branches that cover the tree, and that a matrix that is not definite costs no more branches than it has to. */
#include "core/engine/base/base.h"
#include "plugins/common/cholesky/block_order.h"
#include "plugins/common/supernodal/supernodal.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 20, ROWS = SIDE * SIDE, UNKNOWNS = 3 * ROWS };

static size_t row_start[ROWS + 1];
static uint32_t column[5 * ROWS];
static double value[9 * 5 * ROWS], b[UNKNOWNS];
static const hk_matrix A = {ROWS, 3, row_start, column, value, true, 0};

/* Springs of a grid, stiff along x and soft across, with a mass: condition number 1e4. */
static void make_grid(void) {
  size_t at = 0;
  for (size_t i = 0; i < ROWS; i++) {
    const long step[5] = {-SIDE, -1, 0, 1, SIDE};
    row_start[i] = at;
    for (int k = 0; k < 5; k++) {
      long j = (long)i + step[k];
      bool wraps = (k == 1 && i % SIDE == 0) || (k == 3 && i % SIDE == SIDE - 1);
      if (j < 0 || j >= ROWS || wraps) continue;
      for (size_t c = 0; c < 3; c++) value[9 * at + 4 * c] = k == 2 ? 4000.5 - (double)c : -1000 + (double)c / 4;
      value[9 * at + 1] = value[9 * at + 3] = k == 2 ? 0.2 : 0;
      column[at++] = (uint32_t)j;
    }
  }
  row_start[ROWS] = at;
  for (size_t e = 0; e < UNKNOWNS; e++) b[e] = 1e-3 * sin(1.7 * (double)e);
}

static double residual(const double *x) {
  double left = 0, whole = 0;
  for (size_t i = 0; i < ROWS; i++)
    for (size_t r = 0; r < 3; r++) {
      double sum = b[3 * i + r];
      for (size_t e = row_start[i]; e < row_start[i + 1]; e++)
        for (size_t c = 0; c < 3; c++) sum -= value[9 * e + 3 * r + c] * x[3 * column[e] + c];
      left += sum * sum;
      whole += b[3 * i + r] * b[3 * i + r];
    }
  return sqrt(left / whole);
}

static void solve(const hk_host *host, const hk_dense_path *path, double *x) {
  hk_supernodal s = {0};
  assert_int_equal(hk_supernodal_open(&s, host, path->number == sizeof(float)), HK_OK);
  s.path = path;
  assert_int_equal(hk_supernodal_analyze(&s, &A, HK_ORDER_BEST), HK_OK);
  assert_int_equal(hk_supernodal_factorize(&s, &A), HK_OK);
  hk_supernodal_solve(&s, b, x);
  hk_supernodal_close(&s);
}

/* NULL: not of this processor. */
static const hk_dense_path *path_of(bool single, int lanes) {
  if (lanes > hk_processor_lanes()) return NULL;
  return single ? hk_dense_single(lanes) : hk_dense_double(lanes);
}

/* |b - A x| is some eps |A||x|, and |A||x|/|b| at most the condition number. */
static void every_path_solves(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  static double x[3][UNKNOWNS];
  make_grid();
  for (int single = 0; single < 2; single++) {
    const hk_dense_path *paths[] = {path_of(single, 8), path_of(single, 4), path_of(single, 2)};
    for (int k = 0; k < 3; k++) {
      if (!paths[k]) continue;
      solve(&f->host, paths[k], x[k]);
      double left = residual(x[k]), limit = 1e4 * (single ? 0x1p-24 : 0x1p-53);
      if (!(left <= limit)) fail_msg("%s, %zu bytes: %g", paths[k]->name, paths[k]->number, left);
    }
    if (paths[0] && paths[1]) assert_memory_equal(x[0], x[1], sizeof x[0]);
  }
  fake_system_destroy(f);
}

/* Every supernode is in one branch or at the top, and what is in a branch has its descendants there. */
static void branches_cover_the_tree(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  hk_supernodal s = {0};
  make_grid();
  assert_int_equal(hk_supernodal_open(&s, &f->host, false), HK_OK);
  assert_int_equal(hk_supernodal_analyze(&s, &A, HK_ORDER_BEST), HK_OK);
  const hk_supernodes *n = &s.nodes;
  int *of = calloc(n->count, sizeof *of);
  assert_true(n->branches > 2);
  for (size_t k = 0; k + 1 < n->branches; k++)
    for (uint32_t i = n->branch[k].begin; i < n->branch[k].end; i++) of[i] += (int)k + 1;
  for (uint32_t i = 0; i < n->branch[n->branches - 1].end; i++) of[n->top[i]] += 1000;
  for (size_t i = 0; i < n->count; i++) {
    assert_true(of[i] > 0 && of[i] <= 1000);
    for (size_t c = n->node[i].child; c < n->node[i].child_end; c++)
      assert_true(of[i] == 1000 || of[n->child[c]] == of[i]);
  }
  free(of);
  hk_supernodal_close(&s);
  fake_system_destroy(f);
}

enum { UNTOUCHED = 12345 };

/* Branches that are factorized when the diagonal of `row` is negative, which the message names. */
static size_t branches_until(hk_supernodal *s, size_t row) {
  size_t tried = 0, at = row_start[row];
  while (column[at] != row) at++;
  double good = value[9 * at];
  value[9 * at] = -1;
  for (size_t k = 0; k < s->nodes.branches; k++) s->bad[k] = UNTOUCHED;
  assert_int_equal(hk_supernodal_factorize(s, &A), HK_NOT_CONVERGED);
  for (size_t k = 0; k < s->nodes.branches; k++) tried += s->bad[k] != UNTOUCHED;
  value[9 * at] = good;
  return tried;
}

/* The grid's row of which the branch has the first column. */
static size_t row_of(const hk_supernodal *s, size_t branch) {
  return s->nodes.order[s->nodes.node[s->nodes.branch[branch].begin].first];
}

/* The branch that was bad last is tried first: one branch is enough where it is bad again, also after a matrix that was
 * definite. The factor of a definite matrix has the same bits in every order of the branches. */
static void what_was_not_definite_is_tried_first(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = 1});
  static double x[2][UNKNOWNS];
  hk_supernodal s = {0};
  make_grid();
  assert_int_equal(hk_supernodal_open(&s, &f->host, false), HK_OK);
  assert_int_equal(hk_supernodal_analyze(&s, &A, HK_ORDER_BEST), HK_OK);
  size_t branches = s.nodes.branches - 1;
  assert_true(branches > 2);
  for (int k = 0; k < 2; k++) {
    assert_int_equal(hk_supernodal_factorize(&s, &A), HK_OK);
    hk_supernodal_solve(&s, b, x[k]);
    assert_int_equal(branches_until(&s, row_of(&s, branches - 1)), k == 0 ? branches : 1);
    assert_int_equal(branches_until(&s, row_of(&s, branches - 1)), 1);
    assert_int_equal(branches_until(&s, row_of(&s, 0)), 2);
    assert_int_equal(branches_until(&s, row_of(&s, branches - 1)), 2);
  }
  assert_memory_equal(x[0], x[1], sizeof x[0]);
  hk_supernodal_close(&s);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_path_solves),
      cmocka_unit_test(branches_cover_the_tree),
      cmocka_unit_test(what_was_not_definite_is_tried_first),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
