#include "plugins/common/heat/heat_law.h"

hk_status hk_heat_law_check(hk_heat_law *l, const hk_host *host) {
  if (isnan(l->liquidus)) l->liquidus = l->solidus;
  if (isnan(l->capacity[HK_MOLTEN])) l->capacity[HK_MOLTEN] = l->capacity[HK_SOLID];
  if (isnan(l->conductivity[HK_MOLTEN])) l->conductivity[HK_MOLTEN] = l->conductivity[HK_SOLID];
  if (isnan(l->solidus) && !isnan(l->liquidus))
    return host->fail(host, HK_BAD_PARAM,
                      "liquidus: there is none without a solidus, where melting begins: give `solidus` too");
  if (l->liquidus < l->solidus)
    return host->fail(host, HK_BAD_PARAM,
                      "liquidus: melting ends at %g K and begins at the solidus, %g K: give a liquidus that is not "
                      "below it, or leave it out for one melting point",
                      l->liquidus, l->solidus);
  if (hk_heat_melts(l) && isnan(l->latent))
    return host->fail(host, HK_BAD_PARAM,
                      "latent: what melts takes heat for it: give `latent` in J/kg, or leave out the solidus");
  if (!hk_heat_melts(l) && !isnan(l->latent))
    return host->fail(host, HK_BAD_PARAM,
                      "latent: heat of melting without a temperature of melting: give `solidus`, or leave it out");
  return HK_OK;
}

static double by_slope(double value, double slope, double without) { return slope > 0 ? value / slope : without; }

double hk_heat_least_enthalpy(const hk_heat_law *l, double theta) {
  double solid = l->conductivity[HK_SOLID] / l->capacity[HK_SOLID];
  double molten = l->conductivity[HK_MOLTEN] / l->capacity[HK_MOLTEN];
  if (!hk_heat_melts(l) || theta <= 0) return by_slope(theta, solid, -INFINITY);
  double within = hk_heat_potential(l, l->latent);
  if (theta <= within) return l->latent * (theta / within);
  return l->latent + by_slope(theta - within, molten, 0);
}

double hk_heat_most_enthalpy(const hk_heat_law *l, double theta) {
  double solid = l->conductivity[HK_SOLID] / l->capacity[HK_SOLID];
  double molten = l->conductivity[HK_MOLTEN] / l->capacity[HK_MOLTEN];
  if (!hk_heat_melts(l)) return by_slope(theta, solid, INFINITY);
  if (theta < 0) return by_slope(theta, solid, 0);
  double within = hk_heat_potential(l, l->latent);
  if (theta < within) return l->latent * (theta / within);
  return l->latent + by_slope(theta - within, molten, INFINITY);
}

double hk_heat_steepest_potential(const hk_heat_law *l) {
  const double *k = l->conductivity, *c = l->capacity;
  double solid = k[HK_SOLID] / c[HK_SOLID];
  if (!hk_heat_melts(l)) return solid;
  double within = (k[HK_SOLID] + k[HK_MOLTEN]) / 2 * (l->liquidus - l->solidus) / l->latent;
  return fmax(solid, fmax(within, k[HK_MOLTEN] / c[HK_MOLTEN]));
}

double hk_heat_least_capacity(const hk_heat_law *l) {
  if (!hk_heat_melts(l)) return l->capacity[HK_SOLID];
  double least = fmin(l->capacity[HK_SOLID], l->capacity[HK_MOLTEN]);
  return l->liquidus > l->solidus ? fmin(least, l->latent / (l->liquidus - l->solidus)) : least;
}
