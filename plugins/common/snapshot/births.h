/* When particles appeared, which scenes do not keep. */
#ifndef HK_BIRTHS_H
#define HK_BIRTHS_H

#include "core/plugin.h"

typedef struct hk_births {
  double *seen, *birth; /* n: 1 from its first frame on; s, known from then */
  double last;          /* s, time of the frame before */
} hk_births;

/* Who appears between two frames is taken to be born at `born`, s. Returns how many are new. */
size_t hk_births_note(hk_births *, const hk_view *, double born);
/* Of the first frame. Where a run goes on, births before that are known only as far as the checkpoint has these fields;
 * a warning says so where ages are shown. */
void hk_births_note_first(hk_births *, const hk_view *, bool shown);

#endif
