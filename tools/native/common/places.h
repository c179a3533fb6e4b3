/* Places of many particles, hard ones for whoever searches among them. They follow from a shape and a seed. */
#ifndef HK_TOOLS_PLACES_H
#define HK_TOOLS_PLACES_H

#include <stddef.h>
#include <stdint.h>

typedef struct hk_places {
  int shape; /* a place in hk_places_names */
  uint64_t seed;
} hk_places;

/* NULL-ended. */
extern const char *const hk_places_names[];

/* x: n x 3, m; within about a metre, but for those that are far off. */
void hk_places_put(hk_places *, double *x, size_t n);
/* Moves each particle by less than `most` (m) in a direction of its own. */
void hk_places_move(hk_places *, double *x, size_t n, double most);

#endif
