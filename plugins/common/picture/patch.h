/* The part of a picture that differs from the one before: rectangles around what was drawn on the surroundings, which
 * are drawn once. Only these are restored, drawn, and read. */
#ifndef HK_PATCH_H
#define HK_PATCH_H

#include "plugins/common/camera/camera.h"

#include <stdbool.h>

typedef struct hk_patch { /* pixels, from the lower left corner; empty where width or height is not above 0 */
  int left, bottom, width, height;
} hk_patch;

typedef struct hk_patch_maker {
  const float *both; /* of the lens */
  float scale;       /* pixels of a metre at a distance of 1 m */
  float low[2], high[2];
  int width, height;
  bool whole; /* something is too near to say where it ends */
} hk_patch_maker;

void hk_patch_begin(hk_patch_maker *, const hk_lens *, int width, int height);
/* Adds a sphere; `margin` in pixels. */
void hk_patch_add(hk_patch_maker *, const float centre[3], float radius, float margin);
hk_patch hk_patch_end(const hk_patch_maker *);

static inline bool hk_patch_is_empty(const hk_patch *p) { return p->width <= 0 || p->height <= 0; }

#endif
