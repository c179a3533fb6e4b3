/* The stated largest stable step over the true one, for scenes of every kind of force and every explicit method,
 * adaptive ones with a step that they take whatever their error is: a table of ratios. The truth is that of the scene's
 * linear equations at the start, by the plugin's own step on them (tests/support/linear_scene.h). "-": the method has
 * no stable step there, and states none.
 *
 * Forces that set in and cease (HK_STIFFENS) are held against the contacts that are closed at the start, though what
 * opens and closes is no linear equation: symplectic methods are granted 0.45 of that, and grains count as if crowded.
 * contact_heat.c shows what a longer step would do.
 *
 * Arguments: a part of scenes' names, and a method. */
#include "core/numerics/stability/stability.h"
#include "tests/support/linear_scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint64_t state_of_random;

/* splitmix64 (Steele, Lea and Flood 2014), in [0, 1). */
static double uniform(void) {
  uint64_t z = state_of_random += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static double between(double low, double high) { return low + (high - low) * uniform(); }

/* ---- the scenes ---- */

static hk_plugin_spec *springs(test_engine *e, const uint32_t (*edge)[2], size_t count, double k, double stretch,
                               double damping) {
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "springs");
  double rest[64];
  for (size_t c = 0; c < count; c++) {
    const double *a = e->scene->particles.position + 3 * (edge[c][0] - 1),
                 *b = e->scene->particles.position + 3 * (edge[c][1] - 1);
    double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    rest[c] = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / stretch;
  }
  test_edges(e, s, edge, count);
  test_number(e, s, "k", k);
  test_list(e, s, "rest", rest, count);
  if (damping > 0) test_number(e, s, "damping", damping);
  return s;
}

/* A line of particles along x, 0.1 m apart. */
static size_t line(test_engine *e, size_t n, double bend, double ratio, uint32_t edge[][2]) {
  for (size_t i = 0; i < n; i++) {
    test_particle(e, 0.1 * (double)i, bend * (double)(i % 2), 0, i % 2 ? 0.01 * ratio : 0.01);
    if (i > 0) edge[i - 1][0] = (uint32_t)i, edge[i - 1][1] = (uint32_t)i + 1;
  }
  return n - 1;
}

static void fix(test_engine *e, uint32_t id) { test_pin(e, HK_PIN_FIXED, id, NULL); }

static void chain(test_engine *e, double stretch, double damping, double ratio) {
  uint32_t edge[8][2];
  size_t count = line(e, 7, 0, ratio, edge);
  springs(e, (const uint32_t(*)[2])edge, count, 100, stretch, damping);
  fix(e, 1), fix(e, 7);
}

static void plain_chain(test_engine *e) { chain(e, 1, 0, 1); }
static void damped_chain(test_engine *e) { chain(e, 1, 0.1, 1); }
static void chain_of_two_masses(test_engine *e) { chain(e, 1, 0, 30); }
static void taut_chain(test_engine *e) { chain(e, 1.5, 0, 1); }
static void taut_damped_chain(test_engine *e) { chain(e, 1.5, 0.1, 1); }
static void very_taut_damped_chain(test_engine *e) { chain(e, 5, 0.5, 1); }
static void taut_overdamped_chain(test_engine *e) { chain(e, 1.2, 5, 1); }

/* 5 x 4 particles 0.1 m apart, the border fixed. */
static void net_of(test_engine *e, double stretch, double damping) {
  uint32_t edge[64][2], count = 0;
  for (uint32_t j = 0; j < 4; j++)
    for (uint32_t i = 0; i < 5; i++) {
      uint32_t id = test_particle(e, 0.1 * i, 0.1 * j, 0, 0.01);
      if (i > 0 && j % 3) edge[count][0] = id - 1, edge[count++][1] = id;
      if (j > 0 && i % 4) edge[count][0] = id - 5, edge[count++][1] = id;
    }
  springs(e, (const uint32_t(*)[2])edge, count, 100, stretch, damping);
  for (uint32_t id = 1; id <= 20; id++)
    if (id <= 5 || id > 15 || id % 5 <= 1) fix(e, id);
}

static void net(test_engine *e) { net_of(e, 1, 0); }
static void taut_net(test_engine *e) { net_of(e, 1.5, 0); }
static void taut_damped_net(test_engine *e) { net_of(e, 1.5, 0.1); }
static void slightly_taut_damped_net(test_engine *e) { net_of(e, 1.02, 0.1); }
static void slightly_taut_overdamped_net(test_engine *e) { net_of(e, 1.02, 4); }

static void angles(test_engine *e) {
  uint32_t edge[8][2];
  size_t count = line(e, 6, 0.02, 1, edge);
  springs(e, (const uint32_t(*)[2])edge, count, 100, 1.01, 0.05);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "angle_springs");
  test_edges(e, s, (const uint32_t(*)[2])edge, count);
  test_number(e, s, "EI", 1e-2);
}

static void rods(test_engine *e) {
  uint32_t edge[8][2];
  size_t count = line(e, 6, 0, 1, edge);
  springs(e, (const uint32_t(*)[2])edge, count, 100, 1.01, 0.05);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "rods");
  test_edges(e, s, (const uint32_t(*)[2])edge, count);
  test_number(e, s, "EI", 1e-2);
  test_text(e, s, "rest", "straight");
}

static void bars_with_springs(test_engine *e) {
  uint32_t edge[8][2], next[8][2];
  size_t count = line(e, 6, 0.02, 1, edge);
  for (uint32_t k = 0; k < 4; k++) next[k][0] = k + 1, next[k][1] = k + 3;
  springs(e, (const uint32_t(*)[2])next, 4, 100, 1, 0.05);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])edge, count);
}

static void sheet(test_engine *e, double scale) {
  uint32_t triangle[24], count = 0;
  for (uint32_t j = 0; j < 2; j++)
    for (uint32_t i = 0; i < 3; i++) test_particle(e, 0.1 * i, 0.1 * j, 0, 0.01);
  for (uint32_t j = 0; j < 1; j++)
    for (uint32_t i = 0; i < 2; i++) {
      uint32_t a = 3 * j + i + 1, all[6] = {a, a + 1, a + 4, a, a + 4, a + 3};
      memcpy(triangle + count, all, sizeof all);
      count += 6;
    }
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "membrane");
  test_tuples(e, s, "triangles", 3, triangle, count / 3);
  test_number(e, s, "stiffness", 100);
  test_number(e, s, "rest", scale);
  test_number(e, s, "damping", 1e-3);
}

static void membrane(test_engine *e) { sheet(e, 1); }
static void taut_membrane(test_engine *e) { sheet(e, 0.8); }

static void bodies(test_engine *e, double softening) {
  for (int i = 0; i < 5; i++) test_particle(e, between(-1, 1), between(-1, 1), between(-1, 1), between(0.1, 1));
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, s, "G", 1);
  test_number(e, s, "softening", softening);
}

static void gravitation(test_engine *e) { bodies(e, 2); }

static void pull_and(test_engine *e, const char *field) {
  uint32_t edge[8][2];
  size_t count = line(e, 5, 0.02, 3, edge);
  springs(e, (const uint32_t(*)[2])edge, count, 100, 1.05, 0);
  fix(e, 1);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, field);
  if (strcmp(field, "drag") == 0)
    test_number(e, s, "rate", 20);
  else
    test_vector(e, s, "B", 0, 0.6, 0.8), test_number(e, s, "ratio", 30);
}

static void drag_on_springs(test_engine *e) { pull_and(e, "drag"); }
static void charges_on_springs(test_engine *e) { pull_and(e, "magnetic"); }

static void charges_in_a_well(test_engine *e) {
  for (int i = 0; i < 3; i++) test_particle(e, 1 + i, 0, 0, 1 + 4 * i);
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", 100);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "magnetic");
  test_vector(e, s, "B", 0, 0, 1);
  test_number(e, s, "charge", 20);
}

static void grains(test_engine *e, size_t nx, size_t ny, size_t nz, double friction, double restitution) {
  for (size_t k = 0; k < nz; k++)
    for (size_t j = 0; j < ny; j++)
      for (size_t i = 0; i < nx; i++) test_particle(e, 0.199 * (double)i, 0.199 * (double)j, 0.199 * (double)k, 0.01);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "soft_spheres");
  test_number(e, s, "radius", 0.1);
  test_number(e, s, "stiffness", 1000);
  test_number(e, s, "restitution", restitution);
  test_number(e, s, "friction", friction);
  test_plugin(e, HK_SERVICE, "neighbours");
  test_number(e, test_plugin(e, HK_FORCE, "central"), "strength", 6000); /* pressed grains alone rest unstably */
}

static void two_grains(test_engine *e) { grains(e, 2, 1, 1, 0, 1); }
static void row_of_grains(test_engine *e) { grains(e, 6, 1, 1, 0, 1); }
static void layer_of_grains(test_engine *e) { grains(e, 3, 2, 1, 0, 1); }
static void damped_row_of_grains(test_engine *e) { grains(e, 6, 1, 1, 0, 0.7); }
static void rough_layer_of_grains(test_engine *e) { grains(e, 3, 2, 1, 0.5, 0.7); }

static void on_a_floor(test_engine *e) {
  for (int i = 0; i < 3; i++) test_particle(e, i, 0, -1e-4, 0.01);
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "penalty");
  test_text(e, s, "shape", "plane");
  test_number(e, s, "k", 1000);
}

static void taut_ropes(test_engine *e) {
  uint32_t edge[8][2];
  double rest[8];
  size_t count = line(e, 6, 0, 1, edge);
  for (size_t k = 0; k < count; k++) rest[k] = 0.09;
  hk_plugin_spec *s = test_plugin(e, HK_FORCE, "ropes");
  test_edges(e, s, (const uint32_t(*)[2])edge, count);
  test_number(e, s, "k", 100);
  test_list(e, s, "rest", rest, count);
  fix(e, 1), fix(e, 6);
}

static const struct scene {
  const char *name;
  void (*build)(test_engine *);
} scenes[] = {
    {"chain", plain_chain},
    {"chain, damped", damped_chain},
    {"chain of two masses", chain_of_two_masses},
    {"chain, taut", taut_chain},
    {"chain, taut, damped", taut_damped_chain},
    {"chain, very taut, damped", very_taut_damped_chain},
    {"chain, taut, overdamped", taut_overdamped_chain},
    {"net", net},
    {"net, taut", taut_net},
    {"net, taut, damped", taut_damped_net},
    {"net, a little taut, damped", slightly_taut_damped_net},
    {"net, a little taut, overdamped", slightly_taut_overdamped_net},
    {"angle springs", angles},
    {"rods", rods},
    {"bars with springs", bars_with_springs},
    {"membrane", membrane},
    {"membrane, taut", taut_membrane},
    {"gravitation", gravitation},
    {"springs in a drag", drag_on_springs},
    {"charges on springs", charges_on_springs},
    {"charges in a well", charges_in_a_well},
    {"two grains", two_grains},
    {"grains in a row", row_of_grains},
    {"grains in a row, damped", damped_row_of_grains},
    {"grains in a layer", layer_of_grains},
    {"grains in a layer, rough", rough_layer_of_grains},
    {"penalty", on_a_floor},
    {"ropes, taut", taut_ropes},
};

/* ---- the table ---- */

typedef struct tally {
  size_t figures, above, low, half;
  bool verbose;
} tally;

static void take(tally *t, double ratio) {
  t->figures++;
  t->above += ratio > 1 + LINEAR_PRECISION;
  t->low += ratio < 0.7;
  t->half += ratio < 0.5;
}

static void one_method(const char *name, linear_scene *q, const hk_spectrum *spectrum, tally *t) {
  fake_method m = linear_scene_open(name, q, 1);
  bool fits = fake_method_explicit(&m);
  hk_stable s = {0};
  if (fits) s = hk_stable_step(m.plugin->integrator, m.self, spectrum);
  linear_scene_close(&m);
  if (!fits) return;
  if (!(s.limit > 0) || !isfinite(s.limit)) {
    printf(" %s -", name);
    return;
  }
  double ratio = linear_scene_ratio(name, q, s.limit);
  take(t, ratio);
  if (t->verbose) printf("\n   ");
  printf(" %s %.2f%s", name, ratio, ratio > 1 + LINEAR_PRECISION ? "!" : ratio < 0.7 ? "<" : "");
  if (t->verbose) printf(" limit %.4g by w %.4g g %.4g b %.4g", s.limit, s.w, s.g, s.b);
}

static void one_scene(const struct scene *scene, const char *only, tally *t) {
  test_engine e;
  const char *names[FAKE_METHODS];
  hk_spectrum spectrum;
  size_t count = fake_integrator_names(names);
  test_engine_open(&e);
  state_of_random = 1;
  scene->build(&e);
  test_plugin(&e, HK_INTEGRATOR, "rk4");
  test_run(&e);
  linear_scene q = linear_scene_of(&e);
  assert_int_equal(hk_spectrum_estimate(&e.run->dynamics.system, &spectrum, &e.error), HK_OK);
  printf("%s (w %.4g of %.4g, g %.4g to %.4g, slope %.3g + %.3g, b %.4g, undamped %.4g, beta %.3g)", scene->name,
         spectrum.w_max, spectrum.w_reached, spectrum.alpha, spectrum.g_max, spectrum.damping_slope,
         spectrum.damping_offset, spectrum.b_max, spectrum.w_undamped, spectrum.beta);
  for (int k = 0; k < HK_DAMPED_LINES; k++)
    printf(" damped above %.4g w^2 - %.4g", spectrum.damped[k].slope, spectrum.damped[k].offset);
  printf("\n ");
  printf(" in %zu evaluations", spectrum.evaluations);
  if (!linear_scene_rests(&q)) printf(" (rests unstably)");
  for (size_t k = 0; k < count && linear_scene_rests(&q); k++)
    if (strcmp(names[k], "cvode") != 0 && strcmp(names[k], "arkode") != 0 && strcmp(names[k], "local_leapfrog") != 0 &&
        (!only || strcmp(only, names[k]) == 0))
      one_method(names[k], &q, &spectrum, t);
  printf("\n");
  test_engine_close(&e);
}

int main(int arguments, char **argument) {
  tally t = {.verbose = arguments > 1};
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++)
    if (arguments < 2 || strstr(scenes[k].name, argument[1]))
      one_scene(&scenes[k], arguments > 2 ? argument[2] : NULL, &t);
  printf("%zu figures: %zu above the truth, %zu below 0.7 of it, %zu below 0.5\n", t.figures, t.above, t.low, t.half);
  return t.above > 0;
}
