/* Places of many particles, hard ones for whoever searches among them. A crowd follows from its shape and its seed. */
#ifndef HK_TOOLS_CROWD_H
#define HK_TOOLS_CROWD_H

#include <stddef.h>
#include <stdint.h>

typedef struct hk_crowd {
  int shape; /* a place in hk_crowd_names */
  uint64_t seed;
} hk_crowd;

/* NULL-ended. */
extern const char *const hk_crowd_names[];

/* x: n x 3, m; within about a metre, but for those that are far off. */
void hk_crowd_place(hk_crowd *, double *x, size_t n);
/* Moves each particle by less than `most` (m) in a direction of its own. */
void hk_crowd_move(hk_crowd *, double *x, size_t n, double most);

#endif
