/* Diverging: cool and warm ends of equal lightness that meet in a light grey (after Moreland 2009). Sequential: key
 * colours of viridis (Smith and van der Walt 2015). Groups: after Okabe and Ito (2008). */
#include "plugins/common/picture/colormap.h"

#include <math.h>
#include <string.h>

enum { KEYS = 9 };

static const uint8_t diverging[KEYS][3] = {{38, 72, 168},   {72, 118, 208},  {122, 164, 233},
                                           {180, 204, 240}, {236, 235, 230}, {247, 197, 170},
                                           {238, 142, 110}, {212, 82, 68},   {166, 20, 46}};
static const uint8_t sequential[KEYS][3] = {{68, 1, 84},    {72, 40, 120},  {62, 74, 137},
                                            {49, 104, 142}, {38, 130, 142}, {31, 158, 137},
                                            {83, 197, 104}, {181, 222, 43}, {253, 231, 37}};

void hk_colormap_fill(hk_colormap map, uint8_t table[HK_MAP_SIZE][4]) {
  const uint8_t(*key)[3] = map == HK_MAP_DIVERGING ? diverging : sequential;
  for (int k = 0; k < HK_MAP_SIZE; k++) {
    double at = (k + 0.5) / HK_MAP_SIZE * (KEYS - 1);
    int i = (int)at;
    for (int c = 0; c < 3; c++) table[k][c] = (uint8_t)(key[i][c] + (at - i) * (key[i + 1][c] - key[i][c]) + 0.5);
    table[k][3] = 255;
  }
}

void hk_colormap_look(uint8_t (*table)[4], double low, double high, double value, uint8_t colour[4]) {
  static const uint8_t black[4] = {0, 0, 0, 255};
  double at = high > low ? (value - low) / (high - low) : 0.5;
  if (!isfinite(at)) {
    memcpy(colour, black, 4);
    return;
  }
  at = fmin(fmax(at * HK_MAP_SIZE, 0), HK_MAP_SIZE - 1);
  memcpy(colour, table[(int)at], 4);
}

void hk_colormap_group(uint32_t group, uint8_t colour[4]) {
  static const uint8_t list[8][3] = {{70, 130, 180}, {230, 140, 40}, {40, 158, 115}, {204, 100, 140},
                                     {240, 205, 70}, {90, 180, 233}, {200, 80, 40},  {120, 110, 160}};
  memcpy(colour, list[group % 8], 3);
  colour[3] = 255;
}
