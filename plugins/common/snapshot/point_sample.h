/* Positions of a motion, evenly taken, as many as fit: for what needs only shares of them. */
#ifndef HK_POINT_SAMPLE_H
#define HK_POINT_SAMPLE_H

#include "plugins/common/snapshot/snapshot3d.h"

enum { HK_SAMPLES = 1 << 16 };

typedef struct hk_point_sample {
  float (*x)[3];   /* HK_SAMPLES */
  uint32_t *frame; /* HK_SAMPLES: the frame of each */
  size_t count;
  uint64_t stride, passed; /* one of `stride` positions is kept; positions passed by since the last */
} hk_point_sample;

hk_status hk_point_sample_open(hk_point_sample *, const hk_host *);
void hk_point_sample_close(hk_point_sample *, const hk_host *); /* a zeroed one is allowed */
/* Adds finite positions; when there are too many, every other one goes. */
void hk_point_sample_add(hk_point_sample *, const hk_snapshot3d *, uint32_t frame);

#endif
