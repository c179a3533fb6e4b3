/* The rigid body that a point is inside of, by the triangles of its surface. What has no particles of its own, such as
 * an obstacle, and lies wholly inside of a body touches none of the body's points: nothing else would notice it. */
#ifndef HK_BODY_AROUND_H
#define HK_BODY_AROUND_H

#include "core/plugin.h"

typedef struct hk_body_around {
  bool found;
  uint32_t particle; /* of the body's surface, the nearest triangle's first; an index */
  double depth;      /* m, of the point below the surface */
} hk_body_around;

/* The body round p (m) in which it is deepest. Bodies without triangles are round nothing. HK_NO_MEMORY. */
hk_status hk_body_around_find(const hk_view *, const hk_host *, const double p[3], hk_body_around *out);

#endif
