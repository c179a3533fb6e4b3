/* Facet of forces for the choice of the step: bounds of the stiffness and of the step. */
#ifndef HK_PLUGIN_BOUNDS_H
#define HK_PLUGIN_BOUNDS_H

#include "core/plugin/force.h"

enum {                    /* a further hk_force.flags */
       HK_STIFFENS = 1024 /* may become much stiffer than at present (a slack rope, an open contact): its
                             `stiffness_bound` determines the stable step, not its present stiffness; symplectic and
                             reversible methods, which damp no energy of switching, take half that step */
};

/* The quantity that `stiffness_bound` bounds. */
typedef enum hk_stiffness_part {
  HK_STIFFNESS_WHOLE,    /* K = -dF/dx, N/m */
  HK_STIFFNESS_UNDAMPED, /* the part of K that the force's elements do not damp, such as the tension across an edge; of
                            a force without elements all of K */
  HK_DAMPING_WHOLE       /* D = -dF/dv, N s/m */
} hk_stiffness_part;

#define HK_BOUNDS_ID "bounds/1"
#define HK_BOUNDS_FACET(...) HK_FACET(HK_BOUNDS_ID, hk_bounds_facet, __VA_ARGS__)

typedef struct hk_bounds_facet {
  size_t size;
  /* Adds to block[i] (xx, xy, xz, yy, yz, zz) so that u.K u <= sum_i u_i.block[i] u_i for all u, where K is that of the
   * present positions and, with HK_STIFFENS, of all states that may follow. NULL: the host measures the stiffness. */
  void (*stiffness_bound)(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]);
  double (*longest_step)(void *self, const hk_view *view); /* s, upper bound of the next step; NULL: no bound */
  /* s, of the shortest collision that may come: a twentieth of it is the longest step that the host chooses for a
   * method that is not implicit; a step that is given is not touched. INFINITY: none; NULL: the force makes none. */
  double (*shortest_collision)(void *self, const hk_view *view);
} hk_bounds_facet;

#endif
