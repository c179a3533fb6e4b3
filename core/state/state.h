/* The state of a scene: the vector X = (x, v, channels, work), who is in it (masses, ids, groups, pins), and how births
 * and deaths change that. */
#ifndef HK_STATE_H
#define HK_STATE_H

#include "core/scene/scene.h"

/* Ids rise with the index: the dead close ranks in order and the born are appended, so an id is found by bisection. */
typedef struct hk_state {
  double t;  /* s */
  double *X; /* size doubles, one allocation: x n x 3, v n x 3, the channels one after the other, the work in J */
  size_t width, size; /* channel numbers per particle; size = (6 + width) n + 1 */
  hk_model model;     /* points to the arrays below */
  double *mass, *inverse_mass;
  uint32_t *id, *group;
  uint8_t *pin;
  uint32_t next_id;
  hk_channel *channel;
  uint32_t (*edge)[2], (*triangle)[3];
  hk_view view; /* of X at t, for everyone: plugins get it with their host and selection */
} hk_state;

/* ---- state.c ---- */

hk_status hk_state_open(hk_state *, const hk_scene *, hk_error *error);
void hk_state_close(hk_state *);
void hk_state_refresh(hk_state *); /* model, size and view after t, n or an array changed */
bool hk_state_index(const hk_state *, uint32_t id, uint32_t *index); /* false: no such particle now */
double hk_state_extent(const hk_state *); /* m, longest side of the box around the particles; 1 when there is none */
void hk_state_perturb(hk_state *, double distance, uint64_t seed); /* free particles, at random, by up to that, m */
double hk_state_kinetic(const hk_state *, const double *X);        /* J, of what can move */
/* Masses of 0 need a pin. After the pins are open. */
hk_status hk_state_check_masses(const hk_state *, hk_error *error);

/* ---- snapshot.c: X with who is in it, kept as the last good state ---- */

typedef struct hk_snapshot {
  double t;
  size_t n, size, capacity; /* capacity of X in doubles, and of id and mass in particles: as large as needed */
  double *X;
  uint32_t *id;
  double *mass;
} hk_snapshot;

hk_status hk_snapshot_take(hk_snapshot *, const hk_state *, hk_error *error);
void hk_snapshot_free(hk_snapshot *);

/* ---- particle_set.c: who takes the place of the particles, after births and deaths or from a file ---- */

typedef struct hk_particle_set {
  size_t n;
  double *X; /* (6 + width) n + 1 */
  double *mass;
  uint32_t *id; /* rising */
  uint32_t *group;
} hk_particle_set;

bool hk_particle_set_allocate(hk_particle_set *, size_t n, size_t width); /* false: no memory; free what there is */
void hk_particle_set_free(hk_particle_set *);
/* Old index i becomes map[i] (UINT32_MAX: gone). Takes the set's arrays, also when it fails. What else has indices is
 * the caller's to remap: pins, plugins, matrices. */
hk_status hk_state_adopt(hk_state *, const uint32_t *map, hk_particle_set *, hk_error *error);

/* ---- population.c: births and deaths that a source asks for ---- */

typedef struct hk_population_change {
  hk_population population; /* first member: what the source is given */
  hk_state *state;
  const hk_scene *scene;
  const hk_instance *source;
  size_t births, capacity;
  hk_birth *birth;
  double *channel; /* births x width */
  size_t channel_capacity;
  size_t deaths;
  bool *dies; /* n, NULL while nobody does */
} hk_population_change;

hk_population_change hk_population_begin(hk_state *, const hk_scene *, const hk_instance *source);
/* All of it at once; *map, from old indices to new, is the caller's to free. */
hk_status hk_population_apply(hk_population_change *, uint32_t **map, hk_error *error);
void hk_population_end(hk_population_change *);

/* ---- pins.c ---- */

typedef struct hk_pin_state {
  const hk_pin_spec *spec;
  bool released;
  size_t count;
  uint32_t *index;
  double *origin; /* count x 3, start positions */
} hk_pin_state;

typedef struct hk_pins {
  size_t count;
  hk_pin_state *item;
  bool has_paths, has_slides; /* of those that are not released */
} hk_pins;

hk_status hk_pins_open(hk_pins *, const hk_scene *, hk_state *, hk_error *error);
void hk_pins_close(hk_pins *);
void hk_pin_project(const hk_pin_spec *, double vector[3]); /* keeps what a sliding pin allows */
hk_status hk_pins_impose(const hk_pins *, double t, double *x, double *v, hk_error *error); /* paths and slides */
void hk_pins_filter(const hk_pins *, double *vector);                                       /* n x 3 */
double hk_pins_power(const hk_pins *, const double *F, const double *v); /* W, of what moves pinned particles */
void hk_pins_remap(hk_pins *, const uint32_t *map);
bool hk_pins_due(const hk_pins *, double t); /* something is let go at t */
void hk_pins_release(hk_pins *, hk_state *); /* what is let go at the state's time */
/* Acceleration of a path, m/s^2: differences of its velocity when the script gives one, else second differences. */
hk_status hk_pin_acceleration(const hk_pin_spec *, double t, double out[3], hk_error *error);

#endif
