/* Whether a film can show smoke and flames. Their numbers are those of the moment, so that no picture can wait for the
 * end of the run. */
#ifndef HK_VOLUME_CHOICE_H
#define HK_VOLUME_CHOICE_H

#include "plugins/common/volume/volume.h"

/* In `create`: the gases of the run where the optics ask for them, else NULL. HK_BAD_PARAM: there are none, or another
 * axis than z points up. */
hk_status hk_volumes_choose(const hk_host *, const hk_volume_optics *, bool y_up, const hk_volumes **);
/* waiting: pictures are drawn at the end of the run. HK_BAD_PARAM: so they cannot be. */
hk_status hk_volumes_check(const hk_host *, const hk_volumes *, bool waiting);

#endif
