/* Sources: they let particles be born and die. */
#ifndef HK_PLUGIN_SOURCE_H
#define HK_PLUGIN_SOURCE_H

#include "core/plugin/model.h"

typedef struct hk_birth {
  double mass; /* kg, positive */
  double position[3], velocity[3];
  uint32_t group;        /* position in model->group_name */
  const double *channel; /* all channel values of the particle in the order of model->channel; NULL: initial ones */
} hk_birth;

/* Births and deaths asked for in `emit` take effect together when it returns: deaths close ranks in order, births are
 * appended with new ids. Tuples of forces with dead members go with them. */
typedef struct hk_population hk_population;
struct hk_population {
  hk_status (*add)(hk_population *, const hk_birth *birth, uint32_t *id); /* id may be NULL */
  hk_status (*remove)(hk_population *, uint32_t index);                   /* twice the same is once */
};

typedef struct hk_source {
  size_t size;
  hk_status (*emit)(void *self, const hk_view *view, double h, hk_population *population); /* before a step of h s */
} hk_source;

#endif
