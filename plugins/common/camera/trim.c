#include "plugins/common/camera/trim.h"

#include <stdlib.h>

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* Sorts the points' components along a direction. */
static void sort_along(const hk_point_sample *s, const double direction[3], float *scratch) {
  for (size_t k = 0; k < s->count; k++) {
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += direction[c] * (double)s->x[k][c];
    scratch[k] = (float)sum;
  }
  qsort(scratch, s->count, sizeof *scratch, by_size);
}

static double diagonal(const double low[3], const double high[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += (high[c] - low[c]) * (high[c] - low[c]);
  return sqrt(sum);
}

bool hk_trim_box(const hk_point_sample *s, double share, float *scratch, double low[3], double high[3]) {
  double inner_low[3], inner_high[3];
  size_t out = (size_t)(share * (double)s->count);
  if (!out) return false;
  for (int c = 0; c < 3; c++) {
    sort_along(s, (double[]){c == 0, c == 1, c == 2}, scratch);
    inner_low[c] = (double)scratch[out], inner_high[c] = (double)scratch[s->count - 1 - out];
  }
  if (diagonal(inner_low, inner_high) > 0.8 * diagonal(low, high)) return false;
  for (int c = 0; c < 3; c++) low[c] = inner_low[c], high[c] = inner_high[c];
  return true;
}

void hk_trim_fit(const hk_point_sample *s, double share, double radius, float *scratch, hk_fit *fit) {
  size_t out = (size_t)(share * (double)s->count);
  if (!s->count) return;
  for (int k = 0; k < 4; k++) {
    sort_along(s, fit->normal[k], scratch);
    fit->least[k] = fmin(fit->least[k], (double)scratch[out] - radius);
  }
  sort_along(s, fit->axis[2], scratch);
  fit->front = fmax(fit->front, (double)scratch[s->count - 1 - out] + radius);
  fit->rear = fmin(fit->rear, (double)scratch[out] - radius);
}
