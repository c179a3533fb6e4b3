/* The force barrier in runs: impacts keep momentum and gain no energy with any method; sheets fall on each other
 * without an intersection; the pressure between sheets does not hang on their meshes; Coulomb's friction; what lies
 * still stays still; obstacles that close end the run with words. hooke check has its derivatives, checkpoints, births
 * and threads. */
#include "plugins/common/contact/barrier/barrier_function.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const double g = 9.81, radius = 0.01, reach = 1e-3;

static void open_world(test_engine *e, const char *method, double h) {
  test_engine_open(e);
  e->options.integrator = method;
  e->options.dt = h;
  e->scene->duration = 1000;
  e->scene->fps = 60;
}

static uint32_t put(test_engine *e, const double x[3], const double v[3], double mass) {
  uint32_t id = test_particle(e, x[0], x[1], x[2], mass);
  if (v) memcpy(e->scene->particles.velocity + 3 * (size_t)(id - 1), v, 3 * sizeof *v);
  return id;
}

static hk_plugin_spec *add_barrier(test_engine *e, double friction) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "barrier");
  test_number(e, spec, "radius", radius);
  test_number(e, spec, "d_hat", reach);
  test_number(e, spec, "friction", friction);
  return spec;
}

static void fall(test_engine *e, double x, double z) {
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", x, 0, z);
}

static void add_triangle(test_engine *e, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t triangle[1][3] = {{a, b, c}};
  assert_int_equal(hk_scene_add_triangles(e->scene, 1, triangle, &e->error), HK_OK);
}

static void add_floor(test_engine *e) {
  uint32_t a = put(e, (double[]){-50, -50, 0}, NULL, 1), b = put(e, (double[]){50, -50, 0}, NULL, 1),
           c = put(e, (double[]){0, 80, 0}, NULL, 1);
  for (uint32_t id = a; id <= c; id++) test_pin(e, HK_PIN_FIXED, id, NULL);
  add_triangle(e, a, b, c);
}

/* n x n squares of side 1/n, with springs; its first id. */
static uint32_t add_sheet(test_engine *e, uint32_t n, const double at[3], double mass) {
  uint32_t first = 0, (*edge)[2] = calloc(3 * (size_t)(n + 1) * (n + 1), sizeof *edge);
  size_t edges = 0;
  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i <= n; i++) {
      uint32_t id =
          put(e, (double[]){at[0] + (double)i / n, at[1] + (double)j / n, at[2]}, NULL, mass / (n + 1) / (n + 1));
      if (!first) first = id;
      if (i) memcpy(edge[edges++], (uint32_t[]){id - 1, id}, sizeof *edge);
      if (j) memcpy(edge[edges++], (uint32_t[]){id - n - 1, id}, sizeof *edge);
      if (!i || !j) continue;
      memcpy(edge[edges++], (uint32_t[]){id - n - 2, id}, sizeof *edge);
      add_triangle(e, id - n - 2, id - n - 1, id);
      add_triangle(e, id - n - 2, id, id - 1);
    }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 500);
  test_number(e, springs, "damping", 0.1);
  free(edge);
  return first;
}

static hk_summary summary_of(test_engine *e) {
  hk_summary s;
  hk_run_summary(e->run, &s);
  return s;
}

static double total_energy(test_engine *e) {
  double kinetic, potential, work;
  hk_run_energy(e->run, &kinetic, &potential, &work);
  return kinetic + potential - work;
}

/* ---- impacts ---- */

/* Masses of 1 and 2 kg at 1 m/s each way; momentum -1 kg m/s. */
static void impacts_keep_momentum_and_gain_no_energy(void **state) {
  (void)state;
  const struct {
    const char *name;
    double h;
  } methods[] = {{"bdf2", 1. / 120},
                 {"backward_euler", 1. / 120},
                 {"tr_bdf2", 1. / 120},
                 {"baraff_witkin", 1. / 120},
                 {"implicit_midpoint", 1. / 120},
                 {"leapfrog", NAN},
                 {"rk4", NAN}};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine t;
    open_world(&t, methods[k].name, methods[k].h);
    uint32_t a = put(&t, (double[]){-0.05, 0, 0}, (double[]){1, 0, 0}, 1),
             b = put(&t, (double[]){0.05, 0, 0}, (double[]){-1, 0, 0}, 2);
    add_barrier(&t, 0);
    test_run(&t);
    test_advance(&t, 0.1);
    const double *v = test_velocity(&t, a), *w = test_velocity(&t, b);
    double before = 1.5, after = v[0] * v[0] / 2 + w[0] * w[0];
    print_message("%-18s %zu steps, energy %.3f of what it was, momentum off by %.1e\n", methods[k].name,
                  t.run->record.steps, after / before, v[0] + 2 * w[0] + 1);
    assert_true(test_position(&t, b)[0] - test_position(&t, a)[0] > 2 * radius);
    assert_true(w[0] >= v[0]);
    assert_true(fabs(v[0] + 2 * w[0] + 1) < 1e-12); /* rounding of some thousand steps */
    assert_true(after < before * (1 + 1e-3));       /* explicit methods conserve it up to their error */
    test_engine_close(&t);
  }
}

/* A point falls on a free triangle off its middle: the implicit midpoint rule keeps angular momentum but for the
 * tolerance of its iteration. */
static void angular_momentum_is_kept(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, "implicit_midpoint:tolerance=1e-12", 1e-3);
  uint32_t a = put(&t, (double[]){0, 0, 0}, NULL, 1), b = put(&t, (double[]){1, 0, 0}, NULL, 2),
           c = put(&t, (double[]){0, 1, 0}, NULL, 3), p = put(&t, (double[]){0.2, 0.3, 0.03}, (double[]){0, 0, -1}, 1);
  add_triangle(&t, a, b, c);
  const uint32_t edge[3][2] = {{a, b}, {b, c}, {c, a}};
  hk_plugin_spec *springs = test_plugin(&t, HK_FORCE, "springs");
  test_edges(&t, springs, edge, 3);
  test_number(&t, springs, "k", 1000);
  add_barrier(&t, 0);
  test_run(&t);
  test_advance(&t, 0.1);
  const double mass[] = {1, 2, 3, 1};
  double L[3] = {0}, wanted[3] = {-0.3, 0.2, 0};
  for (uint32_t id = 1; id <= 4; id++) {
    const double *x = test_position(&t, id), *v = test_velocity(&t, id);
    for (int k = 0; k < 3; k++)
      L[k] += mass[id - 1] * (x[(k + 1) % 3] * v[(k + 2) % 3] - x[(k + 2) % 3] * v[(k + 1) % 3]);
  }
  print_message("angular momentum off by %.1e, %.1e, %.1e\n", L[0] - wanted[0], L[1] - wanted[1], L[2] - wanted[2]);
  for (int k = 0; k < 3; k++) assert_true(fabs(L[k] - wanted[k]) < 1e-9);
  assert_true(test_velocity(&t, p)[2] > -0.9);
  test_engine_close(&t);
}

/* ---- sheets ---- */

/* N, with which two sheets of 1 m^2 at half the barrier's reach push each other apart. */
static double push(uint32_t n) {
  test_engine t;
  open_world(&t, "bdf2", 1e-3);
  add_sheet(&t, n, (double[]){0, 0, 0}, 1);
  uint32_t upper = add_sheet(&t, n, (double[]){0.31 / n, 0.17 / n, reach / 2}, 1);
  hk_plugin_spec *spec = add_barrier(&t, 0);
  test_number(&t, spec, "stiffness", 1000);
  test_run(&t);
  hk_instance *barrier = test_instance(&t, spec);
  hk_view view = force_view(&t, barrier);
  double *F = calloc(3 * view.n, sizeof *F), sum = 0;
  force_evaluate(barrier, &view, F);
  for (size_t i = upper - 1; i < view.n; i++) sum += F[3 * i + 2];
  free(F);
  test_engine_close(&t);
  return sum;
}

/* What is left of 1/n is the border, of which the sheets miss (0.31 + 0.17)/n, and which has other pairs. */
static void pressure_does_not_hang_on_the_mesh(void **state) {
  (void)state;
  double coarse = push(8), middle = push(16), fine = push(32), limit = 2 * fine - middle;
  print_message("push %.4g, %.4g, %.4g N\n", coarse, middle, fine);
  assert_true(fabs(coarse / limit - 1) < 1.5 / 8 && fabs(middle / limit - 1) < 1.5 / 16);
  assert_true(fabs((2 * middle - coarse) / limit - 1) < 0.01);
}

/* Three sheets fall on each other and on the floor; intersections are counted at every frame. */
static void sheets_fall_without_an_intersection(void **state) {
  (void)state;
  const char *const methods[] = {"bdf2:tolerance=1e-4", "backward_euler:tolerance=1e-4"};
  for (size_t k = 0; k < 2; k++) {
    test_engine t;
    open_world(&t, methods[k], 1. / 120);
    for (int layer = 1; layer <= 3; layer++)
      add_sheet(&t, 6, (double[]){0.03 * layer, 0.02 * layer, 0.02 * layer}, 0.2);
    add_floor(&t);
    fall(&t, 0, -g);
    add_barrier(&t, 0.3);
    test_run(&t);
    test_advance(&t, 0.25);
    hk_summary s = summary_of(&t);
    print_message("%s: %zu steps, %g intersections, closest %.2e m\n", methods[k], s.steps, s.intersections, s.closest);
    assert_true(s.contact_frames > 0 && s.intersections == 0 && s.closest > 0);
    test_engine_close(&t);
  }
}

/* ---- bits ---- */

/* Two sheets that fall on each other and on the floor, and rub. */
static void open_falling(test_engine *e, const char *method, double h, int threads) {
  open_world(e, method, h);
  e->options.threads = threads;
  for (int layer = 1; layer <= 2; layer++) add_sheet(e, 5, (double[]){0.03 * layer, 0.02 * layer, 0.004 * layer}, 0.2);
  add_floor(e);
  fall(e, 1, -g);
  add_barrier(e, 0.3);
}

/* Way 1 has three threads, way 2 goes on from where way 0 was at half of the time. Implicit methods go on bit by bit
 * from the frames of the output `checkpoint` alone, where they drop their factors
 * (tests/core/run/storage/going_on_long.c). */
static void compare(const char *method, double h, int ways) {
  char path[] = "/tmp/hooke-barrier-XXXXXX";
  int file = mkstemp(path);
  assert_true(file >= 0);
  close(file);
  double whole[6 * 128];
  for (int way = 0; way < ways; way++) {
    test_engine t;
    open_falling(&t, method, h, way == 1 ? 3 : 1);
    if (way == 2) t.scene->start_file = strdup(path);
    test_run(&t);
    if (way == 0) test_advance(&t, 0.05);
    if (way == 0 && hk_run_save(t.run, path, &t.error) != HK_OK) fail_msg("%s", t.error.text);
    test_advance(&t, 0.1);
    size_t size = 6 * t.run->state.model.n * sizeof *whole;
    assert_true(size <= sizeof whole && summary_of(&t).impulse > 0);
    if (way == 0) memcpy(whole, t.run->state.X, size);
    assert_memory_equal(t.run->state.X, whole, size);
    test_engine_close(&t);
  }
  remove(path);
}

static void threads_and_checkpoints_leave_no_trace(void **state) {
  (void)state;
  compare("bdf2:tolerance=1e-4", 1. / 120, 2);
  compare("leapfrog", NAN, 3);
}

/* ---- friction ---- */

/* m/s gained from 0.5 s to 1 s on a slope of tan = 1/2, in the frame of the slope. */
static double gained(double friction) {
  test_engine t;
  open_world(&t, "bdf2:tolerance=1e-6", 1. / 120);
  uint32_t id = put(&t, (double[]){0, 0, radius + 0.97 * reach}, NULL, 0.1);
  add_floor(&t);
  fall(&t, 0.5 * g / sqrt(1.25), -g / sqrt(1.25));
  add_barrier(&t, friction);
  test_run(&t);
  test_advance(&t, 0.5);
  double before = test_velocity(&t, id)[0];
  test_advance(&t, 1);
  double after = test_velocity(&t, id)[0];
  test_engine_close(&t);
  return after - before;
}

/* Coulomb's acceleration is g (tan - mu) cos: positive at mu = 0.495; at 0.505 what moves comes to rest, to the
 * iteration's tolerance. */
static void friction_on_a_slope_brackets_its_tangent(void **state) {
  (void)state;
  double below = gained(0.495), above = gained(0.505), wanted = 0.5 * g * 0.005 / sqrt(1.25);
  print_message("mu = 0.495: %.5f m/s in 0.5 s, expected %.5f; mu = 0.505: %.2e\n", below, wanted, above);
  assert_true(fabs(below - wanted) < 0.01 * wanted);
  assert_true(above <= 1e-6 * wanted);
}

/* m, the gap at which a particle rests on the floor: a bisection of its load. */
static double gap_at_rest(double stiffness, double weight) {
  double area = acos(-1) * pow(radius + reach / 2, 2), S = reach * (reach + 2 * radius), low = 0, high = reach;
  for (int k = 0; k < 60; k++) {
    double gap = (low + high) / 2, u = gap * (gap + 2 * radius) / S;
    double load = -stiffness * area * reach * hk_barrier_at(u).slope * 2 * (gap + radius) / S;
    if (load > weight)
      low = gap;
    else
      high = gap;
  }
  return low;
}

/* m: the way in 0.5 s of a particle that is let go with the speed v on a slope of tan, where the barrier carries it. */
static double way_down(const char *method, double h, double tan, double mu, double v) {
  test_engine t;
  double cos = 1 / sqrt(1 + tan * tan);
  open_world(&t, method, h);
  uint32_t id = put(&t, (double[]){0, 0, radius + gap_at_rest(1e4, 0.1 * g * cos)}, (double[]){v, 0, 0}, 0.1);
  add_floor(&t);
  fall(&t, tan * g * cos, -g * cos);
  test_number(&t, add_barrier(&t, mu), "stiffness", 1e4);
  test_run(&t);
  test_advance(&t, 0.5);
  double x = test_position(&t, id)[0];
  test_engine_close(&t);
  return x;
}

/* Of a method of order 2 whose stages are solved to 1e-6 of the speed: nothing of a uniform acceleration is lost. */
static void what_slides_has_coulombs_acceleration(void **state) {
  (void)state;
  const double tan = 0.5, mu = 0.4, wanted = 0.5 + g * (tan - mu) / sqrt(1 + tan * tan) * 0.125;
  for (int k = 0; k < 3; k++) {
    double h = (double[]){1. / 30, 1. / 60, 1. / 240}[k];
    double off = way_down("bdf2:tolerance=1e-6", h, tan, mu, 1) / wanted - 1;
    print_message("h = %.2g s: the way is off by %.1e\n", h, off);
    assert_true(fabs(off) < 1e-5);
  }
}

/* v^2/(2 mu g) on a floor. The step in which it stops is not resolved: it may be off by its share of v h. */
static void what_slides_stops_where_it_should(void **state) {
  (void)state;
  double wanted = 1 / g, off[2];
  for (int k = 0; k < 2; k++) {
    double h = k ? 1. / 480 : 1. / 120;
    off[k] = way_down("bdf2:tolerance=1e-6", h, 0, 0.5, 1) / wanted - 1;
    print_message("h = %.2g s: the way is off by %.2e\n", h, off[k]);
  }
  assert_true(fabs(off[0]) < 1e-3 && fabs(off[1]) < 1e-4);
}

/* Let go at once where friction just holds, at the tangent itself and 5 % above: with the elastic slip of d_hat/2000, a
 * law of velocities would have to hold to 2e-6 m/s for that. */
static void what_sticks_stays(void **state) {
  (void)state;
  double worst = 0;
  for (int k = 0; k < 12; k++) {
    const char *method = k % 2 ? "bdf2:tolerance=1e-6" : "backward_euler";
    double h = (double[]){1. / 60, 1. / 240, 1. / 1000}[k / 2 % 3], mu = k < 6 ? 0.5 : 0.525;
    double way = way_down(method, h, 0.5, mu, 0);
    print_message("%s, h = %.2g s, mu = %.3g: %.1e m in 0.5 s\n", method, h, mu, way);
    worst = fmax(worst, fabs(way));
  }
  assert_true(worst < 1e-6);
}

/* A ball that falls 2 cm onto a floor along which it goes at 3 m/s, mu = 0.4, in steps of a frame: while it slides, the
 * floor takes mu times the impulse along the normal from its speed, however that comes. bdf2's first step and the steps
 * that it repeats by backward Euler weigh both alike; the iteration's tolerance is 1e-6 of the speed a step. */
static void what_slides_loses_mu_times_its_impacts(void **state) {
  (void)state;
  const double mu = 0.4, speed = 3, drop = 0.02;
  double worst = 0;
  test_engine t;
  open_world(&t, "bdf2:tolerance=1e-6", 1. / 60);
  uint32_t id = put(&t, (double[]){0, 0, radius + reach + drop}, (double[]){speed, 0, 0}, 0.1);
  add_floor(&t);
  fall(&t, 0, -g);
  add_barrier(&t, mu);
  test_run(&t);
  for (int frame = 1; frame <= 30; frame++) {
    test_advance(&t, frame / 60.);
    double along = test_velocity(&t, id)[0], up = test_velocity(&t, id)[2] + g * frame / 60.;
    worst = fmax(worst, fabs(speed - along - mu * up));
  }
  print_message("the speed that is lost and mu times the impacts differ by %.1e m/s of %.2f\n", worst,
                speed - test_velocity(&t, id)[0]);
  assert_true(test_velocity(&t, id)[0] > 0.5 && test_velocity(&t, id)[0] < 0.7 * speed);
  assert_true(worst < 30 * 1e-6 * speed);
  test_engine_close(&t);
}

/* ---- rest ---- */

static void what_rests_keeps_its_energy_for_a_minute(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, "bdf2", 1. / 20);
  t.scene->fps = 20;
  for (int layer = 1; layer <= 3; layer++)
    add_sheet(&t, 2, (double[]){0.03 * layer, 0.02 * layer, 0.97 * reach * layer}, 0.2);
  add_floor(&t);
  fall(&t, 0, -g);
  add_barrier(&t, 0.3);
  test_run(&t);
  test_advance(&t, 10);
  double before = total_energy(&t), height = 3 * 0.2 * g * 2 * reach;
  test_advance(&t, 60);
  print_message("drift %.1e of the potential energy\n", (total_energy(&t) - before) / height);
  assert_true(fabs(total_energy(&t) - before) < 1e-3 * height);
  assert_true(summary_of(&t).intersections == 0);
  test_engine_close(&t);
}

/* ---- no way out ---- */

/* Scripted plates that meet at 0.1 s, with a particle between them. */
static hk_status sink(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out, size_t max,
                      size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max, (void)error;
  out[0] = out[1] = 0;
  out[2] = -in[0];
  *n_out = 3;
  return HK_OK;
}

static void plates_that_close_end_the_run_with_words(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, "bdf2", 1. / 120);
  add_floor(&t);
  uint32_t ids[3] = {put(&t, (double[]){-1, -1, 0.1}, NULL, 1), put(&t, (double[]){1, -1, 0.1}, NULL, 1),
                     put(&t, (double[]){0, 1, 0.1}, NULL, 1)};
  add_triangle(&t, ids[0], ids[1], ids[2]);
  uint32_t between = put(&t, (double[]){0, 0, 0.05}, NULL, 0.1);
  hk_pin_spec pin = {.kind = HK_PIN_PATH, .count = 3, .id = ids, .path = {.call = sink}, .release = INFINITY};
  assert_int_equal(hk_scene_add_pin(t.scene, &pin, &t.error), HK_OK);
  add_barrier(&t, 0.3);
  test_run(&t);
  hk_status status = hk_run_advance(t.run, 0.2, &t.error);
  print_message("%s\n", t.error.text);
  assert_int_equal(status, HK_NOT_CONVERGED);
  assert_non_null(strstr(t.error.text, "scripted particles move into contact"));
  for (int c = 0; c < 3; c++) assert_true(isfinite(test_position(&t, between)[c]));
  test_engine_close(&t);
}

static void a_start_in_contact_is_refused_by_name(void **state) {
  (void)state;
  test_engine t;
  open_world(&t, "bdf2", 1. / 120);
  put(&t, (double[]){0, 0, 0}, NULL, 1);
  put(&t, (double[]){1.5 * radius, 0, 0}, NULL, 1);
  add_barrier(&t, 0);
  assert_int_equal(hk_run_open(t.scene, &t.options, &t.run, &t.error), HK_BAD_PARAM);
  print_message("%s\n", t.error.text);
  assert_non_null(strstr(t.error.text, "particle 1 and particle 2 are in contact: their gap is -0.005 m"));
  test_engine_close(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(impacts_keep_momentum_and_gain_no_energy),
      cmocka_unit_test(angular_momentum_is_kept),
      cmocka_unit_test(pressure_does_not_hang_on_the_mesh),
      cmocka_unit_test(sheets_fall_without_an_intersection),
      cmocka_unit_test(threads_and_checkpoints_leave_no_trace),
      cmocka_unit_test(friction_on_a_slope_brackets_its_tangent),
      cmocka_unit_test(what_slides_has_coulombs_acceleration),
      cmocka_unit_test(what_slides_stops_where_it_should),
      cmocka_unit_test(what_sticks_stays),
      cmocka_unit_test(what_slides_loses_mu_times_its_impacts),
      cmocka_unit_test(what_rests_keeps_its_energy_for_a_minute),
      cmocka_unit_test(plates_that_close_end_the_run_with_words),
      cmocka_unit_test(a_start_in_contact_is_refused_by_name),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
