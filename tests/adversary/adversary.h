/* Random scenes on which hooke's verdict is put to the test. A family makes a scene from a seed; it is written in Lua
 * for hooke, and integrated in long double here, by a method and by laws of force that share no code with hooke. Both
 * sides get the same doubles. What hooke says of its run is then compared with the error that the run has. */
#ifndef HK_TEST_ADVERSARY_H
#define HK_TEST_ADVERSARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef long double adv_real;

enum { ADV_PARTICLES = 8, ADV_EDGES = 12, ADV_FORCES = 10, ADV_PINS = 4, ADV_SIZE = 3 };

/* ---- Functions of time (waves.c) ---- */

typedef enum adv_shape {
  ADV_CONSTANT, /* b */
  ADV_SINE,     /* b + a sin(w (t + t0) + t1) */
  ADV_PULSE,    /* b, and a more from t0 to t1 */
  ADV_TRAIN,    /* b, and a more for t1 in each period w, the first at t0 */
  ADV_RAMP,     /* b, b + a (t - t0) from t0 on, and constant from t1 on */
  ADV_JUMP,     /* b, and a more from t0 on */
  ADV_BUMP,     /* b + a exp(-((t - t0)/w)^2) */
} adv_shape;

typedef struct adv_wave {
  adv_shape shape;
  double a, b, w, t0, t1;
} adv_wave;

/* base + along wave(t) */
typedef struct adv_vector {
  double base[3], along[3];
  adv_wave wave;
} adv_vector;

/* Value and rate at t; of a wave in pieces, those of the piece in which `inside` lies. */
adv_real adv_wave_at(const adv_wave *, adv_real t, adv_real inside, adv_real *rate);
/* Calls `cut` with the times in (0, end) between which the wave is smooth and not narrow. */
void adv_wave_cuts(const adv_wave *, adv_real end, void (*cut)(void *, adv_real), void *context);
/* Writes "function NAME(t) ... end", and NAME_rate likewise. */
void adv_wave_write(const adv_wave *, const char *name, FILE *);

/* ---- Scenes ---- */

typedef enum adv_law {
  ADV_GRAVITY,
  ADV_DRAG,
  ADV_SPRINGS,
  ADV_ROPES,
  ADV_CUBIC,
  ADV_CENTRAL,
  ADV_MAGNETIC,
  ADV_BARS /* no force: distances that stay as they are, by multipliers (bars.c) */
} adv_law;

typedef struct adv_force {
  adv_law law;
  double from, to; /* s; acts in between */
  unsigned only;   /* bit i: on particle i; 0: on all */
  int edges, edge[ADV_EDGES][2];
  double rest[ADV_EDGES], k, damping; /* springs, ropes, cubic */
  adv_vector vector;                  /* gravity: g; central: centre; magnetic: B */
  adv_wave strength;                  /* central */
  double power, softening;            /* central */
  double amount;                      /* drag, magnetic: per mass (rate, ratio) or per particle (d, charge) */
  bool per_mass;                      /* central, drag, magnetic */
} adv_force;

typedef enum adv_hold { ADV_FIXED, ADV_PATH, ADV_LINE, ADV_PLANE } adv_hold;

typedef struct adv_pin {
  int particle;
  adv_hold hold;
  adv_vector path;
  bool tells_velocity;
  int axis;       /* of the line, or normal of the plane: 0 to 2 */
  double release; /* s */
} adv_pin;

typedef enum adv_kinetics { ADV_NO_CHANNEL, ADV_DECAY, ADV_RELAXATION, ADV_ROBERTSON, ADV_VAN_DER_POL } adv_kinetics;

/* What hooke gets a scene in; the reference keeps to metres, kilograms and seconds. Powers of two, and an offset that
 * leaves every start a double: both sides have the same scene to the last bit. */
typedef struct adv_units {
  double length, mass, time; /* one m, kg, s of the scene in those of hooke */
  double offset[3];          /* m of the scene */
} adv_units;

typedef struct adv_scene {
  int family;
  uint64_t seed;
  int n, forces, pins;
  double mass[ADV_PARTICLES], x[ADV_PARTICLES][3], v[ADV_PARTICLES][3];
  adv_force force[ADV_FORCES];
  adv_pin pin[ADV_PINS];
  adv_kinetics kinetics;
  int size; /* of the channel, 0: none */
  double initial[ADV_SIZE], rate[ADV_SIZE];
  double fps, dt, tol; /* dt, tol: NAN: hooke chooses */
  int frames;          /* behind the start; the scene ends with the last */
  adv_units units;
} adv_scene;

/* Moves starts onto the grid of doubles that the offset leaves. */
void adv_round_to_units(adv_scene *);
/* The scene as hooke gets it, with units of 1. */
void adv_scene_in_units(const adv_scene *, adv_scene *out);

double adv_scene_end(const adv_scene *);
void adv_scene_write(const adv_scene *, double accuracy, FILE *);

/* ---- Families ---- */

typedef struct adv_family {
  const char *name;
  void (*make)(adv_scene *, uint64_t *seed);
} adv_family;

extern const adv_family adv_families[];
extern const int adv_families_count;

void adv_scene_make(adv_scene *, int family, uint64_t seed);

/* ---- The reference (laws.c, reference.c) ---- */

enum { ADV_MODES = ADV_FORCES * ADV_EDGES, ADV_STATE = (6 + ADV_SIZE) * ADV_PARTICLES };

/* What changes only between pieces of time. */
typedef struct adv_system {
  const adv_scene *scene;
  adv_real inside; /* a time in the piece */
  enum { ADV_SLACK, ADV_TAUT, ADV_LOOSE } mode[ADV_MODES];
} adv_system;

/* A rope: stretch and its rate, and the tension that it had if it were taut. */
typedef struct adv_rope {
  adv_real stretch, rate, tension;
} adv_rope;

/* y: positions, velocities, channels; pinned particles are put where they belong. */
void adv_rates(const adv_system *, adv_real t, const adv_real *y, adv_real *dy);
void adv_impose(const adv_system *, adv_real t, adv_real *y);
adv_rope adv_rope_at(const adv_system *, const adv_force *, int edge, adv_real t, const adv_real *y);
/* Adds the forces of all bars to F: multipliers that keep accelerations along bars at -u^2 (bars.c). Of pins, those
 * that stand still and those that slide. */
void adv_add_bars(const adv_system *, const adv_real *y, adv_real *F);
/* The longest step in which nothing can be passed over, from where particles are. */
adv_real adv_longest_step(const adv_system *, adv_real t, const adv_real *y);

typedef struct adv_answer {
  adv_real *x;                                                /* (frames + 1) x n x 3 */
  adv_real *c;                                                /* (frames + 1) x n x size */
  double uncertainty;                                         /* m, largest of all frames, RMS; INFINITY: not reached */
  double growth;                                              /* of a disturbance of the start */
  double extent;                                              /* m, largest RMS distance from the start */
  double channel_extent, channel_change, channel_uncertainty; /* largest value; largest distance from the start */
} adv_answer;

/* False without memory. */
bool adv_answer_make(adv_answer *, const adv_scene *);
void adv_answer_free(adv_answer *);

/* ---- Runs (run.c) and what they amount to (tally.c) ---- */

/* Broken, also where the run was never made: it did not end as a run of hooke can. */
typedef enum adv_end { ADV_BROKEN, ADV_OK, ADV_NOT_OK, ADV_REFUSED, ADV_TOO_LONG } adv_end;

typedef struct adv_run {
  int family;
  uint64_t seed;
  char method[64];
  double accuracy, dt; /* m, NAN: not asked for */
  adv_end end;
  char verdict[24], reason[600];
  double error, bound, uncertainty; /* m; the error is the largest of all frames */
  double last;                      /* m, the error at the end */
  double luck;                      /* m: what the rounding of the start in doubles grows to */
  double channel, of_change;        /* largest error of a channel over its largest value; over its largest change */
} adv_run;

/* Runs `hooke run` on the scene in the folder and measures the error; the run's method and accuracy are given. */
void adv_run_make(adv_run *, const char *hooke, const char *folder, const adv_scene *, const adv_answer *);

bool adv_run_certain(const adv_run *); /* the reference is good enough to judge it */
bool adv_run_wrong(const adv_run *);   /* beyond its bound; a channel: by as much as it is large */
bool adv_run_right(const adv_run *);   /* within its bound; a channel: up to a tenth of its change */
bool adv_run_lucky(const adv_run *); /* right, where the rounding of doubles decides: an alarm is none that is false */

typedef struct adv_options {
  const char *hooke, *families, *methods, *accuracies; /* lists with commas; NULL: all */
  uint64_t seed;
  int cases, runs, jobs;   /* runs: of each scene; 0: every method with every accuracy */
  double dt, tol;          /* in place of the scenes'; 0: hooke's choice, NAN: as they are */
  bool one;                /* the seed is that of a scene */
  bool at_end;             /* judge the last frame alone */
  bool alarms, all, print; /* list the false alarms, all runs; print the scene */
} adv_options;

typedef struct adv_tally {
  int right, wrong, rightly, alarms, near, uncertain, refused, too_long, broken;
} adv_tally;

/* Runs the cases, prints tables and lists; the counts of the runs with an accuracy. False: something was not usable. */
bool adv_measure(const adv_options *, adv_tally *);

/* ---- Random numbers: splitmix64 ---- */

static inline uint64_t adv_next(uint64_t *seed) {
  uint64_t z = *seed += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double adv_uniform(uint64_t *seed, double low, double high);
double adv_log(uint64_t *seed, double low, double high); /* uniform in the logarithm */
int adv_below(uint64_t *seed, int count);
bool adv_chance(uint64_t *seed, double probability);
void adv_direction(uint64_t *seed, double unit[3]);

#endif
