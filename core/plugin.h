/* hooke's plugin interface: the part of the engine that plugins see. The contract of each kind is in a header of its
 * own (core/plugin/force.h, ...), all of which this one includes.
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
 * refused in one sentence (core/contract).
 * A failed call changes nothing, unless its comment says otherwise. Inside a step a plugin must not allocate, print or
 * access files (except outputs). Published structs grow at their end only. */
#ifndef HK_PLUGIN_H
#define HK_PLUGIN_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HK_ABI_MAJOR 2 /* another major is refused */
#define HK_ABI_MINOR 0 /* a plugin with a newer minor than the host's is refused */
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

/* `count` tuples of `arity` particles: member c of tuple k is index[arity*k + c]. The members of one tuple differ. */
typedef struct hk_tuples {
  size_t count;
  unsigned arity; /* 1 to 4; set also where the list is empty */
  const uint32_t *index;
} hk_tuples;

static inline const uint32_t *hk_tuple(const hk_tuples *t, size_t k) { return t->index + t->arity * k; }

/* One number for all tuples (count 1) or one number per tuple. When HK_OPTIONAL and not given: count 0. */
typedef struct hk_per_tuple {
  size_t count;
  double *value;
} hk_per_tuple;

static inline double hk_tuple_value(const hk_per_tuple *p, size_t k) { return p->value[p->count > 1 ? k : 0]; }

typedef struct hk_numbers {
  size_t count;
  const double *value;
} hk_numbers;

/* The field that a parameter fills, at `offset` of the instance. */
typedef enum hk_type {
  HK_NUMBER,     /* double; finite */
  HK_INTEGER,    /* int64_t */
  HK_BOOLEAN,    /* bool */
  HK_STRING,     /* const char *, NULL when not given and `text` is NULL; owned by the host as long as the instance */
  HK_CHOICE,     /* int: the position of the value in `text`, "first|second|third"; the default is `initial` */
  HK_VECTOR,     /* double[3] */
  HK_NUMBERS,    /* hk_numbers */
  HK_PARTICLES,  /* hk_tuples of arity 1 */
  HK_EDGES,      /* hk_tuples of arity 2 */
  HK_TRIANGLES,  /* hk_tuples of arity 3 */
  HK_TETRAHEDRA, /* hk_tuples of arity 4: tetrahedra, edges with two triangles */
  HK_PER_TUPLE,  /* hk_per_tuple: a number, or one per tuple of the list that `text` names; NULL: the table's first */
  HK_FUNCTION    /* const hk_function *: for host->call; NULL when not given */
} hk_type;

enum {                  /* hk_param.flags */
       HK_REQUIRED = 1, /* the user must give a value */
       HK_OPTIONAL = 2, /* when not given: NAN, a vector of NAN, an empty list */
       HK_TIMED = 4,    /* the user may give a Lua function of t (number, vector); updated before every evaluation */
       HK_ABOVE_MIN = 8 /* min itself is refused as well */
};

/* One parameter. `min` and `max` hold for every number in it; both 0 means no limit. A table ends with a NULL name. */
typedef struct hk_param {
  const char *name;
  const char *unit; /* "N/m"; "" when there is none */
  const char *help; /* one line, no full stop */
  hk_type type;
  double initial[3]; /* default; scalars use the first number */
  double min, max;
  size_t offset; /* offsetof(instance, field) */
  unsigned flags;
  const char *text; /* HK_STRING: default or NULL; HK_CHOICE: the choices; HK_PER_TUPLE: the name of the list;
                       HK_FUNCTION: "function(t, x, id) -> f", t first and a particle's id last, or t alone */
} hk_param;

/* ---- Evolving state of a plugin -------------------------------------------------------------------------------- */

/* `count` items of a plugin's own type. Only host->resize changes its length. */
typedef struct hk_array {
  size_t count;
  void *item;
} hk_array;

typedef enum hk_field_type {
  HK_FIELD_NUMBER,       /* double */
  HK_FIELD_INTEGER,      /* int64_t */
  HK_FIELD_PER_PARTICLE, /* double *: n x width, zeroed at birth */
  HK_FIELD_STATE, /* double *: width vectors of the shape of X (system->size doubles each); void when n changes */
  HK_FIELD_ARRAY  /* hk_array of items of `width` bytes; items should name particles by id, which never changes */
} hk_field_type;

enum {                  /* hk_field.flags */
       HK_SCRATCH = 1,  /* memory whose content is not needed after the step; not saved */
       HK_PUBLISHED = 2 /* HK_FIELD_PER_PARTICLE: other plugins find it in hk_model.published */
};

/* The evolving data of an instance: the host allocates the arrays before `create`, resizes and remaps them when
 * particles are born or die, and writes them to checkpoints. A table ends with a NULL name. */
typedef struct hk_field {
  const char *name;
  hk_field_type type;
  size_t width;
  size_t offset;
  unsigned flags;
} hk_field;

/* ---- The view of the state --------------------------------------------------------------------------------------- */

typedef struct hk_host hk_host;
typedef struct hk_function hk_function; /* of the scene's script */
typedef struct hk_model hk_model;       /* core/plugin/model.h: masses, ids, groups, pins, channels, edges, elements */

typedef struct hk_view {
  double t;        /* s */
  size_t n;        /* particles */
  const double *x; /* n x 3, m */
  const double *v; /* n x 3, m/s */
  const double *y; /* channels, see hk_channel; NULL when there are none */
  const hk_model *model; /* at the same address throughout the run */
  const hk_host *host;
  size_t acting;          /* number of particles that the force acts on */
  const uint32_t *active; /* their indices in rising order; NULL: all particles */
  const bool *is_active;  /* n; NULL: all particles */
  double *power;          /* W; add the power of non-conservative parts to it (HK_POWER); may be NULL */
} hk_view;

/* Host services, one table per instance. */
struct hk_host {
  unsigned abi;
  /* Records the message ("%s" etc. as printf) under the instance's label and script line; returns `status`. */
  hk_status (*fail)(const hk_host *, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
  /* A warning: shown once per text, listed in the summary. */
  void (*warn)(const hk_host *, const char *format, ...) HK_PRINTF(2, 3);
  /* Zeroed memory, 64-byte aligned; NULL: no memory. The host frees memory that is not released after `destroy`. */
  void *(*allocate)(const hk_host *, size_t bytes);
  void (*release)(const hk_host *, void *memory);
  /* Calls body(context, begin, end, chunk) for the chunks [chunk*grain, ...) of 0..count, on several threads. How the
   * range is cut depends on count and grain alone, so a sum over chunks in order is the same for any thread count. A
   * body may call it too: that loop runs in the body's own thread, its chunks in order. */
  void (*parallel_for)(const hk_host *, size_t count, size_t grain,
                       void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);
  /* Uniform in [0, 1), 53 bits, from the instance's own stream (seeded by --seed, kind and label; in checkpoints). */
  double (*random)(const hk_host *);
  /* Outputs: the path of a file of this run, below its output folder, where folders in `name` are created. HK_IO when
   * that fails, HK_BAD_PARAM when `name` is absolute, has "..", or is another output's: ask early, in `open`. */
  hk_status (*path)(const hk_host *, const char *name, char *buffer, size_t size);
  /* A table of further services by versioned name, "neighbours/1" (core/plugin/service.h); to be queried in `create`,
   * valid as long as the run. NULL: no service has this name. */
  const void *(*query)(const hk_host *, const char *service);
  /* Changes the length of a field HK_FIELD_ARRAY of this instance: items are kept, new ones zeroed. HK_NO_MEMORY: the
   * field does not change. Must not be called during evaluations. */
  hk_status (*resize)(const hk_host *, hk_array *field, size_t count);
  /* Calls a function of the script, which has to give n_out finite numbers; never from a body of parallel_for. */
  hk_status (*call)(const hk_host *, const hk_function *, const double *in, size_t n_in, double *out, size_t n_out);
};

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

#include "core/plugin/model.h"
#include "core/plugin/force.h"
#include "core/plugin/constraint.h"
#include "core/plugin/corrector.h"
#include "core/plugin/source.h"
#include "core/plugin/solver.h"
#include "core/plugin/integrator.h"
#include "core/plugin/output.h"
#include "core/plugin/service.h"

#endif
