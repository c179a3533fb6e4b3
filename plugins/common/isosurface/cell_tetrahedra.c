/* The Kuhn subdivision (Freudenthal 1942, Kuhn 1960): for each order of the axes the tetrahedron of the path that goes
 * from corner 0 to corner 7 one axis after the other. All cubes are cut alike, so faces that two cubes share have the
 * same diagonal. The cut of a tetrahedron is a triangle (one corner inside, or one outside) or a quadrangle (two). */
#include "plugins/common/isosurface/cell_cases.h"

static uint8_t edge(unsigned a, unsigned b) { return (uint8_t)((a & b) | (a ^ b) << 3); } /* one mask has the other */

static void add(hk_cell_case *c, uint8_t first, uint8_t second, uint8_t third) {
  uint8_t *e = c->edge[c->triangles++];
  e[0] = first, e[1] = second, e[2] = third;
}

static void swap(unsigned *a, unsigned *b) {
  unsigned old = *a;
  *a = *b, *b = old;
}

/* Brings the inside corners of a tetrahedron of positive volume to the front and keeps the sign of its volume: an even
 * permutation. Returns how many there are. */
static int inside_first(unsigned v[4], unsigned mask) {
  int count = 0, odd = 0;
  for (int k = 0; k < 4; k++) {
    if (!(mask >> v[k] & 1)) continue;
    for (int j = k; j > count; j--) swap(&v[j], &v[j - 1]), odd ^= 1;
    count++;
  }
  if (odd) count >= 2 ? swap(&v[0], &v[1]) : swap(&v[2], &v[3]);
  return count;
}

static void cut(hk_cell_case *c, unsigned mask, unsigned v[4]) {
  int inside = inside_first(v, mask);
  if (inside == 1) add(c, edge(v[0], v[1]), edge(v[0], v[2]), edge(v[0], v[3]));
  if (inside == 3) add(c, edge(v[0], v[3]), edge(v[1], v[3]), edge(v[2], v[3]));
  if (inside != 2) return;
  add(c, edge(v[0], v[2]), edge(v[0], v[3]), edge(v[1], v[3]));
  add(c, edge(v[0], v[2]), edge(v[1], v[3]), edge(v[1], v[2]));
}

void hk_cell_cases_tetrahedra(hk_cell_case cases[256]) {
  for (unsigned mask = 0; mask < 256; mask++) {
    cases[mask] = (hk_cell_case){0};
    for (unsigned a = 0; a < 3; a++)
      for (unsigned turn = 1; turn < 3; turn++) { /* the second axis follows the first in an even order, or not */
        unsigned b = (a + turn) % 3, v[4] = {0, 1U << a, 1U << a | 1U << b, 7};
        if (turn == 2) swap(&v[1], &v[2]); /* a negative volume becomes positive */
        cut(&cases[mask], mask, v);
      }
    hk_cell_case_list_edges(&cases[mask]);
  }
}
