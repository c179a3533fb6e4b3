/* Rods with retardation: the first mode of a cantilever dies down as it has to, explicitly and implicitly; what moves
 * as a rigid body loses nothing; power and blocks are those of the force; angles that are particles are damped, too. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* ---- a cantilever ---- */

enum { BEAM = 22 };

/* 1 m long from its second particle on, EI = 0.01 N m^2, 0.1 kg/m; the first edge is in the wall. It starts with the
 * velocities of the first mode, 1e-3 m/s at the tip. */
static void open_cantilever(test_engine *e, const char *method, double dt, double retardation) {
  const double l = 1. / (BEAM - 2), root = 1.8751040687, ratio = 0.7340955;
  uint32_t edge[BEAM - 1][2];
  test_engine_open(e);
  for (int i = 0; i < BEAM; i++) {
    double s = root * (i - 1) * l, mode = cosh(s) - cos(s) - ratio * (sinh(s) - sin(s));
    test_particle(e, (i - 1) * l, 0, 0, 0.1 * l * (i == BEAM - 1 ? 0.5 : 1));
    e->scene->particles.velocity[3 * i + 2] = i > 1 ? 5e-4 * mode : 0;
    if (i > 0) edge[i - 1][0] = (uint32_t)i, edge[i - 1][1] = (uint32_t)i + 1;
    if (i < 2) test_pin(e, HK_PIN_FIXED, (uint32_t)i + 1, NULL);
  }
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods"), *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, rods, (const uint32_t(*)[2])edge, BEAM - 1);
  test_edges(e, springs, (const uint32_t(*)[2])edge, BEAM - 1);
  test_number(e, rods, "EI", 0.01);
  test_number(e, rods, "retardation", retardation);
  test_number(e, springs, "k", 100);
  test_plugin(e, HK_INTEGRATOR, method);
  e->options.dt = dt;
  e->scene->duration = 30;
  test_run(e);
}

typedef struct swing {
  double t, height;
} swing;

/* The next largest height of the tip, by the parabola through three samples. */
static swing next_top(test_engine *e, double *t) {
  double z[3] = {0, 0, 0}, step = 0.02;
  for (;;) {
    *t += step;
    test_advance(e, *t);
    z[0] = z[1], z[1] = z[2], z[2] = test_position(e, BEAM)[2];
    if (!(z[1] > 0 && z[1] > z[0] && z[1] >= z[2] && z[0] > 0)) continue;
    double bend = z[0] - 2 * z[1] + z[2], slope = (z[2] - z[0]) / 2;
    return (swing){*t - step - step * slope / bend, z[1] - slope * slope / (2 * bend)};
  }
}

/* The rate at which the first mode dies down is retardation w^2/2, with w^2 = w_seen^2 + rate^2, and w that of a beam,
 * 1.8751^2 (EI/rho A)^(1/2)/L^2 = 1.1118/s. The second mode, of 6.97/s, is gone after two swings. */
static void dies_down(const char *method, double dt, double tolerance) {
  test_engine e;
  double t = 0, retardation = 0.02;
  open_cantilever(&e, method, dt, retardation);
  next_top(&e, &t), next_top(&e, &t);
  swing first = next_top(&e, &t), second = next_top(&e, &t);
  double rate = log(first.height / second.height) / (second.t - first.t), seen = 2 * pi / (second.t - first.t);
  double w2 = seen * seen + rate * rate;
  print_message("%s: rate %.6g/s, expected %.6g/s; w %.6g/s\n", method, rate, retardation * w2 / 2, sqrt(w2));
  assert_true(fabs(rate / (retardation * w2 / 2) - 1) < tolerance);
  assert_true(fabs(sqrt(w2) / 1.11181 - 1) < 5e-3); /* edges of L/20: of second order, with some factor of 1 */
  test_engine_close(&e);
}

static void first_mode_dies_down_at_the_rate_of_its_frequency(void **state) {
  (void)state;
  dies_down("rk4", 5e-4, 1e-3);     /* tops are found to 1e-5 of the height and of the time */
  dies_down("tr_bdf2", 0.02, 5e-3); /* its own damping is of order (w h)^3 = 1e-5 a step of 0.6/s */
}

/* ---- what is not damped, and by how much the rest is ---- */

enum { N = 9 };

typedef struct shape {
  const char *name;
  bool ring;
  double EI2, GJ;
  const char *rest;
} shape;

static const shape shapes[] = {
    {"straight at rest", false, 0, 0, "straight"}, {"straight at rest, a ring", true, 0, 0, "straight"},
    {"with twist", true, 0, 1.5, "straight"},      {"curved", false, 0, 1.5, "initial"},
    {"curved ring", true, 0, 1.5, "initial"},      {"ribbon", false, 0.4, 1.5, "initial"},
    {"ribbon, a ring", true, 0.4, 1.5, "straight"}};

static hk_plugin_spec *open_shape(test_engine *e, const shape *s) {
  uint32_t edge[N][2];
  test_engine_open(e);
  for (uint32_t i = 0; i < N; i++) {
    double angle = (s->ring ? 2 * pi / N : 0.5) * i;
    test_particle(e, cos(angle) + 0.03 * sin(5. * i), sin(angle) + 0.04 * cos(3. * i),
                  0.1 * i * !s->ring + 0.1 * sin(2. * i), 1 + 0.1 * i);
    edge[i][0] = i + 1, edge[i][1] = (i + 1) % N + 1;
  }
  hk_plugin_spec *rods = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, rods, (const uint32_t(*)[2])edge, s->ring ? N : N - 1);
  test_number(e, rods, "EI", 2);
  if (s->EI2 > 0) test_number(e, rods, "EI2", s->EI2);
  test_number(e, rods, "GJ", s->GJ);
  test_text(e, rods, "rest", s->rest);
  test_number(e, rods, "retardation", 0.3);
  e->options.dt = 1e-3;
  test_run(e);
  return rods;
}

/* The force at velocities v less that at rest; returns its power. */
static double damping_of(const hk_instance *rods, hk_view view, const double *v, double *F) {
  double still[3 * N] = {0}, rest[3 * N];
  view.v = still;
  force_evaluate(rods, &view, rest);
  view.v = v;
  double power = force_evaluate(rods, &view, F);
  for (int k = 0; k < 3 * N; k++) F[k] -= rest[k];
  return power;
}

static double largest(const double *F) {
  double most = 0;
  for (int k = 0; k < 3 * N; k++) most = fmax(most, fabs(F[k]));
  return most;
}

static void rigid_motion(const double *x, double *v) {
  static const double turn[3] = {0.7, -1.1, 0.4}, drift[3] = {1, 2, -3};
  for (int i = 0; i < N; i++)
    for (int c = 0; c < 3; c++) {
      int p = (c + 1) % 3, q = (c + 2) % 3;
      v[3 * i + c] = drift[c] + turn[p] * x[3 * i + q] - turn[q] * x[3 * i + p];
    }
}

/* Of any other motion the power is F.v and takes energy, and the three sums of F and of x x F are 0. */
static void rigid_motions_lose_nothing_and_others_energy_alone(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++) {
    test_engine e;
    double v[3 * N], F[3 * N], still[3 * N], work = 0, sum[6] = {0};
    hk_instance *rods = test_instance(&e, open_shape(&e, &shapes[k]));
    hk_view view = force_view(&e, rods);
    rigid_motion(view.x, v);
    double power = damping_of(rods, view, v, still);
    for (int c = 0; c < 3 * N; c++) v[c] = sin(12.9898 * c + 4.1);
    double loss = damping_of(rods, view, v, F), scale = largest(F);
    print_message("%s: %.3g N in a rigid motion, of %.3g N; %.3g W of %.3g W\n", shapes[k].name, largest(still), scale,
                  power, loss);
    assert_true(largest(still) < 1e-12 * scale && fabs(power) < -1e-12 * loss && loss < 0);
    for (int i = 0; i < N; i++)
      for (int c = 0; c < 3; c++) {
        int p = (c + 1) % 3, q = (c + 2) % 3;
        work += F[3 * i + c] * v[3 * i + c], sum[c] += F[3 * i + c];
        sum[3 + c] += view.x[3 * i + p] * F[3 * i + q] - view.x[3 * i + q] * F[3 * i + p];
      }
    assert_true(fabs(work - loss) < -1e-12 * loss);
    for (int c = 0; c < 6; c++) assert_true(fabs(sum[c]) < 1e-12 * scale * N);
    test_engine_close(&e);
  }
}

/* ---- angles that are particles: no section follows, so the blocks are exact, at rest K too ---- */

static void particles_that_are_angles_are_damped(void **state) {
  (void)state;
  enum { NODES = 5, EDGES = NODES - 1 };
  test_engine e;
  uint32_t edge[EDGES][2];
  double spin[EDGES], v[3 * (NODES + EDGES)];
  test_engine_open(&e);
  for (uint32_t i = 0; i < NODES; i++) test_particle(&e, 0.2 * i, 0.05 * sin(2. * i), 0.05 * cos(1.3 * i), 0.1);
  for (uint32_t k = 0; k < EDGES; k++) {
    edge[k][0] = k + 1, edge[k][1] = k + 2;
    spin[k] = test_particle(&e, 1 + k, 0, 0, 0.02);
    test_pin(&e, HK_PIN_LINE, (uint32_t)spin[k], (const double[]){1, 0, 0});
  }
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "rods");
  test_edges(&e, spec, (const uint32_t(*)[2])edge, EDGES);
  test_number(&e, spec, "EI", 0.02), test_number(&e, spec, "EI2", 0.05), test_number(&e, spec, "GJ", 0.03);
  test_number(&e, spec, "retardation", 0.3), test_number(&e, spec, "radius", 0.1);
  test_list(&e, spec, "spins", spin, EDGES);
  e.options.dt = 1e-4;
  test_run(&e);
  hk_instance *rods = test_instance(&e, spec);
  hk_view view = force_view(&e, rods);
  assert_true(force_damping_error(rods, &view) < 10 * FORCE_DIFFERENCES);
  assert_true(force_stiffness_error(rods, &view) < 10 * FORCE_DIFFERENCES);
  for (size_t k = 0; k < sizeof v / sizeof *v; k++) v[k] = sin(5. * (double)k + 1);
  view.v = v;
  assert_true(force_damping_error(rods, &view) < 10 * FORCE_DIFFERENCES);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(first_mode_dies_down_at_the_rate_of_its_frequency),
      cmocka_unit_test(rigid_motions_lose_nothing_and_others_energy_alone),
      cmocka_unit_test(particles_that_are_angles_are_damped),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
