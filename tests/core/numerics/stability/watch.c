/* The watch between estimates: it reports that what the forces state has risen, and raises the spectrum in proportion.
 */
#include "core/numerics/stability/stability.h"
#include "tests/support/network.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <cmocka.h>

enum { N = 20 };

static double scratch[N + 2][6];

/* A chain between fixed ends, along x. */
static spring_network *chain(void) {
  spring_network *w = network_create(N + 2, N + 1, false);
  for (size_t i = 0; i < N + 2; i++) {
    network_place(w, i, 0.1 * (double)i, 0, 0);
    if (i > 0) network_join(w, i - 1, i, 100, 1);
  }
  network_fix(w, 0);
  network_fix(w, N + 1);
  w->covered = true;
  return w;
}

static hk_spectrum estimate(spring_network *w, hk_watch *watch) {
  hk_spectrum s;
  hk_error error = {0};
  assert_int_equal(hk_spectrum_estimate(&w->system, &s, &error), HK_OK);
  hk_watch_begin(watch, &w->system, scratch, 0, 0);
  return s;
}

static void stiffen(spring_network *w, double factor) {
  for (size_t e = 0; e < w->edges; e++) w->stiffness[e] *= factor, w->damping[e] *= factor;
}

/* Two looks: where velocities matter every other one is at the damping. */
static bool rises(spring_network *w, hk_watch *watch) {
  bool one = hk_watch_measure(watch, &w->system, scratch, 0, watch->next);
  return hk_watch_measure(watch, &w->system, scratch, 0, watch->next) || one;
}

static void what_stays_is_no_rise(void **state) {
  (void)state;
  spring_network *w = chain();
  hk_watch watch = {0};
  estimate(w, &watch);
  for (int k = 0; k < 20; k++) assert_false(rises(w, &watch));
  stiffen(w, 0.5);
  assert_false(rises(w, &watch));
  assert_true(watch.every > 100); /* nothing changes: looks are rare */
  network_destroy(w);
}

/* The raised spectrum bounds the new modes: 4 k/m is the bound of w^2, and of the damping rate with c for k. */
static void a_rise_raises_the_spectrum(void **state) {
  (void)state;
  spring_network *w = chain();
  hk_watch watch = {0};
  hk_spectrum s = estimate(w, &watch);
  stiffen(w, 1.3);
  assert_true(rises(w, &watch));
  hk_watch_raise(&watch, &s);
  double exact = network_largest_stiffness(w), damping = network_largest_damping(w);
  print_message("raised to %.3f of w^2, %.3f of g\n", s.w_max * s.w_max / exact, s.g_max / damping);
  assert_true(s.w_max * s.w_max >= exact && s.g_max >= damping);
  assert_false(rises(w, &watch)); /* it has headroom */
  network_destroy(w);
}

/* A rise by 1 % from look to look is reported before the bound is passed by the 2 % that count as none. */
static void a_slow_rise_is_seen_in_time(void **state) {
  (void)state;
  spring_network *w = chain();
  hk_watch watch = {0};
  estimate(w, &watch);
  double begin = w->stiffness[0];
  while (!rises(w, &watch)) stiffen(w, 1.01);
  assert_true(w->stiffness[0] <= 1.02 * begin);
  network_destroy(w);
}

static void where_a_force_states_nothing_there_is_no_measurement(void **state) {
  (void)state;
  spring_network *w = chain();
  hk_watch watch = {0};
  w->covered = false;
  estimate(w, &watch);
  stiffen(w, 4);
  assert_false(rises(w, &watch));
  assert_true(watch.measurements == 0);
  network_destroy(w);
}

/* Symplectic methods take a part of the step that contacts allow, which shortens with the others'. */
static void contacts_stiffen_with_the_scene(void **state) {
  (void)state;
  hk_watch w = {.allowed = {true, 100, 1, 0}, .expected = {true, 400, 1, 0}};
  hk_spectrum s = {.w_max = 10, .w_switching = 8};
  hk_watch_raise(&w, &s);
  assert_true(fabs(s.w_max - 10 * sqrt(4.2)) < 1e-12 && fabs(s.w_switching - 8 * sqrt(4.2)) < 1e-12);
}

/* All that stiffened may be what nothing damps: g >= 0.01 w^2 - 1 becomes 0.01 (w^2 - 110) - 1, with 5 % of headroom.
 */
static void what_stiffens_counts_as_undamped(void **state) {
  (void)state;
  hk_watch w = {.allowed = {true, 100, 1, 0}, .expected = {true, 200, 1, 0}};
  hk_spectrum s = {.w_max = 10, .g_max = 1, .damped = {{0.01, 1}}};
  hk_watch_raise(&w, &s);
  assert_true(fabs(s.damped[0].offset - (1 + 0.01 * 110)) < 1e-12 && s.damped[0].slope == 0.01);
}

/* Where steps cost more, as in contact: the longest interval, and the price of a look, are a tenth. */
static void looks_may_be_more_frequent(void **state) {
  (void)state;
  spring_network *w = chain();
  hk_watch rare = {0}, often = {.often = 10};
  estimate(w, &rare);
  estimate(w, &often);
  for (int k = 0; k < 40; k++) assert_false(rises(w, &rare) || rises(w, &often));
  assert_int_equal(rare.every, 1024);
  assert_int_equal(often.every, 102);
  network_destroy(w);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(looks_may_be_more_frequent),
      cmocka_unit_test(what_stays_is_no_rise),
      cmocka_unit_test(a_rise_raises_the_spectrum),
      cmocka_unit_test(a_slow_rise_is_seen_in_time),
      cmocka_unit_test(where_a_force_states_nothing_there_is_no_measurement),
      cmocka_unit_test(contacts_stiffen_with_the_scene),
      cmocka_unit_test(what_stiffens_counts_as_undamped),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
