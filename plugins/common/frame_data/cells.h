#ifndef HK_FRAME_DATA_CELLS_H
#define HK_FRAME_DATA_CELLS_H

#include "plugins/common/frame_data/frame_data.h"

/* Finds the cells of the particles shown (s->place), and the sources of their strain. HK_NO_MEMORY. */
hk_status hk_gatherer_find_cells(hk_gatherer *, const hk_view *view);

#endif
