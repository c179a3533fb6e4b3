/* A gas on a grid: what is carried comes back with an error of order 2 and within its bounds, fire and loss of heat are
 * those of their equations, sources fill a ball, and the projection leaves no divergence. */
#include "plugins/common/gas/gas_balance.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

typedef struct fixture {
  test_solver s; /* its host */
  hk_gas gas;
  double *kept;
} fixture;

/* A plane square of 1 m with n cells along a side, and heat, smoke and fuel. */
static fixture *open_fixture(size_t n) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  test_solver_open(&f->s, "pcg", 1);
  const hk_host *host = &f->s.solver->host;
  hk_gas *gas = &f->gas;
  gas->host = gas->flow.host = host;
  gas->flow.tolerance = 1e-10;
  gas->density = 1.2;
  gas->floor = gas->ceiling = NAN;
  assert_int_equal(
      hk_liquid_grid_open(&gas->flow.grid, host, (double[]){0, 0, 0}, (double[]){1, 0, 1}, 1.0 / (double)n, 1e9),
      HK_OK);
  assert_int_equal(hk_liquid_open(&gas->flow, host, 0), HK_OK);
  assert_int_equal(hk_gas_open_fields(gas, host), HK_OK);
  size_t size = gas->flow.grid.size;
  double *at = f->kept = calloc((HK_GAS_FIELDS + 4) * size, sizeof *at);
  assert_non_null(at);
  for (int k = 0; k < HK_GAS_FIELDS; k++, at += size) gas->now[k] = at, gas->carried[k] = k != 1;
  for (int c = 0; c < 3; c++, at += size) gas->before[c] = at;
  gas->impulse = at;
  return f;
}

static void close_fixture(fixture *f) {
  hk_gas_close(&f->gas);
  test_solver_close(&f->s);
  free(f->kept);
  free(f);
}

typedef double (*of_place)(const double x[3]);

static void fill(hk_gas *gas, int f, of_place value) {
  const hk_liquid_grid *g = &gas->flow.grid;
  for (size_t k = 0; k < hk_liquid_rows(g, 1); k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i <= row.first + g->cells[hk_liquid_inner(g)]; i++) {
      double x[3];
      if (!hk_gas_has(g, &row, i, f)) continue;
      hk_gas_point(g, &row, i, f, x);
      gas->now[f][i] = value(x);
    }
  }
}

static double turning_x(const double x[3]) { return -2 * pi * (x[2] - 0.5); }
static double turning_z(const double x[3]) { return 2 * pi * (x[0] - 0.5); }
static double blob(const double x[3]) {
  double dx = x[0] - 0.62, dz = x[2] - 0.5;
  return exp(-(dx * dx + dz * dz) / (2 * 0.1 * 0.1));
}
static double disc(const double x[3]) { return hypot(x[0] - 0.7, x[2] - 0.5) < 0.1; }

/* The RMS error after one turn, and by what part the sum has changed. */
static double turn(size_t n, of_place form, double *lost, double *least, double *most) {
  fixture *f = open_fixture(n);
  hk_gas *gas = &f->gas;
  size_t size = gas->flow.grid.size, steps = 2 * n;
  for (int k = 0; k < HK_GAS_FIELDS; k++) gas->carried[k] = k == HK_GAS_SMOKE;
  fill(gas, 0, turning_x);
  fill(gas, 2, turning_z);
  fill(gas, HK_GAS_SMOKE, form);
  double *start = malloc(size * sizeof *start), before = 0, after = 0, error = 0;
  assert_non_null(start);
  memcpy(start, gas->now[HK_GAS_SMOKE], size * sizeof *start);
  for (size_t k = 0; k < steps; k++) {
    hk_gas_begin(gas, 0);
    hk_gas_prepare(gas, 1.0 / (double)steps, 0);
    hk_gas_carry(gas, 1.0 / (double)steps);
  }
  *least = 1, *most = 0;
  for (size_t i = 0; i < size; i++) {
    double value = gas->now[HK_GAS_SMOKE][i];
    before += start[i], after += value;
    error += (value - start[i]) * (value - start[i]);
    *least = fmin(*least, value), *most = fmax(*most, value);
  }
  *lost = fabs(after / before - 1);
  free(start);
  close_fixture(f);
  return sqrt(error / (double)(n * n));
}

/* Found: 0.0226 and 0.00619, of order 1.87, since limits cut the top a little; the first step alone has 0.074 and
 * 0.047. The sum is off by 7e-4 and 5e-4, which is an error of the scheme. */
static void a_blob_comes_round_with_order_2(void **state) {
  (void)state;
  double lost[2], least, most;
  double coarse = turn(32, blob, lost, &least, &most), fine = turn(64, blob, lost + 1, &least, &most);
  if (!(coarse / fine > 3.4 && fine < 0.008)) fail_msg("errors of %.3g and %.3g", coarse, fine);
  if (!(lost[0] < 2e-3 && lost[1] < 8e-4)) fail_msg("sums are off by %.3g and %.3g", lost[0], lost[1]);
}

static void what_is_carried_stays_within_its_bounds(void **state) {
  (void)state;
  double lost, least, most;
  turn(32, disc, &lost, &least, &most);
  if (!(least >= 0 && most <= 1)) fail_msg("%.17g to %.17g", least, most);
}

/* Closed forms: fuel fades as exp(-rate h), dT/dt = -c T, and dT/dt = -r (T/1000)^4. 1e-12 is rounding. */
static void fire_and_loss_of_heat_are_exact(void **state) {
  (void)state;
  fixture *f = open_fixture(4);
  hk_gas *gas = &f->gas;
  const hk_liquid_grid *g = &gas->flow.grid;
  size_t hot = g->stride[0] + g->stride[1] + g->stride[2], cold = hot + g->stride[0];
  const double h = 0.1, heat = 1500;
  gas->burn_rate = 3, gas->burn_heat = 2000, gas->soot = 0.01, gas->ignition = 500;
  gas->now[HK_GAS_FUEL][hot] = gas->now[HK_GAS_FUEL][cold] = 0.4;
  gas->now[HK_GAS_HEAT][hot] = heat, gas->now[HK_GAS_HEAT][cold] = 100;
  hk_gas_burn(gas, h);
  double burnt = 0.4 * (1 - exp(-0.3));
  assert_true(fabs(gas->now[HK_GAS_FUEL][hot] - (0.4 - burnt)) < 1e-12);
  assert_true(fabs(gas->now[HK_GAS_HEAT][hot] - (heat + 2000 * burnt)) < 1e-9);
  assert_true(fabs(gas->now[HK_GAS_SMOKE][hot] - 0.01 * burnt) < 1e-12);
  assert_true(gas->now[HK_GAS_FUEL][cold] == 0.4 && gas->now[HK_GAS_HEAT][cold] == 100);
  gas->burn_rate = 0, gas->cooling = 2;
  gas->now[HK_GAS_HEAT][hot] = heat;
  hk_gas_burn(gas, h);
  assert_true(fabs(gas->now[HK_GAS_HEAT][hot] - heat * exp(-0.2)) < 1e-9);
  gas->cooling = 0, gas->radiation = 3000;
  gas->now[HK_GAS_HEAT][hot] = heat;
  hk_gas_burn(gas, h);
  double wanted = pow(pow(heat, -3) + 3 * 3000 * h * 1e-12, -1.0 / 3);
  assert_true(fabs(gas->now[HK_GAS_HEAT][hot] - wanted) < 1e-9);
  close_fixture(f);
}

/* The part of a cell in the ball is linear in the distance: the area of a disc of two cells or more within 2 %. */
static void a_source_fills_its_ball(void **state) {
  (void)state;
  fixture *f = open_fixture(32);
  hk_gas *gas = &f->gas;
  const hk_gas_source source = {.radius = 0.1, .time = 1e-6, .value = {[HK_GAS_SMOKE] = 0.5}};
  hk_gas_feed(gas, &source, (double[]){0.47, 0, 0.52}, 1e-6 * log(2)); /* half of it comes */
  double sum = 0;
  for (size_t i = 0; i < gas->flow.grid.size; i++) sum += gas->now[HK_GAS_SMOKE][i];
  double inside =
      gas->now[HK_GAS_SMOKE][16 * gas->flow.grid.stride[0] + 17 * gas->flow.grid.stride[2] + gas->flow.grid.stride[1]];
  assert_true(fabs(inside - 0.25) < 1e-12);
  assert_true(fabs(sum / 1024 / (0.25 * pi * 0.01) - 1) < 0.1);
  close_fixture(f);
}

static double rough(const double x[3]) { return sin(40 * x[0] + 3 * x[2]) + cos(17 * x[2] * x[0]); }

static void the_projection_leaves_no_divergence(void **state) {
  (void)state;
  fixture *f = open_fixture(24);
  hk_gas *gas = &f->gas;
  fill(gas, 0, rough);
  fill(gas, 2, rough);
  hk_gas_begin(gas, 0);
  hk_gas_walls(gas);
  assert_int_equal(hk_gas_project(gas, 0.01, 0), HK_OK);
  /* velocities of 2 m/s that differ from cell to cell: 2 x 2 x 24 1/s, and a tolerance of 1e-10 */
  if (!(gas->flow.left < 2e-8)) fail_msg("%.3g 1/s", gas->flow.left);
  close_fixture(f);
}

/* Within closed walls carrying changes the sum of smoke by what its scheme is off; fire turns fuel into heat and keeps
 * heat + burn_heat x fuel to rounding. */
static void sums_are_kept_as_the_figure_says(void **state) {
  (void)state;
  fixture *f = open_fixture(32);
  hk_gas *gas = &f->gas;
  hk_gas_balance balance = {.swelled = 0};
  assert_true(isnan(hk_gas_drift(&balance, gas)));
  for (int k = 0; k < 3; k++) gas->carried[k] = false; /* the flow stays as it is */
  fill(gas, 0, turning_x);
  fill(gas, 2, turning_z);
  fill(gas, HK_GAS_SMOKE, blob);
  double before = hk_gas_sum(gas, HK_GAS_SMOKE); /* of a Gaussian: 2 pi 0.1^2 */
  assert_true(fabs(before / (2 * pi * 0.01) - 1) < 0.01);
  for (int k = 0; k < 8; k++) {
    hk_gas_begin(gas, 0);
    hk_gas_prepare(gas, 1 / 64.0, 0);
    hk_gas_balance_before(&balance, gas);
    hk_gas_carry(gas, 1 / 64.0);
    hk_gas_balance_after(&balance, gas);
  }
  double moved = hk_gas_sum(gas, HK_GAS_SMOKE) - before;
  assert_true(moved != 0 && fabs(moved / before) < 0.01);
  assert_true(fabs(hk_gas_drift(&balance, gas) - moved / before) < 1e-2 * fabs(moved / before));
  fill(gas, HK_GAS_FUEL, blob);
  fill(gas, HK_GAS_HEAT, blob);
  gas->burn_rate = 3, gas->burn_heat = 2000, gas->ignition = 0;
  double whole = hk_gas_sum(gas, HK_GAS_HEAT) + 2000 * hk_gas_sum(gas, HK_GAS_FUEL),
         fuel = hk_gas_sum(gas, HK_GAS_FUEL);
  hk_gas_burn(gas, 0.1);
  assert_true(hk_gas_sum(gas, HK_GAS_FUEL) < 0.8 * fuel);
  assert_true(fabs(hk_gas_sum(gas, HK_GAS_HEAT) + 2000 * hk_gas_sum(gas, HK_GAS_FUEL) - whole) < 1e-13 * whole);
  gas->open[2][1] = true;
  assert_true(isnan(hk_gas_drift(&balance, gas)));
  close_fixture(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_blob_comes_round_with_order_2),  cmocka_unit_test(what_is_carried_stays_within_its_bounds),
      cmocka_unit_test(fire_and_loss_of_heat_are_exact),  cmocka_unit_test(a_source_fills_its_ball),
      cmocka_unit_test(sums_are_kept_as_the_figure_says), cmocka_unit_test(the_projection_leaves_no_divergence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
