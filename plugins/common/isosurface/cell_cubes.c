/* Marching cubes without a table by hand. On each face the surface leaves segments that go from an edge where one comes
 * inside, around the face counterclockwise as seen from outside of the cube, to the next where one leaves: inside
 * corners across a face are kept apart. That rests on the four corners of the face alone, so both of its cubes have the
 * same segments. They join to closed polygons, which are cut into triangles by diagonals of which none lies in a face
 * of the cube: otherwise the cube beyond might have the same one, and four triangles would meet in it. Such diagonals
 * exist in all 256 cases. (With the asymptotic decider of Nielson and Hamann 1991 there are 656 cases, of which 116
 * have none, and would need a vertex within the cube.) */
#include "plugins/common/isosurface/cell_cases.h"

enum { EDGES = 12, NO_EDGE = 255 };

/* Corner `turn` of four around a face: side 0 or 1 of an axis. */
static unsigned corner(unsigned axis, unsigned side, unsigned turn) {
  unsigned around = (side ? turn : 3 - turn) & 3, b = (axis + 1) % 3, c = (axis + 2) % 3;
  return side << axis | (unsigned)(around == 1 || around == 2) << b | (unsigned)(around >= 2) << c;
}

static uint8_t edge(unsigned a, unsigned b) { return (uint8_t)((a & b) | (a ^ b) << 3); }

static bool is_inside(unsigned mask, unsigned axis, unsigned side, unsigned turn) {
  return mask >> corner(axis, side, turn) & 1;
}

/* next[e]: the edge on which the segment that begins on edge e ends. */
static void find_segments(unsigned mask, uint8_t next[64]) {
  for (unsigned e = 0; e < 64; e++) next[e] = NO_EDGE;
  for (unsigned face = 0; face < 6; face++)
    for (unsigned k = 0, axis = face / 2, side = face % 2; k < 4; k++) {
      if (is_inside(mask, axis, side, k) || !is_inside(mask, axis, side, k + 1)) continue;
      unsigned j = k + 1;
      while (is_inside(mask, axis, side, j + 1)) j++;
      next[edge(corner(axis, side, k), corner(axis, side, k + 1))] =
          edge(corner(axis, side, j), corner(axis, side, j + 1));
    }
}

/* Whether the middles of two edges lie in one face: all of their ends are on one side of an axis. */
static bool share_face(uint8_t a, uint8_t b) {
  unsigned low = (a & 7) & (b & 7), high = (a & 7) | a >> 3 | (b & 7) | b >> 3;
  return low || high != 7;
}

/* Whether the part of a polygon from corner i to j can be cut; middle[i][j] is the third corner of the triangle on the
 * line from i to j. Parts are tried from the short to the long ones. */
static void find_cuts(const uint8_t *loop, unsigned count, uint8_t middle[EDGES][EDGES]) {
  for (unsigned length = 2; length < count; length++)
    for (unsigned i = 0, j = length; j < count; i++, j++) {
      middle[i][j] = NO_EDGE;
      if (length < count - 1 && share_face(loop[i], loop[j])) continue;
      for (unsigned k = i + 1; k < j; k++)
        if ((k == i + 1 || middle[i][k] != NO_EDGE) && (j == k + 1 || middle[k][j] != NO_EDGE))
          middle[i][j] = (uint8_t)k;
    }
}

static void add_polygon(hk_cell_case *c, const uint8_t *loop, unsigned count) {
  uint8_t middle[EDGES][EDGES], from[EDGES] = {0}, to[EDGES] = {(uint8_t)(count - 1)};
  find_cuts(loop, count, middle);
  for (unsigned open = 1; open > 0;) {
    uint8_t i = from[--open], j = to[open], k;
    if (j - i < 2) continue;
    k = middle[i][j];
    uint8_t *e = c->edge[c->triangles++];
    e[0] = loop[i], e[1] = loop[k], e[2] = loop[j];
    from[open] = i, to[open++] = k;
    from[open] = k, to[open++] = j;
  }
}

void hk_cell_cases_cubes(hk_cell_case cases[256]) {
  for (unsigned mask = 0; mask < 256; mask++) {
    uint8_t next[64], loop[EDGES];
    cases[mask] = (hk_cell_case){0};
    find_segments(mask, next);
    for (unsigned first = 0; first < 64; first++) {
      unsigned count = 0;
      for (uint8_t e = (uint8_t)first; next[e] != NO_EDGE && count < EDGES;) {
        loop[count++] = e;
        uint8_t after = next[e];
        next[e] = NO_EDGE, e = after;
      }
      if (count > 0) add_polygon(&cases[mask], loop, count);
    }
    hk_cell_case_list_edges(&cases[mask]);
  }
}
