/* Changes of forces along directions, for tangents: those by parameters and masses are the central differences between
 * two scenes, and all of them together are the transposed of the products for adjoints. Elements fill several blocks of
 * lanes and a part of one, and some particles are left out. */
#include "core/engine/contract/contract.h"
#include "core/numerics/sensitivity/force_slopes.h"
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* All numbers of the force are q times larger, each by its own part; which: variants of the same scene. */
typedef hk_plugin_spec *scene(test_engine *, int which, double q);

typedef struct subject {
  const char *name;
  scene *make;
  int variants;
} subject;

enum { N = 150 };

static void particles(test_engine *e, double q) {
  for (uint32_t i = 0; i < N; i++) {
    test_particle(e, 0.1 * i, 0.3 * sin(0.5 * i), 0.2 * cos(0.7 * i), (1 + 0.01 * i) * (1 + q));
    for (size_t c = 0; c < 3; c++) e->scene->particles.velocity[3 * i + c] = cos(1.7 * i + (double)c);
  }
}

static void number(test_engine *e, hk_plugin_spec *spec, const char *name, double value, double q) {
  test_number(e, spec, name, value * (1 + q));
}

static hk_plugin_spec *springs(test_engine *e, int which, double q) {
  static uint32_t pair[2 * N][2];
  static double k[2 * N], rest[2 * N];
  particles(e, which ? 0 : q);
  for (uint32_t i = 0; i < 2 * N - 3; i++) {
    pair[i][0] = i / 2 + 1, pair[i][1] = i / 2 + 2 + i % 2;
    k[i] = (3 + sin(i)) * (1 + q);
    rest[i] = i % 7 ? 0.2 * (1 + 0.3 * q) : 0;
  }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "springs");
  test_edges(e, spec, (const uint32_t(*)[2])pair, 2 * N - 3);
  if (which == 0) number(e, spec, "k", 3, q);
  if (which > 0) test_list(e, spec, "k", k, 2 * N - 3);
  if (which > 0) test_list(e, spec, "rest", rest, 2 * N - 3);
  if (which > 1) number(e, spec, "damping", 0.3, 2 * q);
  return spec;
}

static hk_plugin_spec *angle_springs(test_engine *e, int which, double q) {
  static uint32_t joint[N - 2][3];
  static double damping[N - 2];
  particles(e, 0);
  for (size_t i = 40; i < 45; i++) /* straight */
    memcpy(e->scene->particles.position + 3 * i, (double[]){0.25 * (double)i, 0.5, 0.125}, 3 * sizeof(double));
  for (uint32_t i = 0; i < N - 2; i++) {
    for (uint32_t c = 0; c < 3; c++) joint[i][c] = i + c + 1;
    damping[i] = i % 3 == 0 ? 0.2 * (1 + q) : 0;
  }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "angle_springs");
  test_tuples(e, spec, "joints", 3, &joint[0][0], N - 2);
  number(e, spec, "k", 3, q);
  number(e, spec, "rest", which % 2 ? 0.2 : 0, q);
  if (which >= 2) test_list(e, spec, "damping", damping, N - 2);
  if (which % 2) test_vector(e, spec, "normal", 0, 0.6, 0.8);
  return spec;
}

static void shaken(test_engine *e, size_t n) {
  for (size_t k = 0; k < 3 * n; k++) {
    e->scene->particles.velocity[k] = sin(1.9 * (double)k);
    e->scene->particles.position[k] += 0.02 * cos(2.3 * (double)k);
  }
}

/* Bending that is damped or not, and membranes of three models. */
static hk_plugin_spec *sheets(test_engine *e, int which, double q) {
  static const char *const force[] = {"membrane", "membrane", "membrane", "hinges", "quadratic_bending"};
  static const char *const models[] = {"baraff_witkin", "stvk", "neo_hookean"};
  sheet s = sheet_make(SHEET_IRREGULAR, 9, (double[]){0.4, 0.3, -0.5});
  hk_plugin_spec *spec = sheet_add(e, &s, force[which % 5]);
  if (which % 5 < 3) {
    test_text(e, spec, "model", models[which % 5]);
    number(e, spec, "stiffness", 2, q);
    if (which % 5) number(e, spec, "nu", 0.3, 0.5 * q);
    if (which >= 5) number(e, spec, "damping", 0.1, 2 * q);
    if (which >= 5 && which % 5 < 2) number(e, spec, "weft", 1.5, 3 * q);
    if (which >= 5 && which % 5 < 2) number(e, spec, "shear", 0.7, -q);
  } else {
    number(e, spec, "rigidity", 0.1, q);
    if (which % 5 == 3) number(e, spec, "rest", 0.2, q);
    if (which == 8) number(e, spec, "damping", 0.02, 2 * q);
  }
  shaken(e, s.particles);
  sheet_free(&s);
  return spec;
}

static hk_plugin_spec *solid(test_engine *e, int which, double q) {
  static uint32_t corner[N - 3][4];
  for (uint32_t i = 0; i < N; i++) /* a screw of tetrahedra (Coxeter), each of which has three corners of the last */
    test_particle(e, cos(2.3005239830218631 * i), sin(2.3005239830218631 * i), 0.3651483716701107 * 1.6666666667 * i,
                  1);
  for (uint32_t i = 0; i < N - 3; i++) {
    for (uint32_t c = 0; c < 4; c++) corner[i][c] = i + c + 1;
    const double *x = e->scene->particles.position + 3 * i, *o = x;
    double a[3][3];
    for (int k = 0; k < 9; k++) a[k / 3][k % 3] = x[3 + k] - o[k % 3];
    double volume = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) +
                    a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2]) +
                    a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    if (volume < 0) corner[i][2] = i + 4, corner[i][3] = i + 3;
  }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "neo_hookean");
  test_tuples(e, spec, "tetrahedra", 4, &corner[0][0], N - 3);
  number(e, spec, "E", 5, q);
  number(e, spec, "nu", 0.3, 0.4 * q);
  if (which) number(e, spec, "damping", 0.4, 2 * q);
  for (size_t k = 0; k < 3 * N; k++) e->scene->particles.velocity[k] = sin(1.9 * (double)k);
  return spec;
}

static hk_plugin_spec *central(test_engine *e, int which, double q) {
  static const double powers[] = {1, -2, -1.5, 2};
  particles(e, q);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "central");
  test_vector(e, spec, "center", 3 + 0.3 * q, 0.1, 0.2 + 0.2 * q);
  number(e, spec, "strength", 2, q);
  number(e, spec, "power", powers[which % 4], which % 4 < 2 ? 0 : 0.3 * q);
  number(e, spec, "softening", 0.2, 2 * q);
  if (which / 4 % 2) test_vector(e, spec, "axis", 0.3, -1 - q, 0.5);
  if (which / 8) number(e, spec, "range", 4.03, 0.7 * q);
  return spec;
}

static hk_plugin_spec *drag(test_engine *e, int which, double q) {
  particles(e, q);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "drag");
  number(e, spec, which == 0 ? "d" : which == 1 ? "rate" : "viscosity", 0.3, q);
  if (which == 2) number(e, spec, "radius", 0.01, 0.3 * q);
  return spec;
}

static hk_plugin_spec *gravity(test_engine *e, int which, double q) {
  (void)which;
  particles(e, q);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "gravity");
  test_vector(e, spec, "g", q, 2, -9.81 * (1 + q));
  return spec;
}

static const subject SUBJECTS[] = {{"springs", springs, 3},  {"angle_springs", angle_springs, 4},
                                   {"sheets", sheets, 9},    {"solid", solid, 2},
                                   {"central", central, 16}, {"drag", drag, 3},
                                   {"gravity", gravity, 1}};
enum { COUNT = sizeof SUBJECTS / sizeof *SUBJECTS };

typedef struct trio {
  test_engine own, more, less;
  hk_instance *force[3];
  hk_view view; /* at a point where nothing is at rest */
  double *X;
  hk_varied by;
  hk_force_slopes slopes;
  hk_force_changes changes;
} trio;

/* A step of 1e-5 leaves 1e-10 of third derivatives, and eps/1e-5. */
static const double step = 1e-5;

static hk_instance *open(test_engine *e, const subject *s, int which, double q) {
  test_engine_open(e);
  hk_plugin_spec *spec = s->make(e, which, q);
  test_run(e);
  return test_instance(e, spec);
}

static void open_trio(trio *t, const subject *s, int which) {
  static const bool exact[] = {true};
  *t = (trio){0};
  t->force[0] = open(&t->own, s, which, 0);
  t->force[1] = open(&t->more, s, which, step);
  t->force[2] = open(&t->less, s, which, -step);
  hk_dynamics *d = &t->own.run->dynamics;
  size_t size = 3 * d->state->model.n;
  t->X = malloc(2 * size * sizeof *t->X);
  memcpy(t->X, d->state->X, 2 * size * sizeof *t->X);
  for (size_t e = 0; e < size; e++) t->X[e] += 0.03 * sin(1.1 * (double)e * (double)e);
  t->view = hk_force_view_at(d, 0, 0, t->X, size / 3);
  t->by = (hk_varied){&t->more.run->dynamics, &t->less.run->dynamics, step, NULL};
  assert_int_equal(hk_force_slopes_open(&t->slopes, d, exact), HK_OK);
  assert_true(hk_force_slopes_fit(&t->slopes, d, &t->by));
  assert_int_equal(hk_force_changes_open(&t->changes, &t->slopes, d, &t->by), HK_OK);
}

static void close_trio(trio *t) {
  hk_force_changes_close(&t->changes, &t->own.run->dynamics);
  hk_force_slopes_close(&t->slopes, &t->own.run->dynamics);
  test_engine_close(&t->own);
  test_engine_close(&t->more);
  test_engine_close(&t->less);
  free(t->X);
}

static double largest(const double *list, size_t count) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(list[e]));
  return most;
}

static double *fresh(size_t count) {
  double *list = calloc(count + 1, sizeof *list);
  assert_non_null(list);
  return list;
}

static void along(const trio *t, const double *w, bool parameters, double *force) {
  const hk_implicit_facet *f = &hk_force_of(t->force[0]->plugin)->implicit;
  double *none = fresh(3 * t->view.n);
  const hk_tangent direction = {w ? w : none, w ? w + 3 * t->view.n : none, parameters ? t->changes.force[0] : NULL,
                                parameters ? t->changes.mass : NULL, force};
  assert_int_equal(f->along(t->force[0]->self, &t->view, &direction, 1), HK_OK);
  free(none);
}

static void by_parameters(trio *t, const char *name, int which) {
  size_t size = 3 * t->view.n;
  double *force = fresh(3 * size), *side[2] = {force + size, force + 2 * size};
  for (int k = 0; k < 2; k++) {
    hk_dynamics *d = k ? t->by.more : t->by.less;
    const hk_view view = hk_force_view_at(d, 0, 0, t->X, size / 3);
    assert_int_equal(hk_force_of(t->force[2 - k]->plugin)->own.add(t->force[2 - k]->self, &view, side[k]), HK_OK);
  }
  along(t, NULL, true, force);
  for (size_t e = 0; e < size; e++) side[0][e] = (side[1][e] - side[0][e]) / (2 * step);
  double most = largest(side[0], size);
  assert_true(most > 0);
  for (size_t e = 0; e < size; e++)
    if (!(fabs(force[e] - side[0][e]) <= 1e-8 * most))
      fail_msg("%s %d, number %zu: %.10g, not %.10g of %g", name, which, e, force[e], side[0][e], most);
  free(force);
}

/* u.along(w) = transposed(u).w, up to the rounding of sums of the size of the force's change. */
static void by_transposed(trio *t, const char *name, int which) {
  const hk_implicit_facet *f = &hk_force_of(t->force[0]->plugin)->implicit;
  hk_dynamics *d = &t->own.run->dynamics;
  size_t size = 3 * t->view.n;
  double *u = fresh(6 * size), *w = u + size, *by = w + 2 * size, *force = by + 2 * size, left = 0, right = 0, sum = 0;
  for (size_t e = 0; e < size; e++) u[e] = cos(1.3 * (double)e);
  for (size_t e = 0; e < 2 * size; e++) w[e] = sin(0.9 * (double)e) + 0.2;
  along(t, w, true, force);
  const hk_transposed into = {by, by + size, (double *const *)t->slopes.force[0], t->slopes.mass};
  assert_int_equal(f->transposed(t->force[0]->self, &t->view, u, &into), HK_OK);
  for (size_t e = 0; e < size; e++) left += u[e] * force[e], sum += fabs(u[e] * force[e]);
  for (size_t e = 0; e < 2 * size; e++) right += by[e] * w[e], sum += fabs(by[e] * w[e]);
  right += hk_force_slopes_by(&t->slopes, d, &t->by);
  if (!(fabs(left - right) <= 1e-12 * sum)) fail_msg("%s %d: %.15g and %.15g of %g", name, which, left, right, sum);
  free(u);
}

static void changes_by_parameters_are_differences_of_forces(void **state) {
  (void)state;
  for (const subject *s = SUBJECTS; s < SUBJECTS + COUNT; s++)
    for (int which = 0; which < s->variants; which++) {
      trio t;
      open_trio(&t, s, which);
      by_parameters(&t, s->name, which);
      close_trio(&t);
    }
}

static void changes_are_the_transposed_of_products(void **state) {
  (void)state;
  for (const subject *s = SUBJECTS; s < SUBJECTS + COUNT; s++)
    for (int which = 0; which < s->variants; which++) {
      trio t;
      open_trio(&t, s, which);
      by_transposed(&t, s->name, which);
      close_trio(&t);
    }
}

/* Several directions at once are each alone, and the same bits on every processor. */
static void directions_do_not_mix(void **state) {
  (void)state;
  for (const subject *s = SUBJECTS; s < SUBJECTS + COUNT; s++) {
    trio t;
    open_trio(&t, s, s->variants - 1);
    const hk_implicit_facet *f = &hk_force_of(t.force[0]->plugin)->implicit;
    size_t size = 3 * t.view.n;
    double *w = fresh(6 * size), *one = w + 2 * size, *all = one + 2 * size;
    int own = t.force[0]->host.lanes;
    for (size_t e = 0; e < 2 * size; e++) w[e] = sin(0.9 * (double)e);
    along(&t, w, true, one);
    along(&t, w, false, one + size);
    const hk_tangent two[] = {{w, w + size, t.changes.force[0], t.changes.mass, all},
                              {w, w + size, NULL, NULL, all + size}};
    for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
      memset(all, 0, 2 * size * sizeof *all);
      t.force[0]->host.lanes = lanes;
      assert_int_equal(f->along(t.force[0]->self, &t.view, two, 2), HK_OK);
      assert_memory_equal(one, all, 2 * size * sizeof *one);
    }
    t.force[0]->host.lanes = own;
    free(w);
    close_trio(&t);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(changes_by_parameters_are_differences_of_forces),
      cmocka_unit_test(changes_are_the_transposed_of_products),
      cmocka_unit_test(directions_do_not_mix),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
