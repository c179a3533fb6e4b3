/* Particles on lines and in planes for solvers that treat the coordinates apart: see slides.c. */
#ifndef HK_SLIDES_H
#define HK_SLIDES_H

#include "plugins/common/element_edges.h"

/* Zeroed before the first use. */
typedef struct hk_slides {
  size_t count;        /* directions that are not allowed: one per plane, two per line */
  uint32_t *particle;  /* count */
  double (*normal)[3]; /* count, unit vectors */
  double *L;           /* count x count: Cholesky factor of N^T A^-1 N, lower triangle */
  double *lambda;      /* count */
} hk_slides;

/* The directions, from the pins' projectors. What was there is released first. */
hk_status hk_slides_build(hk_slides *, const hk_host *host, const hk_element_edges *edges);
void hk_slides_release(hk_slides *, const hk_host *host);
/* To be called after every s->factorize of the n x n matrix A. b, x: 3n, scratch. */
hk_status hk_slides_factorize(hk_slides *, hk_system *s, double *b, double *x);
/* Of dx = A^-1 r makes the dx that minimises dx.A dx/2 - r.dx among those that the pins allow. b, x: 3n, scratch. */
hk_status hk_slides_correct(hk_slides *, hk_system *s, double *dx, double *b, double *x);

#endif
