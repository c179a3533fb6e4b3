/* The operators M^-1/2 K M^-1/2 and M^-1/2 D M^-1/2 as central differences of accelerations, and the vectors of an
 * estimate of their largest eigenvalues (spectrum.c). */
#ifndef HK_STABILITY_OPERATION_H
#define HK_STABILITY_OPERATION_H

#include "core/numerics/stability/lanczos.h"
#include "core/numerics/stability/stability.h"

/* Vectors of the scene's length dominate the memory: five for every estimate, the others only in scenes that need them.
 */
typedef struct hk_spectrum_work {
  size_t n, tail; /* tail: length of y */
  double *memory; /* the vectors that every estimate needs */
  double *moved;  /* x or v, displaced; a follows it in memory */
  double *a;      /* m/s^2, on the far side of a difference */
  double *still;  /* the part of X that is not displaced: zero velocities in untouched memory, or a copy, see rest() */
  bool written;   /* `still` has been written */
  bool imposes;   /* evaluations impose the pins, and so may change x and v */
  double *y, *dy[2], *direction;
  double *turn;  /* 1/s, t of every particle; NULL: nothing turns */
  double *spare; /* one more vector, or NULL */
  hk_lanczos stiffness, damping;
  const hk_integrator *method; /* the method whose stable step is estimated; NULL: all bounds are wanted */
  const void *parameters;
  double stiffening_damping; /* 1/s, see stiffness.h */
  bool damps_alone;
  double length, spacing; /* m, see measure_scene; 0: not yet */
  hk_spectrum bounds;
} hk_spectrum_work;

typedef struct hk_operation {
  hk_spectrum_work *work;
  hk_system *system;
  bool velocity; /* true: D; false: K */
  double step;   /* m or m/s: the largest change of a component */
  double *rest;  /* n x 3: x (or v), which is not displaced */
} hk_operation;

/* The bounds are this much larger than what differences, accurate to about 1e-9, give. */
#define HK_INFLATE (1 + 1e-8)

/* Allocates an optional vector. Forces write only into vectors of `memory`, where writing past the end does no harm
 * (and hooke check reports it). HK_NO_MEMORY. */
hk_status hk_operation_need(const hk_spectrum_work *, double **vector);
/* Projects a vector, scaled by the square roots of the masses, onto the motions that pins and constraints allow. */
hk_status hk_operation_allow(hk_system *, double *vector);
hk_status hk_operation_evaluate(hk_operation *, double *a); /* the accelerations at the displaced state */
/* out = (out - a) -1/2 / (factor sqrt(m)) */
void hk_operation_difference(const hk_operation *, double factor, double *out);
/* out = the operator times in; context: hk_operation. */
hk_status hk_operation_apply(void *context, const double *in, double *out);
hk_status hk_operation_apply_unturned(void *context, const double *in, double *out); /* without t x in */
/* The part of X at `from` for evaluations: a copy where imposing pins may change it. */
double *hk_operation_rest(hk_spectrum_work *, double *from);
double *hk_operation_velocities(hk_spectrum_work *, const hk_system *); /* at which K is taken */
/* Sets `length`, the magnitude of the coordinates, and `spacing`, the scale on which forces vary: the shortest element,
 * or the mean distance of the particles. */
void hk_operation_measure(hk_spectrum_work *, const hk_system *, double shortest);
double hk_operation_step(const hk_spectrum_work *); /* m, the displacement in differences for K */
double hk_operation_noise(
    const hk_operation *); /* rounding error of a difference, from the largest acceleration of the last evaluation */
double hk_operation_largest(const double *x, size_t count);
double (*hk_operation_blocks(hk_spectrum_work *))[6];    /* 6n numbers: `moved` and `a` */
hk_status hk_operation_start(hk_lanczos *, hk_system *); /* the start vector: random, as pins and constraints allow */
hk_status hk_operation_bound(hk_operation *, hk_lanczos *, double known); /* the largest eigenvalue of one operator */

/* bound_stiffness.c: bounds w_max. The bounds that the forces state are used when `use_stated`; when Lanczos iteration
 * finds a larger eigenvalue, they are wrong and the estimate is repeated without them. */
hk_status hk_bound_stiffness(hk_spectrum_work *, hk_system *, bool use_stated);
/* bound_damping.c: bounds g_max, b_max and what the damping is at least. */
hk_status hk_bound_damping(hk_spectrum_work *, hk_system *);
/* damping_pencil.c: bounds how damping rises with frequency, from above and from below, where the step depends on it.
 * The operator is D, which is symmetric but for turning. */
hk_status hk_bound_pencils(hk_spectrum_work *, const hk_operation *);

#endif
