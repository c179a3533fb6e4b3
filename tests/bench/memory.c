/* What a scene takes until its first step: resident memory at its peak, and processor time from the start of the
 * process, for cloth of many sizes, for an unstructured mesh of 260,000 triangles with its ids at random, and for edges
 * that a script lists by hand. One step is taken, with one thread. */
#include "tests/support/command.h"
#include "tests/support/resources.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

static const char cloth[] = HK_ROOT "/scripts/scenes/cloth.lua";

static const char by_hand[] =
    "local N = param('N', 256, 'particles along one side')\n"
    "local scene = hooke.scene { duration = 2, fps = 60, integrator = 'leapfrog' }\n"
    "for k = 0, N * N - 1 do scene:particle { position = { k % N / N, k // N / N, 0 }, mass = 1e-6 } end\n"
    "local edges = {}\n"
    "for k = 1, N * N do\n"
    "  if k % N ~= 0 then edges[#edges + 1] = { k, k + 1 } end\n"
    "  if k <= N * (N - 1) then edges[#edges + 1] = { k, k + N } end\n"
    "end\n"
    "scene:force('springs', { edges = edges, k = 1000, damping = 0.02 })\n"
    "return scene\n";

static const char of_mesh[] =
    "local scene = hooke.scene { duration = 2, fps = 60, integrator = 'leapfrog' }\n"
    "local m = scene:mesh { file = 'mesh.obj', mass = 0.15 }\n"
    "scene:force('springs', { edges = m:edges(), k = 1000, damping = 0.02 })\n"
    "scene:force('springs', { edges = m:flexion(), k = 50, damping = 0.005, label = 'flexion' })\n"
    "return scene\n";

static void print_row(const char *name, const char *scene, const char *parameter, double particles, double springs) {
  const char *arguments[] = {scene, parameter, "--no-output", "--quiet", "--until", "1e-6", "--threads", "1", NULL};
  test_resources least = {.bytes = 1e300, .seconds = 1e300};
  for (int again = 0; again < 3; again++) {
    test_resources r = test_resources_of(arguments);
    if (r.code != 0) fprintf(stderr, "%s: exit %d\n", name, r.code);
    if (r.bytes < least.bytes) least.bytes = r.bytes;
    if (r.seconds < least.seconds) least.seconds = r.seconds;
  }
  printf("%-24s %8.0f %9.0f   %7.1f   %6.1f   %6.2f   %6.2f\n", name, particles, springs, 1e-6 * least.bytes,
         least.bytes / springs, least.seconds, 1e6 * least.seconds / springs);
  fflush(stdout);
}

/* Numerical Recipes' linear congruential generator: the mesh is the same everywhere. */
static uint32_t next(uint32_t *seed) { return *seed = 1664525 * *seed + 1013904223; }

static double jitter(uint32_t *seed) { return ((double)next(seed) / UINT32_MAX - 0.5) / 2; }

static void shuffle(uint32_t *list, uint32_t count, uint32_t *seed) {
  for (uint32_t k = count - 1; k > 0; k--) {
    uint32_t j = (uint32_t)((uint64_t)next(seed) * (k + 1) >> 32), kept = list[k];
    list[k] = list[j];
    list[j] = kept;
  }
}

/* A grid whose points are moved by up to a quarter of their distance, with diagonals either way: points and triangles
 * are written in random order. */
static void write_mesh(uint32_t side) {
  uint32_t seed = 1, points = side * side, cells = (side - 1) * (side - 1);
  uint32_t *point = malloc(points * sizeof *point), *id = malloc(points * sizeof *id),
           *cell = malloc(cells * sizeof *cell);
  const char *path = test_write("mesh.obj", "");
  FILE *file = fopen(path, "w");
  if (!point || !id || !cell || !file) exit(1);
  for (uint32_t k = 0; k < points; k++) point[k] = k;
  for (uint32_t k = 0; k < cells; k++) cell[k] = k;
  shuffle(point, points, &seed);
  shuffle(cell, cells, &seed);
  for (uint32_t k = 0; k < points; k++) {
    id[point[k]] = k + 1;
    fprintf(file, "v %.9g %.9g 0\n", (point[k] % side + jitter(&seed)) / side,
            (point[k] / side + jitter(&seed)) / side);
  }
  for (uint32_t k = 0; k < cells; k++) {
    uint32_t a = cell[k] / (side - 1) * side + cell[k] % (side - 1), b = a + 1, c = a + side, d = c + 1;
    bool other = next(&seed) >> 31;
    fprintf(file, "f %u %u %u\n", id[a], id[b], id[other ? c : d]);
    fprintf(file, "f %u %u %u\n", id[other ? b : a], id[d], id[c]);
  }
  fclose(file);
  free(point);
  free(id);
  free(cell);
}

int main(void) {
  printf("scene                    particles  springs        MB  B/spring   CPU s   s per million springs\n");
  for (int side = 64; side <= 1024; side *= 2) {
    char name[32], parameter[32];
    snprintf(name, sizeof name, "cloth %d x %d", side, side);
    snprintf(parameter, sizeof parameter, "N=%d", side);
    double n = side, springs = 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + 2 * n * (n - 2);
    print_row(name, cloth, parameter, n * n, springs);
  }
  double side = 361, edges = 3 * side * side - 4 * side + 1;
  write_mesh(361);
  print_row("mesh, random ids", test_write("mesh.lua", of_mesh), "--no-output", side * side,
            2 * edges - 4 * (side - 1)); /* flexion: of every edge but those of the border */
  print_row("edges by hand, 256 x 256", test_write("hand.lua", by_hand), "N=256", 256 * 256, 2 * 256 * 255);
  return 0;
}
