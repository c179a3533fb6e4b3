/* Conduction against closed forms: a slab's series, the melting front of Stefan and the freezing one of Neumann, linear
 * temperatures on irregular meshes, the enthalpy to rounding, the stable step, and what is refused. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 129 };

static const double pi = 3.14159265358979323846;

typedef struct law {
  double solidus, liquidus, latent, capacity[2], conductivity[2];
} law;

static hk_plugin_spec *conduction(test_engine *e, const law *l) {
  static const char *const capacity[] = {"capacity", "capacity_liquid"}, *const conductivity[] = {
                                                                             "conductivity", "conductivity_liquid"};
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "conduction");
  test_text(e, spec, "channel", "enthalpy");
  if (!isnan(l->solidus)) test_number(e, spec, "solidus", l->solidus);
  if (!isnan(l->liquidus)) test_number(e, spec, "liquidus", l->liquidus);
  if (!isnan(l->latent)) test_number(e, spec, "latent", l->latent);
  for (int k = 0; k < 2; k++) {
    if (!isnan(l->capacity[k])) test_number(e, spec, capacity[k], l->capacity[k]);
    if (!isnan(l->conductivity[k])) test_number(e, spec, conductivity[k], l->conductivity[k]);
  }
  return spec;
}

static void add_channel(test_engine *e, const char *name, double initial) {
  assert_int_equal(hk_scene_add_channel(e->scene, name, 1, &initial, NAN, NULL, &e->error), HK_OK);
}

/* The start of the enthalpy, the first channel, of the particle with that id. */
static void set_enthalpy(test_engine *e, uint32_t id, double h) {
  assert_int_equal(hk_scene_set_channel(e->scene, "enthalpy", id, &h, 1, &e->error), HK_OK);
}

/* A bar of the length 1 m and the section 1 m^2, in `cells`; its left end is held. */
static hk_plugin_spec *bar(test_engine *e, const law *l, int cells, double initial, double left) {
  uint32_t edge[MOST][2];
  test_engine_open(e);
  add_channel(e, "enthalpy", initial);
  for (int i = 0; i <= cells; i++) {
    test_particle(e, (double)i / cells, 0, 0, (i == 0 || i == cells ? 0.5 : 1) / cells);
    edge[i][0] = (uint32_t)i + 1, edge[i][1] = (uint32_t)i + 2;
  }
  set_enthalpy(e, 1, left);
  hk_plugin_spec *spec = conduction(e, l);
  test_edges(e, spec, (const uint32_t(*)[2])edge, (size_t)cells);
  test_number(e, spec, "section", 1);
  test_list(e, spec, "held", (double[]){1}, 1);
  e->options.integrator = "euler";
  return spec;
}

static const double *enthalpies(test_engine *e) { return hk_run_view(e->run)->y; }

static const law plain = {NAN, NAN, NAN, {1, NAN}, {1, NAN}};

/* ---- without melting ---- */

/* A slab of the temperature 1 with one side at 0 and the other closed (Carslaw and Jaeger 1959, 3.4, equation 8). */
static double slab(double x, double t) {
  double sum = 0;
  for (int n = 0; n < 40; n++) {
    double q = (n + 0.5) * pi;
    sum += 2 / q * sin(q * x) * exp(-q * q * t);
  }
  return sum;
}

static double slab_error(int cells) {
  test_engine e;
  bar(&e, &plain, cells, 1, 0);
  e.scene->fps = 5;
  test_run(&e);
  test_advance(&e, 0.2);
  double most = 0;
  for (int i = 0; i <= cells; i++) most = fmax(most, fabs(enthalpies(&e)[i] - slab((double)i / cells, 0.2)));
  test_engine_close(&e);
  return most;
}

/* Of order 2, also in time, as the stable step is that of dx^2. */
static void a_slab_cools_by_its_series(void **state) {
  (void)state;
  double coarse = slab_error(16), fine = slab_error(32);
  printf("slab: error %.3g with 32 cells, order %.3f\n", fine, log2(coarse / fine));
  assert_true(fine < 3e-4 && fabs(log2(coarse / fine) - 2) < 0.1);
}

/* ---- melting ---- */

/* The least root of a rising f in (0, 3). */
static double root(double (*f)(double, const void *), const void *of) {
  double low = 1e-9, high = 3;
  for (int k = 0; k < 100; k++) *(f((low + high) / 2, of) < 0 ? &low : &high) = (low + high) / 2;
  return low;
}

/* Stefan: X = 2 q sqrt(a t), q exp(q^2) erf(q) = c dT/(L sqrt(pi)) (Carslaw and Jaeger 1959, 11.2, I, equation 19). */
static double stefan(double q, const void *number) {
  return q * exp(q * q) * erf(q) - *(const double *)number / sqrt(pi);
}

/* The molten length of the bar, m. */
static double front(test_engine *e, double latent) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++) sum += view->model->mass[i] * fmin(1, fmax(0, view->y[i] / latent));
  return sum;
}

/* The largest error of the front of a bar of one phase, at twelve times until it is at 0.7 m. */
static double stefan_error(int cells, double number) {
  const law l = {100, NAN, 1 / number, {1, NAN}, {1, NAN}};
  double q = root(stefan, &number), end = pow(0.7 / (2 * q), 2), most = 0;
  test_engine e;
  bar(&e, &l, cells, 0, l.latent + 1);
  e.scene->fps = 12 / end;
  test_run(&e);
  for (int k = 4; k <= 12; k++) {
    test_advance(&e, k * end / 12);
    most = fmax(most, fabs(front(&e, l.latent) - 2 * q * sqrt(k * end / 12)));
  }
  test_engine_close(&e);
  return most;
}

/* Within 1e-3 of the bar's length, and of order 1: particles melt one after the other, and what conducts moves in
 * jumps, which the molten part of all of them evens out. */
static void a_melting_front_is_stefans(void **state) {
  (void)state;
  for (double number = 0.5; number <= 2; number *= 2) {
    double coarse = stefan_error(16, number), fine = stefan_error(64, number);
    printf("Stefan number %g: error %.3g with 64 cells, order %.2f\n", number, fine, log2(coarse / fine) / 2);
    assert_true(fine < 1e-3 && coarse / fine > 3.5);
  }
}

/* Neumann: water of the temperature Ti freezes from a wall at Tw, with both phases' own conductivity and capacity
 * (Carslaw and Jaeger 1959, 11.2, II, equation 34; the same density). */
typedef struct neumann {
  law l;
  double Tw, Ti;
} neumann;

static double neumann_equation(double q, const void *of) {
  const neumann *n = of;
  const double *k = n->l.conductivity, *c = n->l.capacity, Tm = n->l.solidus;
  double a = k[0] / c[0], b = k[1] / c[1], p = q * sqrt(a / b);
  double solid = exp(-q * q) / erf(q), melt = k[1] / k[0] * sqrt(a / b) * (n->Ti - Tm) / (Tm - n->Tw);
  return q * n->l.latent * sqrt(pi) / (c[0] * (Tm - n->Tw)) - (solid - melt * exp(-p * p) / erfc(p));
}

static double neumann_error(const neumann *n, int cells) {
  const law *l = &n->l;
  double q = root(neumann_equation, n), end = pow(0.3 / (2 * q), 2) * l->capacity[0] / l->conductivity[0];
  test_engine e;
  bar(&e, l, cells, l->latent + l->capacity[1] * (n->Ti - l->solidus), l->capacity[0] * (n->Tw - l->solidus));
  e.scene->fps = 1 / end;
  test_run(&e);
  test_advance(&e, end);
  double frozen = 1 - front(&e, l->latent);
  test_engine_close(&e);
  return fabs(frozen - 0.3);
}

/* Water at 5 K above its melting point, ice at 20 K below it, and what conducts ten times as well molten. The far end,
 * at 1 m, is out of reach of the melt's diffusion: exp(-(1/0.3)^2 ...) is below the error. */
static void a_freezing_front_is_neumanns(void **state) {
  (void)state;
  static const neumann kinds[] = {
      {{273.15, NAN, 333600, {2100, 4220}, {2.16, 0.561}}, 253.15, 278.15},
      {{100, NAN, 10, {1, 2}, {1, 0.1}}, 90, 105},
  };
  for (size_t k = 0; k < 2; k++) {
    double coarse = neumann_error(&kinds[k], 16), fine = neumann_error(&kinds[k], 64);
    printf("Neumann %zu: error %.3g with 64 cells, order %.2f\n", k, fine, log2(coarse / fine) / 2);
    assert_true(fine < 1e-3 && coarse / fine > 3.5);
  }
}

/* ---- shapes ---- */

/* A lattice of 4 x 4 x layers whose points are moved about, by less than flips a triangle or tetrahedron. */
static void lattice(test_engine *e, int layers) {
  unsigned seed = 7;
  for (int k = 0; k < layers; k++)
    for (int j = 0; j < 4; j++)
      for (int i = 0; i < 4; i++) {
        double x[3] = {i, j, k};
        for (int c = 0; c < 3; c++)
          seed = seed * 1664525u + 1013904223u, x[c] += 0.2 * ((seed >> 8) / 16777216.0 - 0.5);
        test_particle(e, x[0], x[1], layers == 1 ? 0 : x[2], 1 + 0.1 * i);
      }
}

static uint32_t at(int i, int j, int k) { return (uint32_t)(1 + i + 4 * (j + 4 * k)); }

static size_t triangles_of(uint32_t (*t)[3]) {
  size_t count = 0;
  for (int j = 0; j < 3; j++)
    for (int i = 0; i < 3; i++) {
      const uint32_t a = at(i, j, 0), b = at(i + 1, j, 0), c = at(i, j + 1, 0), d = at(i + 1, j + 1, 0);
      memcpy(t[count++], (uint32_t[]){a, b, d}, sizeof *t);
      memcpy(t[count++], (uint32_t[]){a, d, c}, sizeof *t);
    }
  return count;
}

/* Six about the diagonal of each cube. */
static size_t tetrahedra_of(uint32_t (*t)[4]) {
  static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  size_t count = 0;
  for (int cell = 0; cell < 27; cell++)
    for (int o = 0; o < 6; o++, count++) {
      int p[3] = {cell % 3, cell / 3 % 3, cell / 9};
      t[count][0] = at(p[0], p[1], p[2]);
      for (int m = 0; m < 3; m++) {
        p[order[o][m]]++;
        t[count][m + 1] = at(p[0], p[1], p[2]);
      }
    }
  return count;
}

static hk_plugin_spec *sheet(test_engine *e, const law *l) {
  uint32_t triangle[18][3];
  test_engine_open(e);
  add_channel(e, "enthalpy", 0);
  lattice(e, 1);
  hk_plugin_spec *spec = conduction(e, l);
  test_tuples(e, spec, "triangles", 3, &triangle[0][0], triangles_of(triangle));
  test_number(e, spec, "thickness", 0.01);
  return spec;
}

static hk_plugin_spec *block(test_engine *e, const law *l) {
  uint32_t tetrahedron[162][4];
  test_engine_open(e);
  add_channel(e, "enthalpy", 0);
  lattice(e, 4);
  hk_plugin_spec *spec = conduction(e, l);
  test_tuples(e, spec, "tetrahedra", 4, &tetrahedron[0][0], tetrahedra_of(tetrahedron));
  return spec;
}

/* m^3: of the sheet of 0.01 m, or of the block. */
static double volume(const double *x, bool solid) {
  uint32_t triangle[18][3], tetrahedron[162][4];
  double sum = 0;
  size_t count = solid ? tetrahedra_of(tetrahedron) : triangles_of(triangle);
  for (size_t k = 0; k < count; k++) {
    const uint32_t *id = solid ? tetrahedron[k] : triangle[k];
    double d[3][3] = {{0}};
    for (int m = 0; m < (solid ? 3 : 2); m++)
      for (int c = 0; c < 3; c++) d[m][c] = x[3 * (id[m + 1] - 1) + (size_t)c] - x[3 * (id[0] - 1) + (size_t)c];
    double area = d[0][0] * d[1][1] - d[0][1] * d[1][0];
    double det = d[2][0] * (d[0][1] * d[1][2] - d[0][2] * d[1][1]) + d[2][1] * (d[0][2] * d[1][0] - d[0][0] * d[1][2]) +
                 d[2][2] * area;
    sum += solid ? fabs(det) / 6 : 0.01 * fabs(area) / 2;
  }
  return sum;
}

/* Within, a temperature that is linear in space stays; and at the sides flows what it should: the sum of x m dh/dt over
 * all particles is minus the volume times the gradient (the divergence theorem). */
static void linear_temperatures_stay(void **state) {
  (void)state;
  for (int solid = 0; solid < 2; solid++) {
    test_engine e;
    (solid ? block : sheet)(&e, &plain);
    size_t n = solid ? 64 : 16;
    const double *x = e.scene->particles.position;
    for (uint32_t id = 1; id <= n; id++) set_enthalpy(&e, id, 5 + 2 * x[3 * id - 3] - x[3 * id - 2]);
    test_run(&e);
    double dy[65] = {0}, a[3 * 64];
    hk_system *system = &e.run->dynamics.system;
    double *X = e.run->state.X;
    assert_int_equal(system->accelerations(system, 0, X, X + 3 * n, X + 6 * n, a, dy), HK_OK);
    double flow = 0;
    for (size_t i = 0; i < n; i++) flow += X[3 * i] * e.run->state.model.mass[i] * dy[i];
    double wanted = -2 * volume(X, solid); /* the gradient along x is 2 K/m */
    if (!(fabs(flow / wanted - 1) < 1e-12)) fail_msg("%d: %.17g instead of %.17g", solid, flow, wanted);
    for (int k = 0; k < (solid ? 4 : 1); k++)
      for (int i = 0; i < 16; i++) {
        bool within = i % 4 % 3 && i / 4 % 3 && (!solid || k % 3);
        if (within) assert_true(fabs(dy[16 * k + i]) < 1e-13);
      }
    test_engine_close(&e);
  }
}

/* ---- the enthalpy ---- */

/* J, of all particles, less what came from outside where that is a second channel. */
static double total(test_engine *e) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++)
    sum += view->model->mass[i] * (view->y[i] - (view->model->channels > 1 ? view->y[view->n + i] : 0));
  return sum;
}

static const law wax = {319, 329, 2e5, {2000, 2200}, {0.24, 0.15}};

/* A block that is hot on one side and cold on the other melts and freezes: what it holds stays to rounding with
 * explicit methods. */
static void the_enthalpy_is_kept_to_rounding(void **state) {
  (void)state;
  static const char *const methods[] = {"euler", "leapfrog", "rk4", "dopri5"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    block(&e, &wax);
    for (uint32_t id = 1; id <= 64; id++) set_enthalpy(&e, id, id % 4 < 2 ? 4e5 : -1e5);
    e.options.integrator = methods[k];
    e.scene->fps = 1.0 / 2000;
    test_run(&e);
    double before = total(&e), first = hk_run_view(e.run)->y[0];
    test_advance(&e, 1e5);
    printf("%-18s enthalpy off by %.2g of it\n", methods[k], total(&e) / before - 1);
    assert_true(fabs(total(&e) / before - 1) < 1e-12);
    assert_true(fabs(hk_run_view(e.run)->y[0] - first) > 1e4);
    test_engine_close(&e);
  }
}

/* With a held corner the account says what came from it. */
static void what_held_particles_give_is_counted(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = sheet(&e, &wax);
  add_channel(&e, "given", 0);
  test_text(&e, spec, "account", "given");
  test_list(&e, spec, "held", (double[]){1}, 1);
  set_enthalpy(&e, 1, 5e5);
  e.options.integrator = "rk4";
  e.scene->fps = 1.0 / 20000;
  test_run(&e);
  double before = total(&e);
  test_advance(&e, 1e6);
  const hk_view *view = hk_run_view(e.run);
  hk_summary summary;
  hk_run_summary(e.run, &summary);
  const hk_plugin_time *said = &summary.plugin[0];
  assert_true(said->figures == 1 && strcmp(said->figure[0].name, "enthalpy_drift") == 0);
  assert_true(fabs(said->figure[0].value) < 1e-12 && said->figure[0].limit == 1e-6);
  assert_true(view->y[0] == 5e5 && view->y[view->n] > 1e4); /* it stays as warm, and has given */
  assert_true(fabs(total(&e) / before - 1) < 1e-12);
  test_engine_close(&e);
}

/* Heat that a force gives without the account, here `relax`, is seen: the run is not ok. */
static void heat_from_nowhere_is_seen(void **state) {
  (void)state;
  test_engine e;
  hk_summary summary;
  hk_plugin_spec *spec = bar(&e, &plain, 4, 1, 1);
  add_channel(&e, "given", 0);
  test_text(&e, spec, "account", "given");
  hk_plugin_spec *relax = test_plugin(&e, HK_FORCE, "relax");
  test_text(&e, relax, "channel", "enthalpy");
  test_number(&e, relax, "growth", 1e-3);
  e.scene->fps = 100;
  test_run(&e);
  test_advance(&e, 0.1);
  hk_run_summary(e.run, &summary);
  assert_true(fabs(summary.plugin[0].figure[0].value - 1e-4) < 1e-7);
  assert_true(strcmp(summary.verdict_name, "ok") != 0);
  test_engine_close(&e);
}

/* ---- the step ---- */

/* Asked for steps a thousand times too long, a bar whose melt conducts a hundred times as well takes short ones: no
 * particle ever gets warmer than the warmest, and the end is that of ten times as many steps. */
static void steps_are_short_enough(void **state) {
  (void)state;
  static const char *const methods[] = {"euler", "leapfrog", "rk4"};
  const law l = {100, NAN, 1, {1, 1}, {1, 100}};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    bar(&e, &l, 16, -1, 2);
    e.options.integrator = methods[k];
    e.options.dt = 1;
    e.scene->fps = 200;
    test_run(&e);
    for (int f = 1; f <= 6; f++) {
      test_advance(&e, f / 200.0);
      for (int i = 0; i <= 16; i++) assert_true(enthalpies(&e)[i] <= 2 && enthalpies(&e)[i] >= -1);
    }
    assert_true(enthalpies(&e)[1] > 1);
    test_engine_close(&e);
  }
}

/* The largest stable step of a bar that starts at 400 J/kg; with an account of what is given, which starts at 0. */
static double stable_step(bool account) {
  test_engine e;
  hk_summary s;
  hk_plugin_spec *spec = bar(&e, &plain, 16, 400, 300);
  if (account) add_channel(&e, "given", 0);
  if (account) test_text(&e, spec, "account", "given");
  test_run(&e);
  test_advance(&e, 0.1);
  hk_run_summary(e.run, &s);
  test_engine_close(&e);
  return s.dt_max;
}

/* 2/(4/dx^2) at most, and what only counts makes none shorter. */
static void an_account_makes_no_step_shorter(void **state) {
  (void)state;
  double without = stable_step(false), with = stable_step(true);
  printf("steps of %.3g s, with an account %.3g s\n", without, with);
  assert_true(without < 0.5 / 256 && without > 0.25 / 256 && fabs(with / without - 1) < 0.05);
}

/* ---- what is refused ---- */

static void refuses(test_engine *e, const char *sentence) {
  assert_int_equal(hk_run_open(e->scene, &e->options, &e->run, &e->error), HK_BAD_PARAM);
  if (!strstr(e->error.text, sentence)) fail_msg("'%s' is not in: %s", sentence, e->error.text);
  test_engine_close(e);
}

static void refuses_law(law l, const char *sentence) {
  test_engine e;
  bar(&e, &l, 2, 0, 0);
  refuses(&e, sentence);
}

static void laws_that_cannot_be_are_refused(void **state) {
  (void)state;
  refuses_law((law){300, 290, 1, {1, 1}, {1, 1}}, "liquidus: melting ends at 290 K and begins at the solidus, 300 K");
  refuses_law((law){300, NAN, NAN, {1, 1}, {1, 1}}, "latent: what melts takes heat for it");
  refuses_law((law){NAN, NAN, 1, {1, 1}, {1, 1}}, "latent: heat of melting without a temperature of melting");
  refuses_law((law){NAN, 300, NAN, {1, 1}, {1, 1}}, "liquidus: there is none without a solidus");
}

static void what_has_no_way_for_heat_is_refused(void **state) {
  (void)state;
  test_engine e;
  uint32_t edge[1][2] = {{1, 2}};
  for (int same = 0; same < 2; same++) {
    test_engine_open(&e);
    add_channel(&e, "enthalpy", 0);
    test_particle(&e, 0, 0, 0, 1);
    test_particle(&e, 1 - same, 0, 0, 1);
    hk_plugin_spec *spec = conduction(&e, &plain);
    if (same) test_number(&e, spec, "section", 1);
    test_edges(&e, spec, (const uint32_t(*)[2])edge, 1);
    refuses(&e, same ? "the length of edge 1 is 0 at the start"
                     : "section: element 1 has none, and conducts by it: give it above 0");
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_slab_cools_by_its_series),          cmocka_unit_test(a_melting_front_is_stefans),
      cmocka_unit_test(a_freezing_front_is_neumanns),        cmocka_unit_test(linear_temperatures_stay),
      cmocka_unit_test(the_enthalpy_is_kept_to_rounding),    cmocka_unit_test(what_held_particles_give_is_counted),
      cmocka_unit_test(heat_from_nowhere_is_seen),           cmocka_unit_test(steps_are_short_enough),
      cmocka_unit_test(an_account_makes_no_step_shorter),    cmocka_unit_test(laws_that_cannot_be_are_refused),
      cmocka_unit_test(what_has_no_way_for_heat_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
