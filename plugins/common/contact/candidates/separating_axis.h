/* Separating axes of two sets of points that move on straight lines, from the positions at both ends of the move, which
 * stand side by side in one vector.
 *
 * Along a fixed axis, the least coordinate of one set is concave in time and the largest of the other convex, so the
 * gap between them is least at an end of the move: sets that an axis keeps apart at both ends are apart in between. */
#ifndef HK_SEPARATING_AXIS_H
#define HK_SEPARATING_AXIS_H

#include "plugins/common/space/bvh.h"

typedef double hk_two __attribute__((vector_size(16)));
typedef int64_t hk_two_mask __attribute__((vector_size(16)));

typedef struct hk_swept_point {
  hk_two x[3]; /* m, from the origin of the search: at the start, at the end */
} hk_swept_point;

static inline hk_two hk_two_least(hk_two a, hk_two b) {
#if defined(__SSE2__)
  return __builtin_ia32_minpd(a, b);
#else
  hk_two_mask first = a < b;
  return (hk_two)((first & (hk_two_mask)a) | (~first & (hk_two_mask)b));
#endif
}

static inline hk_two hk_two_most(hk_two a, hk_two b) { return -hk_two_least(-a, -b); }

static inline double hk_lesser(hk_two a) { return a[0] < a[1] ? a[0] : a[1]; }

/* One to four points, by their coordinates along an axis. */
typedef struct hk_two_range {
  hk_two low, high;
} hk_two_range;

typedef struct hk_swept_set {
  int count;
  const hk_swept_point *point[4];
} hk_swept_set;

static inline hk_swept_set hk_swept(const hk_swept_point *all, const uint32_t *v, int count) {
  hk_swept_set set = {.count = count};
  for (int k = 0; k < count; k++) set.point[k] = &all[v[k]];
  return set;
}

/* Along x, y or z. */
static inline hk_two_range hk_range_of(const hk_swept_set *a, int c) {
  hk_two_range r = {a->point[0]->x[c], a->point[0]->x[c]};
  for (int k = 1; k < a->count; k++) {
    r.low = hk_two_least(r.low, a->point[k]->x[c]);
    r.high = hk_two_most(r.high, a->point[k]->x[c]);
  }
  return r;
}

static inline hk_two_range hk_range_along(const hk_swept_set *a, const double axis[3]) {
  hk_two at[4] = {{0}};
  for (int k = 0; k < a->count; k++)
    at[k] = a->point[k]->x[0] * axis[0] + a->point[k]->x[1] * axis[1] + a->point[k]->x[2] * axis[2];
  hk_two_range r = {at[0], at[0]};
  for (int k = 1; k < a->count; k++) r.low = hk_two_least(r.low, at[k]), r.high = hk_two_most(r.high, at[k]);
  return r;
}

/* The least gap between two ranges at both ends of the move; below 0: they overlap, or change sides. */
static inline double hk_range_gap(hk_two_range a, hk_two_range b) {
  double after = hk_lesser(b.low - a.high), before = hk_lesser(a.low - b.high);
  return after > before ? after : before;
}

static inline bool hk_apart_by_boxes(const hk_swept_set *a, const hk_swept_set *b, double distance) {
  for (int c = 0; c < 3; c++)
    if (hk_range_gap(hk_range_of(a, c), hk_range_of(b, c)) > distance) return true;
  return false;
}

/* Whether an axis of any length keeps two sets farther apart than a distance, m, throughout the move. */
static inline bool hk_apart_along(const double axis[3], const hk_swept_set *a, const hk_swept_set *b, double distance) {
  double gap = hk_range_gap(hk_range_along(a, axis), hk_range_along(b, axis));
  return gap > 0 && gap * gap > distance * distance * (axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
}

static inline void hk_axis_of_middles(const hk_swept_set *a, const hk_swept_set *b, double axis[3]) {
  for (int c = 0; c < 3; c++) {
    double sa = 0, sb = 0;
    for (int k = 0; k < a->count; k++) sa += a->point[k]->x[c][0];
    for (int k = 0; k < b->count; k++) sb += b->point[k]->x[c][0];
    axis[c] = sb * a->count - sa * b->count;
  }
}

/* The axis between the middles of the two sets at the start. */
static inline bool hk_apart_by_middles(const hk_swept_set *a, const hk_swept_set *b, double distance) {
  double axis[3];
  hk_axis_of_middles(a, b, axis);
  return hk_apart_along(axis, a, b, distance);
}

/* p q x r s at the start. */
static inline void hk_normal_of(const hk_swept_point *p, const hk_swept_point *q, const hk_swept_point *r,
                                const hk_swept_point *s, double n[3]) {
  double d[3], e[3];
  for (int c = 0; c < 3; c++) d[c] = q->x[c][0] - p->x[c][0], e[c] = s->x[c][0] - r->x[c][0];
  n[0] = d[1] * e[2] - d[2] * e[1];
  n[1] = d[2] * e[0] - d[0] * e[2];
  n[2] = d[0] * e[1] - d[1] * e[0];
}

/* The axis p q x r s. */
static inline bool hk_apart_by_normal(const hk_swept_point *p, const hk_swept_point *q, const hk_swept_point *r,
                                      const hk_swept_point *s, const hk_swept_set *a, const hk_swept_set *b,
                                      double distance) {
  double axis[3];
  hk_normal_of(p, q, r, s, axis);
  return hk_apart_along(axis, a, b, distance);
}

static inline bool hk_apart_by_face(const hk_swept_set *face, const hk_swept_set *a, const hk_swept_set *b,
                                    double distance) {
  return hk_apart_by_normal(face->point[0], face->point[1], face->point[0], face->point[2], a, b, distance);
}

#endif
