/* Whether something starts wholly inside of something solid. Contact keeps surfaces from crossing, so what is inside
 * and crosses nothing would stay there, and no intersection would show it. Solids are the closed surfaces that move as
 * rigid bodies, and those that are pinned as a whole, with their faces outward: where surfaces lie in each other, as
 * the two of a hollow ball, their winding numbers add up to 0 in the hollow and 1 in the wall. Closed cloth and soft
 * bodies are no solids: a balloon may hold something. A single pinned particle may be in a solid: joints have them.
 *
 * Time: the points of a connected part, up to the first that is outside, times the triangles of the solids whose boxes
 * it is in. */
#ifndef HK_ENCLOSURE_H
#define HK_ENCLOSURE_H

#include "plugins/common/contact/surfaces/surface_lists.h"

typedef struct hk_enclosure {
  bool found;
  uint32_t particle; /* of the part that is inside, its deepest; an index */
  uint32_t solid;    /* the particle of the solid that is nearest to that */
  double depth;      /* m, of the particle below the surface */
} hk_enclosure;

/* The deepest particle of the first connected part that is inside of a solid at x (n x 3, m). HK_NO_MEMORY. */
hk_status hk_enclosure_find(const hk_surface_lists *, const hk_host *, const hk_model *, const double *x,
                            hk_enclosure *out);

#endif
