/* Forces become accelerations. F itself is looked at, so that a force on a fixed particle is included. */
#include "core/parts/divide.h"

enum { EIGHT = 8 };

#define HK_LOOPS "core/parts/divide_loop.h"
#include "core/plugin/each_width.h"

bool hk_part_divide(const double *inverse, double *F, size_t begin, size_t end) {
  size_t single = end - (end - begin) % EIGHT;
  double bad = 0;
  bool finite = HK_WIDEST(divide_eights)(inverse, F, begin, single);
  for (size_t c = 3 * single; c < 3 * end; c++) {
    bad += F[c] * 0;
    F[c] *= inverse[c / 3];
  }
  return finite && bad == 0;
}
