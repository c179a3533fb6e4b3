/* The files of a film: a PNG of each picture, and a video of them when ffmpeg is there; both are written while the next
 * pictures are drawn. */
#ifndef HK_REEL_H
#define HK_REEL_H

#include "plugins/common/film/conveyor.h"
#include "plugins/common/film/video.h"

typedef struct hk_reel {
  /* To be set before hk_reel_open. */
  const char *folder; /* of the pictures, inside the run's */
  const char *file;   /* of the video, inside the run's folder; NULL: there is to be none */
  bool pictures;      /* whether there are to be PNG files */
  double fps;

  const hk_host *host;
  const hk_interruption *interruption;
  int width, height;
  bool open, possible;
  hk_video video;
  hk_video_result begun;
  hk_conveyor conveyor;
  char path[PATH_MAX], why[256], trouble[256]; /* of the last picture; of the video; of a picture that failed */
  size_t count;
} hk_reel;

/* HK_BAD_PARAM: a video cannot have this size, or there would be no file at all. */
hk_status hk_reel_open(hk_reel *, const hk_host *, int width, int height);
/* Width x height pixels of 4 bytes, the bottom row first. HK_INTERRUPTED: the user asks, once more, to stop. */
hk_status hk_reel_add(hk_reel *, const unsigned char *rgba);
/* Waits for all files, warns where there is no video. */
hk_status hk_reel_finish(hk_reel *);
/* Whether the user asks, once more, to stop: while the pictures of a run that has ended are drawn or made a video. */
bool hk_reel_stopped(void *reel);
void hk_reel_free(hk_reel *); /* a zeroed or freed one is allowed */

#endif
