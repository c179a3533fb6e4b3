/* The gas in octahedra against closed forms, its energy and differences of itself, in sparse and in full blocks; what
 * is open, inside out, turned inside out during a run, or too large for implicit steps; a puncture; no memory. */
#include "tests/plugins/forces/closed_surfaces.h"

static hk_plugin_spec *add_bodies(test_engine *e, double p, double exponent, double ambient) {
  hk_plugin_spec *spec = add_octahedra(e, "pressure");
  test_number(e, spec, "p", p);
  test_number(e, spec, "exponent", exponent);
  test_number(e, spec, "ambient", ambient);
  return spec;
}

static void open_bodies(bodies *b, double p, double exponent, double ambient) {
  run_bodies(b, add_bodies(&b->e, p, exponent, ambient));
}

/* Drawn out to s times its length the first one has s V_0, and each corner feels the overpressure times the area that
 * it sees along its axis, V_0/2 in units of the other axes' lengths. Energies are the gas's work in closed form, n
 * = 1.4: p V_0 (s^-0.4 - 1)/0.4. */
static void an_octahedron_by_hand(void **state) {
  (void)state;
  static const double exponents[] = {0, 1, 1.4};
  double p = 3, out = 5;
  for (int k = 0; k < 3; k++)
    for (double s = 0.5; s < 3; s += 0.5) {
      bodies b;
      double F[SIZE], n = exponents[k];
      open_bodies(&b, p, n, out);
      for (int i = 0; i < 6; i++) b.x[3 * i + 2] *= s;
      force_evaluate(b.force, &b.view, F);
      double over = k == 0 ? p : (out + p) * pow(s, -n) - out;
      double E = k == 0   ? -p * VOLUME * (s - 1)
                 : k == 1 ? VOLUME * (out * (s - 1) - (out + p) * log(s))
                          : VOLUME * (out * (s - 1) + (out + p) * (pow(s, -0.4) - 1) / 0.4);
      assert_true(fabs(energy_of(&b) - E) < 1e-13 * out);
      for (int i = 0; i < 6; i++)
        for (int c = 0; c < 3; c++) {
          double push = c != i / 2 ? 0 : over * 2 / 3 * (c == 2 ? 1 : s) * (i % 2 ? 1 : -1); /* dV/dx: 4 s/3 a pair */
          assert_true(fabs(F[3 * i + c] - push) < 1e-13 * out);
        }
      test_engine_close(&b.e);
    }
}

static void derivatives_are_those_of_the_energy(void **state) {
  (void)state;
  static const double gas[][3] = {{2, 0, 5}, {-2, 0, 5}, {2, 1, 5}, {2, 1.4, 5}, {0, 1.001, 5}, {3, 2.5, 0}};
  for (size_t k = 0; k < sizeof gas / sizeof *gas; k++) {
    bodies b;
    open_bodies(&b, gas[k][0], gas[k][1], gas[k][2]);
    for (int q = 0; q < SIZE; q++) b.x[q] += 0.3 * noise(), b.v[q] = noise();
    assert_true(force_gradient_error(b.force, &b.view) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(b.force, &b.view) < FORCE_DIFFERENCES);
    test_engine_close(&b.e);
  }
}

/* A closed surface is not pushed or turned as a whole, and its stiffness is symmetric, whatever its shape. A given
 * pressure couples the corners of triangles alone. */
static void a_closed_surface_is_in_balance(void **state) {
  (void)state;
  for (int gas = 0; gas < 2; gas++) {
    static double K[SIZE * SIZE], D[SIZE * SIZE];
    bodies b;
    double F[SIZE], sum[6] = {0};
    open_bodies(&b, 7, gas, 1);
    for (int q = 0; q < SIZE; q++) b.x[q] += 0.3 * noise();
    force_evaluate(b.force, &b.view, F);
    for (int i = 0; i < N; i++)
      for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        sum[c] += F[3 * i + c], sum[3 + c] += b.x[3 * i + d] * F[3 * i + e] - b.x[3 * i + e] * F[3 * i + d];
      }
    for (int c = 0; c < 6; c++) assert_true(fabs(sum[c]) < 1e-12);
    assert_int_equal(force_matrices(b.force, &b.view, K, D), PIECES * (gas ? 6 * 6 : 9 * FACES));
    for (int r = 0; r < SIZE; r++)
      for (int c = 0; c < r; c++) assert_true(fabs(K[SIZE * r + c] - K[SIZE * c + r]) < 1e-13);
    test_engine_close(&b.e);
  }
}

static void a_punctured_body_loses_its_gas(void **state) {
  (void)state;
  bodies b;
  open_bodies(&b, 2, 1.4, 5);
  for (int q = 0; q < SIZE; q++) b.x[q] += 0.1 * noise();
  assert_open_without_a_corner(&b);
  test_engine_close(&b.e);
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void refused(const uint32_t *face, size_t faces, const char *why) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
  test_particle(&e, 0.2, 0.2, 1, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "pressure");
  test_tuples(&e, spec, "triangles", 3, face, faces);
  test_number(&e, spec, "p", 1);
  assert_int_equal(open_run(&e), HK_BAD_PARAM);
  if (!strstr(e.error.text, why)) fail_msg("%s", e.error.text);
  test_engine_close(&e);
}

static void what_holds_no_gas_is_refused(void **state) {
  (void)state;
  const uint32_t closed[] = {2, 3, 4, 1, 4, 3, 1, 2, 4, 1, 3, 2}, turned[] = {2, 3, 4, 1, 4, 3, 1, 2, 4, 1, 2, 3};
  const uint32_t inward[] = {2, 4, 3, 1, 3, 4, 1, 4, 2, 1, 2, 3};
  refused(closed, 3, "the edge {1, 2} has one triangle: the surface is open");
  refused(turned, 4, "two run the same way along the edge {1, 2}");
  refused(inward, 4, "the surface with the edge {2, 4} is inside out, its volume is -0.166667 m^3");
  refused(inward, 4, "{2, 3, 4} for {2, 4, 3}");
}

/* A body that is mirrored has the volume -V_0: a given pressure goes on. A gas pushes it back by the tangent of its law
 * at V_0/1000, p_in = q (V_c + (V_c - V)), q = 10^6 of the pressure at the start over V_0; and derivatives hold there.
 */
static void what_turns_inside_out_is_pushed_back(void **state) {
  (void)state;
  for (int gas = 0; gas < 2; gas++) {
    bodies b;
    double F[SIZE], p = 2, over = gas ? p * 1e3 * (1 + 1e3 * (1e-3 + 1)) : p;
    open_bodies(&b, p, gas, 0);
    for (int i = 0; i < 6; i++) b.x[3 * i] *= -1;
    force_evaluate(b.force, &b.view, F);
    assert_true(fabs(F[0] + over * 2 / 3) < 1e-12 * over); /* grad V is that of the body with its corners exchanged */
    for (int q = 0; q < SIZE; q++) b.x[q] += 0.1 * noise();
    assert_true(force_gradient_error(b.force, &b.view) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(b.force, &b.view) < FORCE_DIFFERENCES);
    test_engine_close(&b.e);
  }
}

/* Explicit steps go, and implicit ones with a given pressure; with a gas implicit ones are refused with the way out. */
static void what_is_too_large_for_blocks_is_said(void **state) {
  (void)state;
  for (int mode = 0; mode < 4; mode++) {
    bool implicit = mode % 2, gas = mode / 2;
    test_engine e;
    hk_plugin_spec *spec = add_bipyramid(&e, "pressure");
    test_number(&e, spec, "p", 1);
    test_number(&e, spec, "exponent", gas ? 1 : 0);
    test_number(&e, spec, "ambient", 1);
    assert_steps(&e, implicit, implicit && gas ? "the gas in a surface of 602 particles couples all" : NULL);
  }
}

static void open_gas(test_engine *e) { add_bodies(e, 1, 1, 1); }

static void no_memory_is_an_error(void **state) {
  (void)state;
  assert_no_memory_is_an_error(open_gas);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_octahedron_by_hand),
      cmocka_unit_test(derivatives_are_those_of_the_energy),
      cmocka_unit_test(a_closed_surface_is_in_balance),
      cmocka_unit_test(a_punctured_body_loses_its_gas),
      cmocka_unit_test(what_holds_no_gas_is_refused),
      cmocka_unit_test(what_turns_inside_out_is_pushed_back),
      cmocka_unit_test(what_is_too_large_for_blocks_is_said),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
