#include "plugins/common/film/film.h"

#include "plugins/common/camera/follow.h"
#include "plugins/common/film/obstacle_solids.h"
#include "plugins/common/picture/legend.h"
#include "plugins/common/snapshot/ink.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

/* Is there anything to choose by the whole motion? */
static bool has_to_wait(const hk_film *f) {
  const hk_framing *framing = &f->framing;
  return f->stills > 0 || f->follow || isnan(f->setup.sprites.opacity) || isnan(framing->eye[0]) ||
         (framing->floor && isnan(framing->height)) || f->look.sizes == HK_SIZE_MASS ||
         (framing->counted && isnan(framing->scale.low));
}

static hk_status make_solids(hk_film *f) {
  size_t count = f->solids + (f->obstacles ? f->obstacles->count : 0);
  if (count == 0) return HK_OK;
  f->snapshot.solid = f->host->allocate(f->host, count * sizeof *f->snapshot.solid);
  if (!f->snapshot.solid) return f->host->fail(f->host, HK_NO_MEMORY, "no memory for %zu solids", count);
  if (f->solids) memcpy(f->snapshot.solid, f->solid, f->solids * sizeof *f->solid);
  f->snapshot.solids = count;
  return HK_OK;
}

static void draw_legend(hk_painter *painter, void *film) {
  hk_film *f = film;
  hk_legend legend = {f->text, f->framing.scale, f->table, hk_is_dark(f->setup.background)};
  if (f->look.paint == HK_PAINT_STRAIN) legend.scale.low *= 100, legend.scale.high *= 100; /* per cent */
  hk_legend_draw(painter, &legend);
}

hk_status hk_film_open(hk_film *f, const hk_host *host) {
  const char *why;
  char name[PATH_MAX];
  f->host = host;
  hk_snapshot3d_open(&f->snapshot, host, &f->look);
  hk_status status = hk_reel_open(&f->reel, host, f->width, f->height);
  if (status == HK_OK) status = make_solids(f);
  if (status != HK_OK) return status;
  hk_colormap_fill(f->map, f->reverse, f->table);
  f->gl = hk_gl_context_create(&why);
  if (!f->gl) return host->fail(host, HK_FAILED, "%s", why);
  status = hk_painter_open(&f->painter, host, f->width, f->height);
  if (status != HK_OK) return status;
  if (f->legend && f->framing.counted) f->painter.overlay = draw_legend, f->painter.overlay_context = f;
  f->picture = host->allocate(host, (size_t)f->width * (size_t)f->height * 4);
  if (!f->picture) return host->fail(host, HK_NO_MEMORY, "no memory for the picture");
  snprintf(f->text, sizeof f->text, f->unit ? "%.60s %.30s" : "%.60s", f->label, f->unit);
  f->waiting = has_to_wait(f);
  snprintf(name, sizeof name, "%s/.waiting-XXXXXX", f->reel.folder);
  return f->waiting ? hk_frame_spool_open(&f->spool, host, name) : HK_OK;
}

static hk_status make_colours(hk_film *f, size_t n) {
  if (n < f->colours) return HK_OK;
  f->host->release(f->host, f->colour);
  f->colours = n + n / 2 + 1;
  f->colour = f->host->allocate(f->host, f->colours * sizeof *f->colour);
  if (f->colour) return HK_OK;
  f->colours = 0;
  return f->host->fail(f->host, HK_NO_MEMORY, "no memory for the colours of %zu particles", n);
}

static void plain_colour(const hk_film *f, uint8_t colour[4]) {
  static const uint8_t blue[4] = {84, 132, 190, 255};
  memcpy(colour, blue, sizeof blue);
  for (int c = 0; c < 3 && !isnan(f->plain[0]); c++) colour[c] = (uint8_t)(255 * f->plain[c] + 0.5);
}

static void colour_particles(hk_film *f) {
  uint8_t plain[4];
  plain_colour(f, plain);
  const hk_snapshot3d *s = &f->snapshot;
  const float *fade = s->extra[HK_EXTRA_FADE];
  for (size_t i = 0; i < s->n; i++) {
    uint32_t group;
    memcpy(&group, &s->ink[i], sizeof group);
    if (f->framing.counted)
      hk_colormap_look(f->table, hk_scale_place(&f->framing.scale, (double)s->ink[i].number), f->colour[i]);
    else if (f->look.paint == HK_PAINT_GROUP)
      hk_colormap_group(group, f->colour[i]);
    else
      memcpy(f->colour[i], f->look.paint == HK_PAINT_RGB ? s->ink[i].colour : plain, 4);
    if (fade) f->colour[i][3] = (uint8_t)(255 * fade[i] + 0.5f);
  }
}

/* Exposes for the frame with the most particles, the one in the middle if it is one of them. */
static hk_status expose(hk_film *f) {
  const hk_frame_spool_entry *entry = f->spool.entry;
  size_t best = f->spool.count / 2;
  if (!isnan(f->setup.sprites.opacity)) return HK_OK;
  for (size_t k = 0; k < f->spool.count; k++)
    if (entry[k].n > entry[best].n) best = k;
  hk_status status = hk_frame_spool_read(&f->spool, best, &f->snapshot);
  if (status == HK_OK) status = make_colours(f, f->snapshot.n);
  if (status != HK_OK) return status;
  colour_particles(f);
  return hk_painter_expose(&f->painter, &f->setup, &f->snapshot, f->colour);
}

static hk_status draw(hk_film *f) {
  hk_status status = make_colours(f, f->snapshot.n);
  if (status != HK_OK) return status;
  colour_particles(f);
  hk_framing_move(&f->snapshot, &f->setup);
  status = hk_painter_draw(&f->painter, &f->setup, &f->snapshot, f->colour);
  if (status != HK_OK) return status;
  status = hk_painter_read(&f->painter, &f->setup, f->picture);
  return status == HK_OK ? hk_reel_add(&f->reel, f->picture) : status;
}

static hk_status use_context(hk_film *f) {
  if (hk_gl_context_use(f->gl)) return HK_OK;
  return f->host->fail(f->host, HK_FAILED, "OpenGL cannot make its context current");
}

hk_status hk_film_add(hk_film *f, const hk_view *view, const double *birth, bool changed) {
  hk_status status = hk_snapshot3d_take(&f->snapshot, view, changed);
  if (status != HK_OK) return status;
  hk_ink_take(&f->snapshot, view, birth);
  if (f->obstacles) hk_obstacle_solids(f->obstacles, f->look.y_up, f->snapshot.solid + f->solids);
  memcpy(f->snapshot.eye, f->framing.eye, sizeof f->snapshot.eye);
  memcpy(f->snapshot.target, f->framing.target, sizeof f->snapshot.target);
  if (f->waiting) return hk_frame_spool_add(&f->spool, &f->snapshot);
  hk_framing_snapshot(&f->framing, &f->snapshot, &f->setup);
  status = use_context(f);
  return status == HK_OK ? draw(f) : status;
}

/* A frame that reaches five times (diverged) or a thousand times as far as the median frame is drawn as well, but
 * ignored in the choice of the camera. */
static hk_status draw_waiting(hk_film *f, hk_verdict verdict) {
  hk_status status = use_context(f);
  if (status == HK_OK)
    status = hk_framing_motion(&f->framing, &f->spool, &f->snapshot, verdict == HK_DIVERGED ? 5 : 1000, &f->setup);
  if (status == HK_OK && f->follow)
    status = hk_follow(&f->framing, &f->spool, f->snapshot.origin, f->reel.fps, &f->setup);
  if (status == HK_OK) status = expose(f);
  if (status == HK_OK) status = hk_sheet_open(&f->sheet, f->host, f->stills, f->spool.count, f->width, f->height);
  for (size_t k = 0; k < f->spool.count && status == HK_OK; k++) {
    if (hk_reel_stopped(&f->reel))
      return f->host->fail(f->host, HK_INTERRUPTED, "interrupted: %zu of %zu pictures are drawn", k, f->spool.count);
    status = hk_frame_spool_read(&f->spool, k, &f->snapshot);
    if (status == HK_OK) status = draw(f);
    if (status == HK_OK) hk_sheet_take(&f->sheet, k, f->picture);
  }
  if (status == HK_OK) status = hk_sheet_write(&f->sheet, "sheet.png");
  return status;
}

hk_status hk_film_finish(hk_film *f, hk_verdict verdict) {
  hk_status status = f->waiting && f->spool.count ? draw_waiting(f, verdict) : HK_OK;
  return status == HK_OK ? hk_reel_finish(&f->reel) : status;
}

void hk_film_free(hk_film *f) {
  if (f->gl && hk_gl_context_use(f->gl)) hk_painter_close(&f->painter);
  hk_gl_context_destroy(f->gl);
  f->gl = NULL;
  hk_reel_free(&f->reel);
  hk_sheet_free(&f->sheet);
  hk_frame_spool_close(&f->spool);
  if (f->host) f->host->release(f->host, f->snapshot.solid);
  hk_snapshot3d_free(&f->snapshot);
  if (f->host) f->host->release(f->host, f->colour), f->host->release(f->host, f->picture);
  f->colour = NULL, f->picture = NULL, f->colours = 0;
}
