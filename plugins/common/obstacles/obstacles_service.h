/* "obstacles/1": all obstacles of a run, in the order in which they were entered. Particles that meet several of them
 * in one step do so in the order of time, which takes one search over all. */
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
} hk_obstacles;

#endif
