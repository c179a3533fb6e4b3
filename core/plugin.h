/* hooke's plugin interface: all that a plugin sees of the engine.
 *
 * A plugin is one shared object with one exported constant, `hk_plugin_main`. The host reads that constant without
 * running plugin code, checks `abi`, fills an instance from the parameter table and calls the kind's small vtable.
 * Everything else in a plugin is static.
 *
 * Units are SI. Arrays "n x 3" are particle-major: x[3*i + c] is component c of particle i. Particles are addressed by
 * index 0 <= i < n; an index changes when particles are born or die, an id never does. Lists of particles and edges in
 * an instance are kept up to date by the host, which calls `topology` after every change.
 *
 * Every pointer handed to a plugin is owned by the host and valid during the call only, unless its comment says
 * longer. A function that can fail returns hk_status and makes its message where the cause is known:
 *     return host->fail(host, HK_BAD_PARAM, "rest: %g m is negative", rest);
 * A failed call changes nothing, unless its comment says otherwise. Inside a step nobody allocates, prints or touches
 * files (outputs excepted). */
#ifndef HK_PLUGIN_H
#define HK_PLUGIN_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HK_ABI_MAJOR 1 /* another major is refused */
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
  HK_KINDS
} hk_kind;

typedef struct hk_host hk_host;
typedef struct hk_system hk_system;

/* ---- Parameters ------------------------------------------------------------------------------------------------ */

/* The field that a parameter fills, at `offset` of the instance. */
typedef enum hk_type {
  HK_NUMBER,    /* double; finite */
  HK_INTEGER,   /* int64_t */
  HK_BOOLEAN,   /* bool */
  HK_STRING,    /* const char *, NULL when left out and `text` is NULL; owned by the host as long as the instance */
  HK_CHOICE,    /* int: the position of the value in `text`, "first|second|third"; the default is `initial` */
  HK_VECTOR,    /* double[3] */
  HK_NUMBERS,   /* hk_numbers */
  HK_PARTICLES, /* hk_particles */
  HK_EDGES,     /* hk_edges; at most one per table */
  HK_PER_EDGE   /* hk_per_edge: a number, or one per edge of the table's HK_EDGES */
} hk_type;

typedef struct hk_numbers {
  size_t count;
  const double *value;
} hk_numbers;

typedef struct hk_particles {
  size_t count;
  const uint32_t *index;
} hk_particles;

typedef struct hk_edges {
  size_t count;
  const uint32_t (*pair)[2]; /* indices of the two ends, different from each other */
} hk_edges;

/* One number for all edges (count 1) or one per edge (count of the edges). Left out and HK_OPTIONAL: count 0. */
typedef struct hk_per_edge {
  size_t count;
  double *value;
} hk_per_edge;

static inline double hk_edge_value(const hk_per_edge *p, size_t edge) { return p->value[p->count > 1 ? edge : 0]; }

enum {                  /* hk_param.flags */
       HK_REQUIRED = 1, /* the user must give it */
       HK_OPTIONAL = 2, /* left out: number NAN, vector of NAN, empty list */
       HK_TIMED = 4,    /* a Lua function of t may stand for it (number, vector); updated before every evaluation */
       HK_ABOVE_MIN = 8 /* min itself is refused as well */
};

/* One parameter. `min` and `max` hold for every number in it; both 0 means no limit. A table ends with a NULL name. */
typedef struct hk_param {
  const char *name;
  const char *unit; /* "N/m"; "" when there is none */
  const char *help; /* one line, no full stop */
  hk_type type;
  double initial[3]; /* default; scalars use the first */
  double min, max;
  size_t offset; /* offsetof(instance, field) */
  unsigned flags;
  const char *text; /* HK_STRING: default or NULL; HK_CHOICE: the choices */
} hk_param;

/* ---- Evolving state of a plugin -------------------------------------------------------------------------------- */

typedef enum hk_field_type {
  HK_FIELD_NUMBER,       /* double */
  HK_FIELD_INTEGER,      /* int64_t */
  HK_FIELD_PER_PARTICLE, /* double *: n x width, zeroed at birth */
  HK_FIELD_STATE /* double *: width vectors of the shape of X (system->size doubles each); zeroed when n changes */
} hk_field_type;

enum { HK_SCRATCH = 1 }; /* hk_field.flags: memory whose content need not survive the step; not saved */

/* What evolves in an instance: the host allocates the arrays before `create`, resizes and remaps them when particles
 * are born or die, and writes them to checkpoints. A table ends with a NULL name. */
typedef struct hk_field {
  const char *name;
  hk_field_type type;
  size_t width;
  size_t offset;
  unsigned flags;
} hk_field;

/* ---- What a plugin sees ---------------------------------------------------------------------------------------- */

typedef enum hk_pin {
  HK_FREE,
  HK_PIN_FIXED,
  HK_PIN_PATH, /* follows a script; F on it changes nothing */
  HK_PIN_LINE, /* slides along a line */
  HK_PIN_PLANE /* slides in a plane */
} hk_pin;

typedef struct hk_channel {
  const char *name;
  size_t size;   /* numbers per particle */
  size_t offset; /* its values are y + offset * n, n x size */
} hk_channel;

/* How a force joins particles by springs: what strain, pictures and element-wise methods need. `pair` and the values
 * are valid until the next change of topology. */
typedef struct hk_elements {
  size_t count;
  const uint32_t (*pair)[2];
  hk_per_edge stiffness; /* N/m */
  hk_per_edge damping;   /* N s/m, along the spring */
  hk_per_edge rest;      /* m */
} hk_elements;

typedef struct hk_element_list {
  const char *force; /* the force's label */
  hk_elements elements;
  size_t index; /* the force's place in hk_system.force */
  bool acts;    /* at present, by its `from` and `to` */
} hk_element_list;

/* Constant during a step. */
typedef struct hk_model {
  size_t n;
  const double *mass;         /* n, kg */
  const double *inverse_mass; /* n, 1/kg; 0 for HK_PIN_FIXED and HK_PIN_PATH */
  const uint32_t *id;         /* n, from 1, increasing */
  const uint32_t *group;      /* n, position in group_name */
  const uint8_t *pin;         /* n, hk_pin */
  size_t groups;
  const char *const *group_name;
  size_t channels;
  const hk_channel *channel;
  hk_edges edges; /* the scene's edges, for pictures and collisions: builders' grids, strands and meshes */
  size_t triangles;
  const uint32_t (*triangle)[3];
  size_t element_lists; /* of the forces that offer their elements */
  const hk_element_list *element_list;
} hk_model;

typedef struct hk_view {
  double t;        /* s */
  size_t n;        /* particles */
  const double *x; /* n x 3, m */
  const double *v; /* n x 3, m/s */
  const double *y; /* channels, see hk_channel; NULL when there are none */
  const hk_model *model;
  const hk_host *host;
  size_t acting;          /* how many particles the force acts on ... */
  const uint32_t *active; /* ... and their indices in rising order, or NULL: all of them */
  const bool *is_active;  /* n, or NULL: all of them */
  double *power;          /* add the power of non-conservative parts here, W (HK_POWER); may be NULL */
} hk_view;

/* ---- Host services --------------------------------------------------------------------------------------------- */

/* One table per instance. */
struct hk_host {
  unsigned abi;
  /* Records the message ("%s" etc. as printf) under the instance's label and script line; returns `status`. */
  hk_status (*fail)(const hk_host *, hk_status status, const char *format, ...) HK_PRINTF(3, 4);
  /* A warning: shown once per text, listed in the summary. */
  void (*warn)(const hk_host *, const char *format, ...) HK_PRINTF(2, 3);
  /* Zeroed memory, 64-byte aligned; NULL when there is none. What is not released is freed after `destroy`. */
  void *(*allocate)(const hk_host *, size_t bytes);
  void (*release)(const hk_host *, void *memory);
  /* Calls body(context, begin, end, chunk) for the chunks [chunk*grain, ...) of 0..count, on several threads. How the
   * range is cut depends on count and grain alone, so a sum over chunks in order is the same for any thread count. */
  void (*parallel_for)(const hk_host *, size_t count, size_t grain,
                       void (*body)(void *context, size_t begin, size_t end, size_t chunk), void *context);
  /* Uniform in [0, 1), 53 bits, from the instance's own stream (seeded by --seed, kind and label; in checkpoints). */
  double (*random)(const hk_host *);
  /* Outputs: the path of a file of this run, under its output folder; folders in `name` are created and the file is
   * listed as this run's. HK_IO when that fails, HK_BAD_PARAM when `name` is absolute or has "..". */
  hk_status (*path)(const hk_host *, const char *name, char *buffer, size_t size);
  /* A table of further services by versioned name, "name/1"; NULL when this host has none of that name. */
  const void *(*query)(const hk_host *, const char *service);
};

/* ---- Matrices -------------------------------------------------------------------------------------------------- */

/* Sparse matrix in block compressed rows, both triangles stored; columns rise within a row. */
typedef struct hk_matrix {
  size_t rows;             /* block rows = block columns */
  size_t block;            /* 3 or 1: a block is block x block numbers, row-major */
  const size_t *row_start; /* rows + 1 */
  const uint32_t *column;  /* row_start[rows] */
  double *value;           /* row_start[rows] x block x block */
  bool symmetric;          /* equal to its transpose up to rounding */
} hk_matrix;

/* First phase of assembly: names the blocks, once per topology. */
typedef struct hk_pattern hk_pattern;
struct hk_pattern {
  void (*block)(hk_pattern *, uint32_t row, uint32_t column);
};

enum {                        /* hk_blocks.want: what a method makes of the blocks; without any, they are exact */
       HK_WANT_SYMMETRIC = 1, /* leave out what makes dF/dx unsymmetric, such as the turning of a damping's direction */
       HK_WANT_DEFINITE = 2   /* and project each element's block to positive semi-definite */
};

/* Second phase: the e-th block named goes to K + 9*slot[e] (-dF/dx) and D + 9*slot[e] (-dF/dv). Blocks are added to.
 * Blocks that share a slot are the force's to keep apart when it uses several threads. */
typedef struct hk_blocks {
  const size_t *slot;
  double *K;     /* N/m */
  double *D;     /* N s/m */
  unsigned want; /* honoured by forces that say so, HK_OFFERS_... */
} hk_blocks;

/* ---- Kinds ----------------------------------------------------------------------------------------------------- */

enum { /* hk_force.flags */
       HK_DEPENDS_ON_X = 1,
       HK_DEPENDS_ON_V = 2,
       HK_DEPENDS_ON_T = 4,
       HK_DEPENDS_ON_CHANNELS = 8,
       HK_CONSERVES_MOMENTUM = 16,
       HK_CONSERVES_ANGULAR_MOMENTUM = 32,
       HK_SYMMETRIC_JACOBIAN = 64,
       HK_POWER = 128, /* what is not the gradient of `energy` adds its power to *view->power; a force without this
                          flag is wholly the gradient of its energy, or, without energy, works_unaccounted by the host:
                          all of F.v is its work (also where a parameter is a function of time) */
       HK_OFFERS_SYMMETRIC = 256, /* `jacobian` honours HK_WANT_SYMMETRIC; not needed with HK_SYMMETRIC_JACOBIAN */
       HK_OFFERS_DEFINITE = 512   /* `jacobian` honours HK_WANT_DEFINITE; not needed where it always is */
};

typedef struct hk_force {
  unsigned flags;
  /* F[3*i..] += force on particle i, N, for active particles only (an edge acts when both its ends are active). */
  hk_status (*add)(void *self, const hk_view *view, double *F);
  double (*energy)(void *self, const hk_view *view);                             /* J; NULL: has none */
  hk_status (*rates)(void *self, const hk_view *view, double *dy);               /* dy += channel rates; NULL */
  void (*elements)(void *self, const hk_view *view, hk_elements *out);           /* those that act; NULL: has none */
  void (*pattern)(void *self, const hk_view *view, hk_pattern *pattern);         /* NULL with jacobian */
  hk_status (*jacobian)(void *self, const hk_view *view, const hk_blocks *into); /* NULL: has none (no blocks) */
} hk_force;

/* g(x) = 0, `count` equations whose value is in metres, solved with multipliers. */
typedef struct hk_constraint {
  size_t (*count)(void *self);
  /* Names the blocks (equation, particle) of J = dg/dx, once per topology; J[b] is the b-th, 1 x 3. */
  void (*pattern)(void *self, hk_pattern *pattern);
  void (*value)(void *self, const hk_view *view, double *g);
  void (*jacobian)(void *self, const hk_view *view, double (*J)[3]);
  void (*curvature)(void *self, const hk_view *view, double *c); /* c = (dJ/dt) v, m/s^2 */
} hk_constraint;

enum { HK_WANTS_BEFORE = 1 }; /* hk_corrector.flags: fill x_before */

typedef struct hk_correction {
  double h;               /* s, length of the step just taken */
  const double *x_before; /* n x 3, positions before the step; NULL without HK_WANTS_BEFORE */
  double *x;              /* n x 3, to repair; pins are imposed again afterwards */
  double *v;              /* n x 3 */
  bool changed;           /* set when anything was changed: integrators then drop their history */
} hk_correction;

typedef struct hk_corrector {
  unsigned flags;
  hk_status (*correct)(void *self, const hk_view *view, hk_correction *c);
  double (*violation)(void *self, const hk_view *view); /* m, 0 when satisfied; NULL */
} hk_corrector;

typedef struct hk_birth {
  double mass; /* kg, positive */
  double position[3], velocity[3];
  uint32_t group;        /* position in model->group_name */
  const double *channel; /* all channel values of the particle in the order of model->channel; NULL: initial ones */
} hk_birth;

/* Births and deaths asked for in `emit` take effect together when it returns: deaths close ranks in order, births are
 * appended with new ids. Edges of forces to the dead go with them. */
typedef struct hk_population hk_population;
struct hk_population {
  hk_status (*add)(hk_population *, const hk_birth *birth, uint32_t *id); /* id may be NULL */
  hk_status (*remove)(hk_population *, uint32_t index);                   /* twice the same is once */
};

typedef struct hk_source {
  hk_status (*emit)(void *self, const hk_view *view, double h, hk_population *population); /* before a step of h s */
} hk_source;

enum { /* hk_integrator.flags */
       HK_IMPLICIT = 1,
       HK_ADAPTIVE = 2,
       HK_SYMPLECTIC = 4,
       HK_NEEDS_JACOBIAN = 8,
       HK_REVERSIBLE = 16 /* returns when velocities are reversed */
};

typedef enum hk_reason { /* why the host calls reset */
                         HK_PARTICLES_CHANGED,
                         HK_STATE_CHANGED, /* a corrector, an event or a release changed x, v or the forces */
                         HK_STEP_CHANGED   /* the next h differs from the last (fixed-step methods) */
} hk_reason;

typedef struct hk_step {
  double h;      /* s, the step taken */
  double h_next; /* s, what it would take next; fixed-step methods leave it */
  double error;  /* error estimate relative to the tolerance (1 = just met), or NAN when there is none */
} hk_step;

/* A method for dX/dt = f(X, t). It sees the scene through hk_system alone. */
typedef struct hk_integrator {
  int order;
  int stages; /* evaluations of f per step */
  unsigned flags;
  /* Largest growth factor (spectral radius) of one step on x'' = -g x' - w^2 x, as a function of hw = h w, hg = h g;
   * on y' = -k y, a channel, it is amplification(0, h k) (which is never below 1: x'' = -g x' keeps a constant). */
  double (*amplification)(double hw, double hg);
  /* Advances s->X from s->t by one step, h or shorter, never beyond t_stop; fixed-step methods take h exactly.
   * The host moves s->t. After HK_NOT_CONVERGED s->X is as it was, for the host may try a smaller step; after any other
   * failure the run ends. */
  hk_status (*step)(void *self, hk_system *s, double t_stop, double h, hk_step *out);
  void (*reset)(void *self, hk_reason why); /* history and cached forces are void; NULL: keeps none */
} hk_integrator;

typedef struct hk_solve_info {
  int iterations;   /* 0 for direct solvers */
  double residual;  /* |b - A x| / |b| */
  double tolerance; /* in: the residual that will do, for iterative solvers; 0: the solver's own */
} hk_solve_info;

enum { HK_SOLVES_UNSYMMETRIC = 1, HK_SOLVES_INDEFINITE = 2, HK_ITERATIVE = 4 }; /* hk_solver.flags */

typedef struct hk_solver {
  unsigned flags;
  hk_status (*analyze)(void *self, const hk_matrix *A);   /* the pattern; once per topology */
  hk_status (*factorize)(void *self, const hk_matrix *A); /* the numbers; HK_NOT_CONVERGED: not positive definite */
  hk_status (*solve)(void *self, const double *b, double *x, hk_solve_info *info); /* b, x: rows x block; b != x */
  /* Several right-hand sides side by side: b, x: (rows x block) x columns. NULL: the host solves them one by one. */
  hk_status (*solve_columns)(void *self, const double *b, double *x, size_t columns);
  /* The libraries in use, "CHOLMOD 3.0.14, OpenBLAS 0.3.21", at any time after create. NULL: there is none to name. */
  void (*describe)(const void *self, char *text, size_t size);
} hk_solver;

typedef enum hk_verdict { HK_RUNNING, HK_VERDICT_OK, HK_INACCURATE, HK_DIVERGED, HK_STOPPED } hk_verdict;

typedef struct hk_frame {
  size_t index; /* 0 is the start */
  size_t steps; /* taken so far */
  double fps;
  double kinetic, potential, work;         /* J; potential: of the forces that have an energy; work: of pins and
                                              non-conservative forces since the start (the energy that should have come in) */
  double momentum[3], angular_momentum[3]; /* kg m/s, kg m^2/s about the origin */
  size_t measures;
  const char *const *measure_name;
  const double *measure;
} hk_frame;

/* `view` in the calls of an output is at the frame's time. Between open and close the scene may gain and lose
 * particles. `close` is called once for each open that succeeded, whatever the verdict. */
typedef struct hk_output {
  hk_status (*open)(void *self, const hk_view *view, const hk_frame *frame); /* before frame 0, same state; NULL */
  hk_status (*frame)(void *self, const hk_view *view, const hk_frame *frame);
  hk_status (*close)(void *self, hk_verdict verdict); /* NULL */
} hk_output;

/* ---- The system, as integrators see it ------------------------------------------------------------------------- */

/* A force as methods that split the sum see it. */
typedef struct hk_force_info {
  const char *label;
  unsigned flags; /* hk_force.flags */
  bool jacobian, elements;
} hk_force_info;

/* X = (x, v, y): x is n x 3, v is n x 3 at X + 3n, y the rest: channels, and last the work done on the scene by pins
 * and non-conservative forces (J), which is integrated like a channel so that the energy balance has the method's
 * order. Every evaluation first imposes the pins of time t on the x and v it is given. */
struct hk_system {
  const hk_host *host; /* the integrator's own */
  const hk_model *model;
  double t;       /* s, the time of X */
  double *X;      /* size doubles */
  size_t n, size; /* size = 6n + number of y, the latter at least 1 */
  unsigned flags; /* HK_DEPENDS_ON_... of all forces together */
  double tol;     /* relative tolerance asked for (adaptive methods), > 0 */
  /* a = dv/dt (n x 3, m/s^2) with constraint forces and pins in it, and dy = dy/dt. x and v: n x 3. */
  hk_status (*accelerations)(hk_system *, double t, double *x, double *v, const double *y, double *a, double *dy);
  hk_status (*rates)(hk_system *, double t, double *X, double *dX); /* the whole f(X, t) */
  hk_status (*energy)(hk_system *, double t, const double *X, double *kinetic, double *potential);
  void (*impose)(hk_system *, double t, double *x, double *v); /* the pins of time t */
  void (*filter)(hk_system *, double *vector);                 /* n x 3: zeroes what pins do not allow */
  /* K = -dF/dx, D = -dF/dv at (t, x, v), 3x3 blocks with one common pattern that holds the whole diagonal; not
   * filtered, without masses. `want`: HK_WANT_...; K->symmetric says what came of it. Valid until the next call. */
  hk_status (*jacobian)(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
  /* The scene's solver. `analyze` is called by the host when the pattern (row_start, column) is another one. */
  hk_status (*factorize)(hk_system *, const hk_matrix *A);
  hk_status (*solve)(hk_system *, const double *b, double *x, hk_solve_info *info);
  /* A = m M + d D + k K of the last `jacobian`, with the pins in it: A = S (m M + d D + k K) S + s (I - S), where S is
   * `filter` and s a number of the size of the diagonal, so that the solution for a filtered right-hand side is what
   * the pins allow (up to rounding on slides: filter it). Valid until the next call. */
  hk_status (*combine)(hk_system *, double m, double d, double k, hk_matrix *A);
  /* HK_SOLVES_... of the scene's solver, which is chosen by now: the direct one for symmetric matrices, unless a force
   * has an unsymmetric Jacobian only, or the scene is very large. */
  hk_status (*solver_flags)(hk_system *, unsigned *flags);
  hk_status (*solve_columns)(hk_system *, const double *b, double *x, size_t columns); /* as hk_solver's */
  /* The forces in the scene's order, and which of them evaluations, energies and Jacobians take in. All are taken in
   * when a step begins; a method that splits the sum sets `takes` before its calls. */
  size_t forces;
  const hk_force_info *force;
  bool *takes;
  bool takes_channels; /* the channels' own rates */
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
  /* After parameters and fields are in place, at the start of the run; view is the start state. NULL: nothing to do. */
  hk_status (*create)(void *self, const hk_host *host, const hk_view *view);
  void (*destroy)(void *self, const hk_host *host); /* once per create, even a failed one; NULL */
  /* Indices in parameters and the number of particles have changed: rebuild what was derived from them. NULL. */
  hk_status (*topology)(void *self, const hk_view *view);
  union { /* by kind */
    const hk_force *force;
    const hk_constraint *constraint;
    const hk_corrector *corrector;
    const hk_source *source;
    const hk_integrator *integrator;
    const hk_solver *solver;
    const hk_output *output;
  };
} hk_plugin;

extern HK_EXPORT const hk_plugin hk_plugin_main;

#endif
