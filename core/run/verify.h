/* The cheapest honest error bar, for any scene: the run again, with less than half the step (n steps of a frame become
 * 2n + 1, so that what is in step with the first run is not with the second; an adaptive method: a tenth of the
 * tolerance and at most half its longest step), from start positions disturbed by 1e-10 of the scene's extent. The
 * first shows what the step costs: a method of order 1 is off by twice the difference, one of a higher order by less,
 * and twice the difference is held against the accuracy. The second shows a motion that nobody can know, such as a
 * strut that is balanced on its buckling load. */
#ifndef HK_VERIFY_H
#define HK_VERIFY_H

#include "core/run/run.h"

typedef struct hk_reopen { /* how the scene of a run is opened a second time */
  /* HK_OK: `again` is a run of the same scene, opened with these options. */
  hk_status (*open)(void *context, const hk_run_options *, hk_run **again, hk_error *);
  /* Called once after `open`, even a failed one (`again` is NULL then): destroys the run and what it was made of. */
  void (*close)(void *context, hk_run *again);
  void *context;
} hk_reopen;

/* Fills `verify_difference` of the summary of `whole`, a run that went to its end; where an accuracy is asked for and
 * twice the difference is above it, the verdict becomes `inaccurate` and the reason says so. It also does when the
 * second run fails: then the difference is NAN, and `error` has the cause. `run` are the options of the first run. */
hk_status hk_verify(const hk_reopen *, const hk_run_options *run, hk_run *whole, hk_summary *summary, hk_error *error);

#endif
