/* The surface tension of a liquid by particles: the energy of its surfaces, the pressure within it, how drops become
 * round, its gradient and blocks, and what walls hold of it. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { SIDE = 10, N = SIDE * SIDE * SIDE };
static const double dx = 0.1, rho0 = 1000, sigma = 0.7; /* m, kg/m^3, N/m */

static hk_plugin_spec *tension(test_engine *e, int dimensions, double angle) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "surface_tension");
  test_number(e, spec, "tension", sigma);
  test_number(e, spec, "angle", angle);
  test_number(e, spec, "spacing", dx);
  test_number(e, spec, "dimensions", dimensions);
  e->options.dt = 1e-4;
  return spec;
}

/* A lattice, stretched by a factor, each place shaken by a part of the spacing. */
static void fill(test_engine *e, int dimensions, double stretch, double shake) {
  uint64_t seed[4];
  hk_random_seed(seed, 5);
  for (int i = 0; i < (dimensions == 3 ? N : SIDE * SIDE); i++) {
    double x[3];
    for (int c = 0, at = i; c < 3; c++, at /= SIDE)
      x[c] = dx * stretch * (at % SIDE + shake * (hk_random_uniform(seed) - 0.5));
    test_particle(e, x[0], x[1], dimensions == 3 ? x[2] : 0, rho0 * dx * dx * dx);
  }
}

static hk_view view_of(test_engine *e, const hk_plugin_spec *spec, hk_instance **force) {
  test_run(e);
  *force = test_instance(e, spec);
  return force_view(e, *force);
}

/* J: of a lattice that repeats along those axes. */
static double energy_of(int dimensions, double stretch, const char *axes) {
  test_engine e;
  hk_instance *force;
  const double side = SIDE * dx * stretch, low[3] = {0}, high[3] = {side, side, side};
  test_engine_open(&e);
  fill(&e, dimensions, stretch, 0);
  assert_int_equal(hk_scene_set_box(e.scene, low, high, axes, &e.error), HK_OK);
  hk_plugin_spec *spec = tension(&e, dimensions, 90);
  hk_view view = view_of(&e, spec, &force);
  double energy = force->plugin->force->energy(force->self, &view);
  test_engine_close(&e);
  return energy;
}

/* Of a cut along the lattice's own planes; the mean over all directions is the tension, from which those planes, the
 * smoothest, are off by some percents. A liquid in a plane is one spacing deep. */
static void a_surface_has_the_energy_of_the_tension(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    double area = 2 * SIDE * dx * (dimensions == 3 ? SIDE * dx : dx); /* m^2, of both sides */
    double more = energy_of(dimensions, 1, dimensions == 3 ? "xy" : "x") -
                  energy_of(dimensions, 1, dimensions == 3 ? "xyz" : "xy");
    double part = more / (area * sigma);
    if (!(part > 0.93 && part < 1.07)) fail_msg("%d dimensions: %g of the tension", dimensions, part);
  }
}

/* The pressure within, -dE/dV, is minus tension/spacing, as far as differences show it. */
static void the_liquid_holds_itself_together(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    const char *axes = dimensions == 3 ? "xyz" : "xy";
    double h = 1e-3, volume = pow(SIDE, dimensions) * pow(dx, dimensions == 3 ? 0 : 1) * pow(dx, dimensions);
    double wide = energy_of(dimensions, 1 + h, axes), close = energy_of(dimensions, 1 - h, axes);
    double pressure = -(wide - close) / (2 * h * dimensions * volume);
    if (!(fabs(pressure * dx / sigma + 1) < 1e-4)) fail_msg("%d dimensions: %g Pa", dimensions, pressure);
  }
}

/* A square of 36 particles, with the liquid's pressure and much viscosity. The farthest particle of such a square is at
 * 1.46 of the RMS distance, that of a disc at 1.41 less half a spacing; the area is that of a disc of the RMS distance.
 */
static void a_square_becomes_round(void **state) {
  (void)state;
  enum { ROW = 6 };
  const double strong = 70, mass = rho0 * dx * dx * dx, normal[3] = {0, 0, 1}; /* N/m: 10 sqrt(70/(1000 dx)) = 8 m/s */
  test_engine e;
  double far = 0, square = 0;
  test_engine_open(&e);
  for (int i = 0; i < ROW * ROW; i++)
    test_pin(&e, HK_PIN_PLANE, test_particle(&e, dx * (i % ROW - 2.5), dx * (i / ROW - 2.5), 0, mass), normal);
  test_number(&e, tension(&e, 2, 90), "tension", strong);
  hk_plugin_spec *specs[2] = {test_plugin(&e, HK_FORCE, "sph"), test_plugin(&e, HK_FORCE, "viscosity")};
  for (int k = 0; k < 2; k++) {
    test_number(&e, specs[k], "spacing", dx);
    test_number(&e, specs[k], "dimensions", 2);
  }
  test_number(&e, specs[0], "c", 12);
  test_number(&e, specs[1], "mu", 60);
  e.options.dt = 4e-3;
  e.scene->fps = 10;
  e.scene->duration = 1;
  test_run(&e);
  test_advance(&e, 1);
  for (uint32_t id = 1; id <= ROW * ROW; id++) {
    const double *x = test_position(&e, id);
    double r2 = x[0] * x[0] + x[1] * x[1];
    far = fmax(far, sqrt(r2));
    square += r2 / (ROW * ROW);
  }
  double area = 2 * acos(-1) * square / (ROW * ROW * dx * dx);
  if (!(far < 1.42 * sqrt(square) && fabs(area - 1) < 0.15))
    fail_msg("%g of the RMS, %g of the area", far / sqrt(square), area);
  test_engine_close(&e);
}

static void force_energy_blocks_and_momenta_belong_together(void **state) {
  (void)state;
  enum { FEW = 12 };
  const double none[3] = {0};
  test_engine e;
  hk_instance *force;
  double F[3 * FEW], sum[3] = {0}, turn[3] = {0};
  uint64_t seed[4];
  hk_random_seed(seed, 7);
  test_engine_open(&e);
  for (int i = 0; i < FEW; i++) {
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = 2.5 * dx * hk_random_uniform(seed);
    uint32_t id = test_particle(&e, x[0], x[1], x[2], rho0 * dx * dx * dx);
    if (i < 3) test_pin(&e, HK_PIN_FIXED, id, none);
  }
  hk_plugin_spec *spec = tension(&e, 3, 60);
  hk_view view = view_of(&e, spec, &force);
  force_evaluate(force, &view, F);
  for (size_t i = 0; i < FEW; i++)
    for (size_t c = 0; c < 3; c++) {
      const double *x = view.x + 3 * i, *f = F + 3 * i;
      sum[c] += f[c];
      turn[c] += x[(c + 1) % 3] * f[(c + 2) % 3] - x[(c + 2) % 3] * f[(c + 1) % 3];
    }
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-13 * sigma * dx && fabs(turn[c]) < 1e-13 * sigma * dx);
  double gradient = force_gradient_error(force, &view), stiffness = force_stiffness_error(force, &view);
  if (!(gradient < FORCE_DIFFERENCES && stiffness < FORCE_DIFFERENCES))
    fail_msg("gradient %g, blocks %g", gradient, stiffness);
  test_engine_close(&e);
}

/* N: on one particle beside another that is free or pinned. */
static double pull_between(bool wall, double angle) {
  test_engine e;
  hk_instance *force;
  const double none[3] = {0};
  double F[6];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, rho0 * dx * dx * dx);
  uint32_t id = test_particle(&e, 2.2 * dx, 0, 0, rho0 * dx * dx * dx);
  if (wall) test_pin(&e, HK_PIN_FIXED, id, none);
  hk_plugin_spec *spec = tension(&e, 3, angle);
  test_number(&e, spec, "wall_volume", dx * dx * dx);
  hk_view view = view_of(&e, spec, &force);
  force_evaluate(force, &view, F);
  test_engine_close(&e);
  return F[0];
}

/* Young and Dupre: of the work of cohesion walls have (1 + cos angle)/2. */
static void walls_pull_by_the_angle_of_contact(void **state) {
  (void)state;
  double whole = pull_between(false, 90);
  assert_true(whole > 0);
  assert_true(fabs(pull_between(true, 0) - whole) < 1e-14 * whole);
  assert_true(fabs(pull_between(true, 60) - 0.75 * whole) < 1e-14 * whole);
  assert_true(fabs(pull_between(true, 180)) < 1e-14 * whole);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_surface_has_the_energy_of_the_tension),
      cmocka_unit_test(the_liquid_holds_itself_together),
      cmocka_unit_test(a_square_becomes_round),
      cmocka_unit_test(force_energy_blocks_and_momenta_belong_together),
      cmocka_unit_test(walls_pull_by_the_angle_of_contact),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
