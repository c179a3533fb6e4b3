/* The largest relaxation rate of the channels: see channel_rate.c. */
#ifndef HK_CHANNEL_RATE_H
#define HK_CHANNEL_RATE_H

#include "core/plugin.h"

typedef struct hk_channel_scratch {
  double *x, *v, *a;             /* 3n each */
  double *y, *dy[2], *direction; /* each of the length of y */
} hk_channel_scratch;

/* *rate: 1/s, the largest |k| of dy/dt = -k y; 0 without channel rates. The evaluations are added to *evaluations. */
hk_status hk_bound_channel_rate(hk_system *, const hk_channel_scratch *, double *rate, size_t *evaluations);

#endif
