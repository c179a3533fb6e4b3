/* Sprites become light in an image of floats, from the nearest to the farthest, so that those in front say how much is
 * seen of those behind; then it covers the picture. Sources of light, HK_STYLE_GLOW, are summed instead, in any order.
 * A sum whose strongest colour is s is shown divided by 1 + s, so that dense places keep the hue of their particles
 * and are never quite white, and laid over the picture p as 1 - (1 - p)(1 - own): what is faint is added. */
#include "plugins/common/sprites/sprites.h"

#include "plugins/common/sprites/depth_order.h"

#include <stdlib.h>
#include <string.h>

static const float FAINT = 1e-3f; /* light that is hardly seen: three steps above black */

typedef struct job {
  hk_sprites *sprites;
  const hk_sprite_shading *shading;
  unsigned char *rgba; /* the image's lower left pixel; NULL: the light is all that is wanted */
  size_t stride;       /* bytes of a row of the picture */
} job;

void hk_sprites_open(hk_sprites *s, const hk_host *host) {
  *s = (hk_sprites){.host = host};
  hk_srgb_fill(&s->srgb);
}

void hk_sprites_close(hk_sprites *s) {
  if (!s->host) return;
  void *all[] = {s->sprite, s->order, s->scratch, s->image.light, s->distance};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) s->host->release(s->host, all[k]);
  hk_bands_free(&s->bands, s->host);
  *s = (hk_sprites){0};
}

static void *renew(const hk_host *host, void *old, size_t count, size_t bytes) {
  host->release(host, old);
  return host->allocate(host, count * bytes);
}

static hk_status make_room(hk_sprites *s, size_t count) {
  if (count < s->room) return HK_OK;
  size_t room = count + count / 2 + 1;
  s->sprite = renew(s->host, s->sprite, room, sizeof *s->sprite);
  s->order = renew(s->host, s->order, room, sizeof *s->order);
  s->scratch = renew(s->host, s->scratch, 3 * room, sizeof *s->scratch);
  s->room = s->sprite && s->order && s->scratch ? room : 0;
  if (s->room) return HK_OK;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory to draw %zu particles", count);
}

static hk_status make_pixel_room(hk_sprites *s) {
  size_t pixels = (size_t)s->image.width * (size_t)s->image.height;
  if (pixels <= s->pixel_room) return HK_OK;
  s->image.light = renew(s->host, s->image.light, HK_PLANES * pixels, sizeof *s->image.light);
  s->distance = renew(s->host, s->distance, pixels, sizeof *s->distance);
  s->pixel_room = s->image.light && s->distance ? pixels : 0;
  s->image.scene = s->distance;
  if (s->pixel_room) return HK_OK;
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the light of %zu pixels", pixels);
}

/* The part of the picture that the listed sprites reach. */
static void find_rectangle(hk_sprites *s, int width, int height) {
  float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, size[2] = {(float)width, (float)height};
  for (size_t k = 0; k < s->listed; k++) {
    const hk_sprite *p = s->sprite + s->order[k];
    float half = hk_sprite_half(p->radius), at[2] = {p->x, p->y};
    for (int c = 0; c < 2; c++) {
      low[c] = hk_min(low[c], hk_min(at[c], at[c] + p->tail[c]) - half);
      high[c] = hk_max(high[c], hk_max(at[c], at[c] + p->tail[c]) + half);
    }
  }
  for (int c = 0; c < 2; c++) low[c] = hk_min(hk_max(floorf(low[c]), 0), size[c]);
  for (int c = 0; c < 2; c++) high[c] = hk_min(hk_max(ceilf(high[c]), low[c]), size[c]);
  s->image.left = (int)low[0], s->image.bottom = (int)low[1];
  s->image.width = (int)(high[0] - low[0]), s->image.height = (int)(high[1] - low[1]);
}

/* Light adds up in any order: then that of the particles is kept. */
static void list(hk_sprites *s, hk_style style) {
  if (style != HK_STYLE_GLOW) {
    s->listed = hk_depth_order(s->sprite, s->count, s->order, s->scratch, s->scratch + s->count);
    return;
  }
  s->listed = 0;
  for (size_t k = 0; k < s->count; k++)
    if (s->sprite[k].radius > 0) s->order[s->listed++] = (uint32_t)k;
}

hk_status hk_sprites_place(hk_sprites *s, const hk_lens *lens, const hk_sprite_shading *shading, int width, int height,
                           const hk_point_sprite *point, size_t count) {
  hk_status status = make_room(s, count);
  if (status != HK_OK) return status;
  s->count = count;
  hk_project_points(s->host, lens, shading, width, height, point, count, s->sprite);
  list(s, shading->style);
  find_rectangle(s, width, height);
  status = make_pixel_room(s);
  if (status != HK_OK) return status;
  return hk_bands_fill(&s->bands, s->host, s->sprite, s->order, s->listed, s->image.bottom, s->image.height);
}

static uint8_t byte_of(const hk_srgb *srgb, float light) {
  return srgb->byte[(int)(sqrtf(hk_min(hk_max(light, 0), 1)) * (HK_SRGB_ROOTS - 1) + 0.5f)];
}

static void begin_row(float *light, int width) {
  memset(light, 0, 3 * (size_t)width * sizeof *light);
  for (int x = 0; x < width; x++) light[3 * width + x] = 1;
}

static void cover_row(const hk_srgb *srgb, unsigned char *rgba, const float *light, int width) {
  for (int c = 0; c < 3; c++)
    for (int x = 0; x < width; x++) {
      float own = light[c * width + x], rest = light[3 * width + x];
      if (rest < 1) rgba[4 * x + c] = byte_of(srgb, own + rest * srgb->light[rgba[4 * x + c]]);
    }
}

static float strongest(const float *light, int width, int x) {
  return hk_max(light[x], hk_max(light[width + x], light[2 * width + x]));
}

static void add_row(const hk_srgb *srgb, unsigned char *rgba, const float *light, int width) {
  for (int x = 0; x < width; x++) {
    float level = strongest(light, width, x);
    if (!(level > 0)) continue;
    float part = 1 / (1 + level);
    for (int c = 0; c < 3; c++) {
      float behind = srgb->light[rgba[4 * x + c]], own = light[c * width + x] * part;
      rgba[4 * x + c] = byte_of(srgb, 1 - (1 - behind) * (1 - own));
    }
  }
}

static void draw_band(const job *j, size_t band) {
  hk_sprites *s = j->sprites;
  bool glow = j->shading->style == HK_STYLE_GLOW;
  int width = s->image.width, first = (int)band * HK_BAND_ROWS, end = first + HK_BAND_ROWS;
  size_t row = HK_PLANES * (size_t)width;
  end = end < s->image.height ? end : s->image.height;
  for (int y = first; y < end; y++) begin_row(s->image.light + row * (size_t)y, width);
  for (size_t k = s->bands.start[band]; k < s->bands.start[band + 1]; k++)
    hk_splat(&s->image, &s->srgb, j->shading, s->sprite + s->bands.item[k], first, end);
  for (int y = first; y < end && j->rgba; y++)
    (glow ? add_row : cover_row)(&s->srgb, j->rgba + j->stride * (size_t)y, s->image.light + row * (size_t)y, width);
}

static void draw_bands(void *context, size_t begin, size_t end, size_t chunk) {
  (void)chunk;
  for (size_t b = begin; b < end; b++) draw_band(context, b);
}

void hk_sprites_draw(hk_sprites *s, const hk_sprite_shading *shading, unsigned char *rgba, int width) {
  size_t stride = 4 * (size_t)width;
  job j = {s, shading, rgba + stride * (size_t)s->image.bottom + 4 * (size_t)s->image.left, stride};
  if (s->image.width && s->image.height) s->host->parallel_for(s->host, s->bands.count, 1, draw_bands, &j);
}

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

double hk_sprites_level(hk_sprites *s, const hk_sprite_shading *shading, double share) {
  job j = {s, shading, NULL, 0};
  size_t width = (size_t)s->image.width, pixels = width * (size_t)s->image.height, lit = 0;
  for (size_t k = 0; k < pixels; k++) s->distance[k] = INFINITY;
  if (pixels) s->host->parallel_for(s->host, s->bands.count, 1, draw_bands, &j);
  for (size_t k = 0; k < pixels; k++) {
    float level = strongest(s->image.light + k / width * HK_PLANES * width, (int)width, (int)(k % width));
    if (level > FAINT) s->distance[lit++] = level;
  }
  qsort(s->distance, lit, sizeof *s->distance, by_size);
  return lit ? (double)s->distance[(size_t)(share * (double)(lit - 1))] : 0;
}
