/* Births and deaths that sources ask for, and what leaves the surfaces of a scene. */
#ifndef HK_POPULATION_H
#define HK_POPULATION_H

#include "core/engine/loop/loop.h"

/* ---- particle_set.c: particles that replace those of the state, after births and deaths or from a file ---- */

typedef struct hk_particle_set {
  size_t n;
  double *X; /* (6 + width) n + 1 */
  double *mass;
  uint32_t *id; /* those of the state in its order, then others, increasing */
  uint32_t *group;
} hk_particle_set;

/* false: no memory; the set must be freed all the same */
bool hk_particle_set_allocate(hk_particle_set *, size_t n, size_t width);
void hk_particle_set_free(hk_particle_set *);
bool hk_state_reserve(hk_state *, size_t n); /* makes room for n particles; false: no memory, nothing has changed */
/* Moves old index i to map[i] (UINT32_MAX: removed), in the same order, in a state of n particles for which there is
 * room. The caller sets the rest of them, and remaps the indices in pins, plugins and matrices. */
void hk_state_move(hk_state *, const uint32_t *map, size_t n);
/* Replaces the particles by those of the set, old index i by map[i], and frees the set's arrays, also when it fails. */
hk_status hk_state_adopt(hk_state *, const uint32_t *map, hk_particle_set *, hk_error *error);

/* ---- births_and_deaths.c ---- */

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
  size_t lost;   /* elements of forces that were gone when surfaces were last looked at (torn_surfaces.c) */
};

hk_population_change *hk_population_open(hk_state *); /* NULL: no memory */
void hk_population_close(hk_population_change *);     /* or NULL */
/* Begins a change, without requests. */
hk_status hk_population_begin(hk_population_change *, hk_error *error);
/* Applies all births and deaths, after which `birth` has the living newborns in the order of their ids. */
hk_status hk_population_apply(hk_population_change *, hk_error *error);

/* ---- sources.c ---- */

hk_status hk_sources_emit(hk_loop *, double h, unsigned when); /* 0: before a step; HK_AFTER_STEPS: after it */

/* ---- torn_surfaces.c: elements that are gone (facets/internal.h) leave the scene's edges and triangles ---- */

bool hk_surfaces_may_tear(const hk_loop *);
/* Takes them out of the state, and tells the plugins. *torn: something has left. */
hk_status hk_surfaces_tear(hk_loop *, bool *torn);
/* The same after a checkpoint was read: forces that lose elements also hear of what they have kept of them. */
hk_status hk_surfaces_resume(hk_loop *);
/* The loop's `emit`: births and deaths, and then what has torn since. The energy that goes with it, that of bending
 * perhaps, is dissipated. */
hk_status hk_emit_and_tear(hk_loop *, double h, unsigned when);

/* ---- newborns.c ---- */

/* Moves the last `count` particles, the newborns in the order of the state, from their births to the present. h: s, not
 * below any age. */
hk_status hk_newborns_move(hk_dynamics *, const hk_newborn *, size_t count, double h);

#endif
