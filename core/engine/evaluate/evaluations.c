/* The times at which a run evaluated its functions of time, as the longest distance between neighbouring ones in each
 * of many equal cells of the run's time. Stages go back and forth within a step, so that times are put in order when
 * the step is accepted; what a rejected step looked at beyond the accepted one is forgotten. The memory does not grow:
 * a run that goes beyond its last cell gets cells twice as long. */
#include "core/engine/evaluate/evaluate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool hk_evaluations_open(hk_evaluations *e, double end) {
  *e = (hk_evaluations){.cell = end > 0 ? end / (HK_CELLS - 1) : 1, .last = NAN};
  e->distance = calloc(HK_CELLS, sizeof *e->distance);
  return e->distance != NULL;
}

void hk_evaluations_close(hk_evaluations *e) { free(e->distance); }

static void make_room(hk_evaluations *e, double t) {
  while (!(t < e->cell * HK_CELLS)) {
    for (size_t k = 0; k < HK_CELLS / 2; k++) e->distance[k] = fmaxf(e->distance[2 * k], e->distance[2 * k + 1]);
    memset(e->distance + HK_CELLS / 2, 0, HK_CELLS / 2 * sizeof *e->distance);
    e->cell *= 2;
  }
}

static void move_to(hk_evaluations *e, double t) {
  float distance = (float)(t - e->last);
  if (!(t > e->last)) return;
  make_room(e, t);
  for (size_t k = (size_t)fmax(0, e->last / e->cell); k <= (size_t)fmax(0, t / e->cell); k++)
    e->distance[k] = fmaxf(e->distance[k], distance);
  e->last = t;
}

static int by_time(const void *a, const void *b) {
  double s = *(const double *)a, t = *(const double *)b;
  return (s > t) - (s < t);
}

void hk_evaluations_note(hk_evaluations *e, double t) {
  if (isnan(e->last)) e->last = t;
  if (e->pending && e->time[e->pending - 1] == t) return;
  if (e->pending == HK_PENDING) { /* a step of very many substeps: its first half is done with */
    qsort(e->time, e->pending, sizeof *e->time, by_time);
    for (size_t k = 0; k < HK_PENDING / 2; k++) move_to(e, e->time[k]);
    memmove(e->time, e->time + HK_PENDING / 2, (HK_PENDING - HK_PENDING / 2) * sizeof *e->time);
    e->pending = HK_PENDING - HK_PENDING / 2;
  }
  e->time[e->pending++] = t;
}

void hk_evaluations_accept(hk_evaluations *e, double t) {
  double slack = 1e-9 * (t - e->last); /* a stage at the end of the step may be rounded to behind it */
  qsort(e->time, e->pending, sizeof *e->time, by_time);
  for (size_t k = 0; k < e->pending && e->time[k] <= t + slack; k++) move_to(e, e->time[k]);
  e->pending = 0;
}

double hk_evaluations_distance(const hk_evaluations *e, double t, double otherwise) {
  double cell = e->distance ? t / e->cell : -1;
  if (!(cell >= 0 && cell < HK_CELLS)) return otherwise;
  double found = e->distance[(size_t)cell];
  return found > 0 ? found : otherwise;
}
