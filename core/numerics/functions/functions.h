/* Functions of time of the script, such as paths of pins and timed parameters: their derivatives, the motions that they
 * make, and where they vary between the times at which a run evaluates them. */
#ifndef HK_FUNCTIONS_H
#define HK_FUNCTIONS_H

#include "core/engine/state/state.h"

enum { HK_COLUMNS = 3, HK_RESULTS = 2 * HK_COLUMNS }; /* of the numbers that a function returns, at most */

/* ---- arguments.c ---- */

size_t hk_function_arguments(const hk_param *); /* number of arguments of a HK_FUNCTION, by its text */

/* ---- gust.c: smooth irregular functions of time ---- */

enum { HK_GUST_WAVES = 32 };

typedef struct hk_gust {
  size_t columns; /* 1 or 3 */
  double mean[HK_COLUMNS];
  double fastest; /* s, half of the shortest period: nothing happens within less */
  struct hk_gust_wave {
    double frequency, size, phase; /* 1/s; as the mean; turns */
  } wave[HK_COLUMNS][HK_GUST_WAVES];
} hk_gust;

/* `amplitude` is the RMS of the deviation from the mean; periods are between shortest and longest, s. */
void hk_gust_make(hk_gust *, size_t columns, const double mean[HK_COLUMNS], const double amplitude[HK_COLUMNS],
                  double shortest, double longest, uint64_t seed);
void hk_gust_at(const hk_gust *, double t, double out[HK_COLUMNS]);

/* ---- derivative.c: derivatives by differences (Ridders 1982) ---- */

typedef struct hk_derivative {
  double value[HK_COLUMNS];
  double error; /* estimate, of the length of the vector `value`; 0: nothing is known to be wrong */
  double step;  /* s, smallest distance in time of the differences */
} hk_derivative;

typedef struct hk_differences { /* how a function is differentiated */
  double step;                  /* s, where the search of a good step begins, and mostly ends */
  double usual;                 /* the error with that step at most times, by the function's own roundings */
} hk_differences;

/* Looks for the step that is best between begin and end. */
hk_differences hk_derivative_prepare(const hk_function *, int order, size_t column, double begin, double end);
/* Derivative of order 1 or 2, at t, of three of the numbers that the function returns, from number `column` on. `at`
 * has the numbers at t. The result depends on the arguments alone. HK_SCRIPT: the function fails everywhere beside t.
 */
hk_status hk_derivative_find(const hk_function *, int order, size_t column, const hk_differences *, double t,
                             const double at[HK_RESULTS], hk_derivative *, hk_error *error);

/* ---- path.c: a function of time of three numbers, with its derivatives, in a run ---- */

typedef struct hk_path {
  const hk_function *function; /* t -> three numbers [, their derivatives] */
  const char *name, *where;    /* "path" or "rotation"; script line */
  double end;                  /* s: needed up to there */
  bool gives_velocity;         /* at t = 0 */
  hk_differences by[2];        /* for velocities and accelerations; step 0: none was needed yet */
  double at;                   /* s, time of `value`; NAN: none */
  double value[HK_RESULTS];    /* with the derivatives */
  double speed_error; /* largest estimated error of a derivative so far; 0: the function gives its derivatives */
} hk_path;

/* `end` (s): the path is needed up to there. The function, `name` and `where` must outlive the path. */
void hk_path_open(hk_path *, const hk_function *, const char *name, const char *where, double end);
/* Finds value and derivative at t, unless they are those of the last call: a step asks for its ends, an implicit one
 * for its stages, several times. */
hk_status hk_path_find(hk_path *, double t, hk_error *error);
/* Second derivative: differences of the first when the function gives one, else second differences. */
hk_status hk_path_acceleration(hk_path *, double t, double out[HK_COLUMNS], hk_error *error);

/* ---- motion.c: the motion of the particles of a pin, of functions of the script ---- */

typedef struct hk_scripted_motion {
  hk_pin_motion motion;     /* first member */
  hk_path offset, rotation; /* m; rad. function->call NULL: 0 at all times */
  double reach;             /* m, largest distance from the center of a particle that it moves */
} hk_scripted_motion;

/* Gives the pins with a path their motions, which the pins free, up to `end` (s). */
hk_status hk_motions_open(hk_pins *, double end, hk_error *error);
/* As hk_path_open. */
void hk_motion_open(hk_scripted_motion *, const hk_function *offset, const hk_function *rotation,
                    const double center[3], const char *where, double end);
/* That of a pin whose motion is of hk_motions_open. */
static inline const hk_scripted_motion *hk_scripted_motion_of(const hk_pin_motion *motion) {
  return (const hk_scripted_motion *)(const void *)motion;
}
void hk_rotation(const double r[3], double R[9]); /* exp([r]), by rows */

/* ---- samples.c: samples of a function of time, dense where it varies ---- */

typedef struct hk_sample {
  double t;
  double value[HK_COLUMNS];
} hk_sample;

typedef struct hk_samples {
  size_t count, capacity, calls;
  hk_sample *item;          /* in the order of time */
  double range[HK_COLUMNS]; /* largest less smallest value; 0: constant */
  double spacing;           /* s: what lasts longer than this was hit */
  double narrowest;         /* s: to this a jump is cornered */
} hk_samples;

/* From begin to end (s), one in each of `parts` equal parts; `most` calls with those where the function varies. */
void hk_samples_take(hk_samples *, const hk_function *, double begin, double end, size_t parts, size_t most);
/* Where the function jumps: the times of the samples before and after, s, in *jump, at most `room`; how many there are.
 */
size_t hk_samples_jumps(const hk_samples *, double (*jump)[2], size_t room);
void hk_samples_free(hk_samples *);

/* ---- rapid.c: where a function varies between the times at which it was evaluated ---- */

enum { HK_PIECES = 500 };

typedef struct hk_rapid {
  bool varies;     /* somewhere */
  double shortest; /* s, shortest time in which it does: the length of a pulse, half a period; INFINITY: it does not */
  size_t pieces;
  double piece[HK_PIECES]
              [2]; /* s, begin and end of every time in which it varies; in the order in which they were found */
  bool more;       /* there are more pieces */
} hk_rapid;

typedef double hk_gap(const void *context, double t); /* s, between two evaluations near t */

/* `found` is zeroed before. */
void hk_rapid_find(hk_rapid *found, const hk_samples *, hk_gap *, const void *context);

#endif
