#include "plugins/common/heat/melt_viscosity.h"

hk_status hk_melt_viscosity_check(const hk_melt_viscosity *m, const hk_host *host) {
  const hk_numbers *T = &m->temperatures, *factor = &m->factors;
  if (T->count != factor->count)
    return host->fail(host, HK_BAD_PARAM,
                      "factors: there are %zu, and %zu temperatures: give one for each of `temperatures`",
                      factor->count, T->count);
  for (size_t k = 0; k < T->count; k++) {
    if (!(factor->value[k] > 0))
      return host->fail(host, HK_BAD_PARAM, "factors: number %zu is %g, and a viscosity is above 0: give a larger one",
                        k + 1, factor->value[k]);
    if (k > 0 && !(T->value[k] > T->value[k - 1]))
      return host->fail(host, HK_BAD_PARAM,
                        "temperatures: number %zu, %g K, is not above the one before, %g K: a table rises", k + 1,
                        T->value[k], T->value[k - 1]);
  }
  return HK_OK;
}

/* Of the table's factor at T. */
static double logarithm_of_factor(const hk_melt_viscosity *m, double T) {
  const double *at = m->temperatures.value, *factor = m->factors.value;
  size_t last = m->temperatures.count - 1, k = 0;
  if (T < at[0] || T > at[last]) {
    if (m->outside == HK_TABLE_REFUSED) return NAN;
    return log(factor[T < at[0] ? 0 : last]);
  }
  if (last == 0) return log(factor[0]);
  while (k + 1 < last && T > at[k + 1]) k++;
  double part = (T - at[k]) / (at[k + 1] - at[k]);
  return (1 - part) * log(factor[k]) + part * log(factor[k + 1]);
}

static double logarithm_of_melt(const hk_melt_viscosity *m, double T) {
  double sum = log(m->viscosity);
  if (m->temperatures.count) sum += logarithm_of_factor(m, T);
  if (m->slope > 0) sum += T > m->pole ? m->slope / (T - m->pole) : INFINITY;
  return sum;
}

double hk_melt_viscosity_at(const hk_melt_viscosity *m, const hk_heat_law *law, double h) {
  double molten = hk_heat_melts(law) ? hk_heat_molten(law, h) : 1, most = log(m->most), solid = 0, melt = 0;
  if (!(isnan(m->solid) || molten >= 1)) solid = (1 - molten) * fmin(most, log(m->solid));
  if (isnan(m->solid)) molten = 1;
  if (molten > 0) melt = logarithm_of_melt(m, hk_heat_temperature(law, h));
  if (isnan(melt)) return NAN;
  return exp(fmin(most, solid + (molten > 0 ? molten * fmin(most, melt) : 0)));
}
