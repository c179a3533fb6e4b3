/* When births are due. At a constant rate birth k is at from + k/rate exactly. A rate that changes is a function of the
 * script; it is asked for at the ends of equal cells of time, and is straight between, so that its integral, the number
 * of births by a time, is exact, and none of it depends on the steps of the run. Birth k is then at the last time at
 * which the integral is not above k. */
#ifndef HK_FLOW_H
#define HK_FLOW_H

#include "core/plugin.h"

typedef struct hk_flow {
  double rate, from, to;      /* 1/s, s, s; to NAN: no end */
  const hk_function *of_time; /* t -> 1/s, in the place of the rate; NULL: there is none */
  double cell;                /* s */
  /* evolving, of a function: whether it was asked, cells that are over, births by then, rates at the ends of the
   * present one */
  int64_t asked, cells;
  double before, begin, end;
} hk_flow;

/* *at: s, the time of birth k, of which the one before was asked for last; INFINITY: it is not by t. */
hk_status hk_flow_next(hk_flow *, const hk_host *, int64_t k, double t, double *at);
/* *count: births by t behind the first k, or some more. */
hk_status hk_flow_due(const hk_flow *, const hk_host *, int64_t k, double t, double *count);

#endif
