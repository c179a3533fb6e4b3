/* One step of order 8 by extrapolation, for methods of high order that need a start. */
#ifndef HK_EXTRAPOLATION_H
#define HK_EXTRAPOLATION_H

#include "core/plugin.h"

enum { HK_EXTRAPOLATION_STATES = 5 };

/* change = X' - X, shaped as X, after h from s->t, found as a sum without a subtraction; slope: (a, dy) at s->X. It is
 * the first state in k, HK_EXTRAPOLATION_STATES states of scratch. s->X is only read. */
hk_status hk_extrapolated_change(hk_system *s, double h, const double *slope, double *k, const double **change);

#endif
