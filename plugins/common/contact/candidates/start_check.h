/* Whether a mesh is fine enough for the thickness that contact gives it.
 *
 * Contact keeps every gap above 0, also between features of one surface. Two features that share no particle, of which
 * an edge of the mesh joins a particle of the one with a particle of the other, are neighbours: they are as near as the
 * triangles are small, whatever the motion. So at the start each such pair (but for those of which no particle can
 * move) has to be farther apart than its offset; else the thickness does not fit the mesh. Pairs that are no
 * neighbours, as in folds, do not limit the thickness: they can be moved apart.
 *
 * Nor may particles start in a heap: n of them nearer to each other than they are thick are n^2/2 pairs that are closed
 * from the beginning, of which no method of contact can make sense, and for some thousand of which there is no memory.
 * Nor may anything start wholly inside of something solid (enclosure.h).
 */
#ifndef HK_START_CHECK_H
#define HK_START_CHECK_H

#include "plugins/common/contact/candidates/broad_phase.h"

/* HK_BAD_PARAM, on behalf of the plugin whose view it is: a triangle has no area, more than a hundred particles are
 * nearer to each other than the least sum of two radii, something is inside of a solid (the message says what, and how
 * deep), or neighbours are too near; the message says the largest thickness, or radius of strands, that fits. Else as
 * hk_broad_phase_run. */
hk_status hk_start_check(hk_broad_phase *, const hk_host *, const hk_view *, const hk_surface_request *,
                         hk_gather *pairs);

#endif
