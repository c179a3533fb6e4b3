/* Taking shots of a run, frame by frame. */
#ifndef HK_SHOOTING_H
#define HK_SHOOTING_H

#include "plugins/common/shot/shot.h"

/* Names the arrays: all channels, and with `forces` all forces. HK_NO_MEMORY. */
hk_status hk_shooting_begin(hk_shooting *, const hk_view *view, const hk_frame *frame, bool forces);
/* Takes the shot of this frame. HK_NO_MEMORY, or the status of a force. */
hk_status hk_shooting_take(hk_shooting *, const hk_view *view, const hk_frame *frame);

/* What outputs do with these: the same with messages by the host. */

/* In `create`: finds the group, NULL: all. HK_BAD_PARAM. */
hk_status hk_shooting_choose(hk_shooting *, const hk_host *host, const hk_model *model, const char *group);
/* In `open`: begins, and takes the shot of the start. */
hk_status hk_shooting_open(hk_shooting *, const hk_view *view, const hk_frame *frame, const hk_tuples *only,
                           bool forces);
/* In `frame`. */
hk_status hk_shooting_frame(hk_shooting *, const hk_view *view, const hk_frame *frame, const hk_tuples *only);
void hk_shooting_free(hk_shooting *);

#endif
