/* XPBD's step for elements of any arity and several numbers, on elements made up here. Where C is linear in x a tuple
 * is solved exactly; where it is not, what many sweeps come to is backward Euler. */
#include "plugins/common/elements/xpbd_elements.h"
#include "tests/support/fake_system.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 6, VALUES = 3, SWEEPS = 4000 };

static const double h = 0.05, k = 40, c = 0.7;
static const uint32_t member[] = {0, 1, 2, 3, 2, 3, 4, 5};

/* C_e = sum over members of b.x + bend |x|^2/2 - 1, b by member and number. */
static double bend;

static double coefficient(unsigned e, unsigned a, unsigned p) { return sin(1 + 7.0 * e + 3.0 * a + 1.7 * p); }

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  (void)self;
  for (size_t t = begin; t < end; t++)
    for (unsigned e = 0; e < VALUES; e++, C++) {
      *C = -1;
      for (unsigned a = 0; a < 4; a++, dC++)
        for (unsigned p = 0; p < 3; p++) {
          double q = x[3 * member[4 * t + a] + p], b = coefficient(e, a, p);
          *C += b * q + bend * q * q / 2;
          (*dC)[p] = b + bend * q;
        }
    }
}

typedef struct scene {
  fake_system *f;
  hk_element_list list;
  hk_model model;
  hk_element_edges pins;
  hk_xpbd_elements elements;
  double w[N], stiffness[1], damping[1], x[N][HK_XPBD_LANES], v[N][HK_XPBD_LANES], v0[N][3];
  uint8_t pin[N];
  uint32_t slide[N];
  double S[1][9];
} scene;

static void open_scene(scene *s, size_t tuples, bool by_colour) {
  memset(s, 0, sizeof *s);
  s->f = fake_system_create(&(fake_problem){.n = N});
  s->stiffness[0] = k;
  s->damping[0] = c;
  s->list.elements = (hk_elements){.node = {tuples, 4, member},
                                   .values = VALUES,
                                   .stiffness = {1, s->stiffness},
                                   .damping = {1, s->damping},
                                   .evaluate = evaluate};
  s->list.acts = true;
  s->model = s->f->model;
  s->model.element_lists = 1;
  s->model.element_list = &s->list;
  s->f->system.model = &s->model;
  s->pins = (hk_element_edges){.n = N, .inverse_mass = s->w, .pin = s->pin, .slide = s->slide, .projector = s->S};
  for (size_t i = 0; i < N; i++) {
    s->w[i] = 1 / (1 + 0.2 * (double)i);
    s->slide[i] = HK_NO_SLIDE;
    for (size_t p = 0; p < 3; p++) {
      s->x[i][p] = sin(2.0 + 5.0 * (double)i + 2.3 * (double)p);
      s->v[i][p] = s->v0[i][p] = cos(4.0 * (double)i + 1.1 * (double)p);
    }
  }
  assert_int_equal(hk_xpbd_elements_take(&s->elements, &s->f->system, true, by_colour), HK_OK);
}

static void close_scene(scene *s) { fake_system_destroy(s->f); }

static double sweep(scene *s, bool last) {
  const hk_xpbd_substep substep = {&s->f->host, &s->pins, s->x, s->v, h};
  return hk_xpbd_elements_sweep(&s->elements, &substep, false, last);
}

/* The largest component of M (v - v0) + h k G^T C + h c G^T G v at x + h v, of what may move, over that of h k G^T C.
 */
static double residual(const scene *s, double *power) {
  double x[N][3], r[N][3] = {{0}}, off = 0, size = 0;
  *power = 0;
  for (size_t i = 0; i < N; i++)
    for (size_t p = 0; p < 3; p++) x[i][p] = s->x[i][p] + h * s->v[i][p];
  for (size_t t = 0; t < s->list.elements.node.count; t++) {
    double C[VALUES], G[4 * VALUES][3];
    evaluate(NULL, &x[0][0], t, t + 1, C, G);
    for (unsigned e = 0; e < VALUES; e++) {
      double u = 0;
      for (unsigned a = 0; a < 4; a++)
        for (size_t p = 0; p < 3; p++) u += G[4 * e + a][p] * s->v[member[4 * t + a]][p];
      *power += c * u * u;
      for (unsigned a = 0; a < 4; a++)
        for (size_t p = 0; p < 3; p++) r[member[4 * t + a]][p] += h * (k * C[e] + c * u) * G[4 * e + a][p];
    }
  }
  for (size_t i = 0; i < N; i++) {
    double f[3], moved[3];
    for (size_t p = 0; p < 3; p++) f[p] = r[i][p], moved[p] = s->v[i][p] - s->v0[i][p];
    for (size_t p = 0; p < 3; p++) {
      double allowed = f[p];
      if (s->slide[i] != HK_NO_SLIDE)
        allowed = s->S[0][3 * p] * f[0] + s->S[0][3 * p + 1] * f[1] + s->S[0][3 * p + 2] * f[2];
      off = fmax(off, fabs(s->w[i] > 0 ? moved[p] / s->w[i] + allowed : moved[p]));
      size = fmax(size, fabs(f[p]));
    }
  }
  return off / size;
}

static void one_tuple_with_several_linear_numbers_is_solved_by_one_sweep(void **state) {
  (void)state;
  scene s;
  double power;
  bend = 0;
  open_scene(&s, 1, false);
  hk_xpbd_elements_start(&s.elements);
  assert_true(residual(&s, &power) > 0.1);
  double work = sweep(&s, true);
  assert_true(residual(&s, &power) < 1e-14); /* rounding of sums over 12 coordinates */
  assert_true(fabs(work + h * power) < 1e-14 * power);
  close_scene(&s);
}

static void the_limit_of_many_sweeps_is_backward_euler_though_gradients_turn(void **state) {
  (void)state;
  for (int by_colour = 0; by_colour < 2; by_colour++) {
    scene s;
    double power;
    bend = 0.5;
    open_scene(&s, 2, by_colour);
    hk_xpbd_elements_start(&s.elements);
    for (int q = 0; q < SWEEPS; q++) sweep(&s, q + 1 == SWEEPS);
    assert_true(residual(&s, &power) < 1e-12); /* rounding, which every sweep makes anew */
    close_scene(&s);
  }
}

/* A fixed, a sliding and a path-driven particle: the residual holds along what pins allow, and the path's work is the
 * force against it times its way. */
static void pins_take_the_impulses_they_should(void **state) {
  (void)state;
  static const double line[3] = {0.6, 0, 0.8};
  scene s;
  double power, G[4 * VALUES][3], C[VALUES], x[N][3], on_path = 0;
  bend = 0.3;
  open_scene(&s, 1, false);
  s.w[0] = s.w[1] = 0;
  s.pin[0] = HK_PIN_FIXED;
  s.pin[1] = HK_PIN_PATH;
  s.pin[2] = HK_PIN_LINE;
  s.slide[2] = 0;
  for (int q = 0; q < 9; q++) s.S[0][q] = line[q / 3] * line[q % 3];
  for (int p = 0; p < 3; p++) s.v[0][p] = s.v0[0][p] = 0, s.v[2][p] = s.v0[2][p] = 0.4 * line[p];
  hk_xpbd_elements_start(&s.elements);
  double work = 0;
  for (int q = 0; q < SWEEPS; q++) work += sweep(&s, q + 1 == SWEEPS);
  assert_true(residual(&s, &power) < 1e-12);
  assert_true(fabs(s.v[2][0] * line[2] - s.v[2][2] * line[0]) < 1e-14 && s.v[2][1] == 0);
  for (size_t i = 0; i < N; i++)
    for (size_t p = 0; p < 3; p++) x[i][p] = s.x[i][p] + h * s.v[i][p];
  evaluate(NULL, &x[0][0], 0, 1, C, G);
  for (unsigned e = 0; e < VALUES; e++) {
    double u = 0, along = 0;
    for (unsigned a = 0; a < 4; a++)
      for (size_t p = 0; p < 3; p++) u += G[4 * e + a][p] * s.v[member[a]][p];
    for (size_t p = 0; p < 3; p++) along += G[4 * e + 1][p] * s.v[1][p];
    on_path += h * (k * C[e] + c * u) * along;
  }
  assert_true(fabs(work - (on_path - h * power)) < 1e-12 * (fabs(on_path) + h * power));
  close_scene(&s);
}

/* Tuples that share particles have different colours, others the same. */
static void colours_keep_neighbours_apart(void **state) {
  (void)state;
  scene s;
  open_scene(&s, 2, true);
  assert_int_equal(s.elements.colours, 2);
  close_scene(&s);
  open_scene(&s, 1, true);
  assert_int_equal(s.elements.colours, 1);
  close_scene(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(one_tuple_with_several_linear_numbers_is_solved_by_one_sweep),
      cmocka_unit_test(the_limit_of_many_sweeps_is_backward_euler_though_gradients_turn),
      cmocka_unit_test(pins_take_the_impulses_they_should),
      cmocka_unit_test(colours_keep_neighbours_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
