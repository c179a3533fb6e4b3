#include "plugins/common/surfaces/surface_pair_names.h"

#include <stdio.h>

/* An edge of length 0 is a particle. */
static void name(char text[48], const uint32_t *id, const uint32_t *v, int count) {
  if (count == 3)
    snprintf(text, 48, "triangle %u %u %u", id[v[0]], id[v[1]], id[v[2]]);
  else if (count == 2 && v[0] != v[1])
    snprintf(text, 48, "edge %u %u", id[v[0]], id[v[1]]);
  else
    snprintf(text, 48, "particle %u", id[v[0]]);
}

hk_surface_pair_names hk_surface_pair_name(const hk_surface_pair *pair, const uint32_t *id) {
  hk_surface_pair_names names;
  int first = pair->kind == HK_POINT_TRIANGLE ? 1 : 2;
  name(names.one, id, pair->vertex, first);
  name(names.other, id, pair->vertex + first, 4 - first);
  return names;
}
