/* Elements of any arity for XPBD: the order in which they are solved, and the Gauss-Seidel sweeps. */
#ifndef HK_XPBD_ELEMENTS_H
#define HK_XPBD_ELEMENTS_H

#include "plugins/common/springs/element_edges.h"
#include "plugins/common/elements/element_tuples.h"

enum { HK_XPBD_LANES = 4, HK_XPBD_COLOURS = 64, HK_XPBD_COLOURS_FROM = 1000 };

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_xpbd_elements {
  hk_element_tuples tuples;
  double *x;                                   /* n x 3, m: positions of members at the end of the substep */
  double (*impulse)[4][3];                     /* per tuple and member, N s: the impulse given in this substep so far */
  size_t colours, colour[HK_XPBD_COLOURS + 1]; /* tuples of colour k: sequence[colour[k]] to sequence[colour[k + 1]] */
  uint32_t *sequence; /* positions in `tuples`; those after the colours are solved one by one */
  uint8_t *tint;      /* per tuple: its colour; COLOURS: it is solved alone */
  uint64_t *used;     /* n: bit set of the colours at a particle */
  double *work;       /* per chunk of a colour */
} hk_xpbd_elements;

/* Velocities and positions of a substep, as in hk_xpbd_springs_solve. */
typedef struct hk_xpbd_substep {
  const hk_host *host;
  const hk_element_edges *pins;
  double (*x)[HK_XPBD_LANES], (*v)[HK_XPBD_LANES];
  double h; /* s */
} hk_xpbd_substep;

/* Collects the tuples and determines their order, by colours or that of the scene. `fresh`: the topology is new; memory
 * is allocated only then. */
hk_status hk_xpbd_elements_take(hk_xpbd_elements *, hk_system *, bool fresh, bool by_colour);
void hk_xpbd_elements_start(hk_xpbd_elements *); /* to be called at the start of a substep: sets all impulses to 0 */
/* One sweep; `back`: in the opposite order. Returns the work of path pins and, in the last sweep, of damping, J. */
double hk_xpbd_elements_sweep(hk_xpbd_elements *, const hk_xpbd_substep *, bool back, bool last);

#endif
