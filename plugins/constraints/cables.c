/* Cables that do not stretch: |x_j - x_i| <= L, as g = L - |x_j - x_i| >= 0. A slack cable has no force; where it
 * becomes taut the velocity along it ends (an inelastic impact), and while it is taut it only pulls. The equation and
 * its derivatives are in plugins/common/lengths, what one-sided means in core/numerics/constraints/active_set.c. */
#include "plugins/common/lengths/lengths.h"

static const hk_param params[] = {
    {"edges", "", "pairs of particles to join", .edges = HK_AT(hk_lengths, edges), .flags = HK_REQUIRED},
    {"length", "m", "largest distance; left out: the initial distance", .per_tuple = HK_AT(hk_lengths, length),
     .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  return hk_lengths_start(self, host, view,
                          "a cable of no length is a joint; hold particles in one place by the constraint 'weld', or "
                          "give the cable a length");
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .flags = HK_ONE_SIDED,
                                         .count = hk_lengths_count,
                                         .pattern = hk_lengths_pattern,
                                         .value = hk_lengths_value,
                                         .jacobian = hk_lengths_jacobian,
                                         .curvature = hk_lengths_curvature};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "cables",
    .summary = "cables that do not stretch and may be slack, |x_j - x_i| <= L",
    .reference = "Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics",
    .instance_size = sizeof(hk_lengths),
    .params = params,
    .create = create,
    .constraint = &constraint,
};
