/* What carrying does to the sums of heat, smoke and fuel: nothing in an exact flow within closed walls, so that what it
 * does is an error, which MacCormack's scheme has to its order. Fire, sources and losses are exact in each cell, so
 * heat + burn_heat x fuel of a closed flame is off by this alone. */
#ifndef HK_GAS_BALANCE_H
#define HK_GAS_BALANCE_H

#include "plugins/common/gas/gas.h"

enum { HK_GAS_SUMS = HK_GAS_FIELDS - HK_GAS_HEAT };

typedef struct hk_gas_balance {
  double moved[HK_GAS_SUMS]; /* by which carrying has changed the sums of heat, K m^3, smoke, kg, and fuel, m^3 */
  double whole[HK_GAS_SUMS]; /* the largest that there were */
  double swelled;            /* parts of its volume that a cell gained or lost in all steps, the most of each */
} hk_gas_balance;

/* Before and after hk_gas_carry. */
void hk_gas_balance_before(hk_gas_balance *, const hk_gas *);
void hk_gas_balance_after(hk_gas_balance *, const hk_gas *);
/* Part of the whole that carrying has added, of the field of which that is the most; NAN: the box is open, or there are
 * obstacles, in whose cells sums are of no meaning, or there is nothing to carry. */
double hk_gas_drift(const hk_gas_balance *, const hk_gas *);
/* The sum of a field over the cells by their volume; in a plane by 1 m of depth. */
double hk_gas_sum(const hk_gas *, int field);

#endif
