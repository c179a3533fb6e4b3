/* What particles look like, as numbers of the scene's state. */
#ifndef HK_INK_H
#define HK_INK_H

#include "plugins/common/snapshot/snapshot3d.h"

/* Fills ink and extra. `birth`: the time of each particle's birth, s; NULL: they were there from t = 0. */
void hk_ink_take(hk_snapshot3d *, const hk_view *view, const double *birth);

#endif
