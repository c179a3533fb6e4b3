/* Derivatives of steps with constraints: the adjoint is the transpose of the tangents, these are differences of whole
 * runs, and those of a pendulum have the closed form. */
#include "tests/support/varied_scenes.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const char *const methods[] = {"leapfrog", "symplectic_euler"};
static const double start[VARIED_PARAMETERS] = {20, 0.7, 2, 0.3};

/* Tangents compare forces of scenes whose parameters differ by 1e-5 of their size; that by the start, the last one, has
 * no such part. */
static const double of_differences = 10 * DBL_EPSILON / 1e-5, of_transpose = 1e-12;

/* Velocities along a chain, on its bars after the host has projected them. */
static void set_speeds(test_engine *e, size_t n, double by) {
  for (size_t k = 0; k < 3 * n; k++) e->scene->particles.velocity[k] = by * sin(1.7 * (double)k);
}

/* p: stiffness, damping and half the length of a bar; mass; speed. A chain of bars with a spring at its end: lengths
 * and masses depend on the parameters, the anchor's place does not. */
static void chain(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1 + 0.1 * p[1], 0.2, -0.1, p[2]);
  test_particle(e, 1.5, -0.5, 0.3, 0.5);
  test_particle(e, 2.1, -0.4, -0.3, 1.5);
  set_speeds(e, 4, p[3]);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 4}}, 3);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 4}}, 1);
  test_number(e, springs, "k", p[0]);
  test_number(e, springs, "rest", 0.8);
  test_number(e, springs, "damping", p[1]);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "d", 0.4);
  test_plugin(e, HK_FORCE, "gravity");
}

/* A triangle of bars that nothing pins: a rigid group, which is solved by itself. */
static void triangle(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0.1, 0, 0, 1);
  test_particle(e, 1 + 0.1 * p[1], 0.2, -0.1, p[2]);
  test_particle(e, 0.5, 1.1, 0.3, 0.5);
  set_speeds(e, 3, p[3]);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}, {2, 3}, {3, 1}}, 3);
  hk_plugin_spec *pull = test_plugin(e, HK_FORCE, "central");
  test_number(e, pull, "strength", p[0]);
  test_number(e, pull, "softening", 0.2);
  test_number(e, pull, "power", -2);
}

/* A weld, a guide across two points that move, a particle that slides along a line, and a bar that follows from others.
 */
static void mechanism(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 1, 0.2, -0.1, p[2]);
  test_particle(e, 0.5, 0.8, 0.2 * p[1], 0.5);
  test_particle(e, 0.9, 1.3, 0.1, 1.5);
  test_particle(e, 1.8, 0.2, -0.1, 0.7);
  set_speeds(e, 5, p[3]);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_LINE, 5, (double[]){1, 0, 0});
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}, {2, 5}, {1, 2}}, 3);
  test_tuples(e, test_plugin(e, HK_CONSTRAINT, "guides"), "points", 4, (const uint32_t[]){2, 3, 1, 5}, 1);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "weld"), (const uint32_t[][2]){{3, 4}}, 1);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[][2]){{1, 4}, {4, 5}}, 2);
  test_number(e, springs, "k", p[0]);
  test_number(e, springs, "damping", p[1]);
  test_plugin(e, HK_FORCE, "gravity");
}

typedef struct subject {
  const char *name;
  varied_scene *scene;
  size_t n;
} subject;

static const subject SUBJECTS[] = {{"chain", chain, 4}, {"triangle", triangle, 3}, {"mechanism", mechanism, 5}};

/* As in adjoint.c: the worst, in parts of what may be. */
static double mismatch(const subject *s, const char *method, size_t stride) {
  double w[36], back[36], slope[VARIED_PARAMETERS], worst = 0;
  varied_runs r;
  varied_open(&r, s->scene, method, start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.402);
  if (stride) varied_keep(&r, stride);
  varied_tangents kept = {.numbers = VARIED_PARAMETERS * r.s->wide, .n = s->n};
  hk_error error = {0};
  if (hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error) != HK_OK)
    fail_msg("%s", error.text);
  for (size_t e = 0; e < 6 * s->n; e++) back[e] = w[e] = cos(2.3 * (double)e);
  if (hk_sensitivity_adjoint(r.s, back, r.by, VARIED_PARAMETERS, slope, &error) != HK_OK) fail_msg("%s", error.text);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double sum = 0, size = 0;
    for (size_t e = 0; e < 6 * s->n; e++) {
      sum += w[e] * kept.last[r.s->wide * k + e];
      size += fabs(w[e] * kept.last[r.s->wide * k + e]);
    }
    worst = fmax(worst, fabs(sum - slope[k]) / size / (k < VARIED_PARAMETERS - 1 ? of_differences : of_transpose));
  }
  varied_close(&r);
  return worst;
}

static void adjoint_is_the_transpose_of_the_tangents(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof SUBJECTS / sizeof *SUBJECTS; k++)
    for (size_t m = 0; m < 2; m++)
      for (size_t stride = 0; stride < 20; stride += 14) {
        double off = mismatch(&SUBJECTS[k], methods[m], stride);
        if (!(off < 1)) fail_msg("%s, %s, %zu: %g", SUBJECTS[k].name, methods[m], stride, off);
      }
}

/* Central differences with 1e-3 and 2e-3 of a parameter, extrapolated: 4 by^4 of the fifth derivatives is left, some
 * 1e-11, and rounding over 1e-3. The run solves its constraints to a few units of rounding, which it adds in each of
 * 200 steps. */
static void tangents_are_the_differences_of_whole_runs(void **state) {
  (void)state;
  for (size_t q = 0; q < sizeof SUBJECTS / sizeof *SUBJECTS; q++)
    for (size_t m = 0; m < 2; m++) {
      const subject *s = &SUBJECTS[q];
      varied_runs r;
      varied_open(&r, s->scene, methods[m], start, VARIED_PARAMETERS, 2e-3);
      varied_run(&r, 0.4);
      varied_tangents kept = {.numbers = VARIED_PARAMETERS * r.s->wide, .n = s->n};
      hk_error error = {0};
      assert_int_equal(hk_sensitivity_tangents(r.s, r.by, VARIED_PARAMETERS, varied_keep_tangents, &kept, &error),
                       HK_OK);
      for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
        double end[4][36], by = 1e-3 * start[k], most = 0, worst = 0;
        for (int side = 0; side < 4; side++)
          varied_end(&r, k, (side % 2 ? -1 : 1) * (side < 2 ? 1 : 2) * by, 0.4, end[side]);
        for (size_t e = 0; e < 6 * s->n; e++) {
          double near = (end[0][e] - end[1][e]) / (2 * by), far = (end[2][e] - end[3][e]) / (4 * by);
          double exact = (4 * near - far) / 3;
          most = fmax(most, fabs(exact));
          worst = fmax(worst, fabs(kept.last[r.s->wide * k + e] - exact));
        }
        if (!(worst < 1e-9 * most)) fail_msg("%s, %s, %zu: %g of %g", s->name, methods[m], k, worst, most);
      }
      varied_close(&r);
    }
}

/* ---- a pendulum of one bar, let go at the angle b: sin(a/2) = k sn(K - w t), k = sin(b/2), w^2 = g/L ---- */

static const double swing = 1.2; /* b */

static void pendulum(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, p[1] * sin(p[2]), 0, -p[1] * cos(p[2]), p[3]);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t[][2]){{1, 2}}, 1);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -p[0]);
}

/* The complete elliptic integrals K and E by the arithmetic-geometric mean (Abramowitz and Stegun, 17.6). */
static void elliptic(double k, double *K, double *E) {
  double a = 1, b = sqrt(1 - k * k), c = k, sum = c * c / 2, two = 0.5;
  for (int i = 0; i < 8; i++) {
    double next = (a + b) / 2;
    c = (a - b) / 2;
    b = sqrt(a * b);
    a = next;
    two *= 2;
    sum += two * c * c;
  }
  *K = acos(-1) / (2 * a);
  *E = *K * (1 - sum);
}

/* By g, L, b and the mass, of x = L sin a when it first hangs straight down, at 0.5 s: there da/dt = -2 w k, a depends
 * on w t and b alone, and the quarter period is K/w with dK/dk = E/(k (1 - k^2)) - K/k. */
static void exact_slopes(double L, double slope[VARIED_PARAMETERS], double *g) {
  const double t = 0.5, k = sin(swing / 2);
  double K, E;
  elliptic(k, &K, &E);
  double w = K / t, speed = -2 * w * k, by_k = E / (k * (1 - k * k)) - K / k;
  *g = w * w * L;
  slope[0] = L * speed * t / (2 * *g);
  slope[1] = -speed * t / 2;
  slope[2] = -L * speed / w * by_k * cos(swing / 2) / 2;
  slope[3] = 0;
}

static void slopes_of_a_run(double h, const double p[VARIED_PARAMETERS], double slope[VARIED_PARAMETERS]) {
  varied_runs r;
  varied_open(&r, pendulum, "leapfrog", p, VARIED_PARAMETERS, h);
  varied_run(&r, 0.5);
  double X[12] = {[3] = 1};
  hk_error error = {0};
  if (hk_sensitivity_adjoint(r.s, X, r.by, VARIED_PARAMETERS, slope, &error) != HK_OK) fail_msg("%s", error.text);
  varied_close(&r);
}

/* Order 2: half the step a quarter of the error, to a part of h^2; the extrapolated values are of order 4. The force of
 * gravity is compared between scenes, which leaves eps/1e-5. */
static void a_pendulum_has_the_closed_form(void **state) {
  (void)state;
  double exact[VARIED_PARAMETERS], coarse[VARIED_PARAMETERS], fine[VARIED_PARAMETERS], g, L = 0.8;
  exact_slopes(L, exact, &g);
  const double p[VARIED_PARAMETERS] = {g, L, swing, 1.3};
  slopes_of_a_run(4e-3, p, coarse);
  slopes_of_a_run(2e-3, p, fine);
  for (int k = 0; k < 3; k++) {
    double ratio = (coarse[k] - exact[k]) / (fine[k] - exact[k]);
    double off = fabs((4 * fine[k] - coarse[k]) / 3 - exact[k]) / fabs(exact[k]);
    if (!(fabs(ratio - 4) < 0.01 && off < 1e-8)) fail_msg("%d: %g, off by %g of %g", k, ratio, off, exact[k]);
  }
  assert_true(fabs(fine[3]) < 1e-11); /* the mass */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(adjoint_is_the_transpose_of_the_tangents),
      cmocka_unit_test(tangents_are_the_differences_of_whole_runs),
      cmocka_unit_test(a_pendulum_has_the_closed_form),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
