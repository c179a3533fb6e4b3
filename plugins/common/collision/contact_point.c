#include "plugins/common/collision/contact_point.h"

#include <math.h>

void hk_contact_point_of_pair(hk_pair_kind kind, const double x[12], double reach, const hk_contact_points *points) {
  hk_nearest near = hk_nearest_of_pair(kind, x);
  double distance = sqrt(near.squared), middle[3] = {0}, n[3];
  int first = kind == HK_POINT_TRIANGLE ? 1 : 2; /* points of the first feature */
  if (!(distance <= reach) || !(distance > 0)) return;
  for (int c = 0; c < 3; c++) {
    for (int i = 0; i < first; i++) middle[c] += near.w[i] * x[3 * i + c];
    middle[c] -= near.d[c] / 2;
    n[c] = near.d[c] / distance;
  }
  points->add(points->context, middle, n);
}
