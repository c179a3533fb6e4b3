/* The state of a scene: the vector X = (x, v, channels, work) and the data of the particles (masses, ids, groups,
 * pins).
 */
#ifndef HK_STATE_H
#define HK_STATE_H

#include "core/engine/host/host.h"

typedef struct hk_pin_spec {
  hk_pin kind;
  size_t count;
  uint32_t *id;   /* particles */
  double axis[3]; /* HK_PIN_LINE: along; HK_PIN_PLANE: normal; unit length */
  /* HK_PIN_PATH, one at least: t -> x, y, z [, vx, vy, vz], offsets from the start position; t -> rotation vector
   * [, its rate], axis times angle, about `center`, which moves with the offset. call == NULL: none. */
  hk_function path, rotation;
  double center[3]; /* m; NAN: the mean of the start positions */
  double fastest;   /* s, shortest time in which they change, as the script declares; 0: not declared */
  double release;   /* s, time of the pin's release; infinity: never */
  char *where;      /* script line */
} hk_pin_spec;

typedef struct hk_channel_spec {
  char *name;
  size_t size;
  double *initial;  /* size numbers, initial values of particles without values of their own */
  double *value;    /* capacity x size, per particle, in the order of ids */
  double decay;     /* rate r of dy/dt = r y, or NAN */
  double accuracy;  /* accuracy asked for, in the channel's unit (RMS over the particles); NAN: none */
  hk_function rate; /* t, id, y... -> dy...; call == NULL: none */
} hk_channel_spec;

/* What a state is made of. The position in the arrays of particles is id - 1. */
typedef struct hk_particles {
  size_t n;
  double *position, *velocity, *mass; /* n x 3, x 3, x 1 */
  uint32_t *group;
  size_t groups;
  char **group_name; /* group 0 is "default" */
  size_t channels;
  hk_channel_spec *channel;
  size_t edges, triangles;
  uint32_t (*edge)[2];     /* ids */
  uint32_t (*triangle)[3]; /* ids */
  size_t pins;
  hk_pin_spec *pin;
  size_t riders, skins;
  hk_rider *rider;    /* with ids in the place of indices */
  hk_body_skin *skin; /* likewise */
} hk_particles;

/* Deaths preserve the order of the other particles and births, whose ids increase, are appended. The particles of the
 * start are in the order of their ids, or in a better one. */
typedef struct hk_state {
  const hk_particles *start; /* what it was made of; its arrays of particles may have been freed since */
  double t;                  /* s */
  hk_block *numbers;         /* memory of X, spare, masses: loops are slower where it is not aligned to cache lines */
  double *X;     /* size doubles, one allocation: x n x 3, v n x 3, the channels one after the other, the work in J */
  double *spare; /* the same memory again, for methods with HK_USES_SPARE; NULL: not needed */
  size_t width, size; /* channel numbers per particle; size = (6 + width) n + 1 */
  hk_model model;     /* points to the arrays below */
  hk_partition partition;
  double *mass, *inverse_mass;
  uint32_t *id, *group;
  uint8_t *pin;
  uint32_t *by_id; /* indices in the order of ids; NULL: ids increase with the index */
  uint32_t next_id;
  size_t room; /* the arrays of particles are for up to so many */
  hk_channel *channel;
  uint32_t (*edge)[2], (*triangle)[3];
  hk_rider *rider;
  hk_body_skin *skin;
  bool *inside;   /* as hk_model has it; NULL: there are no bodies */
  size_t insides; /* its length, the particles of the last remapping */
  hk_view view;   /* the view of X at t, from which the views of plugins are made with their host and selection */
} hk_state;

/* ---- state.c ---- */

/* places: the index of each particle, in the order of ids, in malloc's memory that the state frees; NULL: that order.
 */
hk_status hk_state_open(hk_state *, const hk_particles *, uint32_t *places, hk_error *error);
void hk_state_close(hk_state *);
void hk_state_refresh(hk_state *);    /* updates model, size and view after t, n or an array changed */
void hk_state_point(hk_state *);      /* the same, where the inverse masses are right */
bool hk_state_open_spare(hk_state *); /* false: no memory */
void hk_state_exchange(hk_state *);   /* `spare` is now X */
bool hk_state_index(const hk_state *, uint32_t id, uint32_t *index); /* false: no particle has this id at present */
double hk_state_extent(const hk_state *); /* m, longest side of the bounding box of the particles; 1 when that is 0 */
/* J, of the particles that are not fixed or scripted */
double hk_state_kinetic(const hk_state *, const double *X);
/* The first `size` numbers of X into *copy, which has room for *room and grows. False: no memory. */
bool hk_state_copy(const hk_state *, double **copy, size_t *room, size_t size);
/* Refuses particles of mass 0 without a pin; to be called after hk_pins_open. */
hk_status hk_state_check_masses(const hk_state *, hk_error *error);

/* ---- riders.c ---- */

hk_status hk_riders_open(hk_state *, hk_error *error); /* after hk_state_open, before the pins */
void hk_riders_follow(const hk_model *, double *x);    /* n x 3: riders get the combinations of their carriers */
void hk_riders_gather(const hk_model *, double *F);    /* n x 3: what acts on riders acts on their carriers */
void hk_riders_gather_bounds(const hk_model *, double (*)[6]); /* n: the same of bounds of stiffness */
/* After births and deaths. HK_FAILED: a rider has lost a carrier. */
hk_status hk_riders_remap(hk_state *, const uint32_t *map, hk_error *error);

/* ---- motion.c: the rigid motion of the particles of a pin ---- */

/* What started at p is at center + offset + turn (p - center). What knows the motion installs `find` and `bend`
 * (core/numerics/functions). */
typedef struct hk_pin_motion hk_pin_motion;
struct hk_pin_motion {
  hk_status (*find)(hk_pin_motion *, double t, hk_error *); /* offset to spin become those of t */
  hk_status (*bend)(hk_pin_motion *, double t, hk_error *); /* the accelerations, too */
  bool turns;                                               /* false: turn, spin and twist are not read */
  double center[3];                                         /* m, at the start */
  double offset[3], velocity[3], turn[9], spin[3];          /* m, m/s; by rows; rad/s */
  double push[3], twist[3];                                 /* accelerations, m/s^2 and rad/s^2 */
  double speed_error; /* m/s, estimated error of the velocity of any particle so far; 0: there is none */
};

void hk_pin_motion_place(const hk_pin_motion *, const double origin[3], double x[3], double v[3]);
void hk_pin_motion_acceleration(const hk_pin_motion *, const double origin[3], double a[3]);

/* ---- pins.c ---- */

typedef struct hk_pin_state {
  const hk_pin_spec *spec;
  bool released;
  size_t count;
  uint32_t *index;
  double *origin;        /* count x 3, start positions */
  hk_pin_motion *motion; /* HK_PIN_PATH, in malloc's memory, installed before the first step; others NULL */
} hk_pin_state;

typedef struct hk_pin_place {
  uint32_t particle, pin, member; /* the member-th particle of a pin */
} hk_pin_place;

typedef struct hk_pins {
  size_t count;
  hk_pin_state *item;
  size_t places;
  hk_pin_place *place;        /* the particles of paths and slides, rising */
  bool has_paths, has_slides; /* a pin that is not released has a path, or slides */
} hk_pins;

hk_status hk_pins_open(hk_pins *, hk_state *, hk_error *error);
void hk_pins_close(hk_pins *);
void hk_pin_project(const hk_pin_spec *, double vector[3]); /* projects onto the directions that a sliding pin allows */
void hk_pins_filter(const hk_pins *, double *vector);       /* n x 3 */
hk_status hk_pins_find(const hk_pins *, double t, hk_error *error); /* where paths are at t, for hk_pins_impose */
/* Of the particles begin to end - 1, where `has_paths` or `has_slides`: puts them on paths and slides; projects a
 * vector (n x 3) onto the directions of slides; W, the power of the pins on scripted particles. */
void hk_pins_impose(const hk_pins *, size_t begin, size_t end, double *x, double *v);
void hk_pins_slide(const hk_pins *, size_t begin, size_t end, double *vector);
double hk_pins_power(const hk_pins *, size_t begin, size_t end, const double *F, const double *v);
void hk_pins_remap(hk_pins *, const uint32_t *map);
double hk_pins_speed_error(const hk_pins *);        /* m/s, the largest of all paths */
bool hk_pins_release_at(const hk_pins *, double t); /* a pin is released at t */
void hk_pins_release(hk_pins *, hk_state *);        /* releases the pins that are due at the state's time */

#endif
