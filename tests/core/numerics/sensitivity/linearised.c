/* Derivatives of steps that solve one linear system in place of their equation. */
#include "tests/support/varied_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Stiff springs in a string that hangs from one end, in steps that do not follow their swings. */
static void string_of(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 12 };
  uint32_t pair[N - 1][2];
  for (uint32_t i = 0; i < N; i++) test_particle(e, 0.1 * i, 0.02 * sin(i), 0.01 * cos(2. * i), 0.01 * p[2]);
  for (size_t i = 0; i < 3 * (size_t)N; i++) e->scene->particles.velocity[i] = p[3] * sin(1.7 * (double)i);
  for (uint32_t i = 0; i + 1 < N; i++) pair[i][0] = i + 1, pair[i][1] = i + 2;
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])pair, N - 1);
  test_number(e, springs, "k", 200 * p[0]);
  test_number(e, springs, "damping", 0.1 * p[1]);
  test_plugin(e, HK_FORCE, "gravity");
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", p[1]);
}

/* A sheet of springs, held at one corner, and at another on a line. */
static void sheet_of(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 6 };
  static const uint32_t way[4][2] = {{1, 0}, {0, 1}, {1, 1}, {2, 0}};
  uint32_t pair[4 * N * N][2];
  size_t count = 0;
  for (uint32_t i = 0; i < N * N; i++) test_particle(e, 0.2 * (i % N), 0.02 * sin(i), 0.2 * (i / N), 0.01 * p[2]);
  for (size_t i = 0; i < 3 * (size_t)N * N; i++) e->scene->particles.velocity[i] = p[3] * sin(1.7 * (double)i);
  for (int w = 0; w < 4; w++)
    for (uint32_t i = 0; i < N * N; i++)
      if (i % N + way[w][0] < N && i / N + way[w][1] < N) {
        pair[count][0] = i + 1;
        pair[count++][1] = i + way[w][0] + N * way[w][1] + 1;
      }
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_LINE, N, (double[]){1, 0, 0});
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])pair, count);
  test_number(e, springs, "k", 2000 * p[0]);
  test_number(e, springs, "damping", 10 * p[1]);
  test_plugin(e, HK_FORCE, "gravity");
}

/* A straight chain between two pins that is too long for its place, and gives way to the sides as fast as steps, all
 * equal, go on: their matrices are not definite. */
static void pressed_chain(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 7 };
  uint32_t pair[N - 1][2];
  for (uint32_t i = 0; i < N; i++) test_particle(e, 0.1 * i, 1e-3 * sin(i), 1e-3 * cos(2. * i), 0.01 * p[2]);
  for (size_t i = 0; i < 3 * (size_t)N; i++) e->scene->particles.velocity[i] = 0.1 * p[3] * sin(1.7 * (double)i);
  for (uint32_t i = 0; i + 1 < N; i++) pair[i][0] = i + 1, pair[i][1] = i + 2;
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_FIXED, N, NULL);
  e->scene->tol = 10;
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t(*)[2])pair, N - 1);
  test_number(e, springs, "k", 200 * p[0]);
  test_number(e, springs, "rest", 0.155 * p[1]);
  test_number(e, springs, "damping", p[1]);
}

/* Springs whose damping turns with them, and a solver that takes the unsymmetric part of their blocks. */
static void turning(test_engine *e, const double p[VARIED_PARAMETERS]) {
  double damped[VARIED_PARAMETERS] = {p[0], 5 * p[1], p[2], 5 * p[3]};
  varied_tetrahedron(e, damped);
  test_plugin(e, HK_SOLVER, "umfpack");
}

typedef struct linear_case {
  varied_scene *scene;
  size_t n;
  double dt, t;
  size_t projected; /* steps whose factorization fails, at least */
} linear_case;

static const linear_case cases[] = {{varied_tetrahedron, 4, 2e-3, 0.402, 0},
                                    {turning, 4, 5e-3, 0.402, 0},
                                    {string_of, 12, 5e-3, 0.402, 0},
                                    {sheet_of, 36, 5e-3, 0.102, 0},
                                    {pressed_chain, 7, 5e-3, 0.03, 1}};
enum { CASES = sizeof cases / sizeof *cases, MOST = 36 };
static const double start[VARIED_PARAMETERS] = {50, 0.7, 2, 0.3};

static void open_case(varied_runs *r, const linear_case *c) {
  varied_open(r, c->scene, "linear_bdf2", start, VARIED_PARAMETERS, c->dt);
  varied_run(r, c->t);
}

static size_t count_of(const hk_sensitivity *s, bool projected) {
  size_t count = 0;
  for (size_t k = 0; k < s->steps; k++) count += projected ? s->step[k].projected : s->step[k].linear;
  return count;
}

/* Of one parameter the tangent at the end, 6n. */
typedef struct ending {
  size_t wide, n;
  double (*last)[6 * MOST];
} ending;

static hk_status keep_end(void *context, double t, const double *X, const double *tangents) {
  const ending *of = context;
  (void)t, (void)X;
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) memcpy(of->last[k], tangents + k * of->wide, 6 * of->n * sizeof *X);
  return HK_OK;
}

static void tangents_of(varied_runs *r, double last[VARIED_PARAMETERS][6 * MOST]) {
  ending of = {r->s->wide, r->s->n, last};
  hk_error error = {0};
  if (hk_sensitivity_tangents(r->s, r->by, VARIED_PARAMETERS, keep_end, &of, &error) != HK_OK)
    fail_msg("%s", error.text);
}

/* Steps taken again add up roundings, and algebraic errors of up to 1e-12 of the first one's Newton's method. */
static void steps_taken_again_are_those_of_the_method(void **state) {
  (void)state;
  for (size_t k = 0; k < CASES; k++) {
    varied_runs r;
    open_case(&r, &cases[k]);
    assert_true(r.s->off < 1e-10);
    assert_true(count_of(r.s, false) + 3 > r.s->steps);
    assert_true(count_of(r.s, true) >= cases[k].projected);
    varied_close(&r);
  }
}

/* Central differences by 1e-5 of a parameter leave 1e-10 times a third derivative, and what rounding makes of the
 * states, as steps taken again show it, over 1e-5. */
static void compare_with_the_same_steps(varied_runs *r) {
  static double last[VARIED_PARAMETERS][6 * MOST];
  double more[6 * MOST], less[6 * MOST];
  tangents_of(r, last);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double most = 0, worst = 0, size = 0;
    assert_int_equal(hk_sensitivity_replay(r->s, r->by[k].more, more), HK_OK);
    assert_int_equal(hk_sensitivity_replay(r->s, r->by[k].less, less), HK_OK);
    for (size_t e = 0; e < 6 * r->s->n; e++) {
      double exact = (more[e] - less[e]) / (2 * r->by[k].by);
      most = fmax(most, fabs(exact));
      worst = fmax(worst, fabs(last[k][e] - exact));
      size = fmax(size, fabs(more[e]));
    }
    double rounding = 2 * r->s->off * size / r->by[k].by;
    if (!(worst < 1e-7 * most + rounding)) fail_msg("parameter %zu: %g of %g", k, worst, most);
  }
}

static void tangents_are_the_differences_of_the_same_steps(void **state) {
  (void)state;
  for (size_t c = 0; c < CASES; c++) {
    varied_runs r;
    open_case(&r, &cases[c]);
    compare_with_the_same_steps(&r);
    varied_close(&r);
  }
}

static double mismatch(varied_runs *r) {
  static double last[VARIED_PARAMETERS][6 * MOST];
  double back[6 * MOST], slope[VARIED_PARAMETERS], worst = 0;
  hk_error error = {0};
  tangents_of(r, last);
  for (size_t e = 0; e < 6 * r->s->n; e++) back[e] = cos(2.3 * (double)e);
  if (hk_sensitivity_adjoint(r->s, back, r->by, VARIED_PARAMETERS, slope, &error) != HK_OK) fail_msg("%s", error.text);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double sum = 0, size = 0;
    for (size_t e = 0; e < 6 * r->s->n; e++) {
      sum += cos(2.3 * (double)e) * last[k][e];
      size += fabs(cos(2.3 * (double)e) * last[k][e]);
    }
    worst = fmax(worst, fabs(sum - slope[k]) / size);
  }
  return worst;
}

/* Tangents compare scenes whose parameters differ by 1e-5: rounding of their matrices, eps over that, is 2e-11 of
 * these, and of stiff springs more of what the parameter changes. */
static void adjoint_is_the_transpose_of_the_tangents(void **state) {
  (void)state;
  for (size_t c = 0; c < CASES; c++) {
    varied_runs r;
    open_case(&r, &cases[c]);
    assert_true(mismatch(&r) < 1e-8);
    varied_keep(&r, 7);
    assert_true(mismatch(&r) < 1e-8);
    varied_close(&r);
  }
}

/* A method that is reset begins once more, within the run. */
static void steps_begin_again_after_a_reset(void **state) {
  (void)state;
  varied_runs r;
  varied_open(&r, string_of, "linear_bdf2", start, VARIED_PARAMETERS, 5e-3);
  test_advance(&r.base, 0.1);
  r.base.run->loop.method->reset(r.base.run->loop.integrator->self, HK_STATE_CHANGED);
  varied_run(&r, 0.2);
  assert_true(r.s->off < 1e-10);
  assert_int_equal(count_of(r.s, false), r.s->steps - 2);
  compare_with_the_same_steps(&r);
  assert_true(mismatch(&r) < 1e-8);
  varied_close(&r);
}

/* Of steps that are all equal, whatever the parameter, as the tolerance is wide: whole runs by the method itself. */
static void tangents_are_the_differences_of_whole_runs(void **state) {
  (void)state;
  const linear_case *c = &cases[CASES - 1];
  static double last[VARIED_PARAMETERS][6 * MOST];
  varied_runs r;
  open_case(&r, c);
  tangents_of(&r, last);
  for (size_t k = 0; k < VARIED_PARAMETERS; k++) {
    double more[6 * MOST], less[6 * MOST], by = 1e-5 * start[k], most = 0, worst = 0, size = 0;
    varied_end(&r, k, by, c->t, more);
    varied_end(&r, k, -by, c->t, less);
    for (size_t e = 0; e < 6 * r.s->n; e++) {
      double exact = (more[e] - less[e]) / (2 * by);
      most = fmax(most, fabs(exact));
      worst = fmax(worst, fabs(last[k][e] - exact));
      size = fmax(size, fabs(more[e]));
    }
    if (!(worst < 1e-7 * most + 2 * r.s->off * size / by)) fail_msg("parameter %zu: %g of %g", k, worst, most);
  }
  varied_close(&r);
}

/* A particle on a spring without a rest length, x'' = -w^2 x of p[0] = w^2: dx/dp = -x_0 t sin(w t)/(2 w). */
static void oscillator(test_engine *e, const double p[VARIED_PARAMETERS]) {
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, 0.1, 0, 0, 1);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  e->scene->tol = 10;
  hk_plugin_spec *spring = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, spring, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, spring, "k", p[0]);
  test_number(e, spring, "rest", 0);
}

/* The derivative of steps of order 2 is the motion's to order 2: half the step leaves a quarter of the error, within
 * the next term, a part h w = 0.03 or less of it. */
static void derivatives_have_the_order_of_the_method(void **state) {
  (void)state;
  const double t = 1, strength = 40, w = sqrt(strength), scale = 0.1 * t / (2 * w);
  const double exact = -scale * sin(w * t);
  double off[2];
  for (int half = 0; half < 2; half++) {
    static double last[VARIED_PARAMETERS][6 * MOST];
    varied_runs r;
    varied_open(&r, oscillator, "linear_bdf2", (double[]){strength, 1, 1, 1}, VARIED_PARAMETERS, half ? 2.5e-3 : 5e-3);
    varied_run(&r, t);
    tangents_of(&r, last);
    off[half] = last[0][3] - exact;
    assert_true(fabs(off[half]) < 0.02 * scale);
    double back[12] = {0, 0, 0, 1}, slope[VARIED_PARAMETERS];
    hk_error error = {0};
    assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, VARIED_PARAMETERS, slope, &error), HK_OK);
    assert_true(fabs(slope[0] - last[0][3]) < 1e-9 * scale);
    varied_close(&r);
  }
  assert_true(off[0] / off[1] > 3.8 && off[0] / off[1] < 4.2);
}

/* A sheet whose damping is a part of its blocks, without what is not symmetric of them. */
static void damped_sheet(test_engine *e, const double p[VARIED_PARAMETERS]) {
  static const double corner[4][3] = {{0, 0, 0}, {1, 0.1, 0}, {0.1, 0.9, 0}, {1.1, 1, 0.2}};
  for (size_t i = 0; i < 4; i++) test_particle(e, corner[i][0], corner[i][1], corner[i][2], p[2]);
  for (size_t i = 0; i < 12; i++) e->scene->particles.velocity[i] = p[3] * sin(1.7 * (double)i);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane");
  test_tuples(e, membrane, "triangles", 3, (const uint32_t[]){1, 2, 3, 2, 4, 3}, 2);
  test_number(e, membrane, "stiffness", p[0]);
  test_number(e, membrane, "damping", p[1]);
}

/* Blocks that leave something out are differentiated forwards, and backwards where the force states how they change. */
static void blocks_that_are_not_the_jacobian_have_no_adjoint(void **state) {
  (void)state;
  static double last[VARIED_PARAMETERS][6 * MOST];
  double more[24], less[24], back[24] = {1}, slope[VARIED_PARAMETERS];
  hk_error error = {0};
  varied_runs r;
  varied_open(&r, damped_sheet, "linear_bdf2", start, VARIED_PARAMETERS, 2e-3);
  varied_run(&r, 0.1);
  tangents_of(&r, last);
  assert_int_equal(hk_sensitivity_replay(r.s, r.by[1].more, more), HK_OK);
  assert_int_equal(hk_sensitivity_replay(r.s, r.by[1].less, less), HK_OK);
  for (size_t e = 0; e < 24; e++) assert_true(fabs(last[1][e] - (more[e] - less[e]) / (2 * r.by[1].by)) < 1e-7);
  assert_int_equal(hk_sensitivity_adjoint(r.s, back, r.by, VARIED_PARAMETERS, slope, &error), HK_FAILED);
  assert_non_null(
      strstr(error.text, "force 'membrane' leaves a part of its Jacobian out of the linear step to t = 0.1"));
  varied_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_taken_again_are_those_of_the_method),
      cmocka_unit_test(tangents_are_the_differences_of_the_same_steps),
      cmocka_unit_test(adjoint_is_the_transpose_of_the_tangents),
      cmocka_unit_test(steps_begin_again_after_a_reset),
      cmocka_unit_test(tangents_are_the_differences_of_whole_runs),
      cmocka_unit_test(derivatives_have_the_order_of_the_method),
      cmocka_unit_test(blocks_that_are_not_the_jacobian_have_no_adjoint),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
