#include "plugins/common/colour/range.h"

#include <math.h>
#include <stdlib.h>

static int by_size(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* Rounds a positive number up to two digits, or down. */
static double round_up(double value) {
  if (!(value > 0)) return value;
  double unit = pow(10, floor(log10(value)) - 1);
  return unit * ceil(value / unit * (1 - 1e-9));
}

static double round_down(double value) {
  double unit = pow(10, floor(log10(value)) - 1);
  return unit * floor(value / unit * (1 + 1e-9));
}

static void choose_linear(hk_scale *s, double low, double high, bool centred) {
  if (centred) {
    high = fmax(round_up(fmax(fabs(low), fabs(high))), 1e-9);
    low = -high;
  } else if (low >= 0 && (low < 0.5 * high || high - low < 1e-3 * high)) {
    low = 0, high = round_up(high);
  }
  if (high <= low) high = low + fmax(fabs(low), 1) * 1e-3;
  s->low = low, s->high = high;
}

static void choose_log(hk_scale *s, double low, double high) {
  s->low = round_down(low), s->high = round_up(high);
  if (s->high <= 1.01 * s->low) s->low /= 10, s->high *= 10;
}

bool hk_range_choose(hk_scale *s, float *number, size_t count, bool centred) {
  s->low = s->log ? 1 : 0, s->high = s->log ? 10 : 1;
  qsort(number, count, sizeof *number, by_size);
  for (; s->log && count && !(number[0] > 0); count--) number++;
  if (!count) return false;
  double low = (double)number[count / 100], high = (double)number[count - 1 - count / 100];
  if (s->log)
    choose_log(s, low, high);
  else
    choose_linear(s, low, high, centred);
  return true;
}
