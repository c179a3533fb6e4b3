/* Welds: a pair of particles keeps its difference, x_j - x_i = (dx, dy, dz), in all three directions. Particles that
 * start at one place stay together (two strands joined at their ends), others keep their distance and direction (a
 * cloth sewn to a rod beside it); where i is a pin with a path, j goes with it. The gradients are -I and I and nothing
 * is quadratic, so the equations hold to rounding once they do.
 *
 * A particle is a point and does not turn, and so neither does a difference: it is fixed in space, not in the rod. What
 * shall turn with the rest is joined by bars, three to each particle. A direction is clamped by two particles: pin the
 * first of a strand and weld the second to it, and its root keeps the angle of the start; pins with paths turn it.
 * Welds in a closed loop follow from each other, and their forces are then those of least squares. */
#include "core/plugin.h"

typedef struct weld {
  hk_tuples edges;
  hk_per_tuple d[3]; /* m */
} weld;

static const hk_param params[] = {
    {"edges", "", "pairs of particles to weld", .edges = HK_AT(weld, edges), .flags = HK_REQUIRED},
    {"dx", "m", "x of the second minus x of the first; left out: as they start", .per_tuple = HK_AT(weld, d[0]),
     .flags = HK_OPTIONAL},
    {"dy", "m", "the same of y", .per_tuple = HK_AT(weld, d[1]), .flags = HK_OPTIONAL},
    {"dz", "m", "the same of z", .per_tuple = HK_AT(weld, d[2]), .flags = HK_OPTIONAL},
    {0},
};

static double difference(const double *x, const uint32_t *pair, int c) {
  return x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  weld *w = self;
  for (int c = 0; c < 3; c++) {
    if (w->d[c].count) continue;
    double *start = host->allocate(host, (w->edges.count + 1) * sizeof *start);
    if (!start) return host->fail(host, HK_NO_MEMORY, "no memory for %zu welds", w->edges.count);
    for (size_t k = 0; k < w->edges.count; k++) start[k] = difference(view->x, hk_tuple(&w->edges, k), c);
    w->d[c] = (hk_per_tuple){w->edges.count, start};
  }
  return HK_OK;
}

/* ---- the equations: three to a pair, each with its two particles ---- */

static size_t count(void *self) { return 3 * ((const weld *)self)->edges.count; }

static void pattern(void *self, hk_pattern *into) {
  const weld *w = self;
  for (size_t k = 0; k < count(self); k++)
    for (int end = 0; end < 2; end++) into->block(into, (uint32_t)k, hk_tuple(&w->edges, k / 3)[end]);
}

static hk_status value(void *self, const hk_view *view, double *g) {
  const weld *w = self;
  for (size_t k = 0; k < count(self); k++)
    g[k] = difference(view->x, hk_tuple(&w->edges, k / 3), (int)(k % 3)) - hk_tuple_value(&w->d[k % 3], k / 3);
  return HK_OK;
}

static hk_status jacobian(void *self, const hk_view *view, double (*J)[3]) {
  (void)view;
  for (size_t b = 0; b < 2 * count(self); b++)
    for (size_t c = 0; c < 3; c++) J[b][c] = c != b / 2 % 3 ? 0 : b % 2 ? 1 : -1;
  return HK_OK;
}

static hk_status curvature(void *self, const hk_view *view, double *c) {
  (void)view;
  for (size_t k = 0; k < count(self); k++) c[k] = 0;
  return HK_OK;
}

static const hk_constraint constraint = {.size = sizeof(hk_constraint),
                                         .flags = HK_DIFFERENCES,
                                         .count = count,
                                         .pattern = pattern,
                                         .value = value,
                                         .jacobian = jacobian,
                                         .curvature = curvature};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CONSTRAINT,
    .name = "weld",
    .summary = "pairs of particles that keep their difference, x_j - x_i = (dx, dy, dz), or coincide",
    .reference = "Baraff, Linear-Time Dynamics using Lagrange Multipliers (SIGGRAPH 1996), section 1",
    .instance_size = sizeof(weld),
    .params = params,
    .create = create,
    .constraint = &constraint,
};
