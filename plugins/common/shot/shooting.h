/* Taking shots of a run, frame by frame. */
#ifndef HK_SHOOTING_H
#define HK_SHOOTING_H

#include "plugins/common/shot/shot.h"

/* Names the arrays: all channels, and with `forces` all forces. HK_NO_MEMORY. */
hk_status hk_shooting_begin(hk_shooting *, const hk_view *view, const hk_frame *frame, bool forces);
/* Takes the shot of this frame. HK_NO_MEMORY, or the status of a force. */
hk_status hk_shooting_take(hk_shooting *, const hk_view *view, const hk_frame *frame);
void hk_shooting_free(hk_shooting *);

#endif
