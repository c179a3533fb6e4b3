/* What derivatives of a run cost in runs: an adjoint by few and by many parameters, tangents by one and by four, of
 * cloth of springs, sheets of triangles that bend, a block of tetrahedra, and chains, by each kind of method. Processor
 * time of one thread, the least of some repeats taken in turn; `again`: the steps taken again, which every derivative
 * needs once and which count as part of it. A tangent is that of one parameter more, and one alone in brackets.
 * Arguments: the particles of a cloth's edge, a part of the scenes' names, a method. */
#include "tests/bench/cloth.h"
#include "tests/support/sheets.h"
#include "tests/support/varied_scenes.h"

#include <string.h>

enum { REPEATS = 2, MANY = 32 };

static double processor_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int side = 24; /* particles of a cloth's edge */

/* p: stiffness, damping, mass, speed. */
static void springs(test_engine *e, const double p[VARIED_PARAMETERS]) {
  uint32_t N = (uint32_t)side;
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N * N; i++)
    test_particle(e, i % N / (N - 1.0), i / N / (N - 1.0), 0, p[2] / ((double)N * N));
  for (uint32_t i = 0; i < N * N; i++) e->scene->particles.velocity[3 * i + 2] = p[3] * sin(0.1 * i);
  test_pin(e, HK_PIN_FIXED, N * (N - 1) + 1, NULL);
  test_pin(e, HK_PIN_FIXED, N * N, NULL);
  test_plugin(e, HK_FORCE, "gravity");
  add_springs(e, N, (const int[2][2]){{1, 0}, {0, 1}}, p[0], p[1]);
  add_springs(e, N, (const int[2][2]){{1, 1}, {-1, 1}}, 0.3 * p[0], p[1]);
  add_springs(e, N, (const int[2][2]){{2, 0}, {0, 2}}, 0.05 * p[0], p[1]);
}

static void add_forces(test_engine *e, const sheet *s, const double p[VARIED_PARAMETERS], const char *model,
                       const char *bending) {
  hk_plugin_spec *membrane = sheet_add(e, s, "membrane");
  test_text(e, membrane, "model", model);
  test_number(e, membrane, "stiffness", p[0]);
  test_number(e, membrane, "damping", 1e-3 * p[1]);
  hk_plugin_spec *bends = test_plugin(e, HK_FORCE, bending);
  test_tuples(e, bends, "triangles", 3, s->corner, s->triangles);
  test_number(e, bends, "rigidity", 1e-4 * p[0]);
  test_plugin(e, HK_FORCE, "gravity");
  for (size_t i = 0; i < s->particles; i++) {
    e->scene->particles.mass[i] = p[2] / (double)s->particles;
    e->scene->particles.velocity[3 * i + 2] = p[3] * sin(0.1 * (double)i);
  }
}

static void membrane_of(test_engine *e, const double p[VARIED_PARAMETERS], const char *model, const char *bending) {
  sheet s = sheet_make(SHEET_ALTERNATING, (size_t)side - 1, (double[]){0, 0, 0});
  e->scene->threads = 1;
  add_forces(e, &s, p, model, bending);
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  sheet_free(&s);
}

static void baraff_witkin(test_engine *e, const double p[VARIED_PARAMETERS]) {
  membrane_of(e, p, "baraff_witkin", "quadratic_bending");
}
static void stvk(test_engine *e, const double p[VARIED_PARAMETERS]) { membrane_of(e, p, "stvk", "quadratic_bending"); }
static void rubber(test_engine *e, const double p[VARIED_PARAMETERS]) {
  membrane_of(e, p, "neo_hookean", "quadratic_bending");
}
static void hinges(test_engine *e, const double p[VARIED_PARAMETERS]) { membrane_of(e, p, "baraff_witkin", "hinges"); }

/* Cubes of five tetrahedra would need a parity: six around a diagonal each do not. */
static void block(test_engine *e, const double p[VARIED_PARAMETERS]) {
  static const uint32_t way[6][3] = {{1, 2, 4}, {1, 4, 2}, {2, 1, 4}, {2, 4, 1}, {4, 1, 2}, {4, 2, 1}};
  uint32_t N = 7, at = 0, *id = malloc(6 * 4 * (N - 1) * (N - 1) * (N - 1) * sizeof *id);
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N * N * N; i++) {
    test_particle(e, i % N / (N - 1.0), i / N % N / (N - 1.0), i / (N * N) / (N - 1.0), p[2] / (double)(N * N * N));
    e->scene->particles.velocity[3 * i + 2] = p[3] * sin(0.1 * i);
  }
  for (uint32_t c = 0; c < (N - 1) * (N - 1) * (N - 1); c++) {
    uint32_t x = c % (N - 1), y = c / (N - 1) % (N - 1), z = c / ((N - 1) * (N - 1)), step[5] = {0, 1, N, 0, N * N};
    for (int t = 0; t < 6; t++) {
      uint32_t corner[4] = {1 + x + N * y + N * N * z};
      for (int k = 0; k < 3; k++) corner[k + 1] = corner[k] + step[way[t][k]];
      bool odd = t == 1 || t == 2 || t == 5;
      id[at++] = corner[0], id[at++] = corner[odd ? 2 : 1], id[at++] = corner[odd ? 1 : 2], id[at++] = corner[3];
    }
  }
  hk_plugin_spec *solid = test_plugin(e, HK_FORCE, "neo_hookean");
  test_tuples(e, solid, "tetrahedra", 4, id, at / 4);
  test_number(e, solid, "E", 10 * p[0]);
  test_number(e, solid, "damping", 0.01 * p[1]);
  test_plugin(e, HK_FORCE, "gravity");
  free(id);
}

static void chain(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 400 };
  static uint32_t pair[N - 1][2];
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N; i++) {
    test_particle(e, 0.1 * i, 0, 0, 0.01 * p[2]);
    e->scene->particles.velocity[3 * i + 2] = p[3] * sin(0.1 * i);
    if (i + 1 < N) pair[i][0] = i + 1, pair[i][1] = i + 2;
  }
  hk_plugin_spec *along = test_plugin(e, HK_FORCE, "springs"), *across = test_plugin(e, HK_FORCE, "angle_springs");
  test_edges(e, along, (const uint32_t(*)[2])pair, N - 1);
  test_edges(e, across, (const uint32_t(*)[2])pair, N - 1);
  test_number(e, along, "k", p[0]);
  test_number(e, along, "damping", p[1]);
  test_number(e, across, "EI", 1e-4 * p[0]);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.1);
  test_plugin(e, HK_FORCE, "gravity");
}

static void cloud(test_engine *e, const double p[VARIED_PARAMETERS]) {
  e->scene->threads = 1;
  for (uint32_t i = 0; i < 500; i++) {
    test_particle(e, cos(i), sin(1.3 * i), cos(0.7 * i), p[2]);
    e->scene->particles.velocity[3 * i + 2] = p[3] * sin(0.1 * i);
  }
  hk_plugin_spec *pull = test_plugin(e, HK_FORCE, "central");
  test_number(e, pull, "strength", 0.01 * p[0]);
  test_number(e, pull, "power", -2);
  test_number(e, pull, "softening", p[1] * 10);
  test_plugin(e, HK_FORCE, "gravity");
}

/* Of rigid bars, hung at its first particle. */
static void bars(test_engine *e, const double p[VARIED_PARAMETERS]) {
  enum { N = 101 };
  static uint32_t pair[N - 1][2];
  e->scene->threads = 1;
  for (uint32_t i = 0; i < N; i++) {
    test_particle(e, 0.02 * i, 0, 0, 0.01 * p[2]);
    e->scene->particles.velocity[3 * i + 2] = p[3] * 0.02 * i;
    if (i + 1 < N) pair[i][0] = i + 1, pair[i][1] = i + 2;
  }
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  test_edges(e, test_plugin(e, HK_CONSTRAINT, "bars"), (const uint32_t(*)[2])pair, N - 1);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", p[1]);
  test_plugin(e, HK_FORCE, "gravity");
}

typedef struct subject {
  const char *name;
  varied_scene *scene;
  double stiffness;
} subject;

static const subject SUBJECTS[] = {{"springs", springs, 100},
                                   {"baraff_witkin and quadratic_bending", baraff_witkin, 20},
                                   {"stvk and quadratic_bending", stvk, 20},
                                   {"neo_hookean and quadratic_bending", rubber, 20},
                                   {"baraff_witkin and hinges", hinges, 20},
                                   {"neo_hookean, solid", block, 20},
                                   {"springs and angle_springs", chain, 100},
                                   {"central and gravity", cloud, 100},
                                   {"a chain of bars", bars, 100}};

typedef struct costs {
  double run, again, few, many, one, four;
} costs;

static double least(double a, double b) { return a < b ? a : b; }

static double adjoint_seconds(varied_runs *r, const hk_varied *by, size_t count) {
  hk_error error = {0};
  size_t n = r->s->n;
  double *X = calloc(6 * n, sizeof *X), slope[MANY], begun = processor_seconds();
  for (size_t e = 0; e < 3 * n; e++) X[e] = 1. / (double)n;
  r->s->shared_of = NULL; /* each time as the first one */
  if (hk_sensitivity_adjoint(r->s, X, by, count, slope, &error) != HK_OK) printf("%s\n", error.text);
  free(X);
  return processor_seconds() - begun;
}

static double tangent_seconds(varied_runs *r, size_t count) {
  hk_error error = {0};
  double begun = processor_seconds();
  if (hk_sensitivity_tangents(r->s, r->by, count, NULL, NULL, &error) != HK_OK) printf("%s\n", error.text);
  return processor_seconds() - begun;
}

static void measure(const subject *s, const char *method, double dt, size_t steps, costs *c) {
  const double p[VARIED_PARAMETERS] = {s->stiffness, 0.01, 0.15, 0.1};
  varied_runs r;
  hk_varied by[MANY];
  hk_error error = {0};
  varied_open(&r, s->scene, method, p, VARIED_PARAMETERS, dt);
  for (size_t k = 0; k < MANY; k++) by[k] = r.by[k % VARIED_PARAMETERS];
  double begun = processor_seconds();
  test_advance(&r.base, dt * (double)steps);
  c->run = least(c->run, processor_seconds() - begun);
  begun = processor_seconds();
  if (hk_sensitivity_finish(r.s, &error) != HK_OK) printf("%s\n", error.text);
  double again = processor_seconds() - begun;
  c->again = least(c->again, again);
  c->few = least(c->few, again + adjoint_seconds(&r, by, 2));
  c->many = least(c->many, again + adjoint_seconds(&r, by, MANY));
  c->one = least(c->one, again + tangent_seconds(&r, 1));
  c->four = least(c->four, again + tangent_seconds(&r, 4));
  varied_close(&r);
}

int main(int count, char **argument) {
  static const char *const methods[] = {"leapfrog", "rk4", "backward_euler", "bdf2", "linear_bdf2"};
  const size_t steps = 200;
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (count > 1) side = atoi(argument[1]);
  printf("%zu steps; in runs, each with the steps taken again\n%-36s %-14s %9s %6s %6s %6s %14s\n", steps, "scene",
         "method", "run, ms", "again", "by 2", "by 32", "a tangent");
  for (size_t k = 0; k < sizeof SUBJECTS / sizeof *SUBJECTS; k++)
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
      if (count > 2 && !strstr(SUBJECTS[k].name, argument[2])) continue;
      if (SUBJECTS[k].scene == bars && m > 0) continue; /* by kicks and drifts alone */
      if (count > 3 && strcmp(methods[m], argument[3]) != 0) continue;
      costs c = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
      for (int q = 0; q < REPEATS; q++) measure(&SUBJECTS[k], methods[m], 2e-4, steps, &c);
      printf("%-36s %-14s %9.2f %6.2f %6.2f %6.2f %6.2f (%5.2f)\n", SUBJECTS[k].name, methods[m], 1e3 * c.run,
             c.again / c.run, c.few / c.run, c.many / c.run, (c.four - c.one) / 3 / c.run, c.one / c.run);
    }
  return 0;
}
