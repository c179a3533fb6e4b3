/* xoshiro256** 1.0 (Blackman and Vigna 2018, "Scrambled linear pseudorandom number generators"), seeded by
 * splitmix64. Four words of state: an instance's stream, saved with it. */
#ifndef HK_RANDOM_H
#define HK_RANDOM_H

#include <stdint.h>

void hk_random_seed(uint64_t state[4], uint64_t seed);
double hk_random_uniform(uint64_t state[4]); /* [0, 1), 53 bits */

#endif
