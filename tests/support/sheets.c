#include "tests/support/sheets.h"

#include <stdlib.h>

/* The same numbers in [-1, 1) for every sheet. */
static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) / 4503599627370496.0 - 1;
}

static void place(sheet *s, sheet_kind kind, size_t cells, const double h[3]) {
  size_t side = cells + 1;
  double a = 1.0 / (double)cells;
  uint64_t seed = 7;
  for (size_t k = 0; k < s->particles; k++) {
    size_t i = k % side, j = k / side;
    bool inner = i > 0 && j > 0 && i < cells && j < cells;
    double x = a * (double)i, y = a * (double)j, rough = kind == SHEET_IRREGULAR && inner ? 0.3 * a : 0;
    if (kind == SHEET_EQUILATERAL) x += a / 2 * (double)(j % 2), y *= sqrt(3) / 2;
    x += rough * noise(&seed), y += rough * noise(&seed);
    s->x[k][0] = x, s->x[k][1] = y, s->x[k][2] = (h[0] * x * x + h[2] * y * y) / 2 + h[1] * x * y;
  }
}

static double flat_distance2(const double p[3], const double q[3]) {
  return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
}

/* Whether the cell's diagonal goes from its lower right to its upper left corner. */
static bool goes_back(const sheet *s, sheet_kind kind, size_t i, size_t j, size_t side) {
  const double(*x)[3] = (const double(*)[3])s->x + j * side + i;
  if (kind == SHEET_ALTERNATING) return (i + j) % 2 == 1;
  if (kind == SHEET_EQUILATERAL) return j % 2 == 0;
  return kind == SHEET_IRREGULAR && flat_distance2(x[1], x[side]) < flat_distance2(x[0], x[side + 1]);
}

sheet sheet_make(sheet_kind kind, size_t cells, const double h[3]) {
  size_t side = cells + 1, at = 0;
  sheet s = {.particles = side * side, .triangles = 2 * cells * cells, .area = 1};
  if (kind == SHEET_EQUILATERAL) s.area = sqrt(3) / 2;
  s.x = malloc(s.particles * sizeof *s.x);
  s.corner = malloc(3 * s.triangles * sizeof *s.corner);
  place(&s, kind, cells, h);
  for (size_t j = 0; j < cells; j++)
    for (size_t i = 0; i < cells; i++) {
      uint32_t a = (uint32_t)(j * side + i + 1), b = a + 1, c = a + (uint32_t)side, d = c + 1;
      bool back = goes_back(&s, kind, i, j, side);
      const uint32_t two[6] = {a, b, back ? c : d, back ? b : a, d, c};
      for (int k = 0; k < 6; k++) s.corner[at++] = two[k];
    }
  return s;
}

void sheet_free(sheet *s) {
  free(s->x);
  free(s->corner);
  *s = (sheet){0};
}

hk_plugin_spec *sheet_add(test_engine *e, const sheet *s, const char *force) {
  for (size_t k = 0; k < s->particles; k++) test_particle(e, s->x[k][0], s->x[k][1], s->x[k][2], 1);
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  test_tuples(e, spec, "triangles", 3, s->corner, s->triangles);
  e->options.dt = 1e-3;
  return spec;
}
