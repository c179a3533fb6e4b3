/* Heaps under the corrector `contact` with leapfrog: 30 sheets of 12 x 12 particles and 100 of 6 x 6 that fall on each
 * other, a sheet of 200 x 200, and one of 100 x 100, on a ball, a strip in meanders that is crumpled in a box, 1,000
 * strands of 30 particles that fall across each other, and as many on a head. Of each: intersections, which have to be
 * 0, counted exactly at every frame; the time of a step, in all and for a place where something touches; and the
 * largest memory, of a process of its own. Times are those of the process, one thread. On two shared cores with 30
 * other processes, where they vary by a fifth, 0 intersections in each:
 *
 *                   particles  places that touch  ms a step  ns a place     MB
 *     6 sheets            867              4,353        5.2       1,200   12.6
 *     30 sheets         4,323             28,443       51.8       1,820   70.6
 *     100 sheets        3,603             21,850        221      10,130   51.7
 *     100 strands       3,003              3,767       29.4       7,810   28.7
 *     1,000 strands    30,003             47,469        578      12,200    286
 *     ball of 100      11,106                521        3.8       7,360   27.0
 *     ball of 200      41,106              1,855       19.6      10,600    600
 *     60 on a head      2,906                 13        1.8           -    7.7
 *     1,000 on a head  31,106             24,492      2,000      81,500    555
 *     strip in a box    3,144                276        1.2       4,460   26.1
 *
 * The squares of the sheet of 200 x 200 have sides of 5 mm: surfaces are paired up to 6 mm apart, and so the sheet with
 * itself, where that of 100 is not. Most of its memory are those pairs. Strands on a head are pressed into each other
 * by 0.29 mm of their 2 mm, fallen ones by 0.02 mm, after the sweeps that a step may take.
 *
 * Memory is in proportion to what touches. Time is not, and not by the caches: a place takes as long as it is solved
 * often. 6, 12 and 30 sheets took some 37, 48 and 96 sweeps for the positions of a step, of 100 that it may, and as
 * many for the velocities: what bears the weight is told from layer to layer. Where strands were measured whose edges
 * did not meet, as spheres on springs, 100, 400 and 1,000 of them took 29.7, 28.8 and 28.7 ns for one look at an
 * impact, but 82, 123 and 138 looks a place, and 31,600 and 671,000 pairs of patches for 100 and for 1,000: strands of
 * a small heap lie near all others.
 *
 *     build/bench/heaps [short] [NAME]     short: the same heaps, smaller, in less than 20 s
 *
 * It ends with 1 where a surface has passed through another one. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846, apart = 6e-3, radius = 1e-3;

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void must(test_engine *e, hk_status status) {
  if (status == HK_OK) return;
  fprintf(stderr, "heaps: %s\n", e->error.text);
  exit(2);
}

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "heaps: no memory for %zu numbers: close other programs\n", count);
  exit(2);
}

/* ---- bodies ---- */

static void spring_list(test_engine *e, const char *label, const uint32_t (*edge)[2], size_t count, double k) {
  hk_plugin_spec *spec;
  must(e, hk_scene_add_plugin(e->scene, HK_FORCE, "springs", label, NULL, &spec, &e->error));
  test_edges(e, spec, edge, count);
  test_number(e, spec, "k", k);
  test_number(e, spec, "damping", 1e-4 * k);
}

/* A sheet of nx x ny particles, 0.2 kg/m^2 for squares of this side, whose places follow from `at`. */
typedef struct sheet_shape {
  uint32_t nx, ny;
  double side; /* m */
  void (*at)(const struct sheet_shape *, uint32_t i, uint32_t j, double x[3]);
  double place[3], turn; /* m; rad */
} sheet_shape;

/* The particle (i, j) of a sheet whose first id is one more than `before`. */
static uint32_t node(const sheet_shape *s, uint32_t before, uint32_t i, uint32_t j) {
  return before + 1 + j * s->nx + i;
}

static void add_sheet(test_engine *e, const sheet_shape *s) {
  size_t n = (size_t)s->nx * s->ny, edges = 0, triangles = 0;
  uint32_t before = (uint32_t)e->scene->particles.n, (*edge)[2] = memory(6 * n, sizeof *edge),
           (*triangle)[3] = memory(2 * n, sizeof *triangle);
  char label[32];
  for (uint32_t j = 0; j < s->ny; j++)
    for (uint32_t i = 0; i < s->nx; i++) {
      double x[3];
      s->at(s, i, j, x);
      test_particle(e, x[0], x[1], x[2], 0.2 * s->side * s->side);
    }
  for (uint32_t j = 0; j < s->ny; j++)
    for (uint32_t i = 0; i < s->nx; i++) {
      uint32_t here = node(s, before, i, j);
      if (i) memcpy(edge[edges++], (uint32_t[]){here - 1, here}, sizeof *edge);
      if (j) memcpy(edge[edges++], (uint32_t[]){here - s->nx, here}, sizeof *edge);
      if (i > 1) memcpy(edge[edges++], (uint32_t[]){here - 2, here}, sizeof *edge);
      if (j > 1) memcpy(edge[edges++], (uint32_t[]){here - 2 * s->nx, here}, sizeof *edge);
      if (!i || !j) continue;
      memcpy(edge[edges++], (uint32_t[]){here - s->nx - 1, here}, sizeof *edge);
      memcpy(edge[edges++], (uint32_t[]){here - s->nx, here - 1}, sizeof *edge);
      memcpy(triangle[triangles++], (uint32_t[]){here - s->nx - 1, here - s->nx, here}, sizeof *triangle);
      memcpy(triangle[triangles++], (uint32_t[]){here - s->nx - 1, here, here - 1}, sizeof *triangle);
    }
  must(e, hk_scene_add_triangles(e->scene, triangles, (const uint32_t(*)[3])triangle, &e->error));
  snprintf(label, sizeof label, "sheet at %u", before + 1);
  spring_list(e, label, (const uint32_t(*)[2])edge, edges, 200);
  free(edge), free(triangle);
}

/* Pinned corners and triangles of them. */
static void add_fixed(test_engine *e, size_t corners, const double (*x)[3], size_t count, const uint32_t (*of)[3]) {
  uint32_t before = (uint32_t)e->scene->particles.n + 1, (*triangle)[3] = memory(count, sizeof *triangle);
  for (size_t k = 0; k < corners; k++) test_pin(e, HK_PIN_FIXED, test_particle(e, x[k][0], x[k][1], x[k][2], 1), NULL);
  for (size_t k = 0; k < 3 * count; k++) triangle[k / 3][k % 3] = before + of[k / 3][k % 3];
  must(e, hk_scene_add_triangles(e->scene, count, (const uint32_t(*)[3])triangle, &e->error));
  free(triangle);
}

static void add_floor(test_engine *e) {
  static const double x[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 16, 0}};
  add_fixed(e, 3, x, 1, (const uint32_t[][3]){{0, 1, 2}});
}

/* Open above: floor and four walls of 0.3 m around 2 w x 2 w. */
static void add_box(test_engine *e, double w) {
  double x[8][3];
  for (int k = 0; k < 8; k++) {
    x[k][0] = (k & 3) == 1 || (k & 3) == 2 ? w : -w;
    x[k][1] = (k & 3) > 1 ? w : -w;
    x[k][2] = k < 4 ? 0 : 0.3;
  }
  static const uint32_t of[10][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 5}, {0, 5, 4}, {1, 2, 6},
                                     {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  add_fixed(e, 8, (const double(*)[3])x, 10, of);
}

/* A ball at the origin of rings x 2 rings points, its poles among them once for each meridian. */
static void add_ball(test_engine *e, double r) {
  enum { RINGS = 24, ROUND = 2 * RINGS };
  static double x[2 + (RINGS - 1) * ROUND][3];
  static uint32_t of[2 * RINGS * ROUND][3];
  size_t count = 0;
  x[0][2] = r, x[1][2] = -r;
  for (int i = 1; i < RINGS; i++)
    for (int j = 0; j < ROUND; j++) {
      double a = pi * i / RINGS, b = 2 * pi * j / ROUND, *p = x[2 + (i - 1) * ROUND + j];
      p[0] = r * sin(a) * cos(b), p[1] = r * sin(a) * sin(b), p[2] = r * cos(a);
    }
  for (uint32_t i = 0; i < RINGS; i++)
    for (uint32_t j = 0; j < ROUND; j++) {
      uint32_t k = (j + 1) % ROUND, up = 2 + (i - 1) * ROUND, down = 2 + i * ROUND;
      if (i > 0) memcpy(of[count++], (uint32_t[]){up + j, i + 1 < RINGS ? down + j : 1, up + k}, sizeof *of);
      if (i + 1 < RINGS) memcpy(of[count++], (uint32_t[]){i > 0 ? up + k : 0, down + j, down + k}, sizeof *of);
    }
  add_fixed(e, sizeof x / sizeof *x, (const double(*)[3])x, count, (const uint32_t(*)[3])of);
}

/* ---- places ---- */

static void at_flat(const sheet_shape *s, uint32_t i, uint32_t j, double x[3]) {
  double a = s->side * (i - (s->nx - 1) / 2.), b = s->side * (j - (s->ny - 1) / 2.), c = cos(s->turn), d = sin(s->turn);
  x[0] = s->place[0] + c * a - d * b, x[1] = s->place[1] + d * a + c * b, x[2] = s->place[2];
}

/* Along x in meanders, whose angle is 1.7 rad at most, five to the strip's length: the direction of an elastic line. */
static void at_meander(const sheet_shape *s, uint32_t i, uint32_t j, double x[3]) {
  double along = 0, up = 0;
  for (uint32_t k = 0; k < i; k++) {
    double angle = 1.7 * cos(10 * pi * (k + 0.5) / (s->nx - 1));
    along += s->side * cos(angle), up += s->side * sin(angle);
  }
  x[0] = s->place[0] + along, x[1] = s->place[1] + s->side * (j - (s->ny - 1) / 2.) + 0.02 * sin(40 * up);
  x[2] = s->place[2] + up;
}

/* ---- heaps ---- */

typedef struct heap {
  const char *name;
  void (*build)(test_engine *, int size);
  int size, small;  /* of the whole form and of the short one */
  double until[2];  /* s, of both */
  double thickness; /* m */
} heap;

/* Sheets of n x n particles, each turned and moved against the one below. */
static void lay(test_engine *e, int sheets, uint32_t n) {
  for (int k = 1; k <= sheets; k++)
    add_sheet(e, &(sheet_shape){n, n, 0.02, at_flat, {0.003 * (k % 3), 0.002 * (k % 5), apart * k}, 0.16 * k});
  add_floor(e);
}

static void build_layers(test_engine *e, int size) { lay(e, size, 12); }

static void build_tower(test_engine *e, int size) { lay(e, size, 6); }

static void build_ball(test_engine *e, int size) {
  add_sheet(e, &(sheet_shape){(uint32_t)size, (uint32_t)size, 1. / (size - 1), at_flat, {0, 0, 0.25 + apart}, 0});
  add_ball(e, 0.25);
}

static void build_crumple(test_engine *e, int size) {
  uint32_t n = (uint32_t)size;
  add_sheet(e, &(sheet_shape){4 * n, n, 0.25 / n, at_meander, {-0.2, 0, 0.15}, 0});
  add_box(e, 0.23);
}

/* `count` strands of OF particles each, the last ones: their edges, which meet others, and springs along these and to
 * the next but one. */
enum { OF = 30 };

static void join_strands(test_engine *e, int count) {
  size_t strands = (size_t)count, edges = 0, springs = 0;
  uint32_t(*edge)[2] = memory(OF * strands, sizeof *edge), (*spring)[2] = memory(2 * OF * strands, sizeof *spring);
  uint32_t first = (uint32_t)(e->scene->particles.n - OF * strands) + 1;
  for (uint32_t k = 0; k < OF * strands; k++) {
    uint32_t id = first + k;
    if (k % OF > 0) memcpy(edge[edges++], (uint32_t[]){id - 1, id}, sizeof *edge);
    if (k % OF > 0) memcpy(spring[springs++], (uint32_t[]){id - 1, id}, sizeof *spring);
    if (k % OF > 1) memcpy(spring[springs++], (uint32_t[]){id - 2, id}, sizeof *spring);
  }
  must(e, hk_scene_add_edges(e->scene, edges, (const uint32_t(*)[2])edge, &e->error));
  spring_list(e, "strands", (const uint32_t(*)[2])spring, springs, 20);
  free(edge), free(spring);
}

/* Layers of parallel strands, each across the one below, 20 layers of a twentieth of the strands. */
static void build_strands(test_engine *e, int size) {
  enum { LAYERS = 20 };
  for (int k = 0; k < size; k++) {
    int layer = k % LAYERS, row = k / LAYERS;
    double angle = 0.5 * pi * layer + 0.1 * sin(layer), across = 0.006 * (row - 0.5 * (size / LAYERS - 1.));
    for (int i = 0; i < OF; i++) {
      double along = 0.01 * (i - (OF - 1) / 2.);
      test_particle(e, cos(angle) * along - sin(angle) * across, sin(angle) * along + cos(angle) * across,
                    0.01 + 3 * radius * layer, 5e-5);
    }
  }
  join_strands(e, size);
  add_floor(e);
}

/* Strands that stand out from the upper half of a head, evenly (Fibonacci's spiral), and fall over it and each other.
 * Their first two particles are pinned. */
static void build_hair(test_engine *e, int size) {
  const double r = 0.1, golden = pi * (3 - sqrt(5));
  for (int k = 0; k < size; k++) {
    double z = 1 - (k + 0.5) / size, across = sqrt(1 - z * z), angle = golden * k;
    for (int i = 0; i < OF; i++) {
      double far = r + 4e-3 + 0.01 * i;
      uint32_t id = test_particle(e, far * across * cos(angle), far * across * sin(angle), far * z, 5e-5);
      if (i < 2) test_pin(e, HK_PIN_FIXED, id, NULL);
    }
  }
  join_strands(e, size);
  add_ball(e, r);
}

static const heap heaps[] = {
    {"30 layers", build_layers, 30, 6, {0.2, 0.2}, 4e-3},      {"100 layers", build_tower, 100, 12, {0.25, 0.2}, 4e-3},
    {"ball", build_ball, 200, 50, {0.2, 0.2}, 3e-3},           {"ball of 100", build_ball, 100, 30, {0.2, 0.2}, 3e-3},
    {"crumple", build_crumple, 28, 14, {0.6, 0.25}, 4e-3},     {"hair", build_hair, 1000, 60, {0.4, 0.3}, 4e-3},
    {"strands", build_strands, 1000, 100, {0.15, 0.15}, 4e-3},
};

/* ---- measuring ---- */

static void count_point(void *context, const double x[3], const double n[3]) {
  (void)x, (void)n;
  ++*(size_t *)context;
}

static size_t touching(test_engine *e, const hk_plugin_spec *spec) {
  hk_instance *instance = test_instance(e, spec);
  hk_view view = hk_instance_view(instance, &e->run->state.view);
  size_t count = 0;
  instance->plugin->corrector->contact_points(instance->self, &view, &(hk_contact_points){&count, count_point});
  return count;
}

static hk_plugin_spec *open_heap(test_engine *e, const heap *h, bool brief) {
  test_engine_open(e);
  e->options.integrator = "leapfrog";
  e->scene->duration = 100;
  e->scene->fps = 20;
  e->scene->threads = 1;
  h->build(e, brief ? h->small : h->size);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  test_number(e, test_plugin(e, HK_FORCE, "drag"), "rate", 1);
  hk_plugin_spec *contact = test_plugin(e, HK_CORRECTOR, "contact");
  test_number(e, contact, "thickness", h->thickness);
  test_number(e, contact, "radius", radius);
  test_number(e, contact, "friction", 0.3);
  test_run(e);
  return contact;
}

/* 1: a surface has passed through another one. The last fifth of the time is measured, when the heap is one. */
static int measure(const heap *h, bool brief) {
  test_engine e;
  hk_summary before, after;
  hk_plugin_spec *contact = open_heap(&e, h, brief);
  double until = h->until[brief];
  test_advance(&e, 0.8 * until);
  hk_run_summary(e.run, &before);
  double begin = own();
  test_advance(&e, until);
  double taken = own() - begin;
  hk_run_summary(e.run, &after);
  double steps = (double)(after.steps - before.steps);
  size_t places = touching(&e, contact), n = e.scene->particles.n;
  struct rusage used;
  getrusage(RUSAGE_SELF, &used);
  printf("%-11s %6zu particles, %6zu places touch; %7.3f ms a step, %6.0f ns a particle, %6.0f ns a place; %6.1f MB, "
         "%5.0f bytes a particle; %g intersections, least gap %.2g m, %g s in all\n",
         h->name, n, places, 1e3 * taken / steps, 1e9 * taken / steps / (double)n,
         1e9 * taken / steps / (double)(places ? places : 1), (double)used.ru_maxrss / 1024,
         1024. * (double)used.ru_maxrss / (double)n, after.intersections, after.closest, round(10 * own()) / 10);
  test_engine_close(&e);
  return after.intersections > 0;
}

/* In a process of its own, for its memory. */
static int measure_apart(const heap *h, bool brief) {
  int code = 2;
  fflush(stdout);
  pid_t child = fork();
  if (child == 0) {
    code = measure(h, brief);
    fflush(stdout);
    _exit(code);
  }
  if (child < 0 || waitpid(child, &code, 0) != child || !WIFEXITED(code)) {
    fprintf(stderr, "heaps: %s did not come to its end\n", h->name);
    return 2;
  }
  return WEXITSTATUS(code);
}

int main(int count, char **argument) {
  bool brief = count > 1 && strcmp(argument[1], "short") == 0;
  const char *name = count > 1 + brief ? argument[1 + brief] : NULL;
  int worst = 0;
  for (size_t k = 0; k < sizeof heaps / sizeof *heaps; k++) {
    if (name && strcmp(name, heaps[k].name) != 0) continue;
    int code = measure_apart(&heaps[k], brief);
    worst = code > worst ? code : worst;
  }
  return worst;
}
