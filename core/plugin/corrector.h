/* Correctors: they repair x and v after a step. */
#ifndef HK_PLUGIN_CORRECTOR_H
#define HK_PLUGIN_CORRECTOR_H

#include "core/plugin/model.h"

enum {                      /* hk_corrector.flags */
       HK_WANTS_BEFORE = 1, /* fill x_before */
       HK_REPORTS_WORK = 2, /* `work` is filled: the energy balance stays known */
       HK_MAY_REJECT = 4    /* `reject` is looked at */
};

typedef struct hk_correction {
  double h;               /* s, length of the step just taken */
  const double *x_before; /* n x 3, positions before the step; NULL without HK_WANTS_BEFORE */
  double *x;              /* n x 3, to repair; pins and constraints are imposed again afterwards */
  double *v;              /* n x 3 */
  bool changed;           /* set when anything was changed: integrators then drop their history */
  double work;            /* J, energy that the correction gave to the scene (negative: took) */
  bool reject;            /* the step is to be taken back and tried with half the length */
} hk_correction;

typedef struct hk_corrector {
  size_t size;
  unsigned flags;
  hk_status (*correct)(void *self, const hk_view *view, hk_correction *c);
  double (*violation)(void *self, const hk_view *view); /* m, 0 when satisfied; NULL */
} hk_corrector;

#endif
