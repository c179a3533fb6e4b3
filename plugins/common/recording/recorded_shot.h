/* Whole shots of a recording. */
#ifndef HK_RECORDED_SHOT_H
#define HK_RECORDED_SHOT_H

#include "plugins/common/recording/reader.h"

/* Names the arrays. False: no memory. hk_shooting_free (shot/shooting.h) frees it. */
bool hk_recording_shot_open(const hk_recording *, hk_shooting *);
/* Takes frame k. False: the file is damaged, or no memory. */
bool hk_recording_shot(const hk_recording *, size_t k, hk_shooting *);

#endif
