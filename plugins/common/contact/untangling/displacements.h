/* Displacements that untangle surfaces: regions enclosed by a curve are drawn to the other side, other curves are made
 * shorter. Together they keep the centre of mass of the free particles. */
#ifndef HK_DISPLACEMENTS_H
#define HK_DISPLACEMENTS_H

#include "plugins/common/space/bvh.h"
#include "plugins/common/contact/untangling/regions.h"

enum { HK_UNTANGLING_PULL = 5 };

/* A prescribed displacement of a point of an edge, or a vertex, relative to a point of a triangle. */
typedef struct hk_untangling_pull {
  uint32_t vertex[HK_UNTANGLING_PULL]; /* of the first, and of the triangle; a vertex stands twice */
  double w[HK_UNTANGLING_PULL];        /* their weights, those of the triangle negative */
  double way[3];                       /* m: sum w move */
  bool along;                          /* the component along the way alone: the rest is free */
  double part;                         /* 0 to 1, of what is left of it that a sweep meets */
} hk_untangling_pull;

typedef struct hk_displacements {
  size_t pulls;
  hk_untangling_pull *pull;
  double *move;        /* n x 3, m */
  double *kick;        /* n x 3, m/s: removes the relative velocities against the pulls */
  double *part, *flow; /* n x 3, m: of the present sweep */
  /* of the search */
  uint64_t number;                  /* of the mesh of `start` and `around` */
  uint32_t *start, *around;         /* n + 2, 3 x triangles: the triangles at each vertex */
  uint32_t *stamp, stamps, *target; /* triangles: when listed last; the list */
  uint32_t *uses, *degree;          /* n: pulls, and edges, of each vertex */
  size_t targets, box_room, pull_room, n_room[7], mesh_room[3];
  hk_box *box;
  hk_bvh tree;
} hk_displacements;

typedef struct hk_tangle {
  const hk_surface_mesh *mesh;
  const hk_contours *contours;
  const hk_regions *regions;
  const hk_model *model;
  const double *x; /* n x 3, m */
  const double *v; /* n x 3, m/s; NULL: no kicks */
  double beyond;   /* m: the gap that displacements aim at */
} hk_tangle;

/* Fills `move` and `kick`. HK_NO_MEMORY. */
hk_status hk_displacements_find(hk_displacements *, const hk_host *, const hk_tangle *);
void hk_displacements_free(hk_displacements *, const hk_host *);

#endif
