/* What must be conserved, by every integrator that the folder holds: momenta, the balance of energy, the way of the
 * centre of mass. */
#include "tests/support/engine.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { N = 8 };

enum { METHODS = 64 };
static char methods[METHODS][64];
static size_t method_count;

static int list_methods(void **state) {
  (void)state;
  DIR *folder = opendir(HK_BUILD "/plugins/integrators");
  for (struct dirent *entry; folder && (entry = readdir(folder));) {
    size_t length = strlen(entry->d_name);
    if (length < 4 || length > 60 || strcmp(entry->d_name + length - 3, ".so") != 0) continue;
    if (method_count == METHODS) return -1;
    memcpy(methods[method_count], entry->d_name, length - 3);
    methods[method_count++][length - 3] = 0;
  }
  if (folder) closedir(folder);
  return method_count >= 9 ? 0 : -1;
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53 - 0.5;
}

/* A deformed, spinning N x N cloth of random masses, free in space, 0.1 m wide; damped springs. */
static void free_cloth(test_engine *e, double damping) {
  uint64_t seed = 7;
  uint32_t edge[4 * N * N][2];
  size_t edges = 0;
  for (int j = 0; j < N; j++)
    for (int i = 0; i < N; i++)
      test_particle(e, 0.1 * i + 0.01 * noise(&seed), 0.1 * j + 0.01 * noise(&seed), 0.02 * noise(&seed),
                    0.01 + 0.02 * (noise(&seed) + 0.5));
  for (size_t k = 0; k < e->scene->particles.n; k++) {
    const double *x = e->scene->particles.position + 3 * k;
    double *v = e->scene->particles.velocity + 3 * k;
    v[0] = -3 * (x[1] - 0.35);
    v[1] = 3 * (x[0] - 0.35);
    v[2] = 0.5 * noise(&seed);
  }
  for (uint32_t j = 0; j < N; j++)
    for (uint32_t i = 0; i < N; i++) {
      uint32_t a = j * N + i + 1;
      if (i + 1 < N) edge[edges][0] = a, edge[edges++][1] = a + 1;
      if (j + 1 < N) edge[edges][0] = a, edge[edges++][1] = a + N;
      if (i + 1 < N && j + 1 < N) edge[edges][0] = a, edge[edges++][1] = a + N + 1;
    }
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])edge, edges);
  test_number(e, springs, "k", 50);
  test_number(e, springs, "damping", damping);
  test_number(e, springs, "rest", 0.1);
}

typedef struct moments {
  double mass, p[3], l[3], scale, x[3];
} moments;

static moments moments_of(const hk_view *view) {
  moments m = {0};
  for (size_t i = 0; i < view->n; i++) {
    const double *x = view->x + 3 * i, *v = view->v + 3 * i;
    double mass = view->model->mass[i];
    m.mass += mass;
    for (int c = 0; c < 3; c++) {
      m.p[c] += mass * v[c];
      m.x[c] += mass * x[c];
      m.scale += fabs(mass * v[c]);
      m.l[c] += mass * (x[(c + 1) % 3] * v[(c + 2) % 3] - x[(c + 2) % 3] * v[(c + 1) % 3]);
    }
  }
  for (int c = 0; c < 3; c++) m.x[c] /= m.mass;
  return m;
}

static double distance(const double *a, const double *b) {
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* Drift of linear and angular momentum after 0.2 s with steps of `h`. */
static void drift(const char *method, double h, double *linear, double *angular) {
  test_engine e;
  test_engine_open(&e);
  free_cloth(&e, 0.01);
  e.options.integrator = method;
  e.options.dt = h;
  e.options.tol = 1e-6;
  e.scene->fps = 5;
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  test_advance(&e, 0.2);
  moments after = moments_of(hk_run_view(e.run));
  *linear = distance(before.p, after.p) / before.scale;
  *angular = distance(before.l, after.l) / before.scale;
  test_engine_close(&e);
}

/* 64 particles, 1000 steps: sums of some 1e5 roundings of 1e-16, which add like a random walk. */
static void linear_momentum_is_kept_to_rounding_by_every_method(void **state) {
  (void)state;
  for (size_t k = 0; k < method_count; k++) {
    double linear, angular;
    drift(methods[k], 2e-4, &linear, &angular);
    if (!(linear < 1e-13)) fail_msg("%s: linear momentum drifts by %g", methods[k], linear);
  }
}

static void angular_momentum_is_kept_to_rounding_by_leapfrog(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  free_cloth(&e, 0); /* central forces of positions alone */
  e.options.integrator = "leapfrog";
  e.options.dt = 2e-4;
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  test_advance(&e, 0.2);
  moments after = moments_of(hk_run_view(e.run));
  assert_true(distance(before.l, after.l) / before.scale < 1e-13);
  test_engine_close(&e);
}

/* At the method's order: halving h divides the drift by 2^order, give or take a third in the exponent. */
static void angular_momentum_drifts_at_the_order_of_the_others(void **state) {
  (void)state;
  const struct {
    const char *name;
    double order, h;
  } cases[] = {{"euler", 1, 1e-4}, {"midpoint", 2, 4e-4},           {"trapezoid", 2, 4e-4},
               {"rk4", 4, 2e-3},   {"backward_euler", 1, 1e-4},     {"baraff_witkin", 1, 1e-4},
               {"bdf2", 2, 4e-4},  {"implicit_trapezoid", 2, 1e-3}, {"imex", 2, 4e-4}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double linear, coarse, fine;
    drift(cases[k].name, cases[k].h, &linear, &coarse);
    drift(cases[k].name, cases[k].h / 2, &linear, &fine);
    double order = log2(coarse / fine);
    if (!(order > cases[k].order - 0.34)) fail_msg("%s: angular momentum drifts at order %.2f", cases[k].name, order);
  }
}

/* A quadratic invariant: kept up to the algebraic error, 1e-12 of the speed in each of 100 steps. */
static void angular_momentum_is_kept_by_the_implicit_midpoint_rule(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  free_cloth(&e, 0);
  test_number(&e, test_plugin(&e, HK_INTEGRATOR, "implicit_midpoint"), "tolerance", 1e-12);
  e.options.dt = 2e-3;
  test_run(&e);
  moments before = moments_of(hk_run_view(e.run));
  test_advance(&e, 0.2);
  moments after = moments_of(hk_run_view(e.run));
  double off = distance(before.l, after.l) / before.scale;
  print_message("implicit_midpoint: angular momentum drifts by %g\n", off);
  assert_true(off < 1e-11);
  test_engine_close(&e);
}

/* In uniform gravity the centre of mass moves as one particle does under the same integrator and step. */
static void centre_of_mass_falls_as_a_point_does(void **state) {
  (void)state;
  for (size_t k = 0; k < method_count; k++) {
    test_engine cloth, point;
    moments start, end;
    test_engine_open(&cloth);
    free_cloth(&cloth, 0.02);
    test_vector(&cloth, test_plugin(&cloth, HK_FORCE, "gravity"), "g", 1, 2, -9.81);
    cloth.options.integrator = methods[k];
    cloth.options.dt = 2e-4;
    test_run(&cloth);
    start = moments_of(hk_run_view(cloth.run));
    test_advance(&cloth, 0.25);
    end = moments_of(hk_run_view(cloth.run));
    test_engine_open(&point);
    test_particle(&point, start.x[0], start.x[1], start.x[2], start.mass);
    for (int c = 0; c < 3; c++) point.scene->particles.velocity[c] = start.p[c] / start.mass;
    test_vector(&point, test_plugin(&point, HK_FORCE, "gravity"), "g", 1, 2, -9.81);
    point.options.integrator = methods[k];
    point.options.dt = 2e-4;
    test_run(&point);
    test_advance(&point, 0.25);
    double off = distance(end.x, test_position(&point, 1));
    /* both integrate a constant acceleration; rounding of 1250 steps (adaptive steps differ, but are exact here, save
     * those of cvode, which starts at order 1 and so is as exact as its tolerance, 1e-6) */
    if (!(off < (strcmp(methods[k], "cvode") == 0 ? 1e-6 : 1e-12)))
      fail_msg("%s: the centre of mass is %g m off", methods[k], off);
    test_engine_close(&cloth);
    test_engine_close(&point);
  }
}

/* Energy plus dissipated work: its error shrinks at the method's order, so that a wrong damping cannot pass. */
static double imbalance(const char *method, double h, double *dissipated) {
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  free_cloth(&e, 0.05);
  test_number(&e, test_plugin(&e, HK_FORCE, "drag"), "rate", 0.5);
  e.options.integrator = method;
  e.options.dt = h;
  e.scene->fps = 5;
  test_run(&e);
  test_advance(&e, 0.2);
  hk_run_summary(e.run, &s);
  *dissipated = -s.energy_work;
  test_engine_close(&e);
  return fabs(s.energy_drift);
}

/* Steps small enough that the leading term rules: the exponent is then right to a third. */
static void energy_balance_has_the_order_of_the_method(void **state) {
  (void)state;
  const struct {
    const char *name;
    double order, h;
  } cases[] = {{"euler", 1, 1e-4},    {"leapfrog", 2, 2.5e-4},     {"midpoint", 2, 6.25e-5},       {"rk4", 4, 2.5e-4},
               {"stoermer", 4, 1e-3}, {"backward_euler", 1, 1e-4}, {"implicit_midpoint", 2, 1e-3}, {"bdf2", 2, 2.5e-4},
               {"imex", 2, 1e-3}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    double work, coarse = imbalance(cases[k].name, cases[k].h, &work),
                 fine = imbalance(cases[k].name, cases[k].h / 2, &work);
    assert_true(work > 1e-3); /* J: damping takes a good part of the 0.1 J there are */
    double order = log2(coarse / fine);
    if (!(order > cases[k].order - 0.34))
      fail_msg("%s: balance of order %.2f (%g, %g)", cases[k].name, order, coarse, fine);
  }
}

/* k/fps exactly, for a million frames: the time is a quotient of integers and never a sum. */
static void frame_times_are_exact_after_a_million_frames(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_plugin(&e, HK_FORCE, "gravity");
  e.scene->fps = 60;
  e.scene->duration = 1e6 / 60;
  test_run(&e);
  test_advance(&e, 1e6 / 60);
  hk_summary s;
  hk_run_summary(e.run, &s);
  assert_true(hk_run_view(e.run)->t == 1000000.0 / 60);
  assert_int_equal(s.frames, 1000001);
  assert_true(s.dt_min == 1.0 / 60 && s.dt_max == 1.0 / 60);
  test_engine_close(&e);
}

/* Bitwise the same for one, two and three threads: 4096 particles make several chunks and groups. */
static void threads_do_not_show_in_the_result(void **state) {
  (void)state;
  enum { SIDE = 80 };
  static double x[3][3 * SIDE * SIDE];
  static uint32_t edge[2 * SIDE * SIDE][2];
  for (int threads = 1; threads <= 3; threads++) {
    test_engine e;
    size_t edges = 0;
    uint64_t seed = 3;
    test_engine_open(&e);
    e.scene->threads = threads;
    for (int k = 0; k < SIDE * SIDE; k++)
      test_particle(&e, k % SIDE * 0.01 + 0.001 * noise(&seed), k / SIDE * 0.01, 0.001 * noise(&seed), 1e-4);
    for (uint32_t k = 1; k <= SIDE * SIDE; k++) {
      if (k % SIDE) edge[edges][0] = k, edge[edges++][1] = k + 1;
      if (k + SIDE <= SIDE * SIDE) edge[edges][0] = k, edge[edges++][1] = k + SIDE;
    }
    hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
    test_edges(&e, springs, (const uint32_t(*)[2])edge, edges);
    test_number(&e, springs, "k", 100);
    test_number(&e, springs, "damping", 0.001);
    test_plugin(&e, HK_FORCE, "gravity");
    test_number(&e, test_plugin(&e, HK_FORCE, "drag"), "rate", 0.1);
    test_run(&e);
    test_advance(&e, 0.05);
    memcpy(x[threads - 1], hk_run_view(e.run)->x, sizeof x[0]);
    test_engine_close(&e);
  }
  assert_memory_equal(x[0], x[1], sizeof x[0]);
  assert_memory_equal(x[0], x[2], sizeof x[0]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(linear_momentum_is_kept_to_rounding_by_every_method),
      cmocka_unit_test(angular_momentum_is_kept_to_rounding_by_leapfrog),
      cmocka_unit_test(angular_momentum_drifts_at_the_order_of_the_others),
      cmocka_unit_test(angular_momentum_is_kept_by_the_implicit_midpoint_rule),
      cmocka_unit_test(centre_of_mass_falls_as_a_point_does),
      cmocka_unit_test(energy_balance_has_the_order_of_the_method),
      cmocka_unit_test(frame_times_are_exact_after_a_million_frames),
      cmocka_unit_test(threads_do_not_show_in_the_result),
  };
  return cmocka_run_group_tests(tests, list_methods, NULL);
}
