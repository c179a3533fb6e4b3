/* Rods: lists of edges that follow each other, their joints and rest shapes, and the evaluation of their energy. */
#ifndef HK_RODS_H
#define HK_RODS_H

#include "core/plugin.h"
#include "plugins/common/rods/rod_path.h"

#define HK_ROD_NONE UINT32_MAX

enum { HK_ROD_REST_INITIAL, HK_ROD_REST_STRAIGHT }; /* hk_rods.rest */
enum { HK_ROD_BANDED, HK_ROD_EXACT };               /* hk_rods.jacobian */

/* The cross section of an edge at the end of the last accepted step, from which the present one is found: how the edge
 * lay, the director transported along the rod, and the angle of the section from it. Saved in checkpoints. */
typedef struct hk_rod_frame {
  uint32_t id[2]; /* of the edge's particles */
  double angle, offset;
  double tangent[3], director[3];
} hk_rod_frame;

/* To be zeroed before the first use, but for the parameters. The memory belongs to the instance and is released with
 * it. */
typedef struct hk_rods {
  /* ---- parameters ---- */
  hk_tuples edges;
  hk_per_tuple EI, EI2, GJ, length, curvature, torsion;
  double axis[3];
  int rest, jacobian;
  double turn; /* rad */
  /* ---- fields ---- */
  hk_array frames; /* hk_rod_frame, one for each edge of the list */
  double turned;   /* rad, `turn` at the last accepted step */
  /* ---- joints, by their first edge ---- */
  const hk_host *host;
  size_t count;                            /* edges */
  uint32_t *next;                          /* the edge that follows; HK_ROD_NONE: none */
  double *rest_length, *bent[2], *twisted; /* m; of joints: rest curvature towards the axes and rest twist */
  uint32_t (*id)[2];
  /* ---- rows ---- */
  const hk_rod_path *path;
  hk_rod_rows rows;
  size_t batches;
  hk_rod_batch *batch;
  double *sums;  /* per batch */
  double *dense; /* of the longest rod with frames, for exact blocks */
  uint8_t *pin;  /* n: the pins for which the rows were filled */
  size_t pinned; /* n */
  bool shared;   /* some particle is on two rods, or twice on one */
  bool given;    /* rest shapes follow from curvature and torsion */
} hk_rods;

/* `create` and `topology` of a force of rods. HK_BAD_PARAM, HK_NO_MEMORY. */
hk_status hk_rods_open(hk_rods *, const hk_host *, const hk_view *view);
hk_status hk_rods_follow(hk_rods *, const hk_view *view);

/* Frames, angles and forces on the rows, for all rods; the energy, J, unless it is NULL. HK_NOT_CONVERGED. */
hk_status hk_rods_evaluate(hk_rods *, const hk_view *view, double *energy);
void hk_rods_scatter(const hk_rods *, const hk_host *, double *F); /* F += the forces of the last evaluation */
/* Keeps the frames of an accepted state; HK_FAILED where a rod is folded or an edge has no length. */
hk_status hk_rods_accept(hk_rods *, const hk_view *view);

/* ---- rod_rows.c ---- */
hk_status hk_rod_rows_build(hk_rods *, const hk_view *view); /* the batches, for joints and acting particles */
void hk_rod_rows_fill(hk_rods *, const hk_view *view);       /* stiffness and rest shapes, for the present pins */

#endif
