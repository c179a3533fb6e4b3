#ifndef HK_SHOT_STRAIN_H
#define HK_SHOT_STRAIN_H

#include "plugins/common/shot/shot.h"

/* Takes the strains of cells and particles, once the cells are known. */
void hk_shooting_strain(hk_shooting *, const hk_view *view);

#endif
