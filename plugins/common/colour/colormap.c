/* Key colours, between which a map is linear. In all maps but the diverging one lightness (CIE L*) rises evenly from
 * end to end, so that they also tell numbers apart in grey, and to the colour-blind. Viridis and inferno: Smith and van
 * der Walt 2015. Cividis: Nunez, Anderton and Renslow 2018. Fire: the way from black over red, orange and yellow to
 * white, at 16 equal steps of lightness. Diverging: cool and warm ends of equal lightness that meet in a light grey
 * (after Moreland 2009). Groups: after Okabe and Ito 2008. */
#include "plugins/common/colour/colormap.h"

#include <math.h>
#include <string.h>

enum { MOST = 17 };

typedef struct keys {
  int count;
  uint8_t key[MOST][3];
} keys;

static const keys map_keys[HK_MAPS] = {
    [HK_MAP_VIRIDIS] = {9,
                        {{68, 1, 84},
                         {72, 40, 120},
                         {62, 74, 137},
                         {49, 104, 142},
                         {38, 130, 142},
                         {31, 158, 137},
                         {83, 197, 104},
                         {181, 222, 43},
                         {253, 231, 37}}},
    [HK_MAP_INFERNO] = {17,
                        {{0, 0, 4},
                         {11, 7, 36},
                         {33, 12, 74},
                         {61, 9, 101},
                         {87, 16, 110},
                         {113, 25, 110},
                         {138, 34, 106},
                         {163, 44, 97},
                         {188, 55, 84},
                         {210, 70, 68},
                         {228, 90, 49},
                         {241, 115, 29},
                         {249, 142, 9},
                         {252, 172, 17},
                         {249, 203, 53},
                         {242, 234, 105},
                         {252, 255, 164}}},
    [HK_MAP_CIVIDIS] = {17,
                        {{0, 34, 78},
                         {0, 46, 106},
                         {26, 56, 111},
                         {50, 67, 109},
                         {67, 78, 108},
                         {83, 90, 109},
                         {97, 101, 111},
                         {111, 112, 115},
                         {125, 124, 120},
                         {140, 136, 120},
                         {155, 148, 118},
                         {171, 160, 114},
                         {188, 174, 108},
                         {205, 187, 99},
                         {222, 201, 88},
                         {240, 216, 70},
                         {254, 232, 56}}},
    [HK_MAP_GREY] = {2, {{0, 0, 0}, {255, 255, 255}}},
    [HK_MAP_FIRE] = {17,
                     {{0, 0, 0},
                      {50, 0, 4},
                      {74, 0, 7},
                      {99, 1, 8},
                      {124, 5, 6},
                      {151, 9, 5},
                      {177, 19, 4},
                      {199, 40, 2},
                      {220, 60, 0},
                      {233, 87, 0},
                      {242, 115, 0},
                      {250, 140, 0},
                      {252, 167, 13},
                      {254, 192, 26},
                      {255, 217, 67},
                      {255, 239, 133},
                      {255, 255, 255}}},
    [HK_MAP_DIVERGING] = {9,
                          {{38, 72, 168},
                           {72, 118, 208},
                           {122, 164, 233},
                           {180, 204, 240},
                           {236, 235, 230},
                           {247, 197, 170},
                           {238, 142, 110},
                           {212, 82, 68},
                           {166, 20, 46}}},
};

const char *const hk_map_names[HK_MAPS] = {
    [HK_MAP_VIRIDIS] = "viridis", [HK_MAP_INFERNO] = "inferno", [HK_MAP_CIVIDIS] = "cividis",
    [HK_MAP_GREY] = "grey",       [HK_MAP_FIRE] = "fire",       [HK_MAP_DIVERGING] = "diverging",
};

void hk_colormap_fill(hk_colormap map, int reverse, uint8_t table[HK_MAP_SIZE][4]) {
  const uint8_t(*key)[3] = map_keys[map].key;
  for (int k = 0; k < HK_MAP_SIZE; k++) {
    uint8_t *entry = table[reverse ? HK_MAP_SIZE - 1 - k : k];
    double at = (k + 0.5) / HK_MAP_SIZE * (map_keys[map].count - 1);
    int i = (int)at;
    for (int c = 0; c < 3; c++) entry[c] = (uint8_t)(key[i][c] + (at - i) * (key[i + 1][c] - key[i][c]) + 0.5);
    entry[3] = 255;
  }
}

void hk_colormap_colour(uint8_t (*table)[4], double place, uint8_t colour[4]) {
  static const uint8_t black[4] = {0, 0, 0, 255};
  if (isnan(place)) {
    memcpy(colour, black, 4);
    return;
  }
  memcpy(colour, table[(int)fmin(fmax(place * HK_MAP_SIZE, 0), HK_MAP_SIZE - 1)], 4);
}

void hk_colormap_group(uint32_t group, uint8_t colour[4]) {
  static const uint8_t list[HK_GROUP_COLOURS][3] = {{70, 130, 180}, {230, 140, 40}, {40, 158, 115}, {204, 100, 140},
                                                    {240, 205, 70}, {90, 180, 233}, {200, 80, 40},  {120, 110, 160}};
  memcpy(colour, list[group % HK_GROUP_COLOURS], 3);
  colour[3] = 255;
}
