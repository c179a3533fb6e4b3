/* A clear liquid over the opaque picture: its nearest surface mirrors by Fresnel's law, bends what is seen through it
 * by Snell's, and absorbs by the length of the way inside (Beer and Lambert); behind it a second surface does the same
 * without bending where the ray leaves, and absorbs what is left of the way. All is in the space of the picture
 * (gl/water_shaders.h): what lies outside of the picture, or behind something opaque, is not mirrored or seen through.
 * The order of the triangles makes no difference. The eye has to be outside of the liquid. */
#ifndef HK_WATER_H
#define HK_WATER_H

#include "core/plugin.h"
#include "plugins/common/camera/view_setup.h"
#include "plugins/common/gl/canvas.h"
#include "plugins/common/picture/patch.h"

enum { HK_WATER_THICKNESS, HK_WATER_LAYER, HK_WATER_SURFACE, HK_WATER_PROGRAMS };
enum {
  HK_WATER_SCENE,
  HK_WATER_BEHIND,
  HK_WATER_DEPTHS,
  HK_WATER_TOTAL,
  HK_WATER_ENTRIES,
  HK_WATER_EXITS,
  HK_WATER_TEXTURES
};

typedef struct hk_water { /* a zeroed one is closed */
  int width, height;
  unsigned program[HK_WATER_PROGRAMS];
  unsigned texture[HK_WATER_TEXTURES]; /* of the picture's size */
  unsigned target[HK_WATER_TEXTURES];  /* frame buffers that draw on them; of the depths none */
  unsigned depth;                      /* render buffer of the layers */
} hk_water;

typedef struct hk_water_draw {
  const hk_canvas *canvas; /* with the opaque picture; the liquid is drawn on it */
  const hk_view_setup *setup;
  const hk_lens *lens;
  const float *key, *sky;                 /* unit vectors towards the lamp and up, in the camera's axes */
  hk_patch patch;                         /* of the canvas: no pixel outside is changed */
  void (*triangles)(const void *context); /* draws all of the liquid's: attributes 0, position; 1, normal */
  const void *context;
} hk_water_draw;

/* Draws the liquid; the first call makes programs and textures. HK_NO_MEMORY, HK_FAILED (OpenGL refuses a program). */
hk_status hk_water_draw_on(hk_water *, const hk_host *host, const hk_water_draw *);
void hk_water_close(hk_water *); /* a closed one is allowed */

#endif
