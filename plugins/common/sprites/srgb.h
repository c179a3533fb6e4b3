/* Conversion between the bytes of a picture (sRGB, IEC 61966-2-1) and light, to which blending is linear. */
#ifndef HK_SRGB_H
#define HK_SRGB_H

#include <stdint.h>

enum { HK_SRGB_FINE = 1024, HK_SRGB_ROOTS = 4096 };

typedef struct hk_srgb {
  float light[256];             /* of a byte, 0..1 */
  float fine[HK_SRGB_FINE + 1]; /* of the value k / HK_SRGB_FINE */
  uint8_t
      byte[HK_SRGB_ROOTS]; /* nearest to the light (k / (HK_SRGB_ROOTS - 1))^2: roots are dense where eyes are keen */
} hk_srgb;

void hk_srgb_fill(hk_srgb *);

#endif
