/* Contact of a sheet of 100 x 100 particles that falls onto a ball and drapes over it, with leapfrog, accurate to 1e-3
 * m or better: what the corrector and the force take of a step, a tenth of a second at a time from the landing on. All
 * is processor time, which others on the machine disturb less than the wall's. The corrector's parts are searches, the
 * budgets that say where to search, looks at pairs (with what proves that fast ones do not pass), and impulses.
 *
 * At the worst, about 0.35 s, with the sheet of springs in folds: of 20,000 triangles 40,000 pairs are within 3 mm
 * beyond contact, 9,000 are looked at first and 4,500 again, 1,600 may meet and 800 push, in 12,000 relaxations. A look
 * takes about 100 ns, a relaxation with its share of the rest 70 ns, and in folds two patches come nearer by their skin
 * within ten steps, and are searched again. That is 5 ms beside forces of 0.2 ms, as a spring costs 6 ns: there the
 * relaxations alone are more than 60 % of the step. Beside a membrane and hinges contact is half of the step on
 * average. Steps that contact changes cost the method a second evaluation, which stands in the rest of the step here.
 *
 * build/bench/contact [threads] [seconds] [none|corrector|force] [springs|triangles] */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { SIDE = 100, RINGS = 24 };
static const double pi = 3.14159265358979323846, size = 1, ball = 0.25, thickness = 0.003;

/* s, of the process */
static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(test_engine *e, hk_status status) {
  if (status == HK_OK) return;
  fprintf(stderr, "%s\n", e->error.text);
  exit(1);
}

typedef enum cloth { SPRINGS, TRIANGLES, CLOTHS } cloth;
static const char *const cloth_name[] = {"springs", "triangles"};

static void springs(test_engine *e, const char *label, const uint32_t (*edge)[2], size_t count, double k) {
  hk_plugin_spec *spec;
  must(e, hk_scene_add_plugin(e->scene, HK_FORCE, "springs", label, NULL, &spec, &e->error));
  test_edges(e, spec, edge, count);
  test_number(e, spec, "k", k);
  test_number(e, spec, "damping", 1e-5 * k);
}

/* Edges (i, j) to (i + di, j + dj) of the grid. */
static size_t join(uint32_t (*edge)[2], size_t count, int di, int dj) {
  for (int j = 0; j + dj < SIDE; j++)
    for (int i = di < 0 ? -di : 0; i + (di > 0 ? di : 0) < SIDE; i++) {
      edge[count][0] = (uint32_t)(1 + j * SIDE + i);
      edge[count++][1] = (uint32_t)(1 + (j + dj) * SIDE + i + di);
    }
  return count;
}

/* Cotton's bending, a membrane as stiff as the springs. */
static void add_shell(test_engine *e, const uint32_t *triangle, size_t count) {
  hk_plugin_spec *membrane = test_plugin(e, HK_FORCE, "membrane"), *hinges = test_plugin(e, HK_FORCE, "hinges");
  test_tuples(e, membrane, "triangles", 3, triangle, count);
  test_number(e, membrane, "stiffness", 500);
  test_number(e, membrane, "damping", 1e-5);
  test_tuples(e, hinges, "triangles", 3, triangle, count);
  test_number(e, hinges, "rigidity", 2e-5);
  test_number(e, hinges, "damping", 2e-8);
}

static void add_sheet(test_engine *e, cloth kind) {
  static uint32_t edge[4 * SIDE * SIDE][2], triangle[2 * SIDE * SIDE][3];
  size_t triangles = 0;
  for (int k = 0; k < SIDE * SIDE; k++)
    test_particle(e, size * (k % SIDE) / (SIDE - 1) - size / 2, size * (k / SIDE) / (SIDE - 1) - size / 2,
                  ball + 2 * thickness, 0.2 / (SIDE * SIDE));
  for (uint32_t j = 0; j + 1 < SIDE; j++)
    for (uint32_t i = 0; i + 1 < SIDE; i++) {
      uint32_t a = 1 + j * SIDE + i;
      memcpy(triangle[triangles++], (uint32_t[]){a, a + 1, a + SIDE + 1}, sizeof *triangle);
      memcpy(triangle[triangles++], (uint32_t[]){a, a + SIDE + 1, a + SIDE}, sizeof *triangle);
    }
  must(e, hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error));
  if (kind == TRIANGLES) {
    add_shell(e, triangle[0], triangles);
    return;
  }
  springs(e, "structural", (const uint32_t(*)[2])edge, join(edge, join(edge, 0, 1, 0), 0, 1), 500);
  springs(e, "shear", (const uint32_t(*)[2])edge, join(edge, join(edge, 0, 1, 1), -1, 1), 150);
  springs(e, "flexion", (const uint32_t(*)[2])edge, join(edge, join(edge, 0, 2, 0), 0, 2), 50);
}

static uint32_t ring(int i, int j) {
  if (i == 0) return SIDE * SIDE + 1;
  if (i == RINGS) return SIDE * SIDE + 2;
  return (uint32_t)(SIDE * SIDE + 3 + (i - 1) * 2 * RINGS + j % (2 * RINGS));
}

static void add_ball(test_engine *e) {
  static uint32_t triangle[4 * RINGS * RINGS][3];
  size_t triangles = 0;
  test_particle(e, 0, 0, ball, 1);
  test_particle(e, 0, 0, -ball, 1);
  for (int i = 1; i < RINGS; i++)
    for (int j = 0; j < 2 * RINGS; j++) {
      double a = pi * i / RINGS, b = pi * j / RINGS;
      test_particle(e, ball * sin(a) * cos(b), ball * sin(a) * sin(b), ball * cos(a), 1);
    }
  for (uint32_t id = SIDE * SIDE + 1; id <= e->scene->particles.n; id++) test_pin(e, HK_PIN_FIXED, id, NULL);
  for (int i = 0; i < RINGS; i++)
    for (int j = 0; j < 2 * RINGS; j++) {
      if (i > 0)
        memcpy(triangle[triangles++], (uint32_t[]){ring(i, j), ring(i + 1, j), ring(i, j + 1)}, sizeof *triangle);
      if (i + 1 < RINGS)
        memcpy(triangle[triangles++], (uint32_t[]){ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)},
               sizeof *triangle);
    }
  must(e, hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error));
}

static hk_plugin_spec *open_world(test_engine *e, hk_kind kind, cloth of, int threads) {
  test_engine_open(e);
  e->options.integrator = "leapfrog";
  e->scene->duration = 100;
  e->scene->fps = 20;
  e->scene->threads = threads;
  add_sheet(e, of);
  add_ball(e);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 0.5);
  if (kind == HK_KINDS) return NULL;
  hk_plugin_spec *contact = test_plugin(e, kind, kind == HK_FORCE ? "repulsion" : "contact");
  test_number(e, contact, "thickness", thickness);
  test_number(e, contact, "friction", 0.3);
  if (kind == HK_FORCE) {
    test_number(e, contact, "stiffness", 200);
    test_number(e, contact, "slip", 0.05);
  }
  return contact;
}

/* ---- the corrector's own times ---- */

enum { TIMES = 5 };
static const char *const time_name[TIMES] = {"seconds", "seconds_of_pairs", "seconds_of_searches",
                                             "seconds_of_narrow_phase", "seconds_of_impulses"};

static void read_times(const hk_instance *i, double out[TIMES]) {
  for (const hk_field *f = i->plugin->fields; f->name; f++)
    for (int k = 0; k < TIMES; k++)
      if (strcmp(f->name, time_name[k]) == 0) memcpy(&out[k], hk_field_in(f, i->self), sizeof *out);
}

static void print_split(const double before[TIMES], const double after[TIMES], double steps, double taken) {
  double t[TIMES];
  for (int k = 0; k < TIMES; k++) t[k] = 1e3 * (after[k] - before[k]) / steps;
  printf("; contact %2.0f %%, ms: searches %.2f, budgets %.2f, narrow phase %.2f, impulses %.2f, rest %.2f",
         100 * t[0] * steps / (1e3 * taken), t[2], t[1] - t[2], t[3], t[4], t[0] - t[1] - t[3] - t[4]);
}

static void measure(const char *name, hk_kind kind, cloth of, int threads, double until) {
  test_engine e;
  hk_plugin_spec *contact = open_world(&e, kind, of, threads);
  test_run(&e);
  for (double t = 0.1; t < until + 0.05; t += 0.1) {
    hk_summary before, after;
    double times[TIMES] = {0}, later[TIMES] = {0};
    hk_run_summary(e.run, &before);
    if (kind == HK_CORRECTOR) read_times(test_instance(&e, contact), times);
    double begin = own();
    test_advance(&e, t);
    double taken = own() - begin;
    hk_run_summary(e.run, &after);
    double steps = (double)(after.steps - before.steps);
    printf("%-9s %-9s to %.1f s: %5.0f steps, %7.3f ms a step", cloth_name[of], name, t, steps, 1e3 * taken / steps);
    if (kind == HK_CORRECTOR) {
      read_times(test_instance(&e, contact), later);
      print_split(times, later, steps, taken);
    }
    if (kind != HK_KINDS) printf("; intersections %g, least gap %.2g m", after.intersections, after.closest);
    putchar('\n');
  }
  test_engine_close(&e);
}

static bool wanted(int count, char **argument, int k, const char *name) {
  return count <= k || strcmp(argument[k], name) == 0;
}

int main(int count, char **argument) {
  static const struct {
    const char *name;
    hk_kind kind;
  } contact[] = {{"none", HK_KINDS}, {"corrector", HK_CORRECTOR}, {"force", HK_FORCE}};
  setvbuf(stdout, NULL, _IOLBF, 0);
  int threads = count > 1 ? atoi(argument[1]) : 1;
  double until = count > 2 ? atof(argument[2]) : 0.5;
  for (int of = 0; of < CLOTHS; of++)
    for (int k = 0; k < 3; k++)
      if (wanted(count, argument, 3, contact[k].name) && wanted(count, argument, 4, cloth_name[of]))
        measure(contact[k].name, contact[k].kind, (cloth)of, threads, until);
  return 0;
}
