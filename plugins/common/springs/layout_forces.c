/* See layout_forces.h. */
#include "plugins/common/springs/layout_forces.h"
#include "plugins/kit/springs/spring_kernel.h"

void hk_layout_forces(const hk_spring_layout *s, const hk_host *host, const double *x, const double *v, double *F,
                      double *power) {
  hk_spring_forces(s, host, x, v, F, power);
}
