/* The loops of rods for vectors of two doubles, two for each of four. */
#define TARGET
#define ROD_PATH hk_rod_narrow
#include "plugins/common/rods/rod_loops.h"
