/* One plugin in a scene: its parameters, its evolving fields, its host services.
 *
 * Life: create (memory, defaults) -> set (any number) -> check -> start (fields, the plugin's create) -> calls ->
 * destroy. The host table is the first member, so that a service finds the instance behind it. */
#ifndef HK_INSTANCE_H
#define HK_INSTANCE_H

#include "core/base/error.h"
#include "core/plugin.h"
#include "core/base/threads.h"

/* A function of the scene's script. `n_out` is set to the number of results, at most `max_out`. */
typedef struct hk_function hk_function;
struct hk_function {
  hk_status (*call)(const hk_function *, const double *in, size_t n_in, double *out, size_t max_out, size_t *n_out,
                    hk_error *error);
  void *context;
  int reference;
};

/* A value on its way into a parameter, as the script wrote it. */
typedef enum hk_value_kind {
  HK_VALUE_NUMBER,  /* number */
  HK_VALUE_BOOLEAN, /* boolean */
  HK_VALUE_STRING,  /* text */
  HK_VALUE_LIST,    /* count numbers */
  HK_VALUE_EDGES,   /* count pairs of ids */
  HK_VALUE_FUNCTION /* function */
} hk_value_kind;

typedef struct hk_value {
  hk_value_kind kind;
  double number;
  bool boolean;
  const char *text;
  size_t count;
  const double *list;
  const uint32_t (*edges)[2];
  hk_function function;
} hk_value;

/* What all instances of a run share with their hosts. */
typedef struct hk_shared {
  hk_threads *threads;
  hk_error *error; /* where host->fail puts its message */
  uint64_t seed;
  hk_status (*path)(struct hk_shared *, const char *name, char *buffer, size_t size);
  void (*warn)(struct hk_shared *, const char *text);
  const void *(*query)(struct hk_shared *, const char *service);
  void *context;         /* of path, warn and query */
  long allocations_left; /* negative: no limit; tests make the k-th allocation fail */
} hk_shared;

typedef struct hk_timed {
  const hk_param *param;
  hk_function function;
} hk_timed;

typedef struct hk_instance {
  hk_host host; /* first member */
  hk_shared *shared;
  const hk_plugin *plugin;
  void *self;
  char *label;
  char *where;     /* script and line, "cloth.lua:12", or "" */
  double from, to; /* s, when a force acts */
  size_t only_count;
  uint32_t *only; /* indices, or NULL: all */
  char *group;    /* acts on this group, or NULL */
  size_t acting;
  uint32_t *active; /* derived from only and group */
  bool *is_active;
  size_t timed_count;
  hk_timed *timed;
  uint64_t random[4];
  bool *given; /* one per parameter: set by the user */
  bool started;
  struct hk_block *blocks; /* memory given out by host->allocate */
  double seconds;          /* sampled wall time */
  size_t calls, sampled;
} hk_instance;

/* NULL with `error` set when there is no memory. `shared` must live as long as the instance. */
hk_instance *hk_instance_create(const hk_plugin *plugin, const char *label, const char *where, hk_shared *shared,
                                hk_error *error);
void hk_instance_destroy(hk_instance *);

/* The parameter of that name; NULL with `error` naming the nearest one. */
const hk_param *hk_instance_param(const hk_instance *, const char *name, hk_error *error);
/* Checks type, range and indices (ids 1..n become indices) and fills the field. */
hk_status hk_instance_set(hk_instance *, const hk_param *, const hk_value *value, size_t n, hk_error *error);
/* After the last set: required parameters are there, lists per edge have the edges' count. */
hk_status hk_instance_check(hk_instance *, hk_error *error);

/* Allocates fields for n particles and a state of `size` doubles, then calls the plugin's create. */
hk_status hk_instance_start(hk_instance *, const hk_view *view, size_t size, hk_error *error);
/* Particles moved: old index i is now map[i] (UINT32_MAX: dead), there are view->n. Remaps parameters and fields, then
 * calls the plugin's topology. */
hk_status hk_instance_remap(hk_instance *, const uint32_t *map, size_t n_old, const hk_view *view, size_t size,
                            hk_error *error);
/* Evaluates parameters that are functions of time. */
hk_status hk_instance_set_time(hk_instance *, double t, hk_error *error);
/* Works out which particles a force acts on. */
hk_status hk_instance_select(hk_instance *, const hk_model *model, hk_error *error);
/* The edges among the parameters, or NULL. */
const hk_edges *hk_instance_edges(const hk_instance *);

#endif
