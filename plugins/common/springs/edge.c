#include "plugins/common/springs/edge.h"

hk_status hk_edge_rest(const hk_host *host, const hk_view *view, const hk_tuples *edges, hk_per_tuple *rest) {
  if (rest->count) return HK_OK;
  double d[3], *length = host->allocate(host, (edges->count + 1) * sizeof *length);
  if (!length) return host->fail(host, HK_NO_MEMORY, "no memory for the rest lengths");
  for (size_t e = 0; e < edges->count; e++) length[e] = hk_edge_difference(view->x, hk_tuple(edges, e), d);
  *rest = (hk_per_tuple){edges->count, length};
  return HK_OK;
}
