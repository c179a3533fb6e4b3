/* FMA of each width rounds once or twice, as core/plugin/vector_math.h says: of (1 + e)(1 - e) - 1 with e = 2^-30 that
 * is -e^2 or 0. */
#include "core/engine/base/base.h"
#include "core/plugin/vector_math.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define HK_LOOPS "tests/core/plugin/vector_math_loops.h"
#include "core/plugin/each_width.h"

enum { MOST = 8 };

static void products_and_sums_round_once_where_it_says_so(void **state) {
#if defined(__aarch64__)
  const bool narrow = true;
#else
  const bool narrow = false;
#endif
  const double e = ldexp(1, -30);
  double a[MOST], b[MOST], c[MOST], out[MOST];
  (void)state;
  for (size_t i = 0; i < MOST; i++) a[i] = 1 + e, b[i] = 1 - e, c[i] = i % 2 ? -1 : (double)i;
  for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
    assert_int_equal(HK_WIDEST(lanes, fused)(a, b, c, out), lanes);
    for (size_t i = 0; i < (size_t)lanes; i++) {
      const double once = fma(a[i], b[i], c[i]), twice = i % 2 ? 0 : 1 + (double)i;
      assert_true(out[i] == (lanes > 2 || narrow ? once : twice));
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(products_and_sums_round_once_where_it_says_so)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
