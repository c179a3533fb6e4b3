/* Anderson's acceleration of a fixed-point iteration x <- G(x): see anderson.c. */
#ifndef HK_ANDERSON_H
#define HK_ANDERSON_H

#include "core/plugin.h"

enum { HK_ANDERSON_MOST = 16 };

/* To be zeroed before the first use. */
typedef struct hk_anderson {
  size_t length, window;                           /* numbers in x; largest number of differences stored */
  size_t count, next;                              /* differences stored; position of the next one */
  bool primed;                                     /* f_last, g_last and r_last are set */
  double *f_last, *g_last, *r_last;                /* length each: f, g and r of the last iteration */
  double *memory;                                  /* 3 x (window + 2) x length: these three and the differences */
  double gram[HK_ANDERSON_MOST][HK_ANDERSON_MOST]; /* scalar products of the stored differences of f and r */
} hk_anderson;

hk_status hk_anderson_reserve(hk_anderson *, const hk_host *host, size_t length, size_t window);
void hk_anderson_release(hk_anderson *, const hk_host *host);
void hk_anderson_clear(hk_anderson *); /* removes all differences, after x was changed by other means */
/* Computes the next x from g = G(x), f = g - x and r = A f, with A symmetric and positive definite, and from the stored
 * differences. x may be the same array as g. */
void hk_anderson_next(hk_anderson *, const double *f, const double *g, const double *r, double *x);

#endif
