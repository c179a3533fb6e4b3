/* Births and deaths that sources ask for. */
#ifndef HK_POPULATION_H
#define HK_POPULATION_H

#include "core/engine/loop/loop.h"
#include "core/numerics/population/particle_set.h"

typedef struct hk_newborn {
  hk_birth birth;
  double age, lifetime; /* s; age INFINITY: born now, by `add` */
  uint32_t *id;         /* NULL: nobody asks */
  size_t order;
  uint32_t given; /* its id */
} hk_newborn;

struct hk_population_change {
  hk_population population; /* first member: the table that a source gets */
  hk_state *state;
  const hk_instance *source;        /* whom the errors name */
  size_t births, ageless, capacity; /* ageless: those by `add` */
  hk_newborn *birth;
  double *channel; /* births x width, by `order` */
  size_t channel_capacity;
  size_t deaths;
  bool *dies;    /* n, whether the particle dies; all false but between requests and their application */
  uint32_t *map; /* n, from old indices to new ones, after the application */
  size_t room;   /* of `dies` and `map` */
};

hk_population_change hk_population_open(hk_state *);
void hk_population_close(hk_population_change *);
/* Begins a change, without requests. */
hk_status hk_population_begin(hk_population_change *, hk_error *error);
/* Applies all births and deaths, after which `birth` has the living newborns in the order of their ids. */
hk_status hk_population_apply(hk_population_change *, hk_error *error);

/* ---- sources.c ---- */

hk_status hk_sources_emit(hk_loop *, double h, unsigned when); /* 0: before a step; HK_AFTER_STEPS: after it */

/* ---- newborns.c ---- */

/* Moves the last `count` particles, the newborns in the order of the state, from their births to the present. h: s, not
 * below any age. */
hk_status hk_newborns_move(hk_dynamics *, const hk_newborn *, size_t count, double h);

#endif
