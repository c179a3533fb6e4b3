/* Birth times of a source. At a constant rate birth k is at from + k/rate exactly. A variable rate is a function of the
 * script, evaluated at the ends of equal time cells and linear between them: its integral, the number of births, is
 * exact and independent of the run's steps. Birth k is at the last time at which the integral does not exceed k. Bursts
 * come beside them, each with births at one time. */
#ifndef HK_FLOW_H
#define HK_FLOW_H

#include "core/plugin.h"

typedef struct hk_flow {
  double rate, from, to;      /* 1/s, s, s; to NAN: no end */
  const hk_function *of_time; /* t -> 1/s, in the place of the rate; NULL: there is none */
  double cell;                /* s */
  int64_t burst;              /* births at each time of a burst */
  hk_numbers burst_at;        /* s, increasing */
  /* evolving data of a function: whether it was evaluated; completed cells; births by their end; the rates at both ends
   * of the present cell, 1/s */
  int64_t asked, cells;
  double before, begin, end;
  int64_t bursts; /* births of bursts that were; evolving */
} hk_flow;

/* HK_BAD_PARAM, with a message: an end before the start, bursts without times or numbers, or out of order. */
hk_status hk_flow_check(const hk_flow *, const hk_host *);

/* *at: the time of birth k, s; INFINITY: it is later than t. Birth k - 1 was asked for before. */
hk_status hk_flow_next(hk_flow *, const hk_host *, int64_t k, double t, double *at);
/* The time of the next birth of a burst, s; INFINITY: there is none. */
double hk_flow_next_burst(const hk_flow *);
/* *count: an upper bound of the births from k to time t, with those of bursts. */
hk_status hk_flow_births(const hk_flow *, const hk_host *, int64_t k, double t, double *count);

#endif
