/* Gathers the data of a run, frame by frame, for outputs; messages are the host's. */
#ifndef HK_GATHERER_H
#define HK_GATHERER_H

#include "plugins/common/frame_data/frame_data.h"

/* In `create`: finds the obstacles, and the group, NULL: all. HK_BAD_PARAM, HK_FAILED. */
hk_status hk_gatherer_choose(hk_gatherer *, const hk_host *host, const hk_model *model, const char *group);
/* In `open`, when all obstacles are known: names the arrays, all channels and with `forces` all forces, and gathers the
 * start. only: particles to keep; of count 0: all. HK_NO_MEMORY, or the status of a force. */
hk_status hk_gatherer_open(hk_gatherer *, const hk_view *view, const hk_frame *frame, const hk_tuples *only,
                           bool forces);
/* In `frame`: all but the forces. HK_NO_MEMORY. */
hk_status hk_gatherer_frame(hk_gatherer *, const hk_view *view, const hk_frame *frame, const hk_tuples *only);
/* The forces of the frame that was gathered, an evaluation of each. Its status. */
hk_status hk_gatherer_forces(hk_gatherer *, const hk_view *view, const hk_frame *frame);
void hk_gatherer_free(hk_gatherer *);

#endif
