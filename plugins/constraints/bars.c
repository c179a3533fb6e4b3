/* Rigid bars of any graph, |x_j - x_i| = L: chains, trusses, closed loops, bars that others imply. The equation and its
 * derivatives are in plugins/common/lengths, as L - |x_j - x_i| = 0; the host solves for the multipliers of all bars at
 * once, which are the forces in them, positive in tension. */
#include "plugins/common/lengths/lengths.h"

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(hk_lengths, edges), .flags = HK_REQUIRED},
    {"length", "m", "length; left out: the initial distance", .per_tuple = HK_AT(hk_lengths, length),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  hk_lengths *b = self;
  hk_status status = hk_lengths_start(b, host, view,
                                      "a bar of no length has no direction; hold particles in one place by the "
                                      "constraint 'weld', or give the bar a length");
  if (status != HK_OK) return status;
  for (size_t e = 0; e < b->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&b->edges, e);
    const double *p = view->x + 3 * (size_t)pair[0], *q = view->x + 3 * (size_t)pair[1];
    if (p[0] != q[0] || p[1] != q[1] || p[2] != q[2]) continue;
    return host->fail(host, HK_BAD_PARAM,
                      "particles %u and %u (edge %zu) start in one place, where a bar between them has no direction: "
                      "move one of them",
                      (unsigned)view->model->id[pair[0]], (unsigned)view->model->id[pair[1]], e + 1);
  }
  return HK_OK;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .flags = HK_DISTANCES,
                                         .count = hk_lengths_count,
                                         .pattern = hk_lengths_pattern,
                                         .value = hk_lengths_value,
                                         .jacobian = hk_lengths_jacobian,
                                         .curvature = hk_lengths_curvature};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "bars",
    .summary = "rigid bars, |x_j - x_i| = L",
    .reference = "Witkin, Physically based modeling: constrained dynamics, SIGGRAPH course notes",
    .instance_size = sizeof(hk_lengths),
    .params = params,
    .create = create,
    .constraint = &constraint,
};
