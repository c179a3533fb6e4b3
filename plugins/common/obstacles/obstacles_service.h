/* "obstacles/1": all obstacles of a run, in the order in which they were entered. Particles that meet several of them
 * in one step do so in the order of time, which takes one search over all. Outputs show them, and those whose contact
 * is a force. */
#ifndef HK_OBSTACLES_SERVICE_H
#define HK_OBSTACLES_SERVICE_H

#include "plugins/common/obstacles/obstacle.h"

#define HK_OBSTACLES_INTERFACE "obstacles/1"

typedef struct hk_obstacles {
  void *self;
  /* Called in `create`. The obstacle stays the caller's and valid as long as the run. HK_BAD_PARAM: there are too many.
   */
  hk_status (*enter)(void *self, hk_obstacle *);
  const hk_obstacle_set *set;
  /* Called in `create`, for an obstacle that outputs alone need to know: of its shape and the end of its motion, where
   * it is at the end of the last step. It stays the caller's and valid as long as the run. */
  void (*show)(void *self, hk_obstacle *);
  const hk_obstacle_set *shown; /* all that were entered or shown; complete when outputs are opened */
  /* Called in `create` by what moves particles along obstacles and keeps them out by itself, as a liquid does: impacts
   * would change and take back steps in vain. particles: an array of the caller's, n long, which it may replace in
   * `topology`. HK_BAD_PARAM: there are too many. */
  hk_status (*carry)(void *self, const bool *const *particles);
} hk_obstacles;

#endif
