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

/* Rows of the parameters every, only and group of an instance with members of these names. */
/* clang-format off */
#define HK_SHOOTING_ROWS(type)                                                                                         \
  {"every", "frames", "a frame is kept every so many",                                                                 \
   HK_INTEGER, {1}, 1, 1e9, offsetof(type, every), 0, NULL},                                                           \
  {"only", "", "particles to keep; left out: all",                                                                     \
   HK_PARTICLES, {0}, 0, 0, offsetof(type, only), HK_OPTIONAL, NULL},                                                  \
  {"group", "", "keep the particles of this group; left out: of all groups",                                           \
   HK_STRING, {0}, 0, 0, offsetof(type, group), 0, NULL}
/* clang-format on */

#endif
