#ifndef HK_FRAME_DATA_STRAIN_H
#define HK_FRAME_DATA_STRAIN_H

#include "plugins/common/frame_data/frame_data.h"

/* Takes the strains of cells and particles, once the cells are known. */
void hk_gatherer_strain(hk_gatherer *, const hk_view *view);

#endif
