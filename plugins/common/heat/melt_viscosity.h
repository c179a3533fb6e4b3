/* The viscosity of what melts, by its temperature and by how much of it is molten:
 *     mu = solid^(1 - f) melt^f,   melt = viscosity factor(T) exp(slope/(T - pole)),
 * with f the molten part (heat_law.h). With the pole at 0 the melt's law is that of Arrhenius and Andrade, slope being
 * the energy of activation by the gas constant; with another one that of Vogel 1921, Fulcher 1925, Tammann and Hesse
 * 1926; with the slope 0 it is constant. `factor` is a table, between whose entries its logarithm is linear in T. What
 * is above `most`, as near the pole, is `most`. */
#ifndef HK_HEAT_MELT_VISCOSITY_H
#define HK_HEAT_MELT_VISCOSITY_H

#include "plugins/common/heat/heat_law.h"

enum { HK_TABLE_HELD, HK_TABLE_REFUSED };

typedef struct hk_melt_viscosity {
  double viscosity;                 /* Pa s */
  double slope, pole;               /* K */
  hk_numbers temperatures, factors; /* K, rising; 1; of the same length, or empty */
  int outside;                      /* of the table: HK_TABLE_... */
  double solid, most;               /* Pa s; solid NAN: the melt's law holds below the solidus, too */
} hk_melt_viscosity;

/* In `create`. HK_BAD_PARAM: tables that do not rise, are of different lengths or not positive; a solid that is softer
 * than nothing. */
hk_status hk_melt_viscosity_check(const hk_melt_viscosity *, const hk_host *);
/* Pa s; at the enthalpy h, J/kg. NAN: the temperature is outside the table, which refuses that. */
double hk_melt_viscosity_at(const hk_melt_viscosity *, const hk_heat_law *, double h);

#endif
