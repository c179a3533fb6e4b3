/* What forces and Jacobians of a cloth of triangles cost per triangle: a membrane of each energy, and hinges, on 100 x
 * 100 cells of alternating diagonals, with damping and without, on one thread. The least of several repeats, taken in
 * turn. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"
#include "tests/support/sheets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CELLS = 100, TRIANGLES = 2 * CELLS * CELLS, REPEATS = 30 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct subject {
  const char *name, *force, *model;
  double damping;
  unsigned want; /* of the Jacobian */
  test_engine e;
  hk_instance *instance;
  hk_view view;
  double *x, *v, *F, *K, *D, force_least, blocks_least;
  size_t *slot;
} subject;

/* Slots as the host gives them: one for each pair of particles, in the order of rows. */
typedef struct names {
  hk_pattern pattern; /* first member */
  size_t count;
  uint64_t *pair;
} names;

static void name(hk_pattern *pattern, uint32_t row, uint32_t column) {
  names *list = (names *)(void *)pattern;
  list->pair[list->count++] = (uint64_t)row << 32 | column;
}

static int compare(const void *a, const void *b) {
  uint64_t p = *(const uint64_t *)a, q = *(const uint64_t *)b;
  return (p > q) - (p < q);
}

static void make_slots(subject *s) {
  names list = {.pattern = {name}, .pair = malloc(40 * TRIANGLES * sizeof *list.pair)};
  hk_force_of(s->instance->plugin)->implicit.pattern(s->instance->self, &s->view, &list.pattern);
  uint64_t *sorted = malloc(list.count * sizeof *sorted);
  size_t kept = 0;
  memcpy(sorted, list.pair, list.count * sizeof *sorted);
  qsort(sorted, list.count, sizeof *sorted, compare);
  for (size_t k = 0; k < list.count; k++)
    if (kept == 0 || sorted[k] != sorted[kept - 1]) sorted[kept++] = sorted[k];
  s->slot = malloc(list.count * sizeof *s->slot);
  for (size_t k = 0; k < list.count; k++)
    s->slot[k] = (size_t)((uint64_t *)bsearch(&list.pair[k], sorted, kept, sizeof *sorted, compare) - sorted);
  s->K = calloc(9 * kept, sizeof *s->K), s->D = calloc(9 * kept, sizeof *s->D);
  free(sorted);
  free(list.pair);
}

static void open_subject(subject *s) {
  sheet cloth = sheet_make(SHEET_ALTERNATING, CELLS, (double[]){0, 0, 0});
  test_engine_open(&s->e);
  hk_plugin_spec *spec = sheet_add(&s->e, &cloth, s->force);
  if (s->model) test_text(&s->e, spec, "model", s->model);
  if (s->model && strcmp(s->model, "baraff_witkin") != 0) test_number(&s->e, spec, "nu", 0.3);
  test_number(&s->e, spec, s->model ? "stiffness" : "rigidity", 1);
  test_number(&s->e, spec, "damping", s->damping);
  s->e.options.dt = 1e-5;
  s->e.options.threads = 1;
  test_run(&s->e);
  s->instance = test_instance(&s->e, spec);
  s->view = *hk_run_view(s->e.run);
  s->view.host = &s->instance->host;
  size_t size = 3 * s->view.n;
  s->x = malloc(size * sizeof *s->x), s->v = malloc(size * sizeof *s->v), s->F = calloc(size, sizeof *s->F);
  for (size_t k = 0; k < size; k++) {
    s->x[k] = s->view.x[k] + 0.1 / CELLS * sin((double)(k * k % 1001));
    s->v[k] = cos((double)k);
  }
  s->view.x = s->x, s->view.v = s->v;
  make_slots(s);
  s->force_least = s->blocks_least = INFINITY;
  sheet_free(&cloth);
}

static void measure(subject *s) {
  const hk_force_tables *force = hk_force_of(s->instance->plugin);
  hk_blocks into = {.slot = s->slot, .K = s->K, .D = s->D, .want = s->want};
  double start = now();
  for (int q = 0; q < 5; q++)
    if (force->own.add(s->instance->self, &s->view, s->F) != HK_OK) exit(1);
  double middle = now();
  if (force->implicit.jacobian(s->instance->self, &s->view, &into) != HK_OK) exit(1);
  s->force_least = fmin(s->force_least, (middle - start) / 5);
  s->blocks_least = fmin(s->blocks_least, now() - middle);
}

int main(void) {
  static subject all[] = {{"baraff_witkin", "membrane", "baraff_witkin", 0, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"baraff_witkin, damped", "membrane", "baraff_witkin", 0.01, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"baraff_witkin, definite", "membrane", "baraff_witkin", 0, HK_WANT_DEFINITE, .slot = NULL},
                          {"stvk", "membrane", "stvk", 0, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"stvk, damped, definite", "membrane", "stvk", 0.01, HK_WANT_DEFINITE, .slot = NULL},
                          {"neo_hookean", "membrane", "neo_hookean", 0, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"neo_hookean, definite", "membrane", "neo_hookean", 0, HK_WANT_DEFINITE, .slot = NULL},
                          {"hinges", "hinges", NULL, 0, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"hinges, damped", "hinges", NULL, 0.01, HK_WANT_SYMMETRIC, .slot = NULL},
                          {"hinges, definite", "hinges", NULL, 0, HK_WANT_DEFINITE, .slot = NULL}};
  enum { SUBJECTS = sizeof all / sizeof *all };
  for (int k = 0; k < SUBJECTS; k++) open_subject(&all[k]);
  for (int round = 0; round < REPEATS; round++)
    for (int k = 0; k < SUBJECTS; k++) measure(&all[k]);
  printf("%d triangles, one thread, ns per triangle:\n  %-34s %8s %8s\n", TRIANGLES, "", "force", "Jacobian");
  for (int k = 0; k < SUBJECTS; k++) {
    printf("  %-34s %8.1f %8.1f\n", all[k].name, 1e9 * all[k].force_least / TRIANGLES,
           1e9 * all[k].blocks_least / TRIANGLES);
    test_engine_close(&all[k].e);
  }
  double force = 1e9 * (all[0].force_least + all[7].force_least) / TRIANGLES;
  double blocks = 1e9 * (all[0].blocks_least + all[7].blocks_least) / TRIANGLES;
  printf("membrane and hinges: %.1f (at most 45), Jacobian %.1f (at most 250)\n", force, blocks);
  return 0;
}
