/* A disc's weight is w = (1 - r^2)^2 at r radii from its middle: it and its slope vanish at the edge. A light's is
 * w (1 + 4 w^2)/5, a bright core in a faint halo. Discs of less than
 * one and a half pixels are drawn that large and fainter by the ratio of the areas, so that their light does not
 * flicker as they move from pixel to pixel. With a tail, r is the distance from the line, and the weight falls along it
 * to zero. Spheres have the light of plugins/common/gl/shaders.h, and edges by the share of the pixel that they cover.
 * What lies behind something else of the scene is hidden; soft discs vanish gradually there, over their radius. */
#include "plugins/common/sprites/splat.h"

#include "plugins/common/sprites/projection.h"

#include <math.h>

typedef struct span { /* part of a row */
  float *light[HK_PLANES];
  const float *scene;
  int count;
  float x, y; /* middle of the first pixel, from the sprite's, pixels */
} span;

static inline float clamp01(float v) {
  v = v > 0 ? v : 0;
  return v < 1 ? v : 1;
}

/* ---- Discs ------------------------------------------------------------------------------------------------------- */

typedef struct disc {
  float scale;          /* 1 / radius^2 */
  float alpha;          /* of the middle */
  float front, harden;  /* where it begins, m; 1 / m over which it vanishes */
  float colour[3];      /* light */
  float cover;          /* 1: it hides what is behind; 0: it only adds light */
  float core;           /* 4/5, or 0 for a disc without one */
  float tail[2], along; /* pixels; 1 / length^2, 0 without a tail */
} disc;

/* Light of the sprite's colour with its fog. */
static void colour_of(const hk_srgb *srgb, const hk_sprite_shading *shading, const hk_sprite *s, float light[3]) {
  for (int c = 0; c < 3; c++) {
    float fog = shading->style == HK_STYLE_GLOW ? 0 : srgb->fine[(int)(clamp01(shading->fog_colour[c]) * HK_SRGB_FINE)];
    light[c] = srgb->light[s->colour[c]] * (1 - s->fog) + fog * s->fog;
  }
}

static disc make_disc(const hk_srgb *srgb, const hk_sprite_shading *shading, const hk_sprite *s) {
  float radius = hk_sprite_half(s->radius) - 0.5f, ratio = s->radius / radius;
  float length2 = s->tail[0] * s->tail[0] + s->tail[1] * s->tail[1];
  disc d = {.scale = 1 / (radius * radius),
            .alpha = (float)shading->opacity * (float)s->colour[3] / 255 * (ratio * ratio),
            .front = s->depth - s->reach,
            .harden = 1 / (s->reach > 1e-6f * s->depth ? s->reach : 1e-6f * s->depth),
            .cover = shading->style == HK_STYLE_SOFT ? 1 : 0,
            .core = shading->style == HK_STYLE_GLOW ? 0.8f : 0,
            .tail = {s->tail[0], s->tail[1]},
            .along = length2 > 1 ? 1 / length2 : 0}; /* a tail within a pixel is none */
  colour_of(srgb, shading, s, d.colour);
  return d;
}

/* inside: 1 - r^2. */
static inline float weight(const disc *d, float inside) {
  float w = inside * inside;
  return w * (1 - d->core + d->core * w * w);
}

static void add_disc(const disc *d, const span *p) {
  float *restrict red = p->light[0], *restrict green = p->light[1], *restrict blue = p->light[2];
  float *restrict rest = p->light[3];
  for (int k = 0; k < p->count; k++) {
    float x = p->x + (float)k, inside = 1 - (x * x + p->y * p->y) * d->scale;
    inside = inside > 0 ? inside : 0;
    float a = rest[k] * d->alpha * weight(d, inside) * clamp01((p->scene[k] - d->front) * d->harden);
    red[k] += a * d->colour[0];
    green[k] += a * d->colour[1];
    blue[k] += a * d->colour[2];
    rest[k] -= a * d->cover;
  }
}

static void add_streak(const disc *d, const span *p) {
  float *restrict red = p->light[0], *restrict green = p->light[1], *restrict blue = p->light[2];
  float *restrict rest = p->light[3];
  for (int k = 0; k < p->count; k++) {
    float x = p->x + (float)k, t = clamp01((x * d->tail[0] + p->y * d->tail[1]) * d->along);
    float across = x - t * d->tail[0], up = p->y - t * d->tail[1];
    float inside = 1 - (across * across + up * up) * d->scale;
    inside = (inside > 0 ? inside : 0) * (1 - t);
    float a = rest[k] * d->alpha * weight(d, inside) * clamp01((p->scene[k] - d->front) * d->harden);
    red[k] += a * d->colour[0];
    green[k] += a * d->colour[1];
    blue[k] += a * d->colour[2];
    rest[k] -= a * d->cover;
  }
}

/* ---- Spheres ----------------------------------------------------------------------------------------------------- */

static inline float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* lit() of plugins/common/gl/shaders.h. */
static void lit(const float light[4][3], const float n[3], const float base[3], float out[3]) {
  static const float below[3] = {0.43f, 0.41f, 0.43f}, above[3] = {0.42f, 0.45f, 0.50f};
  static const float sun[3] = {0.46f, 0.44f, 0.40f};
  float facing = dot(n, light[0]), sky = 0.5f + 0.5f * dot(n, light[1]), front = dot(n, light[2]);
  float direct = clamp01((facing + 0.25f) / 1.25f) + 0.34f * (facing < 0 ? -facing : 0);
  float shine = dot(n, light[3]), edge = 1 - (front > 0 ? front : 0);
  shine = shine > 0 ? shine : 0;
  for (int k = 0; k < 5; k++) shine *= shine; /* to the power 32 */
  for (int c = 0; c < 3; c++) {
    float fill = below[c] + sky * (above[c] - below[c]);
    out[c] = base[c] * (fill + 0.20f * (1 - edge) + direct * sun[c]) + 0.10f * shine + 0.05f * edge * edge * edge;
  }
}

/* Less of it than this is not seen: a quarter of the step between black and the darkest byte, in light 1 / 3295. */
static const float HIDDEN = 1.f / 13000;

static void add_sphere(const hk_srgb *srgb, const hk_sprite_shading *shading, const hk_sprite *s, const span *p) {
  float base[3], colour[3], front = s->depth - s->reach, *rest = p->light[3];
  for (int c = 0; c < 3; c++) base[c] = (float)s->colour[c] / 255;
  for (int k = 0; k < p->count; k++) {
    if (rest[k] < HIDDEN) continue;
    float n[3] = {(p->x + (float)k) / s->radius, p->y / s->radius, 0};
    float r = sqrtf(n[0] * n[0] + n[1] * n[1]), cover = clamp01((1 - r) * s->radius + 0.5f);
    if (cover <= 0 || p->scene[k] < front) continue;
    if (r < 1)
      n[2] = sqrtf(1 - r * r);
    else
      n[0] /= r, n[1] /= r;
    lit(shading->light, n, base, colour);
    cover *= rest[k] * (float)shading->opacity * (float)s->colour[3] / 255;
    rest[k] -= cover;
    for (int c = 0; c < 3; c++) {
      float shade = clamp01(colour[c] + s->fog * (shading->fog_colour[c] - colour[c]));
      p->light[c][k] += cover * srgb->fine[(int)(shade * HK_SRGB_FINE + 0.5f)];
    }
  }
}

/* ---- Both -------------------------------------------------------------------------------------------------------- */

/* The columns that the sprite reaches in the row whose middle is `y` above the sprite's: those of the disc or, with a
 * tail, of the strip around the line, within the box of both. */
static void reach_in_row(const hk_sprite *s, float y, float half, float reach[2]) {
  float across = s->tail[0], up = s->tail[1], length = sqrtf(across * across + up * up);
  reach[0] = hk_min(0, across) - half, reach[1] = hk_max(0, across) + half;
  if (!(length > 1) || fabsf(up) < 1e-3f * length) return;
  float middle = y * across / up, wide = half * length / fabsf(up);
  reach[0] = hk_max(reach[0], middle - wide), reach[1] = hk_min(reach[1], middle + wide);
}

/* The whole number below, in the range; none of that is negative. */
static int within(float at, int least, int most) { return (int)hk_min(hk_max(at, (float)least), (float)most); }

void hk_splat(const hk_light_image *image, const hk_srgb *srgb, const hk_sprite_shading *shading, const hk_sprite *s,
              int first, int end) {
  float half = hk_sprite_half(s->radius), x = s->x - (float)image->left, y = s->y - (float)image->bottom;
  int low = within(hk_min(y, y + s->tail[1]) - half, first, end);
  int high = within(hk_max(y, y + s->tail[1]) + half + 1, first, end);
  disc d = make_disc(srgb, shading, s);
  for (int row = low; row < high; row++) {
    float reach[2], up = (float)row + 0.5f - y;
    reach_in_row(s, up, half, reach);
    int left = within(x + reach[0], 0, image->width), right = within(x + reach[1] + 1, 0, image->width);
    float *light = image->light + (size_t)row * HK_PLANES * (size_t)image->width + left;
    span p = {{light, light + image->width, light + 2 * image->width, light + 3 * image->width},
              image->scene + (size_t)row * (size_t)image->width + left,
              right - left,
              (float)left + 0.5f - x,
              up};
    if (shading->style == HK_STYLE_SPHERE)
      add_sphere(srgb, shading, s, &p);
    else
      (d.along > 0 ? add_streak : add_disc)(&d, &p);
  }
}
