/* Particles on lines and in planes for solvers that treat the coordinates apart: see slides.c. */
#ifndef HK_SLIDE_PINS_H
#define HK_SLIDE_PINS_H

#include "plugins/common/springs/element_edges.h"

/* Zeroed before the first use. */
typedef struct hk_slide_pins {
  size_t count;        /* directions that are not allowed: one per plane, two per line */
  uint32_t *particle;  /* count */
  double (*normal)[3]; /* count, unit vectors */
  double *L;           /* count x count: Cholesky factor of N^T A^-1 N, lower triangle */
  double *lambda;      /* count */
} hk_slide_pins;

/* The directions, from the pins' projectors. What was there is released first. */
hk_status hk_slide_pins_build(hk_slide_pins *, const hk_host *host, const hk_element_edges *edges);
void hk_slide_pins_release(hk_slide_pins *, const hk_host *host);
/* To be called after every s->factorize of the n x n matrix A. b, x: 3n, scratch. */
hk_status hk_slide_pins_factorize(hk_slide_pins *, hk_system *s, double *b, double *x);
/* Of dx = A^-1 r makes the dx that minimises dx.A dx/2 - r.dx among those that the pins allow. b, x: 3n, scratch. */
hk_status hk_slide_pins_correct(hk_slide_pins *, hk_system *s, double *dx, double *b, double *x);

#endif
