#include "plugins/common/orbits/jacobi.h"

void hk_jacobi_weigh(hk_jacobi *j, const double *mass) {
  double sum = 0;
  for (size_t k = 0; k < j->count; k++) {
    j->upto[k] = sum += mass[j->order[k]];
    j->part[k] = mass[j->order[k]] / sum;
  }
}

void hk_jacobi_from(const hk_jacobi *j, const double *of, double *to) {
  for (int c = 0; c < 3 && j->count > 0; c++) {
    double centre = of[3 * (size_t)j->order[0] + (size_t)c];
    for (size_t k = 1; k < j->count; k++) {
      double apart = of[3 * (size_t)j->order[k] + (size_t)c] - centre;
      to[3 * k + (size_t)c] = apart;
      centre += j->part[k] * apart;
    }
    to[c] = centre;
  }
}

void hk_jacobi_to(const hk_jacobi *j, const double *of, double *to) {
  for (int c = 0; c < 3 && j->count > 0; c++) {
    double centre = of[c];
    for (size_t k = j->count - 1; k > 0; k--) {
      double apart = of[3 * k + (size_t)c];
      centre -= j->part[k] * apart;
      to[3 * (size_t)j->order[k] + (size_t)c] = centre + apart;
    }
    to[3 * (size_t)j->order[0] + (size_t)c] = centre;
  }
}
