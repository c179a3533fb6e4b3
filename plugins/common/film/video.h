/* Makes a video of pictures with the program ffmpeg, which is given them one after the other while it encodes. */
#ifndef HK_VIDEO_H
#define HK_VIDEO_H

#include "plugins/common/film/conveyor.h"

#include <sys/types.h>

typedef enum hk_video_result {
  HK_VIDEO_MADE,
  HK_VIDEO_NO_PROGRAM,
  HK_VIDEO_FAILED,
  HK_VIDEO_STOPPED /* as asked: ffmpeg is ended and its file removed */
} hk_video_result;

typedef struct hk_video { /* a zeroed one has not begun */
  int width, height, lanes;
  unsigned char *planes; /* of the picture that is handed over, as in yuv_picture.h */
  char file[PATH_MAX];
  pid_t child;
  int pictures, errors; /* pipes to and from the program */
  char said[2048];      /* the last of what it wrote */
  size_t length;
} hk_video;

/* True when there is a program ffmpeg on the PATH. */
bool hk_video_possible(void);
/* Starts ffmpeg, in the thread whose end is to be its end as well. It will encode pictures of this size, both even, as
 * H.264 into `file`. lanes: hk_host.lanes. Not HK_VIDEO_MADE: it could not be started, `why` says what the system says.
 */
hk_video_result hk_video_begin(hk_video *, int width, int height, int lanes, double fps, const char *file, char *why,
                               size_t size);
/* Hands over a picture: width x height, 4 bytes each, the bottom row first. False: ffmpeg has ended. Any thread, one at
 * a time, with SIGPIPE blocked. */
bool hk_video_feed(hk_video *, const unsigned char *rgba);
/* Waits until all is encoded. When that fails, `why` is the last line that ffmpeg wrote. */
hk_video_result hk_video_end(hk_video *, const hk_stop *, char *why, size_t size);
/* Ends ffmpeg at once, so that no one waits for it any more; hk_video_end or hk_video_abandon has to follow. */
void hk_video_kill(const hk_video *);
/* Ends ffmpeg and removes its file. */
void hk_video_abandon(hk_video *);

#endif
