/* "inflows/1": the openings in walls through which liquid comes. A source bears its particles; the liquid of the scene
 * has its velocity at the wall. */
#ifndef HK_EMISSION_INFLOWS_H
#define HK_EMISSION_INFLOWS_H

#include "core/plugin.h"

#define HK_INFLOWS_INTERFACE "inflows/1"

/* A rectangle across an axis, through which liquid comes from `from` to `to`. */
typedef struct hk_inflow {
  double low[3], high[3]; /* m, its corners: the same along `axis` */
  int axis;
  double speed;    /* m/s, along the axis; negative: against it */
  double density;  /* kg/m^3, of what comes */
  double from, to; /* s; to INFINITY: it never ends */
} hk_inflow;

enum { HK_INFLOWS = 64 };

typedef struct hk_inflows {
  void *self;
  /* Called in `create`. The inflow stays the caller's and valid as long as the run. HK_BAD_PARAM: there are too many.
   */
  hk_status (*enter)(void *self, const hk_inflow *);
  size_t count;
  const hk_inflow *member[HK_INFLOWS];
  /* Called in `create` by a liquid, whose walls they are in. */
  void (*take)(void *self);
  bool taken;
} hk_inflows;

#endif
