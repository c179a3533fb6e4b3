/* The surfaces of rigid bodies as solids to draw. */
#ifndef HK_SKIN_SOLIDS_H
#define HK_SKIN_SOLIDS_H

#include "plugins/common/frame_data/solid.h"

/* Fills `count` solids: those of the model, where its bodies are, and behind them empty meshes where some have gone.
 * Lists of vertices and faces stay the model's. */
void hk_skin_solids(const hk_view *, bool y_up, hk_frame_solid *solid, size_t count);

#endif
