/* A liquid of particles that is kept incompressible on a grid: velocities go from particles to the faces of cells,
 * walls and pressure change them there, and they come back to the particles, which move along the grid's velocity. The
 * mass, the position and the velocity of the liquid stay on the particles; the grid keeps nothing but the last
 * pressure, as a first guess.
 *
 * The order of a step: hk_thin_walls_begin, hk_liquid_sort, _scatter, _walls, _find_surface, _project, _even, _extend,
 * _gather, _move. Results have the same bits for any number of threads. Bridson, Fluid Simulation for Computer
 * Graphics, 2nd ed. 2015; Jiang, Schroeder, Selle, Teran, Stomakhin 2015, The affine particle-in-cell method. */
#ifndef HK_LIQUID_H
#define HK_LIQUID_H

#include "plugins/common/emission/inflows.h"
#include "plugins/common/liquid/bodies.h"
#include "plugins/common/mac_grid/liquid_grid.h"
#include "plugins/common/mac_grid/pressure.h"
#include "plugins/common/mac_grid/narrow_gaps.h"
#include "plugins/common/obstacles/obstacle.h"
#include "plugins/common/thin_walls/thin_walls.h"

typedef enum hk_liquid_transfer { HK_LIQUID_APIC, HK_LIQUID_FLIP, HK_LIQUID_PIC } hk_liquid_transfer;

#define HK_LIQUID_TRANSFERS "apic|flip|pic"

enum { HK_LIQUID_ENOUGH = 64 }; /* cells within a liquid, above which its density is known */

typedef struct hk_liquid_particles {
  size_t count;
  const uint32_t *index; /* count: particles of the scene */
  const double *mass;    /* of the scene, kg */
  double *x, *v;         /* of the scene, n x 3 */
  const double *affine;  /* of the scene, `apart` numbers from one to the next: row a of nine is the gradient of v_a,
                            1/s; NULL: 0 */
  size_t apart;
} hk_liquid_particles;

typedef struct hk_liquid {
  const hk_host *host;
  hk_liquid_grid grid;
  hk_pressure pressure;
  const hk_obstacle_set *obstacles; /* NULL: none */
  hk_narrow_gap gap;                /* the narrowest between them, where they were at the start */
  const hk_inflows *inflows;        /* NULL: none */
  hk_liquid_bodies bodies;
  hk_thin_walls thin; /* cloth */
  hk_liquid_transfer transfer;
  double density;   /* kg/m^3 */
  double flip;      /* of FLIP: the part of the particle's own velocity that is kept */
  double tolerance; /* of the pressure */
  uint32_t *start;  /* size + 1: places in `sorted` of the particles of a cell */
  uint32_t *sorted; /* most: places in the list of particles, by cells */
  uint32_t *cell;   /* most: of each place in the list */
  bool *through;    /* most: of each place in the list: it passed an obstacle in the last step */
  size_t most;      /* particles that there is memory for */
  bool viscous;     /* it has a viscosity, and drops hang together with it */
  bool sticks;      /* the liquid has the velocity of the box's faces there: it is viscous, and they hold it back */
  bool clings; /* walls hold it with less pressure than that of the air, too: by tension or viscosity, or it is a gas */
  bool walled, stood; /* walls are known; they are those of obstacles that did not move */
  /* of the last step */
  size_t inside; /* cells that are full: liquid on all sides */
  double mean;   /* of the density in them, by `density`; NAN: there are none */
  double left;   /* 1/s, the largest divergence after the projection */
} hk_liquid;

/* Arrays for `most` particles, also again for another number. The grid has been opened. HK_NO_MEMORY: with a message.
 */
hk_status hk_liquid_open(hk_liquid *, const hk_host *, size_t most);
void hk_liquid_close(hk_liquid *);

/* The particles by cells. */
void hk_liquid_sort(hk_liquid *, const hk_liquid_particles *);
/* Velocities, weights and filled parts from the particles. Momentum is kept to rounding, and so is the angular momentum
 * of what is further from walls than half a cell, the particles' own, m C D with D = f (1 - f) h^2 for the faces of a
 * component (f: part of the way between them), counted in. Where the liquid sticks to the box, a particle nearer to it
 * than the first centres has a velocity that falls linearly to none at the face, and gives what its gradient says of
 * them: the box takes the difference. Jiang et al. 2015, eqs. 8
 * to 12, with the bilinear or trilinear kernel on each component's faces. */
void hk_liquid_scatter(hk_liquid *, const hk_liquid_particles *);
/* Distances of cells to the free surface from their filled parts, and the numbers of those in the liquid: its surface
 * is where half of what a cell's kernel covers is filled. */
void hk_liquid_find_surface(hk_liquid *);
/* Numbers of the pressures from the distances. */
void hk_liquid_number_cells(hk_liquid *);
/* Whether there is liquid in the cell and beyond all of its faces that are open, so that its density is known. */
bool hk_liquid_is_within(const hk_liquid *, size_t i);
/* Open parts and velocities of faces from the box and the obstacles where they are at the end of the step; what
 * does not move is computed once. The parts are exact where a face is cut by a plane. Batty, Bertails, Bridson 2007. */
void hk_liquid_walls(hk_liquid *);
/* What comes through walls in the step that ends at t, s, after hk_liquid_walls: by the part of a face that an inflow
 * covers and that of the step in which it flows, so that the volume is that which its source bears. HK_BAD_PARAM, with
 * a message: an inflow is not on a wall of the grid, or has another density. */
hk_status hk_liquid_let_in(hk_liquid *, double t, double h);
/* The part of a cell that no wall covers, as if it were cut by a plane of mean slope. */
double hk_liquid_open_cell(const hk_liquid_grid *, size_t i);
/* m/s, along axis c, of the obstacle that is nearest to x, there; 0: a body is, or there is none. */
double hk_liquid_obstacle_speed(const hk_liquid *, const double x[3], int c);
/* Makes the velocities free of divergence: the pressure is zero on the surface, placed between centres as by Enright,
 * Nguyen, Gibou, Fedkiw 2003 (order 2), walls cover parts of faces as by Ng, Min, Gibou 2009. guess: size, the pressure
 * by the density times the step, m^2/s, of the last step, which becomes that of this one. HK_NOT_CONVERGED: with a
 * message. */
hk_status hk_liquid_project(hk_liquid *, double *guess);
/* The displacement that takes denser and thinner places to the density: with q as a pressure, its divergence is the
 * part by which a cell is too full (Kugelstadt, Longva, Thuerey, Bender 2019, Implicit density projection, eq. 10), of
 * which a quarter is made up for with part = 1; `part`, in [0, 1]: the step by the time that the density is evened in.
 */
hk_status hk_liquid_even(hk_liquid *, double part);
/* Velocities beyond the liquid, and in walls, from the nearest ones that are known, in so many layers of cells; those
 * just beyond the surface are taken from the liquid, too, as no pressure has acted on what particles gave them. */
void hk_liquid_extend(hk_liquid *, int layers);
/* The particles are where they were before the step, with the velocities that forces have given them in it; came, by
 * the order of the list: m and m/s, as they came, by which hk_liquid_differs knows whether they have changed. */
void hk_liquid_step_back(const hk_liquid_particles *, hk_correction *, double (*came)[6]);
bool hk_liquid_differs(const hk_liquid_particles *, double (*came)[6]);
/* Velocities of the particles from the grid, and the affine part, laid out as that of before; `full`, n: the part of
 * the density. */
void hk_liquid_gather(hk_liquid *, const hk_liquid_particles *, double *affine, double *full);
/* Moves the particles by the grid's velocity for h, s (Ralston's method of order 3), then by the displacement, and out
 * of walls, whose obstacles end their motion into them; `through` is whom that took to the other side of an obstacle.
 */
void hk_liquid_move(hk_liquid *, const hk_liquid_particles *, double h);
/* m, how far the particles are beyond walls: the largest. */
double hk_liquid_beyond(const hk_liquid *, const hk_liquid_particles *);
/* Of the cells of the liquid the part that is in no block of three cells a side of liquid and wall: drops, sheets and
 * jets that are less than three cells across, but not films on walls. NAN: no memory. */
double hk_liquid_thin_part(const hk_liquid *);
/* m: by how much the narrowest gap is narrower than a cell, if some of it is in there; 0: it is not. */
double hk_liquid_squeezed(const hk_liquid *, const hk_liquid_particles *);
/* Particles that are beyond walls by more than rounding. */
size_t hk_liquid_count_beyond(const hk_liquid *, const hk_liquid_particles *);
/* 1/s, the largest divergence of a cell of the liquid. */
double hk_liquid_divergence(const hk_liquid *);
/* The part of the way from the centre of the cell `in` of the liquid, across its face of component c below cell i, to
 * the centre of one beyond the surface, where the surface is. Of a face that walls leave less than a fifth open it is
 * moved away, to 1 where nothing is open: through next to nothing a near surface would not hold the pressure, and would
 * make a velocity of it that has no bound. With a fifth or more that is at most five times what comes, by continuity.
 */
double hk_liquid_part_to_surface(const hk_liquid_grid *, int c, size_t i, size_t in);
/* The slope of the pressure (by density and step, m/s) across the face of component c below cell i; the surface's
 * pressure is zero. */
double hk_liquid_slope(const hk_liquid *, int c, size_t i);

#endif
