/* Bars under the corrector `contact`: impacts of rods against closed forms of their energy, however far they turn in a
 * step, and bars that meet between their ends. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double g = 9.81, radius = 1e-3;

static uint32_t put(test_engine *e, double x, double y, double z, const double v[3]) {
  uint32_t id = test_particle(e, x, y, z, 0.3);
  if (v) memcpy(e->scene->particles.velocity + 3 * (size_t)(id - 1), v, 3 * sizeof *v);
  return id;
}

static void bar(test_engine *e, uint32_t a, uint32_t b) {
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{a, b}}, 1);
}

static void open_world(test_engine *e, double h) {
  test_engine_open(e);
  e->options.integrator = "leapfrog";
  e->options.dt = h;
  e->scene->duration = 1000;
  e->scene->fps = 50;
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -g);
}

static void add_floor(test_engine *e) {
  const double corner[3][2] = {{-9, -9}, {9, -9}, {0, 18}};
  uint32_t id[3];
  for (int k = 0; k < 3; k++) {
    id[k] = put(e, corner[k][0], corner[k][1], 0, NULL);
    test_pin(e, HK_PIN_FIXED, id[k], NULL);
  }
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, (const uint32_t[1][3]){{id[0], id[1], id[2]}}, &e->error),
                   HK_OK);
}

static void add_contact(test_engine *e, double restitution, double friction) {
  hk_plugin_spec *spec = test_plugin(e, HK_CORRECTOR, "contact");
  test_number(e, spec, "restitution", restitution);
  test_number(e, spec, "friction", friction);
  test_number(e, spec, "radius", radius);
}

static double energy(test_engine *e) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++) {
    const double *x = view->x + 3 * i, *v = view->v + 3 * i;
    if (hk_model_moves(view->model, (uint32_t)i))
      sum += (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / 2 + g * x[2]; /* all of one mass */
  }
  return sum;
}

/* A rod that turns with `spin` (rad/s) about its middle, whose lower end leads. Gaps are closed to 1e-5 of the distance
 * at which bars touch, as a height 2e-8 m, beside energies of 0.1 to 5 J/kg: 1e-6 covers some impacts. */
static double change_of_energy(double friction, double length, double spin, double seconds) {
  const double c = cos(0.8) * length / 2, s = sin(0.8) * length / 2;
  test_engine t;
  open_world(&t, 0.02);
  add_floor(&t);
  uint32_t a = put(&t, -c, 0, 0.06 + length / 2 - s, (double[]){0.4 + spin * s, 0, -1 - spin * c});
  uint32_t b = put(&t, c, 0, 0.06 + length / 2 + s, (double[]){0.4 - spin * s, 0, -1 + spin * c});
  bar(&t, a, b);
  add_contact(&t, 1, friction);
  test_run(&t);
  double was = energy(&t);
  test_advance(&t, seconds);
  double change = energy(&t) / was - 1;
  test_engine_close(&t);
  return change;
}

/* With e = 1 and friction that holds the end, Newton's law would leave the rod 8 % more than it had. */
static void a_rod_gains_no_energy_by_friction(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    double change = change_of_energy((double[]){0.1, 0.3, 3}[k], 0.6, 0, 0.14);
    print_message("a rod on its end: the energy changes by %.1e\n", change);
    assert_true(change < 1e-6);
  }
}

/* In a step it turns by 0.8 rad. */
static void a_rod_that_turns_fast_keeps_its_energy(void **state) {
  (void)state;
  double change = change_of_energy(0, 0.1, 40, 1);
  print_message("a rod that turns: the energy changes by %.1e\n", change);
  assert_true(fabs(change) < 1e-6);
}

/* A bar falls across a strand that is held at its ends. `before`: particles that a drain takes away meanwhile, so that
 * all others are numbered anew. */
static void fall_across(int before) {
  test_engine t;
  open_world(&t, 1e-3);
  for (int k = 0; k < before; k++) put(&t, 3 + k, 0, 1, NULL);
  uint32_t held[2] = {put(&t, -0.1, 0, 0, NULL), put(&t, 0.1, 0, 0, NULL)};
  for (int k = 0; k < 2; k++) test_pin(&t, HK_PIN_FIXED, held[k], NULL);
  assert_int_equal(hk_scene_add_edges(t.scene, 1, (const uint32_t[1][2]){{held[0], held[1]}}, &t.error), HK_OK);
  uint32_t one = put(&t, 0, -0.1, 0.03, NULL), other = put(&t, 0, 0.1, 0.03, NULL);
  bar(&t, one, other);
  if (before) {
    hk_plugin_spec *drain = test_plugin(&t, HK_SOURCE, "drain");
    test_vector(&t, drain, "low", 2, -1, -9);
    test_vector(&t, drain, "high", 9, 1, 0.99);
  }
  add_contact(&t, 0, 0.5);
  test_run(&t);
  test_advance(&t, 0.3);
  assert_int_equal(hk_run_view(t.run)->n, 4);
  double height = (test_position(&t, one)[2] + test_position(&t, other)[2]) / 2;
  print_message("a bar across another lies %.6f radii above it\n", height / radius);
  assert_true(fabs(height - 2 * radius) < 0.01 * 2 * radius);
  test_engine_close(&t);
}

static void bars_meet_between_their_ends(void **state) {
  (void)state;
  fall_across(0);
  fall_across(3);
}

/* ---- the forces of bars that stand: what contact presses in impulses is part of them ---- */

static const char *const floors[] = {
    "scene:body { shape = 'plane', size = 5 }\nscene:corrector('contact', { friction = 0 })\n",
    "scene:corrector('obstacle', {})\n"};

/* The measures T1, T2, ... of a scene that stands on the floor, in steps that are frames. */
static void measure_standing(const char *scene, int floor, int count, const double *wanted) {
  static test_result r;
  char text[2048], name[16];
  snprintf(text, sizeof text,
           "local scene = hooke.scene { duration = 0.1, fps = 100, dt = 0.01, integrator = 'leapfrog' }\n"
           "scene:force('gravity')\n%s%s"
           "for k = 1, %d do scene:measure('T' .. k, function(s) return s:constraint_forces('bars')[k] end) end\n"
           "return scene\n",
           scene, floors[floor], count);
  test_write("stands.lua", text);
  test_hooke(&r, NULL, "run stands.lua --json --quiet --no-output --no-check");
  for (int k = 0; k < count; k++) {
    snprintf(name, sizeof name, "T%d", k + 1);
    double T = test_json(r.out, name);
    if (!(fabs(T - wanted[k]) < 1e-6 * fabs(wanted[k])))
      fail_msg("floor %d: %s is %.9g N instead of %.9g", floor, name, T, wanted[k]);
  }
}

/* A mast of three bars and four particles of 1, 2, 3 and 4 kg, the first of them on the floor: each bar carries what is
 * above it. Sweeps leave 1e-5 of the thickness, which is less than 1e-6 of the impulses. */
static void a_mast_carries_what_is_above(void **state) {
  (void)state;
  for (int floor = 0; floor < 2; floor++)
    measure_standing("for k = 1, 4 do scene:particle { position = { 0, 0, 1e-3 + 0.5 * (k - 1) }, mass = k } end\n"
                     "scene:constraint('bars', { edges = { { 1, 2 }, { 2, 3 }, { 3, 4 } } })\n",
                     floor, 3, (const double[]){-9 * 9.81, -7 * 9.81, -4 * 9.81});
}

/* Two legs of tan = 2 and a tie between their feet, without friction: half of the top's weight over the sine in each
 * leg, and over the tangent in the tie. */
static void a_trestle_carries_its_top(void **state) {
  (void)state;
  const double half = 2 * 9.81 / 2;
  for (int floor = 0; floor < 2; floor++)
    measure_standing("scene:particle { position = { -0.5, 0, 1e-3 }, mass = 1 }\n"
                     "scene:particle { position = { 0.5, 0, 1e-3 }, mass = 1 }\n"
                     "scene:particle { position = { 0, 0, 1e-3 + 1 }, mass = 2 }\n"
                     "scene:constraint('bars', { edges = { { 1, 3 }, { 2, 3 }, { 1, 2 } } })\n",
                     floor, 3, (const double[]){-half * sqrt(5) / 2, -half * sqrt(5) / 2, half / 2});
}

/* A box of 2 kg that is fixed on one of 3 kg, which lies on the floor: the joint bears the weight of the upper one. */
static void a_joint_bears_the_body_above(void **state) {
  (void)state;
  static test_result r;
  for (int floor = 0; floor < 2; floor++) {
    char text[2048];
    snprintf(
        text, sizeof text,
        "local scene = hooke.scene { duration = 0.1, fps = 100, dt = 0.01, integrator = 'leapfrog' }\n"
        "local function box(z, m)\n"
        "  local body = scene:rigid { shape = 'box', size = { 0.2, 0.2, 0.2 }, position = { 0, 0, z }, mass = m }\n"
        "  body:surface()\n"
        "  return body\n"
        "end\n"
        "local joint = scene:joint { kind = 'fixed', a = box(0.1005, 3), b = box(0.35, 2), at = { 0, 0, 0.22 } }\n"
        "scene:force('gravity')\n%s"
        "scene:measure('z', function(s) return joint:force(s)[3] end)\nreturn scene\n",
        floors[floor]);
    test_write("joint.lua", text);
    test_hooke(&r, NULL, "run joint.lua --json --quiet --no-output --no-check");
    double z = test_json(r.out, "z");
    if (!(fabs(z + 2 * 9.81) < 1e-6 * 2 * 9.81)) fail_msg("floor %d: %.9g N, %s", floor, z, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rod_gains_no_energy_by_friction), cmocka_unit_test(a_rod_that_turns_fast_keeps_its_energy),
      cmocka_unit_test(bars_meet_between_their_ends),      cmocka_unit_test(a_mast_carries_what_is_above),
      cmocka_unit_test(a_trestle_carries_its_top),         cmocka_unit_test(a_joint_bears_the_body_above),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
