#include "plugins/common/sprites/srgb.h"

#include <math.h>

static double light_of(double value) { return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4); }

static double value_of(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * pow(light, 1 / 2.4) - 0.055;
}

void hk_srgb_fill(hk_srgb *s) {
  for (int k = 0; k < 256; k++) s->light[k] = (float)light_of(k / 255.0);
  for (int k = 0; k <= HK_SRGB_FINE; k++) s->fine[k] = (float)light_of(k / (double)HK_SRGB_FINE);
  for (int k = 0; k < HK_SRGB_ROOTS; k++) {
    double root = k / (double)(HK_SRGB_ROOTS - 1);
    s->byte[k] = (uint8_t)(255 * value_of(root * root) + 0.5);
  }
}
