/* Octahedra, surfaces of several pieces and tetrahedra against closed forms, their energy and differences of
 * themselves; surfaces that are open or lose a particle; what is too large for implicit steps; no memory. */
#include "tests/plugins/forces/closed_surfaces.h"

static hk_plugin_spec *add_bodies(test_engine *e) {
  hk_plugin_spec *spec = add_octahedra(e, "volume");
  test_number(e, spec, "k", 3);
  return spec;
}

static void open_bodies(bodies *b, double damping, double inflation) {
  hk_plugin_spec *spec = add_bodies(&b->e);
  test_number(&b->e, spec, "damping", damping);
  test_number(&b->e, spec, "inflation", inflation);
  run_bodies(b, spec);
}

/* The first one drawn out to s times its length has s V_0, of which inflation V_0 would be at rest: a pressure p, which
 * pushes each corner with p over the area that it sees along its axis, 2/3 of V_0 per length across. */
static void an_octahedron_by_hand(void **state) {
  (void)state;
  for (double s = 0.5; s < 3; s += 0.5) {
    bodies b;
    double F[SIZE], k = 3, V = VOLUME, rest = 1.2 * V, p = -k * (s * V - rest) / rest;
    open_bodies(&b, 0, 1.2);
    for (int i = 0; i < 6; i++) b.x[3 * i + 2] *= s;
    force_evaluate(b.force, &b.view, F);
    double second = k / 2 * 0.2 * 0.2 / 1.2 * 8 * V; /* of the other one, at its initial volume 8 V */
    assert_true(fabs(energy_of(&b) - second - k / 2 * pow(s * V - rest, 2) / rest) < 1e-14 * k);
    for (int i = 0; i < 6; i++)
      for (int c = 0; c < 3; c++) {
        double sign = i % 2 ? 1 : -1,
               push = c != i / 2 ? 0 : p * 2 / 3 * (c == 2 ? 1 : s) * sign; /* dV/dx: 4 s/3 a pair */
        assert_true(fabs(F[3 * i + c] - push) < 1e-14 * k);
      }
    test_engine_close(&b.e);
  }
}

static void derivatives_are_those_of_the_energy(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    bodies b;
    open_bodies(&b, 0, k == 0 ? 1 : 2.5);
    for (int q = 0; q < SIZE; q++) b.x[q] += 0.3 * noise(), b.v[q] = noise();
    assert_true(force_gradient_error(b.force, &b.view) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(b.force, &b.view) < FORCE_DIFFERENCES);
    test_engine_close(&b.e);
    open_bodies(&b, 0.7, 2.5);
    for (int q = 0; q < SIZE; q++) b.x[q] += 0.3 * noise(), b.v[q] = noise();
    assert_true(force_stiffness_error(b.force, &b.view) < FORCE_DIFFERENCES);
    assert_true(force_damping_error(b.force, &b.view) < FORCE_DIFFERENCES);
    test_engine_close(&b.e);
  }
}

/* Breathing with the speed u of all corners, dV/dt = 4 u: power -c (4 u)^2/V_0, and 8 u at twice the size. */
static void damping_takes_the_rate_of_the_volume(void **state) {
  (void)state;
  bodies b;
  double F[SIZE], u = 0.3, c = 0.7, V = VOLUME;
  open_bodies(&b, c, 1);
  for (int i = 0; i < N; i++) b.v[3 * i + i % 6 / 2] = (i % 2 ? u : -u) * (i < 6 ? 1 : 0.25);
  double power = force_evaluate(b.force, &b.view, F);
  assert_true(fabs(power + c * 16 * u * u * (1 / V + 1 / (8 * V))) < 1e-14);
  test_engine_close(&b.e);
}

static void a_punctured_body_loses_its_pressure(void **state) {
  (void)state;
  bodies b;
  open_bodies(&b, 0.1, 2);
  for (int q = 0; q < SIZE; q++) b.x[q] += 0.1 * noise(), b.v[q] = noise();
  assert_open_without_a_corner(&b);
  test_engine_close(&b.e);
}

/* ---- tetrahedra -------------------------------------------------------------------------------------------------- */

/* Two that share a face, one of them inside out, each with its own k: 1/2 k (s - 1)^2 V_0. */
static void tetrahedra_each_keep_their_volume(void **state) {
  (void)state;
  test_engine e;
  double x[15], v[15] = {0};
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
  test_particle(&e, 0, 0, 1, 1), test_particle(&e, 0, 0, -2, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "volume");
  test_tuples(&e, spec, "tetrahedra", 4, (uint32_t[]){1, 2, 3, 4, 1, 2, 3, 5}, 2);
  test_list(&e, spec, "k", (double[]){2, 5}, 2);
  test_run(&e);
  hk_instance *volume = test_instance(&e, spec);
  hk_view view = force_view(&e, volume);
  memcpy(x, view.x, sizeof x);
  view.x = x, view.v = v;
  x[3 * 3 + 2] = 1.5, x[3 * 4 + 2] = -1;
  double E = volume->plugin->force->energy(volume->self, &view);
  assert_true(fabs(E - (1.0 * 0.25 / 6 + 2.5 * 0.25 / 3)) < 1e-15);
  for (int q = 0; q < 15; q++) x[q] += 0.2 * noise(), v[q] = noise();
  assert_true(force_gradient_error(volume, &view) < FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(volume, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void refused(const uint32_t *face, size_t faces, double height, const char *why) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
  test_particle(&e, 0.2, 0.2, height, 1), test_particle(&e, 1, 1, 1, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "volume");
  if (faces > 0) test_tuples(&e, spec, "triangles", 3, face, faces);
  test_number(&e, spec, "k", 1);
  assert_int_equal(open_run(&e), HK_BAD_PARAM);
  if (!strstr(e.error.text, why)) fail_msg("%s", e.error.text);
  test_engine_close(&e);
}

static void what_encloses_nothing_is_refused(void **state) {
  (void)state;
  const uint32_t closed[] = {2, 3, 4, 1, 4, 3, 1, 2, 4, 1, 3, 2}, turned[] = {2, 3, 4, 1, 4, 3, 1, 2, 4, 1, 2, 3};
  const uint32_t third[] = {2, 3, 4, 1, 4, 3, 1, 2, 4, 1, 3, 2, 3, 2, 5};
  refused(closed, 3, 1, "has one triangle: the surface is open");
  refused(turned, 4, 1, "two run the same way along the edge {1, 2}");
  refused(third, 5, 1, "the edge {2, 3} has 3 triangles");
  refused(closed, 4, 0, "enclose has no volume");
  refused(NULL, 0, 1, "give triangles, closed surfaces, or tetrahedra");
}

/* Explicit steps go, implicit ones are refused with the way out. */
static void what_is_too_large_for_blocks_is_said(void **state) {
  (void)state;
  for (int implicit = 0; implicit < 2; implicit++) {
    test_engine e;
    hk_plugin_spec *spec = add_bipyramid(&e, "volume");
    test_number(&e, spec, "k", 1);
    test_number(&e, spec, "inflation", 1.1);
    assert_steps(&e, implicit, implicit ? "a surface of 602 particles couples all of them" : NULL);
  }
}

static void open_volumes(test_engine *e) { add_bodies(e); }

static void no_memory_is_an_error(void **state) {
  (void)state;
  assert_no_memory_is_an_error(open_volumes);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_octahedron_by_hand),
      cmocka_unit_test(derivatives_are_those_of_the_energy),
      cmocka_unit_test(damping_takes_the_rate_of_the_volume),
      cmocka_unit_test(a_punctured_body_loses_its_pressure),
      cmocka_unit_test(tetrahedra_each_keep_their_volume),
      cmocka_unit_test(what_encloses_nothing_is_refused),
      cmocka_unit_test(what_is_too_large_for_blocks_is_said),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
