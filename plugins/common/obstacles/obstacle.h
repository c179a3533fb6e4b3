/* Impacts and friction of one particle with obstacles within one step.
 *
 * In a step the particle's path is the parabola through its positions at both ends, with the acceleration (v1 - v0)/h;
 * that is exact under gravity and off by O(h^3) otherwise. The time of impact is found in the
 * obstacle's frame, in which moving obstacles rest; there the relative velocity w changes by the law of impact:
 *     w' = w - (1 + e) (w.n) n - min(mu (1 + e) |w.n|, |w_t|) w_t/|w_t|
 * (Newton's restitution e, Coulomb's friction mu). The particle then goes on under the same acceleration, possibly to
 * further impacts. A Zeno sequence of impacts ends after T = 2 e |w.n|/(|a.n| (1 - e)); if that is within the step, the
 * particle rests on the surface from the first impact on. A resting particle is held by the normal reaction N to the
 * end of the step; it slides with the friction mu N, or sticks if mu N exceeds the tangential load.
 *
 * Work is the change of the energy at the end of the step, under the step's acceleration. Moreau 1988, "Unilateral
 * contact and dry friction in finite freedom dynamics"; Brogliato, Nonsmooth Mechanics, 2016, chapters 2 and 4. */
#ifndef HK_OBSTACLE_H
#define HK_OBSTACLE_H

#include "plugins/common/obstacles/motion.h"
#include "plugins/common/obstacles/shape.h"

enum { HK_OBSTACLES = 64, HK_OBSTACLE_CARRIERS = 8 }; /* at most, in a set */

typedef struct hk_obstacle {
  hk_shape shape;
  double restitution, friction;
  double rolling, spinning; /* m, of round rigid bodies: contact/bodies/body_moments.h */
  double radius;            /* m, of all particles */
  const double *radii;      /* n, m; NULL: `radius` */
  const hk_model *rounded;  /* its riders have radii of their own; NULL: none has */
  double largest;           /* m, of these */
  const hk_tuples *edges; /* arity 2: pairs of particles between which it does not come either; NULL: none are named */
  hk_motion motion;
} hk_obstacle;

typedef struct hk_obstacle_set {
  size_t count;
  hk_obstacle *member[HK_OBSTACLES];
  size_t carriers;
  const bool *const *carried[HK_OBSTACLE_CARRIERS]; /* particles that others keep out of all obstacles: no impacts */
} hk_obstacle_set;

static inline bool hk_obstacle_set_carried(const hk_obstacle_set *s, size_t particle) {
  for (size_t k = 0; k < s->carriers; k++)
    if (*s->carried[k] && (*s->carried[k])[particle]) return true;
  return false;
}

typedef struct hk_obstacle_step {
  size_t i;
  double h, mass; /* s, kg */
  const double *x_from, *v_from;
  double *x, *v;  /* at the end of the step, on entry without obstacles */
  double work;    /* J */
  double depth;   /* m, penetration at the start of the step; 0: none */
  double landing; /* part of the step at which it was first struck by more than the step's own change of speed; 1: it
was not, or the method is of order 1 */
  bool changed, endless; /* endless: too many impacts; x and v are unchanged */
} hk_obstacle_step;

static inline double hk_obstacle_radius(const hk_obstacle *o, size_t i) {
  const hk_rider *r = o->rounded && o->rounded->pin[i] == HK_PIN_RIDES ? hk_model_rider(o->rounded, i) : NULL;
  if (r && r->radius > 0) return r->radius;
  return o->radii ? o->radii[i] : o->radius;
}

/* The positions (m) and velocities (m/s) of all particles at both ends of a step, n x 3 each; h in s. */
typedef struct hk_obstacle_moves {
  double h;
  const double *x_from, *v_from, *x, *v;
} hk_obstacle_moves;

/* near[k]: false if particle begin + k certainly has no contact in the step, by its plane, or by a sphere about the
 * shape with a wide margin. */
void hk_obstacles_sift(const hk_obstacle_set *, const hk_obstacle_moves *, size_t begin, size_t end, bool *near);
/* A sharper test of one particle: false only if it certainly has no contact in the step. */
bool hk_obstacles_near(const hk_obstacle_set *, const hk_obstacle_step *);
void hk_obstacles_meet(const hk_obstacle_set *, hk_obstacle_step *);
/* m, the distance of the particle's surface at the end of the step; n: the normal in the scene. */
double hk_obstacle_gap(const hk_obstacle *, const hk_body_frame *, const double x[3], size_t i, double n[3]);
/* m, the rounding error of a particle's distance on a move from x_from to x. */
double hk_obstacle_rounding(const hk_obstacle *, const double *x_from, const double *x, size_t i);

#endif
