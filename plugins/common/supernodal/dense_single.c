/* The dense loops for floats and every width of vectors. */
#include "plugins/common/supernodal/dense_path.h"

#include "core/plugin/vector_math.h"

#include <string.h>

#define ROOT_OF sqrtf
#define HK_REAL float
#define HK_LOOPS "plugins/common/supernodal/dense_loops.h"
#include "core/plugin/each_width.h"

const hk_dense_path *hk_dense_single(int lanes) { return HK_WIDEST(lanes, path); }
