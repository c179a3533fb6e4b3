/* The lists of surfaces.h, made from the edges and triangles of a scene, and the items by which pairs are searched:
 * each triangle, each edge of a strand, each lone particle. Every point and every edge is owned by one item, the first
 * that has it, so that a pair of features is found once, at the pair of its owners ("representative triangles", Curtis,
 * Tamstorf and Manocha 2008). */
#ifndef HK_SURFACE_LISTS_H
#define HK_SURFACE_LISTS_H

#include "plugins/common/surfaces/surfaces.h"

enum {                      /* hk_surface_item.owns */
       HK_OWNS_POINT = 1,   /* shifted by c: vertex[c] */
       HK_OWNS_EDGE = 8,    /* shifted by c: the edge from vertex[c] to the next vertex */
       HK_IS_TRIANGLE = 64, /* else an edge of a strand or a lone particle, which owns the edge 0 */
       HK_IS_LONE = 128
};

typedef struct hk_surface_item {
  uint32_t vertex[3]; /* of an edge the second one twice, of a lone particle the same three times */
  uint32_t owns;
} hk_surface_item;

typedef struct hk_surface_lists {
  hk_surface_mesh mesh; /* of the arrays below; `number` is left to the caller */
  uint32_t *point, (*edge)[2], (*edge_faces)[2], (*triangle)[3], *part;
  double *radius;
  size_t items; /* triangles in the order of the mesh, then edges of strands, then lone particles */
  hk_surface_item *item;
  uint32_t (*item_edge)[3]; /* the edges of the mesh that the item owns, else UINT32_MAX; */
  size_t surface_edges;     /* edges of triangles, the first ones of the mesh; those of strands follow. Both are in */
  size_t strand_edges;      /* the order of their particles, the lower one first */
  bool *in_triangle;        /* n: a particle of a triangle, be it left out or not */
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
