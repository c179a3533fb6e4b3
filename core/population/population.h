/* Births and deaths that sources ask for. */
#ifndef HK_POPULATION_H
#define HK_POPULATION_H

#include "core/dynamics/dynamics.h"

typedef struct hk_newborn {
  hk_birth birth;
  double age, lifetime; /* s; age INFINITY: born now, by `add` */
  uint32_t *id;         /* NULL: nobody asks */
  size_t order;
  uint32_t given; /* its id */
} hk_newborn;

typedef struct hk_population_change {
  hk_population population; /* first member: the table that a source gets */
  hk_state *state;
  const hk_scene *scene;
  const hk_instance *source;        /* whom the errors name */
  size_t births, ageless, capacity; /* ageless: those by `add` */
  hk_newborn *birth;
  double *channel; /* births x width, by `order` */
  size_t channel_capacity;
  size_t deaths;
  bool *dies; /* n, whether the particle dies; NULL: none does */
} hk_population_change;

hk_population_change hk_population_begin(hk_state *, const hk_scene *);
/* Applies all births and deaths, after which `birth` has the living newborn in the order of their ids. The caller frees
 * *map, from old indices to new ones. */
hk_status hk_population_apply(hk_population_change *, uint32_t **map, hk_error *error);
void hk_population_end(hk_population_change *);

/* ---- newborns.c ---- */

/* Moves the last `count` particles, the newborns in the order of the state, from their births to the present. h: s, not
 * below any age. */
hk_status hk_newborns_move(hk_dynamics *, const hk_newborn *, size_t count, double h);

#endif
