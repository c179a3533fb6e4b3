/* What viscosity takes from a liquid's motion becomes its heat: all of it between particles, on a grid all but what the
 * grid itself takes; what does not fit together is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 16, N = SIDE * SIDE };

static const double dx = 1.0 / SIDE, pi = 3.14159265358979323846;

static void begin(test_engine *e) {
  double none = 0;
  test_engine_open(e);
  e->options.integrator = "symplectic_euler";
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &none, NAN, NULL, &e->error), HK_OK);
  for (int i = 0; i < SIDE; i++)
    for (int k = 0; k < SIDE; k++) test_particle(e, (i + 0.5) * dx, 0, (k + 0.5) * dx, 1000 * dx * dx * dx);
  e->scene->fps = 20;
}

/* To be called after the plugin whose dissipation it is, so that it has the present one. */
static void heat_of(test_engine *e, const char *label) {
  hk_plugin_spec *heat = test_plugin(e, HK_FORCE, "viscous_heating");
  test_text(e, heat, "channel", "enthalpy");
  test_text(e, heat, "of", label);
}

static double *velocity(test_engine *e, size_t i) { return e->scene->particles.velocity + 3 * i; }
static const double *place(test_engine *e, size_t i) { return e->scene->particles.position + 3 * i; }

/* J: kinetic energy and heat. */
static void energies(test_engine *e, double *kinetic, double *heat) {
  const hk_view *view = hk_run_view(e->run);
  *kinetic = *heat = 0;
  for (size_t i = 0; i < view->n; i++) {
    for (size_t c = 0; c < 3; c++) *kinetic += view->model->mass[i] * pow(view->v[3 * i + c], 2) / 2;
    *heat += view->model->mass[i] * view->y[i];
  }
}

static hk_plugin_spec *between_particles(test_engine *e) {
  begin(e);
  hk_plugin_spec *viscosity = test_plugin(e, HK_FORCE, "viscosity");
  test_number(e, viscosity, "spacing", dx);
  test_number(e, viscosity, "dimensions", 2);
  e->scene->box = (hk_periodic_box){{0, 0, 0}, {1, 1, 1}, {true, false, true}};
  for (uint32_t id = 1; id <= N; id++) test_pin(e, HK_PIN_PLANE, id, (double[]){0, 1, 0});
  for (size_t i = 0; i < N; i++) velocity(e, i)[0] = 0.01 * sin(2 * pi * place(e, i)[2]);
  e->options.integrator = "rk4";
  heat_of(e, "viscosity");
  return viscosity;
}

/* By rk4 both are integrals of one power, to its error of the step. */
static void of_particles_all_becomes_heat(void **state) {
  (void)state;
  test_engine e;
  double first, last, heat;
  test_number(&e, between_particles(&e), "mu", 10);
  test_run(&e);
  energies(&e, &first, &heat);
  test_advance(&e, 0.5);
  energies(&e, &last, &heat);
  printf("particles: lost %.8g J, became heat %.8g J\n", first - last, heat);
  assert_true(last < 0.8 * first && fabs(heat / (first - last) - 1) < 1e-6);
  test_engine_close(&e);
}

/* A vortex between walls without friction. On the grid the strains are those of its velocities, and the particles' own
 * part is not: 7 % with 8 cells across, 3 % with 32. */
static void of_a_grid_most_becomes_heat(void **state) {
  (void)state;
  test_engine e;
  double first, last, heat;
  begin(&e);
  hk_plugin_spec *liquid = test_plugin(&e, HK_CORRECTOR, "liquid");
  test_vector(&e, liquid, "low", 0, 0, 0);
  test_vector(&e, liquid, "high", 1, 0, 1);
  test_number(&e, liquid, "cell", 2 * dx);
  test_number(&e, liquid, "viscosity", 50);
  test_text(&e, liquid, "walls", "free_slip");
  test_boolean(&e, liquid, "heats", true);
  heat_of(&e, "liquid");
  for (size_t i = 0; i < N; i++) {
    const double *x = place(&e, i);
    velocity(&e, i)[0] = sin(pi * x[0]) * cos(pi * x[2]), velocity(&e, i)[2] = -cos(pi * x[0]) * sin(pi * x[2]);
    e.scene->particles.mass[i] *= 2; /* a cell is as deep as wide */
  }
  e.scene->dt = 0.005;
  test_run(&e);
  test_advance(&e, 0.05);
  energies(&e, &first, &heat);
  double before = heat;
  test_advance(&e, 0.3);
  energies(&e, &last, &heat);
  printf("grid: lost %.6g J, became heat %.6g J\n", first - last, heat - before);
  assert_true(last < 0.8 * first && fabs((heat - before) / (first - last) - 1) < 0.08);
  test_engine_close(&e);
}

static void refuses(test_engine *e, const char *sentence) {
  hk_status status = hk_run_open(e->scene, &e->options, &e->run, &e->error);
  assert_int_equal(status, HK_BAD_PARAM);
  if (!strstr(e->error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e->error.text);
  test_engine_close(e);
}

static void what_does_not_fit_is_refused(void **state) {
  (void)state;
  test_engine e;
  begin(&e);
  heat_of(&e, "gravity");
  refuses(&e, "of: nothing with the label 'gravity' publishes a dissipation of each particle");
  between_particles(&e);
  refuses(&e, "mu: there is none: give `mu`");
  hk_plugin_spec *viscosity = between_particles(&e);
  test_number(&e, viscosity, "mu", 1);
  test_text(&e, viscosity, "viscosity_of", "melt");
  refuses(&e, "mu: there is one, and those of `viscosity_of`");
  test_text(&e, between_particles(&e), "viscosity_of", "melt");
  hk_plugin_spec *melt = test_plugin(&e, HK_FORCE, "melt");
  test_text(&e, melt, "channel", "enthalpy");
  test_number(&e, melt, "capacity", 1);
  test_number(&e, melt, "viscosity", 1);
  refuses(&e, "viscosity_of: 'melt' stands behind this in the scene");
}

/* It would be that of an earlier evaluation. */
static void heat_in_front_of_its_viscosity_is_refused(void **state) {
  (void)state;
  test_engine e;
  begin(&e);
  heat_of(&e, "viscosity");
  hk_plugin_spec *viscosity = test_plugin(&e, HK_FORCE, "viscosity");
  test_number(&e, viscosity, "spacing", dx);
  test_number(&e, viscosity, "dimensions", 2);
  test_number(&e, viscosity, "mu", 10);
  hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
  if (status == HK_OK) status = hk_run_advance(e.run, 0.05, &e.error);
  assert_int_equal(status, HK_FAILED);
  assert_non_null(strstr(e.error.text, "a force viscosity has to stand in front of this in the scene"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(of_particles_all_becomes_heat),
      cmocka_unit_test(of_a_grid_most_becomes_heat),
      cmocka_unit_test(what_does_not_fit_is_refused),
      cmocka_unit_test(heat_in_front_of_its_viscosity_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
