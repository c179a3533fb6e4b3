/* A scene: what a script describes. Plain data with a few builders; it knows no Lua, takes no step and is changed by no
 * run: any number of runs can be made of it, one after the other or side by side. The index of a particle is its id
 * - 1.
 */
#ifndef HK_SCENE_H
#define HK_SCENE_H

#include "core/host/host.h"

typedef struct hk_pin_spec {
  hk_pin kind;
  size_t count;
  uint32_t *id;     /* particles */
  double axis[3];   /* HK_PIN_LINE: along; HK_PIN_PLANE: normal; unit length */
  hk_function path; /* HK_PIN_PATH: t -> x, y, z [, vx, vy, vz], offsets from the start position */
  double release;   /* s, when it lets go; infinity: never */
  char *where;      /* script line */
} hk_pin_spec;

typedef struct hk_channel_spec {
  char *name;
  size_t size;
  double *initial;  /* size numbers, what particles have that were given no value of their own */
  double *value;    /* capacity x size, per particle, in the order of ids */
  double decay;     /* rate r of dy/dt = r y, or NAN */
  hk_function rate; /* t, id, y... -> dy...; call == NULL: none */
} hk_channel_spec;

typedef struct hk_measure {
  char *name;
  char *where;
  hk_function value; /* t -> one number; the script looks at the state */
} hk_measure;

/* What the script says of the plugins of one kind, in its order. */
typedef struct hk_specs {
  size_t count;
  hk_plugin_spec **item;
} hk_specs;

typedef struct hk_scene {
  char *name;      /* the script's file name without folder and ".lua" */
  char *script;    /* its path as given */
  double duration; /* s, default 1 */
  double fps;      /* default 60 */
  double dt;       /* s, or NAN: chosen */
  double tol;      /* default 1e-6 */
  double accuracy; /* m, asked for the positions at the end (RMS); NAN: not said */
  uint64_t seed;
  hk_registry *registry;
  int threads; /* 0: one per processor */
  /* particles; the position in these arrays is id - 1 */
  size_t n, capacity;
  double *position, *velocity, *mass; /* capacity x 3, x 3, x 1 */
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
  hk_specs plugin[HK_KINDS]; /* at most one integrator and one solver; none: the default */
  bool integrator_auto;      /* none is named: it is to be chosen by measuring (tools/auto.lua) */
  size_t measures;
  hk_measure *measure;
  hk_function on_frame; /* t ->; call == NULL: none */
  hk_function exact;    /* t -> x1, y1, z1, x2, ... of the first particles (as many as it returns) */
  char *start_file;     /* CSV of --state or a checkpoint; NULL: none */
  bool frozen;          /* a run was made of it, or the script has ended: no builder takes it any more */
} hk_scene;

hk_scene *hk_scene_create(const char *script, hk_registry *registry); /* NULL: no memory */
void hk_scene_destroy(hk_scene *);

/* Adds `count` particles; velocity and mass may be NULL (0; `common_mass`). The first new id goes to `first_id`.
 * Refuses what is not finite and negative masses; zero masses must be pinned when the run opens. */
hk_status hk_scene_add_particles(hk_scene *, size_t count, const double *position, const double *velocity,
                                 const double *mass, double common_mass, uint32_t group, uint32_t *first_id,
                                 hk_error *error);
hk_status hk_scene_add_group(hk_scene *, const char *name, uint32_t *group, hk_error *error); /* finds or adds */
hk_status hk_scene_add_channel(hk_scene *, const char *name, size_t size, const double *initial, double decay,
                               const hk_function *rate, hk_error *error);
hk_status hk_scene_set_channel(hk_scene *, const char *name, uint32_t id, const double *value, size_t count,
                               hk_error *error);
/* Copies the lists. `kind`, axis, path, release and where as in the spec given; ids are checked. */
hk_status hk_scene_add_pin(hk_scene *, const hk_pin_spec *spec, hk_error *error);
hk_status hk_scene_add_edges(hk_scene *, size_t count, const uint32_t (*edge)[2], hk_error *error);
hk_status hk_scene_add_triangles(hk_scene *, size_t count, const uint32_t (*triangle)[3], hk_error *error);
hk_status hk_scene_add_measure(hk_scene *, const char *name, const char *where, const hk_function *value,
                               hk_error *error);

/* Adds a plugin by kind and name or path; a kind of which a scene has one (integrator,
 * solver) is replaced. `label` NULL: the name, with "#2" etc. when taken. Set its parameters on the spec, then call
 * hk_spec_check; on a failure afterwards take it away again with hk_scene_drop. */
hk_status hk_scene_add_plugin(hk_scene *, hk_kind kind, const char *name, const char *label, const char *where,
                              hk_plugin_spec **spec, hk_error *error);
void hk_scene_drop(hk_scene *, hk_plugin_spec *);
const hk_plugin_spec *hk_scene_one(const hk_scene *,
                                   hk_kind kind); /* the integrator, the solver; NULL: none is named */

/* ---- overrides.c: what the command line says in place of the script, for one run ---- */

typedef struct hk_overrides {
  const hk_plugin_spec *integrator; /* the scene's, or its own */
  const hk_plugin_spec *solver;     /* NULL: chosen when a linear system comes up */
  hk_plugin_spec *own[2];
  size_t without_count;
  const char *const *without; /* labels of what is left out */
} hk_overrides;

/* `integrator`, `solver`: "name" or "name:parameter=value,...", NULL: the scene's; "auto" of the solver: chosen. Labels
 * must be of the scene. What failed is to be closed as well. */
hk_status hk_overrides_open(hk_overrides *, const hk_scene *, const char *integrator, const char *solver,
                            size_t without_count, const char *const *without, hk_error *error);
void hk_overrides_close(hk_overrides *);
bool hk_overrides_leave_out(const hk_overrides *, const hk_plugin_spec *);

#endif
