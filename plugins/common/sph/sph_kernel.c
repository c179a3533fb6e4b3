/* The sums over the lattice that the kernel is measured by. */
#include "plugins/common/sph/sph_kernel.h"

void hk_sph_kernel_prepare(hk_sph_kernel *k, double spacing, double reach, int dimensions) {
  double R = reach * spacing, volume = spacing * spacing * spacing, sum = 0, second = 0, fourth = 0;
  int most = (int)ceil(reach), deep = dimensions == 3 ? most : 0;
  *k = (hk_sph_kernel){.radius = R, .radius2 = R * R, .inverse = 1 / R, .amplitude = 1, .steepness = 1};
  for (int a = -most; a <= most; a++)
    for (int b = -most; b <= most; b++)
      for (int c = -deep; c <= deep; c++) {
        double r2 = (a * a + b * b + c * c) * (spacing * spacing);
        sum += hk_sph_value(k, r2) * volume;
        second += hk_sph_slope(k, r2) * r2 * volume;
        fourth += hk_sph_slope(k, r2) * r2 * r2 * volume;
      }
  k->amplitude = 1 / sum;
  k->steepness = 20 * k->amplitude / (R * R);
  k->second = k->steepness * second / dimensions;
  k->fourth = k->steepness * fourth / (dimensions * (dimensions + 2));
}
