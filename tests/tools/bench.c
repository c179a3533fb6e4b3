/* hooke bench: its errors are those that this file computes itself (its own leapfrog and Runge-Kutta against closed
 * forms), its orders are the declared ones, it refuses errors of a motion that is not determined, and it finds out an
 * integrator that lies about its order and a force whose Jacobian is wrong. */
#include "tests/support/command.h"
#include "tests/support/force_check.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static test_result r;
static char csv[1 << 18], json[1 << 19];

/* ---- the bench and its files ---- */

static void read_file(const char *name, char *into, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "rb");
  size_t got = file ? fread(into, 1, size - 1, file) : 0;
  into[got] = 0;
  if (file) fclose(file);
}

/* The exit code of `before` hooke bench SCENE ...; the scene is one of scripts/scenes unless it has a slash. */
static int try_bench(const char *before, const char *scene, const char *arguments, char line[1024]) {
  if (strchr(scene, '/'))
    snprintf(line, 1024, "bench %s --out b --quiet --jobs 2 %s", scene, arguments);
  else
    snprintf(line, 1024, "bench %s/scripts/scenes/%s --out b --quiet --jobs 2 %s", HK_ROOT, scene, arguments);
  test_hooke(&r, before, line);
  return r.code;
}

static void bench(const char *before, const char *scene, const char *arguments) {
  char line[1024], more[512];
  int code = try_bench(before, scene, arguments, line);
  if (code == 1 && strstr(r.err, "a larger --budget")) { /* the machine has other things to do: as it says itself */
    snprintf(more, sizeof more, "%s --budget 200", arguments);
    code = try_bench(before, scene, more, line);
  }
  if (code != 0) fail_msg("%s: exit %d: %s%s", line, code, r.out, r.err);
  read_file("b/bench.csv", csv, sizeof csv);
  read_file("b/bench.json", json, sizeof json);
}

static void copy_field(const char *row, int index, char *into, size_t size) {
  while (index-- > 0) row = strchr(row, ',') + 1;
  snprintf(into, size, "%.*s", (int)strcspn(row, ",\n"), row);
}

static int column(const char *name) {
  char field[64];
  for (int k = 0; k < 40; k++) {
    copy_field(csv, k, field, sizeof field);
    if (strcmp(field, name) == 0) return k;
    if (!field[0]) break;
  }
  fail_msg("bench.csv has no column '%s': %.300s", name, csv);
  return 0;
}

/* The k-th row of an integrator; NULL: there are fewer. */
static const char *row_of(const char *integrator, int k) {
  size_t length = strlen(integrator);
  for (const char *at = csv; (at = strchr(at, '\n')) != NULL && at[1];) {
    at++;
    if (strncmp(at, integrator, length) == 0 && at[length] == ',' && k-- == 0) return at;
  }
  return NULL;
}

static double number(const char *row, const char *name) {
  char field[64], *end;
  copy_field(row, column(name), field, sizeof field);
  double value = strtod(field, &end);
  return end == field ? NAN : value; /* also "<1e-9" */
}

/* ---- one particle, integrated here ---- */

typedef void motion(double t, double x[3]); /* the closed form */
typedef void pull(const double x[3], double acceleration[3]);

static pull *acting;

static void leapfrog(double x[3], double v[3], double h) {
  double a[3], b[3];
  acting(x, a);
  for (int c = 0; c < 3; c++) x[c] += h * v[c] + h * h / 2 * a[c];
  acting(x, b);
  for (int c = 0; c < 3; c++) v[c] += h / 2 * (a[c] + b[c]);
}

static void rk4(double x[3], double v[3], double h) {
  static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
  double dx[3] = {0}, dv[3] = {0}, sx[3] = {0}, sv[3] = {0};
  for (int s = 0; s < 4; s++) {
    double at[3], a[3];
    for (int c = 0; c < 3; c++) at[c] = x[c] + h * part[s] * dx[c];
    for (int c = 0; c < 3; c++) dx[c] = v[c] + h * part[s] * dv[c];
    acting(at, a);
    for (int c = 0; c < 3; c++) dv[c] = a[c], sx[c] += weight[s] * dx[c] / 6, sv[c] += weight[s] * dv[c] / 6;
  }
  for (int c = 0; c < 3; c++) x[c] += h * sx[c], v[c] += h * sv[c];
}

typedef void method(double x[3], double v[3], double h);

/* Positions at the frames, `pieces` steps each. */
static void follow(method *step, const double start[6], double fps, int frames, int pieces, double (*out)[3]) {
  double x[3], v[3];
  memcpy(x, start, sizeof x);
  memcpy(v, start + 3, sizeof v);
  for (int k = 0; k < frames; k++) {
    for (int i = 0; i < pieces; i++) step(x, v, 1 / (fps * pieces));
    memcpy(out[k], x, sizeof x);
  }
}

/* RMS over `particles`, of which the others do not move, and over the frames. */
static double rms(double (*a)[3], double (*b)[3], int frames, int particles) {
  double sum = 0;
  for (int k = 0; k < frames; k++)
    for (int c = 0; c < 3; c++) sum += (a[k][c] - b[k][c]) * (a[k][c] - b[k][c]);
  return sqrt(sum / frames / particles);
}

enum { MOST_FRAMES = 400 };

/* The first rows of leapfrog and rk4 in bench.csv against the same steps taken here: errors within 1 %, for a table of
 * speed against error is worthless otherwise; the rounding of both is far below. */
static void compare(const double start[6], double fps, int frames, int particles, double (*known)[3]) {
  static double own[MOST_FRAMES][3];
  struct {
    const char *name;
    method *step;
  } list[] = {{"leapfrog", leapfrog}, {"rk4", rk4}};
  for (int m = 0; m < 2; m++) {
    int checked = 0;
    for (int k = 0; k < 3 && row_of(list[m].name, k); k++) {
      const char *row = row_of(list[m].name, k);
      double told = number(row, "error_x_rms");
      if (isnan(told)) continue;
      follow(list[m].step, start, fps, frames, (int)lround(1 / (fps * number(row, "dt"))), own);
      double error = rms(own, known, frames, particles);
      if (fabs(told / error - 1) > 0.01) fail_msg("%s, row %d: bench says %g, here %g", list[m].name, k, told, error);
      checked++;
    }
    if (checked < 2) fail_msg("%s has %d rows with errors:\n%s", list[m].name, checked, csv);
  }
}

static void fill(motion *exact, double fps, int frames, double (*known)[3]) {
  for (int k = 0; k < frames; k++) exact((k + 1) / fps, known[k]);
}

static double known[MOST_FRAMES][3];

static void circle_pull(const double x[3], double a[3]) {
  for (int c = 0; c < 3; c++) a[c] = -25 * x[c];
}

static void circle(double t, double x[3]) { x[0] = cos(5 * t), x[1] = sin(5 * t), x[2] = 0; }

static void sine_pull(const double x[3], double a[3]) { a[0] = 0, a[1] = -4 * x[1], a[2] = -4 * x[2]; }

static void sine(double t, double x[3]) { x[0] = t, x[1] = -2 * cos(2 * t), x[2] = 0; }

static void kepler_pull(const double x[3], double a[3]) {
  double d = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
  for (int c = 0; c < 3; c++) a[c] = -x[c] / (d * d * d);
}

static void kepler(double t, double x[3]) {
  double e = 0.6, E = t + e * sin(t);
  for (int k = 0; k < 50; k++) E -= (E - e * sin(E) - t) / (1 - e * cos(E));
  x[0] = cos(E) - e, x[1] = sqrt(1 - e * e) * sin(E), x[2] = 0;
}

static void pendulum_pull(const double x[3], double a[3]) {
  double l = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
  for (int c = 0; c < 3; c++) a[c] = -1e6 * (l - 1) * x[c] / l;
  a[2] -= 1;
}

static void errors_on_circle_sine_and_orbit_are_those_of_closed_forms(void **state) {
  (void)state;
  acting = circle_pull;
  fill(circle, 60, 60, known);
  bench(NULL, "circle.lua", "--integrators leapfrog,rk4 --until 1 --target 1e-4 --budget 4");
  compare((const double[]){1, 0, 0, 0, 5, 0}, 60, 60, 1, known);
  acting = sine_pull;
  fill(sine, 30, 60, known);
  bench(NULL, "sine.lua", "--integrators leapfrog,rk4 --until 2 --target 1e-4 --budget 4");
  compare((const double[]){0, -2, 0, 1, 0, 0}, 30, 60, 1, known);
  acting = kepler_pull;
  fill(kepler, 30, 90, known);
  bench(NULL, "orbit.lua", "--integrators leapfrog,rk4 --until 3 --target 1e-4 --budget 4");
  compare((const double[]){0.4, 0, 0, 0, 2, 0}, 30, 90, 1, known);
}

/* Without a closed form: Runge-Kutta here with h w = 1e-3 has errors of (h w)^4 w t / 120 = 8e-12 of the vibration. */
static void errors_on_the_stiff_pendulum_are_those_of_a_program_of_its_own(void **state) {
  (void)state;
  acting = pendulum_pull;
  follow(rk4, (const double[]){1, 0, 0, 0, 0, 0}, 60, 30, 16667, known);
  bench(NULL, "stiff_pendulum.lua", "--integrators leapfrog,rk4 --until 0.5 --target 1e-6 --budget 6");
  compare((const double[]){1, 0, 0, 0, 0, 0}, 60, 30, 2, known);
}

/* y' = -10 y: a step of explicit Euler multiplies by 1 - 10 h, one of rk4 by the first terms of exp. */
static void errors_on_decay_are_those_of_the_growth_factors(void **state) {
  (void)state;
  bench(NULL, "decay.lua", "--metric y --integrators euler,rk4 --until 2 --target 1e-3 --budget 4");
  for (int m = 0; m < 2; m++)
    for (int k = 0; k < 3; k++) {
      const char *row = row_of(m ? "rk4" : "euler", k);
      assert_non_null(row);
      double z = -10 * number(row, "dt"), factor = m ? 1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24 : 1 + z;
      double sum = 0, told = number(row, "error_y");
      for (int frame = 1; frame <= 8; frame++) {
        double error = pow(factor, round(frame * 0.25 / number(row, "dt"))) - exp(-2.5 * frame);
        sum += error * error;
      }
      if (!(fabs(told / sqrt(sum / 8) - 1) < 0.01)) fail_msg("%s: bench says %g, here %g", row, told, sqrt(sum / 8));
    }
  test_hooke(&r, NULL, "bench " HK_ROOT "/scripts/scenes/decay.lua --out b --quiet --budget 4");
  assert_int_equal(r.code, 1);
  assert_non_null(strstr(r.err, "nothing moves in this scene"));
}

/* ---- orders ---- */

static double observed(const char *integrator) {
  char key[128];
  snprintf(key, sizeof key, "\"integrator\":\"%s\"", integrator);
  const char *at = strstr(json, "\"methods\":[");
  for (; at; at = strchr(at + 1, '{')) { /* the keys of an object come in any order */
    char object[600];
    if (*at != '{') continue;
    snprintf(object, sizeof object, "%.*s", (int)strcspn(at, "}"), at);
    if (strstr(object, key)) return test_json(object, "order_observed");
  }
  fail_msg("bench.json has no method %s", integrator);
  return NAN;
}

/* 0.15: the next term of an error's expansion, of some h w = 0.07 and less, against the first. */
static void observed_orders_are_the_declared_ones(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double order;
  } list[] = {{"symplectic_euler", 1}, {"leapfrog", 2},   {"midpoint", 2}, {"implicit_midpoint", 2}, {"rk4", 4},
              {"stoermer", 4},         {"blanes_moan", 4}};
  bench(NULL, "sine.lua",
        "--integrators symplectic_euler,leapfrog,midpoint,implicit_midpoint,rk4,stoermer,blanes_moan --until 3 "
        "--target 1e-3 --finest 1e-9 --budget 8");
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (!(fabs(observed(list[k].name) - list[k].order) < 0.15))
      fail_msg("%s: order %g", list[k].name, observed(list[k].name));
  assert_null(strstr(r.out, "does not show its order"));
  test_write("slow.lua", "local scene = hooke.scene { duration = 12, fps = 0.5 }\n"
                         "scene:particle { position = { 1, 0, 0 }, velocity = { 0, 0.7, 0 }, mass = 1 }\n"
                         "scene:force('central', { strength = 4 })\nreturn scene\n");
  bench(NULL, "./slow.lua", "--integrators dopri5 --target 1e-3 --finest 1e-9 --budget 6");
  /* its steps are chosen by an estimate of order 4, which for this motion is even all the same; half an order for steps
     that end at frames */
  if (!(fabs(observed("dopri5") - 5) < 0.5)) fail_msg("dopri5: order %g", observed("dopri5"));
}

static void an_integrator_of_order_1_that_declares_2_is_found_out(void **state) {
  (void)state;
  bench("mkdir -p p/integrators && cp " HK_BUILD "/tests/fixtures/poser.so p/integrators/ && HOOKE_PLUGIN_PATH=$PWD/p ",
        "sine.lua", "--integrators poser,leapfrog --until 2 --target 1e-2 --budget 4");
  assert_true(fabs(observed("poser") - 1) < 0.15);
  assert_non_null(strstr(r.out, "warning: poser does not show its order here: observed 1.0, declared 2"));
  assert_null(strstr(r.out, "warning: leapfrog"));
}

/* ---- wrong Jacobians ---- */

static void pull_scene(const char *name, const char *force) {
  char text[400];
  snprintf(
      text, sizeof text,
      "local scene = hooke.scene { duration = 1, fps = 10 }\n"
      "scene:particle { position = { 1, 0, 0 }, mass = 1 }\nscene:force('%s', { strength = 4000 })\nreturn scene\n",
      force);
  test_write(name, text);
}

static void a_wrong_jacobian_is_found_out(void **state) {
  (void)state;
  static const char path[] =
      "mkdir -p p/forces && cp " HK_BUILD "/tests/fixtures/wrong_jacobian.so p/forces/ && HOOKE_PLUGIN_PATH=$PWD/p ";
  pull_scene("wrong.lua", "wrong_jacobian");
  pull_scene("right.lua", "central");
  bench(path, "./wrong.lua", "--integrators implicit_midpoint,leapfrog --target 1e-2 --budget 6");
  assert_non_null(
      strstr(r.out, "warning: implicit_midpoint halved its steps where Newton's iteration did not converge"));
  bench(NULL, "./right.lua", "--integrators implicit_midpoint,leapfrog --target 1e-2 --budget 6");
  assert_null(strstr(r.out, "halved its steps"));
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 1, 0.5, -0.2, 1);
  hk_plugin_spec *force = test_plugin(&e, HK_FORCE, "fixture:wrong_jacobian");
  e.options.dt = 1e-3;
  test_run(&e);
  const hk_instance *wrong = test_instance(&e, force);
  hk_view view = force_view(&e, wrong);
  assert_true(force_gradient_error(wrong, &view) < FORCE_DIFFERENCES);
  assert_true(fabs(force_stiffness_error(wrong, &view) - 2) < 1e-6); /* the opposite sign */
  test_engine_close(&e);
}

/* ---- chaos ---- */

static double lower_start[6] = {1, 0, 1, 0, 0, 0};

/* The double pendulum here: both weights by Runge-Kutta; returns the lower one's position at the frames. */
static void pendulum_rates(const double s[12], double d[12]) {
  double f[2][3] = {{0, 0, -9.81}, {0, 0, -9.81}}, up = 0, low = 0, rod[3];
  for (int c = 0; c < 3; c++) rod[c] = s[3 + c] - s[c], up += s[c] * s[c], low += rod[c] * rod[c];
  up = sqrt(up), low = sqrt(low);
  for (int c = 0; c < 3; c++) {
    double upper = 4000 * (up - 1) * s[c] / up, lower = 4000 * (low - 1) * rod[c] / low;
    f[0][c] += lower - upper, f[1][c] -= lower;
  }
  for (int c = 0; c < 6; c++) d[c] = s[6 + c], d[6 + c] = f[c / 3][c % 3];
}

/* `fine` steps a frame up to the frame `change`, and then 64, as the fate of a difference is that of the motion. */
static void pendulum(int frames, int change, int fine, double (*out)[3]) {
  double s[12] = {1, 0, 0};
  memcpy(s + 3, lower_start, 3 * sizeof *s);
  for (int k = 0; k < frames; k++) {
    int pieces = k <= change ? fine : 64;
    double h = 1.0 / 60 / pieces;
    for (int i = 0; i < pieces; i++) {
      static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1, 2, 2, 1};
      double d[12] = {0}, sum[12] = {0}, at[12];
      for (int q = 0; q < 4; q++) {
        for (int c = 0; c < 12; c++) at[c] = s[c] + h * part[q] * d[c];
        pendulum_rates(at, d);
        for (int c = 0; c < 12; c++) sum[c] += h * weight[q] * d[c] / 6;
      }
      for (int c = 0; c < 12; c++) s[c] += sum[c];
    }
    memcpy(out[k], s + 3, sizeof out[k]);
  }
}

/* The horizon is true: to it two fine runs made here agree to the target, and at the end they are as far apart as the
 * motion is wide. These runs are fine enough up to it for horizons of 19 s (64 steps a frame resolve 9.6 s, which a
 * quiet machine exceeds). No error below what the references support is printed as a number. */
static void a_chaotic_scene_gets_a_horizon_and_no_meaningless_errors(void **state) {
  (void)state;
  static double a[3600][3], b[3600][3];
  bench(NULL, "double_pendulum.lua", "--integrators leapfrog,blanes_moan,dopri5 --target 1e-3 --budget 5");
  double horizon = test_json(json, "horizon_s"), support = test_json(json, "supports_errors_above");
  if (!(horizon > 0.5 && horizon < 30))
    fail_msg("horizon %g s\n%s", horizon, r.out); /* the better, the faster a machine */
  assert_non_null(strstr(r.out, "errors mean something up to the horizon"));
  assert_true(test_json(json, "growth") > 1);
  int last = (int)(horizon * 60) - 1;
  pendulum(3600, last, 1024, a);
  pendulum(3600, last, 2048, b);
  double apart = 0, at_end = 0;
  for (int c = 0; c < 3; c++) {
    apart += (a[last][c] - b[last][c]) * (a[last][c] - b[last][c]);
    at_end += (a[3599][c] - b[3599][c]) * (a[3599][c] - b[3599][c]);
  }
  assert_true(sqrt(apart) < 1e-3 && sqrt(at_end) > 0.1);
  const char *const names[] = {"leapfrog", "blanes_moan", "dopri5"};
  for (int m = 0; m < 3; m++)
    for (int k = 0; row_of(names[m], k); k++) {
      double error = number(row_of(names[m], k), "error_x_rms");
      assert_true(isnan(error) || error >= support);
    }
}

/* ---- the tool ---- */

static void results_are_written_and_drawn(void **state) {
  (void)state;
  bench(NULL, "circle.lua", "--integrators leapfrog,blanes_moan,xpbd --until 1 --target 1e-3 --budget 3");
  assert_true(test_exists("b/bench.csv") && test_exists("b/bench.json"));
  assert_true(test_exists("b/bench.png") && test_exists("b/bench.svg"));
  assert_false(test_exists("b/bench.state.jsonl")); /* all is done: nothing to take up */
  assert_non_null(strstr(r.out, "\ntake "));        /* which one is a matter of the machine */
  const char *chosen = strstr(json, "\"recommendation\":");
  assert_non_null(chosen);
  assert_true(test_json(chosen, "error_x_rms") <= 1e-3);
  for (int k = 0; row_of("leapfrog", k); k++) { /* all digits: the steps of a frame are a whole number of times dt */
    double pieces = 1 / (60 * number(row_of("leapfrog", k), "dt"));
    assert_true(fabs(pieces - round(pieces)) < 4 * DBL_EPSILON * pieces);
  }
  assert_int_equal(strncmp(csv,
                           "integrator,dt,tol,steps,force_evaluations,factorizations,wall_s,error_x_rms,error_x_max,"
                           "error_v_rms,energy_drift,verdict,",
                           100),
                   0);
}

static int lines_of(const char *name) {
  int count = 0;
  read_file(name, json, sizeof json);
  for (const char *at = json; (at = strchr(at, '\n')) != NULL; at++) count++;
  return count;
}

/* Starts a bench in the test's folder, interrupts it when six lines are on file, and waits for its end. */
static void interrupt_a_bench(const char *scene) {
  pid_t pid = fork();
  assert_true(pid >= 0);
  if (pid == 0) {
    if (chdir(test_folder()) != 0) _exit(9);
    execl(HK_BUILD "/hooke", "hooke", "bench", scene, "N=12", "--until", "0.1", "--out", "c", "--jobs", "2", "--budget",
          "8", "--integrators", "leapfrog,rk4", "--quiet", (char *)NULL);
    _exit(9);
  }
  int status = 0;
  while (lines_of("c/bench.state.jsonl") < 6 && waitpid(pid, &status, WNOHANG) == 0) usleep(5000);
  if (kill(pid, SIGINT) != 0) fail_msg("the bench ended before it was interrupted");
  assert_int_equal(waitpid(pid, &status, 0), pid);
  assert_true(WIFSIGNALED(status));
}

/* What an interrupted bench has done is not done again: the second one takes up as many runs as were on file. */
static void an_interrupted_bench_goes_on(void **state) {
  (void)state;
  static const char scene[] = HK_ROOT "/scripts/scenes/curtain.lua";
  test_folder();
  interrupt_a_bench(scene);
  int runs = lines_of("c/bench.state.jsonl") - 1; /* the first line is the fingerprint */
  assert_true(runs >= 5);
  test_hooke(&r, NULL,
             "bench " HK_ROOT "/scripts/scenes/curtain.lua N=12 --until 0.1 --out c --jobs 2 --budget 8 "
             "--integrators leapfrog,rk4");
  assert_int_equal(r.code, 0);
  const char *said = strstr(r.err, "taking up ");
  assert_non_null(said);
  assert_int_equal(atoi(said + strlen("taking up ")), runs);
  assert_false(test_exists("c/bench.state.jsonl")); /* all is done */
}

static void methods_that_do_not_fit_are_listed_with_the_reason(void **state) {
  (void)state;
  bench(NULL, "fpu.lua", "--integrators leapfrog,rk4,xpbd --until 0.3 --target 1e-2 --budget 4");
  const char *list = strstr(r.out, "these do not fit the scene");
  assert_non_null(list);
  assert_non_null(strstr(list, "xpbd, xpbd:bdf=2: force 'soft' acts between particles and offers no elements"));
  assert_non_null(strstr(json, "\"refused\":\"xpbd: force 'soft'"));
  assert_null(row_of("xpbd", 0));
}

/* Off by 1e-6 of an amplitude of 1: far above what two methods differ by. */
static void a_wrong_exact_solution_is_doubted(void **state) {
  (void)state;
  static const char scene[] = "local scene = hooke.scene { duration = 1, fps = 30 }\n"
                              "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                              "scene:force('central', { strength = 4 })\n"
                              "scene:exact(function(t) return %s * math.cos(2 * t), 0, 0 end)\nreturn scene\n";
  char text[400];
  snprintf(text, sizeof text, scene, "1.000001");
  test_write("doubtful.lua", text);
  bench(NULL, "./doubtful.lua", "--integrators rk4 --target 1e-4 --budget 4");
  assert_non_null(strstr(r.out, "than with the scene's exact solution: is it right?"));
  snprintf(text, sizeof text, scene, "1");
  test_write("doubtful.lua", text);
  bench(NULL, "./doubtful.lua", "--integrators rk4 --target 1e-4 --budget 4");
  assert_null(strstr(r.out, "is it right?"));
}

static void wrong_use_is_refused_with_the_remedy(void **state) {
  (void)state;
  static const struct {
    const char *arguments, *text;
  } list[] = {{"--integrators leapfroq", "did you mean 'leapfrog'?"},
              {"--metric radiuss --integrators rk4", "did you mean 'radius'?"},
              {"sped=3", "sped"},
              {"--target=-1", "is not a positive number"}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    char line[400];
    snprintf(line, sizeof line, "bench %s/scripts/scenes/circle.lua --quiet --budget 3 --out b %s", HK_ROOT,
             list[k].arguments);
    test_hooke(&r, NULL, line);
    if (r.code != 1 || !strstr(r.err, list[k].text)) fail_msg("%s: exit %d: %s", line, r.code, r.err);
  }
}

/* The circle's speed as a parameter of the scene: leapfrog's error of the phase is that of (w h)^2/24 w t. */
static void values_of_a_parameter_are_methods_of_their_own(void **state) {
  (void)state;
  test_write("vary.lua", "local keep = param('keep', 'gently', 'how')\n"
                         "local scene = hooke.scene { duration = 1, fps = 20 }\n"
                         "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                         "local w2 = keep == 'firmly' and 9 or 4\n"
                         "scene:force('central', { power = 1, strength = w2 })\n"
                         "scene:exact(function(t) return math.cos(2 * t), 0, 0 end)\n"
                         "return scene\n");
  bench(NULL, "./vary.lua", "--integrators leapfrog --vary keep=gently,firmly --target 1e-3 --budget 2");
  const char *gently = row_of("leapfrog keep=gently", 0), *firmly = row_of("leapfrog keep=firmly", 0);
  assert_true(gently && firmly && !row_of("leapfrog", 0));
  assert_true(number(gently, "error_x_rms") < 0.05 && number(firmly, "error_x_rms") > 0.3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_of_a_parameter_are_methods_of_their_own),
      cmocka_unit_test(errors_on_circle_sine_and_orbit_are_those_of_closed_forms),
      cmocka_unit_test(errors_on_the_stiff_pendulum_are_those_of_a_program_of_its_own),
      cmocka_unit_test(errors_on_decay_are_those_of_the_growth_factors),
      cmocka_unit_test(observed_orders_are_the_declared_ones),
      cmocka_unit_test(an_integrator_of_order_1_that_declares_2_is_found_out),
      cmocka_unit_test(a_wrong_jacobian_is_found_out),
      cmocka_unit_test(a_chaotic_scene_gets_a_horizon_and_no_meaningless_errors),
      cmocka_unit_test(results_are_written_and_drawn),
      cmocka_unit_test(an_interrupted_bench_goes_on),
      cmocka_unit_test(methods_that_do_not_fit_are_listed_with_the_reason),
      cmocka_unit_test(a_wrong_exact_solution_is_doubted),
      cmocka_unit_test(wrong_use_is_refused_with_the_remedy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
