/* Sheets of membranes: by closed forms of tension and shear, under refinement, in runs; threads; deaths; no memory. */
#include "tests/plugins/forces/membranes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_status open_run(test_engine *e) { return hk_run_open(e->scene, &e->options, &e->run, &e->error); }

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
  for (size_t k = 0; k < 3 * s.particles; k++) e.scene->particles.velocity[k] = noise(&seed);
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
      cmocka_unit_test(refinement_changes_nothing),
      cmocka_unit_test(a_strip_narrows_by_poissons_ratio),
      cmocka_unit_test(small_strains_have_the_moduli_asked_for),
      cmocka_unit_test(the_warp_has_the_direction_given),
      cmocka_unit_test(elements_are_the_force),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(triangles_follow_deaths),
      cmocka_unit_test(no_memory_is_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
