/* The vectors that every x86-64 and arm64 has, with tiles of 2 vectors x 6 columns, and the choice of the widest path.
 * Products are rounded by themselves: the last digit may differ from that of processors with fused multiply-add. */
#include "plugins/common/supernodal/dense_path.h"

#include <math.h>

#define TARGET
#define INLINE static inline __attribute__((always_inline)) TARGET
#define NAME_OF_PATH "narrow"
#define BYTES 16
#define TALL 2
#define WIDE 6

#define REAL double
#define NAME(x) x##_double
#define ROOT sqrt
#define FMA(a, b, c) ((a) * (b) + (c))
#define FMA1(a, b, c) ((a) * (b) + (c))
#include "plugins/common/supernodal/dense_loops.h"

#define REAL float
#define NAME(x) x##_single
#define ROOT sqrtf
#define FMA(a, b, c) ((a) * (b) + (c))
#define FMA1(a, b, c) ((a) * (b) + (c))
#include "plugins/common/supernodal/dense_loops.h"

const hk_dense_path *hk_dense_narrow(bool single) { return single ? &path_single : &path_double; }

const hk_dense_path *hk_dense_best(bool single) {
  const hk_dense_path *wide8 = hk_dense_wide8(single), *wide4 = hk_dense_wide4(single);
  return wide8 ? wide8 : wide4 ? wide4 : hk_dense_narrow(single);
}
