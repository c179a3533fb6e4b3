/* K and D are central differences of the accelerations, projected onto what pins and constraints allow. A step is
 * stable while the spectral radius of the plugin's own step on these equations (step_matrix.h) is at most 1, but for
 * what a foretold limit allows. */
#include "tests/support/linear_scene.h"

#include "core/numerics/stability/operation.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* A pull on every particle, relative to the largest stiffness: modes without stiffness, whose roots are double, would
 * show the rounding of the differences, 1e-10, as growth by its root. */
static const double pull = 1e-6;
static const double by_x = 1e-5, by_v = 1e-3; /* of the differences, m and m/s */

static void apply(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                  double *dy) {
  const linear_scene *q = context;
  (void)t, (void)y, (void)dy;
  for (size_t r = 0; r < q->numbers; r++)
    for (size_t c = 0; c < q->numbers; c++) a[r] -= q->h * q->h * q->K[r][c] * x[c] + q->h * q->D[r][c] * v[c];
}

static void accelerations(hk_system *s, const double *x, const double *v, double *a) {
  size_t size = 3 * s->n * sizeof *x, tail = (s->size - 6 * s->n) * sizeof *x;
  double *copy[2] = {malloc(size), malloc(size)}, *dy = malloc(tail);
  assert_true(copy[0] && copy[1] && dy);
  memcpy(copy[0], x, size);
  memcpy(copy[1], v, size);
  assert_int_equal(s->accelerations(s, s->t, copy[0], copy[1], s->X + 6 * s->n, a, dy), HK_OK);
  for (int k = 0; k < 2; k++) free(copy[k]);
  free(dy);
}

/* column = -d(sqrt(m) a)/du, u being the displacement of sqrt(m) x (or of sqrt(m) v) along one component, as far as
 * pins and constraints allow it. memory: 3 vectors. */
static void difference(hk_system *s, bool velocity, size_t component, double *column, double *memory) {
  size_t count = 3 * s->n;
  double *u = memory, *moved = memory + count, *a = memory + 2 * count, step = velocity ? by_v : by_x;
  const double *w = s->model->inverse_mass, *x = s->X, *v = s->X + count;
  for (size_t c = 0; c < count; c++) u[c] = c == component;
  assert_int_equal(hk_operation_allow(s, u), HK_OK);
  for (int side = 1; side >= -1; side -= 2) {
    for (size_t c = 0; c < count; c++)
      moved[c] = (velocity ? v : x)[c] + side * step * u[c] * sqrt(w[c / 3] / w[component / 3]);
    accelerations(s, velocity ? x : moved, velocity ? moved : v, side > 0 ? column : a);
  }
  for (size_t c = 0; c < count; c++)
    column[c] = w[c / 3] > 0 ? -(column[c] - a[c]) * sqrt(w[component / 3] / w[c / 3]) / (2 * step) : 0;
  assert_int_equal(hk_operation_allow(s, column), HK_OK);
}

/* Makes K symmetric, as it is where no velocity matters, and adds the pull. */
static void settle(linear_scene *q) {
  double most = 0;
  for (size_t r = 0; r < q->numbers; r++)
    for (size_t c = 0; c < r; c++) q->K[r][c] = q->K[c][r] = (q->K[r][c] + q->K[c][r]) / 2;
  for (size_t r = 0; r < q->numbers; r++)
    for (size_t c = 0; c < q->numbers; c++) most = fmax(most, fabs(q->K[r][c]));
  for (size_t r = 0; r < q->numbers; r++) q->K[r][r] += most > 0 ? pull * most : 1e-12;
}

linear_scene linear_scene_of(test_engine *e) {
  hk_system *s = &e->run->dynamics.system;
  size_t count = 3 * s->n, free_one[LINEAR_NUMBERS];
  linear_scene q = {.h = 1};
  double *column = malloc(4 * count * sizeof *column);
  assert_non_null(column);
  for (size_t c = 0; c < count; c++)
    if (s->model->inverse_mass[c / 3] > 0) {
      assert_true(q.numbers < LINEAR_NUMBERS);
      free_one[q.numbers++] = c;
    }
  for (size_t c = 0; c < q.numbers; c++)
    for (int part = 0; part < 2; part++) {
      difference(s, part == 1, free_one[c], column, column + count);
      for (size_t r = 0; r < q.numbers; r++) (part ? q.D : q.K)[r][c] = column[free_one[r]];
    }
  free(column);
  settle(&q);
  return q;
}

/* By Cholesky's factorisation. */
bool linear_scene_rests(const linear_scene *q) {
  double L[LINEAR_NUMBERS][LINEAR_NUMBERS];
  for (size_t r = 0; r < q->numbers; r++)
    for (size_t c = 0; c <= r; c++) {
      double sum = q->K[r][c];
      for (size_t k = 0; k < c; k++) sum -= L[r][k] * L[c][k];
      if (r == c && !(sum > 0)) return false;
      L[r][c] = r == c ? sqrt(sum) : sum / L[c][c];
    }
  return true;
}

/* Adaptive methods take the step whatever its error is. */
fake_method linear_scene_open(const char *method, linear_scene *q, double h) {
  static const double any = 1e30;
  q->h = h;
  fake_system *f = fake_system_create(&(fake_problem){q->numbers / 3, 0, HK_DEPENDS_ON_X | HK_DEPENDS_ON_V, apply, q});
  for (size_t c = 0; c < 2 * q->numbers; c++) f->system.X[c] = sin(1 + 2.3 * (double)c);
  fake_method m = fake_method_open(method, f);
  if (m.plugin->integrator->flags & HK_ADAPTIVE) f->system.tol = any;
  return m;
}

void linear_scene_close(fake_method *m) {
  fake_system *f = m->system;
  fake_method_close(m);
  fake_system_destroy(f);
}

bool linear_scene_stable(const char *method, linear_scene *q, double h) {
  fake_method m = linear_scene_open(method, q, h);
  bool exceeds = step_growth_exceeds(&m, 1 + LINEAR_EXCESS);
  linear_scene_close(&m);
  return !exceeds;
}

double linear_scene_ratio(const char *method, linear_scene *q, double foretold) {
  double low = foretold, high = foretold;
  if (linear_scene_stable(method, q, foretold))
    while (high < 10 * foretold && linear_scene_stable(method, q, high *= 1.1)) low = high;
  else
    while (low > foretold / 100 && !linear_scene_stable(method, q, low /= 1.1)) high = low;
  while (high > (1 + LINEAR_PRECISION) * low) {
    double middle = sqrt(low * high);
    if (linear_scene_stable(method, q, middle))
      low = middle;
    else
      high = middle;
  }
  return foretold / low;
}
