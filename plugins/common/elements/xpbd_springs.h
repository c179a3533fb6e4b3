/* The springs and other elements of a scene for XPBD: the order they are solved in, and the sweeps of Gauss-Seidel. */
#ifndef HK_XPBD_SPRINGS_H
#define HK_XPBD_SPRINGS_H

#include "plugins/common/elements/xpbd_elements.h"

enum { HK_XPBD_AUTO, HK_XPBD_SCENE, HK_XPBD_BY_COLOUR }; /* hk_xpbd_springs.order */

/* Zeroed before the first use, but for `order`. The memory is the instance's and goes with it. */
typedef struct hk_xpbd_springs {
  int order;
  hk_element_edges edges;
  double (*x)[HK_XPBD_LANES], (*v)[HK_XPBD_LANES]; /* n + 1 each, the last for lanes without a spring */
  double h;                                        /* s, that the springs' numbers are for; 0: none */
  size_t springs, batches;                         /* solved one by one; in fours */
  struct hk_xpbd_spring *spring;
  struct hk_xpbd_batch *batch;
  uint32_t *source, *lane_source;              /* springs, batches x LANES: position in `edges` */
  size_t colours, colour[HK_XPBD_COLOURS + 1]; /* batches of colour k: colour[k] to colour[k + 1] */
  uint64_t *used;                              /* n: colours at a particle */
  uint8_t *tint;                               /* springs of `edges`: colour; COLOURS: alone, UINT8_MAX: does nothing */
  double *work;                                /* per chunk of batches */
  hk_xpbd_elements elements;                   /* those with an `evaluate`: in every sweep after the springs */
} hk_xpbd_springs;

/* hk_element_edges_take, then the order of the springs; to be called before each step. scratch: 3n. Allocates when the
 * topology is new only. */
hk_status hk_xpbd_springs_take(hk_xpbd_springs *, hk_system *, double *scratch);
/* Sweeps from x (n x 4, m, kept) and v (n x 4, m/s, without the springs' impulses; on return with them, and the
 * positions are x + h v). A symmetric iteration goes there and back. Returns the work of damping and path pins, J. */
double hk_xpbd_springs_solve(hk_xpbd_springs *, const hk_host *, double h, int64_t iterations, bool symmetric);

#endif
