/* The adjoint is the transpose of the tangents, up to rounding, whatever the number of steps between states kept. */
#include "tests/support/varied_scenes.h"

#include <complex.h>
#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

/* Tangents compare scenes whose parameters differ by 1e-5 of their size (varied_scenes.c): forces are rounded, so
 * derivatives by their numbers are off by some eps/1e-5, where the adjoint has them from the forces themselves. That by
 * the start, the last parameter, has no such part: it is the transpose itself. */
static const double of_differences = 10 * DBL_EPSILON / 1e-5, of_transpose = 1e-12;

/* w . (dX/dp) of all tangents against the adjoint of w, relative to the sum of the sizes, in parts of what
 * may be: the worst. */
static double mismatch_of(varied_scene *scene, size_t n, const char *method, size_t stride) {
  double w[36], back[36], slope[VARIED_PARAMETERS], worst = 0;
  varied_runs r;
  varied_open(&r, scene, method, start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.402);
  if (stride) varied_keep(&r, stride);
  varied_tangents kept = {.numbers = VARIED_PARAMETERS * r.s->wide, .n = n};
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error), HK_OK);
  for (size_t e = 0; e < 6 * n; e++) back[e] = w[e] = cos(2.3 * (double)e);
  assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, VARIED_PARAMETERS, slope, &error), HK_OK);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double sum = 0, size = 0;
    for (size_t e = 0; e < 6 * n; e++) {
      sum += w[e] * kept.last[r.s->wide * k + e];
      size += fabs(w[e] * kept.last[r.s->wide * k + e]);
    }
    worst = fmax(worst, fabs(sum - slope[k]) / size / (k < VARIED_PARAMETERS - 1 ? of_differences : of_transpose));
  }
  varied_close(&r);
  return worst;
}

static double mismatch(const char *method, size_t stride) { return mismatch_of(varied_tetrahedron, 4, method, stride); }

static void adjoint_is_the_transpose_of_the_tangents(void **state) {
  (void)state;
  for (size_t m = 0; m < VARIED_ALL; m++) {
    double off = mismatch(varied_method[m], 0);
    if (!(off < 1)) fail_msg("%s: %g", varied_method[m], off);
  }
}

static void states_kept_in_place_of_points_change_nothing(void **state) {
  (void)state;
  assert_true(mismatch("leapfrog", 3) < 1);
  assert_true(mismatch("leapfrog", 14) < 1);
  assert_true(mismatch("rk4", 40) < 1);
  assert_true(mismatch("bdf2", 14) < 1);
}

/* A chain whose springs, drag and gravity have numbers of their own each, through masses that are all others: no scene
 * is compared, and one with a force that has no product of its own is. */
static void chain(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 6 };
  double k[N - 1], c[N - 1], L[N - 1];
  uint32_t pair[N - 1][2];
  for (uint32_t i = 0; i < N; i++) test_particle(e, i, 0.1 * i * i, -0.2 * sin(i), p[2] * (1 + 0.3 * sin(2. * i)));
  for (uint32_t i = 0; i + 1 < N; i++) {
    pair[i][0] = i % 2 ? i + 2 : i + 1, pair[i][1] = i % 2 ? i + 1 : i + 2;
    k[i] = p[0] * (1 + 0.1 * i), c[i] = p[1] * (2 - 0.2 * i), L[i] = 0.7 + 0.2 * cos(i);
  }
  for (size_t i = 0; i < 3 * N; i++) e->scene->particles.velocity[i] = p[3] * sin(1.7 * (double)i);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])pair, N - 1);
  test_list(e, springs, "k", k, N - 1);
  test_list(e, springs, "damping", c, N - 1);
  test_list(e, springs, "rest", L, N - 1);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", p[1]);
  test_plugin(e, HK_FORCE, "gravity");
}

/* One force without a product of its own beside. */
static void chain_and_flow(test_engine *e, const double p[VARIED_PARAMETERS]) {
  chain(e, p);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "cubic_springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 4}, {2, 6}}, 2);
  test_number(e, springs, "k", p[0]);
}

static const double corner[6][3] = {{0, 0, 0},     {1, 0.1, 0},    {0.1, 0.9, 0},
                                    {1.1, 1, 0.2}, {2, 0.2, -0.1}, {0.4, 0.4, 0.8}};

static void places(test_engine *e, size_t n, const double p[VARIED_PARAMETERS]) {
  for (size_t i = 0; i < n; i++)
    test_particle(e, corner[i][0], corner[i][1], corner[i][2], p[2] * (1 + 0.3 * sin(2. * (double)i)));
  for (size_t i = 0; i < 3 * n; i++) e->scene->particles.velocity[i] = p[3] * sin(1.7 * (double)i);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
}

/* A sheet of three triangles with the moduli p[0] and p[1] in a row of their own each, and what bends it. */
static hk_plugin_spec *sheet(test_engine *e, const double p[VARIED_PARAMETERS], const char *model) {
  places(e, 5, p);
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane");
  test_tuples(e, membrane, "triangles", 3, (const uint32_t[]){1, 2, 3, 2, 4, 3, 2, 5, 4}, 3);
  test_text(e, membrane, "model", model);
  test_list(e, membrane, "stiffness", (double[]){p[0], 2 * p[0], 1.5 * p[0]}, 3);
  test_number(e, membrane, "damping", 0.05 * p[1]);
  return membrane;
}

static void cloth(test_engine *e, const double p[VARIED_PARAMETERS]) {
  hk_plugin_spec *membrane = sheet(e, p, "baraff_witkin");
  test_number(e, membrane, "shear", 10 * p[1]);
  test_number(e, membrane, "weft", 30 * p[1]);
  hk_plugin_spec *hinges = test_plugin(e, HK_FORCE, "hinges");
  test_tuples(e, hinges, "triangles", 3, (const uint32_t[]){1, 2, 3, 2, 4, 3, 2, 5, 4}, 3);
  test_number(e, hinges, "rigidity", 0.01 * p[0]);
  test_number(e, hinges, "damping", 0.1 * p[1]);
  test_number(e, hinges, "rest", 0.3 * p[1]);
}

static void fabric(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_number(e, sheet(e, p, "stvk"), "nu", 0.3 * p[1]);
  hk_plugin_spec *bending = test_plugin(e, HK_FORCE, "quadratic_bending");
  test_tuples(e, bending, "hinges", 4, (const uint32_t[]){2, 3, 1, 4, 2, 4, 3, 5}, 2);
  test_list(e, bending, "rigidity", (double[]){0.02 * p[0], p[1]}, 2);
}

static void rubber(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_number(e, sheet(e, p, "neo_hookean"), "nu", 0.5 * p[1]);
  hk_plugin_spec *central = test_plugin(e, HK_FORCE, "central");
  test_number(e, central, "strength", p[1]);
  test_number(e, central, "power", -p[1]);
  test_number(e, central, "softening", 0.4 * p[1]);
  test_number(e, central, "range", 3 * p[1]);
  test_vector(e, central, "center", 0.2, p[1], 0.01 * p[0]);
  test_vector(e, central, "axis", p[1], 1, 0.3);
}

static void flesh(test_engine *e, const double p[VARIED_PARAMETERS]) {
  places(e, 6, p);
  hk_plugin_spec *solid = test_plugin(e, HK_FORCE, "neo_hookean");
  test_tuples(e, solid, "tetrahedra", 4, (const uint32_t[]){1, 2, 3, 6, 2, 4, 3, 6}, 2);
  test_list(e, solid, "E", (double[]){2 * p[0], p[0]}, 2);
  test_number(e, solid, "nu", 0.5 * p[1]);
  test_list(e, solid, "damping", (double[]){p[1], 0}, 2);
  hk_plugin_spec *angles = test_plugin(e, HK_FORCE, "angle_springs");
  test_edges(e, angles, (const uint32_t[][2]){{1, 2}, {2, 5}, {5, 4}}, 3);
  test_number(e, angles, "EI", p[1]);
  test_number(e, angles, "retardation", 0.1 * p[1]);
}

/* Against tangents, which compare scenes at every evaluation. */
static void derivatives_by_forces_are_those_between_scenes(void **state) {
  (void)state;
  varied_scene *const scenes[] = {chain, chain_and_flow, flesh, cloth, fabric, rubber};
  for (int which = 0; which < 6; which++)
    for (size_t m = 0; m < VARIED_ALL; m++) {
      double off = mismatch_of(scenes[which], which < 3 ? 6 : 5, varied_method[m], 0);
      if (!(off < 1)) fail_msg("%d, %s: %g", which, varied_method[m], off);
    }
}

/* A solid, a sheet and a rod that have no damping, and springs that have. */
static void elastic(test_engine *e, const double p[VARIED_PARAMETERS]) {
  places(e, 6, p);
  hk_plugin_spec *solid = test_plugin(e, HK_FORCE, "neo_hookean");
  test_tuples(e, solid, "tetrahedra", 4, (const uint32_t[]){1, 2, 3, 6, 2, 4, 3, 6}, 2);
  test_number(e, solid, "E", 2 * p[0]);
  test_number(e, solid, "nu", 0.5 * p[1]);
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane");
  test_tuples(e, membrane, "triangles", 3, (const uint32_t[]){1, 2, 3, 2, 4, 3, 2, 5, 4}, 3);
  test_number(e, membrane, "stiffness", p[0]);
  hk_plugin_spec *angles = test_plugin(e, HK_FORCE, "angle_springs");
  test_edges(e, angles, (const uint32_t[][2]){{1, 2}, {2, 5}, {5, 4}}, 3);
  test_number(e, angles, "EI", p[1]);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 6}, {3, 5}}, 2);
  test_number(e, springs, "k", p[0]);
  test_number(e, springs, "damping", p[1]);
}

/* Of linear steps both ways take differences of matrices or of products, which leave 1e-9 of them. */
static void linear_steps_have_the_matrices_of_all_forces(void **state) {
  (void)state;
  static varied_scene *const scenes[] = {chain, chain_and_flow, elastic};
  for (int which = 0; which < 3; which++) {
    double off = mismatch_of(scenes[which], 6, "linear_bdf2", 0) * of_differences;
    if (!(off < 1e-8)) fail_msg("%d: %g", which, off);
  }
}

/* d(x_N)/d(v_0) of an oscillator, by the start: sin(N a) h/sin a of leapfrog, cos a = 1 - (h w)^2/2. */
static void oscillator(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0.1, 0, 0, 1);
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", p[0]);
}

static void adjoint_gives_the_derivative_by_the_start(void **state) {
  (void)state;
  enum { N = 150 };
  const double h = 0.01, strength = 40, a = acos(1 - h * h * strength / 2);
  varied_runs r;
  varied_open(&r, oscillator, "leapfrog", (double[]){strength, 1, 1, 1}, 1, h);
  varied_run(&r, N * h);
  double X[6] = {1}, slope;
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &slope, &error), HK_OK);
  assert_true(fabs(X[0] - cos(N * a)) < 1e-12);
  assert_true(fabs(X[3] - h * sin(N * a) / sin(a)) < 1e-12);
  double exact = -0.1 * N * sin(N * a) * h * h / (2 * sin(a));
  assert_true(fabs(slope - exact) < 1e-9 * fabs(exact));
  varied_close(&r);
}

/* Of backward Euler x_N = Re (R^N (x - i v/w)), R = 1/(1 - i h w), of the implicit midpoint rule R = (1 + i h w/2)/(1 -
 * i h w/2). The strength w^2 is compared between scenes. */
static void adjoint_of_implicit_steps_has_the_closed_form(void **state) {
  (void)state;
  enum { N = 150 };
  const double h = 0.01, w = sqrt(40);
  for (int midpoint = 0; midpoint < 2; midpoint++) {
    double complex part = I * h * (midpoint ? 0.5 : 1), up = midpoint ? 1 + part * w : 1, down = 1 - part * w;
    double complex R = cpow(up / down, N), by_w = N * R * ((midpoint ? part / up : 0) + part / down);
    varied_runs r;
    varied_open(&r, oscillator, midpoint ? "implicit_midpoint" : "backward_euler", (double[]){40, 1, 1, 1}, 1, h);
    varied_run(&r, N * h);
    double X[6] = {1}, slope;
    hk_error error = {0};
    assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &slope, &error), HK_OK);
    assert_true(fabs(X[0] - creal(R)) < 1e-12);
    assert_true(fabs(X[3] - cimag(R) / w) < 1e-12);
    double exact = 0.1 * creal(by_w) / (2 * w);
    assert_true(fabs(slope - exact) < 1e-9 * fabs(exact));
    varied_close(&r);
  }
}

/* Further adjoints of a run take derivatives by parameters from the first one: of twice a number they are twice as
 * large, bit by bit, and so where nothing was kept. */
static void further_adjoints_are_those_of_a_first_one(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, "rk4", start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.2);
  double slope[3][VARIED_PARAMETERS];
  hk_error error = {0};
  for (int which = 0; which < 3; which++) {
    double X[24] = {0.7 * (which == 1 ? 2 : 1), 0, 0.5 * (which == 1 ? 2 : 1)};
    if (which == 2) r.s->shared_of = NULL;
    assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, VARIED_PARAMETERS, slope[which], &error), HK_OK);
    assert_non_null(r.s->shared);
  }
  for (int j = 0; j < VARIED_PARAMETERS; j++)
    assert_true(slope[0][j] == slope[2][j] && slope[1][j] == 2 * slope[0][j] && slope[0][j] != 0);
  varied_close(&r);
}

/* By the values of a function of time at knots: together they are the derivative by a number. */
static void knots_share_the_derivative_by_a_number(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, varied_tetrahedron, "leapfrog", start, 1, 2e-3);
  varied_run(&r, 0.4);
  double values[5], number, slope, X[24] = {1, 0, 0.5};
  hk_error error = {0};
  assert_int_equal(hk_sensitivity_adjoint(r.s, X, r.by, 1, &number, &error), HK_OK);
  for (size_t count = 2; count <= 5; count++) {
    double sum = 0, back[24] = {1, 0, 0.5};
    hk_knots knots = {.count = count, .begin = 0, .end = 0.4, .slope = values};
    r.by[0].knots = &knots;
    assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, 1, &slope, &error), HK_OK);
    for (size_t k = 0; k < count; k++) sum += values[k];
    assert_true(fabs(sum - number) < 1e-12 * fabs(number));
    assert_true(fabs(slope - number) < 1e-12 * fabs(number));
    if (count == 5) assert_true(fabs(values[4]) < 0.1 * fabs(number)); /* late forces have hardly moved anything */
  }
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(adjoint_is_the_transpose_of_the_tangents),
      cmocka_unit_test(states_kept_in_place_of_points_change_nothing),
      cmocka_unit_test(derivatives_by_forces_are_those_between_scenes),
      cmocka_unit_test(linear_steps_have_the_matrices_of_all_forces),
      cmocka_unit_test(adjoint_gives_the_derivative_by_the_start),
      cmocka_unit_test(adjoint_of_implicit_steps_has_the_closed_form),
      cmocka_unit_test(further_adjoints_are_those_of_a_first_one),
      cmocka_unit_test(knots_share_the_derivative_by_a_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
