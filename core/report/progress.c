/* Progress on standard error: one line that is rewritten on a terminal, a line every few seconds in a pipe. */
#include "core/run/engine.h"

static const double terminal_every = 0.2, pipe_every = 5; /* s */

void hk_progress(hk_run *run, bool last) {
  int mode = run->options.progress;
  if (mode <= 0) return;
  double now = hk_clock(), t = run->system.t;
  if (!last && now - run->progress_at < (mode == 2 ? terminal_every : pipe_every)) return;
  if (last && run->progress_at == run->opened_at) return; /* too short a run to have shown a line */
  run->progress_at = now;
  if (last) {
    if (mode == 2) fputs("\r\033[K", stderr);
    return;
  }
  double wall = now - run->first_step_at, rate = wall > 0 ? (double)run->steps / wall : 0;
  double left = t > 0 ? wall * (run->end - t) / t : NAN;
  fprintf(stderr, "%st = %.3f of %g s, %.3g steps/s, %.0f s left, kinetic %.4g J, total %.4g J%s",
          mode == 2 ? "\r\033[K" : "", t, run->end, rate, left, run->last_frame.kinetic,
          run->last_frame.kinetic + run->last_frame.potential, mode == 2 ? "" : "\n");
  fflush(stderr);
}
