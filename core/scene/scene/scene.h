/* A scene: plain data that a script describes through these builders. It depends neither on Lua nor on a run, and no
 * run changes it: any number of runs can use it, in succession or at the same time. A particle's index is its id - 1.
 */
#ifndef HK_SCENE_H
#define HK_SCENE_H

#include "core/engine/state/state.h"

typedef struct hk_measure {
  char *name;
  char *unit; /* "": not said */
  char *where;
  hk_function value; /* t -> one number; the script reads the state */
} hk_measure;

/* A parameter of the script that is a function of time, linear between values at equally spaced knots from 0 to
 * `duration` and constant afterwards; whoever looks for its values keeps them within the bounds. */
typedef struct hk_control {
  char *name;
  double duration, min, max; /* s; bounds of the values, -INFINITY and INFINITY: none */
  size_t knots;
  double *value;     /* knots: those that the scene was made with */
  double *current;   /* knots: those that its function of time has, the script's memory: whoever changes them tells
                      * the dynamics (timed_at) */
  const bool *asked; /* the script has asked for values while it made the scene */
} hk_control;

typedef struct hk_goal { /* that a measure has a value at a time, or lies in a range */
  size_t measure;        /* which of the scene's */
  double low, high;      /* equal: the value; -INFINITY, INFINITY: no bound on this side */
  double at;             /* s */
  char *where;           /* the script's line */
} hk_goal;

/* The script's plugins of one kind, in its order. */
typedef struct hk_specs {
  size_t count;
  hk_plugin_spec **item;
} hk_specs;

/* The user's substitute for a force, to try a plugin in existing scenes. */
typedef struct hk_stand_in {
  const char *force, *path; /* the force's name in scripts; the substitute's file; NULL: none. Both outlive the scene */
} hk_stand_in;

/* Where in the script particles were added: those from `first`, an index, on. */
typedef struct hk_scene_place {
  uint32_t first;
  char *where; /* "cloth.lua:12" */
} hk_scene_place;

typedef struct hk_scene_places_list {
  size_t count;
  hk_scene_place *item; /* by rising `first`; no two in succession are alike */
} hk_scene_places_list;

/* Pairs, or four points each, that a constraint of the scene keeps, which comes with the first of them. */
typedef struct hk_kept_tuples {
  hk_tuples tuples;     /* id - 1 */
  hk_plugin_spec *spec; /* NULL: there is none yet */
} hk_kept_tuples;

typedef struct hk_scene {
  char *name;           /* the script's file name without folder and ".lua" */
  char *script;         /* its path as given */
  double duration;      /* s, default 1 */
  double fps;           /* default 60 */
  double dt;            /* s; NAN: chosen by the run */
  double tol;           /* relative, of adaptive integrators; NAN: the method's own */
  double accuracy;      /* m, accuracy asked for the positions (RMS over the particles); NAN: none */
  bool accuracy_at_end; /* the accuracy is asked at the end only, not at every frame */
  uint64_t seed;
  hk_registry *registry;
  int threads; /* 0: one per processor */
  hk_particles particles;
  size_t capacity; /* of the arrays of particles */
  hk_strands strands;
  hk_periodic_box box;                         /* repeats along no axis: space is open */
  hk_kept_tuples distances, differences, ways; /* of rigid bodies and joints */
  hk_specs plugin[HK_KINDS]; /* at most one integrator and one solver; without one the default is used */
  bool integrator_auto;      /* the scene names no integrator: a benchmark chooses it (tools/auto.lua) */
  size_t measures;
  hk_measure *measure;
  size_t controls, goals;
  hk_control *control;
  hk_goal *goal;
  const char *cost;     /* the measure whose integral is to be least; NULL: that of the controls' squares */
  hk_function on_frame; /* t ->; call == NULL: none */
  hk_function exact;    /* t -> x1, y1, z1, x2, ...: exact positions of the first particles, m */
  bool trusted;         /* plugins may be files anywhere, and files be read from anywhere */
  hk_stand_in stand_in; /* of the command line */
  char *start_file;     /* CSV of --state or a checkpoint; NULL: none */
  /* The script's lines of exact, start_file and integrator_auto; NULL: not known. */
  char *exact_where, *start_where, *auto_where;
  hk_scene_places_list places; /* of builders */
  hk_warnings warnings;        /* what the script says and has no effect, or not the one that may be meant; for runs */
  char *origin;                /* origin.c: its script, modules, meshes and parameters; NULL: not known */
  bool spent;  /* hk_scene_spend() has freed positions, velocities, masses, groups, edges and triangles */
  bool frozen; /* a run was made of the scene, or the script has ended: builders refuse it */
} hk_scene;

/* Frees the arrays that a run has copied: positions, velocities, masses, groups, edges and triangles. n, the groups'
 * names, channels, pins, plugins and measures stay; no further run can be opened. */
void hk_scene_spend(hk_scene *);

hk_scene *hk_scene_create(const char *script, hk_registry *registry); /* NULL: no memory */
void hk_scene_destroy(hk_scene *);

/* Adds `count` particles; velocity and mass may be NULL (0; `common_mass`). The first new id goes to `first_id`.
 * Refuses numbers that are not finite and negative masses; particles of zero mass must be pinned when the run opens. */
hk_status hk_scene_add_particles(hk_scene *, size_t count, const double *position, const double *velocity,
                                 const double *mass, double common_mass, uint32_t group, uint32_t *first_id,
                                 hk_error *error);
/* *group: the index of the group with this name, which is added if it is new. */
hk_status hk_scene_add_group(hk_scene *, const char *name, uint32_t *group, hk_error *error);
hk_status hk_scene_add_channel(hk_scene *, const char *name, size_t size, const double *initial, double decay,
                               const hk_function *rate, hk_error *error);
hk_status hk_scene_set_channel(hk_scene *, const char *name, uint32_t id, const double *value, size_t count,
                               hk_error *error);
/* Copies `spec` and its lists; a center of NAN is computed. HK_BAD_PARAM: an unknown id, no direction, a negative
 * release time. */
hk_status hk_scene_add_pin(hk_scene *, const hk_pin_spec *spec, hk_error *error);
hk_status hk_scene_add_edges(hk_scene *, size_t count, const uint32_t (*edge)[2], hk_error *error);
hk_status hk_scene_add_triangles(hk_scene *, size_t count, const uint32_t (*triangle)[3], hk_error *error);
/* A strand: the `count` particles added last, from first_id on, with the half axes of its section, m. */
hk_status hk_scene_add_strand(hk_scene *, uint32_t first_id, size_t count, const double half_axis[2], hk_error *error);

/* Adds a plugin by kind and name or path; an integrator or solver replaces the scene's. `label` NULL: the name,
 * followed by "#2" etc. when it is in use. The caller then sets the parameters of the spec and calls hk_spec_check;
 * when that fails, hk_scene_drop removes the plugin. */
hk_status hk_scene_add_plugin(hk_scene *, hk_kind kind, const char *name, const char *label, const char *where,
                              hk_plugin_spec **spec, hk_error *error);
void hk_scene_drop(hk_scene *, hk_plugin_spec *);
const hk_plugin_spec *hk_scene_one(const hk_scene *,
                                   hk_kind kind); /* the integrator or the solver; NULL: the scene names none */

/* param.c: the plugin's parameter by name; NULL: unknown, and `error` suggests the nearest name. */
const hk_param *hk_scene_param(const hk_scene *, const hk_plugin_spec *, const char *name, hk_error *error);

/* ---- box.c ---- */

/* HK_BAD_PARAM: a length that is not positive, or no axis among "x", "xy", ... */
hk_status hk_scene_set_box(hk_scene *, const double low[3], const double high[3], const char *axes, hk_error *error);
bool hk_box_repeats(const hk_periodic_box *); /* along some axis */

/* ---- measure.c ---- */

/* unit: short plain text, NULL or "": not said. */
hk_status hk_scene_add_measure(hk_scene *, const char *name, const char *unit, const char *where,
                               const hk_function *value, hk_error *error);

/* ---- goal.c: what `hooke optimise` looks for ---- */

/* Copies the control and its values, which have to be within its bounds. */
hk_status hk_scene_add_control(hk_scene *, const hk_control *, hk_error *error);
/* A goal of the measure of that name; `at` within the scene's duration. HK_BAD_PARAM: the measure has another goal at
 * that time, its range is empty, or there is no such measure. */
hk_status hk_scene_add_goal(hk_scene *, const char *measure, const hk_goal *, const char *where, hk_error *error);

/* ---- bodies.c: what rigid bodies have beside particles ---- */

/* Holds `count` pairs of ids at their distances at the start, by a constraint that keeps distances (HK_DISTANCES): the
 * scene has one for all bodies, which comes with the first. */
hk_status hk_scene_add_distances(hk_scene *, const char *where, size_t count, const uint32_t (*pair)[2], hk_error *);
/* The same of their differences, in one place (HK_DIFFERENCES): joints. */
hk_status hk_scene_add_differences(hk_scene *, const char *where, size_t count, const uint32_t (*pair)[2], hk_error *);
/* The same of ways of four points, (b - a).(d - c)/l (HK_WAYS): sliders. */
hk_status hk_scene_add_ways(hk_scene *, const char *where, size_t count, const uint32_t (*points)[4], hk_error *);
/* Makes the particle a rider, of ids, and puts it where it belongs. HK_BAD_PARAM: it has a mass, it or a carrier is
 * unknown or a rider, or the weights do not have the sum 1. */
hk_status hk_scene_add_rider(hk_scene *, const hk_rider *, hk_error *error);
/* The particles beyond the first `before` are the points of a joint, which its bodies do not meet at (hk_rider.joined),
 * or whose bodies meet all the same (hk_rider.meets). */
void hk_scene_mark_joint(hk_scene *, size_t before, bool meets);
/* A surface for pictures, of ids; its lists are copied. */
hk_status hk_scene_add_skin(hk_scene *, const hk_body_skin *, hk_error *error);

/* ---- place.c: lines of the script, for messages ---- */

hk_status hk_scene_note_place(hk_scene *, uint32_t first_id, const char *where, hk_error *error);
const char *hk_scene_place_of(const hk_scene *, uint32_t id); /* the script's name where no line is known */
/* *where becomes a copy of the text. */
hk_status hk_scene_set_where(char **where, const char *text, hk_error *error);

/* ---- order.c: an order of the particles in which joined ones have close indices ---- */

/* n indices by id, allocated with malloc; NULL: the order of ids is good enough. */
uint32_t *hk_scene_places(const hk_scene *);

/* ---- section.c: stiffnesses of a strand by its section and material, with their formulas ---- */

typedef struct hk_section {
  double half_axis[2]; /* m; a circle: its radius twice */
  double E, nu;        /* Pa; Poisson's ratio; NAN: not given, and so are the stiffnesses that need it */
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
bool hk_origin_add_text(char **text, const char *what, const char *content); /* as of a file with that content */
typedef struct hk_origin_changes {
  size_t count;
  const char *const *change; /* parameters that may differ; "=VALUE" may follow */
  char said[600];            /* is set: those that do, "the parameter k was 1 and is 2; ..."; "": none */
} hk_origin_changes;

/* False: they differ; `sentence` says in what, "the script cloth.lua has changed". `changes`: NULL, or what may. */
bool hk_origin_same(const char *then, const char *now, hk_origin_changes *, char *sentence, size_t size);

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
