/* The iteration of preconditioned conjugate gradients, Hestenes and Stiefel 1952, J. Res. NBS 49, for any product and
 * any preconditioner. Vectors are divided into chunks whose sums are added in order, so that results are bitwise equal
 * for any number of threads if those of both functions are. */
#ifndef HK_GRADIENTS_LOOP_H
#define HK_GRADIENTS_LOOP_H

#include "core/plugin.h"

enum { HK_GRADIENTS_CHUNK = 4096 };

/* The size of a residual. */
typedef struct hk_residual {
  double squares; /* the sum of the squares of its numbers */
  double largest; /* of the numbers without their signs */
} hk_residual;

typedef struct hk_gradients_loop {
  const hk_host *host;
  size_t unknowns;
  double *x, *r, *z, *p, *q; /* unknowns, and what the functions want beyond */
  hk_residual *part;         /* hk_gradients_chunks(unknowns) */
  void *context;
  double (*product)(void *context, const double *p, double *q);      /* q = A p; returns p.q */
  double (*precondition)(void *context, const double *r, double *z); /* z = M^-1 r, M symmetric; returns r.z */
  hk_residual left;                                                  /* of r; in and out */
  int iterations;                                                    /* so far; in and out */
  double curvature;                                                  /* p.(A p) of the last iteration */
} hk_gradients_loop;

static inline size_t hk_gradients_chunks(size_t unknowns) {
  return (unknowns + HK_GRADIENTS_CHUNK - 1) / HK_GRADIENTS_CHUNK;
}

/* Iterates from x, whose residual is r, until both sizes of the residual are at most those of `goal`, or there have
 * been `limit` iterations. False: the matrix or the preconditioner is not positive definite, or numbers are not finite:
 * `curvature` tells. */
bool hk_gradients_iterate(hk_gradients_loop *, const hk_residual *goal, int limit);

#endif
