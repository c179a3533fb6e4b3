/* The sums over the lattice that give cohesion its strength. */
#include "plugins/common/sph/sph_cohesion.h"

static const double inner_pressure = 1; /* by tension/spacing */
static const double pi = 3.14159265358979323846;

typedef struct lattice_sums {
  double work;   /* m: sum V W |d| */
  double virial; /* sum V (-W'/r) d^2 */
} lattice_sums;

static lattice_sums sum_over_lattice(const hk_sph_kernel *k, double spacing, int dimensions) {
  lattice_sums sum = {0};
  double volume = spacing * spacing * spacing;
  int most = (int)ceil(k->radius / spacing), deep = dimensions == 3 ? most : 0;
  for (int a = -most; a <= most; a++)
    for (int b = -most; b <= most; b++)
      for (int c = -deep; c <= deep; c++) {
        double r2 = (a * a + b * b + c * c) * (spacing * spacing);
        sum.work += volume * hk_sph_value(k, r2) * sqrt(r2);
        sum.virial += volume * hk_sph_slope(k, r2) * r2;
      }
  return sum;
}

void hk_sph_cohesion_prepare(hk_sph_cohesion *c, double spacing, double reach, int dimensions, double tension) {
  hk_sph_kernel_prepare(&c->wide, spacing, HK_SPH_COHESION_WIDER * reach, dimensions);
  hk_sph_kernel_prepare(&c->narrow, spacing, reach, dimensions);
  lattice_sums wide = sum_over_lattice(&c->wide, spacing, dimensions);
  lattice_sums narrow = sum_over_lattice(&c->narrow, spacing, dimensions);
  double part = dimensions == 3 ? 0.5 : 2 / pi, inner = inner_pressure * dimensions * part / (2 * spacing);
  double by = (wide.virial - inner * wide.work) / (narrow.virial - inner * narrow.work);
  c->pull = 4 * tension / (part * (wide.work - by * narrow.work));
  c->push = by * c->pull;
}
