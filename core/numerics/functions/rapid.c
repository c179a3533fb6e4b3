/* Where a function of time varies between the times at which it was evaluated. Within a window as long as the distance
 * of two evaluations, a function that they follow goes up or down; one that goes up and down again has a total
 * variation above its net change. This excess is compared with the net changes in the windows beside it: at a maximum
 * of a motion that is followed it is the smaller one by far (a quarter, at ten evaluations a period), in a pulse or a
 * vibration the larger one. A jump has no excess. The windows do not begin at the evaluations themselves, so that a
 * vibration in phase with them is found. They are laid twice, shifted by half, so that no pulse falls between two. */
#include "core/numerics/functions/functions.h"

#include <string.h>

enum { FEWEST = 8 };                /* samples in a window: what is sampled more coarsely has no excess to speak of */
static const double follows = 0.75, /* excess by net changes: 2.4 evaluations of a period of a sine */
    visible = 1e-3,                 /* of the range, as in samples.c */
    edge = 0.05, quarter = 0.25;    /* of the range in the window */

typedef struct window {
  size_t first, last; /* samples */
  double excess, net; /* net: for the whole length of the window */
  bool dense;
} window;

typedef struct scan {
  const hk_samples *list;
  int column;
  hk_gap *distance;
  const void *context;
  hk_rapid *found;
} scan;

static double value(const scan *s, size_t k) { return s->list->item[k].value[s->column]; }

static window window_at(const scan *s, size_t first, double length) {
  const hk_sample *item = s->list->item;
  window w = {.first = first, .last = first};
  double sum = 0;
  for (; w.last + 1 < s->list->count && item[w.last + 1].t <= item[first].t + length; w.last++)
    sum += fabs(value(s, w.last + 1) - value(s, w.last));
  double net = fabs(value(s, w.last) - value(s, first)), covered = item[w.last].t - item[first].t;
  w.excess = sum - net;
  w.net = covered > 0 ? net * length / covered : 0;
  w.dense = w.last - first >= FEWEST;
  return w;
}

/* The shortest time between two passages from the lowest quarter to the highest or back. */
static double shortest_in(const scan *s, const window *w, double low, double high) {
  double least = INFINITY, since = NAN;
  int state = 0;
  for (size_t k = w->first; k <= w->last; k++) {
    double v = value(s, k), t = s->list->item[k].t;
    int now = v < low + quarter * (high - low) ? -1 : v > high - quarter * (high - low) ? 1 : state;
    if (state && now != state) {
      if (!isnan(since)) least = fmin(least, t - since);
      since = t;
    }
    state = now;
  }
  return least;
}

static void add_piece(hk_rapid *found, double begin, double end) {
  for (size_t k = 0; k < found->pieces; k++) {
    double *piece = found->piece[k];
    if (begin > piece[1] || end < piece[0]) continue;
    piece[0] = fmin(piece[0], begin);
    piece[1] = fmax(piece[1], end);
    return;
  }
  if (found->pieces < HK_PIECES) {
    double *piece = found->piece[found->pieces++];
    piece[0] = begin;
    piece[1] = end;
  } else
    found->more = true;
}

/* Begin and end are the samples before the first and after the last that differ from what the window begins and ends
 * with. */
static void take(const scan *s, const window *w) {
  const hk_sample *item = s->list->item;
  double low = INFINITY, high = -INFINITY;
  for (size_t k = w->first; k <= w->last; k++) {
    low = fmin(low, value(s, k));
    high = fmax(high, value(s, k));
  }
  size_t begin = w->first, end = w->last;
  while (begin + 1 < end && fabs(value(s, begin + 1) - value(s, w->first)) <= edge * (high - low)) begin++;
  while (end > begin + 1 && fabs(value(s, end - 1) - value(s, w->last)) <= edge * (high - low)) end--;
  double least = shortest_in(s, w, low, high);
  s->found->varies = true;
  s->found->shortest = fmin(s->found->shortest, fmin(least, item[end].t - item[begin].t));
  add_piece(s->found, item[begin].t, item[end].t);
}

static void scan_from(const scan *s, size_t first) {
  const hk_samples *list = s->list;
  window before = {.net = 0}, now = {.net = 0};
  while (first + 1 < list->count) {
    double length = s->distance(s->context, list->item[first].t);
    window next = window_at(s, first, length);
    double beside = before.net + next.net;
    if (now.dense && now.excess > follows * beside && now.excess > visible * list->range[s->column]) take(s, &now);
    before = now;
    now = next;
    first = next.last > first ? next.last : first + 1;
  }
  if (now.dense && now.excess > follows * before.net && now.excess > visible * list->range[s->column]) take(s, &now);
}

void hk_rapid_find(hk_rapid *found, const hk_samples *list, hk_gap *distance, const void *context) {
  found->shortest = INFINITY;
  for (int c = 0; c < HK_COLUMNS; c++) {
    scan s = {list, c, distance, context, found};
    if (!(list->range[c] > 0)) continue;
    scan_from(&s, 0);
    size_t half = 0;
    double begin = list->item[0].t, length = distance(context, begin);
    while (half + 1 < list->count && list->item[half].t < begin + length / 2) half++;
    scan_from(&s, half);
  }
}
