/* Makes a video of pictures with the program ffmpeg. */
#ifndef HK_VIDEO_H
#define HK_VIDEO_H

#include <stdbool.h>
#include <stddef.h>

typedef enum hk_video_result { HK_VIDEO_MADE, HK_VIDEO_NO_PROGRAM, HK_VIDEO_FAILED } hk_video_result;

/* Encodes the first `count` of folder/000000.png, folder/000001.png ... as H.264 into `file`. When that fails, `why` is
 * the last line that ffmpeg wrote, or the system's message. */
hk_video_result hk_video_make(const char *folder, size_t count, double fps, const char *file, char *why, size_t size);
/* True when there is a program ffmpeg on the PATH. */
bool hk_video_possible(void);

#endif
