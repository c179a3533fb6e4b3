/* The corrector liquid with the viscosity of melt: what is solid falls freely and keeps its shape where what is molten
 * spreads, and what does not fit together is refused. */
#include "tests/support/melting.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double cell = 0.05, latent = 3e5;

/* Gravity, and a corrector in a plane box for what melts, 1e7 Pa s when it is solid. */
static hk_plugin_spec *add_melt(test_engine *e) {
  hk_plugin_spec *gravity = test_plugin(e, HK_FORCE, "gravity"), *melt = test_plugin(e, HK_FORCE, "melt");
  test_vector(e, gravity, "g", 0, 0, -9.81);
  test_text(e, melt, "channel", "enthalpy");
  test_number(e, melt, "solidus", 273.15);
  test_number(e, melt, "latent", latent);
  test_number(e, melt, "capacity", 2000);
  test_number(e, melt, "viscosity", 1e-3);
  test_number(e, melt, "solid", 1e7);
  hk_plugin_spec *liquid = test_plugin(e, HK_CORRECTOR, "liquid");
  test_vector(e, liquid, "low", 0, 0, 0);
  test_vector(e, liquid, "high", 1, 0, 1);
  test_number(e, liquid, "cell", cell);
  test_text(e, liquid, "viscosity_of", "melt");
  return liquid;
}

/* A plane block of 0.3 m, at the height z, under gravity. Its enthalpy is h. */
static hk_plugin_spec *block(test_engine *e, double h, double z) {
  test_engine_open(e);
  e->options.integrator = "symplectic_euler";
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &h, NAN, NULL, &e->error), HK_OK);
  for (int i = 0; i < 12; i++)
    for (int k = 0; k < 12; k++)
      test_particle(e, 0.35 + (i + 0.5) * cell / 2, 0, z + (k + 0.5) * cell / 2, 1000 * cell * cell * cell / 4);
  return add_melt(e);
}

/* From rest all particles fall alike, to the rounding of a matrix whose numbers are h mu/(rho cell^2) = 3e4. */
static void what_is_solid_falls_freely(void **state) {
  (void)state;
  test_engine e;
  test_number(&e, block(&e, -1e4, 0.6), "tolerance", 1e-12);
  e.scene->fps = 50;
  test_run(&e);
  test_advance(&e, 0.1);
  double most = 0;
  for (uint32_t id = 1; id <= 144; id++) {
    const double *v = test_velocity(&e, id);
    most = fmax(most, hypot(v[0], v[2] + 0.981));
  }
  printf("solid: off free fall by %.2g m/s\n", most);
  assert_true(most < 1e-10);
  test_engine_close(&e);
}

/* 1/s, the rate at which the block turns, and m/s, by how much its particles are off a rigid motion, RMS. */
static double turning(test_engine *e, double *off) {
  double x[3] = {0}, v[3] = {0}, momentum = 0, inertia = 0, squares = 0;
  for (uint32_t id = 1; id <= 144; id++)
    for (int c = 0; c < 3; c++) x[c] += test_position(e, id)[c] / 144, v[c] += test_velocity(e, id)[c] / 144;
  for (uint32_t id = 1; id <= 144; id++) {
    const double *p = test_position(e, id), *u = test_velocity(e, id);
    momentum += (p[2] - x[2]) * (u[0] - v[0]) - (p[0] - x[0]) * (u[2] - v[2]);
    inertia += (p[2] - x[2]) * (p[2] - x[2]) + (p[0] - x[0]) * (p[0] - x[0]);
  }
  for (uint32_t id = 1; id <= 144; id++) {
    const double *p = test_position(e, id), *u = test_velocity(e, id), rate = momentum / inertia;
    squares += pow(u[0] - v[0] - rate * (p[2] - x[2]), 2) + pow(u[2] - v[2] + rate * (p[0] - x[0]), 2);
  }
  *off = sqrt(squares / 144);
  return momentum / inertia;
}

/* The grid at the surface, of 6 cells across, takes a few percent of the turning in a step, as it does of any liquid;
 * but what is left is that of a rigid body, to a twentieth of the corners' 0.2 m/s. */
static void what_is_solid_turns_as_a_whole(void **state) {
  (void)state;
  test_engine e;
  block(&e, -1e4, 0.6);
  for (uint32_t id = 1; id <= 144; id++) {
    const double *x = e.scene->particles.position + 3 * (size_t)(id - 1);
    double *v = e.scene->particles.velocity + 3 * (size_t)(id - 1);
    v[0] = x[2] - 0.75, v[2] = 0.5 - x[0];
  }
  e.scene->fps = 50;
  test_run(&e);
  for (int k = 0; k <= 5; k++) {
    double off = 0, rate;
    test_advance(&e, 0.02 * k);
    rate = turning(&e, &off);
    printf("at %g s: turns with %.4g/s, off a rigid motion by %.2g m/s\n", 0.02 * k, rate, off);
    assert_true(off < 0.01 && rate > 0.7);
  }
  test_engine_close(&e);
}

/* m: the width on the floor after half a second. */
static double width(double h) {
  test_engine e;
  block(&e, h, 0);
  e.scene->fps = 10;
  test_run(&e);
  test_advance(&e, 0.3);
  double least = 1, most = 0;
  for (uint32_t id = 1; id <= 144; id++) {
    least = fmin(least, test_position(&e, id)[0]);
    most = fmax(most, test_position(&e, id)[0]);
  }
  test_engine_close(&e);
  return most - least;
}

static void what_is_molten_spreads(void **state) {
  (void)state;
  double solid = width(-1e4), slush = width(latent / 3), molten = width(latent);
  printf("on the floor after 0.3 s: %.3g m solid, %.3g m a third molten, %.3g m molten\n", solid, slush, molten);
  assert_true(solid < 0.31 && slush < molten && molten > 0.6);
}

enum { ROW = 8, ALL = ROW * ROW * ROW };

/* m: the farthest that a particle of a solid block of 4 x 4 x 4 cells on a floor has moved in half a second; *steps:
 * how many it took. */
static double moved(double courant, int64_t *steps) {
  test_engine e;
  double h = -1e4, most = 0;
  test_engine_open(&e);
  e.options.integrator = "symplectic_euler";
  assert_int_equal(hk_scene_add_channel(e.scene, "enthalpy", 1, &h, NAN, NULL, &e.error), HK_OK);
  for (int i = 0; i < ROW; i++)
    for (int j = 0; j < ROW; j++)
      for (int k = 0; k < ROW; k++)
        test_particle(&e, 0.1 + (i + 0.5) * cell / 2, 0.1 + (j + 0.5) * cell / 2, (k + 0.5) * cell / 2,
                      1000 * cell * cell * cell / 8);
  hk_plugin_spec *liquid = add_melt(&e);
  test_vector(&e, liquid, "high", 0.4, 0.4, 0.4);
  test_number(&e, liquid, "courant", courant);
  e.scene->fps = 20;
  e.scene->duration = 1;
  test_run(&e);
  test_advance(&e, 0.5);
  for (uint32_t id = 1; id <= ALL; id++) {
    const double *x = e.scene->particles.position + 3 * (size_t)(id - 1), *y = test_position(&e, id);
    most =
        fmax(most, sqrt((y[0] - x[0]) * (y[0] - x[0]) + (y[1] - x[1]) * (y[1] - x[1]) + (y[2] - x[2]) * (y[2] - x[2])));
  }
  hk_summary s;
  hk_run_summary(e.run, &s);
  *steps = (int64_t)s.steps;
  test_engine_close(&e);
  return most;
}

/* Its particles creep by less than rho g H^2/mu t = 2e-5 m, in steps that are as long as a frame but for the first
 * ones, and with a courant of 8 as with 0.5. Those along its upright edges fell down by centimetres, and by the more
 * the longer the steps. */
static void a_solid_on_a_floor_keeps_its_edges(void **state) {
  (void)state;
  const double creeping = 1000 * 9.81 * 0.2 * 0.2 / 1e7 * 0.5;
  int64_t few, many;
  double usual = moved(0.5, &many), large = moved(8, &few);
  printf("solid: %.2g m in %d steps, %.2g m in %d, creeping to %.2g m\n", usual, (int)many, large, (int)few, creeping);
  assert_true(usual < creeping && large < creeping);
  assert_true(many <= 14 && few <= many);
}

static void refuses(test_engine *e, const char *sentence) {
  assert_int_equal(hk_run_open(e->scene, &e->options, &e->run, &e->error), HK_BAD_PARAM);
  if (!strstr(e->error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e->error.text);
  test_engine_close(e);
}

static void what_does_not_fit_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_text(&e, block(&e, 0, 0), "viscosity_of", "gravity");
  refuses(&e, "viscosity_of: nothing with the label 'gravity' publishes a local_viscosity of each particle");
  test_number(&e, block(&e, 0, 0), "viscosity", 1);
  refuses(&e, "viscosity: there are two, 1 Pa s and those of 'melt'");
}

/* A sheet falls and melts meanwhile: what is in no triangle any more is liquid, which the floor holds. Before it comes
 * there its momentum is that of free fall and its heat that which it was given, to rounding. */
static void what_a_sheet_lets_go_is_liquid(void **state) {
  (void)state;
  test_engine e;
  enum { COUNT = MELTING_SIDE * MELTING_SIDE };
  const double g = 9.81, growth = 400, t = 0.25, mass = 0.01;
  test_engine_open(&e);
  melting_sheet(&e, "melting_membrane", 280, 10); /* all has molten after 0.15 s */
  melting_warms(&e, growth);
  e.options.integrator = "symplectic_euler";
  e.scene->fps = 100;
  e.scene->duration = 1;
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -g);
  hk_plugin_spec *liquid = test_plugin(&e, HK_CORRECTOR, "liquid");
  test_vector(&e, liquid, "low", -0.4, -0.4, -0.8);
  test_vector(&e, liquid, "high", 0.8, 0.8, 0.4);
  test_number(&e, liquid, "cell", 0.1);
  test_run(&e);
  test_advance(&e, t);
  double momentum[3] = {0}, heat = 0;
  const hk_view *view = hk_run_view(e.run);
  for (uint32_t id = 1; id <= COUNT; id++) {
    for (int c = 0; c < 3; c++) momentum[c] += mass * test_velocity(&e, id)[c];
    heat += view->y[id - 1] - (230 + 10 * ((id - 1) / MELTING_SIDE) + growth * t);
  }
  print_message("off by %.2g, %.2g, %.2g N s and %.2g K\n", momentum[0], momentum[1],
                momentum[2] + COUNT * mass * g * t, heat);
  assert_true(fabs(momentum[0]) < 1e-13 && fabs(momentum[1]) < 1e-13);
  assert_true(fabs(momentum[2] + COUNT * mass * g * t) < 1e-12 && fabs(heat) < 1e-9);
  test_advance(&e, 0.8);
  for (uint32_t id = 1; id <= COUNT; id++)
    if (!(test_position(&e, id)[2] > -0.8)) fail_msg("%u is at %g m", (unsigned)id, test_position(&e, id)[2]);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_a_sheet_lets_go_is_liquid),     cmocka_unit_test(what_is_solid_falls_freely),
      cmocka_unit_test(what_is_solid_turns_as_a_whole),     cmocka_unit_test(what_is_molten_spreads),
      cmocka_unit_test(a_solid_on_a_floor_keeps_its_edges), cmocka_unit_test(what_does_not_fit_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
