/* "grip/1": the hand of a user who watches the run and may hold one particle. An output that hears of the user's moves
 * tells it at frames where the hand is; forces ask where it is at a time. Between two frames it moves evenly, and its
 * hold grows or fades evenly over the frame in which it takes or lets go, so that forces are continuous in time. */
#ifndef HK_HAND_H
#define HK_HAND_H

#include "core/plugin.h"

#define HK_HAND_INTERFACE "grip/1"

typedef struct hk_grip {
  uint32_t id;     /* of the particle that is held; 0: none */
  double place[3]; /* m, where the hand is */
  double hold;     /* from 0 to 1 */
  double strength; /* a factor that the user chose */
  double frame;    /* s, from frame to frame: the time scale of the hand */
} hk_grip;

typedef struct hk_hand {
  void *self;
  /* At a frame: until the next one, `frame` s later, the hand moves to `place` with the particle `id`, or lets go of
   * what it holds (0). Another particle than before is taken where it is. */
  void (*move)(void *self, const hk_view *view, double frame, uint32_t id, const double place[3], double strength);
  hk_grip (*grip)(const void *self, double t);
} hk_hand;

#endif
