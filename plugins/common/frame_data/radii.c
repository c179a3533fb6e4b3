#include "plugins/common/frame_data/radii.h"

#include <math.h>

const hk_drawn_radii hk_drawn = {.tube = {0.006, 0.0022, 0.0012},
                                 .most = {300, 5000},
                                 .on_tubes = 1.9,
                                 .loose = 0.34,
                                 .least = 0.004,
                                 .largest = 0.03,
                                 .pin = 0.0065,
                                 .pin_on_tubes = 1.25};

double hk_drawn_tube(double size, double lines) {
  int k = 0;
  while (k < HK_TUBE_CLASSES - 1 && lines > hk_drawn.most[k]) k++;
  return size * hk_drawn.tube[k];
}

double hk_drawn_loose(double size, double n) {
  return fmin(fmax(hk_drawn.loose / sqrt(n + 1), hk_drawn.least), hk_drawn.largest) * size;
}
