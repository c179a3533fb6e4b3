/* The loops over rods, by the width of vectors. Rods come four at a time, one in each lane of the
 * vectors, so that what runs along a rod, the transport of frames and the elimination of angles, costs a quarter for
 * each. Rows: number k of a batch stands at (first + k) * HK_ROD_LANES + lane. No operation is contracted or estimated:
 * all paths have the same bits. */
#ifndef HK_ROD_PATH_H
#define HK_ROD_PATH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_ROD_LANES = 4 };

/* Below this 1 + cos of the angle between two edges, 1.4e-3 rad from a fold, a rod counts as folded. */
#define HK_ROD_FOLD 1e-6

/* Rods of one kind. Joint k is between edges k and k + 1; of a ring, the last is between the last edge and the first.
 */
typedef struct hk_rod_batch {
  size_t first;                 /* row of its edges and joints; its nodes, one more, begin at row first + number */
  size_t number;                /* of the batch */
  size_t edges;                 /* of the longest rod */
  size_t joint;                 /* number of joints in the batches before */
  uint32_t count[HK_ROD_LANES]; /* edges of each rod; 0: an empty lane. Of rings all are equal to `edges` or 0 */
  bool ring;
  bool framed;                   /* the directions of its cross sections matter */
  bool found;                    /* its angles are those of the places on its rows, and of `turn` */
  double turn;                   /* rad */
  uint32_t turned[HK_ROD_LANES]; /* number in the rod of the clamped edge that is turned; UINT32_MAX: none */
} hk_rod_batch;

/* Rows of numbers. Padding has zero stiffness, and nodes that repeat the last. */
typedef struct hk_rod_rows {
  size_t edges, nodes; /* rows */
  uint32_t *node;      /* particles, by row of nodes */
  uint32_t *edge;      /* numbers in the list of edges; UINT32_MAX: padding */
  /* Joints: stiffness over length towards the first and the second axis and in twist, J; rest curvature (2 tan of half
   * the angle of turn) towards the two axes and rest twist, rad */
  double *bend[2], *twist, *rest[2], *rest_twist;
  double *held;    /* 1: the angle of the edge is given */
  double *x[3];    /* m, by row of nodes */
  double *f[3];    /* N, by row of nodes */
  double *t[3];    /* unit vectors of the edges; 0 where it has no length */
  double *inverse; /* 1/m, 1/length; 0 where it has none */
  double *a[3];    /* a director of each edge, transported in parallel along the rod from the first edge */
  double *angle;   /* rad, of the cross section from that director */
  double *turn[2]; /* of joints: the curvature binormal 2 t0 x t1/(1 + t0.t1) on t x a and -a of the edge before it */
  double *offset;  /* rad, of joints: of a ring's last one, the angle between the directors that meet there; else 0 */
  double *pivot, *lower, *right, *column; /* of the elimination */
} hk_rod_rows;

typedef struct hk_rod_path {
  void (*gather)(const hk_rod_rows *, const hk_rod_batch *, const double *x);
  /* Whether no joint is folded and no edge without length. */
  bool (*sound)(const hk_rod_rows *, const hk_rod_batch *);
  /* Bending alone, of straight isotropic rods: f. Returns the energy, J. */
  double (*plain)(const hk_rod_rows *, const hk_rod_batch *);
  /* t, inverse, a from the directors of the first edges in `a`, turn. */
  void (*frames)(const hk_rod_rows *, const hk_rod_batch *);
  /* The angles of edges that are not held, from those in `angle`, where the energy is least. False: not found. */
  bool (*solve)(const hk_rod_rows *, const hk_rod_batch *);
  /* f of frames and angles. Returns the energy, J. */
  double (*forces)(const hk_rod_rows *, const hk_rod_batch *);
} hk_rod_path;

extern const hk_rod_path hk_rod_narrow, hk_rod_wide;
hk_rod_path hk_rod_path_of(int lanes); /* hk_host.lanes */

#endif
