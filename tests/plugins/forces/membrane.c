/* Membranes by hand, against their energy and differences of themselves, by closed forms of tension and shear, under
 * refinement; triangles without area; what is no membrane; deaths; no memory. */
#include "plugins/common/membranes/membrane.h"
#include "tests/support/force_check.h"
#include "tests/support/sheets.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_status open_run(test_engine *e) { return hk_run_open(e->scene, &e->options, &e->run, &e->error); }

/* A material of each energy: orthotropic where there is such a one. */
typedef struct material {
  const char *model;
  double stiffness, weft, shear, nu, damping; /* weft, shear 0: not given */
} material;

static const material MATERIAL[] = {
    {"baraff_witkin", 3, 1.5, 0.4, 0, 0.2}, {"stvk", 3, 1.5, 0.4, 0.35, 0.2}, {"stvk", 2, 0, 0, 0.25, 0},
    {"neo_hookean", 3, 0, 0, 0.5, 0.2},     {"neo_hookean", 3, 0, 0, 0.3, 0}, {"neo_hookean", 3, 0, 0, 0, 0.1}};
enum { MATERIALS = sizeof MATERIAL / sizeof *MATERIAL };

static void set(test_engine *e, hk_plugin_spec *spec, const material *m) {
  test_text(e, spec, "model", m->model);
  test_number(e, spec, "stiffness", m->stiffness);
  if (m->weft > 0) test_number(e, spec, "weft", m->weft);
  if (m->shear > 0) test_number(e, spec, "shear", m->shear);
  test_number(e, spec, "nu", m->nu);
  test_number(e, spec, "damping", m->damping);
}

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 9007199254740992.0 - 0.5;
}

/* A flat sheet at rest that is crumpled and moves. */
typedef struct crumpled {
  test_engine e;
  sheet s;
  hk_instance *force;
  hk_view view;
  double *x, *v;
} crumpled;

static crumpled *crumple(const material *m, size_t cells, double rough) {
  crumpled *c = calloc(1, sizeof *c);
  uint64_t seed = 5;
  c->s = sheet_make(SHEET_IRREGULAR, cells, (double[]){0, 0, 0});
  test_engine_open(&c->e);
  hk_plugin_spec *spec = sheet_add(&c->e, &c->s, "membrane");
  set(&c->e, spec, m);
  test_vector(&c->e, spec, "warp", 1, 0.4, 0.2);
  test_run(&c->e);
  c->force = test_instance(&c->e, spec);
  c->view = force_view(&c->e, c->force);
  size_t size = 3 * c->s.particles;
  c->x = malloc(size * sizeof *c->x), c->v = malloc(size * sizeof *c->v);
  for (size_t k = 0; k < size; k++) {
    c->x[k] = c->view.x[k] * (1 + 0.1 * (double)(k % 3)) + rough / (double)cells * noise(&seed);
    c->v[k] = noise(&seed);
  }
  c->view.x = c->x, c->view.v = c->v;
  return c;
}

static void smooth_out(crumpled *c) {
  free(c->x);
  free(c->v);
  sheet_free(&c->s);
  test_engine_close(&c->e);
  free(c);
}

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
    c->force->plugin->force->elements(c->force->self, &c->view, &list);
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
    hk_membrane_forces(c->force->self, &c->view, F);
    hk_membrane_forces_narrow(c->force->self, &c->view, G);
    assert_memory_equal(F, G, size * sizeof *F);
    free(F);
    smooth_out(c);
  }
}

/* ---- The sheet --------------------------------------------------------------------------------------------------- */

/* Positions x -> A x of a flat sheet, and there the energy per area, and the largest force on a particle inside. */
static void deform(sheet_kind kind, size_t cells, const material *m, const double A[3][2], double *energy,
                   double *inside) {
  test_engine e;
  sheet s = sheet_make(kind, cells, (double[]){0, 0, 0});
  test_engine_open(&e);
  hk_plugin_spec *spec = sheet_add(&e, &s, "membrane");
  set(&e, spec, m);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  double *x = malloc(6 * s.particles * sizeof *x), *F = x + 3 * s.particles;
  for (size_t k = 0; k < 3 * s.particles; k++) x[k] = A[k % 3][0] * s.x[k / 3][0] + A[k % 3][1] * s.x[k / 3][1];
  view.x = x;
  *energy = force->plugin->force->energy(force->self, &view) / s.area;
  force_evaluate(force, &view, F);
  *inside = 0;
  for (size_t i = 0; i < s.particles; i++) {
    size_t column = i % (cells + 1), row = i / (cells + 1);
    bool inner = column > 0 && row > 0 && column < cells && row < cells;
    for (size_t c = 0; c < 3 && inner; c++) *inside = fmax(*inside, fabs(F[3 * i + c]));
  }
  free(x);
  sheet_free(&s);
  test_engine_close(&e);
}

/* Any mesh has the energy of the sheet under any even deformation, and no force inside. */
static void refinement_changes_nothing(void **state) {
  (void)state;
  const double A[3][2] = {{1.2, 0.1}, {-0.2, 0.9}, {0.3, 0.5}};
  static const sheet_kind kind[] = {SHEET_ONE_WAY, SHEET_ALTERNATING, SHEET_IRREGULAR};
  for (int k = 0; k < MATERIALS; k++) {
    double first, inside;
    deform(SHEET_ONE_WAY, 1, &MATERIAL[k], A, &first, &inside);
    assert_true(first > 0.01);
    for (int m = 0; m < 3; m++)
      for (size_t cells = 2; cells <= 16; cells *= 2) {
        double energy;
        deform(kind[m], cells, &MATERIAL[k], A, &energy, &inside);
        assert_true(fabs(energy - first) < 1e-13 * first); /* rounding of the sum of up to 512 triangles */
        assert_true(inside < 1e-14 * 10);
      }
  }
}

/* dE/dr at the width r of a unit square pulled to the length s. */
static double side_force(const material *m, double s, double r) {
  double up, down, inside, h = 1e-5;
  deform(SHEET_ALTERNATING, 2, m, (const double[3][2]){{s, 0}, {0, r + h}, {0, 0}}, &up, &inside);
  deform(SHEET_ALTERNATING, 2, m, (const double[3][2]){{s, 0}, {0, r - h}, {0, 0}}, &down, &inside);
  return (up - down) / (2 * h);
}

/* stvk: e_v = -nu e_u; neo_hookean: r = s^-nu for any s. Differences leave 1e-10 or so. */
static void a_strip_narrows_by_poissons_ratio(void **state) {
  (void)state;
  for (double s = 0.7; s < 2.1; s += 0.3) {
    for (int k = 1; k < MATERIALS; k++) {
      const material *m = &MATERIAL[k];
      double green = 1 - m->nu * (s * s - 1), r = strcmp(m->model, "stvk") == 0 ? sqrt(green) : pow(s, -m->nu);
      if (!(green > 0.04)) continue; /* stvk: it would have no width */
      assert_true(fabs(side_force(m, s, r)) < 1e-8);
    }
  }
}

/* E = Y/2 e^2 at the free width, and G/2 g^2 under a small shear, per area; errors are of order e. */
static void small_strains_have_the_moduli_asked_for(void **state) {
  (void)state;
  const double e = 1e-6;
  for (int k = 0; k < MATERIALS; k++) {
    const material *m = &MATERIAL[k];
    double pulled, sheared, across, inside, Yv = m->weft > 0 ? m->weft : m->stiffness;
    double G = m->shear > 0 ? m->shear : m->stiffness / (2 * (1 + m->nu));
    deform(SHEET_IRREGULAR, 4, m, (const double[3][2]){{1 + e, 0}, {0, 1 - m->nu * e}, {0, 0}}, &pulled, &inside);
    deform(SHEET_IRREGULAR, 4, m, (const double[3][2]){{1, e}, {0, 1}, {0, 0}}, &sheared, &inside);
    double narrow = m->nu * Yv / m->stiffness;
    deform(SHEET_IRREGULAR, 4, m, (const double[3][2]){{1 - narrow * e, 0}, {0, 1 + e}, {0, 0}}, &across, &inside);
    assert_true(fabs(pulled / (m->stiffness / 2 * e * e) - 1) < 1e-3); /* eps/e^2: the rounding of W, |f| - 1 */
    assert_true(fabs(across / (Yv / 2 * e * e) - 1) < 1e-3);
    assert_true(fabs(sheared / (G / 2 * e * e) - 1) < 1e-3);
  }
}

/* The warp along y of one sheet, or the pattern turned by 90 degrees, is the sheet whose warp is its weft. */
static void the_warp_has_the_direction_given(void **state) {
  (void)state;
  material m = MATERIAL[1], turned = {"stvk", m.weft, m.stiffness, m.shear, m.nu * m.weft / m.stiffness, 0};
  double expected, inside;
  deform(SHEET_ONE_WAY, 1, &turned, (const double[3][2]){{1.3, 0}, {0.1, 0.9}, {0, 0}}, &expected, &inside);
  for (int by_pattern = 0; by_pattern < 2; by_pattern++) {
    test_engine e;
    sheet s = sheet_make(SHEET_ONE_WAY, 1, (double[]){0, 0, 0});
    test_engine_open(&e);
    hk_plugin_spec *spec = sheet_add(&e, &s, "membrane");
    set(&e, spec, &m);
    double uv[12], x[12];
    for (int c = 0; c < 6; c++) uv[2 * c] = s.x[s.corner[c] - 1][1], uv[2 * c + 1] = -s.x[s.corner[c] - 1][0];
    if (by_pattern)
      test_list(&e, spec, "uv", uv, 12);
    else
      test_vector(&e, spec, "warp", 0, 1, 0);
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    for (int k = 0; k < 4; k++)
      x[3 * k] = 1.3 * s.x[k][0], x[3 * k + 1] = 0.1 * s.x[k][0] + 0.9 * s.x[k][1], x[3 * k + 2] = 0;
    view.x = x;
    assert_true(fabs(force->plugin->force->energy(force->self, &view) - expected) < 1e-14);
    sheet_free(&s);
    test_engine_close(&e);
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

/* ---- Methods, deaths, memory ------------------------------------------------------------------------------------- */

static void fall(const char *method, const material *m, double *x) {
  test_engine e;
  sheet s = sheet_make(SHEET_IRREGULAR, 3, (double[]){0, 0, 0});
  test_engine_open(&e);
  material still = *m;
  still.damping = 0;
  set(&e, sheet_add(&e, &s, "membrane"), &still);
  for (uint32_t id = 1; id < 5; id++) test_pin(&e, HK_PIN_FIXED, id, NULL);
  test_plugin(&e, HK_FORCE, "gravity");
  hk_plugin_spec *integrator = test_plugin(&e, HK_INTEGRATOR, method);
  if (strcmp(method, "local_global") == 0) {
    test_number(&e, integrator, "iterations", 2000);
    test_number(&e, integrator, "tolerance", 1e-10);
  }
  e.options.dt = 1e-3;
  e.scene->duration = 0.05;
  test_run(&e);
  test_advance(&e, 0.05);
  for (uint32_t i = 0; i < s.particles; i++) memcpy(x + 3 * i, test_position(&e, i + 1), 3 * sizeof *x);
  sheet_free(&s);
  test_engine_close(&e);
}

/* local_global, iterated to the end, is backward Euler: it has force, gradient and weight of every triangle from the
 * elements. Both end their iterations at 1e-10 of what a step moves. */
static void elements_are_the_force(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    double x[48], y[48], off = 0;
    fall("backward_euler", &MATERIAL[k], x);
    fall("local_global", &MATERIAL[k], y);
    for (int c = 0; c < 48; c++) off = fmax(off, fabs(x[c] - y[c]));
    assert_true(off < 1e-8); /* of 1 cm and more */
  }
}

/* Blocks of several chunks, of triangles and of hinges: a crumpled sheet moves for some implicit steps. */
static void move(int threads, double *x) {
  test_engine e;
  uint64_t seed = 3;
  sheet s = sheet_make(SHEET_IRREGULAR, 20, (double[]){0, 0, 0});
  test_engine_open(&e);
  set(&e, sheet_add(&e, &s, "membrane"), &MATERIAL[1]);
  hk_plugin_spec *hinges = test_plugin(&e, HK_FORCE, "hinges");
  test_tuples(&e, hinges, "triangles", 3, s.corner, s.triangles);
  test_number(&e, hinges, "rigidity", 1e-3);
  for (size_t k = 0; k < 3 * s.particles; k++) e.scene->velocity[k] = noise(&seed);
  test_plugin(&e, HK_INTEGRATOR, "backward_euler");
  e.options.dt = 1e-2;
  e.options.threads = threads;
  e.scene->duration = 0.03;
  test_run(&e);
  test_advance(&e, 0.03);
  for (uint32_t i = 0; i < s.particles; i++) memcpy(x + 3 * i, test_position(&e, i + 1), 3 * sizeof *x);
  sheet_free(&s);
  test_engine_close(&e);
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  static double one[3 * 441], three[3 * 441];
  move(1, one);
  move(3, three);
  assert_memory_equal(one, three, sizeof one);
}

/* The triangles that are left keep the shapes of the start. */
static void triangles_follow_deaths(void **state) {
  (void)state;
  crumpled *c = crumple(&MATERIAL[1], 3, 0.5);
  size_t n = c->s.particles;
  uint32_t map[16], id[15];
  double F[48], G[48];
  for (uint32_t i = 0; i < n; i++) map[i] = i == 0 ? UINT32_MAX : i - 1;
  force_evaluate(c->force, &c->view, F);
  memmove(c->x, c->x + 3, 45 * sizeof *c->x), memmove(c->v, c->v + 3, 45 * sizeof *c->v);
  hk_model model = *c->view.model;
  for (uint32_t i = 0; i < 15; i++) id[i] = i + 2;
  model.id = id, model.n = c->view.n = c->view.acting = n - 1, c->view.model = &model;
  assert_int_equal(hk_instance_remap(c->force, map, n, &c->view, 6 * n - 5, &c->e.error), HK_OK);
  force_evaluate(c->force, &c->view, G);
  for (size_t k = 3 * 6; k < 3 * n; k++) assert_true(F[k] == G[k - 3]); /* in no triangle with the dead one */
  smooth_out(c);
}

static void no_memory_is_an_error(void **state) {
  (void)state;
  for (long k = 0, failures = 0;; k++, failures++) {
    test_engine e;
    sheet s = sheet_make(SHEET_ONE_WAY, 2, (double[]){0, 0, 0});
    test_engine_open(&e);
    set(&e, sheet_add(&e, &s, "membrane"), &MATERIAL[0]);
    e.options.allocations = k + 1;
    hk_status status = open_run(&e);
    sheet_free(&s);
    test_engine_close(&e);
    if (status == HK_OK) {
      assert_true(failures >= 8);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_triangle_by_hand),
      cmocka_unit_test(force_and_jacobian_are_derivatives),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(the_kernel_is_the_elements_to_rounding),
      cmocka_unit_test(every_processor_has_the_same_bits),
      cmocka_unit_test(refinement_changes_nothing),
      cmocka_unit_test(a_strip_narrows_by_poissons_ratio),
      cmocka_unit_test(small_strains_have_the_moduli_asked_for),
      cmocka_unit_test(the_warp_has_the_direction_given),
      cmocka_unit_test(triangles_without_area_have_finite_forces),
      cmocka_unit_test(what_is_no_membrane_is_named),
      cmocka_unit_test(elements_are_the_force),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(triangles_follow_deaths),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
