/* Whether implicit steps resolve the oscillations of a scene. A mode of frequency w with h w >> 1 is stable under an
 * implicit method. Where the method does not damp it (midpoint rule, trapezoidal rule), it oscillates with a wrong
 * frequency and the right energy, and its coupling to the slow modes is wrong (Ascher and Reich 1999, SIAM J. Sci.
 * Comput. 21:1045). The accelerations at the two ends of a step are then almost unrelated: h^2 (a1 - a0)/12, the local
 * error of the trapezoidal rule, reaches (h w)^2/6 of the amplitude. One step of each frame is sampled, with two
 * evaluations. The median of all samples counts, so that an oscillation that decays early in the run does not decide
 * the verdict. */
#include "core/run/judge/judge.h"

#include <stdlib.h>
#include <string.h>

/* Accelerations and channel rates of the present state, into j->slope[which]. False: not available; an error of the
 * evaluation is dropped, because the run's own evaluations report it. */
static bool slope(hk_loop *loop, hk_judgement *j, size_t which) {
  hk_system *s = &loop->dynamics->system;
  size_t n = s->n, evaluations = loop->dynamics->count.evaluations;
  hk_error kept = *loop->error;
  double *grown = realloc(j->slope[which], s->size * sizeof *grown);
  if (!grown) return false;
  j->slope[which] = grown;
  hk_status status = s->accelerations(s, s->t, s->X, s->X + 3 * n, s->X + 6 * n, grown, grown + 3 * n);
  loop->dynamics->count.evaluations = evaluations;
  *loop->error = kept;
  return status == HK_OK;
}

void hk_under_resolved_before(hk_loop *loop, hk_judgement *j) { j->sampling = slope(loop, j, 0); }

void hk_under_resolved_after(hk_loop *loop, hk_judgement *j, double h) {
  size_t n = loop->state->model.n, moving = 0;
  double sum = 0, *grown = realloc(j->unresolved, (j->samples + 1) * sizeof *grown);
  if (grown) j->unresolved = grown;
  if (!j->sampling || !grown || !slope(loop, j, 1)) return;
  for (size_t i = 0; i < n; i++) {
    moving += loop->state->inverse_mass[i] > 0;
    for (size_t e = 3 * i; e < 3 * i + 3; e++) {
      double change = j->slope[1][e] - j->slope[0][e];
      sum += change * change;
    }
  }
  j->unresolved[j->samples++] = moving ? h * h / 12 * sqrt(sum / (double)moving) : 0;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double hk_under_resolved_error(hk_judgement *j) {
  if (j->samples == 0) return 0;
  qsort(j->unresolved, j->samples, sizeof *j->unresolved, by_size);
  return j->unresolved[j->samples / 2];
}
