/* Places of many particles: see places.h. Random numbers are those of splitmix64 (Steele, Lea and Flood 2014). */
#include "tools/native/common/places.h"

enum { BOX, LINE, PLANE, HEAP, LATTICE, FAR, TWINS };

const char *const hk_places_names[] = {
    "a box", "a line", "a plane", "a heap", "a lattice", "a box and some far off", "pairs in one place", NULL};

/* Between 0 and 1. */
static double random_number(hk_places *c) {
  uint64_t z = c->seed += 0x9e3779b97f4a7c15;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
  z = (z ^ z >> 27) * 0x94d049bb133111eb;
  return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

/* The k-th number of particle i. */
static double place(hk_places *c, size_t i, int k) {
  double u = random_number(c);
  switch (c->shape) {
  case LINE:
    return k == 0 ? 20 * u : 0;
  case PLANE:
    return k == 2 ? -0.5 : 3 * u;
  case HEAP:
    return i % 2 ? 1e-3 * u : 1e-9 * u;
  case LATTICE:
    return 0.1 * (double)(k == 0 ? i % 11 : k == 1 ? i / 11 % 13 : i / 143) - 0.5;
  case FAR:
    return i % 100 == 7 ? 1e6 * (u - 0.5) : u;
  default:
    return u - 0.5;
  }
}

void hk_places_put(hk_places *c, double *x, size_t n) {
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      size_t e = 3 * i + (size_t)k;
      x[e] = c->shape == TWINS && i % 2 ? x[e - 3] : place(c, i, k);
    }
}

void hk_places_move(hk_places *c, double *x, size_t n, double most) {
  for (size_t e = 0; e < 3 * n && most > 0; e++) x[e] += 0.577 * most * (2 * random_number(c) - 1);
}
