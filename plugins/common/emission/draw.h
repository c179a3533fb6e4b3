/* Random numbers by number: draw j of birth k is a function of a seed, k and j alone, so that births do not depend on
 * who was born before, on the steps or on threads. The generator is SplitMix64 (Steele, Lea and Flood, Fast splittable
 * pseudorandom number generators, OOPSLA 2014), begun anew for every birth at a mixed number. */
#ifndef HK_EMISSION_DRAW_H
#define HK_EMISSION_DRAW_H

#include <math.h>
#include <stdint.h>

typedef struct hk_draw {
  uint64_t state;
} hk_draw;

static inline uint64_t hk_draw_mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static inline hk_draw hk_draw_begin(uint64_t seed, uint64_t number) {
  return (hk_draw){hk_draw_mix(seed ^ hk_draw_mix(number + 0x9e3779b97f4a7c15u))};
}

/* Uniform in (0, 1), 53 bits; neither end is ever drawn. */
static inline double hk_draw_uniform(hk_draw *d) {
  d->state += 0x9e3779b97f4a7c15u;
  return ((double)(hk_draw_mix(d->state) >> 11) + 0.5) * 0x1p-53;
}

/* The standard normal distribution, by Box and Muller. */
static inline double hk_draw_normal(hk_draw *d) {
  double u = hk_draw_uniform(d), angle = 6.283185307179586 * hk_draw_uniform(d);
  return sqrt(-2 * log(u)) * cos(angle);
}

#endif
