/* Smoke and flames over a picture that is read. */
#ifndef HK_VOLUME_PASS_H
#define HK_VOLUME_PASS_H

#include "plugins/common/gl/canvas.h"
#include "plugins/common/volume/volume.h"

/* Draws all volumes over rgba, the picture on the canvas, as `like` says, of which volume, patch and distance are not
 * used. changed: the pixels about all of them. HK_NO_MEMORY. */
hk_status hk_volume_pass(const hk_volumes *, const hk_volume_draw *like, const hk_canvas *, const hk_lens *,
                         hk_patch *changed, unsigned char *rgba);

#endif
