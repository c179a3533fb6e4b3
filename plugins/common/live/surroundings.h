/* What is told of a run that is watched beside its particles: obstacles, wind, contacts.
 *
 * S is uint32_t: the number of solids; of each its kind (hk_shape_kind), 1 where it is hollow plus 2 where it is the
 * surface of a rigid body plus 4 (1 + its group), its numbers of vertices and faces; then float: the vertices of all (3
 * each), and uint32_t: the faces (3 each). A frame has float: of each solid its centre from the origin and three axes
 * (12), and of each list of marks uint32_t: how many, of how many, and float: their places from the origin (3 each),
 * their vectors (3 each).
 */
#ifndef HK_LIVE_SURROUNDINGS_H
#define HK_LIVE_SURROUNDINGS_H

#include "plugins/common/frame_data/frame_data.h"
#include "plugins/common/live/queue.h"

void hk_live_send_solids(hk_live_queue *, const hk_frame_data *);
/* Of their part of a frame: its bytes; writes it to `at`, and moves that. */
size_t hk_live_surroundings_size(const hk_frame_data *);
void hk_live_put_surroundings(char **at, const hk_frame_data *, const double origin[3]);

#endif
