/* The strain of an element, that of edges and that of elements with numbers of their own, and the figure of a run,
 * which is the largest of all its elements by magnitude. Lengths are those of the triangle 3, 4, 5, exact. */
#include "core/plugin/strain.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double x[9] = {0, 0, 0, 3, 4, 0, 3, 0, 0};

static void an_edge_is_strained_by_its_length(void **state) {
  (void)state;
  const uint32_t pair[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  double rest[3] = {4, 8, 0};
  hk_elements e = {.node = {3, 2, pair[0]}, .values = 1, .rest = {3, rest}};
  assert_true(hk_elements_strained(&e));
  assert_true(hk_element_strain(&e, x, 0) == 0.25 && hk_element_strain(&e, x, 1) == -0.5);
  assert_true(!hk_element_is_strained(&e, 2) && isnan(hk_element_strain(&e, x, 2)));
  e.rest.count = 0;
  assert_false(hk_elements_strained(&e));
}

static void evaluate(const void *self, const double *at, size_t begin, size_t end, double *C, double (*dC)[3]) {
  (void)self, (void)at, (void)dC, (void)end;
  memcpy(C, (double[]){1, begin == 1 ? 0.5 : -3, 2}, 3 * sizeof *C);
}

static void of_several_numbers_the_largest_counts(void **state) {
  (void)state;
  const uint32_t triangle[2][3] = {{0, 1, 2}, {0, 1, 2}};
  double rest = 2;
  hk_elements e = {.node = {2, 3, triangle[0]}, .values = 3, .rest = {1, &rest}, .evaluate = evaluate};
  assert_true(hk_element_strain(&e, x, 0) == -1.5 && hk_element_strain(&e, x, 1) == 1);
}

static void the_figure_of_a_run_is_the_largest(void **state) {
  (void)state;
  test_engine e;
  double strain = 0;
  test_engine_open(&e);
  for (int i = 0; i < 3; i++) test_particle(&e, x[3 * i], x[3 * i + 1], x[3 * i + 2], 1);
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t[][2]){{1, 2}, {2, 3}, {1, 3}}, 3);
  test_number(&e, springs, "k", 1);
  test_list(&e, springs, "rest", (double[]){4, 8, 0}, 3);
  test_run(&e);
  assert_int_equal(hk_run_strain(e.run, NULL, &strain, &e.error), HK_OK);
  assert_true(strain == -0.5); /* the spring without a rest length has none */
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_edge_is_strained_by_its_length),
      cmocka_unit_test(of_several_numbers_the_largest_counts),
      cmocka_unit_test(the_figure_of_a_run_is_the_largest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
