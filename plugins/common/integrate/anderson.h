/* Anderson's acceleration of a fixed-point iteration x <- G(x): see anderson.c. */
#ifndef HK_ANDERSON_H
#define HK_ANDERSON_H

#include "core/plugin.h"

enum { HK_ANDERSON_MOST = 16 };

/* Zeroed before the first use. */
typedef struct hk_anderson {
  size_t length, window;                           /* numbers in x; differences kept at most */
  size_t count, next;                              /* differences kept; the place of the next */
  bool primed;                                     /* f_last and g_last are there */
  double *f_last, *g_last, *r_last;                /* length each: of the last step */
  double *memory;                                  /* 3 x (window + 2) x length: these three and the differences */
  double gram[HK_ANDERSON_MOST][HK_ANDERSON_MOST]; /* products of the kept differences of f and r */
} hk_anderson;

hk_status hk_anderson_reserve(hk_anderson *, const hk_host *host, size_t length, size_t window);
void hk_anderson_release(hk_anderson *, const hk_host *host);
void hk_anderson_clear(hk_anderson *); /* forgets: x was moved by other means */
/* From g = G(x), f = g - x and r = A f, A symmetric and positive definite, the next x: what the kept steps make of
 * them. x may be g's place. */
void hk_anderson_next(hk_anderson *, const double *f, const double *g, const double *r, double *x);

#endif
