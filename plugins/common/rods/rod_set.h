/* The rods of one force: its parameters and fields, the joints of its edges, and the rows on which they are evaluated.
 */
#ifndef HK_ROD_SET_H
#define HK_ROD_SET_H

#include "core/plugin.h"
#include "plugins/common/rods/rod_elements.h"

#define HK_ROD_NONE UINT32_MAX

enum { HK_ROD_REST_INITIAL, HK_ROD_REST_STRAIGHT }; /* hk_rods.rest */
enum { HK_ROD_BANDED, HK_ROD_EXACT };               /* hk_rods.jacobian */

/* The cross section of an edge at the end of the last accepted step, from which the present one is found: how the edge
 * lay, the director transported along the rod, and the angle of the section from it. Saved in checkpoints. */
typedef struct hk_rod_frame {
  uint32_t id[2]; /* of the edge's particles */
  double angle, offset;
  double spin; /* m, of the particle that is the angle; of edges that have one */
  double tangent[3], director[3];
} hk_rod_frame;

/* To be zeroed before the first use, but for the parameters. The memory belongs to the instance and is released with
 * it. */
typedef struct hk_rods {
  /* ---- parameters ---- */
  hk_tuples edges;
  hk_per_tuple EI, EI2, GJ, length, curvature, torsion;
  double axis[3];
  hk_tuples spins; /* one particle for each edge, whose x is `radius` times the angle; none: quasi-static */
  double radius;
  int rest, jacobian;
  double turn;        /* rad */
  double retardation; /* s */
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
  hk_rod_path path;
  hk_rod_rows rows;
  size_t batches;
  hk_rod_batch *batch;
  hk_rod_elements elements;
  double *sums;  /* per batch */
  double *dense; /* of the longest rod with frames, for exact blocks */
  uint8_t *pin;  /* n: the pins for which the rows were filled */
  size_t pinned; /* n */
  bool shared;   /* some particle is on two rods, or twice on one */
  bool given;    /* rest shapes follow from curvature and torsion */
} hk_rods;

#endif
