/* Whether the distances of two runs of particles are all within limits, without roots. */
#ifndef HK_RUN_SCREEN_H
#define HK_RUN_SCREEN_H

#include <stdbool.h>
#include <stddef.h>

typedef struct hk_run_ends {
  const double *x[2], *y[2], *z[2]; /* coordinates of the particles of both ends, m */
} hk_run_ends;

/* True where one of `count` squared distances is outside of [low, high], m^2. NaN is within. */
typedef bool hk_run_screen(const hk_run_ends *, size_t count, double low, double high);

hk_run_screen hk_run_screen_narrow;      /* for every processor */
hk_run_screen *hk_run_screen_wide(void); /* NULL where this processor has no vectors of four doubles */
hk_run_screen *hk_run_screen_fastest(void);

#endif
