/* Progress of a run, printed on standard error. */
#include "core/run/report/report.h"

static const double terminal_every = 0.2, pipe_every = 5; /* s */
static const double judged_after = 0.5 /* s */, long_run = 10 /* s */;

static void say(const hk_progress *p, double seconds, double steps, const char *since) {
  fprintf(stderr, "%shooke: the run will take about %.2g %s: some %.2g steps, %.3g a second %s\n",
          p->mode == 2 ? "\r\033[K" : "",
          seconds < 120    ? seconds
          : seconds < 7200 ? seconds / 60
                           : seconds / 3600,
          seconds < 120    ? "s"
          : seconds < 7200 ? "minutes"
                           : "hours",
          steps, steps / seconds, since);
}

void hk_progress_expect(hk_progress *p, double seconds_per_step, double steps) {
  double whole = seconds_per_step * steps;
  if (!(whole > long_run)) return;
  p->expected = whole;
  say(p, whole, steps, "in a trial");
}

/* A run that will take long says so by its first steps where nothing was said before them, or something else: outputs
 * take part now, and steps may have become shorter. */
static void tell(hk_progress *p, const hk_loop *loop, double now) {
  double wall = now - loop->first_step_at, t = loop->state->t, done = (double)(loop->record->steps - p->steps);
  if (p->told || !(loop->first_step_at > 0) || wall < judged_after || !(t > p->begin)) return;
  p->told = true;
  double whole = wall * (p->end - p->begin) / (t - p->begin);
  bool said = whole < 2 * p->expected && whole > p->expected / 2;
  if (!said && whole > long_run) say(p, whole, done * whole / wall, "so far");
}

void hk_progress_show(hk_progress *p, const hk_loop *loop, const hk_frame *last) {
  double now = hk_clock(), t = loop->state->t;
  if (p->mode > 0) tell(p, loop, now);
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
