/* What a script says of a gas at the start: functions of the place. */
#ifndef HK_GAS_START_H
#define HK_GAS_START_H

#include "plugins/common/gas/gas.h"

typedef struct hk_gas_start {
  const hk_function *velocity, *temperature, *smoke, *fuel; /* m/s, K, kg/m^3, part; NULL: at rest, ambient, none */
  double ambient;                                           /* K */
} hk_gas_start;

/* Fills the fields that the gas carries; the wind is that of the ambient air where nothing is said of the velocity. Any
 * error of the script's functions. */
hk_status hk_gas_start_fields(hk_gas *, const hk_gas_start *, double t);

#endif
