/* PNG pictures of the scene, and a video of them when ffmpeg is installed. A picture is drawn immediately when nothing
 * in it depends on later frames. When the camera, the range of colours or the floor is chosen for the whole motion,
 * frames are stored in an unlinked file and drawn at the end, for any verdict. */
#include "core/plugin.h"
#include "plugins/common/gl/gl_context.h"
#include "plugins/common/picture/legend.h"
#include "plugins/common/picture/painter.h"
#include "plugins/common/picture/framing.h"
#include "plugins/common/film/png_file.h"
#include "plugins/common/film/video.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

enum { AUTO, ON, OFF };

typedef struct frames {
  int64_t width, height, every;
  const char *color, *folder, *video_file;
  double camera[3], target[3], fov, radius, ground_height, background[3];
  hk_numbers range;
  int springs, particles;
  bool ground, legend, video;

  const hk_host *host;
  hk_look look;
  hk_framing framing;
  hk_view_setup setup;
  bool waiting; /* frames are drawn at the end */
  bool changed; /* the topology may have changed since the last snapshot */
  hk_snapshot3d snapshot;
  hk_frame_spool spool;
  hk_gl_context *gl;
  hk_painter painter;
  uint8_t (*colour)[4]; /* one per particle */
  size_t colours;
  unsigned char *picture; /* width x height x 4 */
  uint8_t table[HK_MAP_SIZE][4];
  char label[64]; /* label of the legend */
  size_t pictures;
  double fps;
} frames;

/* clang-format off */
static const hk_param params[] = {
    {"width", "pixels", "width of the pictures",
     HK_INTEGER, {1280}, 16, 8192, offsetof(frames, width), 0, NULL},
    {"height", "pixels", "height of the pictures",
     HK_INTEGER, {720}, 16, 8192, offsetof(frames, height), 0, NULL},
    {"every", "frames", "draw every so many frames",
     HK_INTEGER, {1}, 1, 1e9, offsetof(frames, every), 0, NULL},
    {"color", "", "auto, none, strain, speed, group, or the name of a channel (of three numbers: red, green, blue)",
     HK_STRING, {0}, 0, 0, offsetof(frames, color), 0, "auto"},
    {"range", "", "smallest and largest number of the colours; left out: chosen from the whole motion",
     HK_NUMBERS, {0}, 0, 0, offsetof(frames, range), HK_OPTIONAL, NULL},
    {"camera", "m", "where the camera stands; left out: where it sees the whole motion",
     HK_VECTOR, {0}, 0, 0, offsetof(frames, camera), HK_OPTIONAL, NULL},
    {"target", "m", "what the camera looks at; left out: the middle",
     HK_VECTOR, {0}, 0, 0, offsetof(frames, target), HK_OPTIONAL, NULL},
    {"fov", "degrees", "angle from the bottom to the top of the picture",
     HK_NUMBER, {30}, 1, 150, offsetof(frames, fov), 0, NULL},
    {"springs", "", "draw springs; auto: those with an end outside all triangles",
     HK_CHOICE, {0}, 0, 0, offsetof(frames, springs), 0, "auto|on|off"},
    {"particles", "", "draw particles; auto: those outside all triangles, and pins",
     HK_CHOICE, {0}, 0, 0, offsetof(frames, particles), 0, "auto|on|off"},
    {"radius", "m", "radius of drawn particles; left out: chosen",
     HK_NUMBER, {0}, 0, 1e30, offsetof(frames, radius), HK_OPTIONAL, NULL},
    {"ground", "", "draw the floor with its grid and the shadow",
     HK_BOOLEAN, {1}, 0, 0, offsetof(frames, ground), 0, NULL},
    {"ground_height", "m", "height of the floor; left out: 0 or just below the motion",
     HK_NUMBER, {0}, 0, 0, offsetof(frames, ground_height), HK_OPTIONAL, NULL},
    {"background", "", "red, green and blue of the background, 0 to 1",
     HK_VECTOR, {0.66, 0.705, 0.755}, 0, 1, offsetof(frames, background), 0, NULL},
    {"legend", "", "draw the bar of colours",
     HK_BOOLEAN, {1}, 0, 0, offsetof(frames, legend), 0, NULL},
    {"video", "", "make a video of the pictures, with ffmpeg",
     HK_BOOLEAN, {1}, 0, 0, offsetof(frames, video), 0, NULL},
    {"folder", "", "folder of the pictures, inside the output folder",
     HK_STRING, {0}, 0, 0, offsetof(frames, folder), 0, "frames"},
    {"video_file", "", "name of the video, inside the output folder",
     HK_STRING, {0}, 0, 0, offsetof(frames, video_file), 0, "video.mp4"},
    {0},
};
/* clang-format on */

static void make_plan(frames *f) {
  f->framing = (hk_framing){.fov = f->fov * acos(-1) / 180, .aspect = (double)f->width / (double)f->height};
  memcpy(f->framing.eye, f->camera, sizeof f->camera);
  memcpy(f->framing.target, f->target, sizeof f->target);
  f->framing.floor = f->ground, f->framing.height = f->ground_height, f->framing.radius = f->radius;
  f->framing.centred = f->look.paint == HK_PAINT_STRAIN;
  f->framing.counted = f->framing.centred || f->look.paint == HK_PAINT_SPEED || f->look.paint == HK_PAINT_CHANNEL;
  f->framing.low = f->range.count ? f->range.value[0] : NAN;
  f->framing.high = f->range.count ? f->range.value[1] : NAN;
  for (int c = 0; c < 3; c++) f->setup.background[c] = (float)f->background[c];
  hk_colormap_fill(f->framing.centred ? HK_MAP_DIVERGING : HK_MAP_SEQUENTIAL, f->table);
  f->waiting =
      isnan(f->camera[0]) || (f->ground && isnan(f->ground_height)) || (f->framing.counted && isnan(f->framing.low));
}

/* Checks the colouring at the start of the run; `open` chooses it again, when the forces' elements are known. */
static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  frames *f = self;
  const char *label;
  f->host = host;
  f->look.springs = f->springs, f->look.particles = f->particles;
  if (f->range.count != 0 && (f->range.count != 2 || f->range.value[0] >= f->range.value[1]))
    return host->fail(host, HK_BAD_PARAM, "range: expected two numbers, the smaller first");
  return hk_look_choose(&f->look, host, view->model, f->color, &label);
}

static hk_status open(void *self, const hk_view *view, const hk_frame *frame) {
  frames *f = self;
  const hk_host *host = view->host;
  const char *why, *label;
  char name[PATH_MAX];
  hk_status status = hk_look_choose(&f->look, host, view->model, f->color, &label);
  if (status != HK_OK) return status;
  snprintf(f->label, sizeof f->label, "%s", label);
  make_plan(f);
  f->gl = hk_gl_context_create(&why);
  if (!f->gl) return host->fail(host, HK_FAILED, "%s", why);
  status = hk_painter_open(&f->painter, host, (int)f->width, (int)f->height);
  if (status != HK_OK) return status;
  f->picture = host->allocate(host, (size_t)f->width * (size_t)f->height * 4);
  if (!f->picture) return host->fail(host, HK_NO_MEMORY, "no memory for the picture");
  f->fps = frame->fps / (double)f->every;
  f->changed = true;
  snprintf(name, sizeof name, "%s/.waiting-XXXXXX", f->folder);
  return f->waiting ? hk_frame_spool_open(&f->spool, host, name) : HK_OK;
}

static hk_status colour_particles(frames *f) {
  static const uint8_t plain[4] = {84, 132, 190, 255};
  const hk_snapshot3d *s = &f->snapshot;
  if (s->n >= f->colours) {
    f->host->release(f->host, f->colour);
    f->colours = s->n + s->n / 2 + 1;
    f->colour = f->host->allocate(f->host, f->colours * sizeof *f->colour);
    if (!f->colour) return f->host->fail(f->host, HK_NO_MEMORY, "no memory for the colours of %zu particles", s->n);
  }
  for (size_t i = 0; i < s->n; i++) {
    uint32_t group;
    memcpy(&group, &s->ink[i], sizeof group);
    if (f->framing.counted)
      hk_colormap_look(f->table, f->framing.low, f->framing.high, (double)s->ink[i].number, f->colour[i]);
    else if (f->look.paint == HK_PAINT_GROUP)
      hk_colormap_group(group, f->colour[i]);
    else
      memcpy(f->colour[i], f->look.paint == HK_PAINT_RGB ? s->ink[i].colour : plain, 4);
  }
  return HK_OK;
}

static hk_status draw(frames *f) {
  char name[PATH_MAX], path[PATH_MAX], why[256];
  double percent = f->framing.centred ? 100 : 1;
  hk_status status = colour_particles(f);
  if (status == HK_OK) status = hk_painter_draw(&f->painter, &f->setup, &f->snapshot, f->colour);
  if (status != HK_OK) return status;
  if (f->legend && f->framing.counted)
    hk_legend_draw(&f->painter, &(hk_legend){f->label, percent * f->framing.low, percent * f->framing.high, f->table});
  status = hk_painter_read(&f->painter, &f->setup, f->picture);
  if (status != HK_OK) return status;
  snprintf(name, sizeof name, "%s/%06zu.png", f->folder, f->pictures);
  status = f->host->path(f->host, name, path, sizeof path);
  if (status != HK_OK) return status;
  if (hk_png_write(path, (int)f->width, (int)f->height, f->picture, why, sizeof why) != 0)
    return f->host->fail(f->host, HK_IO, "cannot write %s: %s", path, why);
  f->pictures++;
  return HK_OK;
}

static hk_status frame(void *self, const hk_view *view, const hk_frame *now) {
  frames *f = self;
  if (now->index % (size_t)f->every != 0) return HK_OK;
  hk_status status = hk_snapshot3d_take(&f->snapshot, view, &f->look, f->changed);
  if (status != HK_OK) return status;
  f->changed = false;
  if (f->waiting) return hk_frame_spool_add(&f->spool, &f->snapshot);
  hk_framing_snapshot(&f->framing, &f->snapshot, &f->setup);
  if (!hk_gl_context_use(f->gl)) return f->host->fail(f->host, HK_FAILED, "OpenGL cannot make its context current");
  return draw(f);
}

/* Draws the stored frames. A frame that reaches five times (diverged) or a thousand times as far as the median frame is
 * drawn as well, but ignored in the choice of the camera. */
static hk_status draw_waiting(frames *f, hk_verdict verdict) {
  if (!f->spool.count) return HK_OK;
  hk_status status =
      hk_framing_motion(&f->framing, &f->spool, &f->snapshot, verdict == HK_DIVERGED ? 5 : 1000, &f->setup);
  for (size_t k = 0; k < f->spool.count && status == HK_OK; k++) {
    status = hk_frame_spool_read(&f->spool, k, &f->snapshot);
    if (status == HK_OK) status = draw(f);
  }
  return status;
}

static hk_status make_video(frames *f) {
  char name[PATH_MAX], first[PATH_MAX], file[PATH_MAX], why[256] = "";
  snprintf(name, sizeof name, "%s/000000.png", f->folder);
  hk_status status = f->host->path(f->host, name, first, sizeof first);
  if (status != HK_OK) return status;
  *strrchr(first, '/') = 0;
  if (!hk_video_possible()) {
    f->host->warn(
        f->host,
        "no video: there is no program ffmpeg; the pictures are in %s, and where there is one, this makes the "
        "video: ffmpeg -framerate %g -i %s/%%06d.png -pix_fmt yuv420p %s",
        first, f->fps, first, f->video_file);
    return HK_OK;
  }
  status = f->host->path(f->host, f->video_file, file, sizeof file);
  if (status != HK_OK) return status;
  if (hk_video_make(first, f->pictures, f->fps, file, why, sizeof why) != HK_VIDEO_MADE)
    f->host->warn(f->host, "no video: ffmpeg: %s; the pictures are in %s", why, first);
  return HK_OK;
}

static hk_status close(void *self, hk_verdict verdict) {
  frames *f = self;
  if (!hk_gl_context_use(f->gl)) return f->host->fail(f->host, HK_FAILED, "OpenGL cannot make its context current");
  hk_status status = f->waiting ? draw_waiting(f, verdict) : HK_OK;
  if (status == HK_OK && f->video && f->pictures > 0) status = make_video(f);
  return status;
}

static void destroy(void *self, const hk_host *host) {
  frames *f = self;
  (void)host;
  if (f->gl && hk_gl_context_use(f->gl)) hk_painter_close(&f->painter);
  hk_gl_context_destroy(f->gl);
  hk_frame_spool_close(&f->spool);
  hk_snapshot3d_free(&f->snapshot);
}

static hk_status topology(void *self, const hk_view *view) {
  frames *f = self;
  (void)view;
  f->changed = true;
  return HK_OK;
}

static const hk_output output = {.size = sizeof(hk_output), .open = open, .frame = frame, .close = close};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_OUTPUT,
    .name = "frames",
    .summary = "PNG pictures of the scene, and a video of them",
    .reference = "",
    .instance_size = sizeof(frames),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .output = &output,
};
