/* Where a function of time varies between the times at which it was evaluated. Within a window as long as the distance
 * of two evaluations, a function that they follow goes up or down; one that goes up and down again has a total
 * variation above its net change. This excess is compared with the net changes in the windows beside it: at a maximum
 * of a motion that is followed it is the smaller one by far (a quarter, at ten evaluations a period), in a pulse or a
 * vibration the larger one. A single jump in a window does not count, whatever slope it interrupts. A window is laid at
 * every sample, so that whatever is shorter than it is within one, wherever it begins, and a vibration in phase with
 * the evaluations is found. */
#include "core/numerics/functions/functions.h"

#include <string.h>

enum { FEWEST = 8 };                /* samples in a window: what is sampled more coarsely has no excess to speak of */
static const double follows = 0.75, /* excess by net changes: 2.4 evaluations of a period of a sine */
    visible = 1e-3,                 /* of the range, as in samples.c */
    edge = 0.05, quarter = 0.25;    /* of the range in the window */

typedef struct window {
  size_t before, first, last, next; /* samples: it goes from first to last, those beside it from before and to next */
  double excess, net;               /* net: of the windows beside it */
} window;

typedef struct scan {
  const hk_samples *list;
  int column;
  hk_gap *distance;
  const void *context;
  hk_rapid *found;
} scan;

static double value(const scan *s, size_t k) { return s->list->item[k].value[s->column]; }

/* 0 where one is not finite. */
static double change(const scan *s, size_t from, size_t to) {
  double found = fabs(value(s, to) - value(s, from));
  return found < INFINITY ? found : 0;
}

/* The net change from one sample to another for a whole window, which may reach beyond the samples. */
static double net_change(const scan *s, size_t from, size_t to, double length) {
  double covered = s->list->item[to].t - s->list->item[from].t;
  return covered > 0 ? change(s, from, to) * length / covered : 0;
}

/* The last sample that is at most `length` after `first`, from `now` on, whichever way that is. */
static size_t reach(const hk_samples *list, size_t first, double length, size_t now) {
  double end = list->item[first].t + length;
  while (now + 1 < list->count && list->item[now + 1].t <= end) now++;
  while (now > first && list->item[now].t > end) now--;
  return now;
}

/* What the function does between the samples of a window. */
typedef struct path {
  double variation, jumped; /* the sums of changes' magnitudes, and of jumps */
  size_t jumps;
} path;

/* `times` 1 or -1: from one sample to another, added or taken away. */
static void add_changes(const scan *s, path *p, size_t from, size_t to, int times) {
  const hk_sample *item = s->list->item;
  for (size_t k = from; k < to; k++) {
    double here = change(s, k, k + 1);
    bool jumps = item[k + 1].t - item[k].t <= s->list->narrowest && here > visible * s->list->range[s->column];
    p->variation += times * here;
    if (!jumps) continue;
    p->jumped += times * (value(s, k + 1) - value(s, k));
    p->jumps += (size_t)times;
  }
}

static double excess_of(const scan *s, const path *p, size_t first, size_t last) {
  if (p->jumps != 1) return p->variation - change(s, first, last);
  return p->variation - fabs(p->jumped) - fabs(value(s, last) - value(s, first) - p->jumped);
}

/* Lays the window at a sample. */
static void lay(const scan *s, window *w, size_t first, path *p) {
  const hk_samples *list = s->list;
  double length = s->distance(s->context, list->item[first].t);
  size_t last = reach(list, first, length, w->last > first ? w->last : first);
  add_changes(s, p, w->last, last, 1);
  add_changes(s, p, last, w->last, -1);
  add_changes(s, p, w->first, first, -1);
  w->first = first;
  w->last = last;
  w->next = reach(list, last, length, w->next > last ? w->next : last);
  while (list->item[w->before].t < list->item[first].t - length) w->before++;
  w->excess = excess_of(s, p, first, last);
  w->net = net_change(s, w->before, first, length) + net_change(s, last, w->next, length);
}

static bool varies_in(const scan *s, const window *w) {
  return w->last - w->first >= FEWEST && w->excess > follows * w->net &&
         w->excess > visible * s->list->range[s->column];
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
  found->varies = true;
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

/* Extends the piece to the samples before the first and after the last that differ from what the window begins and ends
 * with. */
static void take(const scan *s, const window *w, double piece[2]) {
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
  s->found->shortest = fmin(s->found->shortest, fmin(least, item[end].t - item[begin].t));
  piece[0] = fmin(piece[0], item[begin].t);
  piece[1] = fmax(piece[1], item[end].t);
}

/* Of windows that follow each other and in which it varies, those with the largest excess are looked at, one in each
 * length of a window: a pulse is within it as a whole. */
static void slide(const scan *s) {
  window w = {.first = 0}, best = {.excess = 0};
  path inside = {0};
  double piece[2] = {INFINITY, -INFINITY};
  for (size_t first = 0; first < s->list->count; first++) {
    lay(s, &w, first, &inside);
    bool varies = varies_in(s, &w);
    if (best.excess > 0 && (!varies || first > best.last)) {
      take(s, &best, piece);
      best.excess = 0;
    }
    if (!varies && piece[1] > piece[0]) {
      add_piece(s->found, piece[0], piece[1]);
      piece[0] = INFINITY, piece[1] = -INFINITY;
    }
    if (varies && w.excess > best.excess) best = w;
  }
}

void hk_rapid_find(hk_rapid *found, const hk_samples *list, hk_gap *distance, const void *context) {
  found->shortest = INFINITY;
  for (int c = 0; c < HK_COLUMNS; c++) {
    scan s = {list, c, distance, context, found};
    if (!(list->range[c] > 0)) continue;
    slide(&s);
  }
}
