/* Makes a video of pictures with the program ffmpeg. */
#ifndef HK_VIDEO_H
#define HK_VIDEO_H

#include <stdbool.h>
#include <stddef.h>

typedef enum hk_video_result {
  HK_VIDEO_MADE,
  HK_VIDEO_NO_PROGRAM,
  HK_VIDEO_FAILED,
  HK_VIDEO_STOPPED /* as asked: ffmpeg is ended and its file removed */
} hk_video_result;

typedef struct hk_video_stop { /* whether to stop, asked ten times a second */
  bool (*asked)(void *context);
  void *context;
} hk_video_stop;

/* Encodes the first `count` of folder/000000.png, folder/000001.png ... as H.264 into `file`. When that fails, `why` is
 * the last line that ffmpeg wrote, or the system's message. */
hk_video_result hk_video_make(const char *folder, size_t count, double fps, const char *file, const hk_video_stop *,
                              char *why, size_t size);
/* True when there is a program ffmpeg on the PATH. */
bool hk_video_possible(void);

#endif
