/* Elements of any arity, of the forces of tests/fixtures: areas of triangles beside struts on edges, volumes of
 * tetrahedra. Every method that works element by element is held against Newton's backward Euler. */
#include "tests/support/command.h"
#include "tests/support/element_scenes.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 4 };

/* ---- methods ---- */

static void use_newton(test_engine *e) {
  hk_plugin_spec *method = test_plugin(e, HK_INTEGRATOR, "backward_euler");
  test_number(e, method, "tolerance", 1e-12);
  test_number(e, method, "iterations", 100);
}

static void use_local_global(test_engine *e, const char *acceleration) {
  hk_plugin_spec *method = test_plugin(e, HK_INTEGRATOR, "local_global");
  test_number(e, method, "iterations", 50000);
  test_number(e, method, "tolerance", 1e-12);
  test_text(e, method, "acceleration", acceleration);
}

static void use_xpbd(test_engine *e, double substeps, double iterations, const char *order) {
  hk_plugin_spec *method = test_plugin(e, HK_INTEGRATOR, "xpbd");
  test_number(e, method, "substeps", substeps);
  test_number(e, method, "iterations", iterations);
  test_text(e, method, "order", order);
}

enum { NEWTON, QUASI_NEWTON, ACCELERATED, XPBD, XPBD_COLOURS, METHODS, ONE_SWEEP = METHODS };

static const char *const method_name[] = {"backward_euler", "local_global",    "local_global with anderson",
                                          "xpbd",           "xpbd by colours", "xpbd in one sweep"};

static void use(test_engine *e, int method) {
  if (method == NEWTON) use_newton(e);
  if (method == QUASI_NEWTON || method == ACCELERATED) use_local_global(e, method == ACCELERATED ? "anderson" : "none");
  if (method == ONE_SWEEP) use_xpbd(e, 2, 1, "scene");
  if (method == XPBD || method == XPBD_COLOURS) use_xpbd(e, 1, 20000, method == XPBD ? "scene" : "colours");
}

/* ---- one step ---- */

typedef void build(test_engine *e);

static void crumpled_sheet(test_engine *e) {
  elements_stiffen(e, elements_sheet(e, SIDE, 0.01), 2e4, 0, 30);
  elements_gravity(e);
}

static void swelling_blob(test_engine *e) {
  elements_blob(e, 3, 0.005, 1.3, 1e8, 0);
  elements_gravity(e);
}

static void held_blob(test_engine *e) {
  static const double line[3] = {0, 0.8, -0.6}, plane[3] = {0.6, 0, 0.8};
  swelling_blob(e);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_pin(e, HK_PIN_LINE, 9, line);
  test_pin(e, HK_PIN_PLANE, 27, plane);
}

/* Triangles, struts and plain springs together: for these xpbd's limit is not quite backward Euler (xpbd_springs.c). */
static void mixed(test_engine *e) {
  crumpled_sheet(e);
  hk_plugin_spec *springs = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, springs, (const uint32_t[2][2]){{1, 6}, {2, 16}}, 2);
  test_number(e, springs, "k", 20);
  test_pin(e, HK_PIN_FIXED, 4, NULL);
}

/* The positions after `steps` steps of h; the caller frees. */
static double *positions(build *make, int method, double h, int steps, size_t *n) {
  test_engine e;
  elements_open(&e, h);
  make(&e);
  use(&e, method);
  test_run(&e);
  test_advance(&e, steps * h);
  const hk_view *view = hk_run_view(e.run);
  *n = view->n;
  double *x = malloc(3 * view->n * sizeof *x);
  memcpy(x, view->x, 3 * view->n * sizeof *x);
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  if (summary.steps != (size_t)steps) fail_msg("%s took %zu steps", method_name[method], summary.steps);
  test_engine_close(&e);
  return x;
}

static double distance(const double *a, const double *b, size_t n) {
  double most = 0;
  for (size_t k = 0; k < 3 * n; k++) most = isfinite(a[k]) ? fmax(most, fabs(a[k] - b[k])) : INFINITY;
  return most;
}

static void one_step_of_every_method_is_newtons_backward_euler(void **state) {
  (void)state;
  static build *const scene[] = {crumpled_sheet, swelling_blob, held_blob, mixed};
  static const char *const scene_name[] = {"sheet", "blob", "held blob", "mixed"};
  const double h = 1.0 / 60;
  size_t n;
  for (size_t s = 0; s < sizeof scene / sizeof *scene; s++) {
    double *newton = positions(scene[s], NEWTON, h, 1, &n), *before = positions(scene[s], NEWTON, h, 0, &n);
    double moved = distance(newton, before, n);
    for (int m = QUASI_NEWTON; m < (scene[s] == mixed ? XPBD : METHODS); m++) {
      double *x = positions(scene[s], m, h, 1, &n), off = distance(x, newton, n);
      /* Stopped at changes of 1e-12 of the step's; errors contract by 0.9975 at the slowest, which leaves 400 times
       * that, an RMS of up to 81 coordinates. */
      if (!(off < 1e-8 * moved)) fail_msg("%s, %s: %g m off, %g m moved", scene_name[s], method_name[m], off, moved);
      free(x);
    }
    free(newton);
    free(before);
  }
}

/* Weighed where its gradients are a tenth of what they become, a crushed blob bursts open: the constant matrix is too
 * soft, and moves along it have to be shortened. What it comes to is a backward Euler step none the less. */
static void a_matrix_that_is_too_soft_still_leads_to_backward_euler(void **state) {
  (void)state;
  for (int accelerated = 0; accelerated < 2; accelerated++) {
    const double h = 0.01;
    test_engine e;
    elements_open(&e, h);
    hk_plugin_spec *spec = elements_blob(&e, 2, 0, 1, 1e9, 0);
    for (size_t k = 0; k < 3 * e.scene->particles.n; k++) e.scene->particles.position[k] *= 0.3;
    use(&e, accelerated ? ACCELERATED : QUASI_NEWTON);
    test_run(&e);
    test_advance(&e, h);
    hk_summary summary;
    hk_run_summary(e.run, &summary);
    assert_int_equal(summary.steps, 1);
    const hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double F[24], off = 0, size = 0;
    force_evaluate(force, &view, F);
    for (size_t k = 0; k < 24; k++) { /* at rest at the start: m v = h F */
      off = fmax(off, fabs(view.model->mass[k / 3] * view.v[k] - h * F[k]));
      size = fmax(size, fabs(h * F[k]));
    }
    print_message("%s: m v - h F is %.1e of h F\n", accelerated ? "anderson" : "plain", off / size);
    assert_true(size > 0.01);
    /* 1e-12 of the move, times the stiffness h^2 k |dC|^2/m = 500 and the contraction of 0.998. */
    assert_true(off < 1e-7 * size);
    test_engine_close(&e);
  }
}

/* ---- edges, in two ways ---- */

static void struts(test_engine *e) {
  hk_plugin_spec *force = elements_sheet(e, SIDE, 0.01);
  test_tuples(e, force, "triangles", 3, NULL, 0);
  elements_stiffen(e, force, 0, 0, 200);
  test_number(e, force, "edge_rest", 0.1);
}

/* The same as plain edges of `springs`. */
static void springs(test_engine *e) {
  uint32_t edge[2 * SIDE * SIDE][2];
  size_t count = 0;
  hk_plugin_spec *idle = elements_sheet(e, SIDE, 0.01);
  elements_stiffen(e, idle, 0, 0, 0);
  for (uint32_t j = 0; j < SIDE; j++)
    for (uint32_t i = 0; i < SIDE; i++) {
      uint32_t a = j * SIDE + i + 1;
      if (i + 1 < SIDE) edge[count][0] = a, edge[count++][1] = a + 1;
      if (j + 1 < SIDE) edge[count][0] = a, edge[count++][1] = a + SIDE;
    }
  hk_plugin_spec *force = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, force, (const uint32_t(*)[2])edge, count);
  test_number(e, force, "k", 200);
  test_number(e, force, "rest", 0.1);
}

static void edges_with_an_evaluate_move_as_plain_ones(void **state) {
  (void)state;
  size_t n;
  for (int m = QUASI_NEWTON; m <= ONE_SWEEP; m++) {
    if (m == XPBD || m == XPBD_COLOURS) continue; /* see `mixed` */
    double *a = positions(struts, m, 0.01, 5, &n), *b = positions(springs, m, 0.01, 5, &n), off = distance(a, b, n);
    /* One sweep is the same arithmetic in another order; local_global stops at its tolerance. */
    if (!(off < (m == ONE_SWEEP ? 1e-14 : 1e-9))) fail_msg("%s: %g m off", method_name[m], off);
    free(a);
    free(b);
  }
}

/* ---- motion ---- */

static void falling_sheet(test_engine *e) {
  elements_stiffen(e, elements_sheet(e, SIDE, 0.01), 2e4, 0, 30);
  elements_gravity(e);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
}

static void falling_blob(test_engine *e) {
  elements_blob(e, 3, 0.005, 1.3, 1e7, 1e4);
  elements_gravity(e);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
}

static double *fall(build *make, const char *method, double h, double substeps, size_t *n) {
  test_engine e;
  elements_open(&e, 0.1);
  make(&e);
  e.options.dt = h;
  hk_plugin_spec *spec = test_plugin(&e, HK_INTEGRATOR, method);
  if (substeps > 0) test_number(&e, spec, "substeps", substeps);
  if (strcmp(method, "local_global") == 0) {
    test_number(&e, spec, "iterations", 20000);
    test_number(&e, spec, "tolerance", 1e-9);
    test_text(&e, spec, "acceleration", "anderson");
  }
  test_run(&e);
  test_advance(&e, 0.1);
  const hk_view *view = hk_run_view(e.run);
  *n = view->n;
  double *x = malloc(3 * view->n * sizeof *x);
  memcpy(x, view->x, 3 * view->n * sizeof *x);
  test_engine_close(&e);
  return x;
}

static double fall_error(build *make, const char *method, double h, double substeps, const double *exact) {
  size_t n;
  double *x = fall(make, method, h, substeps, &n), off = distance(x, exact, n);
  free(x);
  return off;
}

/* Errors of methods of order 1 halve with the step; 1.6: what is left of their next order at these steps. */
static void falling_bodies_converge_with_every_method(void **state) {
  (void)state;
  static build *const scene[] = {falling_sheet, falling_blob};
  for (int s = 0; s < 2; s++) {
    size_t n;
    double *exact = fall(scene[s], "rk4", 2e-5, 0, &n), before = INFINITY;
    for (double substeps = 16; substeps <= 256; substeps *= 2) {
      double off = fall_error(scene[s], "xpbd", 0.01, substeps, exact);
      print_message("xpbd with %g substeps: %.2e m off\n", substeps, off);
      assert_true(substeps < 64 || off < before / 1.6);
      before = off;
    }
    before = INFINITY;
    for (double h = 1e-3; h > 2e-4; h /= 2) {
      double off = fall_error(scene[s], "local_global", h, 0, exact);
      double newton = fall_error(scene[s], "backward_euler", h, 0, exact);
      print_message("h = %g s: local_global %.2e m off, backward_euler %.2e\n", h, off, newton);
      assert_true(off < before / 1.6);
      before = off;
    }
    free(exact);
  }
}

static void momentum_stays_without_outer_forces(void **state) {
  (void)state;
  for (int m = QUASI_NEWTON; m <= ONE_SWEEP; m++) {
    test_engine e;
    double sum[3] = {0}, size = 0;
    if (m == XPBD || m == XPBD_COLOURS) continue;
    elements_open(&e, 1e-3);
    elements_blob(&e, 3, 0.005, 1.3, 1e7, 1e4);
    use(&e, m);
    test_run(&e);
    const hk_view *view = hk_run_view(e.run);
    for (size_t k = 0; k < 3 * view->n; k++) sum[k % 3] += view->model->mass[k / 3] * view->v[k];
    test_advance(&e, 0.02);
    for (size_t k = 0; k < 3 * view->n; k++) {
      sum[k % 3] -= view->model->mass[k / 3] * view->v[k];
      size += view->model->mass[k / 3] * fabs(view->v[k]);
    }
    /* Rounding of 20 steps over 48 tetrahedra; local_global's x is rounded by 1e-17 m, its v by 1e-14 m/s a step. */
    for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-12 * size);
    test_engine_close(&e);
  }
}

/* Every 0.02 s the oldest particle dies, with its triangles and struts, and a free one is born. */
static void shrinking_sheet(test_engine *e) {
  crumpled_sheet(e);
  hk_plugin_spec *emitter = test_plugin(e, HK_SOURCE, "fixture:spout");
  test_number(e, emitter, "every", 0.02);
  test_number(e, emitter, "lifetime", 0.0199);
}

static void bodies_that_lose_particles_move_alike_with_every_method(void **state) {
  (void)state;
  size_t n, born;
  double *newton = positions(shrinking_sheet, NEWTON, 0.01, 10, &n);
  assert_int_equal(n, SIDE * SIDE + 5 - 5);
  for (int m = QUASI_NEWTON; m <= XPBD_COLOURS; m++) {
    double *x = positions(shrinking_sheet, m, 0.01, 10, &born), off = distance(x, newton, n);
    assert_int_equal(born, n);
    /* As in one step, grown by the motion of ten. */
    if (!(off < 1e-8)) fail_msg("%s: %g m off", method_name[m], off);
    free(x);
  }
  free(newton);
}

/* ---- threads ---- */

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  static const char *const method[] = {"xpbd", "local_global"};
  for (int m = 0; m < 2; m++) {
    double *x[2];
    size_t n = 0;
    for (int threads = 1; threads <= 2; threads++) {
      test_engine e;
      elements_open(&e, 0.01);
      e.scene->threads = threads;
      elements_stiffen(&e, elements_sheet(&e, 64, 0.01), 2e4, 1, 30);
      test_plugin(&e, HK_INTEGRATOR, method[m]);
      test_run(&e);
      test_advance(&e, 0.05);
      n = hk_run_view(e.run)->n;
      x[threads - 1] = malloc(6 * n * sizeof **x);
      memcpy(x[threads - 1], hk_run_view(e.run)->x, 3 * n * sizeof **x);
      memcpy(x[threads - 1] + 3 * n, hk_run_view(e.run)->v, 3 * n * sizeof **x);
      test_engine_close(&e);
    }
    assert_memory_equal(x[0], x[1], 6 * n * sizeof **x);
    assert_true(isfinite(x[0][0]));
    free(x[0]);
    free(x[1]);
  }
}

/* ---- checkpoints ---- */

/* local_global's weights are of the start, or of where its matrix became too soft: a resumed run has the same. */
static void resumed_runs_go_on_bit_by_bit(void **state) {
  (void)state;
  static const char *const method[] = {"xpbd", "local_global"};
  const double h = 0.01;
  for (int m = 0; m < 2; m++) {
    test_engine e[2];
    const char *path = test_write("elements.checkpoint", "");
    for (int again = 0; again < 2; again++) {
      elements_open(&e[again], h);
      elements_blob(&e[again], 3, 0.005, 4, 1e8, 1e4);
      test_plugin(&e[again], HK_INTEGRATOR, method[m]);
      if (again) e[again].scene->start_file = strdup(path);
      test_run(&e[again]);
      if (again) break;
      test_advance(&e[0], 10 * h);
      assert_int_equal(hk_run_save(e[0].run, path, &e[0].error), HK_OK);
    }
    for (int again = 0; again < 2; again++) test_advance(&e[again], 20 * h);
    assert_memory_equal(hk_run_view(e[0].run)->x, hk_run_view(e[1].run)->x, 3 * 27 * sizeof(double));
    assert_memory_equal(hk_run_view(e[0].run)->v, hk_run_view(e[1].run)->v, 3 * 27 * sizeof(double));
    test_engine_close(&e[0]);
    test_engine_close(&e[1]);
  }
}

/* ---- memory ---- */

static void every_allocation_that_fails_is_said(void **state) {
  (void)state;
  static const char *const method[] = {"xpbd", "local_global"};
  for (int m = 0; m < 2; m++) {
    hk_status status = HK_NO_MEMORY;
    for (long k = 1; status != HK_OK; k++) {
      test_engine e;
      elements_open(&e, 0.01);
      crumpled_sheet(&e);
      test_plugin(&e, HK_INTEGRATOR, method[m]);
      e.options.allocations = k;
      status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
      if (status == HK_OK) status = hk_run_advance(e.run, 0.01, &e.error);
      if (status != HK_OK && (status != HK_NO_MEMORY || !strstr(e.error.text, "no memory")))
        fail_msg("%s, allocation %ld: %s", method[m], k, e.error.text);
      assert_true(k < 200);
      test_engine_close(&e);
    }
  }
}

/* ---- what others make of such elements ---- */

static void desbrun_refuses_them_by_the_forces_label(void **state) {
  (void)state;
  test_engine e;
  elements_open(&e, 0.01);
  elements_blob(&e, 2, 0, 1, 1e6, 0);
  test_plugin(&e, HK_INTEGRATOR, "desbrun");
  test_run(&e);
  assert_int_equal(hk_run_advance(e.run, 0.01, &e.error), HK_FAILED);
  assert_non_null(strstr(e.error.text, "the elements of force 'volume_springs' are not plain edges"));
  test_engine_close(&e);
}

/* Steps of a sheet whose triangles grow tenfold, with a limit of the change of their strain. */
static size_t steps_of_growing_triangles(double stretch) {
  test_engine e;
  elements_open(&e, 1e-3);
  hk_plugin_spec *force = elements_sheet(&e, SIDE, 0);
  elements_stiffen(&e, force, 1e6, 0, 1);
  test_number(&e, force, "rest", 0.05);
  test_number(&e, test_plugin(&e, HK_INTEGRATOR, "baraff_witkin"), "stretch", stretch);
  test_run(&e);
  test_advance(&e, 1e-3);
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  assert_true(fabs(test_position(&e, 1)[0]) > 1e-5);
  test_engine_close(&e);
  return summary.steps;
}

static void baraff_witkin_looks_at_the_stretch_of_triangles_too(void **state) {
  (void)state;
  assert_int_equal(steps_of_growing_triangles(100), 1);
  assert_true(steps_of_growing_triangles(1e-3) > 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_matrix_that_is_too_soft_still_leads_to_backward_euler),
      cmocka_unit_test(edges_with_an_evaluate_move_as_plain_ones),
      cmocka_unit_test(falling_bodies_converge_with_every_method),
      cmocka_unit_test(momentum_stays_without_outer_forces),
      cmocka_unit_test(bodies_that_lose_particles_move_alike_with_every_method),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(resumed_runs_go_on_bit_by_bit),
      cmocka_unit_test(every_allocation_that_fails_is_said),
      cmocka_unit_test(desbrun_refuses_them_by_the_forces_label),
      cmocka_unit_test(baraff_witkin_looks_at_the_stretch_of_triangles_too),
      cmocka_unit_test(one_step_of_every_method_is_newtons_backward_euler),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
