/* What of a motion is hidden from the eye by triangles: lines of sight to a sample of its points are intersected with
 * those that face the eye (Moller and Trumbore, "Fast, minimum storage ray/triangle intersection", J. Graphics Tools
 * 2(1), 1997). */
#ifndef HK_OCCLUSION_H
#define HK_OCCLUSION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_SIGHT_POINTS = 256 };

typedef struct hk_sight {
  float eye[3], point[HK_SIGHT_POINTS][3]; /* m */
  bool hidden[HK_SIGHT_POINTS];            /* by anything so far */
  size_t points;
} hk_sight;

/* Adds a point to the sample, m, unless it is full; one that is not finite is left out. */
void hk_sight_add(hk_sight *, const float x[3]);
/* The share of the points, 0 to 1, that triangles hide, which are noted as hidden. The vertices are `stride` bytes
 * apart. Of many triangles, fewer lines of sight are tried. */
double hk_sight_hidden_by(hk_sight *, const void *vertex, size_t stride, const uint32_t (*triangle)[3],
                          size_t triangles);
/* Whether a line of sight meets the sphere at all, in front of its point. */
bool hk_sight_may_meet(const hk_sight *, const double middle[3], double radius);
/* How opaque a thing is drawn that hides `share` of the points, 1 to 0.18. Only where all together hide more than half
 * of the points does it fade, wholly from three quarters on; what hides less than a tenth fades by less. It changes
 * continuously with what is hidden, so that no film flickers. */
double hk_sight_opacity(const hk_sight *, double share);

#endif
