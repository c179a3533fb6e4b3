/* Messages of a run that is watched (queue.h): a frame as it is gathered for recordings, too (frame_data.h).
 *
 *   R  the run, as text: lines "key<TAB>value", among them "field<TAB>name<TAB>components<TAB>kind" of the fields of a
 *      frame in their order, "measure<TAB>name<TAB>unit" and "mark<TAB>name<TAB>kind" of lists of wind or contacts in
 *      theirs, and, where there are several, "group<TAB>name" of groups
 *   S  what particles bounce off (surroundings.h), once, behind R
 *   T  uint32_t: number of the topology, n, edges, triangles, pins, groups and radii (n each, or 0); ids (n), edges (2
 *      each), triangles (3 each), pins, groups; float: radii of strands, m, 0 of what is of none
 *   N  double: t, kinetic, potential, work (J), momentum (3), angular momentum (3), largest strain, mean step since the
 *      frame before (s), then the measures
 *   F  uint32_t: frame, its topology, n, 0; double: t; float: positions from the origin (3n), the fields in their
 * order, then the places of S and the marks (surroundings.h)
 *
 *   D  uint32_t: 1 when the run has stopped because the user wants it to, 0 when it goes on: nothing comes in between
 *
 *   K  the path of the checkpoint that will be written when the run is interrupted now: it waits for that
 *
 * All numbers are little-endian. N is sent at every frame, F where the reader keeps up, and where the run stops. */
#ifndef HK_LIVE_MESSAGES_H
#define HK_LIVE_MESSAGES_H

#include "plugins/common/live/queue.h"
#include "plugins/common/live/surroundings.h"

#include "core/plugin.h"

typedef struct hk_live_messages {
  hk_live_queue queue;
  double origin[3]; /* m */
  uint32_t topology;
  double t; /* s, and steps at the frame before */
  size_t steps;
} hk_live_messages;

/* origin: m, of positions in messages; NAN: the middle of the start. False: no memory, or no thread. */
bool hk_live_open(hk_live_messages *, int fd, const double origin[3]);
void hk_live_close(hk_live_messages *); /* all is written, or the reader has gone; a second call does nothing */
void hk_live_send_run(hk_live_messages *, const hk_frame_data *, const hk_frame *);
void hk_live_send_topology(hk_live_messages *, const hk_frame_data *);
/* N. Whether F is sent as well: it is left out where one waits already. */
bool hk_live_send_numbers(hk_live_messages *, const hk_frame_data *, const hk_frame *);
void hk_live_send_state(hk_live_messages *, const hk_frame_data *, const hk_frame *);
void hk_live_send_doing(hk_live_messages *, bool stopped);
void hk_live_send_kept(hk_live_messages *, const char *path);

#endif
