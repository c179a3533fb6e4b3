/* Rigid bodies in a liquid: walls whose motion follows from the pressure on them. They are what the scene has as
 * surfaces of rigid bodies (hk_body_skin), by signed distances. */
#ifndef HK_LIQUID_BODIES_H
#define HK_LIQUID_BODIES_H

#include "plugins/common/obstacles/motion.h"
#include "plugins/common/obstacles/shape.h"

#include "core/plugin.h"

typedef struct hk_liquid_body {
  const double *vertex; /* of the skin, by which it is known */
  hk_surface surface;
  hk_shape shape;
  double reach;                  /* m, from the frame's origin to the farthest vertex */
  bool present;                  /* it is in the scene still */
  bool free;                     /* nothing but its own constraints holds it: pressure moves it */
  bool wet;                      /* pressure acts on it in this step */
  uint32_t carriers, carrier[4]; /* indices */
  double weight[4];              /* kg, of the carriers */
  hk_body_frame frame;           /* where the liquid meets it: at the start of the step, then at its end */
  double mass, centre[3];        /* kg; m, of mass, with the frame */
  double inverse_inertia[9];     /* 1/(kg m^2), there */
  double velocity[3], spin[3];   /* m/s, of the centre; rad/s */
} hk_liquid_body;

typedef struct hk_liquid_bodies {
  const hk_host *host;
  const struct hk_body_service *service;
  size_t count;
  hk_liquid_body *body;
  uint16_t *owner[3]; /* size of the grid, on faces: the body that covers what is not open, from 1; 0: none */
  uint16_t *beside;   /* size of the grid, at corners: the body that is the nearest solid, from 1; 0: none is */
  double h;           /* s, of the step */
  bool known;         /* which are free */
  bool said;
} hk_liquid_bodies;

/* The bodies of a scene, and owners for a grid of `size` faces along each axis; across: unit, the axis along which the
 * grid has no depth, or 0: bodies are endless along it. HK_NO_MEMORY, HK_BAD_PARAM (a surface that is not closed), with
 * a message. */
hk_status hk_liquid_bodies_open(hk_liquid_bodies *, const hk_host *, const hk_view *, size_t size,
                                const double across[3]);
/* In `topology`. */
void hk_liquid_bodies_topology(hk_liquid_bodies *);
/* Where they are at the start of the step, and the velocities with which they come to its end. */
hk_status hk_liquid_bodies_begin(hk_liquid_bodies *, const hk_view *, const hk_correction *);
/* Those that are wet move through the step with the velocities that they have now, and x and v become those of the end;
 * of all the frame becomes that of the end. Whether any has moved. */
bool hk_liquid_bodies_end(hk_liquid_bodies *, const hk_view *, hk_correction *);
/* m, of the point to the surface, negative inside; where it is above `near`, a lower bound will do. n: the outward
 * normal, where it is not above. */
double hk_liquid_body_distance(const hk_liquid_body *, const double x[3], double near, double n[3]);
/* An impulse, N s, and one that turns, N m s about the centre, on a body that is free. */
void hk_liquid_body_push(hk_liquid_body *, const double impulse[6]);
/* m/s, of the body at the point. */
void hk_liquid_body_velocity(const hk_liquid_body *, const double x[3], double u[3]);

#endif
