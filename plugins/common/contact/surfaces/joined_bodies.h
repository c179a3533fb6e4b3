/* Which bodies do not meet, as they are joined: by joints of the scene, unless these say otherwise, by constraints that
 * keep a point of the one nearer to a point of the other than the thickness, where contact would push against the
 * constraint, and by a particle that both hold so. */
#ifndef HK_JOINED_BODIES_H
#define HK_JOINED_BODIES_H

#include "plugins/common/contact/surfaces/surfaces.h"

/* A body is named by its first carrier. */
typedef struct hk_joined_bodies {
  uint32_t (*apart)[2]; /* pairs that do not meet, each as often as it is named: the lower first, rising */
  size_t aparts;
  uint32_t (*held)[2]; /* particles of no body, and such a body that holds them nearer than the thickness, rising */
  size_t helds;
  bool *is_held; /* n: it is one of those; NULL: there are none */
} hk_joined_bodies;

hk_status hk_joined_bodies_find(hk_joined_bodies *, const hk_host *, const hk_view *,
                                const hk_surface_request *); /* of an empty one; HK_NO_MEMORY */
void hk_joined_bodies_free(hk_joined_bodies *, const hk_host *);

/* Whether they do not meet: they are the same one, or joined. UINT32_MAX: no body. */
bool hk_solids_apart(const hk_joined_bodies *, uint32_t solid, uint32_t other);
/* Whether the body holds one of those particles, as a peg holds one of a cloth, so that their feature does not meet it.
 */
bool hk_solid_holds(const hk_joined_bodies *, uint32_t solid, const uint32_t *particle, int count);

#endif
