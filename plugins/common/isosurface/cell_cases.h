/* The triangles within a cube of the grid, for each way in which its corners are inside. Corner c of a cube is x + 2 y
 * + 4 z of its place; an edge is a corner and the direction that leads upwards from it: corner + 8 direction, where
 * direction is again x + 2 y + 4 z of a step of 0 or 1 along each axis. */
#ifndef HK_CELL_CASES_H
#define HK_CELL_CASES_H

#include "core/plugin.h"

enum { HK_CELL_TRIANGLES = 12, HK_CELL_EDGES = 19 };

typedef struct hk_cell_case {
  uint8_t triangles;
  uint8_t edges, used[HK_CELL_EDGES]; /* the edges with a vertex, each once, rising */
  uint8_t edge[HK_CELL_TRIANGLES][3]; /* counterclockwise as seen from outside */
} hk_cell_case;

/* Case m has corner c inside where bit c of m is 1. */
void hk_cell_cases_tetrahedra(hk_cell_case cases[256]);
void hk_cell_cases_cubes(hk_cell_case cases[256]);

/* Lists the edges of a case whose triangles are known. */
static inline void hk_cell_case_list_edges(hk_cell_case *c) {
  uint64_t used = 0;
  for (unsigned t = 0; t < c->triangles; t++)
    for (int k = 0; k < 3; k++) used |= 1ULL << c->edge[t][k];
  c->edges = 0;
  for (uint8_t e = 0; e < 64; e++)
    if (used >> e & 1) c->used[c->edges++] = e;
}

#endif
