/* Whether a squared distance is outside of the limits: all are looked at, without a branch. */
#include "plugins/common/strain/run_screen.h"

HK_INLINE bool any_outside(const hk_run_ends *c, size_t count, double low, double high) {
  long found = 0; /* as wide as a number */
  for (size_t k = 0; k < count; k++) {
    double dx = c->x[1][k] - c->x[0][k], dy = c->y[1][k] - c->y[0][k], dz = c->z[1][k] - c->z[0][k];
    double l2 = dx * dx + dy * dy + dz * dz;
    found |= (l2 > high) | (l2 < low);
  }
  return found;
}

HK_VERSIONS(static bool, screen, (const hk_run_ends *c, size_t count, double low, double high),
            return any_outside(c, count, low, high))

bool hk_run_screen(int lanes, const hk_run_ends *c, size_t count, double low, double high) {
  return HK_WIDEST(lanes, screen)(c, count, low, high);
}
