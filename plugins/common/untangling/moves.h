/* How vertices have to move for surfaces to come apart: what closed curves enclose is drawn to the other side, other
 * curves become shorter. All moves together keep the center of mass of what is free. */
#ifndef HK_MOVES_H
#define HK_MOVES_H

#include "plugins/common/space/bvh.h"
#include "plugins/common/untangling/regions.h"

typedef struct hk_pull { /* vertex[0] is to move by `way` relative to the point of the triangle of the others */
  uint32_t vertex[4];
  double w[4]; /* 1, and minus the point's barycentric coordinates */
  double way[3];
} hk_pull;

typedef struct hk_moves {
  size_t pulls;
  hk_pull *pull;
  double *move; /* n x 3, m */
  double *kick; /* n x 3, m/s: takes from velocities what goes against the pulls */
  /* what follows is for the search */
  uint64_t number;                         /* of the mesh of `start` and `around` */
  uint32_t *start, *around;                /* n + 2, 3 x triangles: the triangles at each vertex */
  uint32_t *stamp, stamps, *target, *uses; /* triangles: when listed last; the list; n: pulls of each vertex */
  size_t targets, box_room, pull_room, n_room[4], mesh_room[3];
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

/* Adds the direction in which the vertices of an edge and a triangle that it pierces have to move for the curve to
 * become shorter: minus the gradient of its length by their positions; 0 where they are parallel. */
void hk_shortening(const hk_surface_mesh *, const double *x, const hk_contour_point *, uint32_t vertex[5],
                   double direction[5][3]);

#endif
