/* What springs state of a bilinear form of their blocks are its derivatives, with every wish and with tensions that
 * were foretold. */
#include "tests/support/engine.h"

#include "core/engine/contract/contract.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 4, V = 3 * N, ALL = 4 * V };

/* Springs that are drawn and pressed, one without a rest length, damped. */
static void open_springs(test_engine *e) {
  test_engine_open(e);
  for (uint32_t i = 0; i < N; i++) test_particle(e, cos(2. * i), sin(3. * i), 0.4 * i, 1);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}, {4, 1}}, 4);
  test_list(e, springs, "k", (const double[]){5, 7, 4, 6}, 4);
  test_list(e, springs, "rest", (const double[]){0.3, 4, 0, 3.5}, 4);
  test_number(e, springs, "damping", 0.6);
  e->options.integrator = "linear_bdf2";
  test_run(e);
}

static void fill(double *list, size_t count, double by) {
  for (size_t k = 0; k < count; k++) list[k] = sin(by * (double)(k + 1)) + 0.1 * (double)(k % 5);
}

/* u.(by_x K + by_v D) w at a point: x, v, the positions of the linearisation and those that were reached. */
static double form_at(test_engine *e, const hk_bilinear *form, const double *point) {
  hk_dynamics *d = &e->run->dynamics;
  double X[2 * V + 1], sum = 0;
  hk_matrix K, D;
  memcpy(X, point, 2 * V * sizeof *X);
  d->linear.linearised = form->linearised ? point + 2 * V : NULL;
  d->linear.reached = form->linearised ? point + 3 * V : NULL;
  assert_int_equal(d->linear.jacobian(&d->system, 0, X, form->want, &K, &D), HK_OK);
  d->linear.linearised = d->linear.reached = NULL;
  for (size_t i = 0; i < N; i++)
    for (size_t b = K.row_start[i]; b < K.row_start[i + 1]; b++)
      for (size_t q = 0; q < 9; q++)
        sum += form->u[3 * i + q / 3] * form->w[3 * (size_t)K.column[b] + q % 3] *
               (form->by_x * K.value[9 * b + q] + form->by_v * D.value[9 * b + q]);
  return sum;
}

/* Central differences of 1e-5 leave 1e-10 of third derivatives, and eps/1e-5. */
static void compare(test_engine *e, unsigned want, bool foretold) {
  hk_instance *force = e->run->dynamics.plugins->kind[HK_FORCE].item[0];
  double point[ALL], u[V], w[V], by[ALL] = {0};
  fill(point, ALL, 1.3);
  fill(u, V, 2.1);
  fill(w, V, 0.7);
  const hk_bilinear form = {.want = want,
                            .linearised = foretold ? point + 2 * V : NULL,
                            .reached = foretold ? point + 3 * V : NULL,
                            .by_x = 0.4,
                            .by_v = 1.7,
                            .u = u,
                            .w = w,
                            .by_linearised = by + 2 * V,
                            .by_reached = by + 3 * V};
  const hk_view view = hk_force_view_at(&e->run->dynamics, 0, 0, point, N);
  const hk_transposed into = {by, by + V, NULL, NULL};
  assert_int_equal(hk_force_of(force->plugin)->implicit.bilinear(force->self, &view, &form, &into), HK_OK);
  for (size_t k = 0; k < ALL; k++) {
    double before = point[k], value[2];
    for (int side = 0; side < 2; side++) {
      point[k] = before + (side ? 1e-5 : -1e-5);
      value[side] = form_at(e, &form, point);
    }
    point[k] = before;
    double slope = (value[1] - value[0]) / 2e-5;
    if (!(fabs(by[k] - slope) < 1e-8 * (1 + fabs(slope))))
      fail_msg("want %u, %s, number %zu: %g, not %g", want, foretold ? "foretold" : "not foretold", k, by[k], slope);
  }
}

static void a_form_of_the_blocks_has_these_derivatives(void **state) {
  (void)state;
  test_engine e;
  open_springs(&e);
  for (int foretold = 0; foretold < 2; foretold++) {
    compare(&e, 0, foretold);
    compare(&e, HK_WANT_SYMMETRIC, foretold);
    compare(&e, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE, foretold);
  }
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_form_of_the_blocks_has_these_derivatives)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
