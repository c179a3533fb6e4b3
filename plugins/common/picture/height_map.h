/* What a directional light meets first. Every object is projected along the light onto the floor's plane; a texel keeps
 * the largest height of what falls on it. So the map tells what is in the shadow on the floor, where it has any height
 * at all, and on other objects, where it has a larger one than theirs. */
#ifndef HK_HEIGHT_MAP_H
#define HK_HEIGHT_MAP_H

#include <stddef.h>
#include <stdint.h>

enum { HK_HEIGHT_MAP_SIZE = 1536 }; /* texels along a side */
enum { HK_HEIGHT_MAP_TOP = 65535 };

typedef struct hk_height_map {
  uint16_t *height;      /* HK_HEIGHT_MAP_SIZE squared; 0: nothing, else 1 to HK_HEIGHT_MAP_TOP */
  float lean[2];         /* displacement of a shadow along the floor per height, m/m */
  float corner[2], side; /* of the square on the floor, m */
  float floor;           /* m, height onto which all is projected */
  float low, high;       /* m, heights that 0 and HK_HEIGHT_MAP_TOP stand for */
  int rows[2];           /* outside of rows[0] <= y < rows[1] there is nothing */
} hk_height_map;

/* Empties the map; all but `height` and `rows` is to be set before. A new map has 0 everywhere. */
void hk_height_map_begin(hk_height_map *);
void hk_height_map_triangle(hk_height_map *, const float a[3], const float b[3], const float c[3]);
/* A band of this half width, at least half a texel, along the projection of a tube. */
void hk_height_map_tube(hk_height_map *, const float a[3], const float b[3], float radius);
void hk_height_map_sphere(hk_height_map *, const float centre[3], float radius);

#endif
