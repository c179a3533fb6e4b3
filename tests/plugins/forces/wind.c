/* Wind on triangles: by hand, against drag and lift written with angles, against a falling plate's closed form, against
 * differences of itself; turned over, without area, without relative wind, on chosen triangles, on any threads. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 7, T = 5 };

/* A crumpled strip, and one triangle apart from it. */
static const uint32_t strip[T][3] = {{1, 2, 3}, {3, 2, 4}, {3, 4, 5}, {1, 5, 3}, {2, 6, 7}};

static void triangles(test_engine *e, const uint32_t (*list)[3], size_t count) {
  assert_int_equal(hk_scene_add_triangles(e->scene, count, list, &e->error), HK_OK);
}

static hk_plugin_spec *open_wind(test_engine *e, double wx, double wy, double wz) {
  hk_plugin_spec *wind = test_plugin(e, HK_FORCE, "wind");
  test_vector(e, wind, "velocity", wx, wy, wz);
  e->options.dt = 1e-3;
  return wind;
}

static const char *const coefficient_name[] = {"density", "drag", "lift", "friction", "linear"};

static void set_coefficients(test_engine *e, hk_plugin_spec *wind, const double value[5]) {
  for (int k = 0; k < 5; k++) test_number(e, wind, coefficient_name[k], value[k]);
}

static const double general[5] = {1.3, 1.1, 0.8, 0.2, 0.7};

static hk_plugin_spec *open_strip(test_engine *e) {
  static const double x[N][3] = {{0, 0, 0.1},   {1, 0.2, -0.1}, {0.3, 1.1, 0},   {1.2, 1.3, 0.6},
                                 {0.2, 2, 0.9}, {2, 0.5, 1},    {1.8, 1.5, -0.3}};
  test_engine_open(e);
  for (int i = 0; i < N; i++) test_particle(e, x[i][0], x[i][1], x[i][2], 1 + i);
  for (size_t k = 0; k < 3 * N; k++) e->scene->particles.velocity[k] = 2 * sin(1.7 * (double)k);
  triangles(e, strip, T);
  hk_plugin_spec *wind = open_wind(e, 3, -1, 2);
  set_coefficients(e, wind, general);
  return wind;
}

/* ---- Values ------------------------------------------------------------------------------------------------------ */

static void check(const double coefficient[5], const double each[3]) {
  test_engine e;
  double F[9];
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
  triangles(&e, (const uint32_t[][3]){{1, 2, 3}}, 1);
  hk_plugin_spec *spec = open_wind(&e, 3, 0, 4);
  set_coefficients(&e, spec, coefficient);
  test_run(&e);
  hk_instance *wind = test_instance(&e, spec);
  hk_view view = force_view(&e, wind);
  assert_true(force_evaluate(wind, &view, F) == 0);
  for (int k = 0; k < 9; k++) assert_true(fabs(F[k] - each[k % 3]) < 1e-14); /* some roundings of numbers up to 10 */
  test_engine_close(&e);
}

/* Area 1/2, |u| = 5, sin alpha = 0.8, cos alpha = 0.6; u points along (0.6, 0, 0.8), lift along (-0.8, 0, 0.6).
 * With density 2, 1/2 rho A u^2 = 12.5: drag 12.5 (0.64 + 0.1 0.36) = 8.45, lift 12.5 0.5 0.96 = 6. */
static void wind_by_hand(void **state) {
  (void)state;
  check((double[]){2, 1, 0.5, 0.1, 0}, (double[]){0.27 / 3, 0, 10.36 / 3});
  check((double[]){2, 1, 0, 0, 0}, (double[]){8 * 0.6 / 3, 0, 8 * 0.8 / 3});
  check((double[]){2, 0, 0.5, 0, 0}, (double[]){-4.8 / 3, 0, 3.6 / 3});
  check((double[]){2, 0, 0, 1, 0}, (double[]){4.5 * 0.6 / 3, 0, 4.5 * 0.8 / 3});
  check((double[]){2, 1, 0.5, 0, 0}, (double[]){0, 0, 10.0 / 3}); /* drag = 2 lift: along the normal */
  check((double[]){1, 0, 0, 0, 3}, (double[]){0, 0, 3 * 0.5 * 4 / 3});
}

static double length(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* Drag and lift of one triangle with the angle itself. */
static void by_angles(const double x[3][3], const double v[3][3], const double w[3], double F[3]) {
  double n[3], u[3], a[3], b[3], up[3], ue = 0;
  for (int c = 0; c < 3; c++) a[c] = x[1][c] - x[0][c], b[c] = x[2][c] - x[0][c];
  for (int c = 0; c < 3; c++) n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  for (int c = 0; c < 3; c++) u[c] = w[c] - (v[0][c] + v[1][c] + v[2][c]) / 3;
  double area = length(n) / 2, speed = length(u), un = 0;
  for (int c = 0; c < 3; c++) un += u[c] * n[c] / (2 * area);
  for (int c = 0; c < 3; c++) n[c] *= (un < 0 ? -1 : 1) / (2 * area); /* to leeward */
  double alpha = asin(fabs(un) / speed), pressure = general[0] / 2 * area * speed * speed;
  double drag = pressure * (general[1] * pow(sin(alpha), 2) + general[3] * pow(cos(alpha), 2));
  double lift = pressure * general[2] * sin(2 * alpha);
  for (int c = 0; c < 3; c++) ue += n[c] * u[c] / speed;
  for (int c = 0; c < 3; c++) up[c] = n[c] - ue * u[c] / speed;
  double size = length(up);
  for (int c = 0; c < 3; c++) F[c] = drag * u[c] / speed + lift * up[c] / size + general[4] * area * fabs(un) * n[c];
}

/* The strip's total is what flows in from the air, and its power what F does on the corners. Sums of some tens of terms
 * of up to 10 N and 30 W. */
static void wind_is_drag_and_lift_and_their_power(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_strip(&e);
  double F[3 * N], total[3] = {0}, known[3] = {0}, work = 0;
  test_run(&e);
  hk_instance *wind = test_instance(&e, spec);
  hk_view view = force_view(&e, wind);
  double power = force_evaluate(wind, &view, F);
  for (size_t t = 0; t < T; t++) {
    double x[3][3], v[3][3], one[3];
    for (int r = 0; r < 3; r++) {
      memcpy(x[r], view.x + 3 * (strip[t][r] - 1), sizeof x[r]);
      memcpy(v[r], view.v + 3 * (strip[t][r] - 1), sizeof v[r]);
    }
    by_angles((const double(*)[3])x, (const double(*)[3])v, (double[]){3, -1, 2}, one);
    for (int c = 0; c < 3; c++) known[c] += one[c];
  }
  for (int k = 0; k < 3 * N; k++) total[k % 3] += F[k], work += F[k] * view.v[k];
  for (int c = 0; c < 3; c++) assert_true(fabs(total[c] - known[c]) < 1e-13 && fabs(known[c]) > 0.5);
  assert_true(fabs(power - work) < 1e-13 && fabs(work) > 0.5);
  test_engine_close(&e);
}

/* Only the relative wind counts; in air at rest the power is never positive. */
static void wind_is_the_same_in_a_moving_frame_and_takes_energy_from_what_moves_in_still_air(void **state) {
  (void)state;
  double F[2][3 * N], v[3 * N];
  for (int moving = 0; moving < 2; moving++) {
    test_engine e;
    hk_plugin_spec *spec = open_strip(&e);
    test_vector(&e, spec, "velocity", moving ? 13.0 : 0, moving ? -4.0 : 0, moving ? 2.5 : 0);
    test_run(&e);
    hk_instance *wind = test_instance(&e, spec);
    hk_view view = force_view(&e, wind);
    for (int k = 0; k < 3 * N; k++) v[k] = view.v[k] + (moving ? (double[]){13, -4, 2.5}[k % 3] : 0);
    view.v = v;
    double power = force_evaluate(wind, &view, F[moving]);
    assert_true(moving || power < -0.1);
    test_engine_close(&e);
  }
  for (int k = 0; k < 3 * N; k++) assert_true(fabs(F[0][k] - F[1][k]) < 1e-13); /* roundings of velocities up to 15 */
}

static void a_triangle_turned_over_feels_the_same(void **state) {
  (void)state;
  double F[3][3 * N];
  for (int turned = 0; turned < 3; turned++) {
    test_engine e;
    hk_plugin_spec *spec = open_strip(&e);
    for (size_t t = 0; t < T && turned; t++)
      for (int r = 0; r < 3; r++)
        e.scene->particles.triangle[t][r] = strip[t][turned == 1 ? 2 - r : (r + 1) % 3]; /* mirrored, rotated */
    test_run(&e);
    hk_instance *wind = test_instance(&e, spec);
    hk_view view = force_view(&e, wind);
    force_evaluate(wind, &view, F[turned]);
    test_engine_close(&e);
  }
  for (int k = 0; k < 3 * N; k++) assert_true(fabs(F[0][k] - F[1][k]) < 1e-14 && fabs(F[0][k] - F[2][k]) < 1e-14);
}

/* ---- A falling plate --------------------------------------------------------------------------------------------- */

/* A square across its path with masses as the corners' shares of the area: it stays in one plane without springs, and
 * m v' = m g - 1/2 rho A drag v^2 gives v = V tanh(g t / V), V^2 = 2 m g / (rho A drag); the depth is
 * V^2/g ln cosh(g t / V). Here V = 10 / sqrt(1.2) m/s; t = 2.5 V / g. rk4 with g h / V = 1e-3 is good to 1e-13. */
static void a_falling_plate_reaches_its_terminal_velocity(void **state) {
  (void)state;
  test_engine e;
  double g = 10, rho = 1.2, drag = 1.25, side = 2, m = 30, V = sqrt(2 * m * g / (rho * drag * side * side));
  double duration = 2.5 * V / g;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, m / 3), test_particle(&e, side, 0, 0, m / 6);
  test_particle(&e, side, side, 0, m / 3), test_particle(&e, 0, side, 0, m / 6);
  triangles(&e, (const uint32_t[][3]){{1, 2, 3}, {1, 4, 3}}, 2);
  hk_plugin_spec *wind = open_wind(&e, 0, 0, 0), *gravity = test_plugin(&e, HK_FORCE, "gravity");
  set_coefficients(&e, wind, (double[]){rho, drag, 0.3, 0.1, 0});
  test_vector(&e, gravity, "g", 0, 0, -g);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  e.scene->duration = duration;
  e.scene->fps = 1 / duration;
  e.options.dt = 1e-3 * V / g;
  test_run(&e);
  test_advance(&e, duration);
  for (uint32_t id = 1; id <= 4; id++) {
    const double *x = test_position(&e, id), *v = test_velocity(&e, id);
    assert_true(fabs(v[2] / (V * tanh(2.5)) + 1) < 1e-12 && fabs(x[2] / (V * V / g * log(cosh(2.5))) + 1) < 1e-12);
    assert_true(v[0] == 0 && v[1] == 0);
  }
  test_engine_close(&e);
}

/* ---- Jacobian ---------------------------------------------------------------------------------------------------- */

static void wind_jacobian_is_exact_and_unsymmetric(void **state) {
  (void)state;
  for (int k = 0; k < 5; k++) { /* all coefficients together, then each alone */
    test_engine e;
    hk_plugin_spec *spec = open_strip(&e);
    double one[5] = {1.3}, K[9 * N * N], D[9 * N * N], skew = 0;
    one[k] = k > 0 ? 0.9 : 1.3;
    if (k > 0) set_coefficients(&e, spec, one);
    test_run(&e);
    hk_instance *wind = test_instance(&e, spec);
    hk_view view = force_view(&e, wind);
    assert_int_equal(force_matrices(wind, &view, K, D), 9 * T);
    assert_true(force_stiffness_error(wind, &view) < FORCE_DIFFERENCES);
    assert_true(force_damping_error(wind, &view) < FORCE_DIFFERENCES);
    for (int r = 0; r < 3 * N; r++)
      for (int c = 0; c < r; c++) skew = fmax(skew, fabs(K[3 * N * r + c] - K[3 * N * c + r]));
    assert_true(skew > 0.1);
    assert_false(wind->plugin->force->flags & (HK_SYMMETRIC_JACOBIAN | HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE));
    test_engine_close(&e);
  }
}

/* Edge-on to the wind the angle of attack changes its sign; the slope must not jump there: the Jacobians a little to
 * either side differ in proportion to the angle. A law whose lift does not vanish edge-on fails here. */
static void the_slope_does_not_jump_where_a_triangle_is_edge_on(void **state) {
  (void)state;
  test_engine e;
  double K[3][81], D[3][81], v[9] = {0};
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
  triangles(&e, (const uint32_t[][3]){{1, 2, 3}}, 1);
  hk_plugin_spec *spec = open_wind(&e, 3, 1, 0);
  set_coefficients(&e, spec, general);
  test_run(&e);
  hk_instance *wind = test_instance(&e, spec);
  hk_view view = force_view(&e, wind);
  assert_true(force_stiffness_error(wind, &view) < FORCE_DIFFERENCES);
  assert_true(force_damping_error(wind, &view) < FORCE_DIFFERENCES);
  view.v = v;
  for (int side = 0; side < 3; side++) {
    for (int k = 2; k < 9; k += 3) v[k] = (side - 1) * 1e-8;
    force_matrices(wind, &view, K[side], D[side]);
  }
  for (int k = 0; k < 81; k++) /* 1e-8 m/s times second derivatives of order 1 */
    assert_true(fabs(K[0][k] - K[2][k]) < 1e-7 && fabs(D[0][k] - D[2][k]) < 1e-7);
  test_engine_close(&e);
}

/* ---- Nothing to blow on ------------------------------------------------------------------------------------------ */

static void expect_finite(const hk_instance *wind, const hk_view *view, bool still) {
  double F[9], K[81], D[81];
  assert_true(isfinite(force_evaluate(wind, view, F)));
  force_matrices(wind, view, K, D);
  for (int k = 0; k < 9; k++) assert_true(isfinite(F[k]) && (!still || F[k] == 0));
  for (int k = 0; k < 81; k++) assert_true(isfinite(K[k]) && isfinite(D[k]) && (!still || K[k] == 0));
}

/* Squares of lengths that underflow, and lengths that do; the last scale is an ordinary one. */
static void triangles_without_area_and_air_without_motion_are_no_trouble(void **state) {
  (void)state;
  static const double shape[4][9] = {
      {0}, {0, 0, 0, 1, 1, 1, 2, 2, 2}, {0, 0, 0, 0, 0, 0, 1, 0, 1}, {0, 0, 0, 1, 0, 0, 0.3, 1, 0}};
  static const double scale[] = {1e-320, 1e-163, 1e-155, 1e-140, 1e-75, 1e-20, 1};
  test_engine e;
  double x[9], v[9];
  test_engine_open(&e);
  for (int i = 0; i < 3; i++) test_particle(&e, i, i * i, 0, 1);
  triangles(&e, (const uint32_t[][3]){{1, 2, 3}}, 1);
  hk_plugin_spec *spec = open_wind(&e, 0, 0, 0);
  set_coefficients(&e, spec, (double[]){1.3, 1.1, 0.8, 0.2, 0}); /* linear alone has a slope at u = 0 */
  test_run(&e);
  hk_instance *wind = test_instance(&e, spec);
  hk_view view = force_view(&e, wind);
  view.x = x, view.v = v;
  for (size_t s = 0; s < 4 * 49; s++) {
    double size = scale[s / 4 % 7], speed = scale[s / 28];
    for (int k = 0; k < 9; k++) x[k] = size * shape[s % 4][k], v[k] = speed * sin(k + 1.0);
    expect_finite(wind, &view, s % 4 == 0);
    memset(v, 0, sizeof v);
    expect_finite(wind, &view, true);
  }
  test_engine_close(&e);
}

static void wind_without_triangles_is_refused(void **state) {
  (void)state;
  for (int with = 0; with < 2; with++) {
    test_engine e;
    test_engine_open(&e);
    for (int i = 0; i < 3; i++) test_particle(&e, i, i * i, 0, 1);
    if (with) triangles(&e, (const uint32_t[][3]){{1, 2, 3}}, 1);
    hk_plugin_spec *wind = open_wind(&e, 1, 0, 0);
    wind->only = malloc(2 * sizeof *wind->only);
    memcpy(wind->only, (uint32_t[]){0, 2}, 2 * sizeof(uint32_t));
    wind->only_count = 2;
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    assert_non_null(strstr(e.error.text, with ? "`only`" : "has no triangles"));
    test_engine_close(&e);
  }
}

/* ---- Which triangles --------------------------------------------------------------------------------------------- */

/* All but particle 5: the first two triangles and the last are left, here alone in a scene of their own. */
static void wind_acts_on_triangles_with_all_corners_active(void **state) {
  (void)state;
  test_engine e, wanted;
  double F[3 * N], G[3 * N], K[9 * N * N], D[9 * N * N];
  hk_plugin_spec *wind_spec = open_strip(&e), *other_spec = open_strip(&wanted);
  wind_spec->only = malloc((N - 1) * sizeof *wind_spec->only);
  memcpy(wind_spec->only, (uint32_t[]){0, 1, 2, 3, 5, 6}, (N - 1) * sizeof(uint32_t));
  wind_spec->only_count = N - 1;
  memcpy(wanted.scene->particles.triangle[2], strip[4], sizeof strip[4]);
  wanted.scene->particles.triangles = 3;
  test_run(&e);
  hk_instance *wind = test_instance(&e, wind_spec);
  test_run(&wanted);
  hk_instance *other = test_instance(&wanted, other_spec);
  hk_view view = force_view(&e, wind), all = force_view(&wanted, other);
  assert_true(force_evaluate(wind, &view, F) == force_evaluate(other, &all, G));
  assert_memory_equal(F, G, sizeof F);
  assert_true(F[3 * 4] == 0 && F[3 * 3] != 0);
  assert_int_equal(force_matrices(wind, &view, K, D), 9 * 3);
  assert_true(force_stiffness_error(wind, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
  test_engine_close(&wanted);
}

/* Particle 5 dies, and with it the third and the fourth triangle. */
static void wind_follows_deaths(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_strip(&e);
  const uint32_t map[N] = {0, 1, 2, 3, UINT32_MAX, 4, 5}, left[3][3] = {{0, 1, 2}, {2, 1, 3}, {1, 4, 5}};
  double F[2][3 * N], x[3 * N], v[3 * N];
  test_run(&e);
  hk_instance *wind = test_instance(&e, spec);
  hk_view view = force_view(&e, wind);
  hk_model model = *view.model;
  force_evaluate(wind, &view, F[0]);
  memcpy(x, view.x, sizeof x);
  memcpy(v, view.v, sizeof v);
  memmove(x + 12, x + 15, 6 * sizeof *x);
  memmove(v + 12, v + 15, 6 * sizeof *v);
  model.n = N - 1, model.triangles = (hk_tuples){3, 3, &left[0][0]};
  view.x = x, view.v = v, view.model = &model, view.n = view.acting = N - 1;
  assert_int_equal(hk_instance_remap(wind, map, N, &view, 6 * N - 5, &e.error), HK_OK);
  assert_true(force_evaluate(wind, &view, F[1]) != 0);
  assert_memory_equal(F[0] + 15, F[1] + 12, 6 * sizeof(double)); /* the triangle apart did not know the dead */
  assert_true(F[0][0] != F[1][0]);
  assert_true(force_stiffness_error(wind, &view) < FORCE_DIFFERENCES);
  test_engine_close(&e);
}

/* ---- Threads and memory ------------------------------------------------------------------------------------------ */

enum { SIDE = 71, MANY = SIDE * SIDE, CELLS = 2 * (SIDE - 1) * (SIDE - 1) };

static hk_plugin_spec *open_sheet(test_engine *e, double *x) {
  static uint32_t list[CELLS][3];
  uint32_t id, k = 0;
  test_engine_open(e);
  for (size_t i = 0; i < MANY; i++) {
    x[3 * i] = (double)(i % SIDE), x[3 * i + 1] = (double)(i / SIDE), x[3 * i + 2] = sin((double)i);
  }
  assert_int_equal(hk_scene_add_particles(e->scene, MANY, x, NULL, NULL, 1, 0, &id, &e->error), HK_OK);
  for (uint32_t a = 1; a < MANY - SIDE; a++) {
    if (a % SIDE == 0) continue;
    memcpy(list[k++], (uint32_t[]){a, a + 1, a + SIDE + 1}, sizeof *list);
    memcpy(list[k++], (uint32_t[]){a, a + SIDE + 1, a + SIDE}, sizeof *list);
  }
  triangles(e, (const uint32_t(*)[3])list, k);
  hk_plugin_spec *wind = open_wind(e, 2, 3, -1);
  set_coefficients(e, wind, general);
  return wind;
}

static void by_slots(const hk_instance *wind, const hk_view *view, size_t *slot, double *K, double *D) {
  for (size_t t = 0; t < CELLS; t++) /* all blocks of a row in one: as much sharing as rows allow */
    for (size_t b = 0; b < 9; b++) slot[9 * t + b] = hk_tuple(&view->model->triangles, t)[b / 3];
  memset(K, 0, 9 * MANY * sizeof *K);
  memset(D, 0, 9 * MANY * sizeof *D);
  hk_blocks into = {.slot = slot, .K = K, .D = D};
  assert_int_equal(hk_force_of(wind->plugin)->implicit.jacobian(wind->self, view, &into), HK_OK);
}

static void wind_is_the_same_on_any_threads(void **state) {
  (void)state;
  double *room = malloc((2 * 3 + 4 * 9 + 3) * MANY * sizeof *room), power[3];
  double *F = room, *first = F + 3 * MANY, *K = first + 3 * MANY, *D = K + 9 * MANY, *K1 = D + 9 * MANY;
  double *D1 = K1 + 9 * MANY, *v = D1 + 9 * MANY;
  size_t *slot = malloc(9 * CELLS * sizeof *slot);
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    hk_plugin_spec *spec = open_sheet(&e, v);
    e.scene->threads = threads;
    test_run(&e);
    hk_instance *wind = test_instance(&e, spec);
    hk_view view = force_view(&e, wind);
    for (size_t k = 0; k < 3 * MANY; k++) v[k] = cos((double)k);
    view.v = v;
    power[threads - 1] = force_evaluate(wind, &view, threads == 1 ? first : F);
    by_slots(wind, &view, slot, threads == 1 ? K1 : K, threads == 1 ? D1 : D);
    if (threads > 1) {
      assert_memory_equal(first, F, 3 * MANY * sizeof *F);
      assert_memory_equal(K1, K, 9 * MANY * sizeof *K);
      assert_memory_equal(D1, D, 9 * MANY * sizeof *D);
    }
    test_engine_close(&e);
  }
  assert_true(power[0] != 0 && power[0] == power[1] && power[0] == power[2]);
  free(room);
  free(slot);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    open_strip(&e);
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 4);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(wind_by_hand),
      cmocka_unit_test(wind_is_drag_and_lift_and_their_power),
      cmocka_unit_test(wind_is_the_same_in_a_moving_frame_and_takes_energy_from_what_moves_in_still_air),
      cmocka_unit_test(a_triangle_turned_over_feels_the_same),
      cmocka_unit_test(a_falling_plate_reaches_its_terminal_velocity),
      cmocka_unit_test(wind_jacobian_is_exact_and_unsymmetric),
      cmocka_unit_test(the_slope_does_not_jump_where_a_triangle_is_edge_on),
      cmocka_unit_test(triangles_without_area_and_air_without_motion_are_no_trouble),
      cmocka_unit_test(wind_without_triangles_is_refused),
      cmocka_unit_test(wind_acts_on_triangles_with_all_corners_active),
      cmocka_unit_test(wind_follows_deaths),
      cmocka_unit_test(wind_is_the_same_on_any_threads),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
