/* Groups of two to four particles at fixed distances, eight side by side, their steps and their factors; rigid bodies
 * that links join as trees; and links that are distances and differences of points of bodies. */
#ifndef HK_RIGID_BUNDLES_H
#define HK_RIGID_BUNDLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_RIGID_BUNDLE = 8 };
#define HK_RIGID_AT(p, q) ((p) * ((p) + 1) / 2 + (q)) /* the place of an entry of F */

/* Groups of one size, side by side: the numbers of particle i or pair p of the l-th are at [i][l], [p][l]. Pairs are
 * (0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3). Lanes beyond `used` repeat the last group. */
typedef struct hk_rigid_bundle {
  int size, used; /* particles of a group, 2 to 4; groups */
  uint32_t particle[4][HK_RIGID_BUNDLE], equation[6][HK_RIGID_BUNDLE];
  double weight[4][HK_RIGID_BUNDLE];                                 /* inverse masses, 1/kg */
  double square[6][HK_RIGID_BUNDLE], per_length[6][HK_RIGID_BUNDLE]; /* L^2, m^2; 1/L, 1/m */
  double factor[21][HK_RIGID_BUNDLE]; /* lower triangle of F, A = F F^T, by rows, its diagonal as reciprocals */
} hk_rigid_bundle;

/* One group, by rising particles. Of a particle by itself there are no pairs. */
typedef struct hk_rigid_group {
  int size, pairs;
  uint32_t particle[4], equation[4][4];
  double square[4][4]; /* of the distances, m^2 */
} hk_rigid_group;

/* Fills factor, square and per_length of a lane from the squares of the distances, whose weights are set; false: the
 * equations are dependent. */
bool hk_rigid_bundle_factorize(hk_rigid_bundle *, int lane, const double square[4][4]);
/* See hk_constraint_table; n x 3 each. False: a group did not converge; x and v of the
 * bundle are as they were. */
bool hk_rigid_bundle_shake(int width, const hk_rigid_bundle *, const double *from, double h, double *x, double *v);
/* One round of that: x is corrected along J at `from`, and all, 6 x HK_RIGID_BUNDLE, grows by the multipliers. The
 * largest violation before it, m; NaN counts as the largest. */
double hk_rigid_bundle_round(int width, const hk_rigid_bundle *, const double *from, double *x, double *all);
/* v += `by` W J^T all, J at `from`. */
void hk_rigid_bundle_push(int width, const hk_rigid_bundle *, const double *from, const double *all, double by,
                          double *v);
/* lambda of its equations becomes `by` times the impulse. */
void hk_rigid_bundle_rattle(int width, const hk_rigid_bundle *, const double *x, double by, double *v, double *lambda);

/* ---- tree.c: the motion of all bodies that meets the equations of all links ---- */

enum { HK_RIGID_ROWS = 6 };         /* equations of a link, at most, and of a body's motion */
#define HK_RIGID_NOTHING UINT32_MAX /* no parent: the world, or no link */

typedef double hk_rigid_rows[HK_RIGID_ROWS][HK_RIGID_ROWS];

/* A body and the link to its parent, which comes before it in the list. A twist is a velocity of the centre of mass and
 * a rate of turning, (u, w), a wrench a force and a torque about that centre, in the axes of space. Of matrices of
 * links rows and columns beyond `rows` are 0. */
typedef struct hk_rigid_node {
  uint32_t parent, rows; /* node; equations of its link to the parent or to the world, 0: it is free */
  size_t row;            /* the first of them in a list of all equations of links */
  int size;              /* particles, 1 to 4 */
  uint32_t particle[4];
  double mass[4];  /* kg */
  double at[4][4]; /* m, from the centre of mass; the last is of no use */
  /* Of each equation the wrench of its gradient on this body as a column of own_across, J^T, and on the parent as a row
   * of other, J'. Once factorized, with A = L D L^T of the body and what hangs on it, K = J A^-1 J^T = G E G^T of the
   * link: L^-1 J^T and G^-1 J', and both transposed. */
  hk_rigid_rows own, other, own_across, other_across;
  hk_rigid_rows body, link; /* A, kg and kg m^2; once factorized, column k of L and of G in row k */
  double body_pivot[HK_RIGID_ROWS], link_pivot[HK_RIGID_ROWS]; /* 1/D, 1/E */
  double wrench[HK_RIGID_ROWS];                                /* given: what acts, or mass times a way */
  double body_part[HK_RIGID_ROWS], link_part[HK_RIGID_ROWS];   /* scratch of a solution */
  double twist[HK_RIGID_ROWS];                                 /* the solution */
  double moved[HK_RIGID_ROWS];                                 /* a sum of solutions */
} hk_rigid_node;

/* A block of an equation of the link of a node: its gradient with respect to a particle or rider of the node's body or,
 * `other`, of its parent. */
typedef struct hk_rigid_term {
  uint32_t block, particle, node, row;
  bool other;
} hk_rigid_term;

/* Of nodes whose particles are at x, n x 3, what does not depend on links; their gradients are 0. */
void hk_rigid_bodies_place(int width, hk_rigid_node *, size_t count, const double *x);
/* The same, with the gradients J of blocks. */
void hk_rigid_tree_place(int width, hk_rigid_node *, size_t count, const hk_rigid_term *, size_t terms, const double *x,
                         double (*J)[3]);
/* `wrench` becomes the momentum of velocities v, n x 3, and the angular momentum about the centre of mass. */
void hk_rigid_tree_take(int width, hk_rigid_node *, size_t count, const double *v);
/* vector, n x 3, += `by` times the motion of the bodies' particles by their twists, or by their `moved`. */
void hk_rigid_tree_turn(int width, const hk_rigid_node *, size_t count, double by, double *vector);
void hk_rigid_tree_push(int width, const hk_rigid_node *, size_t count, double by, double *vector);
/* The largest coordinate of the bodies' particles, m. */
double hk_rigid_tree_extent(const hk_rigid_node *, size_t count, const double *x);
/* The factors of all nodes, which have been placed; false: equations of a link follow from others. */
bool hk_rigid_tree_factorize(int width, hk_rigid_node *, size_t count);
/* The twists u that make u.M u/2 - wrench.u least among those with J u = -g, where g has a number for each row. */
void hk_rigid_tree_solve(int width, hk_rigid_node *, size_t count, const double *g);

/* ---- pairs.c: links that are distances and differences of points ---- */

/* Two points, each a combination of four particles, and the equations of the link of a node that they are in: that
 * their distance |d| is a length, g = length - |d|, or that their difference d = x_1 - x_0 is one, g = d - length. */
typedef struct hk_rigid_pair {
  uint32_t node, row;                       /* its first equation among those of the link */
  size_t equation;                          /* and in a list of all equations of links */
  bool distance;                            /* one equation; otherwise three */
  enum { HK_OWN, HK_OTHER, HK_HELD } of[2]; /* points of the node's body, of its parent, or that do not move */
  size_t at[2][4];                          /* where the coordinates of the points' particles are in a list of all */
  double weight[2][4], length[3];           /* m; of a distance the first */
} hk_rigid_pair;

/* g of all equations of pairs, m, at x, n x 3. */
void hk_rigid_pairs_value(int width, const hk_rigid_pair *, size_t count, const double *x, double *g);
/* As hk_rigid_tree_place, of links that are pairs. */
void hk_rigid_pairs_place(int width, hk_rigid_node *, size_t count, const hk_rigid_pair *, size_t pairs,
                          const double *x);

#endif
