/* The loops of the tree in single precision for every width of vectors. */
#include "plugins/common/gravity/tree/single_path.h"

#include "core/plugin/vector_math.h"

enum { SPAN = 64 /* sources that are summed in single precision */ };

#define LOAD(p) (*(const VECTOR *)(p))
#define SUMS NAME(lane_sums)

#define HK_REAL float
#define HK_LOOPS "plugins/common/gravity/tree/single_loops.h"
#include "core/plugin/each_width.h"

const hk_single_path *hk_single_path_of(int lanes) {
  const hk_single_path *path = HK_WIDEST(lanes, path);
  return path->pull ? path : NULL;
}
