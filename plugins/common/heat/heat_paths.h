/* Ways that heat takes between particles: from the shapes of edges, triangles and tetrahedra a length g, m, for each
 * two of their particles, so that m_i dh_i/dt = sum over j of g_ij (theta_j - theta_i), W. What one particle gives, the
 * other gets, so the enthalpy sum m h is kept to rounding. Of a bar g is its section by its length; of triangles and
 * tetrahedra it is that of linear elements with the mass in their corners, -volume grad N_i . grad N_j, of a triangle
 * thickness cot(alpha)/2 with the angle opposite of the side (Zienkiewicz and Taylor 2000, The finite element method,
 * volume 1, chapter 7). Obtuse angles make ways of negative length: right for fields that are resolved, but such an
 * element may cool what is coldest. */
#ifndef HK_HEAT_PATHS_H
#define HK_HEAT_PATHS_H

#include "core/plugin.h"

/* One list of elements with the lengths of all its ways, count x hk_heat_ways(arity) m, in the order 01, 02, 12, 03,
 * 13, 23. */
typedef struct hk_heat_elements {
  const hk_tuples *node;
  const double *length;
  const bool *gone; /* count: it is no more, and no heat passes it; NULL: all are there */
} hk_heat_elements;

static inline size_t hk_heat_ways(unsigned arity) { return arity * (arity - 1) / 2; }

/* m: the ways of one element at the positions x (n x 3); `size` is the section of an edge, m^2, or the thickness of a
 * triangle, m, and not used for tetrahedra. HK_BAD_PARAM: its length, area or volume is 0, as `which` (from 1) of its
 * list. */
hk_status hk_heat_shape(const hk_view *view, const hk_tuples *node, size_t which, double size, double *length);

/* The ways of each particle, one row behind the other. Zeroed before the first call. */
typedef struct hk_heat_paths {
  size_t *start;   /* n + 1 */
  uint32_t *other; /* start[n]: the particle at the other end */
  double *length;  /* start[n], m */
} hk_heat_paths;

/* Of all elements that are there and whose particles all act. HK_NO_MEMORY. */
hk_status hk_heat_paths_build(hk_heat_paths *, const hk_view *view, const hk_heat_elements *list, size_t lists);
/* rate[i] += sum of g (theta_j - theta_i)/m_i, J/(kg s), for the acting particles; potential: n, W/m. Rows are summed
 * in their order, so threads leave no trace. */
void hk_heat_paths_add(const hk_heat_paths *, const hk_view *view, const double *potential, double *rate);
/* m/kg: the largest sum of |g| by the mass of a particle, of half of Gershgorin's bound. */
double hk_heat_paths_densest(const hk_heat_paths *, const hk_view *view);

#endif
