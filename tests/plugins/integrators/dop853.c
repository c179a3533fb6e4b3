/* The tables of dop853, by the conditions of order of Butcher's trees: all 200 up to order 8 hold, so that a wrong
 * digit shows; its two estimates are of orders 5 and 3. The error follows the tolerance. */
#include "plugins/common/integrate/embedded.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { MOST_TREES = 600, STAGES = 13 };

/* Rooted trees by order, each with its elementary weight at every stage, phi_i = product over its branches of
 * sum_j a_ij phi_j(branch), and its density gamma (Hairer, Norsett and Wanner, Solving ODEs I, II.2). */
typedef struct tree {
  int order;
  double gamma, phi[STAGES];
} tree;

typedef struct forest {
  const hk_tableau *T;
  tree tree[MOST_TREES];
  int count;
} forest;

/* Grafts trees of index `from` and above onto a root, in order, until `order` vertices are there. */
static void graft(forest *f, tree root, int order, int from) {
  if (root.order == order) {
    root.gamma *= order;
    assert_true(f->count < MOST_TREES);
    f->tree[f->count++] = root;
    return;
  }
  for (int k = from, known = f->count; k < known; k++) {
    const tree *branch = &f->tree[k];
    if (root.order + branch->order > order) break; /* trees are in the sequence of their orders */
    tree more = root;
    more.order += branch->order;
    more.gamma *= branch->gamma;
    for (int i = 0; i < STAGES; i++) {
      double sum = 0;
      for (int j = 0; j < i; j++) sum += f->T->a[i][j] * branch->phi[j];
      more.phi[i] *= sum;
    }
    graft(f, more, order, k);
  }
}

static forest grow(const hk_tableau *T, int order) {
  forest f = {.T = T};
  tree root = {.order = 1, .gamma = 1};
  for (int i = 0; i < STAGES; i++) root.phi[i] = 1;
  for (int p = 1; p <= order; p++) graft(&f, root, p, 0);
  return f;
}

/* The largest |sum w_i phi_i - consistent/gamma| of the trees of an order. */
static double defect(const forest *f, const double *w, int order, double consistent) {
  double most = 0;
  for (int k = 0; k < f->count; k++) {
    if (f->tree[k].order != order) continue;
    double sum = 0;
    for (int i = 0; i < STAGES; i++) sum += w[i] * f->tree[k].phi[i];
    most = fmax(most, fabs(sum - consistent / f->tree[k].gamma));
  }
  return most;
}

static const hk_embedded *method_of(fake_method *m, fake_system **f) {
  *f = fake_system_create(&(fake_problem){1, 0, 0, NULL, NULL});
  *m = fake_method_open("dop853", *f);
  return m->plugin->integrator->method;
}

/* Weights are below 50, so that rounding leaves 1e-14; what does not hold is above 1e-6. */
static void the_table_has_order_eight(void **state) {
  (void)state;
  fake_method m;
  fake_system *f;
  const hk_embedded *method = method_of(&m, &f);
  static forest trees;
  trees = grow(method->tableau, 9);
  int up_to_eight = 0;
  for (int k = 0; k < trees.count; k++) up_to_eight += trees.tree[k].order <= 8;
  assert_int_equal(up_to_eight, 200);
  for (int p = 1; p <= 8; p++) assert_true(defect(&trees, method->tableau->b, p, 1) < 3e-15);
  assert_true(defect(&trees, method->tableau->b, 9, 1) > 1e-6);
  for (int i = 0; i < STAGES; i++) {
    double sum = 0;
    for (int j = 0; j < i; j++) sum += method->tableau->a[i][j];
    assert_true(fabs(sum - method->tableau->c[i]) < 2e-14);
  }
  assert_memory_equal(method->tableau->a[12], method->tableau->b, 12 * sizeof(double)); /* f at the end */
  fake_method_close(&m);
  fake_system_destroy(f);
}

static void the_estimates_have_orders_five_and_three(void **state) {
  (void)state;
  fake_method m;
  fake_system *f;
  const hk_embedded *method = method_of(&m, &f);
  static forest trees;
  trees = grow(method->tableau, 6);
  for (int p = 1; p <= 5; p++) assert_true(defect(&trees, method->weight, p, 0) < 1e-14);
  assert_true(defect(&trees, method->weight, 6, 0) > 1e-6);
  for (int p = 1; p <= 3; p++) assert_true(defect(&trees, method->second, p, 0) < 1e-14);
  assert_true(defect(&trees, method->second, 4, 0) > 1e-6);
  fake_method_close(&m);
  fake_system_destroy(f);
}

static void kepler(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  double r2 = x[0] * x[0] + x[1] * x[1], scale = r2 * sqrt(r2);
  a[0] = -x[0] / scale;
  a[1] = -x[1] / scale;
}

/* references.md 10.6: t = 10, e = 0.6. */
static double orbit_error(double tol, size_t *evaluations) {
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, kepler, NULL});
  double *X = f->system.X;
  X[0] = 0.4;
  X[4] = 2;
  f->system.tol = tol;
  fake_method m = fake_method_open("dop853", f);
  for (double h = INFINITY; f->system.t < 10;) {
    hk_step out = {0, 0, NAN};
    if (m.plugin->integrator->step(m.self, m.plugin->integrator->method, &f->system, 10, h, &out) != HK_OK)
      fail_msg("%s", f->message);
    f->system.t = out.h >= 10 - f->system.t ? 10 : f->system.t + out.h;
    h = out.h_next;
  }
  *evaluations = f->evaluations;
  double error = hypot(X[0] + 1.5350235919098137, X[1] + 0.28366840649978086);
  fake_method_close(&m);
  fake_system_destroy(f);
  return error;
}

/* Error per step is held, so the error at the end goes like tol, up to the orbit's own growth of errors, about 100 in
 * two revolutions. */
static void error_follows_the_tolerance(void **state) {
  (void)state;
  double before = INFINITY;
  for (double tol = 1e-4; tol > 0.5e-12; tol /= 100) {
    size_t evaluations;
    double error = orbit_error(tol, &evaluations);
    print_message("tol %.0e: error %.1e in %zu evaluations\n", tol, error, evaluations);
    assert_true(error < before && error > 0.01 * tol && error < 2000 * tol);
    before = error;
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_table_has_order_eight),
      cmocka_unit_test(the_estimates_have_orders_five_and_three),
      cmocka_unit_test(error_follows_the_tolerance),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
