/* Follower forces: forces of constant size along an edge, which rotate with it, such as the thrust of an engine on a
 * rod. With d = x_j - x_i and n = d/|d| the force f n acts on the second end j, on the first end i, or half of it on
 * each. It has no energy: its work depends on the path, and its power is that of f n. An edge of length 0 has no
 * direction and no force.
 *
 * -dF/dx_j = dF/dx_i = -(f/|d|) (I - n n^T) only in the rows of the ends on which it acts, so it is not symmetric: a
 * loaded column flutters where a weight would only buckle it. Beck, ZAMP 3 (1952). */
#include "plugins/kit/springs/edge.h"
#include "core/plugin.h"

enum { SECOND, FIRST, BOTH };

typedef struct follower {
  hk_tuples edges;
  hk_per_tuple f;
  int on;
} follower;

static const hk_param params[] = {
    {"edges", "", "pairs of particles that give the direction, from the first to the second",
     .edges = HK_AT(follower, edges), .flags = HK_REQUIRED},
    {"f", "N", "size of the force; negative: towards the first end", .per_tuple = HK_AT(follower, f),
     .flags = HK_REQUIRED},
    {"on", "", "the end it acts on; both: half on each", .choice = HK_AT(follower, on), .initial = {SECOND},
     .choices = "second|first|both"},
    {0},
};

/* The part of f on end 0 (first) or 1 (second). */
static double share(const follower *p, int end) { return p->on == BOTH ? 0.5 : end == (p->on == SECOND); }

/* The unit vector along an edge; returns 1/|d|, or 0 where there is no direction. */
static double direction(const hk_view *view, const uint32_t pair[2], double n[3]) {
  double square = 0;
  for (int c = 0; c < 3; c++) n[c] = view->x[3 * (size_t)pair[1] + c] - view->x[3 * (size_t)pair[0] + c];
  for (int c = 0; c < 3; c++) square += n[c] * n[c];
  double inverse = square > 0 ? 1 / sqrt(square) : 0;
  for (int c = 0; c < 3; c++) n[c] *= inverse;
  return inverse;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const follower *p = self;
  for (size_t e = 0; e < p->edges.count; e++) {
    const uint32_t *pair = hk_tuple(&p->edges, e);
    double n[3], power = 0;
    if (!hk_edge_acts(view, pair)) continue;
    direction(view, pair, n);
    for (int end = 0; end < 2; end++)
      for (int c = 0; c < 3; c++) {
        double f = share(p, end) * hk_tuple_value(&p->f, e) * n[c];
        F[3 * (size_t)pair[end] + c] += f;
        power += f * view->v[3 * (size_t)pair[end] + c];
      }
    if (view->power) *view->power += power;
  }
  return HK_OK;
}

/* Names the blocks: rows of the ends on which the force acts, columns of both ends. */
static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  const follower *p = self;
  for (size_t e = 0; e < p->edges.count; e++)
    for (int b = 0; b < 4; b++)
      if (hk_edge_acts(view, hk_tuple(&p->edges, e)) && share(p, b / 2) > 0)
        pattern->block(pattern, hk_tuple(&p->edges, e)[b / 2], hk_tuple(&p->edges, e)[b % 2]);
}

static void add_block(double *K, double f, const double n[3]) {
  for (int q = 0; q < 9; q++) K[q] += f * ((q % 4 == 0) - n[q / 3] * n[q % 3]);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const follower *p = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < p->edges.count; e++) {
    double n[3];
    if (!hk_edge_acts(view, hk_tuple(&p->edges, e))) continue;
    double stiffness = hk_tuple_value(&p->f, e) * direction(view, hk_tuple(&p->edges, e), n);
    for (int b = 0; b < 4; b++)
      if (share(p, b / 2) > 0) add_block(into->K + 9 * *slot++, share(p, b / 2) * stiffness * (b % 2 ? -1 : 1), n);
  }
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_POWER,
    .add = add,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "follower",
    .summary = "force of constant size along an edge, turning with it, F = f d/|d|",
    .reference = "Beck, Die Knicklast des einseitig eingespannten, tangential gedrueckten Stabes, ZAMP 3 (1952)",
    .instance_size = sizeof(follower),
    .params = params,
    .force = &force,
};
