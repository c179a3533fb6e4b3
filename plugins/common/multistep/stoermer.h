/* Stoermer's explicit multistep methods for x'' = a(x, v, t), as integrators. */
#ifndef HK_STOERMER_H
#define HK_STOERMER_H

#include "plugins/common/integrate/runge_kutta.h"

enum { HK_STOERMER_TERMS = 8, HK_STOERMER_START = HK_RK_STAGES }; /* at most; no fewer than extrapolation takes */

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
  double *slope;               /* HK_FIELD_STATE of width `terms`: a ring buffer of (a, dy) */
  double *change;              /* n x 3, m/s: (x - x before) / h */
  double *start;               /* HK_FIELD_STATE of width HK_STOERMER_START, scratch */
  hk_stoermer_weights weights; /* follow from h; no field */
} hk_stoermer;

/* The fields of an instance that begins with hk_stoermer. */
#define HK_STOERMER_FIELDS(terms)                                                                                      \
  {"known", HK_FIELD_INTEGER, 1, offsetof(hk_stoermer, known), 0},                                                     \
      {"head", HK_FIELD_INTEGER, 1, offsetof(hk_stoermer, head), 0},                                                   \
      {"h", HK_FIELD_NUMBER, 1, offsetof(hk_stoermer, h), 0},                                                          \
      {"slopes", HK_FIELD_STATE, terms, offsetof(hk_stoermer, slope), 0},                                              \
      {"start", HK_FIELD_STATE, HK_STOERMER_START, offsetof(hk_stoermer, start), HK_SCRATCH}, {                        \
    0                                                                                                                  \
  }

double hk_stoermer_amplification(const hk_stoermer_method *, double hw, double hg);
double hk_stoermer_rotation(const hk_stoermer_method *, double hw, double hg, double hb);
hk_status hk_stoermer_step(hk_stoermer *, const hk_stoermer_method *, hk_system *s, double h);
hk_status hk_stoermer_march(hk_stoermer *, const hk_stoermer_method *, hk_system *s, const double *t, double h,
                            size_t *count); /* hk_integrator.march */
void hk_stoermer_reset(void *self, hk_reason why);

/* The table `integrator` and the table `fields` of a method of `terms` terms, which is defined
 * before as `method`, with its order as the constant ORDER. */
#define HK_STOERMER_INTEGRATOR(terms)                                                                                  \
  static const hk_field fields[] = {HK_STOERMER_FIELDS(terms)};                                                        \
  static double amplification(const void *self, double hw, double hg) {                                                \
    (void)self;                                                                                                        \
    return hk_stoermer_amplification(&method, hw, hg);                                                                 \
  }                                                                                                                    \
  static double rotation(const void *self, double hw, double hg, double hb) {                                          \
    (void)self;                                                                                                        \
    return hk_stoermer_rotation(&method, hw, hg, hb);                                                                  \
  }                                                                                                                    \
  static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {                             \
    (void)t_stop, (void)out;                                                                                           \
    return hk_stoermer_step(self, &method, s, h);                                                                      \
  }                                                                                                                    \
  static hk_status march(void *self, hk_system *s, const double *t, double h, size_t *count) {                         \
    return hk_stoermer_march(self, &method, s, t, h, count);                                                           \
  }                                                                                                                    \
  static const hk_integrator integrator = {.size = sizeof(hk_integrator),                                              \
                                           .order = ORDER,                                                             \
                                           .stages = 1,                                                                \
                                           .flags = HK_USES_SPARE,                                                     \
                                           .amplification = amplification,                                             \
                                           .rotation = rotation,                                                       \
                                           .step = step,                                                               \
                                           .reset = hk_stoermer_reset,                                                 \
                                           .march = march}

#endif
