/* Obstacles as one step sees them, and the way of one particle among them.
 *
 * In a step the particle's path is the parabola through its positions at both ends, with the acceleration (v1 - v0)/h;
 * that is exact under gravity and off by O(h^3) otherwise. Where it meets an obstacle is found inside the step, in the
 * obstacle's frame, in which moving obstacles rest; there the relative velocity w changes by the law of impact:
 *     w' = w - (1 + e) (w.n) n - min(mu (1 + e) |w.n|, |w_t|) w_t/|w_t|        (Newton's restitution, Coulomb's
 * friction) and from there the particle goes on under the same acceleration, to the next obstacle if need be. Impacts
 * that follow each other ever faster end after T = 2 e |w.n|/(|a.n| (1 - e)); where that is within the step, the
 * particle lies on the surface from the first of them on. What lies on a surface is held by the reaction N that keeps
 * it there to the end of the step, slows down by mu N while it slides, and stays where it is once that is more than
 * what moves it.
 *
 * Work is the change of the energy at the end of the step, under the step's acceleration. Moreau 1988, "Unilateral
 * contact and dry friction in finite freedom dynamics"; Brogliato, Nonsmooth Mechanics, 2016, chapters 2 and 4. */
#ifndef HK_OBSTACLE_H
#define HK_OBSTACLE_H

#include "plugins/common/obstacles/motion.h"
#include "plugins/common/obstacles/shape.h"

enum { HK_OBSTACLES = 64 }; /* at most, in a set */

typedef struct hk_obstacle {
  hk_shape shape;
  double restitution, friction;
  double radius;       /* m, of all particles */
  const double *radii; /* n, m; NULL: `radius` */
  hk_motion motion;
} hk_obstacle;

typedef struct hk_obstacle_set {
  size_t count;
  hk_obstacle *member[HK_OBSTACLES];
} hk_obstacle_set;

typedef struct hk_obstacle_step {
  size_t i;
  double h, mass; /* s, kg */
  const double *x_from, *v_from;
  double *x, *v;  /* at the end of the step; changed where obstacles say so */
  double work;    /* J */
  double depth;   /* m, by which it was inside at the start of the step; 0: it was not */
  double landing; /* part of the step at which it was first struck by more than the step's own change of speed; 1: it
was not, or the method is of order 1 */
  bool changed, endless; /* endless: more impacts than can be counted; x and v are as they were */
} hk_obstacle_step;

static inline double hk_obstacle_radius(const hk_obstacle *o, size_t i) { return o->radii ? o->radii[i] : o->radius; }

/* What all particles did in a step: n x 3 each, at its start and at its end. */
typedef struct hk_obstacle_moves {
  double h;
  const double *x_from, *v_from, *x, *v;
} hk_obstacle_moves;

/* near[k]: whether particle begin + k may meet something, quickly and with a wide margin; to be followed by the next.
 */
void hk_obstacles_sift(const hk_obstacle_set *, const hk_obstacle_moves *, size_t begin, size_t end, bool *near);
/* False: in this step the particle meets nothing (cheap, and right whenever it says so). */
bool hk_obstacles_near(const hk_obstacle_set *, const hk_obstacle_step *);
void hk_obstacles_meet(const hk_obstacle_set *, hk_obstacle_step *);
/* m, the distance of the particle's surface at the end of the step; n: the normal in the scene. */
double hk_obstacle_gap(const hk_obstacle *, const hk_body_frame *, const double x[3], size_t i, double n[3]);
/* m, what rounding makes of a distance of a particle between two places. */
double hk_obstacle_rounding(const hk_obstacle *, const double *x_from, const double *x, size_t i);

#endif
