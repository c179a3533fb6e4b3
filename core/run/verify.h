/* The cheapest honest error bar, for any scene: the run again, with less than half the step (n steps of a frame become
 * 2n + 1, so that what is in step with the first run is not with the second; an adaptive method: a tenth of the
 * tolerance and at most half its longest step), from start positions disturbed by 1e-10 of the scene's extent. The
 * first shows what the step costs: a method of order 1 is off by twice the difference, one of a higher order by less,
 * and twice the difference is held against the accuracy. The second shows a motion that nobody can know, such as a
 * strut that is balanced on its buckling load. */
#ifndef HK_VERIFY_H
#define HK_VERIFY_H

#include "core/lua/script.h"

/* Fills `verify_difference` of the summary of `whole`, a run of the script at `path` that went to its end; where an
 * accuracy is asked for and twice the difference is above it, the verdict becomes `inaccurate` and the reason says so.
 * It also does when the second run fails: then the difference is NAN, and `error` has the cause. `options` and `run`
 * are those of the first run. */
hk_status hk_verify(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                    hk_summary *summary, hk_error *error);

#endif
