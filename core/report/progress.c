/* Progress of a run, printed on standard error. */
#include "core/report/report.h"

static const double terminal_every = 0.2, pipe_every = 5; /* s */

void hk_progress_show(hk_progress *p, const hk_loop *loop, const hk_frame *last) {
  double now = hk_clock(), t = loop->state->t;
  if (p->mode <= 0 || now - p->at < (p->mode == 2 ? terminal_every : pipe_every)) return;
  double wall = now - loop->first_step_at;
  char pace[64] = "";
  if (t > p->begin && wall > 0)
    snprintf(pace, sizeof pace, " %.3g steps/s, %.0f s left,", (double)(loop->record->steps - p->steps) / wall,
             wall * (p->end - t) / (t - p->begin));
  p->at = now;
  p->shown = true;
  fprintf(stderr, "%st = %.3f of %g s,%s kinetic %.4g J, total %.4g J%s", p->mode == 2 ? "\r\033[K" : "", t, p->end,
          pace, last->kinetic, last->kinetic + last->potential, p->mode == 2 ? "" : "\n");
  fflush(stderr);
}

void hk_progress_end(hk_progress *p) {
  if (p->shown && p->mode == 2) fputs("\r\033[K", stderr);
}
