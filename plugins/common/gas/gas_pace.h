/* How fast a gas is and will be, and the longest step that it allows. */
#ifndef HK_GAS_PACE_H
#define HK_GAS_PACE_H

#include "plugins/common/gas/gas.h"

/* m/s^2: by which the gas rises or sinks fastest, of its cells and of what the source, NULL: none, would make of them.
 */
double hk_gas_fastest_lift(const hk_gas *, const hk_gas_source *);
/* s, in which gas at the speed now and with that acceleration, m/s^2, passes no more than `courant` cells; INFINITY: it
 * is at rest, and nothing lifts it. */
double hk_gas_longest_step(const hk_gas *, double lift, double courant);

#endif
