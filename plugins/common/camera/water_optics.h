/* How clear liquids look in pictures: Fresnel's reflection, refraction, and absorption by thickness. */
#ifndef HK_WATER_OPTICS_H
#define HK_WATER_OPTICS_H

#include <stdbool.h>

typedef struct hk_water_optics {
  bool clear;          /* liquids are drawn as what is said here, not as solids */
  float index;         /* of refraction, 1 or more; 1.333 is water in air */
  float absorption[3]; /* 1/m, of red, green and blue light */
} hk_water_optics;

#endif
