/* What slides over an edge at the thickness and falls a little below it on its way, as a step does before the surface
 * beside the edge holds it, does not collide with the edge; what comes deep does, by the normal of the instant at which
 * it gets there. */
#include "plugins/common/contact/impulses/narrow_phase.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const double thickness = 1e-3;

/* A particle passes over the middle of an edge along y, from `before` to `after` thicknesses beside it, and falls from
 * the height of the thickness by `fall` of it. */
static hk_narrow_phase passed(double before, double after, double fall) {
  static const double nothing[9];
  double from[9] = {before * thickness, 0.1e-3, (1 + 1e-9) * thickness, 0, -1, 0, 0, 1, 0}, to[9], v[9] = {0};
  for (int i = 0; i < 9; i++) to[i] = from[i];
  to[0] = after * thickness;
  to[2] -= fall * thickness;
  v[0] = (to[0] - from[0]) / 1e-3, v[2] = 2 * (to[2] - from[2]) / 1e-3;
  hk_step_move move = {1e-3, from, nothing, to, v, nothing};
  hk_feature_pair pair = {{0, 0, 1, 2}, HK_EDGE_EDGE, thickness, 0};
  return hk_narrow_phase_of(&pair, &move, 0.01 * thickness, 0);
}

static void what_slides_over_an_edge_does_not_collide_with_it(void **state) {
  (void)state;
  const double falls[] = {1e-6, 0.005, 0.02, 0.08};
  for (int k = 0; k < 4; k++) {
    hk_narrow_phase p = passed(-0.9, 0.8, falls[k]);
    assert_false(p.on_the_way);
    assert_int_equal(p.state, HK_PAIR_APART);
    /* It ends above the edge: by what it overlaps, along the normal there. */
    p = passed(-1.2, 0, falls[k]);
    assert_false(p.on_the_way);
    assert_int_equal(p.state, falls[k] < 0.01 ? HK_PAIR_CLOSES : HK_PAIR_OVERLAPS);
    assert_float_equal(p.frame.n[2], 1, 1e-12);
  }
}

static void what_comes_deep_collides_on_the_way(void **state) {
  (void)state;
  hk_narrow_phase p = passed(-1.2, 0.6, 0.6);
  assert_true(p.on_the_way);
  assert_int_equal(p.state, HK_PAIR_OVERLAPS);
  assert_true(p.frame.n[0] < -0.3); /* it is still beside the edge */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_slides_over_an_edge_does_not_collide_with_it),
                                     cmocka_unit_test(what_comes_deep_collides_on_the_way)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
