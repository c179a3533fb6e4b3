/* Muscles: a tension along edges that may be a function of time, such as a control. It pulls both ends of an edge
 * towards each other with the same force, F n on the first and -F n on the second end, n = d/|d|, d = x_j - x_i, so
 * that it changes neither momentum nor angular momentum. A spring whose rest length changes by r(t) is `springs` with
 * the mean rest length and beside it a tension of -k r(t): Witkin and Kass, Spacetime constraints (1988), have their
 * muscles like this. An edge of length 0 has no direction and no force.
 *
 * -dF_i/dx_i = (F/|d|) (I - n n^T), positive for a tension, with zero across along the edge. What it does is counted as
 * work. */
#include "plugins/kit/springs/edge.h"
#include "core/plugin.h"

typedef struct muscles {
  hk_tuples edges;
  double tension;
} muscles;

static const hk_param params[] = {
    {"edges", "", "pairs of particles that are pulled together", .edges = HK_AT(muscles, edges), .flags = HK_REQUIRED},
    {"tension", "N", "of every edge; negative: it pushes the ends apart", .number = HK_AT(muscles, tension),
     .flags = HK_REQUIRED | HK_TIMED},
    {0},
};

/* The unit vector along an edge; returns 1/|d|, or 0 where there is no direction. */
static double direction(const hk_view *view, const uint32_t pair[2], double n[3]) {
  const double length = hk_edge_difference(view->x, pair, n);
  const double inverse = length * length > HK_SPRING_TINY ? 1 / length : 0;
  for (int c = 0; c < 3; c++) n[c] *= inverse;
  return inverse;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const muscles *p = self;
  double n[3], shortening = 0;
  for (size_t e = 0; e < p->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&p->edges, e);
    if (!hk_edge_acts(view, pair)) continue;
    direction(view, pair, n);
    for (size_t c = 0; c < 3; c++) {
      const size_t first = 3 * (size_t)pair[0] + c, second = 3 * (size_t)pair[1] + c;
      F[first] += p->tension * n[c];
      F[second] -= p->tension * n[c];
      shortening += (view->v[first] - view->v[second]) * n[c];
    }
  }
  if (view->power) *view->power += p->tension * shortening;
  return HK_OK;
}

static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  const muscles *p = self;
  for (size_t e = 0; e < p->edges.count; e++)
    for (int b = 0; b < 4; b++)
      if (hk_edge_acts(view, hk_tuple(&p->edges, e)))
        pattern->block(pattern, hk_tuple(&p->edges, e)[b / 2], hk_tuple(&p->edges, e)[b % 2]);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const muscles *p = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < p->edges.count; e++) {
    double n[3];
    if (!hk_edge_acts(view, hk_tuple(&p->edges, e))) continue;
    const double stiffness = p->tension * direction(view, hk_tuple(&p->edges, e), n);
    for (int b = 0; b < 4; b++) {
      double *K = into->K + 9 * *slot++, part = b % 3 == 0 ? stiffness : -stiffness;
      for (int q = 0; q < 9; q++) K[q] += part * ((q % 4 == 0) - n[q / 3] * n[q % 3]);
    }
  }
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_POWER | HK_SYMMETRIC_JACOBIAN,
    .add = add,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "muscles",
    .summary = "tension along edges that may be a function of time, F = T(t) d/|d|",
    .reference = "Witkin, Kass, Spacetime constraints, SIGGRAPH (1988)",
    .instance_size = sizeof(muscles),
    .params = params,
    .force = &force,
};
