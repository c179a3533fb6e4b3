/* Intersection paths: where surfaces intersect they do so along curves, which pass from one edge that pierces a
 * triangle to the next. Each piece of a curve lies in two triangles, and so each curve in two surfaces, or twice in one
 * (Baraff, Witkin and Kass 2003, "Untangling cloth", section 3). */
#ifndef HK_CONTOURS_H
#define HK_CONTOURS_H

#include "plugins/common/contact/surfaces/surfaces.h"

typedef enum hk_contour_kind {
  HK_CONTOUR_CLOSED, /* comes back to where it began */
  HK_CONTOUR_BORDER, /* ends at borders of surfaces */
  HK_CONTOUR_LOOP,   /* ends, on one side at least, at a corner that both triangles have: the tip of a fold */
  HK_CONTOUR_BROKEN, /* ends elsewhere: a strand in a triangle, or surfaces that touch in a point or a line */
  HK_CONTOUR_KINDS
} hk_contour_kind;

typedef struct hk_contour_point {
  uint32_t edge, triangle; /* of the mesh; the edge passes through the triangle */
  uint32_t side;           /* 0 or 1: of the two surfaces, that of the edge */
} hk_contour_point;

typedef struct hk_contour {
  hk_contour_kind kind;
  size_t first, count; /* of the points, in their order along the curve */
  bool twisted;        /* closed, and its two sides are one curve that runs around twice */
  bool cuts[2];        /* on which sides it divides the surface from one place of the border to another */
  struct {
    size_t first, count;
  } beyond[2]; /* of `beyond`: edges that it would cross if it went on to the border, prolong.h */
} hk_contour;

typedef struct hk_contours {
  size_t points, count;
  hk_contour_point *point;
  hk_contour *contour;
  size_t kinds[HK_CONTOUR_KINDS]; /* how many there are of each */
  size_t beyonds;
  uint32_t *beyond;
  struct hk_contour_link *link; /* what follows is for the tracing */
  struct hk_contour_node *node;
  size_t link_room, node_room, point_room, contour_room, beyond_room;
} hk_contours;

/* Traces the curves of the intersections. HK_NO_MEMORY. */
hk_status hk_contours_trace(hk_contours *, const hk_host *, const hk_surface_mesh *, const hk_surface_intersections *);
void hk_contours_free(hk_contours *, const hk_host *);

#endif
