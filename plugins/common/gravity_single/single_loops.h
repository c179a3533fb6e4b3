/* The loops of single_path.h. A file that includes this one defines before: INLINE and TARGET, attributes with its
 * instruction set; LANES and vector (floats); SPREAD(a), a in all lanes; FMA(a, b, c) = a b + c; LESSER(a, b), the
 * lesser of each lane; and over_cube(m, s2) = m/s^3. All functions with vectors are inlined into functions for the same
 * instructions. */
#include "plugins/common/gravity_single/single_path.h"

enum {
  TOGETHER = 2, /* vectors at a time: each hides the latency of the other */
  SPAN = 64     /* sources that are summed in floats */
};

#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))

typedef struct place {
  vector x, y, z;
} place;

/* One vector of targets and its sums. */
typedef struct lane_sums {
  place high, low, a;
  vector nearest;
} lane_sums;

INLINE lane_sums no_sums(const hk_single_targets *t, const hk_single_pull *sum, size_t l) {
  return (lane_sums){.high = {LOAD(t->high[0] + l), LOAD(t->high[1] + l), LOAD(t->high[2] + l)},
                     .low = {LOAD(t->low[0] + l), LOAD(t->low[1] + l), LOAD(t->low[2] + l)},
                     .nearest = LOAD(sum->nearest + l)};
}

INLINE void pull_one(lane_sums *t, const hk_single_body *s, vector soft) {
  vector x = (SPREAD(s->high[0]) - t->high.x) + (SPREAD(s->low[0]) - t->low.x);
  vector y = (SPREAD(s->high[1]) - t->high.y) + (SPREAD(s->low[1]) - t->low.y);
  vector z = (SPREAD(s->high[2]) - t->high.z) + (SPREAD(s->low[2]) - t->low.z);
  vector s2 = FMA(x, x, FMA(y, y, FMA(z, z, soft)));
  vector f = over_cube(SPREAD(s->m), s2);
  t->nearest = LESSER(s2, t->nearest);
  t->a = (place){FMA(f, x, t->a.x), FMA(f, y, t->a.y), FMA(f, z, t->a.z)};
}

INLINE void add_span(double *sum, const vector *a) {
  const float *from = (const float *)a;
  for (size_t l = 0; l < LANES; l++) sum[l] += (double)from[l];
}

INLINE void add_sums(hk_single_pull *sum, const lane_sums *t, size_t l) {
  add_span(sum->a[0] + l, &t->a.x);
  add_span(sum->a[1] + l, &t->a.y);
  add_span(sum->a[2] + l, &t->a.z);
  STORE(sum->nearest + l, t->nearest);
}

TARGET static void pull(const hk_single_body *s, size_t begin, size_t end, const hk_single_targets *t, float eps2,
                        hk_single_pull *sum) {
  const vector soft = SPREAD(eps2);
  for (size_t at = 0; at < HK_SINGLE_BLOCK; at += TOGETHER * LANES)
    for (size_t j = begin; j < end;) {
      lane_sums one = no_sums(t, sum, at), two = no_sums(t, sum, at + LANES);
      for (size_t until = end - j < SPAN ? end : j + SPAN; j < until; j++) {
        pull_one(&one, s + j, soft);
        pull_one(&two, s + j, soft);
      }
      add_sums(sum, &one, at);
      add_sums(sum, &two, at + LANES);
    }
}
