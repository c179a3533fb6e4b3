/* The loops of rods for vectors of four doubles and more, and the choice. */
#include "core/plugin/widest.h"

#if defined(__x86_64__)
#define TARGET HK_TARGET_4
#define ROD_PATH hk_rod_wide
#include "plugins/common/rods/rod_loops.h"

hk_rod_path hk_rod_path_of(int lanes) { return lanes >= 4 ? hk_rod_wide : hk_rod_narrow; }
#else
#include "plugins/common/rods/rod_path.h"

hk_rod_path hk_rod_path_of(int lanes) {
  (void)lanes;
  return hk_rod_narrow;
}
#endif
