/* Whole frames of a recording. */
#ifndef HK_RECORDED_FRAME_H
#define HK_RECORDED_FRAME_H

#include "plugins/common/recording/reader.h"

/* Names the arrays. False: no memory. hk_gatherer_free (frame_data/gatherer.h) frees it. */
bool hk_recording_frame_open(const hk_recording *, hk_gatherer *);
/* Takes frame k. False: the file is damaged, or no memory. */
bool hk_recording_frame_read(const hk_recording *, size_t k, hk_gatherer *);

#endif
