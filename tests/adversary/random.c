/* Random numbers from splitmix64 (Steele, Lea and Flood 2014): a seed gives the same scene on every machine. */
#include "tests/adversary/adversary.h"

#include <math.h>

double adv_uniform(uint64_t *seed, double low, double high) {
  return low + (high - low) * ((double)(adv_next(seed) >> 11) * 0x1.0p-53);
}

double adv_log(uint64_t *seed, double low, double high) { return low * exp(adv_uniform(seed, 0, log(high / low))); }

int adv_below(uint64_t *seed, int count) { return (int)(adv_next(seed) % (uint64_t)count); }

bool adv_chance(uint64_t *seed, double probability) { return adv_uniform(seed, 0, 1) < probability; }

void adv_direction(uint64_t *seed, double unit[3]) {
  double square = 2;
  while (square > 1 || square < 0.01) {
    square = 0;
    for (int c = 0; c < 3; c++) unit[c] = adv_uniform(seed, -1, 1), square += unit[c] * unit[c];
  }
  for (int c = 0; c < 3; c++) unit[c] /= sqrt(square);
}
