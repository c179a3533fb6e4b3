/* Bounds of the stiffness and damping of forces along edges: see edge_stiffness.c. */
#ifndef HK_COMMON_EDGE_STIFFNESS_H
#define HK_COMMON_EDGE_STIFFNESS_H

#include "core/plugin.h"

typedef struct hk_edge_stiffness {
  const hk_tuples *edges;
  const hk_per_tuple *k, *damping, *rest; /* N/m, N s/m, m */
  bool drawn; /* bounds the limit of infinite extension, where an edge is as stiff across as along */
} hk_edge_stiffness;

/* Adds the share of one edge along the unit vector n (0: no direction) with the stiffness or damping `along` it and
 * `across`, neither negative. */
void hk_edge_stiffness_add(const hk_view *, const uint32_t pair[2], const double n[3], double along, double across,
                           double (*block)[6]);

typedef struct hk_edge_numbers {
  double k, damping, rest; /* N/m, N s/m, m */
} hk_edge_numbers;

/* Adds the share of one spring to what the function below has to sum; `drawn` as above. */
void hk_edge_stiffness_one(const hk_view *, const uint32_t pair[2], hk_edge_numbers, bool drawn, hk_stiffness_part,
                           double (*block)[6]);

/* As hk_force.stiffness_bound, for all u that are 0 at particles without inverse mass: those have no share. */
void hk_edge_stiffness_bound(const hk_edge_stiffness *, const hk_view *, hk_stiffness_part, double (*block)[6]);

#endif
