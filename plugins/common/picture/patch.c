#include "plugins/common/picture/patch.h"

#include <math.h>

void hk_patch_begin(hk_patch_maker *m, const hk_lens *lens, int width, int height) {
  *m = (hk_patch_maker){.both = lens->both,
                        .scale = lens->projection[5] * (float)height / 2,
                        .width = width,
                        .height = height,
                        .low = {INFINITY, INFINITY},
                        .high = {-INFINITY, -INFINITY}};
}

/* A sphere nearer than twice its radius may be seen anywhere. */
void hk_patch_add(hk_patch_maker *m, const float centre[3], float radius, float margin) {
  const float *b = m->both;
  float clip[4];
  for (int r = 0; r < 4; r++) clip[r] = b[r] * centre[0] + b[4 + r] * centre[1] + b[8 + r] * centre[2] + b[12 + r];
  if (!(clip[3] > 2 * radius) || !(clip[3] > 0)) {
    m->whole = true;
    return;
  }
  float extent[2] = {(float)m->width, (float)m->height}, reach = radius * m->scale / (clip[3] - radius) * 1.5f + margin;
  for (int k = 0; k < 2; k++) {
    float at = (clip[k] / clip[3] + 1) / 2 * extent[k];
    m->low[k] = fminf(m->low[k], at - reach), m->high[k] = fmaxf(m->high[k], at + reach);
  }
}

static int clamp(float at, int most) { return at < 0 ? 0 : at > (float)most ? most : (int)at; }

hk_patch hk_patch_end(const hk_patch_maker *m) {
  if (m->whole) return (hk_patch){0, 0, m->width, m->height};
  if (!(m->low[0] <= m->high[0])) return (hk_patch){0};
  int left = clamp(floorf(m->low[0]), m->width), right = clamp(ceilf(m->high[0]), m->width);
  int bottom = clamp(floorf(m->low[1]), m->height), top = clamp(ceilf(m->high[1]), m->height);
  return (hk_patch){left, bottom, right - left, top - bottom};
}
