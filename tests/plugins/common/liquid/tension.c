/* Surface tension on a liquid's grid: the curvature of a round drop is that of its radius, so that a drop at rest stays
 * at rest, and momentum is kept. */
#include "plugins/common/liquid/tension.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

typedef struct fixture {
  test_solver s; /* its host */
  hk_liquid l;
  hk_tension t;
} fixture;

static const double low = 1.03, middle[3] = {0.013, 0.007, -0.011}; /* m: among the cells the drop is nowhere special */

/* A drop of the half axes a, b and b in a box of side 2.06 m, plane or not. */
static fixture *open_drop(double cell, bool plane, double a, double b) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  test_solver_open(&f->s, "pcg", 1);
  const hk_host *host = &f->s.solver->host;
  hk_liquid_grid *g = &f->l.grid;
  f->l.density = 1000;
  f->l.tolerance = 1e-10;
  const double from[3] = {-low, plane ? 0 : -low, -low}, to[3] = {low, plane ? 0 : low, low};
  assert_int_equal(hk_liquid_grid_open(g, host, from, to, cell, 1e9), HK_OK);
  assert_int_equal(hk_liquid_open(&f->l, host, 1), HK_OK);
  hk_liquid_walls(&f->l);
  for (size_t i = 0; i < g->size; i++) {
    double x[3], size = 0;
    for (int c = 0; c < 3; c++) {
      x[c] = g->flat[c] ? 0 : g->low[c] + ((double)(i / g->stride[c] % (g->cells[c] + 2)) - 0.5) * g->spacing[c];
      x[c] = g->flat[c] ? 0 : (x[c] - middle[c]) / (c == 0 ? a : b);
      size += x[c] * x[c];
      g->weight[c][i] = 1;
    }
    double s = fmax(-1, fmin(1, (sqrt(size) - 1) * b / g->spacing[0]));
    g->filled[i] = 0.5 - s + s * fabs(s) / 2;
  }
  hk_liquid_find_surface(&f->l);
  return f;
}

static void close_drop(fixture *f) {
  hk_tension_close(&f->t, f->l.host);
  hk_liquid_close(&f->l);
  test_solver_close(&f->s);
  free(f);
}

/* Of the curvature where the surface passes between cells, by that of the radius: the mean's, and the largest. */
static void curvature_errors(double cell, bool plane, double *mean, double *most) {
  const double R = 0.62;
  fixture *f = open_drop(cell, plane, R, R);
  const hk_liquid_grid *g = &f->l.grid;
  double known = (plane ? 1 : 2) / R, sum = 0, count = 0;
  *most = 0;
  f->t.tension = 1;
  assert_int_equal(hk_liquid_draw_in(&f->l, &f->t, 1e-3), HK_OK);
  for (size_t k = 0; k < f->l.pressure.rows; k++) {
    size_t i = f->l.pressure.cell[k];
    bool last = false; /* of the liquid on its way out */
    for (int c = 0; c < 3; c++) last |= !g->flat[c] && g->unknown[i + g->stride[c]] == HK_LIQUID_NONE;
    if (!last) continue;
    sum += f->t.bend[i] / known, count++;
    *most = fmax(*most, fabs(f->t.bend[i] / known - 1));
  }
  *mean = sum / count - 1;
  close_drop(f);
}

/* Laplace's pressure is sigma times that: sigma/R in a plane, 2 sigma/R in space. The parts of cells here are those
 * beside a flat surface along an axis, which is what hundredths of the error come from. */
static void the_curvature_of_a_drop_is_that_of_its_radius(void **state) {
  (void)state;
  for (int plane = 0; plane < 2; plane++) {
    double mean, most;
    curvature_errors(2.06 / (plane ? 64 : 24), plane, &mean, &most);
    if (!(fabs(mean) < 0.03 && most < 0.1)) fail_msg("plane %d: %.3g in the mean, %.3g at most", plane, mean, most);
  }
}

/* m/s after a step of 1 ms with sigma = 1000 N/m, by what an uneven curvature of 1/R would give across a cell. */
static double stir(double a, double b) {
  const double cell = 2.06 / 32, h = 1e-3;
  fixture *f = open_drop(cell, true, a, b);
  hk_liquid_grid *g = &f->l.grid;
  double *guess = calloc(g->size, sizeof *guess), most = 0;
  f->t.tension = 1000;
  assert_int_equal(hk_liquid_draw_in(&f->l, &f->t, h), HK_OK);
  assert_int_equal(hk_liquid_project(&f->l, guess), HK_OK);
  for (int c = 0; c < 3; c += 2)
    for (size_t i = 0; i < g->size; i++)
      if (g->unknown[i] != HK_LIQUID_NONE) most = fmax(most, fabs(g->u[c][i]));
  free(guess);
  close_drop(f);
  return most / (h * 1000 / 1000 / (b * cell));
}

static void a_round_drop_rests_and_a_long_one_does_not(void **state) {
  (void)state;
  double round_one = stir(0.62, 0.62), long_one = stir(0.7, 0.55);
  if (!(round_one < 0.03 && long_one > 4 * round_one)) fail_msg("%.3g and %.3g", round_one, long_one);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_curvature_of_a_drop_is_that_of_its_radius),
      cmocka_unit_test(a_round_drop_rests_and_a_long_one_does_not),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
