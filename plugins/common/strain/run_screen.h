/* Whether the distances of two runs of particles are all within limits, without roots. */
#ifndef HK_RUN_SCREEN_H
#define HK_RUN_SCREEN_H

#include "core/plugin.h"

typedef struct hk_run_ends {
  const double *x[2], *y[2], *z[2]; /* coordinates of the particles of both ends, m */
} hk_run_ends;

/* True where one of `count` squared distances is outside of [low, high], m^2. NaN is within. lanes: hk_host.lanes. */
bool hk_run_screen(int lanes, const hk_run_ends *, size_t count, double low, double high);

#endif
