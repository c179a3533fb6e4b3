/* Samples of a function of time: one at a random time in each of many equal parts of an interval, so that no period is
 * in phase with them, and more where neighbouring values differ by much: there the interval is divided on and on, until
 * the values follow each other closely or a jump is cornered. A pulse that was hit once is measured exactly in that
 * way. The number of calls is bounded; where it does not suffice for all intervals, some, spread evenly, get all they
 * need. */
#include "core/numerics/functions/functions.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

static const double close_by = 0.02, /* of the range: so finely a pulse is measured */
    isolated = 8,                    /* times the changes beside it: a change that is no part of a slope */
    visible = 1e-3,                  /* of the range: smaller pulses are not looked at */
    constant = 1e-12,                /* of the values: their rounding is no range */
    cornered = 1e-12;                /* of the interval: here a jump is not divided any more */
static const double golden = 0.618033988749895;

typedef struct sampler {
  hk_samples *samples;
  const hk_function *function;
  uint64_t random[4];
  size_t most;
} sampler;

/* False: no memory, or enough calls. A time at which the function fails is left out: the run was never there. */
static bool add(sampler *s, double t, hk_sample *made) {
  hk_samples *list = s->samples;
  double out[HK_RESULTS];
  size_t got = 0;
  hk_error ignored = {0};
  if (list->calls >= s->most || hk_array_reserve((void **)&list->item, &list->capacity, list->count + 1, sizeof *made))
    return false;
  list->calls++;
  if (s->function->call(s->function, NULL, &t, 1, out, HK_RESULTS, &got, &ignored) != HK_OK) return false;
  *made = (hk_sample){.t = t};
  for (size_t c = 0; c < HK_COLUMNS && c < got; c++) made->value[c] = out[c];
  list->item[list->count++] = *made;
  return true;
}

static void find_range(hk_samples *list) {
  for (int c = 0; c < HK_COLUMNS; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < list->count; k++) {
      low = fmin(low, list->item[k].value[c]);
      high = fmax(high, list->item[k].value[c]);
    }
    list->range[c] = high - low > constant * fmax(fabs(low), fabs(high)) ? high - low : 0;
  }
}

/* The largest difference of two samples relative to the range. */
static double change(const hk_samples *list, const hk_sample *a, const hk_sample *b) {
  double most = 0;
  for (int c = 0; c < HK_COLUMNS; c++)
    if (list->range[c] > 0) most = fmax(most, fabs(a->value[c] - b->value[c]) / list->range[c]);
  return most;
}

static double change_at(const hk_samples *list, size_t k, size_t count) {
  return k + 1 < count ? change(list, &list->item[k], &list->item[k + 1]) : 0;
}

/* Whether the function may do something else between samples k and k + 1 than go straight on. */
static bool is_rough(const hk_samples *list, size_t k, size_t count) {
  double here = change_at(list, k, count);
  double beside = (k >= 2 ? change_at(list, k - 2, count) : 0) + change_at(list, k + 2, count);
  return here > close_by || (here > visible && here > isolated * beside);
}

static void bisect(sampler *s, hk_sample a, hk_sample b, double enough) {
  hk_sample middle;
  double width = b.t - a.t;
  if (!(width > s->samples->narrowest) || change(s->samples, &a, &b) <= enough) return;
  if (!add(s, a.t + width * (0.4 + 0.2 * hk_random_uniform(s->random)), &middle)) return;
  bisect(s, a, middle, enough);
  bisect(s, middle, b, enough);
}

static int by_time(const void *a, const void *b) {
  double s = ((const hk_sample *)a)->t, t = ((const hk_sample *)b)->t;
  return (s > t) - (s < t);
}

static size_t common_divisor(size_t a, size_t b) { return b ? common_divisor(b, a % b) : a; }

/* Steps through all intervals in an order that is spread evenly: k s mod n with s near n times the golden section. */
static void bisect_rough(sampler *s) {
  hk_samples *list = s->samples;
  size_t count = list->count, stride = 1 + (size_t)((double)count * golden);
  while (common_divisor(count, stride) > 1) stride++;
  for (size_t k = 0, at = 0; k < count && list->calls < s->most; k++, at = (at + stride) % count)
    if (at + 1 < count && is_rough(list, at, count)) {
      double enough = fmin(close_by, change_at(list, at, count) / 4);
      bisect(s, list->item[at], list->item[at + 1], enough);
    }
}

void hk_samples_take(hk_samples *list, const hk_function *f, double begin, double end, size_t parts, size_t most) {
  sampler s = {.samples = list, .function = f, .most = most};
  hk_sample made;
  *list = (hk_samples){.count = 0};
  list->narrowest = fmax(cornered * (end - begin), 8 * DBL_EPSILON * fmax(fabs(begin), fabs(end)));
  hk_random_seed(s.random, 1);
  add(&s, begin, &made);
  for (size_t k = 0; k < parts; k++)
    add(&s, begin + (end - begin) * ((double)k + hk_random_uniform(s.random)) / (double)parts, &made);
  add(&s, end, &made);
  for (size_t k = 1; k < list->count; k++) list->spacing = fmax(list->spacing, list->item[k].t - list->item[k - 1].t);
  find_range(list);
  bisect_rough(&s);
  qsort(list->item, list->count, sizeof *list->item, by_time);
  find_range(list);
}

size_t hk_samples_jumps(const hk_samples *list, double (*jump)[2], size_t room) {
  size_t count = 0;
  for (size_t k = 0; k + 1 < list->count; k++) {
    const hk_sample *before = &list->item[k], *after = before + 1;
    if (after->t - before->t > list->narrowest || change(list, before, after) <= visible) continue;
    if (count < room) jump[count][0] = before->t, jump[count][1] = after->t;
    count++;
  }
  return count;
}

void hk_samples_free(hk_samples *list) { free(list->item); }
