/* The data of one stage of an implicit method; newton.h has its equation. */
#ifndef HK_STAGE_H
#define HK_STAGE_H

#include "core/plugin.h"

/* X: shaped as s->X. On entry: the guess of v at X + 3n (and of y). On return: x, v and y of the stage; slopes are (X -
 * base)/g. */
typedef struct hk_stage {
  double t, g;
  double limit;       /* m/s, algebraic error allowed in v, RMS */
  const double *base; /* x*, v*, y*; shaped as s->X */
  double *X;
  bool fixed; /* of a method with a fixed step: the algebraic error must also be far below the first change of v, which
                 is about the error of the step, so that it stays negligible for short steps too */
  double channels; /* algebraic error allowed in a channel's number, relative to its size; 0: no such limit */
} hk_stage;

#endif
