/* Sources: they add and remove particles. */
#ifndef HK_PLUGIN_SOURCE_H
#define HK_PLUGIN_SOURCE_H

#include "core/plugin/model.h"

typedef struct hk_birth {
  double mass; /* kg, positive */
  double position[3], velocity[3];
  uint32_t group;        /* position in model->group_name */
  const double *channel; /* all channel values of the particle in the order of model->channel; NULL: initial ones */
} hk_birth;

/* Births and deaths requested in `emit` take effect together when it returns: dead particles are removed, the others
 * keep their order, and births are appended with new ids. Tuples with dead members are removed from the forces. */
typedef struct hk_population hk_population;
struct hk_population {
  hk_status (*add)(hk_population *, const hk_birth *birth, uint32_t *id); /* id may be NULL */
  /* removing a particle twice has no further effect */
  hk_status (*remove)(hk_population *, uint32_t index);
};

typedef struct hk_source {
  size_t size;
  /* called before a step of h s */
  hk_status (*emit)(void *self, const hk_view *view, double h, hk_population *population);
} hk_source;

#endif
