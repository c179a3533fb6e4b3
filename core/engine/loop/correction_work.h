/* Within the time loop: the work of a step that correctors ended, for methods that do not know it themselves. */
#ifndef HK_CORRECTION_WORK_H
#define HK_CORRECTION_WORK_H

#include "core/engine/loop/loop.h"

/* Of the step of h s from X_before, whole, to X_end, which was then corrected; without constraints. out->work is NAN
 * where forces are not finite at one of these. Fails without memory only. */
hk_status hk_correction_work(hk_loop *, double h, hk_corrected *out);

#endif
