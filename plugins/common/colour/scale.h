/* Numbers to places on a bar of colours, and the numbers written beside the bar. */
#ifndef HK_SCALE_H
#define HK_SCALE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct hk_scale {
  double low, high; /* low < high; 0 < low where it is logarithmic */
  bool log;
} hk_scale;

/* 0 at low, 1 at high; NAN for a number that is not finite. */
double hk_scale_place(const hk_scale *, double value);

/* Where numbers from `least` to `most` saturate: out[0] below the low end, out[1] above the high one, by more than the
 * colours of a map of `colours` tell apart. On a logarithmic scale what is not positive is below. False for both where
 * least > most: there is no number. */
void hk_scale_saturates(const hk_scale *, double least, double most, int colours, bool out[2]);

enum { HK_TICKS = 16 };

typedef struct hk_tick {
  double place; /* on the bar, 0..1 */
  double align; /* of its text at the place: 0 left end, 0.5 middle, 1 right end */
  char text[24];
} hk_tick;

/* Ticks for a bar that is `length` letters long (at least as long as hk_scale_least says): the two ends and, as far as
 * their texts stay a letter apart, the middle or powers of ten. The texts tell the ticks apart. Returns their number.
 */
size_t hk_scale_ticks(const hk_scale *, double length, hk_tick tick[HK_TICKS]);
/* Letters that the texts of the ends and the gap between them need. */
double hk_scale_least(const hk_scale *);

#endif
