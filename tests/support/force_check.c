#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

hk_view force_view(test_engine *e, const hk_instance *force) {
  hk_view view = *hk_run_view(e->run);
  view.host = &force->host;
  view.active = force->active;
  view.is_active = force->is_active;
  view.acting = force->is_active ? force->acting : view.n;
  view.power = NULL;
  return view;
}

double force_evaluate(const hk_instance *force, const hk_view *view, double *F) {
  double power = 0;
  hk_view own = *view;
  own.power = &power;
  memset(F, 0, 3 * view->n * sizeof *F);
  assert_int_equal(hk_force_add(force, &own, F), HK_OK);
  return power;
}

static double worst(const double *a, const double *b, size_t count) {
  double off = 0, largest = 0;
  for (size_t k = 0; k < count; k++) {
    if (!isfinite(a[k]) || !isfinite(b[k])) return INFINITY;
    off = fmax(off, fabs(a[k] - b[k]));
    largest = fmax(largest, fabs(a[k]));
  }
  return largest > 0 ? off / largest : off;
}

double force_gradient_error(const hk_instance *force, const hk_view *view) {
  size_t size = 3 * view->n;
  double *x = malloc(size * sizeof *x), *F = malloc(size * sizeof *F), *dE = malloc(size * sizeof *dE), best = INFINITY;
  hk_view moved = *view;
  force_evaluate(force, view, F);
  memcpy(x, view->x, size * sizeof *x);
  moved.x = x;
  for (double h = 1e-3; h > 1e-8; h /= 4) {
    for (size_t k = 0; k < size; k++) {
      double at = x[k];
      x[k] = at + h;
      double up = force->plugin->force->energy(force->self, &moved);
      x[k] = at - h;
      dE[k] = -(up - force->plugin->force->energy(force->self, &moved)) / (2 * h);
      x[k] = at;
    }
    best = fmin(best, worst(F, dE, size));
  }
  free(x);
  free(F);
  free(dE);
  return best;
}

typedef struct names {
  hk_pattern pattern; /* first member */
  size_t count, room;
  uint32_t (*at)[2];
} names;

static void name(hk_pattern *pattern, uint32_t row, uint32_t column) {
  names *list = (names *)(void *)pattern;
  if (list->count == list->room) {
    list->room = 2 * list->room + 16;
    list->at = realloc(list->at, list->room * sizeof *list->at);
    assert_non_null(list->at);
  }
  list->at[list->count][0] = row;
  list->at[list->count++][1] = column;
}

static void expand(const names *list, const double *block, size_t size, double *full) {
  memset(full, 0, size * size * sizeof *full);
  for (size_t b = 0; b < list->count; b++)
    for (size_t q = 0; q < 9; q++)
      full[(3 * list->at[b][0] + q / 3) * size + 3 * list->at[b][1] + q % 3] += block[9 * b + q];
}

static double largest(const double *list, size_t count) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(list[e]));
  return most;
}

/* A product of the force's own is that of its blocks up to rounding, which is of the size of the largest number of the
 * blocks, since parts of a block may cancel. */
static void check_transposed(const hk_instance *force, const hk_view *view, const double *K, const double *D) {
  const hk_implicit_facet *f = &hk_force_of(force->plugin)->implicit;
  size_t size = 3 * view->n;
  double *u = calloc(3 * size + 1, sizeof *u), *x = u + size, *v = x + size;
  double by_x = 1e-12 * largest(K, size * size), by_v = 1e-12 * largest(D, size * size);
  for (size_t e = 0; e < size; e++) u[e] = cos(1.3 * (double)e);
  assert_int_equal(f->transposed(force->self, view, u, &(hk_transposed){.x = x, .v = v}), HK_OK);
  for (size_t e = 0; e < size; e++) {
    double of_x = x[e], of_v = v[e];
    for (size_t r = 0; r < size; r++) {
      of_x += K[r * size + e] * u[r];
      of_v += D[r * size + e] * u[r];
    }
    if (!(fabs(of_x) <= by_x && fabs(of_v) <= by_v)) fail_msg("%zu: %g of %g, %g of %g", e, of_x, by_x, of_v, by_v);
  }
  free(u);
}

/* So is its change along a direction. */
static void check_along(const hk_instance *force, const hk_view *view, const double *K, const double *D) {
  const hk_implicit_facet *f = &hk_force_of(force->plugin)->implicit;
  size_t size = 3 * view->n;
  double *x = calloc(3 * size + 1, sizeof *x), *v = x + size, *to = v + size;
  double tolerance = 1e-12 * (largest(K, size * size) + largest(D, size * size));
  for (size_t e = 0; e < size; e++) x[e] = cos(1.3 * (double)e), v[e] = sin(0.8 * (double)e);
  assert_int_equal(f->along(force->self, view, &(hk_tangent){.x = x, .v = v, .force = to}, 1), HK_OK);
  for (size_t r = 0; r < size; r++) {
    for (size_t e = 0; e < size; e++) to[r] += K[r * size + e] * x[e] + D[r * size + e] * v[e];
    if (!(fabs(to[r]) <= tolerance)) fail_msg("%zu: %g of %g", r, to[r], tolerance);
  }
  free(x);
}

size_t force_matrices(const hk_instance *force, const hk_view *view, double *K, double *D) {
  names list = {.pattern = {name}};
  hk_force_of(force->plugin)->implicit.pattern(force->self, view, &list.pattern);
  size_t *slot = malloc((list.count + 1) * sizeof *slot), count = list.count;
  double *block[2];
  for (size_t b = 0; b < count; b++) slot[b] = b;
  for (int m = 0; m < 2; m++) block[m] = calloc(9 * count + 1, sizeof *block[m]);
  hk_blocks into = {.slot = slot, .K = block[0], .D = block[1]};
  assert_int_equal(hk_force_of(force->plugin)->implicit.jacobian(force->self, view, &into), HK_OK);
  expand(&list, block[0], 3 * view->n, K);
  expand(&list, block[1], 3 * view->n, D);
  if (hk_force_of(force->plugin)->implicit.transposed) check_transposed(force, view, K, D);
  if (hk_force_of(force->plugin)->implicit.along) check_along(force, view, K, D);
  for (int m = 0; m < 2; m++) free(block[m]);
  free(slot);
  free(list.at);
  return count;
}

static double matrix_error(const hk_instance *force, const hk_view *view, bool by_velocity) {
  size_t size = 3 * view->n;
  double *room = malloc((3 * size + 3 * size * size) * sizeof *room), best = INFINITY;
  double *z = room, *plus = z + size, *minus = plus + size, *K = minus + size, *D = K + size * size,
         *measured = D + size * size;
  hk_view moved = *view;
  force_matrices(force, view, K, D);
  memcpy(z, by_velocity ? view->v : view->x, size * sizeof *z);
  *(by_velocity ? &moved.v : &moved.x) = z;
  for (double h = 1e-3; h > 1e-8; h /= 4) {
    for (size_t k = 0; k < size; k++) {
      double at = z[k];
      z[k] = at + h;
      force_evaluate(force, &moved, plus);
      z[k] = at - h;
      force_evaluate(force, &moved, minus);
      z[k] = at;
      for (size_t r = 0; r < size; r++) measured[r * size + k] = -(plus[r] - minus[r]) / (2 * h);
    }
    best = fmin(best, worst(by_velocity ? D : K, measured, size * size));
  }
  free(room);
  return best;
}

double force_stiffness_error(const hk_instance *force, const hk_view *view) { return matrix_error(force, view, false); }

double force_damping_error(const hk_instance *force, const hk_view *view) { return matrix_error(force, view, true); }
