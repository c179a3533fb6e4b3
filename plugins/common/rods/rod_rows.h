/* The batches of rods and the rows of their numbers. */
#ifndef HK_ROD_ROWS_H
#define HK_ROD_ROWS_H

#include "plugins/common/rods/rod_set.h"

hk_status hk_rod_rows_build(hk_rods *, const hk_view *view); /* for joints and acting particles; HK_NO_MEMORY */
void hk_rod_rows_fill(hk_rods *, const hk_view *view);       /* stiffness and rest shapes, for the present pins */

#endif
