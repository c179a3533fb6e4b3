#include "plugins/common/colour/palette.h"

const char *const hk_palette_names[HK_PALETTE_SIZE] = {
    [HK_PALETTE_PLAIN] = "plain",   [HK_PALETTE_SECOND] = "second",
    [HK_PALETTE_PIN] = "pin",       [HK_PALETTE_HELD] = "held",
    [HK_PALETTE_BODY] = "body",     [HK_PALETTE_BODY_AT_NIGHT] = "body at night",
    [HK_PALETTE_PLANE] = "plane",   [HK_PALETTE_PLANE_AT_NIGHT] = "plane at night",
    [HK_PALETTE_WIND] = "wind",     [HK_PALETTE_CONTACT] = "contact",
    [HK_PALETTE_PICKED] = "picked", [HK_PALETTE_ARROW] = "arrow",
};

const uint8_t hk_palette_colours[HK_PALETTE_SIZE][4] = {
    [HK_PALETTE_PLAIN] = {84, 132, 190, 255},  [HK_PALETTE_SECOND] = {224, 140, 64, 255},
    [HK_PALETTE_PIN] = {52, 58, 70, 255},      [HK_PALETTE_HELD] = {230, 115, 33, 255},
    [HK_PALETTE_BODY] = {150, 146, 140, 255},  [HK_PALETTE_BODY_AT_NIGHT] = {72, 74, 80, 255},
    [HK_PALETTE_PLANE] = {168, 174, 182, 255}, [HK_PALETTE_PLANE_AT_NIGHT] = {44, 47, 54, 255},
    [HK_PALETTE_WIND] = {26, 158, 153, 255},   [HK_PALETTE_CONTACT] = {217, 38, 115, 255},
    [HK_PALETTE_PICKED] = {250, 199, 46, 255}, [HK_PALETTE_ARROW] = {217, 64, 51, 255},
};
