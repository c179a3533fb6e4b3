#include "plugins/common/film/film.h"

#include "plugins/common/colour/palette.h"

#include "plugins/common/camera/follow.h"
#include "plugins/common/frame_data/obstacle_solids.h"
#include "plugins/common/frame_data/skin_solids.h"
#include "plugins/common/picture/legend.h"
#include "plugins/common/snapshot/particle_colour.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>

static const char sheet_name[] = "sheet.png";

/* Is there anything to choose by the whole motion? */
static bool has_to_wait(const hk_film *f) {
  const hk_framing *framing = &f->framing;
  return f->stills > 0 || f->follow || isnan(f->setup.sprites.opacity) || framing->viewports > 1 ||
         !framing->viewport[0].own || isnan(f->own.eye[0]) || (framing->floor && isnan(framing->height)) ||
         f->appearance.sizes == HK_SIZE_MASS || (framing->counted && isnan(framing->scale.low));
}

static hk_status make_solids(hk_film *f) {
  size_t count = f->solids + (f->obstacles ? f->obstacles->count : 0) + f->skins + (f->liquid != NULL);
  if (count == 0) return HK_OK;
  f->snapshot.solid = f->host->allocate(f->host, count * sizeof *f->snapshot.solid);
  if (!f->snapshot.solid) return f->host->fail(f->host, HK_NO_MEMORY, "no memory for %zu solids", count);
  if (f->solids) memcpy(f->snapshot.solid, f->solid, f->solids * sizeof *f->solid);
  f->snapshot.obstacles = count - f->skins - (f->liquid != NULL);
  f->snapshot.solids = count, f->snapshot.liquid = f->liquid != NULL;
  return HK_OK;
}

/* Bodies and liquids have colours of their own: where nothing else is seen, the bar would say nothing. */
static bool has_legend(const hk_film *f) { return f->legend && f->framing.counted && f->painted; }

static void saturates(const hk_film *f, bool beyond[2]) {
  hk_scale_saturates(&f->framing.scale, f->least, f->most, HK_MAP_SIZE, beyond);
}

/* The name of the view, and in the first the legend. */
static void draw_overlay(hk_painter *painter, void *film) {
  hk_film *f = film;
  hk_legend_name(painter, f->framing.viewport[f->view].name, hk_is_dark(f->setup.background));
  if (f->view > 0 || f->bare || !has_legend(f)) return;
  hk_legend legend = {f->text, f->framing.scale, f->table, hk_is_dark(f->setup.background), {0}};
  saturates(f, legend.beyond);
  if (f->appearance.paint == HK_PAINT_STRAIN) legend.scale.low *= 100, legend.scale.high *= 100; /* per cent */
  hk_legend_draw(painter, &legend);
}

/* Between views a picture is white. */
static hk_status open_views(hk_film *f) {
  const hk_host *host = f->host;
  size_t bytes = (size_t)f->width * (size_t)f->height * 4;
  bool several = f->framing.viewports > 1;
  f->grid = hk_view_grid_for(f->framing.viewports, f->width, f->height);
  f->framing.aspect = (double)f->grid.width / f->grid.height;
  hk_status status = hk_painter_open(&f->painter, host, f->grid.width, f->grid.height);
  if (status != HK_OK) return status;
  f->painter.overlay = draw_overlay, f->painter.overlay_context = f;
  f->picture = host->allocate(host, bytes);
  if (several) f->cell = host->allocate(host, (size_t)f->grid.width * (size_t)f->grid.height * 4);
  if (!f->picture || (several && !f->cell)) return host->fail(host, HK_NO_MEMORY, "no memory for the picture");
  memset(f->picture, 255, bytes);
  return HK_OK;
}

/* What is written at the end is asked for at the start: no other output may have it. */
static hk_status claim_files(const hk_film *f) {
  char path[PATH_MAX];
  const hk_film_files *files = &f->files;
  hk_status status = files->possible ? f->host->path(f->host, files->file, path, sizeof path) : HK_OK;
  return status == HK_OK && f->stills ? f->host->path(f->host, sheet_name, path, sizeof path) : status;
}

static void plain_colour(const hk_film *f, uint8_t colour[4]) {
  memcpy(colour, hk_palette_colours[HK_PALETTE_PLAIN], 4);
  for (int c = 0; c < 3 && !isnan(f->plain[0]); c++) colour[c] = (uint8_t)(255 * f->plain[c] + 0.5);
}

hk_status hk_film_open(hk_film *f, const hk_host *host) {
  const char *why;
  char name[PATH_MAX];
  f->host = host;
  f->least = INFINITY, f->most = -INFINITY;
  hk_snapshot3d_open(&f->snapshot, host, &f->appearance);
  hk_film_files_open(&f->files, host, f->width, f->height);
  hk_status status = claim_files(f);
  if (status == HK_OK) status = make_solids(f);
  if (status != HK_OK) return status;
  hk_colormap_fill(f->map, f->reverse, f->table);
  f->gl = hk_gl_context_create(&why);
  if (!f->gl) return host->fail(host, HK_FAILED, "%s", why);
  status = open_views(f);
  if (status != HK_OK) return status;
  snprintf(f->text, sizeof f->text, f->unit ? "%.60s %.30s" : "%.60s", f->label, f->unit);
  f->waiting = has_to_wait(f);
  if (f->liquid) plain_colour(f, f->liquid->colour);
  if (f->liquid && f->waiting && isnan(f->framing.radius)) f->framing.radius = f->liquid_radius;
  snprintf(name, sizeof name, "%s/.waiting-XXXXXX", f->files.folder);
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

static void colour_particles(hk_film *f) {
  uint8_t plain[4];
  plain_colour(f, plain);
  const hk_snapshot3d *s = &f->snapshot;
  const float *fade = s->extra[HK_EXTRA_FADE];
  for (size_t i = 0; i < s->n; i++) {
    uint32_t group;
    memcpy(&group, &s->colour[i], sizeof group);
    if (f->framing.counted)
      hk_colormap_colour(f->table, hk_scale_place(&f->framing.scale, (double)s->colour[i].number), f->colour[i]);
    else if (f->appearance.paint == HK_PAINT_GROUP)
      hk_colormap_group(group, f->colour[i]);
    else
      memcpy(f->colour[i], f->appearance.paint == HK_PAINT_RGB ? s->colour[i].colour : plain, 4);
    if (fade) f->colour[i][3] = (uint8_t)(255 * fade[i] + 0.5f);
  }
}

/* Places the camera of this view for picture k. */
static void aim(hk_film *f, size_t k) {
  const hk_viewport *port = f->framing.viewport + f->view;
  hk_camera_place place = {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
  if (f->way)
    place = f->way[f->view * f->spool.count + k];
  else if (port->own) {
    memcpy(place.eye, f->snapshot.eye, sizeof place.eye);
    memcpy(place.target, f->snapshot.target, sizeof place.target);
  }
  hk_framing_move(f->waiting ? &port->camera : &f->setup.camera, &place, f->snapshot.origin, &f->setup);
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
  aim(f, best);
  return hk_painter_expose(&f->painter, &f->setup, &f->snapshot, f->colour);
}

static hk_status draw_view(hk_film *f, size_t k) {
  bool several = f->framing.viewports > 1;
  aim(f, k);
  if (several) f->painter.kept = false; /* the surroundings are another view's */
  hk_status status = hk_painter_draw(&f->painter, &f->setup, &f->snapshot, f->colour);
  if (status == HK_OK) status = hk_painter_read(&f->painter, &f->setup, several ? f->cell : f->picture);
  if (several) hk_view_grid_put(&f->grid, f->view, f->cell, f->picture);
  return status;
}

/* Picture k. */
static hk_status draw(hk_film *f, size_t k) {
  hk_status status = make_colours(f, f->snapshot.n);
  if (status != HK_OK) return status;
  colour_particles(f);
  for (f->view = 0; f->view < f->framing.viewports && status == HK_OK; f->view++) status = draw_view(f, k);
  f->view = 0;
  return status;
}

static hk_status use_context(hk_film *f) {
  if (hk_gl_context_use(f->gl)) return HK_OK;
  return f->host->fail(f->host, HK_FAILED, "OpenGL cannot make its context current");
}

/* Frames that wait show where the whole motion saturates; those that are drawn at once, the motion so far: then the
 * legend, which is kept with the surroundings, is drawn anew. */
static void note_numbers(hk_film *f) {
  bool before[2], after[2];
  const hk_snapshot3d *s = &f->snapshot;
  if (!has_legend(f)) return;
  saturates(f, before);
  for (size_t i = 0; i < s->n; i++) {
    double number = (double)s->colour[i].number;
    if (isfinite(number)) f->least = fmin(f->least, number), f->most = fmax(f->most, number);
  }
  saturates(f, after);
  if (memcmp(before, after, sizeof before) != 0) f->painter.kept = false;
}

/* Rigid bodies have the colour of their group where groups have colours; those of the first, which has no name, that of
 * all bodies. */
static void take_skins(const hk_film *f, const hk_view *view, hk_frame_solid *solid) {
  hk_skin_solids(view, f->appearance.y_up, solid, f->skins);
  for (size_t k = 0; k < f->skins && f->appearance.paint == HK_PAINT_GROUP; k++)
    if (solid[k].group > 1) hk_colormap_group(solid[k].group - 1, solid[k].colour);
}

hk_status hk_film_add(hk_film *f, const hk_view *view, const hk_frame *frame, const double *birth, bool changed) {
  hk_status status = hk_snapshot3d_take(&f->snapshot, view, changed);
  if (status == HK_OK) status = hk_particle_colours_take(&f->snapshot, view, frame, birth);
  if (status != HK_OK) return status;
  f->painted |= f->snapshot.painted;
  note_numbers(f);
  if (f->obstacles) hk_obstacle_solids(f->obstacles, f->appearance.y_up, f->snapshot.solid + f->solids);
  size_t liquid = f->snapshot.solids - (f->liquid != NULL);
  if (f->liquid) f->snapshot.solid[liquid] = *f->liquid, f->snapshot.normal = f->liquid_normal;
  if (f->skins) take_skins(f, view, f->snapshot.solid + liquid - f->skins);
  memcpy(f->snapshot.eye, f->own.eye, sizeof f->snapshot.eye);
  memcpy(f->snapshot.target, f->own.target, sizeof f->snapshot.target);
  for (size_t p = 0; p < f->framing.viewports; p++)
    if (f->framing.viewport[p].own) f->framing.viewport[p].given = f->own;
  if (f->waiting) return hk_frame_spool_add(&f->spool, &f->snapshot);
  hk_framing_snapshot(&f->framing, &f->snapshot, &f->setup);
  f->painter.volumes = f->volumes, f->painter.volume_optics = f->volume_optics;
  memcpy(f->painter.volume_origin, f->snapshot.origin, sizeof f->snapshot.origin);
  status = use_context(f);
  if (status == HK_OK) status = draw(f, 0);
  return status == HK_OK ? hk_film_files_add(&f->files, f->picture) : status;
}

static hk_status follow(hk_film *f) {
  size_t count = f->framing.viewports, frames = f->spool.count;
  f->way = f->host->allocate(f->host, count * frames * sizeof *f->way);
  if (!f->way) return f->host->fail(f->host, HK_NO_MEMORY, "no memory for the ways of %zu cameras", count);
  hk_status status = HK_OK;
  for (size_t p = 0; p < count && status == HK_OK; p++)
    status =
        hk_follow(f->framing.viewport + p, &f->spool, f->snapshot.origin, f->files.fps, &f->setup, f->way + p * frames);
  return status;
}

/* Stills have one legend for all, below them, in the size that it has on a picture. */
static hk_status take_still(hk_film *f, size_t k) {
  hk_status status = HK_OK;
  if (!hk_contact_sheet_wants(&f->sheet, k)) return HK_OK;
  if (f->sheet.footer) {
    f->bare = true, f->painter.kept = false;
    status = draw(f, k);
    f->bare = false, f->painter.kept = false;
  }
  if (status == HK_OK) hk_contact_sheet_take(&f->sheet, f->picture);
  return status;
}

static hk_status finish_sheet(hk_film *f) {
  if (f->sheet.footer && f->sheet.count) {
    hk_snapshot3d nothing = f->snapshot;
    hk_view_setup setup = f->setup;
    unsigned char *picture = f->framing.viewports > 1 ? f->cell : f->picture;
    nothing.n = nothing.triangles = nothing.cloth = nothing.rigid = nothing.lines = nothing.solids = nothing.obstacles =
        0;
    nothing.liquid = false;
    setup.floor = setup.shadows = f->painter.kept = false;
    hk_status status = hk_painter_draw(&f->painter, &setup, &nothing, f->colour);
    if (status == HK_OK) status = hk_painter_read(&f->painter, &setup, picture);
    if (status != HK_OK) return status;
    hk_contact_sheet_fill_footer(&f->sheet, picture, f->grid.width);
  }
  return hk_contact_sheet_write(&f->sheet, sheet_name);
}

/* A frame that reaches five times (diverged) or a thousand times as far as the median frame is drawn as well, but
 * ignored in the choice of the camera. */
static hk_status draw_waiting(hk_film *f, hk_verdict verdict) {
  hk_status status = use_context(f);
  if (status == HK_OK)
    status = hk_framing_motion(&f->framing, &f->spool, &f->snapshot, verdict == HK_DIVERGED ? 5 : 1000, &f->setup);
  if (status == HK_OK && f->follow) status = follow(f);
  if (status == HK_OK) status = expose(f);
  int footer = has_legend(f) ? hk_legend_height(&f->painter) : 0;
  if (status == HK_OK)
    status = hk_contact_sheet_open(&f->sheet, f->host, f->stills, f->spool.count, f->width, f->height, footer);
  for (size_t k = 0; k < f->spool.count && status == HK_OK; k++) {
    if (hk_film_files_stopped(&f->files))
      return f->host->fail(f->host, HK_INTERRUPTED, "interrupted: %zu of %zu pictures are drawn", k, f->spool.count);
    status = hk_frame_spool_read(&f->spool, k, &f->snapshot);
    if (status == HK_OK) status = draw(f, k);
    if (status == HK_OK) status = hk_film_files_add(&f->files, f->picture);
    if (status == HK_OK) status = take_still(f, k);
  }
  return status == HK_OK ? finish_sheet(f) : status;
}

hk_status hk_film_finish(hk_film *f, hk_verdict verdict) {
  hk_status status = f->waiting && f->spool.count ? draw_waiting(f, verdict) : HK_OK;
  return status == HK_OK ? hk_film_files_finish(&f->files) : status;
}

void hk_film_free(hk_film *f) {
  if (f->gl && hk_gl_context_use(f->gl)) hk_painter_close(&f->painter);
  hk_gl_context_destroy(f->gl);
  f->gl = NULL;
  hk_film_files_free(&f->files);
  hk_contact_sheet_free(&f->sheet);
  hk_frame_spool_close(&f->spool);
  if (f->host) f->host->release(f->host, f->snapshot.solid);
  hk_snapshot3d_free(&f->snapshot);
  void *all[] = {f->colour, f->picture, f->cell, f->way};
  for (size_t k = 0; k < sizeof all / sizeof *all && f->host; k++) f->host->release(f->host, all[k]);
  f->colour = NULL, f->picture = f->cell = NULL, f->way = NULL, f->colours = 0;
}
