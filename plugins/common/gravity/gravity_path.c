/* The loops of gravitation for every width of vectors. */
#include "plugins/common/gravity/gravity_path.h"

#include "core/plugin/vector_math.h"

enum {
  TOGETHER = 2, /* vectors at a time: each hides the latency of the other */
  SPAN = 64     /* sources that are summed apart: roundings of the sum of n grow with SPAN and n/SPAN, not with n */
};

#define LOAD(p) (*(const VECTOR *)(p))
#define STORE(p, value) (*(VECTOR *)(p) = (value))
#define PLACE NAME(place)
#define SUMS NAME(lane_sums)

#define HK_LOOPS "plugins/common/gravity/gravity_loops.h"
#include "core/plugin/each_width.h"

const hk_gravity_path *hk_gravity_path_of(int lanes) { return HK_WIDEST(lanes, path); }
