/* Energy, forces and weights of elements in an implicit step, on elements made up here: distances between three
 * particles (which a move of the whole does not change) and ties of one particle to a place (which it does). */
#include "plugins/common/elements/element_energy.h"
#include "plugins/common/linear/laplacian.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 5, M = 3 * N };

static const double h = 0.1;
static const uint32_t bend_member[] = {0, 1, 2, 1, 2, 3, 2, 3, 4}, tie_member[] = {0, 4};
static double bend_k[] = {3, 5, 7}, bend_c[] = {0.2, 0, 0.4}, tie_k[] = {11};

/* Two numbers: |x_1 - x_0|^2 - 1 and |x_0 - 2 x_1 + x_2|^2. */
static void bend(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  (void)self;
  for (size_t t = begin; t < end; t++, C += 2, dC += 6) {
    const uint32_t *i = bend_member + 3 * t;
    C[0] = -1;
    C[1] = 0;
    for (size_t p = 0; p < 3; p++) {
      double a = x[3 * i[0] + p], b = x[3 * i[1] + p], c = x[3 * i[2] + p], s = b - a, q = a - 2 * b + c;
      C[0] += s * s;
      C[1] += q * q;
      dC[0][p] = -2 * s, dC[1][p] = 2 * s, dC[2][p] = 0;
      dC[3][p] = 2 * q, dC[4][p] = -4 * q, dC[5][p] = 2 * q;
    }
  }
}

/* |x|^2/2 */
static void tie(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  (void)self;
  for (size_t t = begin; t < end; t++, C++, dC++) {
    *C = 0;
    for (size_t p = 0; p < 3; p++) {
      (*dC)[p] = x[3 * tie_member[t] + p];
      *C += (*dC)[p] * (*dC)[p] / 2;
    }
  }
}

typedef struct scene {
  fake_system *f;
  hk_element_list list[2];
  hk_model model;
  hk_element_energy energy;
  double x[M], d[M];
} scene;

static void open_scene(scene *s) {
  memset(s, 0, sizeof *s);
  s->f = fake_system_create(&(fake_problem){.n = N});
  s->list[0].elements = (hk_elements){
      .node = {3, 3, bend_member}, .values = 2, .stiffness = {3, bend_k}, .damping = {3, bend_c}, .evaluate = bend};
  s->list[1].elements =
      (hk_elements){.node = {2, 1, tie_member}, .values = 1, .stiffness = {1, tie_k}, .evaluate = tie};
  s->list[0].acts = s->list[1].acts = true;
  s->model = s->f->model;
  s->model.element_lists = 2;
  s->model.element_list = s->list;
  for (int e = 0; e < M; e++) s->x[e] = sin(1 + 2.7 * e), s->d[e] = 0.1 * cos(1.3 * e);
  assert_int_equal(hk_element_energy_take(&s->energy, &s->f->host, &s->model, s->x, true), HK_OK);
  hk_element_energy_start(&s->energy, &s->f->host, s->x);
}

static double value(scene *s, const double *d) {
  double x[M], slope = 0;
  for (int e = 0; e < M; e++) x[e] = s->x[e] + d[e];
  hk_element_energy_evaluate(&s->energy, &s->f->host, x);
  return hk_element_energy_value(&s->energy, d, h, &slope);
}

static void forces_are_the_gradient_of_the_value(void **state) {
  (void)state;
  const double step = 1e-5;
  scene s;
  double F[M] = {0}, power = 0, damping = 0;
  open_scene(&s);
  for (int e = 0; e < M; e++) {
    double d[M];
    memcpy(d, s.d, sizeof d);
    d[e] += step;
    double up = value(&s, d);
    d[e] -= 2 * step;
    double down = value(&s, d);
    value(&s, s.d);
    memset(F, 0, sizeof F);
    hk_element_energy_forces(&s.energy, s.d, h, F, NULL);
    /* Rounding of some J over 1e-5 m; C is of second degree, so differences err by step^2 at most. */
    assert_true(fabs(h * h * F[e] + (up - down) / (2 * step)) < 1e-8);
  }
  hk_element_energy_forces(&s.energy, s.d, h, F, &power);
  bend_c[0] = bend_c[2] = 0;
  double with = value(&s, s.d);
  hk_element_energy_take(&s.energy, &s.f->host, &s.model, s.x, false);
  bend_c[0] = 0.2, bend_c[2] = 0.4;
  damping = with - value(&s, s.d);
  assert_true(power < 0);
  assert_true(fabs(h * h * h * power / 2 + damping) <
              1e-13 * with); /* Q = h/2 sum c (dC_0.d)^2, power = -sum c (./h)^2 */
  fake_system_destroy(s.f);
}

/* u.W u, W of the weights, against the tuples' u.(h (h k + c) dC dC^T) u for many u. */
static void weights_lie_above_the_matrix_of_gauss_and_newton(void **state) {
  (void)state;
  scene s;
  uint32_t pair[9][2];
  double weight[9], diagonal[N] = {0}, one[N];
  hk_laplacian l = {0};
  uint64_t bits = 1;
  open_scene(&s);
  assert_int_equal(s.energy.pairs, 9); /* three of each triple, none of the ties */
  hk_element_energy_pairs(&s.energy, pair);
  hk_element_energy_weights(&s.energy, h, weight, diagonal);
  assert_true(diagonal[0] > 0 && diagonal[4] > 0 && diagonal[1] == 0 && diagonal[2] == 0 && diagonal[3] == 0);
  for (int i = 0; i < N; i++) one[i] = 1;
  assert_int_equal(hk_laplacian_build(&l, &s.f->host, N, 9, (const uint32_t(*)[2])pair), HK_OK);
  hk_laplacian_fill(&l, diagonal, one, weight);
  hk_element_energy_evaluate(&s.energy, &s.f->host, s.x);
  for (int trial = 0; trial < 1000; trial++) {
    double u[M], above = 0, below = 0;
    for (int e = 0; e < M; e++) {
      bits = bits * 6364136223846793005u + 1442695040888963407u;
      u[e] = (double)(bits >> 11) * 0x1p-53 - 0.5 + (trial % 2 ? 3 : 0); /* every other one nearly a move of all */
    }
    for (size_t i = 0; i < N; i++)
      for (size_t q = l.row_start[i]; q < l.row_start[i + 1]; q++)
        for (size_t p = 0; p < 3; p++) above += u[3 * i + p] * l.matrix.value[q] * u[3 * l.column[q] + p];
    for (size_t t = 0; t < s.energy.tuples.count; t++) {
      const hk_element_tuple *e = &s.energy.tuples.item[t];
      for (unsigned v = 0; v < e->list->values; v++) {
        double along = 0;
        for (unsigned a = 0; a < e->list->node.arity; a++)
          for (size_t p = 0; p < 3; p++)
            along += s.energy.dC[e->gradient + e->list->node.arity * v + a][p] * u[3 * e->member[a] + p];
        below += h * (h * e->stiffness + e->damping) * along * along;
      }
    }
    assert_true(above > below);
  }
  fake_system_destroy(s.f);
}

static void weights_rise_with_the_gradients_and_never_fall(void **state) {
  (void)state;
  scene s;
  double x[M], weight[9], higher[9], diagonal[N] = {0}, raised[N] = {0};
  open_scene(&s);
  hk_element_energy_weights(&s.energy, h, weight, diagonal);
  for (int e = 0; e < M; e++) x[e] = s.x[e] / 2;
  hk_element_energy_evaluate(&s.energy, &s.f->host, x);
  assert_false(hk_element_energy_raise(&s.energy));
  for (int e = 0; e < M; e++) x[e] = s.x[e] * 2;
  hk_element_energy_evaluate(&s.energy, &s.f->host, x);
  assert_true(hk_element_energy_raise(&s.energy));
  hk_element_energy_weights(&s.energy, h, higher, raised);
  /* All C here are quadratic: twice the gradients, four times the weights. */
  for (int e = 0; e < 9; e++) assert_true(fabs(higher[e] / weight[e] - 4) < 1e-12);
  assert_true(fabs(raised[4] / diagonal[4] - 4) < 1e-12);
  fake_system_destroy(s.f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(forces_are_the_gradient_of_the_value),
      cmocka_unit_test(weights_lie_above_the_matrix_of_gauss_and_newton),
      cmocka_unit_test(weights_rise_with_the_gradients_and_never_fall),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
