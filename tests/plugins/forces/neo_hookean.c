/* The force on a block of tetrahedra against its energy and differences of itself, with viscosity, at random, flat and
 * inverted states; momenta; patch tests; what cannot be a solid; no memory. */
#include "core/engine/contract/contract.h"
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { CELLS = 8, N = 27, SIZE = 3 * N, TETRAHEDRA = 5 * CELLS };

static uint64_t bits = 1;

/* -1 to 1. */
static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

/* Five tetrahedra fill a cube; those of neighbours are mirror images, so that the diagonals of their faces meet. */
static void fill(uint32_t ids[TETRAHEDRA][4]) {
  static const int CORNERS[5][4] = {{0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
  for (uint32_t cell = 0; cell < CELLS; cell++) {
    uint32_t at[3] = {cell & 1, cell >> 1 & 1, cell >> 2};
    bool other = (at[0] + at[1] + at[2]) % 2;
    for (int t = 0; t < 5; t++)
      for (int m = 0; m < 4; m++) {
        int corner = CORNERS[t][other && m < 2 ? 1 - m : m] ^ (other ? 1 : 0);
        uint32_t i = at[0] + (corner & 1), j = at[1] + (corner >> 1 & 1), k = at[2] + (uint32_t)(corner >> 2);
        ids[5 * cell + (uint32_t)t][m] = 1 + i + 3 * (j + 3 * k);
      }
  }
}

/* A cube of side 1 whose inner corner is off the middle. */
static hk_plugin_spec *add_block(test_engine *e) {
  uint32_t ids[TETRAHEDRA][4];
  test_engine_open(e);
  for (int i = 0; i < N; i++) {
    double off = i == 13 ? 0.1 : 0;
    test_particle(e, i % 3 * 0.5 + off, i / 3 % 3 * 0.5 - off, i / 9 * 0.5 + off / 2, 1 + 0.1 * i);
  }
  fill(ids);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "neo_hookean");
  test_tuples(e, spec, "tetrahedra", 4, ids[0], TETRAHEDRA);
  test_number(e, spec, "E", 2);
  e->options.dt = 1e-3;
  return spec;
}

typedef struct block {
  test_engine e;
  hk_instance *solid;
  hk_view view;
  double x[SIZE], v[SIZE];
} block;

static void open_block(block *b, double nu, double damping) {
  hk_plugin_spec *spec = add_block(&b->e);
  test_number(&b->e, spec, "nu", nu);
  test_number(&b->e, spec, "damping", damping);
  test_run(&b->e);
  b->solid = test_instance(&b->e, spec);
  b->view = force_view(&b->e, b->solid);
  memcpy(b->x, b->view.x, sizeof b->x);
  b->view.x = b->x, b->view.v = b->v;
  for (int k = 0; k < SIZE; k++) b->v[k] = noise();
}

/* Displaced by up to `size`; flat, and turned inside out. */
static void deform(block *b, int kind, double size) {
  for (int k = 0; k < SIZE; k++) {
    b->x[k] += size * noise();
    if (k % 3 == 2 && kind > 0) b->x[k] *= kind == 1 ? 0 : -1;
  }
}

static void derivatives_are_those_of_the_energy(void **state) {
  (void)state;
  static const double NU[] = {0, 0.3, 0.49};
  for (int kind = 0; kind < 3; kind++)
    for (int k = 0; k < 3; k++) {
      block b;
      open_block(&b, NU[k], 0);
      deform(&b, kind, 0.15);
      assert_true(force_gradient_error(b.solid, &b.view) < FORCE_DIFFERENCES);
      assert_true(force_stiffness_error(b.solid, &b.view) < FORCE_DIFFERENCES);
      test_engine_close(&b.e);
      open_block(&b, NU[k], 0.7);
      deform(&b, kind, 0.15);
      assert_true(force_stiffness_error(b.solid, &b.view) < FORCE_DIFFERENCES);
      assert_true(force_damping_error(b.solid, &b.view) < FORCE_DIFFERENCES);
      test_engine_close(&b.e);
    }
}

/* F of a deformation that is the same everywhere: inside there is no force, and on the faces what a stress P = dW/dF
 * makes, which for a small strain is Hooke's law. The stress is measured by the pull of the face x = 1. */
static void patches_have_the_stress_of_hookes_law(void **state) {
  (void)state;
  const double size = 1e-6, E = 2, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  for (int k = 0; k < 10; k++) {
    block b;
    double G[9], F[SIZE], pull[3] = {0};
    open_block(&b, nu, 0);
    for (int e = 0; e < 9; e++) G[e] = noise();
    const double *X = b.e.run ? test_position(&b.e, 1) : NULL;
    for (int i = 0; i < N; i++)
      for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++) b.x[3 * i + c] += size * G[3 * c + d] * X[3 * i + d];
    memset(b.v, 0, sizeof b.v);
    force_evaluate(b.solid, &b.view, F);
    for (int i = 0; i < N; i++)
      for (int c = 0; c < 3; c++) {
        if (i % 3 == 2) pull[c] -= F[3 * i + c];
        if (i == 13) assert_true(fabs(F[3 * i + c]) < 1e-15 * E); /* rounding of forces of about E */
      }
    for (int c = 0; c < 3; c++) {
      double stress = mu * (G[3 * c] + G[c]) + (c == 0 ? lambda * (G[0] + G[4] + G[8]) : 0);
      assert_true(fabs(pull[c] / size - stress) < 20 * size * E); /* terms of second order */
    }
    test_engine_close(&b.e);
  }
}

/* Viscosity: a turning solid loses nothing, and momenta stay. */
static void viscosity_leaves_turning_alone(void **state) {
  (void)state;
  block b;
  double F[SIZE], sum[3] = {0}, turning[3] = {0}, elastic[SIZE], most = 0;
  open_block(&b, 0.3, 5);
  deform(&b, 0, 0.2);
  double power = force_evaluate(b.solid, &b.view, F);
  assert_true(power < 0);
  for (size_t i = 0; i < N; i++)
    for (size_t c = 0; c < 3; c++) {
      sum[c] += F[3 * i + c];
      turning[c] +=
          b.x[3 * i + (c + 1) % 3] * F[3 * i + (c + 2) % 3] - b.x[3 * i + (c + 2) % 3] * F[3 * i + (c + 1) % 3];
      most = fmax(most, fabs(F[3 * i + c]));
    }
  for (int c = 0; c < 3; c++) assert_true(fabs(sum[c]) < 1e-13 * most && fabs(turning[c]) < 1e-13 * most);
  memset(b.v, 0, sizeof b.v);
  force_evaluate(b.solid, &b.view, elastic);
  for (size_t i = 0; i < N; i++) { /* v = w x x + u */
    const double w[3] = {3, -2, 1};
    for (size_t c = 0; c < 3; c++)
      b.v[3 * i + c] = w[(c + 1) % 3] * b.x[3 * i + (c + 2) % 3] - w[(c + 2) % 3] * b.x[3 * i + (c + 1) % 3] + 4;
  }
  power = force_evaluate(b.solid, &b.view, F);
  assert_true(fabs(power) < 1e-24); /* the square of a rate of rounding */
  for (int k = 0; k < SIZE; k++) assert_true(fabs(F[k] - elastic[k]) < 1e-13 * most);
  test_engine_close(&b.e);
}

/* No negative eigenvalue of the whole matrix: Cholesky's factorisation of K + 1e-12 of its size goes through. */
static bool is_definite(double *K) {
  double shift = 0;
  for (int k = 0; k < SIZE; k++) shift = fmax(shift, 1e-12 * K[SIZE * k + k]);
  for (int j = 0; j < SIZE; j++) {
    K[SIZE * j + j] += shift;
    for (int k = 0; k < j; k++) K[SIZE * j + j] -= K[SIZE * j + k] * K[SIZE * j + k];
    if (!(K[SIZE * j + j] > 0)) return false;
    K[SIZE * j + j] = sqrt(K[SIZE * j + j]);
    for (int i = j + 1; i < SIZE; i++) {
      for (int k = 0; k < j; k++) K[SIZE * i + j] -= K[SIZE * i + k] * K[SIZE * j + k];
      K[SIZE * i + j] /= K[SIZE * j + j];
    }
  }
  return true;
}

static size_t blocks_named;
static void count_block(hk_pattern *p, uint32_t row, uint32_t column) {
  (void)p, (void)row, (void)column;
  blocks_named++;
}

static void definite_blocks_are_definite(void **state) {
  (void)state;
  double *K = calloc(2 * SIZE * SIZE, sizeof *K), *part = calloc(2 * 9 * 16 * TETRAHEDRA, sizeof *part);
  size_t slot[16 * TETRAHEDRA];
  for (size_t k = 0; k < 16 * TETRAHEDRA; k++) slot[k] = k;
  for (int kind = 0; kind < 3; kind++) {
    block b;
    uint32_t ids[TETRAHEDRA][4];
    open_block(&b, 0.45, 0.7);
    deform(&b, kind, 0.3);
    fill(ids);
    memset(part, 0, 2 * 9 * 16 * TETRAHEDRA * sizeof *part);
    memset(K, 0, 2 * SIZE * SIZE * sizeof *K);
    hk_pattern counter = {count_block};
    blocks_named = 0;
    hk_force_of(b.solid->plugin)->implicit.pattern(b.solid->self, &b.view, &counter);
    assert_int_equal(blocks_named, 16 * TETRAHEDRA);
    const hk_blocks into = {.slot = slot, .K = part, .D = part + 9 * 16 * TETRAHEDRA, .want = HK_WANT_DEFINITE};
    assert_int_equal(hk_force_of(b.solid->plugin)->implicit.jacobian(b.solid->self, &b.view, &into), HK_OK);
    for (size_t k = 0; k < 16 * TETRAHEDRA; k++)
      for (size_t e = 0; e < 9; e++) {
        size_t row = 3 * (ids[k / 16][k % 16 / 4] - 1) + e / 3, column = 3 * (ids[k / 16][k % 4] - 1) + e % 3;
        K[SIZE * row + column] += part[9 * k + e];
        K[SIZE * SIZE + SIZE * row + column] += into.D[9 * k + e];
      }
    assert_true(is_definite(K));
    assert_true(is_definite(K + SIZE * SIZE));
    test_engine_close(&b.e);
  }
  free(K), free(part);
}

/* ---- element by element ------------------------------------------------------------------------------------------ */

/* A block held at one corner falls and swings; its particles after 20 steps of 10 ms. */
static void fall(const char *method, const char *parameter, double value, double damping, double x[SIZE]) {
  test_engine e;
  hk_plugin_spec *solid = add_block(&e);
  test_number(&e, solid, "E", 2000);
  test_number(&e, solid, "damping", damping);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -10);
  test_pin(&e, HK_PIN_FIXED, 27, NULL);
  hk_plugin_spec *spec = test_plugin(&e, HK_INTEGRATOR, method);
  if (strcmp(method, "xpbd") == 0) test_number(&e, spec, "substeps", 1);
  test_number(&e, spec, parameter, value);
  if (strcmp(method, "local_global") == 0) test_number(&e, spec, "iterations", 1e6);
  e.options.dt = 0.01, e.scene->fps = 100;
  test_run(&e);
  test_advance(&e, 0.2);
  for (uint32_t i = 0; i < N; i++) memcpy(x + 3 * i, test_position(&e, i + 1), 3 * sizeof *x);
  test_engine_close(&e);
}

static double distance(const double *x, const double *y) {
  double off = 0;
  for (int k = 0; k < SIZE; k++) off = fmax(off, fabs(x[k] - y[k]));
  return off;
}

/* Methods that know the elements alone, iterated to their end, are backward Euler: the elements are the force. One of
 * them damps along the gradients of a step's start, and is tried without damping. */
static void elements_are_the_force(void **state) {
  (void)state;
  double x[SIZE], y[SIZE];
  fall("backward_euler", "tolerance", 1e-12, 20, x);
  fall("xpbd", "iterations", 300, 20, y);
  assert_true(distance(x, y) < 1e-11); /* of 0.2 m, after 20 steps to a tolerance of 1e-12 */
  fall("backward_euler", "tolerance", 1e-12, 0, x);
  fall("local_global", "tolerance", 1e-10, 0, y);
  assert_true(distance(x, y) < 1e-8); /* after 20 steps to a tolerance of 1e-10 each, which is of the last iteration */
}

/* ---- what is refused --------------------------------------------------------------------------------------------- */

static void refused(const uint32_t ids[4], double lift, double nu, const char *why) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1);
  test_particle(&e, 0, 1, 0, 1), test_particle(&e, 0.2, 0.3, lift, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "neo_hookean");
  test_tuples(&e, spec, "tetrahedra", 4, ids, 1);
  test_number(&e, spec, "E", 1);
  test_number(&e, spec, "nu", nu);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, why));
  test_engine_close(&e);
}

static void what_is_no_solid_is_refused(void **state) {
  (void)state;
  const uint32_t right[] = {1, 2, 3, 4}, wrong[] = {1, 3, 2, 4};
  refused(wrong, 1, 0.3, "the tetrahedron {1, 3, 2, 4} is inside out at the start");
  refused(right, 0, 0.3, "the tetrahedron {1, 2, 3, 4} has no volume");
  refused(right, 1e-13, 0.3, "has no volume");
  refused(right, 1, 0.5, "take 0.49");
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    add_block(&e);
    e.options.allocations = k + 1;
    hk_status status = hk_run_open(e.scene, &e.options, &e.run, &e.error);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 10);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(derivatives_are_those_of_the_energy),
      cmocka_unit_test(patches_have_the_stress_of_hookes_law),
      cmocka_unit_test(viscosity_leaves_turning_alone),
      cmocka_unit_test(definite_blocks_are_definite),
      cmocka_unit_test(elements_are_the_force),
      cmocka_unit_test(what_is_no_solid_is_refused),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
