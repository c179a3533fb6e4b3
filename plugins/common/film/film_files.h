/* The files of a film: a PNG file per picture, and a video of all if ffmpeg is there. Both are written by threads of
 * their own while the next pictures are drawn. */
#ifndef HK_FILM_FILES_H
#define HK_FILM_FILES_H

#include "plugins/common/film/conveyor.h"
#include "plugins/common/film/video.h"

typedef struct hk_film_files {
  /* To be set before hk_film_files_open. */
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
} hk_film_files;

/* Before a run, of a plan. HK_BAD_PARAM: a video cannot have this size. HK_FAILED: it is all there is to be, and
 * there is no ffmpeg. */
hk_status hk_film_files_check(const hk_film_files *, const hk_host *, int width, int height);
void hk_film_files_open(hk_film_files *, const hk_host *, int width, int height);
/* Width x height pixels of 4 bytes, the bottom row first. HK_INTERRUPTED: the user asks, once more, to stop. */
hk_status hk_film_files_add(hk_film_files *, const unsigned char *rgba);
/* Waits for all files, warns where there is no video. */
hk_status hk_film_files_finish(hk_film_files *);
/* Whether the user asks, once more, to stop: while the pictures of a run that has ended are drawn or made a video. */
bool hk_film_files_stopped(void *files);
void hk_film_files_free(hk_film_files *); /* a zeroed or freed one is allowed */

#endif
