/* What has molten joins a liquid by particles, or a heap of grains: its mass and momentum are what they were. */
#include "tests/support/melting.h"

#include <math.h>

enum { COUNT = MELTING_SIDE * MELTING_SIDE, FLOOR = 15 };

static const double spacing = 0.1, mass = 0.01, depth = -0.8, g = 9.81;

/* A floor of pinned particles, their middles at `depth`. */
static void add_floor(test_engine *e) {
  const double none[3] = {0};
  for (int k = 0; k < FLOOR * FLOOR; k++)
    test_pin(e, HK_PIN_FIXED, test_particle(e, spacing * (k % FLOOR - 5), spacing * (k / FLOOR - 5), depth, mass),
             none);
}

static void add_kind(test_engine *e, const char *name) {
  bool corrector = strcmp(name, "incompressible") == 0, grains = strcmp(name, "soft_spheres") == 0;
  hk_plugin_spec *spec = test_plugin(e, corrector ? HK_CORRECTOR : HK_FORCE, name);
  e->options.integrator = corrector ? "symplectic_euler" : "leapfrog";
  if (corrector) e->options.dt = 2e-3;
  if (grains) {
    test_number(e, spec, "radius", spacing / 2);
    test_number(e, spec, "stiffness", 500);
    return;
  }
  test_number(e, spec, "spacing", spacing);
  test_number(e, spec, "density", mass / pow(spacing, 3));
  if (!corrector) test_number(e, spec, "c", 20);
}

/* kg m/s, of the sheet and what was it. */
static void momentum_of(test_engine *e, double p[3]) {
  p[0] = p[1] = p[2] = 0;
  for (uint32_t id = 1; id <= COUNT; id++)
    for (int c = 0; c < 3; c++) p[c] += mass * test_velocity(e, id)[c];
}

/* A sheet whose particles were stirred falls and melts meanwhile. Before it comes to the floor its momentum is that of
 * free fall, to the rounding of some hundred steps of 25 particles; behind, in the time in which it would have fallen
 * 0.4 m below the floor, this has held all that melted. */
static void falls_and_joins(const char *kind) {
  test_engine e;
  const double t = 0.3;
  double before[3], after[3];
  test_engine_open(&e);
  melting_sheet(&e, "melting_membrane", 280, 10); /* all has molten after 0.15 s */
  melting_warms(&e, 400);
  for (uint32_t id = 1; id <= COUNT; id++)
    for (int c = 0; c < 3; c++) e.scene->particles.velocity[3 * (id - 1) + (uint32_t)c] = 0.1 * sin(7. * id + c);
  add_floor(&e);
  add_kind(&e, kind);
  e.scene->fps = 100;
  e.scene->duration = 1;
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -g);
  test_run(&e);
  momentum_of(&e, before);
  test_advance(&e, t);
  momentum_of(&e, after);
  after[2] += COUNT * mass * g * t;
  print_message("%s: off by %.2g, %.2g, %.2g N s\n", kind, after[0] - before[0], after[1] - before[1],
                after[2] - before[2]);
  for (int c = 0; c < 3; c++) assert_true(fabs(after[c] - before[c]) < 1e-13);
  test_advance(&e, 0.5);
  assert_int_equal(hk_run_view(e.run)->n, COUNT + FLOOR * FLOOR);
  for (uint32_t id = 1; id <= COUNT; id++) {
    assert_true(hk_run_view(e.run)->model->mass[id - 1] == mass);
    if (!(test_position(&e, id)[2] > depth)) fail_msg("%u is at %g m", (unsigned)id, test_position(&e, id)[2]);
  }
  test_engine_close(&e);
}

static void what_melts_joins_sph(void **state) {
  (void)state;
  falls_and_joins("sph");
}

static void what_melts_joins_an_incompressible_liquid(void **state) {
  (void)state;
  falls_and_joins("incompressible");
}

static void what_melts_joins_grains(void **state) {
  (void)state;
  falls_and_joins("soft_spheres");
}

/* While triangles join it, it is a wall of the liquid, which has no density of its own; then it has. */
static void what_melts_is_a_wall_before(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  melting_sheet(&e, "melting_membrane", 280, 10);
  melting_warms(&e, 400);
  add_kind(&e, "sph");
  e.scene->fps = 100;
  e.scene->duration = 1;
  test_run(&e);
  const hk_model *m = hk_run_view(e.run)->model;
  const double *const *density = NULL;
  for (size_t k = 0; k < m->publications; k++)
    if (strcmp(m->published[k].name, "local_density") == 0) density = m->published[k].values;
  assert_non_null(density);
  for (int melted = 0; melted < 2; melted++) {
    test_advance(&e, melted ? 0.3 : 0.01);
    for (size_t i = 0; i < COUNT; i++) assert_true(melted ? (*density)[i] > 0 : (*density)[i] == 0);
  }
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_melts_joins_sph),
      cmocka_unit_test(what_melts_joins_an_incompressible_liquid),
      cmocka_unit_test(what_melts_joins_grains),
      cmocka_unit_test(what_melts_is_a_wall_before),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
