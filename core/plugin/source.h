/* Sources: they add and remove particles. */
#ifndef HK_PLUGIN_SOURCE_H
#define HK_PLUGIN_SOURCE_H

#include "core/plugin/model.h"

typedef struct hk_birth {
  double mass; /* kg, positive */
  double position[3], velocity[3];
  uint32_t group;        /* position in model->group_name */
  const double *channel; /* all channel values of the particle in the order of model->channel, NAN for the initial one;
                            NULL: all initial ones */
} hk_birth;

/* Births and deaths that the sources request in `emit` take effect together, after all of them: dead particles are
 * removed, the others keep their order, and births are appended with new ids. Tuples with dead members are removed from
 * the forces. */
typedef struct hk_population hk_population;
struct hk_population {
  hk_status (*add)(hk_population *, const hk_birth *birth, uint32_t *id); /* id may be NULL */
  /* removing a particle twice has no further effect */
  hk_status (*remove)(hk_population *, uint32_t index);
  /* A particle that was born `age` s ago, as `birth` says: it is moved to the present by the forces of the scene on it
   * alone, those between it and others left out, with an error of the fourth order in its age. Ids rise with the times
   * of birth, whatever source asks first. One whose lifetime (s) is not above its age takes an id and is not seen. *id
   * is set when the births take effect, after `emit` has returned; it may be NULL. */
  hk_status (*add_aged)(hk_population *, const hk_birth *birth, double age, double lifetime, uint32_t *id);
};

enum { HK_AFTER_STEPS = 1 }; /* hk_source.flags: `emit` is called after a step of h s, before the frame at its end */

typedef struct hk_source {
  size_t size;
  /* Called before a step of h s. With HK_AFTER_STEPS, after a step of h s that ended at view->t: with births of ages
   * from 0 to h and deaths of what died in the step, every frame has the same particles for any length of the steps. */
  hk_status (*emit)(void *self, const hk_view *view, double h, hk_population *population);
  unsigned flags;
} hk_source;

#endif
