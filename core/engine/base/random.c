/* See base.h. Each number takes one step of a shift register of 256 bits, whose output is scrambled by multiplication
 * and rotation. */
#include "core/engine/base/base.h"

static uint64_t rotate(uint64_t x, int bits) { return (x << bits) | (x >> (64 - bits)); }

void hk_random_seed(uint64_t state[4], uint64_t seed) {
  for (int k = 0; k < 4; k++) {
    uint64_t z = seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    state[k] = z ^ (z >> 31);
  }
}

double hk_random_uniform(uint64_t state[4]) {
  uint64_t result = rotate(state[1] * 5, 7) * 9, t = state[1] << 17;
  state[2] ^= state[0];
  state[3] ^= state[1];
  state[1] ^= state[2];
  state[0] ^= state[3];
  state[2] ^= t;
  state[3] = rotate(state[3], 45);
  return (double)(result >> 11) * 0x1.0p-53;
}
