/* What bodies that pressure moves add to its matrix: rho V sum of G M^-1 G^T over bodies, with the volume V of a cell,
 * the flux G x (velocity, spin) out of each cell by the volume, and the body's mass and moments of inertia M, six by
 * six. It is symmetric and not negative: liquid and bodies get the velocities of least kinetic energy (Batty, Bertails,
 * Bridson 2007, A fast variational framework for accurate solid-fluid coupling, section 4). */
#ifndef HK_MOVING_WALLS_H
#define HK_MOVING_WALLS_H

#include "core/plugin.h"

/* Beside one row and one body. */
typedef struct hk_moving_wall {
  uint32_t row, body;
  double flux[6]; /* 1/m of the velocity, 1 of the spin about the centre of mass */
} hk_moving_wall;

typedef struct hk_moving_body {
  double mass, inverse_inertia[9]; /* by rho V: of the liquid in a cell; m^2, 1/m^2 */
  double sum[6], reply[6];         /* of a product */
  uint32_t row;                    /* the first beside it, for whoever asks; UINT32_MAX: none yet */
} hk_moving_body;

typedef struct hk_moving_walls {
  size_t count, room, bodies;
  hk_moving_wall *wall;
  hk_moving_body *body;
} hk_moving_walls;

/* Whether no pressure moves it. */
static inline bool hk_moving_body_is_held(const hk_moving_body *b) {
  return isinf(b->mass) && b->inverse_inertia[0] + b->inverse_inertia[4] + b->inverse_inertia[8] == 0;
}

void hk_moving_walls_clear(hk_moving_walls *);
/* HK_NO_MEMORY, with a message. */
hk_status hk_moving_walls_add(hk_moving_walls *, const hk_host *, const hk_moving_wall *);
/* The velocities and spins that the pressure `in` gives: `reply` of each body. */
void hk_moving_walls_reply(hk_moving_walls *, const double *in);
/* out += what the bodies do with the pressure `in`, both of rows; returns its product with `in`. */
double hk_moving_walls_multiply(hk_moving_walls *, const double *in, double *out);

#endif
