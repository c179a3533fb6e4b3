#include "tests/support/surface_scenes.h"

#include "core/engine/base/base.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static void *memory(size_t count, size_t size) {
  void *p = calloc(count + 1, size);
  if (p) return p;
  fprintf(stderr, "no memory for %zu numbers: close other programs\n", count);
  exit(1);
}

static void reserve(test_surfaces *s, size_t room) {
  s->room = room;
  s->x = memory(3 * room, sizeof *s->x);
  s->mass = memory(room, sizeof *s->mass);
  s->inverse_mass = memory(room, sizeof *s->inverse_mass);
  s->id = memory(room, sizeof *s->id);
  s->triangle = memory(12 * room, sizeof *s->triangle);
  s->edge = memory(8 * room, sizeof *s->edge);
  s->left = memory(room, sizeof *s->left);
}

test_surfaces *test_surfaces_open(int threads, uint64_t seed, size_t room) {
  test_surfaces *s = memory(1, sizeof *s);
  reserve(s, room);
  s->plugin.kind = HK_SERVICE;
  s->shared = (hk_shared){
      .error = &s->error, .threads = hk_threads_create(threads), .allocations_left = -1, .lanes = hk_processor_lanes()};
  assert_non_null(s->shared.threads);
  s->instance = (hk_instance){
      .host = hk_host_table, .shared = &s->shared, .plugin = &s->plugin, .label = "surfaces", .where = ""};
  s->model = (hk_model){.mass = s->mass,
                        .inverse_mass = s->inverse_mass,
                        .id = s->id,
                        .edges = {0, 2, s->edge},
                        .triangles = {0, 3, s->triangle}};
  s->view = (hk_view){.x = s->x, .model = &s->model, .host = &s->instance.host};
  s->request = (hk_surface_request){.thickness = 0.01, .body_thickness = 0.02, .radius = 0.004};
  s->pairs.record_size = sizeof(hk_feature_pair);
  s->crossings.record_size = 2 * sizeof(uint32_t);
  hk_random_seed(s->seed, seed);
  return s;
}

void test_surfaces_close(test_surfaces *s) {
  const hk_host *host = &s->instance.host;
  hk_broad_phase_free(&s->search, host);
  hk_surface_lists_free(&s->lists, host);
  hk_gather_free(&s->pairs, host);
  hk_gather_free(&s->crossings, host);
  assert_null(s->instance.blocks);
  hk_threads_destroy(s->shared.threads);
  void *memory_of[] = {s->x, s->mass, s->inverse_mass, s->id, s->triangle, s->edge, s->left, s};
  for (size_t k = 0; k < sizeof memory_of / sizeof *memory_of; k++) free(memory_of[k]);
}

const hk_host *test_surfaces_host(test_surfaces *s) { return &s->instance.host; }

double test_uniform(test_surfaces *s, double low, double high) {
  return low + (high - low) * hk_random_uniform(s->seed);
}

uint32_t test_surfaces_particle(test_surfaces *s, double x, double y, double z) {
  size_t i = s->model.n++;
  assert_true(i < s->room);
  s->view.n = s->view.acting = s->model.n;
  s->x[3 * i] = x, s->x[3 * i + 1] = y, s->x[3 * i + 2] = z;
  s->mass[i] = s->inverse_mass[i] = 1;
  s->id[i] = (uint32_t)i + 1;
  return (uint32_t)i;
}

void test_surfaces_triangle(test_surfaces *s, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *t = s->triangle + 3 * s->model.triangles.count++;
  assert_true(s->model.triangles.count <= 4 * s->room);
  t[0] = a, t[1] = b, t[2] = c;
}

void test_surfaces_edge(test_surfaces *s, uint32_t a, uint32_t b) {
  uint32_t *e = s->edge + 2 * s->model.edges.count++;
  assert_true(s->model.edges.count <= 4 * s->room);
  e[0] = a, e[1] = b;
}

void test_surfaces_hold(test_surfaces *s, uint32_t i) { s->inverse_mass[i] = 0; }

uint32_t test_surfaces_sheet(test_surfaces *s, unsigned n, const double origin[3]) {
  uint32_t first = (uint32_t)s->model.n, row = n + 1;
  for (unsigned j = 0; j <= n; j++)
    for (unsigned i = 0; i <= n; i++)
      test_surfaces_particle(s, origin[0] + (double)i / n, origin[1] + (double)j / n, origin[2]);
  for (unsigned j = 0; j < n; j++)
    for (unsigned i = 0; i < n; i++) {
      uint32_t at = first + j * row + i;
      test_surfaces_triangle(s, at, at + 1, at + row);
      test_surfaces_triangle(s, at + 1, at + row + 1, at + row);
      test_surfaces_edge(s, at, at + 1);
    }
  return first;
}

void test_surfaces_strand(test_surfaces *s, unsigned edges, const double from[3], const double step[3]) {
  for (unsigned k = 0; k <= edges; k++) {
    uint32_t i = test_surfaces_particle(s, from[0] + k * step[0], from[1] + k * step[1], from[2] + k * step[2]);
    if (k) test_surfaces_edge(s, i, i - 1);
  }
}

void test_surfaces_list(test_surfaces *s) {
  const hk_host *host = &s->instance.host;
  if (hk_surface_lists_build(&s->lists, host, &s->view, &s->request, s->left) != HK_OK ||
      hk_broad_phase_open(&s->search, host, &s->lists, &s->model) != HK_OK)
    fail_msg("%s", s->error.text);
}
