/* A scene: the description that a script makes. It is plain data with a few builders; it depends neither on Lua nor on
 * a run, and no run changes it: any number of runs can be made of it, one after the other or at the same time. The
 * index of a particle is its id - 1. */
#ifndef HK_SCENE_H
#define HK_SCENE_H

#include "core/host/host.h"

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

typedef struct hk_measure {
  char *name;
  char *where;
  hk_function value; /* t -> one number; the script reads the state */
} hk_measure;

/* The plugins of one kind that the script names, in its order. */
typedef struct hk_specs {
  size_t count;
  hk_plugin_spec **item;
} hk_specs;

/* A plugin that the user put in the place of a force, to try it in scenes that name that force. */
typedef struct hk_stand_in {
  const char *force, *path; /* its name in scripts; the plugin's file. NULL: there is none. Both outlive the scene */
} hk_stand_in;

typedef struct hk_scene {
  char *name;           /* the script's file name without folder and ".lua" */
  char *script;         /* its path as given */
  double duration;      /* s, default 1 */
  double fps;           /* default 60 */
  double dt;            /* s; NAN: chosen by the run */
  double tol;           /* relative, of adaptive integrators; NAN: the method's own */
  double accuracy;      /* m, accuracy asked for the positions (RMS over the particles); NAN: none */
  bool accuracy_at_end; /* it holds at the end only, not at every frame */
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
  hk_strands strands;
  size_t pins;
  hk_pin_spec *pin;
  hk_specs plugin[HK_KINDS]; /* at most one integrator and one solver; without one the default is used */
  bool integrator_auto;      /* the scene names no integrator: a benchmark chooses it (tools/auto.lua) */
  size_t measures;
  hk_measure *measure;
  hk_function on_frame; /* t ->; call == NULL: none */
  hk_function exact;    /* t -> x1, y1, z1, x2, ... of the first particles (as many as it returns) */
  bool trusted;         /* plugins may be files anywhere, and files be read from anywhere */
  hk_stand_in stand_in; /* what the user put in the place of a force that the script names */
  char *start_file;     /* CSV of --state or a checkpoint; NULL: none */
  char *origin;         /* origin.c: its script, modules, meshes and parameters; NULL: not known */
  bool spent;           /* hk_scene_spend() was called: n, but no position, velocity, mass, group, edge and triangle */
  bool frozen;          /* a run was made of the scene, or the script has ended: builders refuse it */
} hk_scene;

/* Frees the particles' numbers, the edges and the triangles, which a run has copied; no other run can be made of the
 * scene. What they are of is known still: n, groups, channels, pins, plugins, measures. */
void hk_scene_spend(hk_scene *);

hk_scene *hk_scene_create(const char *script, hk_registry *registry); /* NULL: no memory */
void hk_scene_destroy(hk_scene *);

/* Adds `count` particles; velocity and mass may be NULL (0; `common_mass`). The first new id goes to `first_id`.
 * Refuses numbers that are not finite and negative masses; particles of zero mass must be pinned when the run opens. */
hk_status hk_scene_add_particles(hk_scene *, size_t count, const double *position, const double *velocity,
                                 const double *mass, double common_mass, uint32_t group, uint32_t *first_id,
                                 hk_error *error);
/* finds or adds the group */
hk_status hk_scene_add_group(hk_scene *, const char *name, uint32_t *group, hk_error *error);
hk_status hk_scene_add_channel(hk_scene *, const char *name, size_t size, const double *initial, double decay,
                               const hk_function *rate, hk_error *error);
hk_status hk_scene_set_channel(hk_scene *, const char *name, uint32_t id, const double *value, size_t count,
                               hk_error *error);
/* Copies the lists; what else `spec` says is taken as it is, but for a center NAN. Ids are checked. */
hk_status hk_scene_add_pin(hk_scene *, const hk_pin_spec *spec, hk_error *error);
hk_status hk_scene_add_edges(hk_scene *, size_t count, const uint32_t (*edge)[2], hk_error *error);
hk_status hk_scene_add_triangles(hk_scene *, size_t count, const uint32_t (*triangle)[3], hk_error *error);
/* Of the particles added last, whose section has these half axes, m. */
hk_status hk_scene_add_strand(hk_scene *, uint32_t first_id, size_t count, const double half_axis[2], hk_error *error);
hk_status hk_scene_add_measure(hk_scene *, const char *name, const char *where, const hk_function *value,
                               hk_error *error);

/* Adds a plugin by kind and name or path; an integrator or solver replaces the scene's. `label` NULL: the name,
 * followed by "#2" etc. when it is in use. The caller then sets the parameters of the spec and calls hk_spec_check;
 * when that fails, hk_scene_drop removes the plugin. */
hk_status hk_scene_add_plugin(hk_scene *, hk_kind kind, const char *name, const char *label, const char *where,
                              hk_plugin_spec **spec, hk_error *error);
void hk_scene_drop(hk_scene *, hk_plugin_spec *);
const hk_plugin_spec *hk_scene_one(const hk_scene *,
                                   hk_kind kind); /* the integrator or the solver; NULL: the scene names none */

/* param.c: the plugin's parameter of that name; NULL with `error` naming the one that may be meant. */
const hk_param *hk_scene_param(const hk_scene *, const hk_plugin_spec *, const char *name, hk_error *error);

/* ---- order.c: where particles that are joined have distant ids, a better order for the indices of a run ---- */

/* The index of each particle, in the order of ids, n of them in malloc's memory; NULL: the order of ids will do. */
uint32_t *hk_scene_places(const hk_scene *);

/* ---- section.c: what a strand's section and material are worth; the formulas are there ---- */

typedef struct hk_section {
  double half_axis[2]; /* m; a circle: its radius twice */
  double E, nu;        /* Pa; Poisson's ratio; NAN: not given, as is what follows from it */
  double density;      /* kg/m^3 */
} hk_section;

typedef struct hk_section_numbers {
  double line_mass; /* kg/m */
  double EA;        /* N */
  double EI[2], GJ; /* N m^2; EI of bending towards each half axis */
} hk_section_numbers;

hk_status hk_section_check(const hk_section *, hk_error *error);
hk_section_numbers hk_section_of(const hk_section *);

/* ---- curve.c: curves by arc length ---- */

/* Starts at `from`, its centre on the side `side`. radius 0: a straight line along the axis; pitch 0: a circle. */
typedef struct hk_helix {
  double from[3], axis[3], side[3]; /* m; unit vectors across each other */
  double radius, pitch;             /* m; advance per turn, negative: left-handed */
} hk_helix;

/* One that winds about the unit vector `axis`, and one that starts along the unit vector `tangent` with a constant
 * curvature and torsion (1/m, not both 0). phase: rad, turns it about that vector. */
hk_helix hk_helix_about(const double from[3], const double axis[3], double phase, double radius, double pitch);
hk_helix hk_helix_along(const double from[3], const double tangent[3], double phase, double curvature, double torsion);
void hk_helix_at(const hk_helix *, double s, double x[3]);  /* the point at the arc length s, m */
void hk_helix_tangent(const hk_helix *, double tangent[3]); /* at the start */
double hk_polygon_length(const double (*point)[3], size_t points);
/* The places of `count` points, 2 or more, at equal distances along a polygon: k + part, part of the way from point k
 * to the next. */
void hk_polygon_divide(const double (*point)[3], size_t points, size_t count, double *place);

/* ---- scatter.c: even places on a surface, from a seed ---- */

/* Triangles, or with triangles = 0 a sphere, of which `cap` (rad, up to pi) about the axis counts. */
typedef struct hk_skin {
  size_t vertices, triangles;
  const double (*vertex)[3];     /* m */
  const uint32_t (*triangle)[3]; /* vertices, from 0 */
  double centre[3], axis[3], radius, cap;
} hk_skin;

/* x and normal: count each; normals are unit vectors, of triangles those between their vertices'. `random`: a state of
 * hk_random_uniform. HK_BAD_PARAM: no area. */
hk_status hk_scatter(const hk_skin *, size_t count, uint64_t random[4], double (*x)[3], double (*normal)[3],
                     hk_error *error);
/* A unit vector within `angle` of the axis, all of them alike. */
void hk_random_in_cone(uint64_t random[4], const double axis[3], double angle, double into[3]);
/* Two unit vectors across the unit vector `axis` and each other. */
void hk_frame_across(const double axis[3], double side[3], double other[3]);

/* ---- origin.c: what a scene is made from, a text of lines "what<TAB>value" in malloc's memory; NULL: empty ---- */

bool hk_origin_add(char **text, const char *what, const char *value); /* false: no memory */
bool hk_origin_add_file(char **text, const char *what, const char *path);
/* False: they differ; `sentence` says in what, "the script cloth.lua has changed". */
bool hk_origin_same(const char *then, const char *now, char *sentence, size_t size);

/* ---- overrides.c: choices of the command line that replace those of the script, for one run ---- */

typedef struct hk_overrides {
  const hk_plugin_spec *integrator; /* the scene's, or one made from the command line */
  const hk_plugin_spec *solver;     /* NULL: chosen when the run opens */
  hk_plugin_spec *own[2];
  size_t without_count;
  const char *const *without; /* labels of the plugins to omit */
  size_t added_count;
  hk_plugin_spec **added; /* behind those of the scene, each in its kind */
} hk_overrides;

/* `integrator`, `solver`: "name" or "name:parameter=value,...", NULL: the scene's; "auto" for the solver: chosen by the
 * run. Labels must be those of plugins of the scene. After a failure the overrides must be closed as well. */
hk_status hk_overrides_open(hk_overrides *, const hk_scene *, const char *integrator, const char *solver,
                            size_t without_count, const char *const *without, hk_error *error);
/* "kind:name" or "kind:name:parameter=value,...": a plugin that the run has beside those of the scene. */
hk_status hk_overrides_add(hk_overrides *, const hk_scene *, const char *choice, hk_error *error);
void hk_overrides_close(hk_overrides *);
bool hk_overrides_leave_out(const hk_overrides *, const hk_plugin_spec *);

#endif
