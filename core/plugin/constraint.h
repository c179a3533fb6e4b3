/* Constraints: equations g(x, t) = 0, or g(x, t) >= 0, solved with multipliers. */
#ifndef HK_PLUGIN_CONSTRAINT_H
#define HK_PLUGIN_CONSTRAINT_H

#include "core/plugin/facets/implicit.h"

enum {                   /* hk_constraint.flags */
       HK_ONE_SIDED = 1, /* g >= 0: the multiplier only pushes; an equation is inactive while g > 0 */
       /* For rigid bodies: what the host holds their particles and joints together by. Pairs are those of the first
        * list of edges among the parameters. */
       HK_DISTANCES = 2,  /* equation k is L - |x_j - x_i| of pair k. L is constant, the value of the first parameter
                             per tuple, which `create` fills with the distance at the start where it is not given */
       HK_DIFFERENCES = 4 /* equations 3 k to 3 k + 2 keep x_j - x_i of pair k, as at the start where nothing else is
                             given */
};

/* `count` equations whose value is in metres. The force J^T lambda on the particles is towards growing g; scripts read
 * lambda, in N, so g = L - |d| of a bar gives its tension. */
typedef struct hk_constraint {
  size_t size;
  unsigned flags;
  size_t (*count)(void *self);
  /* Names the blocks (equation, particle) of J = dg/dx, once per topology and after a change by `update`; J[b] is the
   * b-th block, 1 x 3. */
  void (*pattern)(void *self, hk_pattern *pattern);
  hk_status (*value)(void *self, const hk_view *view, double *g);
  hk_status (*jacobian)(void *self, const hk_view *view, double (*J)[3]);
  hk_status (*curvature)(void *self, const hk_view *view, double *c); /* c = d^2 g/dt^2 - J a, m/s^2 */
  hk_status (*speed)(void *self, const hk_view *view, double *gt);    /* dg/dt at fixed x, m/s; NULL: 0 */
  /* Called at the start of every step; sets *changed, false on entry, when count or pattern differ from before. May be
   * NULL. */
  hk_status (*update)(void *self, const hk_view *view, bool *changed);
} hk_constraint;

#endif
