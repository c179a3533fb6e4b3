/* The lists of surfaces.h, made from the edges and triangles of a scene. */
#ifndef HK_SURFACE_LISTS_H
#define HK_SURFACE_LISTS_H

#include "plugins/common/contact/surfaces/joined_bodies.h"

typedef struct hk_surface_lists {
  hk_surface_mesh mesh; /* of the arrays below; `number` is left to the caller */
  uint32_t *point, (*edge)[2], (*edge_faces)[2], (*triangle)[3], *part;
  double *radius;
  uint32_t *solid; /* n: the first carrier of the rigid body whose surface it is of; UINT32_MAX: none */
  hk_joined_bodies joined;
  size_t surface_edges; /* edges of triangles, the first ones of the mesh; those of strands follow. Both are in */
  size_t strand_edges;  /* the order of their particles, the lower one first */
  bool *in_triangle;    /* n: a particle of a triangle, be it left out or not */
} hk_surface_lists;

/* left: n, true for particles that have no part in contact. HK_BAD_PARAM: triangles that are degenerate, duplicate, or
 * more than two at an edge; HK_NO_MEMORY. The lists are empty then. */
hk_status hk_surface_lists_build(hk_surface_lists *, const hk_host *, const hk_view *, const hk_surface_request *,
                                 const bool *left);
void hk_surface_lists_free(hk_surface_lists *, const hk_host *);

/* m: the largest radius of the particles of a feature. */
static inline double hk_feature_radius(const hk_surface_mesh *m, const uint32_t *vertex, int count) {
  double radius = m->radius[vertex[0]];
  for (int c = 1; c < count; c++) radius = m->radius[vertex[c]] > radius ? m->radius[vertex[c]] : radius;
  return radius;
}

#endif
