/* What is shown of one frame: the one model of it. Outputs gather it from a view, the reader of recordings from a file;
 * recordings, the stream of a run that is watched, pages and other formats are made of it alone. */
#ifndef HK_FRAME_DATA_H
#define HK_FRAME_DATA_H

#include "plugins/common/frame_data/marks.h"
#include "plugins/common/frame_data/radii.h"
#include "plugins/common/frame_data/solid.h"
#include "plugins/common/obstacles/obstacles_service.h"

#include "plugins/common/colour/colormap.h"
#include "plugins/common/stress/stress.h"
#include "core/plugin.h"

/* The cells of a frame: segments, triangles, and, so that each particle is seen, vertices for those in neither. */
typedef struct hk_frame_cells {
  size_t vertices, segments, triangles;
  uint32_t *vertex; /* indices of the particles shown */
  uint32_t (*segment)[2];
  uint32_t (*triangle)[3];
} hk_frame_cells;

static inline size_t hk_cell_count(const hk_frame_cells *c) { return c->vertices + c->segments + c->triangles; }

enum { HK_ARRAY_NAME = 64 };

/* Numbers of the particles (n x width). */
typedef struct hk_frame_array {
  char name[HK_ARRAY_NAME]; /* of the channel, or label of the force */
  bool force;               /* N, the force of a plugin; otherwise a channel */
  size_t width;
  double *value;
} hk_frame_array;

typedef struct hk_frame_data {
  double t;
  size_t n;
  double *x, *v, *mass; /* n x 3, n x 3, n */
  uint32_t *id;         /* n */
  uint8_t *pin;         /* n, hk_pin */
  size_t groups;        /* of the scene, */
  const char *const *group_name;
  uint32_t *group;       /* n: of each particle its place in group_name; NULL: all are in one */
  double *strand_radius; /* n, m: of the strand or rod that the particle is of; 0: of none; NULL: none has one */
  hk_frame_cells cells;
  double *cell_strain; /* per cell, in their order; NAN: none is known; NULL: of no cell */
  double *strain;      /* n: of the elements of a particle the largest by magnitude; NULL: none has a strain */
  size_t arrays;
  hk_frame_array *array;
  size_t solids; /* what particles bounce off */
  hk_frame_solid *solid;
  hk_mark_lists marks;
} hk_frame_data;

/* ---- fields.c: what a frame has numbers of for each particle, beside its position ---- */

/* A kind of them: one line tells all who show it. */
typedef struct hk_field_kind {
  const char *name, *unit, *painted; /* painted: what colours show of a vector, where that has a name; or NULL */
  hk_colormap map;
} hk_field_kind;

enum { HK_FIELD_VELOCITY, HK_FIELD_STRAIN, HK_FIELD_CHANNEL, HK_FIELD_FORCE, HK_FIELD_KINDS };
extern const hk_field_kind hk_field_kinds[HK_FIELD_KINDS];

typedef struct hk_frame_field {
  int kind;
  const char *name; /* of the channel, or label of the force; otherwise that of the kind */
  size_t components;
  const double *value; /* n x components */
} hk_frame_field;

/* Field k, in the order that all have; false: there are no more. */
bool hk_frame_field_at(const hk_frame_data *, size_t k, hk_frame_field *);

/* ---- what it is gathered with: gatherer.h ---- */

/* Where the strain of a cell comes from: a tuple of an element list, or none. */
typedef struct hk_cell_source {
  uint32_t list, tuple; /* list: UINT32_MAX: no element */
} hk_cell_source;

typedef enum hk_gatherer_array {
  HK_ROOM_KEPT,
  HK_ROOM_PLACE,
  HK_ROOM_X,
  HK_ROOM_V,
  HK_ROOM_MASS,
  HK_ROOM_ID,
  HK_ROOM_PIN,
  HK_ROOM_GROUP,
  HK_ROOM_STRAND_RADIUS,
  HK_ROOM_EVERY,
  HK_ROOM_STRAIN,
  HK_ROOM_VERTEX,
  HK_ROOM_SEGMENT,
  HK_ROOM_TRIANGLE,
  HK_ROOM_SOURCE,
  HK_ROOM_CELL_STRAIN,
  HK_GATHERER_ARRAYS
} hk_gatherer_array;

typedef struct hk_gatherer {
  hk_frame_data data;
  hk_tuples only; /* particles to show; count 0: all, */
  uint32_t group; /* or those of this group; UINT32_MAX: of any */
  bool changed;   /* ids, masses, pins or cells are others than in the frame before */
  /* scratch */
  uint32_t *kept, *place; /* indices of the view that are shown; their places, UINT32_MAX: not shown */
  hk_cell_source *source;
  double *every;                   /* n x 3 of the view: a force */
  size_t stresses;                 /* the last arrays are of forces within, */
  int stress[HK_STRESS_KINDS];     /* of these kinds */
  size_t room[HK_GATHERER_ARRAYS]; /* of each array */
  uint64_t signature;              /* of the cells */
  bool dirty;                      /* the topology changed */
  bool strained;                   /* the scene has elements with a strain */
  const hk_obstacles *obstacles;
  hk_strand_radii radii;
} hk_gatherer;

#endif
