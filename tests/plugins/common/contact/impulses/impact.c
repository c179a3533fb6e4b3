/* What an impact is for the solver: contact that lasts is told from an impact by gaps and speeds that errors of the
 * last step cannot make. */
#include "plugins/common/contact/impulses/impact.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static const double h = 1e-3, distance = 0.01, near = 1e-9; /* s, m, m */

/* Two edges across each other, as particles, whose gap is `gap` m at the start and changes at `speed` m/s, while the
 * upper one slides by `slide` m. Returns whether their contact lasts. */
static bool lasts(double gap, double speed, double slide, hk_impact *k) {
  double x_from[12] = {0}, v[12] = {0}, x[12];
  const double inverse_mass[4] = {1, 1, 1, 1};
  for (int i = 0; i < 2; i++) x_from[3 * i + 2] = distance + gap, v[3 * i + 2] = speed;
  for (int i = 0; i < 12; i++) x[i] = x_from[i] + h * v[i];
  x[0] += slide, x[3] += slide;
  hk_step_move move = {h, x_from, v, x, v, inverse_mass};
  *k = (hk_impact){.pair = {{0, 1, 2, 3}, HK_EDGE_EDGE, distance, gap}, .frame = {{0.5, 0.5, -0.5, -0.5}, {0, 0, 1}}};
  hk_impact_set(k, &move, 0, false);
  return hk_impact_last(k, &move, near);
}

/* Of a gap of 1e-13 m that opens or closes by as much: friction acts on the slide of the whole step in either case, and
 * the end of the step may not overlap. */
static void errors_of_a_gap_are_contact_that_lasts(void **state) {
  (void)state;
  hk_impact k;
  for (int sign = -1; sign <= 1; sign++) {
    assert_true(lasts(1e-13, sign * 1.5e-10, 1e-6, &k));
    assert_true(k.place.origin[0] == 0);
    double end = k.place.origin[2] + k.place.target; /* of the distance: at most what it was or would be, whichever */
    assert_true(end >= distance - 1e-15 && end <= distance + 3e-13);
  }
}

static void what_lands_or_parts_is_none(void **state) {
  (void)state;
  hk_impact k;
  assert_false(lasts(1e-13, -1e-3, 1e-6, &k)); /* it lands at 1 mm/s */
  assert_true(k.speed_then < 0);
  assert_false(lasts(1e-13, 1e-3, 1e-6, &k)); /* it parts */
  assert_true(k.place.origin[0] == 1e-6);
  assert_false(lasts(1e-6, -1e-9, 1e-6, &k)); /* it is not there yet */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(errors_of_a_gap_are_contact_that_lasts),
                                     cmocka_unit_test(what_lands_or_parts_is_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
