#ifndef HK_SHOT_CELLS_H
#define HK_SHOT_CELLS_H

#include "plugins/common/shot/shot.h"

/* Finds the cells of the particles shown (s->place), and the sources of their strain. HK_NO_MEMORY. */
hk_status hk_shooting_find_cells(hk_shooting *, const hk_view *view);

#endif
