/* Constraints: equations g(x, t) = 0, or g(x, t) >= 0, solved with multipliers. */
#ifndef HK_PLUGIN_CONSTRAINT_H
#define HK_PLUGIN_CONSTRAINT_H

#include "core/plugin/facets/implicit.h"

enum {                   /* hk_constraint.flags */
       HK_ONE_SIDED = 1, /* g >= 0: the multiplier only pushes; an equation is inactive while g > 0 */
       /* For rigid bodies: what the host holds their particles and joints together by. Pairs are those of the first
        * list of edges among the parameters. */
       HK_DISTANCES = 2,   /* equation k is L - |x_j - x_i| of pair k. L is constant, the value of the first parameter
                              per tuple, which `create` fills with the distance at the start where it is not given */
       HK_DIFFERENCES = 4, /* equations 3 k to 3 k + 2 are x_j - x_i of pair k minus the values of the first three
                             parameters per tuple, which `create` fills with it at the start where it is not given */
       HK_WAYS = 8         /* equation k keeps (b - a).(d - c)/l of the k-th four points a, b, c, d of the first list of
                              tetrahedra, with l their distance |d - c| at the start, as at the start */
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
  /* Of one-sided equations, each for `count` equations, once per topology: the coefficient of restitution, 0 to 1, the
   * speed of g after an impact in parts of that before, and the speed, m/s, below which it is 0. NULL: 0. */
  void (*restitution)(void *self, double *part, double *least);
  /* For equations that break by what they bear: where the multipliers at the start of a step go, `count` numbers, N,
   * each time before `update`, which is called again, with others, as long as it changes something. They cost an
   * evaluation of the forces. NULL, or NULL as the answer: they are not wanted. */
  double *(*loads)(void *self);
  const hk_tuples
      *joins; /* HK_AT: pairs that are joined at present; NULL: all that lists of edges name. For pictures */
} hk_constraint;

/* ---- "bodies/1", which the host serves itself -------------------------------------------------------------------- */

/* Particles that constraints join move together, so an impulse on one of them moves all. With the inverse masses W,
 * pins applied, and the Jacobian J of the equations, an impulse p on the particles changes their velocities by (W - W
 * J^T (J W J^T)^-1 J W) p, the change of least kinetic energy that the equations allow (Gauss's principle; Moreau 1988,
 * Unilateral contact and dry friction in finite freedom dynamics). A body is a set of movable particles that equations
 * join, directly or through each other, and of riders (hk_rider) of these, on which an impulse p is one of weight[k] p
 * on carrier[k]. One-sided equations join too, but take no part in `respond`: their impulses
 * only push, as those of contacts do, and are solved with these. */

/* sum weight_k x_k of at most four particles: a place on an edge or a face, or the difference of two such places. */
typedef struct hk_weighted_point {
  uint32_t particle[4];
  double weight[4]; /* 0: that particle does not count */
} hk_weighted_point;

/* A one-sided equation of one or two particles as a contact: gap + n.(the point's move) >= 0, and where it is closed
 * n.(the point's velocity) + speed >= 0. */
typedef struct hk_one_sided {
  hk_weighted_point point;
  double n[3];       /* a unit vector */
  double gap, speed; /* m; m/s, the equation's own */
} hk_one_sided;

typedef struct hk_body_service {
  void *self;
  /* Of the present topology, from 0. 0: no constraint acts, and the other functions need not be called. HK_NO_MEMORY.
   */
  hk_status (*count)(void *self, size_t *bodies);
  uint32_t (*of)(
      void *self,
      uint32_t particle); /* its body; UINT32_MAX: no equation has it or its carriers, or pins hold them for ever */
  /* The particles of a body, rising; returns how many. Valid until the topology changes, as the next list. */
  size_t (*members)(void *self, uint32_t body, const uint32_t **particle);
  size_t (*edges)(void *self, const uint32_t (**pair)[2]); /* the pairs that an equation of two particles joins */
  /* Takes the equations as they are at x and v (n x 3): `respond` is for that place until the next call of this or of
   * `settle`. The errors are the constraints'. */
  hk_status (*linearise)(void *self, double t, const double *x, const double *v);
  /* The one-sided equations at that place, but for those of more than two particles, which `settle` alone knows;
   * returns how many. */
  size_t (*one_sided)(void *self, const hk_one_sided **list);
  /* The velocities, m/s, that the impulse (N s) at the point gives to all particles of the bodies that have a part in
   * it; with a mass times a way, kg m, in its place they are ways, m. Writes those rows of `response` (n x 3) and
   * leaves the others, also of particles that are in no body. A body of at most 96 equations has a dense factor of its
   * own, which is made once and serves until the next `linearise`; larger ones take the scene's solver. Equations that
   * follow from others are found by their pivots. */
  hk_status (*respond)(void *self, const hk_weighted_point *, const double impulse[3], double *response);
  /* n.(W - ...).n of the point for a unit vector n, 1/kg: how easily it is moved along n; 0: it cannot be. Of particles
   * in no body it is sum weight^2/m. */
  hk_status (*mobility)(void *self, const hk_weighted_point *, const double n[3], double *mobility);
  /* v (n x 3) after that impulse, also of particles in no body. */
  hk_status (*push)(void *self, const hk_weighted_point *, const double impulse[3], double *v);
  /* Brings x and v onto all equations, the one-sided ones among them, as the host does after each corrector: Newton's
   * iteration to 1e-12 of the largest coordinate. HK_NOT_CONVERGED: constraints contradict each other there. */
  hk_status (*settle)(void *self, double t, double *x, double *v);
} hk_body_service;

#endif
