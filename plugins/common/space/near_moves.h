/* The particles that a straight move may have taken near a point or a line: what a force of short range about it looks
 * at after every step, with a few operations for all others. */
#ifndef HK_SPACE_NEAR_MOVES_H
#define HK_SPACE_NEAR_MOVES_H

#include "core/plugin.h"

/* r: the vector to x from the centre, or from the nearest point of the line where the unit vector `axis` is not 0. */
static inline void hk_from_line(const double center[3], const double axis[3], const double x[3], double r[3]) {
  double along = 0;
  for (int c = 0; c < 3; c++) r[c] = x[c] - center[c];
  for (int c = 0; c < 3; c++) along += axis[c] * r[c];
  for (int c = 0; c < 3; c++) r[c] -= along * axis[c];
}

typedef struct hk_near_moves {
  const double *center, *axis; /* m; a unit vector, or 0: a point */
  double ways;                 /* a particle that ends this many of its moves away is not near */
  const hk_view *to;
  const double *x_from; /* n x 3, m: before the move */
} hk_near_moves;

/* Calls each(context, i, r, dr) for the acting particles i that are near and come nearest on the way, in their order:
 * r from the centre or line before the move, and its change. */
void hk_near_moves_visit(const hk_near_moves *,
                         void (*each)(void *context, uint32_t i, const double r[3], const double dr[3]), void *context);

#endif
