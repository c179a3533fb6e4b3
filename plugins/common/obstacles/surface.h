/* Closed surfaces of triangles by their signed distance: that to the nearest point, with the sign of the side on which
 * the point lies, by the normal of the face, edge or corner there, each weighted by the angles of its faces (Baerentzen
 * and Aanaes 2005, "Signed distance computation using the angle weighted pseudonormal", theorem 1). */
#ifndef HK_SURFACE_H
#define HK_SURFACE_H

#include "plugins/common/space/bvh.h"

typedef struct hk_surface {
  size_t vertices, faces;
  double *vertex;      /* vertices x 3, m */
  uint32_t (*face)[3]; /* anticlockwise, seen from outside */
  double (*face_normal)[3], (*edge_normal)[3][3],
      (*vertex_normal)[3]; /* outward; edge e is between corners e and e + 1 */
  hk_box *box;             /* faces */
  double size;             /* m, the largest extent */
  const hk_bvh_service *trees;
  hk_bvh *tree;
} hk_surface;

/* Takes the surface from lists of coordinates and of corners (from 1). HK_BAD_PARAM: it is not closed, or not a
 * surface; the message names `file`. Memory is the host's. */
hk_status hk_surface_open(hk_surface *, const hk_host *, const hk_numbers *vertices, const hk_numbers *faces,
                          const char *file);
/* m, and the outward unit normal n. */
double hk_surface_distance(const hk_surface *, const double p[3], double n[3]);

#endif
