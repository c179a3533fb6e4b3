/* Membranes by hand, against their energy and differences of themselves, against their elements; triangles without
 * area; what is no membrane. */
#include "core/engine/contract/contract.h"
#include "plugins/common/membranes/membrane.h"
#include "tests/plugins/forces/membranes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_status open_run(test_engine *e) { return hk_run_open(e->scene, &e->options, &e->run, &e->error); }

/* ---- One triangle ------------------------------------------------------------------------------------------------ */

/* Corners (0,0), (2,0), (0,1) at rest, deformed to f_u = (1.5, 0, 0), f_v = (0.6, 0, 0.8): |f_v| = 1, c = 0.9. */
static void a_triangle_by_hand(void **state) {
  (void)state;
  static const double x[9] = {0, 0, 0, 3, 0, 0, 0.6, 0, 0.8};
  const double area = 1, u = 3, v = 1.5, w = 0.4, nu = 0.35, rest = 1 - nu * nu * v / u, eu = (1.5 * 1.5 - 1) / 2;
  const double expected[3] = {area * (u * 0.25 + w * 0.81) / 2, area * (u / rest * eu * eu + w * 0.81) / 2,
                              area * 3 / (2 * 1.5) / 2 * (2.25 + 1 - 2 + 1 / (2.25 - 0.81) - 1)};
  const int of[3] = {0, 1, 3};
  for (int k = 0; k < 3; k++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1), test_particle(&e, 2, 0, 0, 1), test_particle(&e, 0, 1, 0, 1);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "membrane");
    test_tuples(&e, spec, "triangles", 3, (uint32_t[]){1, 2, 3}, 1);
    set(&e, spec, &MATERIAL[of[k]]);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double F[9];
    force_evaluate(force, &view, F);
    for (int c = 0; c < 9; c++) assert_true(F[c] == 0); /* at rest, to the last bit */
    view.x = x;
    assert_true(fabs(force->plugin->force->energy(force->self, &view) - expected[k]) < 1e-15 * 4);
    if (k == 0) { /* S_uu = u (1 - 1/1.5) = 1, S_uv = 0.36, S_vv = 0; f_1 = -(S_uu f_u + S_uv f_v)/2 */
      force_evaluate(force, &view, F);
      const double f1[3] = {-(1.5 + 0.36 * 0.6) / 2, 0, -0.36 * 0.8 / 2}, f2[3] = {-0.36 * 1.5, 0, 0};
      for (int c = 0; c < 3; c++) assert_true(fabs(F[3 + c] - f1[c]) < 4e-16 && fabs(F[6 + c] - f2[c]) < 4e-16);
    }
    test_engine_close(&e);
  }
}

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

static void force_and_jacobian_are_derivatives(void **state) {
  (void)state;
  for (int k = 0; k < MATERIALS; k++) {
    crumpled *c = crumple(&MATERIAL[k], 3, 0.6);
    hk_view resting = c->view;
    double *still = calloc(3 * c->s.particles, sizeof *still);
    resting.v = still;
    assert_true(force_gradient_error(c->force, &resting) < FORCE_DIFFERENCES);
    assert_true(force_stiffness_error(c->force, &c->view) < FORCE_DIFFERENCES);
    assert_true(force_damping_error(c->force, &c->view) < FORCE_DIFFERENCES);
    free(still);
    smooth_out(c);
  }
}

/* Forces of some N at arms of 1 m sum to nothing but their rounding. */
static void momentum_is_kept(void **state) {
  (void)state;
  for (int k = 0; k < MATERIALS; k++) {
    crumpled *c = crumple(&MATERIAL[k], 8, 0.8);
    double *F = malloc(3 * c->s.particles * sizeof *F), sum[6] = {0}, whole = 0;
    force_evaluate(c->force, &c->view, F);
    for (size_t i = 0; i < c->s.particles; i++)
      for (size_t r = 0, d = 1, g = 2; r < 3; r++, d = (d + 1) % 3, g = (g + 1) % 3) {
        sum[r] += F[3 * i + r];
        sum[3 + r] += c->x[3 * i + d] * F[3 * i + g] - c->x[3 * i + g] * F[3 * i + d];
        whole += fabs(F[3 * i + r]);
      }
    for (int r = 0; r < 6; r++) assert_true(fabs(sum[r]) < 1e-14 * whole);
    free(F);
    smooth_out(c);
  }
}

/* ---- Against the elements, and on other processors --------------------------------------------------------------- */

/* The forces of 1/2 c11 sum C^2 with damping, one triangle after the other: the plain version of the kernel. */
static void plain_forces(const hk_elements *a, const hk_view *view, double *F) {
  memset(F, 0, 3 * view->n * sizeof *F);
  for (size_t k = 0; k < a->node.count; k++) {
    const uint32_t *corner = hk_tuple(&a->node, k);
    double C[3], dC[9][3];
    a->evaluate(a->self, view->x, k, k + 1, C, dC);
    for (int q = 0; q < 3; q++) {
      double rate = 0;
      for (int m = 0; m < 3; m++)
        for (int r = 0; r < 3; r++) rate += dC[3 * q + m][r] * view->v[3 * corner[m] + (size_t)r];
      double z = hk_tuple_value(&a->stiffness, k) * C[q] + hk_tuple_value(&a->damping, k) * rate;
      for (int m = 0; m < 3; m++)
        for (int r = 0; r < 3; r++) F[3 * corner[m] + (size_t)r] -= z * dC[3 * q + m][r];
    }
  }
}

static void the_kernel_is_the_elements_to_rounding(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    crumpled *c = crumple(&MATERIAL[k], 13, 0.8); /* blocks that are not full */
    size_t size = 3 * c->s.particles;
    double *F = malloc(2 * size * sizeof *F), *G = F + size;
    hk_elements list;
    hk_force_of(c->force->plugin)->elements.list(c->force->self, &c->view, &list);
    assert_int_equal(list.values, 3);
    force_evaluate(c->force, &c->view, F);
    plain_forces(&list, &c->view, G);
    for (size_t r = 0; r < size; r++) assert_true(fabs(F[r] - G[r]) < 1e-14 * 6); /* sums of forces of up to 1 N */
    free(F);
    smooth_out(c);
  }
}

static void every_processor_has_the_same_bits(void **state) {
  (void)state;
  for (int k = 0; k < MATERIALS; k++) {
    crumpled *c = crumple(&MATERIAL[k], 13, 0.8);
    size_t size = 3 * c->s.particles;
    double *F = calloc(2 * size, sizeof *F), *G = F + size;
    hk_membrane_forces(c->force->self, &c->view, HK_ALL_PARTS, F);
    for (int lanes = 2; lanes <= hk_processor_lanes(); lanes *= 2) {
      memset(G, 0, size * sizeof *G);
      c->force->host.lanes = lanes;
      hk_membrane_forces(c->force->self, &c->view, HK_ALL_PARTS, G);
      assert_memory_equal(F, G, size * sizeof *F);
    }
    free(F);
    smooth_out(c);
  }
}

/* ---- Triangles without area -------------------------------------------------------------------------------------- */

/* All corners in one point, in a line, two in one point, mirrored: forces are finite, and there the derivatives are
 * those of the energy where it has any. */
static void triangles_without_area_have_finite_forces(void **state) {
  (void)state;
  static const double flat[4][9] = {
      {0}, {0, 0, 0, 1, 0, 0, 2, 0, 0}, {0, 0, 0, 1, 0, 0, 1, 0, 0}, {0, 0, 0, -1, 0, 0, 0, 1, 0}};
  for (int k = 0; k < MATERIALS; k++) {
    test_engine e;
    test_engine_open(&e);
    test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0.2, 1, 0, 1);
    hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "membrane");
    test_tuples(&e, spec, "triangles", 3, (uint32_t[]){1, 2, 3}, 1);
    set(&e, spec, &MATERIAL[k]);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    for (int q = 0; q < 4; q++) {
      double F[9], K[81], D[81];
      view.x = flat[q];
      force_evaluate(force, &view, F);
      force_matrices(force, &view, K, D);
      for (int c = 0; c < 9; c++) assert_true(isfinite(F[c]));
      for (int c = 0; c < 81; c++) assert_true(isfinite(K[c]) && isfinite(D[c]));
      if (q == 1 || q == 3) {
        assert_true(force_gradient_error(force, &view) < 10 * FORCE_DIFFERENCES); /* W'' = 1e6 at t = 0 */
        assert_true(force_stiffness_error(force, &view) < 10 * FORCE_DIFFERENCES);
      }
    }
    test_engine_close(&e);
  }
}

/* ---- What is no membrane ----------------------------------------------------------------------------------------- */

typedef struct wrong {
  const char *text;
  const char *model;
  double weft, shear, nu, warp[3];
  const double *uv;
  size_t numbers;
  uint32_t corner[6];
} wrong;

static void refused(const wrong *w) {
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1), test_particle(&e, 1, 0, 0, 1), test_particle(&e, 0, 1, 0, 1),
      test_particle(&e, 3, 0, 0, 1);
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, "membrane");
  size_t count = w->corner[0] == 0 ? 0 : w->corner[3] == 0 ? 1 : 2;
  if (count) test_tuples(&e, spec, "triangles", 3, w->corner, count);
  test_text(&e, spec, "model", w->model);
  test_number(&e, spec, "stiffness", 2);
  if (w->weft > 0) test_number(&e, spec, "weft", w->weft);
  if (w->shear > 0) test_number(&e, spec, "shear", w->shear);
  test_number(&e, spec, "nu", w->nu);
  if (w->warp[2] != 0) test_vector(&e, spec, "warp", w->warp[0], w->warp[1], w->warp[2]);
  if (w->uv) test_list(&e, spec, "uv", w->uv, w->numbers);
  e.options.dt = 1e-3;
  assert_int_equal(open_run(&e), HK_BAD_PARAM);
  if (!strstr(e.error.text, w->text)) fail_msg("'%s' is not in: %s", w->text, e.error.text);
  test_engine_close(&e);
}

static void what_is_no_membrane_is_named(void **state) {
  (void)state;
  static const double folded[12] = {0, 0, 1, 0, 0, 1, 1, 0, 3, 0, 0, -1}, line[6] = {0, 0, 1, 0, 2, 0};
  static const wrong list[] = {
      {"there are no triangles", "stvk", 0, 0, 0, {0}, NULL, 0, {0}},
      {"triangle 2, of the particles 1, 2 and 4, has no area at the start",
       "stvk",
       0,
       0,
       0,
       {0},
       NULL,
       0,
       {1, 2, 3, 1, 2, 4}},
      {"nu: 0.3: the conditions of baraff_witkin have no Poisson's ratio",
       "baraff_witkin",
       0,
       0,
       0.3,
       {0},
       NULL,
       0,
       {1, 2, 3}},
      {"nu: 0.6: neo_hookean has 0 to 0.5", "neo_hookean", 0, 0, 0.6, {0}, NULL, 0, {1, 2, 3}},
      {"weft: neo_hookean is the same in all directions", "neo_hookean", 1, 0, 0, {0}, NULL, 0, {1, 2, 3}},
      {"shear: neo_hookean is the same in all directions", "neo_hookean", 0, 1, 0, {0}, NULL, 0, {1, 2, 3}},
      {"nu: 0.9 is too much for 2 N/m along the warp and 8 N/m along the weft: it has to be below the root of their "
       "ratio, 0.5",
       "stvk",
       8,
       0,
       0.9,
       {0},
       NULL,
       0,
       {1, 2, 3}},
      {"warp: {0, 0, 2} is across triangle 1, of the particles 1, 2 and 3",
       "stvk",
       0,
       0,
       0,
       {0, 0, 2},
       NULL,
       0,
       {1, 2, 3}},
      {"uv: 6 numbers for 2 triangles: give six", "stvk", 0, 0, 0, {0}, line, 6, {1, 2, 3, 2, 4, 3}},
      {"triangle 1, of the particles 1, 2 and 3, has no area in uv", "stvk", 0, 0, 0, {0}, line, 6, {1, 2, 3}},
      {"uv: triangle 2, of the particles 2, 4 and 3, is turned the other way",
       "stvk",
       0,
       0,
       0,
       {0},
       folded,
       12,
       {1, 2, 3, 2, 4, 3}},
  };
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) refused(&list[k]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_triangle_by_hand),
      cmocka_unit_test(force_and_jacobian_are_derivatives),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(the_kernel_is_the_elements_to_rounding),
      cmocka_unit_test(every_processor_has_the_same_bits),
      cmocka_unit_test(triangles_without_area_have_finite_forces),
      cmocka_unit_test(what_is_no_membrane_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
