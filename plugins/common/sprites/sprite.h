/* Particles as points in the scene and as sprites on the picture. */
#ifndef HK_SPRITE_H
#define HK_SPRITE_H

#include <stddef.h>
#include <stdint.h>

/* As fminf and fmaxf of numbers, but without the call. */
static inline float hk_min(float a, float b) { return a < b ? a : b; }
static inline float hk_max(float a, float b) { return a > b ? a : b; }

typedef struct hk_point_sprite { /* in the scene */
  float centre[3], radius;       /* m */
  float tail[3];                 /* m: drawn from the centre to centre - tail; 0: a point */
  uint8_t colour[4];             /* red, green, blue, opacity */
} hk_point_sprite;

typedef enum hk_style {
  HK_STYLE_SPHERE, /* opaque spheres in the light; the nearest hides the others */
  HK_STYLE_SOFT,   /* discs that fade towards their edge, which hide each other partly */
  HK_STYLE_GLOW    /* the same discs as sources of light, which add up */
} hk_style;

typedef struct hk_sprite_shading {
  hk_style style;
  double opacity;      /* factor of every point's */
  double least;        /* smallest radius, pixels */
  double fog;          /* 0..1: share of the fog's colour in that of the farthest point */
  double clear, thick; /* distances where the fog begins and where it is `fog`, m */
  float fog_colour[3]; /* 0..1 */
  float light[4][3];   /* key, sky, toward, between of plugins/common/gl/shaders.h, in the camera's axes */
} hk_sprite_shading;

/* x and y are in pixels from the lower left corner of the picture. radius 0: not visible. */
typedef struct hk_sprite {
  float x, y, radius;
  float tail[2]; /* pixels */
  float depth;   /* of the centre, m from the eye along the line of sight */
  float reach;   /* radius, m */
  float fog;     /* 0..1 */
  uint8_t colour[4];
} hk_sprite;

#endif
