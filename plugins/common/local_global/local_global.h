/* Parts of the integrator local_global, which says what the letters mean: the matrix of the global step, and what keeps
 * its iteration from raising g. */
#ifndef HK_LOCAL_GLOBAL_H
#define HK_LOCAL_GLOBAL_H

#include "plugins/common/elements/element_energy.h"
#include "plugins/common/integrate/slide_pins.h"
#include "plugins/common/linear/anderson.h"
#include "plugins/common/linear/laplacian.h"
#include "plugins/common/springs/element_edges.h"
#include "plugins/common/springs/layout_forces.h"

enum { HK_LOCAL_GLOBAL_PLAIN, HK_LOCAL_GLOBAL_ANDERSON };

typedef struct hk_local_global {
  int64_t iterations, window;
  int acceleration;
  double tolerance;

  const hk_host *host;
  hk_element_edges edges;
  hk_laplacian laplacian;
  hk_slide_pins slides;
  hk_spring_layout springs, dampers; /* springs without damping; dampers without stiffness */
  hk_element_energy elements;        /* the elements that are not springs */
  double *weight, *diagonal;         /* off-diagonal: edges, then pairs of the elements' members; diagonal: n */
  double h;
  hk_anderson anderson;

  int64_t warned;
  double change;      /* change in the last iteration, relative to the step's displacement */
  double *d, *y;      /* n x 3, m: displacements in this step, of x and without internal forces */
  double *from;       /* n x 3, m: d before the last correction; with elements only */
  bool soft;          /* whether a correction was reduced to a quarter or less */
  bool weighed;       /* whether weights of the elements were computed in this run */
  hk_array steepness; /* double: of the elements, for runs resumed from a checkpoint */
  double *F, *r, *dx, *scratch;
  double *next, *slope; /* shaped as X: the new state; (a, dy) */
} hk_local_global;

/* ---- local_global_matrix.c ---- */

/* Makes the matrix of steps of h, s, where springs, pins or h are others. */
hk_status hk_local_global_prepare(hk_local_global *, hk_system *, double h);
/* Makes it again where gradients of elements have become steeper than its weights. */
hk_status hk_local_global_stiffen(hk_local_global *, hk_system *, double h);

/* ---- local_global_descent.c ---- */

/* Computes the new x and evaluates the elements there. */
void hk_local_global_place(hk_local_global *, const hk_system *);
/* g at the new x, J s^2; *noise: with elements its rounding error, else 0. */
double hk_local_global_objective(const hk_local_global *, const hk_system *, double h, double *noise);
/* With elements an unaccelerated correction may raise g as well: it is halved until g does not rise by more than its
 * rounding error, which is reached because dx is a direction of descent. Returns g, which was `now`. */
double hk_local_global_shorten(hk_local_global *, const hk_system *, double h, double g, double now, double *noise);
/* If g rose, the accelerated x is replaced by the unaccelerated one, which cannot raise g without elements, and the
 * acceleration starts again. */
void hk_local_global_safeguard(hk_local_global *, const hk_system *, double h, double *g);
/* With elements, the iteration starts where g is smaller: at the position without internal forces, or at that of the
 * start of the step. g of the new x is then at most g of the old one, so that no step adds energy. */
void hk_local_global_choose_start(hk_local_global *, const hk_system *, double h);

#endif
