/* Sliding pins (lines and planes) for methods that solve each coordinate separately: see slide_pins.c. */
#ifndef HK_SLIDE_PINS_H
#define HK_SLIDE_PINS_H

#include "plugins/common/springs/element_edges.h"

/* To be zeroed before the first use. */
typedef struct hk_slide_pins {
  size_t count;        /* forbidden directions: one per plane, two per line */
  uint32_t *particle;  /* count */
  double (*normal)[3]; /* count, unit vectors */
  double *L;           /* count x count: Cholesky factor of N^T A^-1 N, lower triangle */
  double *lambda;      /* count */
} hk_slide_pins;

/* Computes the forbidden directions from the pins' projectors. Earlier content is released first. */
hk_status hk_slide_pins_build(hk_slide_pins *, const hk_host *host, const hk_element_edges *edges);
void hk_slide_pins_release(hk_slide_pins *, const hk_host *host);
/* To be called after every s->factorize of the n x n matrix A. b, x: 3n, scratch. */
hk_status hk_slide_pins_factorize(hk_slide_pins *, hk_system *s, double *b, double *x);
/* Changes dx = A^-1 r into the dx that minimises dx.A dx/2 - r.dx among those the pins allow. b, x: 3n, scratch. */
hk_status hk_slide_pins_correct(hk_slide_pins *, hk_system *s, double *dx, double *b, double *x);

#endif
