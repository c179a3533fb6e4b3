/* Impacts of bodies, particles that constraints join, and of edges with obstacles, by the law of impact that obstacle.h
 * has for particles on their own:
 *     w.n after >= -e (w.n before), Coulomb's friction of the impulse,
 * of the system, with all contacts of a step together (contact/bodies/body_impacts.h). A step in which a body lands
 * with a speed that shows is cut there, so that the law holds at one instant: no energy of a rigid body is lost or made
 * by its turning within the step. What rests or slides is held at the end of the step. Sequences of bounces that end
 * within the step end in rest, as in obstacle.h. Contacts that the solution brings about are solved in further rounds,
 * in which those before are kept from closing. */
#ifndef HK_BODY_OBSTACLES_H
#define HK_BODY_OBSTACLES_H

#include "plugins/common/contact/bodies/body_impacts.h"
#include "plugins/common/obstacles/body_obstacle_law.h"

typedef struct hk_body_obstacles {
  hk_body_impacts impacts;
  const hk_obstacle_set *set;
  size_t further; /* edges that the script names */
  size_t features, feature_room;
  hk_obstacle_feature *feature;
  bool *taken; /* n: the particle is here, and not on a path of its own */
  size_t contacts, contact_room;
  hk_body_contact *contact;
  bool *solved; /* features x obstacles: that contact has had its impulse in this step */
  bool *near;   /* features x obstacles: they may touch in the step */
  size_t solved_room, near_room;
  hk_impact *impact;
  hk_body_arms *arms;
  hk_body_moments *moments;
  double (*slip)[3]; /* m/s, hk_body_obstacle_slides */
  double *friction;
  bool *touch;
  size_t impact_room, arms_room, moments_room, slip_room, friction_room, touch_room;
  uint64_t *moved, *touched, now; /* for gauss_seidel.h */
  double *force;                  /* n x 3, N: the mean of the last step's impulses; the plugin's */
  double *end;                    /* 6 n: x and v of the end of the step before corrections */
} hk_body_obstacles;

/* What the bodies do in a step. */
typedef struct hk_body_landing {
  double part;     /* of the step, at which the first lands with a speed that shows; 1: none does */
  size_t landings; /* of all of them */
  double depth;    /* m, the largest overlap at the start; 0: none */
  uint32_t deepest;
} hk_body_landing;

/* The set is complete at the first step. */
hk_status hk_body_obstacles_open(hk_body_obstacles *, const hk_host *, const hk_obstacle_set *);
void hk_body_obstacles_topology(hk_body_obstacles *); /* in `topology` */
/* Before anything else in a step: `features`, of the present equations; 0: there is nothing to do. */
hk_status hk_body_obstacles_begin(hk_body_obstacles *, const hk_view *);
/* Finds what touches in the step. */
hk_status hk_body_obstacles_find(hk_body_obstacles *, const hk_obstacle_moves *, hk_body_landing *);
/* Solves what was found last: changes x and v of the correction, and adds to its work. `reject`: no solution was found,
 * shorter steps may have one. HK_FAILED: contact and constraints contradict each other. */
hk_status hk_body_obstacles_solve(hk_body_obstacles *, const hk_view *, hk_correction *);
/* m, how deep edges are inside obstacles at the present state; 0: nowhere. */
double hk_body_obstacles_depth(const hk_body_obstacles *, const hk_view *);

#endif
