/* One implicit step of heat between cells: its equations hold for steps of any length, what one cell gives another
 * gets, and none becomes warmer than the warmest. */
#include "plugins/common/heat/implicit_heat.h"
#include "tests/support/engine.h"
#include "tests/support/plain_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 12, CELLS = SIDE * SIDE };

static const hk_heat_law wax = {319, 329, 2e5, {2000, 2200}, {0.24, 0.15}},
                         ice = {273.15, 273.15, 333600, {2100, 4220}, {2.16, 0.561}},
                         plain = {NAN, NAN, NAN, {500, 500}, {3, 3}};

static hk_status failed(const hk_host *host, hk_status status, const char *format, ...) {
  (void)host;
  print_message("%s\n", format);
  return status;
}

static void in_one_piece(const hk_host *host, size_t count, size_t grain, void (*body)(void *, size_t, size_t, size_t),
                         void *context) {
  (void)host;
  for (size_t k = 0; k * grain < count; k++)
    body(context, k * grain, (k + 1) * grain < count ? (k + 1) * grain : count, k);
}

static double at_random(unsigned *seed) {
  *seed = *seed * 1664525u + 1013904223u;
  return *seed / 4294967296.0;
}

/* A square of cells whose masses and enthalpies are at random, from cold to molten. */
static void lay(hk_implicit_heat *s, const hk_heat_law *law, unsigned seed) {
  s->rows = CELLS;
  s->law = law;
  for (size_t i = 0; i < CELLS; i++) {
    size_t at[2] = {i % SIDE, i / SIDE};
    s->mass[i] = 0.2 + at_random(&seed);
    s->before[i] = 1e6 * (at_random(&seed) - 0.3);
    s->wall_way[i] = s->source[i] = 0;
    for (int k = 0; k < HK_HEAT_SIDES; k++) {
      size_t axis = (size_t)k / 2, step = axis ? SIDE : 1;
      bool inside = axis < 2 && (k % 2 ? at[axis] + 1 < SIDE : at[axis] > 0);
      s->other[i][k] = (uint32_t)(inside ? (k % 2 ? i + step : i - step) : i);
      s->way[i][k] = inside ? 1 : 0;
    }
  }
}

static void equations_hold_for_any_step(void **state) {
  (void)state;
  const hk_host host = {
      .allocate = test_allocate, .release = test_release, .fail = failed, .parallel_for = in_one_piece};
  const hk_heat_law *law[] = {&wax, &ice, &plain};
  hk_implicit_heat s = {0};
  assert_int_equal(hk_implicit_heat_open(&s, &host, CELLS), HK_OK);
  for (int k = 0; k < 3; k++)
    for (double tau = 1; tau < 1e9; tau *= 30) {
      double warmest = -INFINITY, coldest = INFINITY, off = 0, sum = 0, size = 0;
      lay(&s, law[k], (unsigned)tau);
      s.tau = tau;
      assert_int_equal(hk_implicit_heat_solve(&s, 1e-9), HK_OK);
      for (size_t i = 0; i < CELLS; i++) {
        double theta = hk_heat_potential(law[k], s.before[i]);
        warmest = fmax(warmest, theta), coldest = fmin(coldest, theta);
        off = fmax(off, fabs(s.h[i] - s.before[i] - s.heat[i]));
        sum += s.mass[i] * s.heat[i], size += s.mass[i] * fabs(s.heat[i]);
      }
      for (size_t i = 0; i < CELLS; i++) assert_true(s.potential[i] <= warmest && s.potential[i] >= coldest);
      printf("tau %.2g s: equations off by %.2g J/kg, enthalpy by %.2g of what flowed; %d sweeps, %d steps, %d "
             "iterations\n",
             tau, off, sum / size, s.sweeps, s.steps, s.iterations);
      /* tolerance of the largest at the start, which grows with tau, and the rounding of flows, eps tau theta/M */
      assert_true(off < 1e-9 * 1e6 * (1 + tau * 8) + 1e-3);
      assert_true(fabs(sum) < 1e-13 * (size + tau * (warmest - coldest) * CELLS));
    }
  hk_implicit_heat_close(&s);
}

/* One cell at a wall: all of M (h - h0) = tau (g (theta_w - theta) + q), by hand. */
static void walls_and_sources_give(void **state) {
  (void)state;
  const hk_host host = {
      .allocate = test_allocate, .release = test_release, .fail = failed, .parallel_for = in_one_piece};
  hk_implicit_heat s = {0};
  assert_int_equal(hk_implicit_heat_open(&s, &host, 1), HK_OK);
  s.rows = 1, s.law = &plain, s.tau = 10;
  s.mass[0] = 2, s.before[0] = 100;
  s.wall_way[0] = 0.5, s.source[0] = 0.5 * 30 + 7;
  assert_int_equal(hk_implicit_heat_solve(&s, 1e-12), HK_OK);
  double h = (2 * 100 + 10 * 22.0) / (2 + 10 * 0.5 * 3 / 500);
  assert_true(fabs(s.h[0] - h) < 1e-12 * h && fabs(s.given[0] - (h - 100)) < 1e-12 * h && s.given[0] == s.heat[0]);
  hk_implicit_heat_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equations_hold_for_any_step),
      cmocka_unit_test(walls_and_sources_give),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
