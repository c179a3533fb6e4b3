/* Bounds by the caps that touching spheres shade. Spheres of radius r that touch one of radius R shade caps of
 * half-angle A, sin A = r/(R + r), which do not overlap. Each has the part w = (1 - cos A)/2 of the sphere: there are
 * at most 1/w. Over a cap the mean of P2(cos theta) is f times that in its middle, f = cos A (1 + cos A)/2; so the sum
 * of cos^2 theta over the middles of caps that cover the part p is largest where they lie around the poles, (p + (1 - p
 * - (1 - p)^3)/f)
 * /(3 w), and of all p at 1 - p = sqrt((1 - f)/3). Equal spheres: 14.9 contacts, which are 12 in truth, and 5.2. */
#include "plugins/common/grains/crowd.h"

#include <math.h>

hk_crowd hk_crowd_of(double R, double r) {
  double sine = r / (R + r), cosine = sqrt(1 - sine * sine), w = (1 - cosine) / 2, f = cosine * (1 + cosine) / 2;
  double bare = sqrt((1 - f) / 3);
  return (hk_crowd){1 / w, (1 - bare + (bare - bare * bare * bare) / f) / (3 * w)};
}
