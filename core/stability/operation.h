/* The operators whose eigenvalues are bounded, M^-1/2 K M^-1/2 and M^-1/2 D M^-1/2, as differences of accelerations,
 * and what an estimate works with (see spectrum.c). */
#ifndef HK_STABILITY_OPERATION_H
#define HK_STABILITY_OPERATION_H

#include "core/stability/lanczos.h"
#include "core/stability/stability.h"

/* A scene's vectors are most of the memory that an estimate takes: five are needed in any case, and what only some
 * scenes need is allocated for them. */
struct hk_spectrum_work {
  size_t n, tail; /* tail: length of y */
  double *memory; /* the vectors that every estimate needs */
  double *moved;  /* x or v, displaced; a follows it in memory */
  double *a;      /* m/s^2, on the far side of a difference */
  double *still;  /* what is not displaced: velocities 0, in memory that is never written, or a copy, see rest() */
  bool written;   /* `still` has been written */
  bool imposes;   /* evaluations put particles where their pins have them, and so may change what they are given */
  double *y, *dy[2], *direction;
  double *turn;  /* 1/s, t of every particle; NULL: nothing turns */
  double *spare; /* one more vector; NULL: it was not needed */
  double *ritz;  /* two vectors of repeated estimates; NULL: they are not repeated */
  bool repeats;
  hk_lanczos stiffness, damping;
  const hk_integrator *method; /* whose stable step is wanted; NULL: all that can be said of the scene is */
  const void *parameters;
  double stiffening_damping; /* 1/s, see stiffness.h */
  bool damps_alone;
  double length, spacing; /* m, see measure_scene; 0: not yet */
  hk_spectrum bounds;
};

typedef struct hk_operation {
  hk_spectrum_work *work;
  hk_system *system;
  bool velocity; /* true: D; false: K */
  double step;   /* m or m/s: the largest change of a component */
  double *rest;  /* n x 3: x (or v), which is not displaced */
} hk_operation;

/* The bounds are this much larger than what differences, accurate to about 1e-9, give. */
#define HK_INFLATE (1 + 1e-8)

/* Makes room for a vector that only some scenes need. Forces are evaluated into those of `memory` alone: one that
 * writes next to them does no harm there, and hooke check names it. */
hk_status hk_operation_need(const hk_spectrum_work *, double **vector);
/* Leaves of a vector that is scaled by the roots of the masses what pins and constraints allow. */
hk_status hk_operation_allow(hk_system *, double *vector);
hk_status hk_operation_evaluate(hk_operation *, double *a); /* the accelerations at the displaced state */
/* out = (out - a) -1/2 / (factor sqrt(m)) */
void hk_operation_divide(const hk_operation *, double factor, double *out);
/* out = the operator times in; context: hk_operation. */
hk_status hk_operation_apply(void *context, const double *in, double *out);
hk_status hk_operation_apply_unturned(void *context, const double *in, double *out); /* without t x in */
/* The part of X at `from` for evaluations: a copy where imposing pins may change it. */
double *hk_operation_rest(hk_spectrum_work *, double *from);
double *hk_operation_velocities(hk_spectrum_work *, const hk_system *); /* at which K is taken */
/* Sets `length`, the magnitude of the coordinates, and `spacing`, the scale on which forces vary: the shortest element,
 * or the mean distance of the particles. */
void hk_operation_measure(hk_spectrum_work *, const hk_system *, double shortest);
double hk_operation_step(const hk_spectrum_work *); /* m, of the differences for K */
double hk_operation_noise(const hk_operation *);    /* rounding error of what the last evaluation gave */
double hk_operation_largest(const double *x, size_t count);
double (*hk_operation_blocks(hk_spectrum_work *))[6]; /* 6n numbers: `moved` and `a` */
/* The start vector: random, or the last approximate eigenvector mixed with a random direction, which has a component
 * along every eigenvector. *share: that of the random part. */
hk_status hk_operation_start(hk_lanczos *, hk_system *, bool warm, double *share);
/* Bounds the largest eigenvalue of one operator. When `steps` are too few for a rigorous bound, the last bound is
 * scaled up: with the eigenvalue reached, by the margin of the last rigorous bound, and with the bound `known`. */
hk_status hk_operation_bound(hk_operation *, hk_lanczos *, double known, int steps, bool warm);

/* bound_stiffness.c: bounds w_max. The bounds that the forces state are used when `use_stated`; when Lanczos iteration
 * finds a larger eigenvalue, they are wrong and the estimate is repeated without them. */
hk_status hk_bound_stiffness(hk_spectrum_work *, hk_system *, bool use_stated, int steps, bool warm);
/* bound_damping.c: bounds g_max, b_max and what the damping is at least. */
hk_status hk_bound_damping(hk_spectrum_work *, hk_system *, int steps, bool warm);

#endif
