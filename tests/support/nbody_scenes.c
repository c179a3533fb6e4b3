/* The numbers of the problems, from the literature that is named with each. */
#include "tests/support/nbody_scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.10; the answer of the test set of Bari,
 * which was computed anew with 40 digits. */
const nbody_problem nbody_pleiades = {
    .name = "Pleiades",
    .count = 7,
    .G = 1,
    .end = 3,
    .mass = (const double[]){1, 2, 3, 4, 5, 6, 7},
    .x = (const double[][3]){{3, 3, 0}, {3, -3, 0}, {-1, 2, 0}, {-3, 0, 0}, {2, 0, 0}, {-2, -4, 0}, {2, 4, 0}},
    .v = (const double[][3]){{0}, {0}, {0}, {0, -1.25, 0}, {0, 1, 0}, {1.75, 0, 0}, {-1.5, 0, 0}},
    .answer = (const double[][3]){{0.37061391439705129, -3.9434375855173921, 0},
                                  {3.2372840920572331, -3.2713809739725499, 0},
                                  {-3.2225590324183233, 5.2250818434565442, 0},
                                  {0.65970914557753084, -2.5906124349774695, 0},
                                  {0.34255817071565798, 1.1982136933922746, 0},
                                  {1.5621721014006310, -0.24296823449358234, 0},
                                  {-0.70030929222124954, 1.0914492404289797, 0}}};

/* Burrau 1913; the answer was computed with two tolerances that agree to 1e-14. */
const nbody_problem nbody_pythagorean = {.name = "Pythagorean",
                                         .count = 3,
                                         .G = 1,
                                         .end = 10,
                                         .mass = (const double[]){3, 4, 5},
                                         .x = (const double[][3]){{1, 3, 0}, {-2, -1, 0}, {1, -1, 0}},
                                         .v = (const double[][3]){{0}, {0}, {0}},
                                         .answer = (const double[][3]){{0.77848041013809, 0.14139230029009, 0},
                                                                       {-2.02509247797820, 0.09721938414606, 0},
                                                                       {1.15298573629971, -0.16261088749090, 0}}};

/* Hairer, Lubich and Wanner, Geometric Numerical Integration, I.2.4: distances of the earth, days, masses of the sun.
 * The answer was computed by a program that shares no code with hooke. */
const nbody_problem nbody_solar = {
    .name = "outer solar system",
    .count = 6,
    .G = 2.95912208286e-4,
    .end = 200000,
    .mass = (const double[]){1.00000597682, 0.000954786104043, 0.000285583733151, 0.0000437273164546,
                             0.0000517759138449, 1 / 1.3e8},
    .x = (const double[][3]){{0},
                             {-3.5023653, -3.8169847, -1.5507963},
                             {9.0755314, -3.0458353, -1.6483708},
                             {8.3101420, -16.2901086, -7.2521278},
                             {11.4707666, -25.7294829, -10.8169456},
                             {-15.5387357, -25.2225594, -3.1902382}},
    .v = (const double[][3]){{0},
                             {0.00565429, -0.00412490, -0.00190589},
                             {0.00168318, 0.00483525, 0.00192462},
                             {0.00354178, 0.00137102, 0.00055029},
                             {0.00288930, 0.00114527, 0.00039677},
                             {0.00276725, -0.00170702, -0.00136504}},
    .answer = (const double[][3]){{1.23584254235461, -0.48994382114427, -0.24610536181432},
                                  {2.61107957011286, -5.07952549678799, -2.24472067785306},
                                  {-7.66913624739131, -4.05205224548783, -1.33111566971138},
                                  {-5.82474394984774, 15.33717375357252, 6.78246340991761},
                                  {20.66398024751502, 20.58295604245987, 7.89479541474820},
                                  {36.56695069882260, -13.76768440125963, -15.04346922182326}}};

/* Two bodies of 1/2 kg each about their centre, eccentricity 0.6, period 2 pi; after 10 s the first is at half the
 * place
 * (-1.5350235919098137, -0.28366840649978086) of the relative motion. */
const nbody_problem nbody_kepler = {.name = "Kepler",
                                    .count = 2,
                                    .G = 1,
                                    .end = 10,
                                    .mass = (const double[]){0.5, 0.5},
                                    .x = (const double[][3]){{0.2, 0, 0}, {-0.2, 0, 0}},
                                    .v = (const double[][3]){{0, 1, 0}, {0, -1, 0}},
                                    .answer = (const double[][3]){{-0.76751179595490685, -0.14183420324989043, 0},
                                                                  {0.76751179595490685, 0.14183420324989043, 0}}};

hk_plugin_spec *nbody_open(test_engine *e, const nbody_problem *p, const char *method) {
  uint32_t id;
  test_engine_open(e);
  assert_int_equal(hk_scene_add_particles(e->scene, p->count, &p->x[0][0], &p->v[0][0], p->mass, 0, 0, &id, &e->error),
                   HK_OK);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "nbody");
  test_number(e, spec, "G", p->G);
  e->options.integrator = method;
  e->scene->duration = p->end;
  e->scene->fps = 1 / p->end;
  return spec;
}

double nbody_error(const nbody_problem *p, const char *method, double dt, double tol, size_t *evaluations) {
  test_engine e;
  double sum = 0;
  nbody_open(&e, p, method);
  if (dt > 0) e.options.dt = dt;
  if (tol > 0) e.options.tol = tol;
  test_run(&e);
  test_advance(&e, p->end);
  const double *x = hk_run_view(e.run)->x;
  for (size_t k = 0; k < 3 * p->count; k++) sum += pow(x[k] - p->answer[k / 3][k % 3], 2);
  if (evaluations) *evaluations = e.run->dynamics.count.evaluations;
  test_engine_close(&e);
  return sqrt(sum / (double)p->count);
}

static void direction(uint64_t *seed, double length, double *d) {
  double z = 2 * hk_random_uniform(seed) - 1, angle = 6.283185307179586 * hk_random_uniform(seed);
  d[0] = length * sqrt(1 - z * z) * cos(angle);
  d[1] = length * sqrt(1 - z * z) * sin(angle);
  d[2] = length * z;
}

/* Aarseth, Henon and Wielen 1974: q = v/v_escape has the density q^2 (1 - q^2)^3.5, which is below 0.1. */
void nbody_add_sphere(test_engine *e, size_t count, uint64_t number) {
  double *x = malloc(3 * count * sizeof *x), *v = malloc(3 * count * sizeof *v);
  uint64_t seed[4];
  uint32_t id;
  assert_true(x && v);
  hk_random_seed(seed, number);
  for (size_t i = 0; i < count; i++) {
    double r, q;
    do r = 1 / sqrt(pow(hk_random_uniform(seed), -2.0 / 3) - 1);
    while (!(r < 10));
    do q = hk_random_uniform(seed);
    while (0.1 * hk_random_uniform(seed) > q * q * pow(1 - q * q, 3.5));
    direction(seed, r, x + 3 * i);
    direction(seed, q * sqrt(2 / sqrt(1 + r * r)), v + 3 * i);
  }
  assert_int_equal(hk_scene_add_particles(e->scene, count, x, v, NULL, 1 / (double)count, 0, &id, &e->error), HK_OK);
  free(x);
  free(v);
}
