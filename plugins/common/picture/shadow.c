/* Casting, and the shadow on the floor: the share of a texel of the floor that texels of the map cover, darkened by
 * what is not opaque, and blurred three times by box filters with running sums (nearly a Gaussian). */
#include "plugins/common/picture/shadow.h"

#include <string.h>

enum { SIZE = HK_SHADOW_SIZE, FINE = HK_HEIGHT_MAP_SIZE / SIZE, REACH = 3, PASSES = 3 };

/* The square that contains the shadow of the motion's box and a margin for the blur. */
static void place_map(hk_height_map *m, const hk_view_setup *setup, const double key[3]) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int corner = 0; corner < 8; corner++)
    for (int c = 0; c < 2; c++) {
      double z = (corner & 4 ? setup->high : setup->low)[2] - setup->height;
      double at = (corner >> c & 1 ? setup->high : setup->low)[c] - key[c] / key[2] * z;
      low[c] = fmin(low[c], at), high[c] = fmax(high[c], at);
    }
  double half = 0.53 * fmax(high[0] - low[0], high[1] - low[1]) + 0.1 * setup->size + setup->point;
  for (int c = 0; c < 2; c++) {
    m->lean[c] = (float)(key[c] / key[2]);
    m->corner[c] = (float)((low[c] + high[c]) / 2 - half);
  }
  m->side = (float)(2 * half);
  m->floor = (float)setup->height;
  m->low = (float)(fmin(setup->low[2], setup->height) - 0.1 * setup->size);
  m->high = (float)(setup->high[2] + 0.1 * setup->size + setup->point);
}

enum { CLEAR_SHADE = 70 }; /* of 255: what a clear liquid takes off the light */

static bool is_opaque(const hk_view_setup *setup, const hk_point_sprite *point) {
  return setup->sprites.style == HK_STYLE_SPHERE && setup->sprites.opacity >= 1 && point->colour[3] == 255;
}

/* Darkens what lies in the shadow of the map to `dark` or more. What is below the floor casts no shadow on it. */
static void cover(const hk_height_map *m, int dark, unsigned char *shade) {
  double floor = (double)(m->floor - m->low) / (double)(m->high - m->low) * HK_HEIGHT_MAP_TOP;
  uint16_t above = (uint16_t)fmin(fmax(floor, 0), HK_HEIGHT_MAP_TOP - 1);
  for (int y = m->rows[0] / FINE; y * FINE < m->rows[1]; y++) {
    uint16_t count[SIZE] = {0};
    for (int k = 0; k < FINE; k++) {
      const uint16_t *row = m->height + (size_t)(FINE * y + k) * HK_HEIGHT_MAP_SIZE;
      for (int x = 0; x < SIZE; x++)
        for (int l = 0; l < FINE; l++) count[x] = (uint16_t)(count[x] + (row[FINE * x + l] > above));
    }
    for (int x = 0; x < SIZE; x++) {
      unsigned char here = (unsigned char)(count[x] * dark / (FINE * FINE)), *at = shade + y * SIZE + x;
      *at = here > *at ? here : *at;
    }
  }
}

/* The map is scratch here. */
static void shade_liquid(hk_painter *p) {
  hk_height_map *m = &p->map;
  hk_height_map_begin(m);
  for (size_t k = p->planes; k < p->triangles; k++) {
    const uint32_t *t = p->triangle[k];
    hk_height_map_triangle(m, p->vertex[t[0]].x, p->vertex[t[1]].x, p->vertex[t[2]].x);
  }
  cover(m, CLEAR_SHADE, p->shade);
}

void hk_shadow_cast(hk_painter *p, const hk_view_setup *setup, const double key[3]) {
  hk_height_map *m = &p->map;
  place_map(m, setup, key);
  memset(p->shade, 0, SIZE * SIZE);
  if (p->planes < p->triangles) shade_liquid(p);
  hk_height_map_begin(m);
  for (size_t k = 0; k < p->faded; k++) {
    const uint32_t *t = p->triangle[k];
    hk_height_map_triangle(m, p->vertex[t[0]].x, p->vertex[t[1]].x, p->vertex[t[2]].x);
  }
  for (size_t k = 0; k < p->tubes; k++) hk_height_map_tube(m, p->tube[k].a, p->tube[k].b, p->tube[k].radius);
  for (size_t k = 0; k < p->points; k++)
    if (is_opaque(setup, p->point + k)) hk_height_map_sphere(m, p->point[k].centre, p->point[k].radius);
}

static int clamp(float at) { return at < 0 ? 0 : at > SIZE - 1 ? SIZE - 1 : (int)at; }

/* What is not opaque darkens by its opacity, one after the other. */
static void darken(unsigned char *shade, const hk_height_map *m, const hk_point_sprite *point, double opacity) {
  int dark = (int)fmin(opacity * point->colour[3] + 0.5, 255);
  float p[2], scale = SIZE / m->side, r = fmaxf(point->radius * scale, 0.75f);
  for (int k = 0; k < 2; k++)
    p[k] = (point->centre[k] - m->lean[k] * (point->centre[2] - m->floor) - m->corner[k]) * scale;
  if (!(p[0] + r >= 0 && p[0] - r < SIZE && p[1] + r >= 0 && p[1] - r < SIZE)) return;
  for (int y = clamp(p[1] - r); y <= clamp(p[1] + r); y++)
    for (int x = clamp(p[0] - r); x <= clamp(p[0] + r); x++) {
      float dx = (float)x + 0.5f - p[0], dy = (float)y + 0.5f - p[1];
      unsigned char *at = shade + y * SIZE + x;
      if (dx * dx + dy * dy <= r * r) *at = (unsigned char)(*at + dark < 255 ? *at + dark : 255);
    }
}

/* One box filter along rows; the result is transposed, so that the next works along columns. */
static void blur(const unsigned char *from, unsigned char *to) {
  for (int y = 0; y < SIZE; y++) {
    const unsigned char *row = from + y * SIZE;
    int sum = 0;
    for (int x = 0; x < REACH; x++) sum += row[x];
    for (int x = 0; x < SIZE; x++) {
      if (x + REACH < SIZE) sum += row[x + REACH];
      if (x > REACH) sum -= row[x - REACH - 1];
      to[x * SIZE + y] = (unsigned char)(sum / (2 * REACH + 1));
    }
  }
}

void hk_shadow_shade(hk_painter *p, const hk_view_setup *setup) {
  cover(&p->map, 255, p->shade);
  for (size_t k = 0; k < p->points && setup->sprites.style != HK_STYLE_GLOW; k++)
    if (!is_opaque(setup, p->point + k)) darken(p->shade, &p->map, p->point + k, setup->sprites.opacity);
  for (int k = 0; k < 2 * PASSES; k++) blur(p->shade + (k % 2 ? SIZE * SIZE : 0), p->shade + (k % 2 ? 0 : SIZE * SIZE));
}
