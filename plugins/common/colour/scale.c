#include "plugins/common/colour/scale.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double hk_scale_place(const hk_scale *s, double value) {
  if (!isfinite(value)) return NAN;
  if (!s->log) return s->high > s->low ? (value - s->low) / (s->high - s->low) : 0.5;
  return value > 0 ? log(value / s->low) / log(s->high / s->low) : 0;
}

void hk_scale_saturates(const hk_scale *s, double least, double most, int colours, bool out[2]) {
  double step = 1.0 / colours;
  out[0] = least <= most && (hk_scale_place(s, least) < -step || (s->log && least <= 0));
  out[1] = least <= most && hk_scale_place(s, most) > 1 + step;
}

/* The shortest text, of three digits or more, whose number is off by less than can be seen on the bar; below a million
 * without a power of ten. */
static void write_number(const hk_scale *s, double value, char text[24]) {
  double range = s->high - s->low, error = 0.006 * range;
  if (s->log) error = 0.006 * fabs(value) * fmin(log(s->high / s->low), 1);
  if (!s->log && fabs(value) < 1e-9 * range) value = 0;
  int whole = fabs(value) >= 1 && fabs(value) < 1e6 ? (int)floor(log10(fabs(value))) + 1 : 0;
  for (int digits = whole > 3 ? whole : 3; digits <= 15; digits++) {
    snprintf(text, 24, "%.*g", digits, value);
    if (fabs(strtod(text, NULL) - value) <= error) return;
  }
}

/* Its first and last letter's places on the bar, in letters. */
static void extent(const hk_tick *t, double length, double out[2]) {
  double width = (double)strlen(t->text);
  out[0] = t->place * length - t->align * width;
  out[1] = out[0] + width;
}

static bool fits(const hk_tick *tick, size_t count, const hk_tick *another, double length) {
  double a[2], b[2];
  extent(another, length, a);
  for (size_t k = 0; k < count; k++) {
    extent(tick + k, length, b);
    if (a[0] < b[1] + 1 && b[0] < a[1] + 1) return false;
  }
  return count < HK_TICKS;
}

static size_t add(const hk_scale *s, double value, double align, double length, hk_tick *tick, size_t count) {
  hk_tick t = {.place = hk_scale_place(s, value), .align = align};
  write_number(s, value, t.text);
  if (align == 0.5 && !fits(tick, count, &t, length)) return count;
  tick[count] = t;
  return count + 1;
}

size_t hk_scale_ticks(const hk_scale *s, double length, hk_tick tick[HK_TICKS]) {
  size_t count = add(s, s->low, 0, length, tick, 0);
  count = add(s, s->high, 1, length, tick, count);
  if (!s->log) return add(s, s->low + (s->high - s->low) * 1 / 2, 0.5, length, tick, count);
  for (double decade = ceil(log10(s->low)); pow(10, decade) < s->high; decade++)
    count = add(s, pow(10, decade), 0.5, length, tick, count);
  return count;
}

double hk_scale_least(const hk_scale *s) {
  hk_tick tick[HK_TICKS];
  hk_scale_ticks(s, 0, tick);
  return (double)(strlen(tick[0].text) + strlen(tick[1].text) + 1);
}
