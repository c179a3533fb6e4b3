#include "plugins/common/snapshot/point_sample.h"

#include <string.h>

hk_status hk_point_sample_open(hk_point_sample *s, const hk_host *host) {
  *s = (hk_point_sample){.stride = 1};
  s->x = host->allocate(host, HK_SAMPLES * sizeof *s->x);
  s->frame = host->allocate(host, HK_SAMPLES * sizeof *s->frame);
  return s->x && s->frame ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory to choose the camera");
}

void hk_point_sample_close(hk_point_sample *s, const hk_host *host) {
  host->release(host, s->x);
  host->release(host, s->frame);
  *s = (hk_point_sample){0};
}

static void thin_out(hk_point_sample *s) {
  s->count = HK_SAMPLES / 2;
  for (size_t k = 0; k < s->count; k++) {
    memcpy(s->x[k], s->x[2 * k + 1], sizeof s->x[k]);
    s->frame[k] = s->frame[2 * k + 1];
  }
  s->stride *= 2;
}

void hk_point_sample_add(hk_point_sample *s, const hk_snapshot3d *snapshot, uint32_t frame) {
  for (size_t i = 0; i < snapshot->n; i++) {
    if (isnan(snapshot->x[i][0]) || ++s->passed < s->stride) continue;
    s->passed = 0;
    if (s->count == HK_SAMPLES) thin_out(s);
    memcpy(s->x[s->count], snapshot->x[i], sizeof s->x[0]);
    s->frame[s->count++] = frame;
  }
}
