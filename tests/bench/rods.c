/* What a force evaluation of rods costs per particle: 1,000 strands of 32 edges, straight and curled, on one thread.
 * The least of several repeats, taken in turn. */
#include "core/engine/contract/contract.h"
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { STRANDS = 1000, EDGES = 32, NODES = EDGES + 1, REPEATS = 40 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct subject {
  const char *name;
  const char *rest;
  double EI2, curvature;
  double moved; /* m, about, since the last accepted step */
  test_engine e;
  hk_instance *rods;
  hk_view view;
  double *x, *F, least;
} subject;

static void place(test_engine *e, uint32_t (*edge)[2]) {
  for (uint32_t s = 0; s < STRANDS; s++)
    for (uint32_t k = 0; k < NODES; k++) {
      double a = 0.4 * k + s, r = 0.01;
      uint32_t id = test_particle(e, r * cos(a) + 0.05 * (s % 32), r * sin(a) + 0.05 * (s / 32), -0.008 * k, 1e-6);
      if (k > 0) edge[EDGES * s + k - 1][0] = id - 1, edge[EDGES * s + k - 1][1] = id;
      if (k < 2) test_pin(e, HK_PIN_FIXED, id, NULL);
    }
}

static void open_subject(subject *s) {
  uint32_t(*edge)[2] = malloc(STRANDS * EDGES * sizeof *edge);
  test_engine_open(&s->e);
  place(&s->e, edge);
  hk_plugin_spec *spec = test_plugin(&s->e, HK_FORCE, "rods");
  test_edges(&s->e, spec, (const uint32_t(*)[2])edge, STRANDS * EDGES);
  test_number(&s->e, spec, "EI", 1e-9);
  test_number(&s->e, spec, "GJ", 7e-10);
  if (s->rest) test_text(&s->e, spec, "rest", s->rest);
  if (s->EI2 > 0) test_number(&s->e, spec, "EI2", s->EI2);
  if (s->curvature != 0) test_number(&s->e, spec, "curvature", s->curvature);
  s->e.options.dt = 1e-5;
  s->e.options.threads = 1;
  test_run(&s->e);
  s->rods = test_instance(&s->e, spec);
  s->view = *hk_run_view(s->e.run);
  s->view.host = &s->rods->host;
  s->x = malloc(3 * s->view.n * sizeof *s->x);
  s->F = calloc(3 * s->view.n, sizeof *s->F);
  memcpy(s->x, s->view.x, 3 * s->view.n * sizeof *s->x);
  if (hk_force_of(s->rods->plugin)->steps.accepted(s->rods->self, &s->view, 1e-5) != HK_OK) exit(1);
  for (size_t k = 0; k < 3 * s->view.n; k++) s->x[k] += s->moved * sin((double)k);
  s->view.x = s->x;
  s->least = INFINITY;
  free(edge);
}

int main(void) {
  static subject all[] = {{"straight at rest", "straight", 0, 0, 0, .least = 0},
                          {"curled, where it was accepted", "initial", 0, 0, 0, .least = 0},
                          {"curled, moved by 1e-5 m", "initial", 0, 0, 1e-5, .least = 0},
                          {"curled, moved by 1e-4 m", "initial", 0, 0, 1e-4, .least = 0},
                          {"ribbons, moved by 1e-5 m", "initial", 2e-9, 0, 1e-5, .least = 0},
                          {"given curvature, moved by 1e-5 m", NULL, 0, 50, 1e-5, .least = 0}};
  enum { SUBJECTS = sizeof all / sizeof *all };
  for (int k = 0; k < SUBJECTS; k++) open_subject(&all[k]);
  for (int round = 0; round < REPEATS; round++)
    for (int k = 0; k < SUBJECTS; k++) {
      subject *s = &all[k];
      double start = now();
      for (int q = 0; q < 3; q++)
        if (s->rods->plugin->force->add(s->rods->self, &s->view, s->F) != HK_OK) return 1;
      s->least = fmin(s->least, (now() - start) / 3);
    }
  printf("%d strands of %d edges, one thread, ns per particle and evaluation of the force:\n", STRANDS, EDGES);
  for (int k = 0; k < SUBJECTS; k++) {
    printf("  %-34s %6.1f\n", all[k].name, 1e9 * all[k].least / (STRANDS * NODES));
    test_engine_close(&all[k].e);
  }
  return 0;
}
