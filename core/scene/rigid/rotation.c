/* Rotations as quaternions and matrices. */
#include "core/scene/rigid/rigid.h"

#include <math.h>

void hk_quaternion_of(const double R[9], double q[4]) {
  double four[4] = {1 + R[0] + R[4] + R[8], 1 + R[0] - R[4] - R[8], 1 - R[0] + R[4] - R[8], 1 - R[0] - R[4] + R[8]};
  int most = 0;
  for (int k = 1; k < 4; k++)
    if (four[k] > four[most]) most = k;
  double p[4][4] = {{four[0], R[7] - R[5], R[2] - R[6], R[3] - R[1]},
                    {R[7] - R[5], four[1], R[1] + R[3], R[2] + R[6]},
                    {R[2] - R[6], R[1] + R[3], four[2], R[5] + R[7]},
                    {R[3] - R[1], R[2] + R[6], R[5] + R[7], four[3]}};
  double scale = 2 * sqrt(four[most]) * (p[most][0] < 0 ? -1 : 1);
  for (int k = 0; k < 4; k++) q[k] = p[most][k] / scale;
}

void hk_rotation_of_quaternion(const double q[4], double R[9]) {
  double w = q[0], x = q[1], y = q[2], z = q[3];
  R[0] = 1 - 2 * (y * y + z * z), R[1] = 2 * (x * y - w * z), R[2] = 2 * (x * z + w * y);
  R[3] = 2 * (x * y + w * z), R[4] = 1 - 2 * (x * x + z * z), R[5] = 2 * (y * z - w * x);
  R[6] = 2 * (x * z - w * y), R[7] = 2 * (y * z + w * x), R[8] = 1 - 2 * (x * x + y * y);
}

double hk_rotation_error(const double R[9]) {
  double most = 0;
  for (int p = 0; p < 9; p++) {
    const double *a = R + p / 3 * 3, *b = R + p % 3 * 3;
    most = fmax(most, fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - (p % 4 == 0)));
  }
  double det =
      R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) + R[2] * (R[3] * R[7] - R[4] * R[6]);
  return det < 0 ? 2 : most;
}
