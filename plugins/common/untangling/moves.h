/* How vertices have to move for surfaces to come apart: what closed curves enclose is drawn to the other side, other
 * curves become shorter. All moves together keep the center of mass of what is free. */
#ifndef HK_MOVES_H
#define HK_MOVES_H

#include "plugins/common/space/bvh.h"
#include "plugins/common/untangling/regions.h"

enum { HK_PULL = 5 };

typedef struct hk_pull {    /* a point of an edge, or a vertex, is to move relative to a point of a triangle */
  uint32_t vertex[HK_PULL]; /* of the first, and of the triangle; a vertex stands twice */
  double w[HK_PULL];        /* their weights, those of the triangle negative */
  double way[3];            /* m: sum w move */
} hk_pull;

typedef struct hk_moves {
  size_t pulls;
  hk_pull *pull;
  double *move;        /* n x 3, m */
  double *kick;        /* n x 3, m/s: takes from velocities what goes against the pulls */
  double *part, *flow; /* n x 3, m: of the present sweep */
  /* what follows is for the search */
  uint64_t number;                  /* of the mesh of `start` and `around` */
  uint32_t *start, *around;         /* n + 2, 3 x triangles: the triangles at each vertex */
  uint32_t *stamp, stamps, *target; /* triangles: when listed last; the list */
  uint32_t *uses, *degree;          /* n: pulls, and edges, of each vertex */
  size_t targets, box_room, pull_room, n_room[7], mesh_room[3];
  hk_box *box;
  hk_bvh tree;
} hk_moves;

typedef struct hk_tangle { /* what is to be freed */
  const hk_surface_mesh *mesh;
  const hk_contours *contours;
  const hk_regions *regions;
  const hk_model *model;
  const double *x; /* n x 3, m */
  const double *v; /* n x 3, m/s; NULL: no kicks */
  double beyond;   /* m: how much further than their radii surfaces are to be apart */
} hk_tangle;

/* Fills `move` and `kick`. HK_NO_MEMORY. */
hk_status hk_moves_find(hk_moves *, const hk_host *, const hk_tangle *);
void hk_moves_free(hk_moves *, const hk_host *);

#endif
