#include "plugins/common/film/film_files.h"

#include "plugins/common/film/png_file.h"

#include <stdio.h>
#include <string.h>

enum { PICTURES, VIDEO }; /* outlets */

static bool take_picture(void *self, const hk_still *still) {
  hk_film_files *r = self;
  return hk_png_write(still->path, r->width, r->height, still->rgba, r->trouble, sizeof r->trouble) == 0;
}

static bool take_frame(void *self, const hk_still *still) {
  hk_film_files *r = self;
  return hk_video_feed(&r->video, still->rgba);
}

bool hk_film_files_stopped(void *files) {
  const hk_film_files *r = files;
  return r->interruption && r->interruption->again(r->interruption->self);
}

hk_status hk_film_files_check(const hk_film_files *r, const hk_host *host, int width, int height) {
  if (r->file && (width % 2 || height % 2))
    return host->fail(host, HK_BAD_PARAM,
                      "a video has an even width and height, not %d x %d: take %d x %d, or video = false", width,
                      height, width + width % 2, height + height % 2);
  if (r->file && !r->pictures && !hk_video_possible())
    return host->fail(host, HK_FAILED, "pictures = false, and there is no program ffmpeg to make a video: install it");
  return HK_OK;
}

void hk_film_files_open(hk_film_files *r, const hk_host *host, int width, int height) {
  r->host = host, r->width = width, r->height = height;
  r->interruption = host->query(host, "interruption/1");
  r->possible = r->file && hk_video_possible();
}

/* At the first picture: a run without any leaves no file. */
static hk_status begin(hk_film_files *r) {
  char file[PATH_MAX];
  hk_film_outlet outlet[] = {[PICTURES] = {take_picture, r}, [VIDEO] = {take_frame, r}};
  hk_status status = r->possible ? r->host->path(r->host, r->file, file, sizeof file) : HK_OK;
  if (status != HK_OK) return status;
  r->begun = HK_VIDEO_NO_PROGRAM;
  if (r->possible)
    r->begun = hk_video_begin(&r->video, r->width, r->height, r->host->lanes, r->fps, file, r->why, sizeof r->why);
  r->open = true;
  bool film = r->begun == HK_VIDEO_MADE;
  return hk_conveyor_open(&r->conveyor, r->host, (size_t)r->width * (size_t)r->height * 4,
                          outlet + (r->pictures ? PICTURES : VIDEO), (size_t)r->pictures + film);
}

/* Ends the program first, for which a thread may wait. */
static void stop(hk_film_files *r) {
  if (r->video.child > 0) hk_video_kill(&r->video);
  hk_conveyor_close(&r->conveyor);
  if (r->video.child > 0) hk_video_abandon(&r->video);
}

static hk_status interrupted(hk_film_files *r) {
  stop(r);
  return r->host->fail(r->host, HK_INTERRUPTED, "interrupted: no video%s%s",
                       r->pictures ? "; the pictures are in " : "", r->pictures ? r->folder : "");
}

static hk_status check_pictures(hk_film_files *r) {
  if (!r->pictures || !hk_conveyor_failed(&r->conveyor, 0)) return HK_OK;
  stop(r);
  return r->host->fail(r->host, HK_IO, "cannot write %s: %s", r->path, r->trouble);
}

/* A run that is asked to end still has its pictures written, unless there is no room for one after two seconds: then
 * ffmpeg hangs. */
typedef struct last_chance {
  hk_film_files *files;
  int looks; /* ten a second */
} last_chance;

static bool has_no_more_patience(void *self) {
  last_chance *l = self;
  return hk_film_files_stopped(l->files) && ++l->looks > 20;
}

hk_status hk_film_files_add(hk_film_files *r, const unsigned char *rgba) {
  char name[PATH_MAX];
  last_chance chance = {r, 0};
  hk_stop asked = {has_no_more_patience, &chance};
  if (!r->file && !r->pictures) return HK_OK;
  hk_status status = r->open ? HK_OK : begin(r);
  if (status == HK_OK) status = check_pictures(r);
  snprintf(name, sizeof name, "%s/%06zu.png", r->folder, r->count);
  if (status == HK_OK && r->pictures) status = r->host->path(r->host, name, r->path, sizeof r->path);
  if (status != HK_OK) return status;
  if (!hk_conveyor_put(&r->conveyor, rgba, r->path, &asked)) return interrupted(r);
  r->count++;
  return HK_OK;
}

/* Where there is no program, how to make the video where there is one. */
static void warn_of_no_video(hk_film_files *r) {
  char folder[PATH_MAX];
  snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(r->path, '/') - r->path), r->path);
  r->host->warn(r->host,
                "no video: there is no program ffmpeg; the pictures are in %s, and where there is one, this makes the "
                "video: ffmpeg -framerate %g -i %s/%%06d.png -pix_fmt yuv420p %s",
                folder, r->fps, folder, r->file);
}

static hk_status finish_video(hk_film_files *r) {
  hk_stop asked = {hk_film_files_stopped, r};
  hk_video_result result = r->begun;
  if (result == HK_VIDEO_MADE) result = hk_video_end(&r->video, &asked, r->why, sizeof r->why);
  if (result == HK_VIDEO_STOPPED) return interrupted(r);
  if (result == HK_VIDEO_MADE) return HK_OK;
  if (!r->pictures) return r->host->fail(r->host, HK_IO, "no video: ffmpeg: %s", r->why);
  if (result == HK_VIDEO_NO_PROGRAM)
    warn_of_no_video(r);
  else
    r->host->warn(r->host, "no video: ffmpeg: %s; the pictures are in %s", r->why, r->folder);
  return HK_OK;
}

hk_status hk_film_files_finish(hk_film_files *r) {
  if (!r->open) return HK_OK;
  hk_stop asked = {hk_film_files_stopped, r};
  if (!hk_conveyor_drain(&r->conveyor, &asked)) return interrupted(r);
  hk_status status = check_pictures(r);
  if (status != HK_OK || !r->file) return status;
  hk_conveyor_close(&r->conveyor); /* no thread is left that could hand over a picture */
  return finish_video(r);
}

void hk_film_files_free(hk_film_files *r) {
  if (!r->host) return;
  stop(r);
  *r = (hk_film_files){0};
}
