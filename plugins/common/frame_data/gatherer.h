/* Gathers the data of a run, frame by frame. */
#ifndef HK_GATHERER_H
#define HK_GATHERER_H

#include "plugins/common/frame_data/frame_data.h"

/* Names the arrays: all channels, and with `forces` all forces. HK_NO_MEMORY. */
hk_status hk_gatherer_begin(hk_gatherer *, const hk_view *view, const hk_frame *frame, bool forces);
/* Gathers this frame. HK_NO_MEMORY, or the status of a force. */
hk_status hk_gatherer_take(hk_gatherer *, const hk_view *view, const hk_frame *frame);

/* What outputs do with these: the same with messages by the host. */

/* In `create`: finds the group, NULL: all. HK_BAD_PARAM. */
hk_status hk_gatherer_choose(hk_gatherer *, const hk_host *host, const hk_model *model, const char *group);
/* In `open`: begins, and gathers the start. */
hk_status hk_gatherer_open(hk_gatherer *, const hk_view *view, const hk_frame *frame, const hk_tuples *only,
                           bool forces);
/* In `frame`. */
hk_status hk_gatherer_frame(hk_gatherer *, const hk_view *view, const hk_frame *frame, const hk_tuples *only);
void hk_gatherer_free(hk_gatherer *);

/* Rows of the parameters every, only and group of an instance with members of these names. */
/* clang-format off */
#define HK_GATHERER_ROWS(type)                                                                                         \
  {"every", "frames", "a frame is kept every so many",                                                                 \
   HK_INTEGER, {1}, 1, 1e9, offsetof(type, every), 0, NULL},                                                           \
  {"only", "", "particles to keep; left out: all",                                                                     \
   HK_PARTICLES, {0}, 0, 0, offsetof(type, only), HK_OPTIONAL, NULL},                                                  \
  {"group", "", "keep the particles of this group; left out: of all groups",                                           \
   HK_STRING, {0}, 0, 0, offsetof(type, group), 0, NULL}
/* clang-format on */

#endif
