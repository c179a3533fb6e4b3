/* The stiff scenes against published numbers, against closed forms, and against a plain program for cloth, written here
 * for the purpose: springs one by one, wind by its angle, Runge-Kutta's method on plain arrays. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void run(const char *scene, const char *options) {
  char all[512];
  snprintf(all, sizeof all, "--state end.csv %s", options);
  test_scene(&r, scene, all);
}

/* A measure, for other keys of the summary may have the same name. */
static double value(const char *key) { return test_json(strstr(r.out, "\"measures\""), key); }

static void near(double got, double wanted, double tolerance) {
  if (!(fabs(got - wanted) <= tolerance))
    fail_msg("%.17g is off %.17g by %g, more than %g", got, wanted, got - wanted, tolerance);
}

/* ---- Pendulum ---------------------------------------------------------------------------------------------------- */

/* Off the state at t = 10 of the problem stiffpendul in the test set of BiMD, recomputed in 113-bit arithmetic. */
static double pendulum_error(void) {
  return fmax(fmax(fabs(value("x") + 0.81157637265109929), fabs(value("z") + 0.58424934474571282)),
              fmax(fabs(value("vx") + 0.63155263059074722), fabs(value("vz") - 0.87728951446538580)));
}

/* rk4 with h w = 0.1: the vibration, an amplitude of g/w^2 = 1e-6 m at most, is what it has to follow. bdf2 damps the
 * vibration away; what is left is the error on the swing, whose frequency is about 1/s: some h^2 t = 1e-5, and an
 * algebraic error of 1e-6 a step, of no fixed sign. */
static void stiff_pendulum_is_where_it_is_known_to_be(void **state) {
  (void)state;
  run("stiff_pendulum", "--integrator rk4 --dt 1e-4");
  near(pendulum_error(), 0, 1e-9);
  near(value("stretch"), 1.752736047251e-6, 1e-10); /* the published multiplier is the pull, k times the stretch */
  run("stiff_pendulum", "");
  near(pendulum_error(), 0, 1e-4);
}

/* ---- String ------------------------------------------------------------------------------------------------------ */

/* Sag and pull of a string at rest, extrapolated from 30 and 60 springs: the lumped string converges with order 2. */
static void settle(const char *options, const char *finer, double sag, double pull) {
  double s[2], p[2];
  char all[256];
  for (int k = 0; k < 2; k++) {
    snprintf(all, sizeof all, "drag=6 %s", k ? finer : options);
    run("stiff_string", all);
    s[k] = value("sag"), p[k] = value("pull");
  }
  near((s[0] - sag) / (s[1] - sag), 4, 0.1);
  near((4 * s[1] - s[0]) / 3, sag, 2e-6); /* h^4 of the lengths 0.04 m */
  near((4 * p[1] - p[0]) / 3, pull, 2e-6);
}

/* The elastic catenary of span 1 m, length 1.2 m, weight 1 N/m for EA = 100 N, and the inextensible one. With a drag
 * rate of 6/s what moves has died down to exp(-18) after 6 s. */
static void stiff_string_comes_to_rest_in_the_catenary(void **state) {
  (void)state;
  settle("k=2500 --integrator rk4", "k=5000 n=61 --integrator rk4", 0.297929871215, 0.755906350799);
  settle("k=2500", "k=5000 n=61", 0.297929871215, 0.755906350799);
  settle("k=1e8", "k=1e8 n=61", 0.292343797601, 0.761885320727);
}

/* ---- Fermi, Pasta and Ulam ----------------------------------------------------------------------------------------
 */

static void energies(double I1, double I2, double I3, double tolerance) {
  near(value("I1"), I1, tolerance), near(value("I2"), I2, tolerance), near(value("I3"), I3, tolerance);
  near(value("I"), I1 + I2 + I3, 3 * tolerance);
}

/* Energies of the stiff springs as published. At h = 1e-3 s Blanes and Moan's method is off by 1e-10 at t = 10 (a
 * sixteenth of that at half the step); at t = 200 rounding of positions up to 9 m has grown to 1e-8. The implicit
 * midpoint rule slows the vibration by (h w)^2/12 = 2e-4. */
static void fpu_exchanges_its_energy_on_time(void **state) {
  (void)state;
  run("fpu", "duration=1");
  energies(1.004734940327, 0.001128950694, 0.000005395862, 1e-9);
  run("fpu", "duration=10");
  energies(0.956065119574, 0.025680529674, 0.000198333515, 1e-9);
  near(value("H"), 2.00120008, 1e-10);
  run("fpu", "duration=200");
  energies(0.010236186101, 0.159758923908, 0.834987923999, 1e-7);
  near(value("H"), 2.00120008, 1e-10);
  run("fpu", "duration=10 --integrator implicit_midpoint");
  energies(0.956065119574, 0.025680529674, 0.000198333515, 5e-4);
}

/* ---- Plain cloth --------------------------------------------------------------------------------------------------
 */

enum { MOST = 128, PAIRS = 12 * MOST };

static struct {
  int nx, ny, springs, pair[PAIRS][2];
  double mass, k[PAIRS], c[PAIRS], L[PAIRS], drag, friction; /* drag: 1/s; friction < 0: no wind */
  bool pinned[MOST];
  double x[3 * MOST], v[3 * MOST];
} cloth;

static void join_all(int di, int dj, double k, double c) {
  for (int j = 0; j < cloth.ny; j++)
    for (int i = 0; i < cloth.nx; i++) {
      int p = i + di, q = j + dj, s = cloth.springs;
      if (p < 0 || p >= cloth.nx || q >= cloth.ny) continue;
      double *a = cloth.x + 3 * (j * cloth.nx + i), *b = cloth.x + 3 * (q * cloth.nx + p);
      cloth.pair[s][0] = j * cloth.nx + i, cloth.pair[s][1] = q * cloth.nx + p;
      cloth.k[s] = k, cloth.c[s] = c, cloth.springs++;
      cloth.L[s] = sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
    }
}

/* nx x ny particles over w x 1 m, along x and along y or (up) z, pinned where j is last or (up) i is first. */
static void lay_out(int nx, int ny, double w, double mass, bool up, const double k[3], const double c[3]) {
  memset(&cloth, 0, sizeof cloth);
  cloth.nx = nx, cloth.ny = ny, cloth.mass = mass / (nx * ny), cloth.friction = -1;
  for (int p = 0; p < nx * ny; p++) {
    cloth.x[3 * p] = w * (p % nx) / (nx - 1);
    cloth.x[3 * p + (up ? 2 : 1)] = (double)(p / nx) / (ny - 1);
    cloth.pinned[p] = up ? p % nx == 0 : p / nx == ny - 1;
  }
  join_all(1, 0, k[0], c[0]), join_all(0, 1, k[0], c[0]);
  join_all(1, 1, k[1], c[1]), join_all(-1, 1, k[1], c[1]);
  join_all(2, 0, k[2], c[2]), join_all(0, 2, k[2], c[2]);
}

static void pull(const double *x, const double *v, double *F) {
  for (int s = 0; s < cloth.springs; s++) {
    int i = 3 * cloth.pair[s][0], j = 3 * cloth.pair[s][1];
    double d[3], l2 = 0, closing = 0;
    for (int q = 0; q < 3; q++) d[q] = x[j + q] - x[i + q], l2 += d[q] * d[q], closing += d[q] * (v[j + q] - v[i + q]);
    double l = sqrt(l2), f = (cloth.k[s] * (l - cloth.L[s]) + cloth.c[s] * closing / l) / l;
    for (int q = 0; q < 3; q++) F[i + q] += f * d[q], F[j + q] -= f * d[q];
  }
}

/* The wind of wind_cloth.lua on one triangle: drag 1.2 sin^2 alpha + friction cos^2 alpha, lift 0.6 sin 2 alpha. */
static void blow(double t, int a, int b, int c, const double *x, const double *v, double *F) {
  double gust = 6 * (1 + 0.25 * sin(2.1 * t) + 0.15 * sin(5.3 * t)), turn = 0.5 * sin(3.1 * t) + 0.35 * sin(7.7 * t);
  double w[3] = {gust * cos(turn), gust * sin(turn), 0}, n[3], p[3], q[3], u[3], area = 0, speed = 0, un = 0, up[3];
  for (int k = 0; k < 3; k++) p[k] = x[3 * b + k] - x[3 * a + k], q[k] = x[3 * c + k] - x[3 * a + k];
  for (int k = 0; k < 3; k++) {
    n[k] = p[(k + 1) % 3] * q[(k + 2) % 3] - p[(k + 2) % 3] * q[(k + 1) % 3];
    u[k] = w[k] - (v[3 * a + k] + v[3 * b + k] + v[3 * c + k]) / 3;
    area += n[k] * n[k], speed += u[k] * u[k], un += u[k] * n[k];
  }
  area = sqrt(area) / 2, speed = sqrt(speed);
  double sine = fabs(un) / (2 * area * speed), cosine = sqrt(fmax(1 - sine * sine, 0));
  double pressure = 0.6 * area * speed * speed,
         drag = pressure * (1.2 * sine * sine + cloth.friction * cosine * cosine);
  double lift = pressure * 0.6 * 2 * sine * cosine;
  for (int k = 0; k < 3; k++) /* the unit vector of lift: the normal to leeward less its part along u */
    up[k] = cosine > 0 ? ((un < 0 ? -n[k] : n[k]) / (2 * area) - sine * u[k] / speed) / cosine : 0;
  for (int k = 0; k < 9; k++)
    F[3 * (int[]){a, b, c}[k / 3] + k % 3] += (drag * u[k % 3] / speed + lift * up[k % 3]) / 3;
}

static void accelerate(double t, const double *x, const double *v, double *a) {
  memset(a, 0, 3 * MOST * sizeof *a);
  pull(x, v, a);
  for (int j = 0; j + 1 < cloth.ny && cloth.friction >= 0; j++)
    for (int i = 0; i + 1 < cloth.nx; i++) {
      int p = j * cloth.nx + i;
      blow(t, p, p + 1, p + cloth.nx + 1, x, v, a);
      blow(t, p, p + cloth.nx + 1, p + cloth.nx, x, v, a);
    }
  for (int k = 0; k < 3 * cloth.nx * cloth.ny; k++)
    a[k] = cloth.pinned[k / 3] ? 0 : a[k] / cloth.mass - cloth.drag * v[k] - (k % 3 == 2 ? 9.81 : 0);
}

static void runge_kutta(double t, double h) {
  static const double at[4] = {0, 0.5, 0.5, 1}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  static double x[3 * MOST], v[3 * MOST], a[3 * MOST], dx[3 * MOST], dv[3 * MOST];
  int m = 3 * cloth.nx * cloth.ny;
  memset(dx, 0, sizeof dx), memset(dv, 0, sizeof dv), memset(a, 0, sizeof a), memcpy(v, cloth.v, sizeof v);
  for (int s = 0; s < 4; s++) {
    for (int k = 0; k < m; k++) {
      double before = v[k];
      v[k] = cloth.v[k] + at[s] * h * a[k];
      x[k] = cloth.x[k] + at[s] * h * before;
    }
    accelerate(t + at[s] * h, x, v, a);
    for (int k = 0; k < m; k++) dx[k] += weight[s] * h * v[k], dv[k] += weight[s] * h * a[k];
  }
  for (int k = 0; k < m; k++) cloth.x[k] += dx[k], cloth.v[k] += dv[k];
}

static void advance(double until, int steps) {
  for (int s = 0; s < steps; s++) runge_kutta(until * s / steps, until / steps);
}

/* Largest distance of a particle in hooke's final state from the plain program's. */
static double distance(void) {
  char path[256], line[512];
  double worst = 0;
  int count = 0;
  snprintf(path, sizeof path, "%s/end.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    double x[3];
    int id;
    if (sscanf(line, "%d,%lf,%lf,%lf", &id, &x[0], &x[1], &x[2]) != 4) continue;
    for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(x[k] - cloth.x[3 * (id - 1) + k]));
    count++;
  }
  fclose(file);
  assert_int_equal(count, cloth.nx * cloth.ny);
  return worst;
}

/* Both by rk4 with the same steps, at h w = 0.4: what differs is rounding, 1e-16 m a step, grown by the motion. bdf2
 * with half the step has a quarter of the error where it resolves the vibrations; the scene's own method damps them,
 * and is good to what measurements on such cloth can tell apart, 1e-2 m. */
static void stiff_cloth_falls_as_in_a_plain_program(void **state) {
  (void)state;
  double c = 10, t = 0.25;
  lay_out(8, 8, 1, 0.15, false, (double[]){1e5, 3e4, 5e3}, (double[]){0.02 * c, 0.01 * c, 0.005 * c});
  cloth.drag = 0.02;
  advance(t, 15 * 256);
  run("stiff_cloth", "N=8 k=1e5 --until 0.25 --integrator rk4 --dt 6.52e-5");
  near(distance(), 0, 1e-12);
  run("stiff_cloth", "N=8 k=1e5 --until 0.25");
  near(distance(), 0, 1e-2);
  run("stiff_cloth", "N=8 k=1e5 --until 0.25 --integrator bdf2 --dt 2.61e-4");
  double coarse = distance();
  run("stiff_cloth", "N=8 k=1e5 --until 0.25 --integrator bdf2 --dt 1.31e-4");
  near(coarse / distance(), 4, 0.4);
}

/* The same for the flag: springs, gusts, and wind by the sine and cosine of its angle. tr_bdf2 at the scene's own tol
 * of 1e-2 is off by a fiftieth of the flag's length at most, and comes closer as tol falls: by tol^(2/3) in the end. */
static void flag_flies_as_in_a_plain_program(void **state) {
  (void)state;
  double c = 0.5 * sqrt(2), t = 0.5;
  lay_out(10, 7, 1.5, 0.225, true, (double[]){2000, 600, 40}, (double[]){c, c / 2, c / 4});
  cloth.friction = 0.02;
  advance(t, 30 * 128);
  run("wind_cloth", "N=7 --until 0.5 --integrator rk4 --dt 1.31e-4");
  near(distance(), 0, 1e-12);
  run("wind_cloth", "N=7 --until 0.5");
  double coarse = distance();
  near(coarse, 0, 0.03);
  run("wind_cloth", "N=7 --until 0.5 --tol 1e-4");
  near(distance(), 0, coarse / 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stiff_pendulum_is_where_it_is_known_to_be),
      cmocka_unit_test(stiff_string_comes_to_rest_in_the_catenary),
      cmocka_unit_test(fpu_exchanges_its_energy_on_time),
      cmocka_unit_test(stiff_cloth_falls_as_in_a_plain_program),
      cmocka_unit_test(flag_flies_as_in_a_plain_program),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
