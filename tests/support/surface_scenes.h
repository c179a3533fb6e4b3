/* Surfaces for tests, without an engine: a model made by hand, and a host with as many threads as wanted. */
#ifndef HK_TEST_SURFACE_SCENES_H
#define HK_TEST_SURFACE_SCENES_H

#include "core/engine/host/host.h"
#include "plugins/common/contact/candidates/feature_pairs.h"

typedef struct test_surfaces {
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error;
  hk_model model;
  hk_view view;
  size_t room; /* particles that fit; four times as many triangles and edges do */
  double *x, *mass, *inverse_mass;
  uint32_t *id, *triangle, *edge;
  bool *left;
  uint64_t seed[4];
  hk_surface_request request;
  hk_surface_lists lists;
  hk_broad_phase search;
  hk_gather pairs, crossings;
} test_surfaces;

test_surfaces *test_surfaces_open(int threads, uint64_t seed, size_t room);
void test_surfaces_close(test_surfaces *);
const hk_host *test_surfaces_host(test_surfaces *);
double test_uniform(test_surfaces *, double low, double high);
uint32_t test_surfaces_particle(test_surfaces *, double x, double y, double z); /* 1 kg, free; returns its index */
void test_surfaces_triangle(test_surfaces *, uint32_t a, uint32_t b, uint32_t c);
void test_surfaces_edge(test_surfaces *, uint32_t a, uint32_t b);
void test_surfaces_hold(test_surfaces *, uint32_t i); /* pinned */
/* A square of side 1 in the plane z = 0, moved to `origin`, of n x n cells; the index of its first particle. */
uint32_t test_surfaces_sheet(test_surfaces *, unsigned n, const double origin[3]);
void test_surfaces_strand(test_surfaces *, unsigned edges, const double from[3], const double step[3]);
/* Builds the lists and opens the search; fails the test when that cannot be. */
void test_surfaces_list(test_surfaces *);

#endif
