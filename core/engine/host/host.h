/* The plugin host: the search of plugins, the description of a plugin by a script (its spec), and a plugin in a run
 * (its instance). */
#ifndef HK_HOST_H
#define HK_HOST_H

#include "core/engine/base/base.h"
#include "core/engine/text/text.h"

/* ---- registry.c: the folders of the installation, of HOOKE_PLUGIN_PATH, and files named by path. A plugin is opened
 * when a scene first names it; the catalogue opens all. Failed loads are listed with their reason ---- */

typedef struct hk_loaded {
  char *path;
  const hk_plugin *plugin; /* the registry's copy, with a table of this host's length; NULL: the load failed */
  char *reason;            /* why */
  void *handle;
  uint64_t file[4]; /* device, node, bytes and time of the last change (ns), when it was loaded */
} hk_loaded;

typedef struct hk_registry {
  char *root;   /* folder with forces/, integrators/ ...: beside the executable or in ../lib/hooke/plugins */
  char *search; /* further folders, separated by ':', or NULL */
  size_t count;
  hk_loaded *item;
  const char *volatile opening; /* the file that is being loaded, for whoever has to say why the process ends; NULL */
} hk_registry;

hk_status hk_registry_open(hk_registry *, const char *root, const char *search, hk_error *error);
void hk_registry_close(hk_registry *); /* to be called after all instances are destroyed */
/* Finds a plugin by its name, or by a path with a slash; the error of an unknown name suggests the nearest name and
 * lists failed loads. `trusted`: the path may name any file; otherwise only those in the folders above. */
hk_status hk_registry_find(hk_registry *, hk_kind kind, const char *name, bool trusted, const hk_plugin **plugin,
                           hk_error *error);
/* Loads the plugin in a file, of any kind; NULL with `error`. */
const hk_loaded *hk_registry_load(hk_registry *, const char *path, bool trusted, hk_error *error);
/* The registry's copy of a plugin that is a constant of this program, which keeps the contract; NULL: no memory. */
const hk_plugin *hk_registry_add(hk_registry *, const hk_plugin *constant, hk_error *error);
/* The first file that was written over in its place since it was loaded, by which the plugin's code is another one;
 * NULL: none. It may be called by a signal handler. */
const char *hk_registry_overwritten(const hk_registry *);
hk_status hk_registry_load_all(hk_registry *, hk_error *error); /* loads all plugins, for the catalogue */
/* The first plugin of a kind for which `suits` is true: first those that the installation names in KIND/default, in
 * that order, then all. They are opened one by one. HK_FAILED: there is none. */
hk_status hk_registry_prefer(hk_registry *, hk_kind kind, bool (*suits)(const hk_plugin *, const void *context),
                             const void *context, const hk_plugin **plugin, hk_error *error);
/* What a name that is not known may mean: a synonym in the installation's list, or the closest name; NULL: neither. */
const char *hk_registry_meant(const hk_registry *, const char *wrong, hk_name_at *, const void *context);
const char *hk_kind_name(hk_kind kind); /* "force" */

/* ---- spec.c, params.c: the description of a plugin by the script ---- */

/* A function of the scene's script. `caller` is the run whose state the function may read, NULL: none. `n_out` is set
 * to the number of results, at most `max_out`. */
struct hk_function {
  hk_status (*call)(const hk_function *, const void *caller, const double *in, size_t n_in, double *out, size_t max_out,
                    size_t *n_out, hk_error *error);
  /* `count` calls, count x n_in arguments and count x n_out results, for the caller NULL. *made: so many have given
   * n_out numbers; where the next one gave another number of them, *got, the status is HK_OK. NULL: there is `call`
   * alone. */
  hk_status (*each)(const hk_function *, const double *in, size_t n_in, double *out, size_t n_out, size_t count,
                    size_t *made, size_t *got, hk_error *error);
  void *context;
  int reference;
  size_t id;      /* position of the argument that is the id of a particle; 0: none */
  double fastest; /* s, shortest time in which it changes, where that is known; 0: it is not */
};

/* A value of the script for a parameter, before it is checked and stored. */
typedef enum hk_value_kind {
  HK_VALUE_NUMBER,  /* number */
  HK_VALUE_BOOLEAN, /* boolean */
  HK_VALUE_STRING,  /* text */
  HK_VALUE_LIST,    /* count numbers */
  HK_VALUE_TUPLES,  /* count tuples of `arity` ids */
  HK_VALUE_FUNCTION /* function */
} hk_value_kind;

typedef struct hk_value {
  hk_value_kind kind;
  double number;
  bool boolean;
  const char *text;
  size_t count;
  const double *list;
  unsigned arity;
  const uint32_t *tuples;
  hk_function function;
} hk_value;

typedef struct hk_timed {
  const hk_param *param;
  hk_function function;
} hk_timed;

typedef struct hk_plugin_spec {
  const hk_plugin *plugin;
  char *label;
  char *where;     /* script and line, "cloth.lua:12", or "" */
  double from, to; /* s, when a force acts */
  double fastest;  /* s, shortest time in which a function of time changes, as the script declares; 0: not declared */
  size_t only_count;
  uint32_t *only; /* id - 1, increasing; NULL: all */
  char *group;    /* the group that the force acts on, or into which the source emits; NULL: none is named */
  void *values;   /* instance_size bytes, of which the parameters are filled; lists hold id - 1 */
  bool *given;    /* one per parameter: set by the user */
  size_t timed_count;
  hk_timed *timed;
  hk_block *blocks; /* memory of the lists */
} hk_plugin_spec;

hk_plugin_spec *hk_spec_create(const hk_plugin *, const char *label, const char *where, hk_error *error);
void hk_spec_destroy(hk_plugin_spec *);
/* The parameter of that name; NULL with `error`. */
const hk_param *hk_spec_param(const hk_plugin_spec *, const char *name, hk_error *error);
/* Checks type, range and ids (1 to n) and fills the field. */
hk_status hk_spec_set(hk_plugin_spec *, const hk_param *, const hk_value *value, size_t n, hk_error *error);
/* To be called after the last hk_spec_set: checks that required parameters are set and that HK_PER_TUPLE lists have the
 * tuples' count. */
hk_status hk_spec_check(const hk_plugin_spec *, hk_error *error);
unsigned hk_param_arity(const hk_param *); /* arity of a list of tuples; 0: the parameter is no such list */
/* The list of tuples of that name among its parameters; `list` NULL: the first. NULL: there is none. */
const hk_param *hk_param_list(const hk_plugin *, const char *list);
hk_status hk_param_check_list(const char *label, const hk_param *, const double *list, size_t count, hk_error *error);

/* ---- instance.c, fields.c, services.c: a plugin in a run. Order of calls: create (a copy of the spec's values) ->
 * start (fields, the plugin's create) -> calls -> destroy. The host table is the first member, so that the host's
 * functions find the instance by a cast ---- */

/* Data shared by all instances of a run. */
typedef struct hk_shared {
  hk_registry *registry;
  hk_threads *threads;
  hk_error *error; /* host->fail writes its message here */
  hk_warnings *warnings;
  uint64_t seed;
  /* NULL: no output folder. `owner` is the label of the instance that asks. */
  hk_status (*path)(void *context, const char *owner, const char *name, char *buffer, size_t size);
  const void *(*query)(void *context, const char *service);
  void *context;                              /* of path and query */
  const struct hk_instance *volatile *acting; /* who is at work, for whoever has to say why the process ends; NULL */
  /* What a plugin has changed that belongs to the process, in words ("has ..."), put right by now; NULL: nothing. It is
   * asked after each of the next `surveys` calls; without it that is 0. */
  const char *(*disturbed)(void);
  int surveys;
  const struct hk_instance *disturber; /* who did, and what; the next call that has a status fails. NULL: nobody */
  const char *disturbance;
  int lanes;             /* hk_host.lanes; below 2: 2. Tests try fewer than the processor has */
  long allocations_left; /* negative: no limit; tests make the k-th allocation fail */
} hk_shared;

typedef struct hk_instance {
  hk_host host; /* first member */
  hk_shared *shared;
  const hk_plugin_spec *spec; /* outlives the instance */
  const hk_plugin *plugin;
  void *self;
  const char *label, *where; /* the spec's */
  bool own_lists;            /* the lists of indices are copies; until the first remap they are the spec's */
  size_t only_count;
  uint32_t *only; /* indices, or NULL: all */
  size_t acting;
  uint32_t *active; /* derived from only and group */
  bool *is_active;
  uint64_t random[4];
  bool started;
  hk_block *blocks; /* memory given out by host->allocate */
  double seconds;   /* sampled wall time */
  size_t calls, sampled;
} hk_instance;

/* In a thread that works beside others in which another plugin is at work: who is in this one. NULL: see `acting`. */
extern _Thread_local const hk_instance *hk_acting_here;

/* Around every call into a plugin: `acting` names the innermost one. */
static inline const hk_instance *hk_enter(const hk_instance *instance) {
  const hk_instance *volatile *acting = instance->shared->acting;
  if (!acting) return NULL;
  const hk_instance *outer = *acting;
  *acting = instance;
  return outer;
}

/* Sets `disturber` where the plugin's call has changed what belongs to the process; whether there is one. */
bool hk_survey(const hk_instance *);

static inline bool hk_leave(const hk_instance *instance, const hk_instance *outer) {
  if (instance->shared->acting) *instance->shared->acting = outer;
  return instance->shared->surveys > 0 && hk_survey(instance);
}

/* A failure of a plugin's function that came without a message gets one. Returns the status, HK_FAILED for what is
 * none. */
hk_status hk_failure_explained(const hk_instance *, const char *function, hk_status status);
hk_status hk_disturbed(const hk_shared *); /* the error of what the disturber has done */

/* hk_leave after a call of the plugin's `function` that returned `status`. */
static inline hk_status hk_leave_with(const hk_instance *instance, const hk_instance *outer, const char *function,
                                      hk_status status) {
  if (hk_leave(instance, outer)) return hk_disturbed(instance->shared);
  return status == HK_OK ? HK_OK : hk_failure_explained(instance, function, status);
}

/* NULL with `error` set when there is no memory. `shared` must live as long as the instance. */
hk_instance *hk_instance_create(const hk_plugin_spec *, hk_shared *shared, hk_error *error);
void hk_instance_destroy(hk_instance *);
/* Allocates fields for n particles and a state of `size` doubles, then calls the plugin's create. */
hk_status hk_instance_start(hk_instance *, const hk_view *view, size_t size, hk_error *error);
/* Puts map[i] in the place of particle i in the lists that the script gave; before hk_instance_start. */
hk_status hk_instance_renumber(hk_instance *, const uint32_t *map, hk_error *error);
/* To be called after births and deaths: old index i is now map[i] (UINT32_MAX: dead), and there are view->n particles.
 * Remaps parameters and fields, then calls the plugin's topology. */
hk_status hk_instance_remap(hk_instance *, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                            hk_error *error);
hk_status hk_instance_set_time(hk_instance *, double t, hk_error *error); /* evaluates the timed parameters */
/* Determines the particles that a force acts on. */
hk_status hk_instance_select(hk_instance *, const hk_model *model, hk_error *error);
/* the scene's view with the instance's host and selection */
hk_view hk_instance_view(const hk_instance *, const hk_view *scene);

hk_status hk_fields_allocate(hk_instance *, size_t n, size_t size, hk_error *error);
hk_status hk_fields_remap(hk_instance *, const uint32_t *map, size_t n_old, size_t n, size_t size, hk_error *error);
/* Calls visit(context, memory, bytes) for every field that is saved, in order; lengths of arrays come first, and a
 * visit that changes one (reading) resizes the array, after one with `data` NULL that says whether so many bytes
 * follow. False: a visit was false, or there was no memory. */
/* The values of a tuple of that list move to the place `to`, in all fields per tuple of it; to <= from. */
void hk_fields_move_tuple(hk_instance *, const hk_param *list, size_t from, size_t to);
bool hk_fields_visit(hk_instance *, size_t n, size_t size, bool (*visit)(void *context, void *data, size_t bytes),
                     void *context);
extern const hk_host hk_host_table;

/* ---- plugins.c: the instances of a run, by kind ---- */

typedef struct hk_instances {
  size_t count;
  hk_instance **item;
} hk_instances;

typedef struct hk_plugins {
  hk_instances kind[HK_KINDS]; /* in the script's order; at most one integrator and one solver */
} hk_plugins;

hk_status hk_plugins_add(hk_plugins *, const hk_plugin_spec *, hk_shared *, hk_instance **made, hk_error *error);
void hk_plugins_clear(hk_plugins *);
hk_instance *hk_plugins_one(const hk_plugins *, hk_kind kind); /* NULL: none */
/* Calls hk_instance_remap for all started instances, sources first. */
hk_status hk_plugins_remap(hk_plugins *, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                           hk_error *error);

#endif
