/* Bonet and Wood, Nonlinear continuum mechanics for finite element analysis, 2nd edition (2008), chapter 9; or Sifakis
 * and Barbic, FEM simulation of 3D deformable solids, SIGGRAPH courses (2012), 4.2. */
#include "plugins/common/solids/tetrahedron.h"

#include "plugins/kit/vector3.h"

#include <stddef.h>

/* d[m] = y_m - y_0 */
static void sides(const double *y, const uint32_t member[4], double d[4][3]) {
  for (int m = 0; m < 4; m++) hk_subtract(d[m], y + 3 * (size_t)member[m], y + 3 * (size_t)member[0]);
}

double hk_tetrahedron_volume(const double *x, const uint32_t member[4]) {
  double d[4][3], normal[3];
  sides(x, member, d);
  hk_cross(normal, d[2], d[3]);
  return hk_dot(d[1], normal) / 6;
}

void hk_tetrahedron_slopes(const double *x, const uint32_t member[4], double slope[4][3]) {
  double d[4][3];
  sides(x, member, d);
  for (int c = 0; c < 3; c++) slope[0][c] = 0;
  for (int m = 1; m < 4; m++) {
    hk_cross(slope[m], d[m % 3 + 1], d[(m + 1) % 3 + 1]);
    for (int c = 0; c < 3; c++) slope[0][c] -= slope[m][c] /= 6;
  }
}

hk_tetrahedron hk_tetrahedron_of(const double *x, const uint32_t member[4]) {
  hk_tetrahedron t = {.volume = hk_tetrahedron_volume(x, member)};
  hk_tetrahedron_slopes(x, member, t.slope);
  for (int e = 0; e < 12; e++) t.slope[e / 3][e % 3] /= t.volume;
  return t;
}

double hk_tetrahedron_longest(const double *x, const uint32_t member[4]) {
  double longest = 0, e[3];
  for (int m = 1; m < 4; m++)
    for (int q = 0; q < m; q++) {
      hk_subtract(e, x + 3 * (size_t)member[m], x + 3 * (size_t)member[q]);
      longest = fmax(longest, hk_length(e));
    }
  return longest;
}

void hk_tetrahedron_gradient(const hk_tetrahedron *t, const double *y, const uint32_t member[4], double F[9]) {
  double d[4][3];
  sides(y, member, d); /* differences first: a far origin costs no digits */
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      F[3 * r + c] = d[1][r] * t->slope[1][c] + d[2][r] * t->slope[2][c] + d[3][r] * t->slope[3][c];
}

void hk_tetrahedron_load(const hk_tetrahedron *t, const double P[9], double (*load)[3]) {
  for (int r = 0; r < 3; r++) {
    for (int m = 1; m < 4; m++) load[m][r] = -t->volume * hk_dot(P + 3 * r, t->slope[m]);
    load[0][r] = -(load[1][r] + load[2][r] + load[3][r]);
  }
}

void hk_tetrahedron_matrix(const hk_tetrahedron *t, const double H[81], double K[144]) {
  for (int q = 0; q < 4; q++)
    for (int s = 0; s < 3; s++) {
      double part[9]; /* of the stress, by a change of coordinate s of member q */
      for (int e = 0; e < 9; e++) part[e] = t->volume * hk_dot(H + 9 * e + 3 * s, t->slope[q]);
      for (int m = 0; m < 4; m++)
        for (int r = 0; r < 3; r++) K[12 * (3 * m + r) + 3 * q + s] = hk_dot(part + 3 * r, t->slope[m]);
    }
}
