/* hooke's plugin interface: the part of the engine that plugins see. This page and that of a kind (core/plugin/force.h,
 * ...) are what one needs for a plugin of it; what it may offer beside that are facets (core/plugin/facets).
 *
 * A plugin is one shared object with one exported constant, `hk_plugin_main`. The host reads that constant without
 * running plugin code, checks `abi`, fills an instance by the parameter table and calls the functions of the kind's
 * table. All other symbols of a plugin are static.
 *
 * Units are SI. Arrays "n x 3" are particle-major: x[3*i + c] is component c of particle i. Particles are addressed by
 * index 0 <= i < n; an index changes when particles are born or die, an id never does. Lists of particles and tuples in
 * an instance are kept up to date by the host, which calls `topology` after every change.
 *
 * Every pointer handed to a plugin is owned by the host and valid during the call only, unless its comment says
 * otherwise. A function that can fail returns hk_status and makes its message where the cause is known:
 *     return host->fail(host, HK_BAD_PARAM, "rest: %g m is negative", rest);
 * A plugin never ends the process: one that crashes or calls exit() is named, and the run ends with code 2; --state has
 * the state of the last frame then. A failure without a message gets one, and a constant that breaks this contract is
 * refused in one sentence (core/engine/contract).
 * A failed call changes nothing, unless its comment says otherwise. Inside a step a plugin must not allocate, print or
 * access files (except outputs). Published structs grow at their end only. */
#ifndef HK_PLUGIN_H
#define HK_PLUGIN_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/plugin/lists.h"

#define HK_ABI_MAJOR 3 /* another major is refused */
#define HK_ABI_MINOR 5 /* a plugin with a newer minor than the host's is refused */
#define HK_ABI ((HK_ABI_MAJOR << 16) | HK_ABI_MINOR)

#if defined(__GNUC__)
#define HK_EXPORT __attribute__((visibility("default")))
#define HK_PRINTF(string, first) __attribute__((__format__(__printf__, string, first)))
#else
#define HK_EXPORT
#define HK_PRINTF(string, first)
#endif

typedef enum hk_status {
  HK_OK = 0,
  HK_BAD_PARAM,     /* a value the user gave is wrong */
  HK_FAILED,        /* the plugin cannot do what it was asked */
  HK_NO_MEMORY,     /* an allocation failed */
  HK_IO,            /* a file could not be read or written */
  HK_NOT_FINITE,    /* NaN or infinity appeared: the run has diverged */
  HK_NOT_CONVERGED, /* a solver stopped above its tolerance and the step cannot be made smaller */
  HK_SCRIPT,        /* a function of the scene's script failed */
  HK_INTERRUPTED    /* the user asked to stop */
} hk_status;

typedef enum hk_kind {
  HK_FORCE,
  HK_CONSTRAINT,
  HK_CORRECTOR,
  HK_SOURCE,
  HK_INTEGRATOR,
  HK_SOLVER,
  HK_OUTPUT,
  HK_SERVICE,
  HK_KINDS
} hk_kind;

/* ---- Parameters ------------------------------------------------------------------------------------------------ */

typedef struct hk_function hk_function; /* of the scene's script */

/* The numbers that a parameter may be; left out: any that is finite. */
typedef struct hk_range {
  enum { HK_NO_LIMITS, HK_LEAST_INCLUDED, HK_LEAST_EXCLUDED } kind;
  double least, most; /* the largest is included */
} hk_range;

#define HK_WITHIN(least, most)                                                                                         \
  { HK_LEAST_INCLUDED, least, most }
#define HK_ABOVE_TO(least, most)                                                                                       \
  { HK_LEAST_EXCLUDED, least, most }
#define HK_AT_LEAST(least) HK_WITHIN(least, INFINITY)
#define HK_ABOVE(least) HK_ABOVE_TO(least, INFINITY)

/* The member of an instance that a row fills: a pointer into an instance that would lie at HK_BASE, so that the
 * compiler compares its type with that of the row's member. */
#define HK_BASE 4096
#define HK_AT(instance, member) (&((instance *)HK_BASE)->member)

enum {                  /* hk_param.flags */
       HK_REQUIRED = 1, /* the user must give a value */
       HK_OPTIONAL = 2, /* when not given: NAN, a vector of NAN, an empty list */
       HK_TIMED = 4,    /* the user may give a Lua function of t (number, vector); updated before every evaluation */
       HK_NOT_EMPTY = 8 /* of lists of which left out means all: the user may not give an empty one */
};

/* One parameter. A table ends with {0}.
 *     {"d", "N s/m", "drag of one particle", .number = HK_AT(drag, d), .initial = {0.1}, .limits = HK_AT_LEAST(0)} */
typedef struct hk_param {
  const char *name;
  const char *unit; /* "N/m"; "" when there is none */
  const char *help; /* one line, no full stop */
  /* What it fills, one of these: */
  double *number; /* finite */
  int64_t *integer;
  bool *boolean;
  const char **string; /* NULL when not given and `text` is NULL; owned by the host as long as the instance */
  int *choice;         /* the position of the value in `choices` */
  double (*vector)[3];
  hk_numbers *numbers;
  hk_tuples *particles, *edges, *triangles; /* core/plugin/lists.h */
  hk_tuples *tetrahedra;                    /* or edges with two triangles */
  hk_per_tuple *per_tuple;      /* a number, or one per tuple of the list that `list` names; NULL: the table's first */
  const hk_function **function; /* for host->call; NULL when not given */
  double initial[3];            /* default; scalars use the first number */
  hk_range limits;              /* of every number in it */
  unsigned flags;
  union {
    const char *text;    /* of a string: its default, or NULL */
    const char *choices; /* "first|second|third" */
    const char *list;
    const char *signature; /* "function(t, x, id) -> f", t first and a particle's id last, or t alone */
  };
} hk_param;

/* ---- Evolving state of a plugin -------------------------------------------------------------------------------- */

/* `count` items of a plugin's own type. Only host->resize changes its length. */
typedef struct hk_array {
  size_t count;
  void *item;
} hk_array;

enum {                   /* hk_field.flags */
       HK_SCRATCH = 1,   /* memory whose content is not needed after the step; not saved */
       HK_PUBLISHED = 2, /* per_particle: other plugins find it in hk_model.published */
       HK_COUNTED = 4 /* array: the plugin alone sets its count; a checkpoint with another one is not of this scene */
};

/* The evolving data of an instance: the host allocates the arrays before `create`, resizes and remaps them when
 * particles are born or die, and writes them to checkpoints. A table ends with {0}.
 *     {"slopes", .state = HK_AT(bdf, slopes), .width = 2, .flags = HK_SCRATCH}
 *     {"flow", .per_tuple = HK_AT(plastic, flow), .list = "edges", .width = 2} */
typedef struct hk_field {
  const char *name;
  /* What it keeps, one of these: */
  double *number;
  int64_t *integer;
  double **per_particle; /* n x width, zeroed at birth */
  double **state;        /* width vectors of the shape of X (system->size doubles each); void when n changes */
  hk_array *array;       /* items of `width` bytes, which should name particles by id, which never changes */
  size_t width;
  unsigned flags;
  /* Minor 1: internal variables of elements (facets/internal.h), count x width of the tuples in the list that `list`
   * names, or in the table's first; zeroed before `create`, and moved with their tuples when others lose a particle. */
  double **per_tuple;
  const char *list;
} hk_field;

/* ---- The view of the state --------------------------------------------------------------------------------------- */

typedef struct hk_host hk_host;   /* core/plugin/host.h: messages, memory, threads, random numbers, services */
typedef struct hk_model hk_model; /* core/plugin/model.h: masses, ids, groups, pins, channels, edges, elements */

typedef struct hk_view {
  double t;              /* s */
  size_t n;              /* particles */
  const double *x;       /* n x 3, m */
  const double *v;       /* n x 3, m/s */
  const double *y;       /* channels, see hk_channel; NULL when there are none */
  const hk_model *model; /* at the same address throughout the run */
  const hk_host *host;
  size_t acting;          /* number of particles that the force acts on */
  const uint32_t *active; /* their indices in rising order; NULL: all particles */
  const bool *is_active;  /* n; NULL: all particles */
  double *power;          /* W; add the power of non-conservative parts to it (HK_POWER); may be NULL */
} hk_view;

/* ---- Facets ------------------------------------------------------------------------------------------------------ */

/* What a plugin offers beside the table of its kind: one small table for one purpose, such as Jacobians for implicit
 * methods. core/plugin/facets has a header for each: its id, a name with a version as "implicit/1", its table, whose
 * first member is `size`, and the macro that makes an entry of the list, which ends with a NULL id:
 *     .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian), HK_PARTS_FACET(.touch = touch))
 */
typedef struct hk_facet {
  const char *id;
  const void *table;
} hk_facet;

#define HK_FACETS(...) ((const hk_facet[]){__VA_ARGS__, {NULL, NULL}})
#define HK_FACET(id, type, ...)                                                                                        \
  {                                                                                                                    \
    id, &(const type) { .size = sizeof(type), __VA_ARGS__ }                                                            \
  }

/* ---- The plugin ------------------------------------------------------------------------------------------------ */

typedef struct hk_plugin {
  unsigned abi; /* HK_ABI; first in every version */
  hk_kind kind;
  const char *name;      /* as in its file name */
  const char *summary;   /* one line: what it does, with the formula */
  const char *reference; /* paper and equation, or "" */
  size_t instance_size;
  const hk_param *params; /* NULL: none */
  const hk_field *fields; /* NULL: none */
  /* Called at the start of the run, when parameters and fields are set; view is the start state. May be NULL. */
  hk_status (*create)(void *self, const hk_host *host, const hk_view *view);
  void (*destroy)(void *self, const hk_host *host); /* called once per create, even a failed one; may be NULL */
  /* Called after indices in parameters and the number of particles have changed: rebuilds data derived from them. May
   * be NULL. */
  hk_status (*topology)(void *self, const hk_view *view);
  /* The kind's table. Its first member is `size`, the size of the table in the plugin's version of this header: for the
   * host, members beyond it are NULL or 0. */
  union {
    const struct hk_force *force;
    const struct hk_constraint *constraint;
    const struct hk_corrector *corrector;
    const struct hk_source *source;
    const struct hk_integrator *integrator;
    const struct hk_solver *solver;
    const struct hk_output *output;
    const struct hk_service *service;
  };
} hk_plugin;

extern HK_EXPORT const hk_plugin hk_plugin_main;

#include "core/plugin/kinds.h"

#endif
