#include "plugins/common/frame_data/frame_data.h"

const hk_field_kind hk_field_kinds[HK_FIELD_KINDS] = {
    [HK_FIELD_VELOCITY] = {"velocity", "m/s", "speed", HK_MAP_VIRIDIS},
    [HK_FIELD_STRAIN] = {"strain", "", NULL, HK_MAP_DIVERGING},
    [HK_FIELD_CHANNEL] = {"channel", "", NULL, HK_MAP_VIRIDIS},
    [HK_FIELD_FORCE] = {"force", "N", NULL, HK_MAP_VIRIDIS},
};

bool hk_frame_field_at(const hk_frame_data *d, size_t k, hk_frame_field *field) {
  size_t own = d->strain ? 2 : 1;
  if (k < own) {
    int kind = k ? HK_FIELD_STRAIN : HK_FIELD_VELOCITY;
    *field = (hk_frame_field){kind, hk_field_kinds[kind].name, k ? 1 : 3, k ? d->strain : d->v};
    return true;
  }
  if (k - own >= d->arrays) return false;
  const hk_frame_array *a = &d->array[k - own];
  *field = (hk_frame_field){a->force ? HK_FIELD_FORCE : HK_FIELD_CHANNEL, a->name, a->width, a->value};
  return true;
}
