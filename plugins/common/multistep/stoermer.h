/* Stoermer's explicit multistep methods for x'' = a(x, v, t), as integrators. */
#ifndef HK_STOERMER_H
#define HK_STOERMER_H

#include "plugins/common/integrate/runge_kutta.h"

enum { HK_STOERMER_TERMS = 8, HK_STOERMER_START = 7 }; /* at most; no fewer than extrapolation takes */

/* Coefficients of the backward differences of a; for order p the first p are those of the series, given here. Above
 * order 5 the first steps are extrapolated ones of order 8. */
typedef struct hk_stoermer_method {
  int order, terms;
  double sigma[HK_STOERMER_TERMS]; /* for x; 1, 0, 1/12, 1/12, 19/240, 3/40, 863/12096, 275/4032 */
  double gamma[HK_STOERMER_TERMS]; /* for v and channels; 1, 1/2, 5/12, 3/8, 251/720, 95/288, ... */
} hk_stoermer_method;

/* Of the slopes, newest first, for a step of h; of terms that the method does not use: 0. */
typedef struct hk_stoermer_weights {
  double h, change[HK_STOERMER_TERMS], lead[HK_STOERMER_TERMS], rate[HK_STOERMER_TERMS];
} hk_stoermer_weights;

typedef struct hk_stoermer {
  int64_t known;               /* number of valid slopes of earlier steps, at most terms - 1 */
  int64_t head;                /* position of the next slope */
  double h;                    /* s, length of the steps in the history */
  double *slope;               /* a field `state` of width `terms`: a ring buffer of (a, dy) */
  double *start;               /* a field `state` of width HK_STOERMER_START, scratch */
  hk_stoermer_weights weights; /* follow from h; no field */
} hk_stoermer;

/* The fields of an instance of hk_stoermer. */
/* clang-format off */
#define HK_STOERMER_FIELDS(terms)                                                                                      \
  {{"known", .integer = HK_AT(hk_stoermer, known)},                                                                    \
   {"head", .integer = HK_AT(hk_stoermer, head)},                                                                      \
   {"h", .number = HK_AT(hk_stoermer, h)},                                                                             \
   {"slopes", .state = HK_AT(hk_stoermer, slope), .width = terms},                                                     \
   {"start", .state = HK_AT(hk_stoermer, start), .width = HK_STOERMER_START, .flags = HK_SCRATCH},                     \
   {0}}
/* clang-format on */

/* Members of an hk_integrator whose instance is an hk_stoermer and whose `method` an hk_stoermer_method. */
hk_status hk_stoermer_step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out);
void hk_stoermer_reset(void *self, hk_reason why);
double hk_stoermer_growth(const void *self, const void *method, double hw, double hg, double hb);
extern const hk_facet hk_stoermer_facets[]; /* it takes tiles */

#endif
