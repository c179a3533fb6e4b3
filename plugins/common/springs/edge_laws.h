/* Forces along edges that are a function of the length of the edge, its rate and what the element remembers: sums over
 * parts, energy, blocks and bounds from one law. With d = x_j - x_i, l = |d|, n = d/l and the rate l' = (v_j - v_i).n
 * the force on j is -f(l, l') n, and i gets the opposite. An edge of length 0 has no direction and no force. */
#ifndef HK_SPRINGS_EDGE_LAWS_H
#define HK_SPRINGS_EDGE_LAWS_H

#include "plugins/kit/parts/part_sums.h"

typedef struct hk_edge_answer {
  double force;     /* N, above 0: pulls the ends together */
  double energy;    /* J, of which the force is the derivative by the length */
  double stiffness; /* N/m, derivative of the force by the length */
  double damping;   /* N s/m, derivative of the force by the rate */
} hk_edge_answer;

/* First member of an instance, zeroed; `law` to `gone`, whose `self` is the instance, are set in `create`. */
typedef struct hk_edge_laws {
  hk_tuples edges;
  /* The answer of edge e of the length l, m, and the rate, m/s; all 0 on entry. */
  void (*law)(const void *self, const hk_view *view, size_t e, double l, double rate, hk_edge_answer *);
  double (*stiffest)(const void *self, size_t e); /* N/m, the largest stiffness that edge e may have */
  bool (*gone)(const void *self, size_t e);       /* it neither acts nor has blocks any more; NULL: never */
  hk_part_sums sums;
} hk_edge_laws;

/* The length of an edge, m, its rate, m/s, and its direction n, 0 where it has none. */
double hk_edge_laws_measure(const hk_view *view, const uint32_t pair[2], double n[3], double *rate);

/* Functions of the tables of a force; `self` is its instance. */
hk_status hk_edge_laws_topology(void *self, const hk_view *view); /* to be called in `create`, too; HK_NO_MEMORY */
void hk_edge_laws_add_part(void *self, const hk_view *view, size_t part, double *F);
void hk_edge_laws_touch(void *self, const hk_view *view, const hk_part_use *use);
double hk_edge_laws_energy(void *self, const hk_view *view);
void hk_edge_laws_pattern(void *self, const hk_view *view, hk_pattern *p);
hk_status hk_edge_laws_jacobian(void *self, const hk_view *view, const hk_blocks *into);
void hk_edge_laws_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);

#endif
