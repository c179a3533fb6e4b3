/* The springs and other elements of a scene for XPBD: the order of their solution, and the Gauss-Seidel sweeps. */
#ifndef HK_XPBD_SPRINGS_H
#define HK_XPBD_SPRINGS_H

#include "plugins/common/elements/xpbd_elements.h"

enum { HK_XPBD_AUTO, HK_XPBD_SCENE, HK_XPBD_BY_COLOUR }; /* hk_xpbd_springs.order */

/* To be zeroed before the first use, except `order`. The memory belongs to the instance and is released with it. */
typedef struct hk_xpbd_springs {
  int order;
  hk_element_edges edges;
  double (*x)[HK_XPBD_LANES], (*v)[HK_XPBD_LANES]; /* n + 1 each, the last for lanes without a spring */
  double h;                /* s, the step for which the springs' coefficients were computed; 0: none */
  size_t springs, batches; /* number of springs solved one by one; number of batches of four */
  struct hk_xpbd_spring *spring;
  struct hk_xpbd_batch *batch;
  uint32_t *source, *lane_source;              /* `springs` and batches x LANES: positions in `edges` */
  size_t colours, colour[HK_XPBD_COLOURS + 1]; /* batches of colour k: colour[k] to colour[k + 1] */
  uint64_t *used;                              /* n: bit set of the colours at a particle */
  uint8_t *tint;             /* per spring of `edges`: its colour; COLOURS: solved alone; UINT8_MAX: no effect */
  double *work;              /* per chunk of batches */
  hk_xpbd_elements elements; /* elements with an `evaluate`: solved after the springs in every sweep */
} hk_xpbd_springs;

/* Calls hk_element_edges_take, then determines the order of the springs; to be called before each step. scratch: 3n.
 * Memory is allocated only when the topology is new. */
hk_status hk_xpbd_springs_take(hk_xpbd_springs *, hk_system *, double *scratch);
/* Sweeps over positions x (n x 4, m, unchanged) and velocities v (n x 4, m/s, on entry without the springs' impulses,
 * on return with them; the new positions are x + h v). A symmetric iteration is a sweep in each direction. Returns the
 * work of damping and path pins, J. */
double hk_xpbd_springs_solve(hk_xpbd_springs *, const hk_host *, double h, int64_t iterations, bool symmetric);

#endif
