/* A gas without a free surface on a MAC grid, smoke and flame: velocity, heat, smoke and fuel are the grid's own, are
 * carried by MacCormack's scheme, driven by buoyancy, and pressure keeps the velocity free of divergence. Grid, walls
 * and pressure are those of a liquid that fills its box (plugins/common/liquid/liquid.h).
 *
 * The order of a step: hk_gas_begin, _walls, _prepare, _carry, _feed, _burn, _push, _spread, _project. Half of
 * pressure and buoyancy act before the fields are carried, along the flow of the middle of the step, and half
 * after, so that smooth flows are of order 2 in time; viscosity, conduction, fire and sources are of order 1. Of order
 * 2 in space away from obstacles. Results have the same bits for any number of threads. */
#ifndef HK_GAS_H
#define HK_GAS_H

#include "plugins/common/liquid/liquid.h"

/* The fields: the velocity's three components on faces, then what is in centres of cells. */
enum {
  HK_GAS_HEAT = 3 /* K above the ambient air */,
  HK_GAS_SMOKE /* kg/m^3 */,
  HK_GAS_FUEL /* part */,
  HK_GAS_FIELDS
};

typedef enum hk_gas_open { HK_GAS_CLOSED, HK_GAS_TOP, HK_GAS_SIDES, HK_GAS_ALL } hk_gas_open;
#define HK_GAS_OPENINGS "none|top|sides|all"

/* Walls that the gas sticks to: the lower and upper face of the box, or all, obstacles too. */
typedef enum hk_gas_sticks { HK_GAS_SLIPS, HK_GAS_STICKS_TO_FLOORS, HK_GAS_STICKS } hk_gas_sticks;
#define HK_GAS_STICKING "none|floors|all"

typedef struct hk_gas {
  const hk_host *host;
  hk_liquid flow;             /* grid, walls and pressure; grid.u: the velocity that the projection works on */
  double *now[HK_GAS_FIELDS]; /* size each, the caller's: the fields */
  double *impulse;            /* size, the caller's: the last step's pressure times its length by the density, m^2/s */
  double *before[HK_GAS_FIELDS]; /* as the step began; of the velocity the caller's */
  double *impulse_before;
  double *rate[3];             /* of the velocity's change in the step before, m/s^2 */
  double *along[3];            /* velocity of the middle of the step; the arrays of grid.before */
  double *from[HK_GAS_FIELDS]; /* what is carried; of the velocity the arrays of grid.push */
  double *work[HK_GAS_FIELDS];
  bool carried[HK_GAS_FIELDS]; /* what the gas has */
  double gravity[3];           /* m/s^2 */
  double expansion;            /* 1/K: a = -g expansion T, Boussinesq */
  double density;              /* kg/m^3, of the ambient air: a = g smoke/density */
  double viscosity;            /* m^2/s, kinematic */
  double diffusivity;          /* m^2/s, of heat */
  double confinement;          /* of vortices, without a unit */
  double cooling;              /* 1/s */
  double radiation;            /* K/s at 1000 K above the ambient, by the fourth power */
  double burn_rate, burn_heat; /* 1/s; K of all the fuel */
  double ignition;             /* K above the ambient */
  double soot;                 /* kg/m^3 of all the fuel */
  hk_gas_sticks sticks;
  double lid[3];                /* m/s, of the box's upper face, where it sticks */
  double floor, ceiling;        /* K above the ambient, of the lower and upper face; NAN: no heat passes */
  bool open[3][2], inlet[3][2]; /* sides of the box that are open; where wind blows in */
  double wind[3];               /* m/s, of the ambient air */
} hk_gas;

/* What a ball gives to the gas in it: within `time` it comes near to these values. */
typedef struct hk_gas_source {
  double radius, time;         /* m, s */
  double value[HK_GAS_FIELDS]; /* of heat, smoke and fuel; those of the velocity are not used */
} hk_gas_source;

/* Bytes of a grid with that many cells along the axes, with all that a gas keeps. */
double hk_gas_bytes(const double cells[3]);
/* Arrays; the grid of `flow` has been opened. HK_NO_MEMORY: with a message. */
hk_status hk_gas_open_fields(hk_gas *, const hk_host *);
void hk_gas_close(hk_gas *);
/* Which sides are open, and of these where the wind comes in, from `wind`. */
void hk_gas_open_sides(hk_gas *, hk_gas_open);

/* A step begins from the fields as they are, after one of the length `last`, 0: none. One that is taken back begins
 * with `before` as it is, without this call. */
void hk_gas_begin(hk_gas *, double last);
/* Walls at the end of the step. */
void hk_gas_walls(hk_gas *);
/* The flow of the middle of the step, and the velocity that half of pressure and buoyancy have changed; last: the
 * length of the step before, 0: there is none. */
void hk_gas_prepare(hk_gas *, double h, double last);
/* The fields, carried for h: MacCormack's scheme on ways of order 2, kept within the values that its first
 * step took (Selle, Fedkiw, Kim, Liu, Rossignac 2008, An unconditionally stable MacCormack method). What
 * comes in through an open side is ambient air. It keeps the sum of a field to the order of the scheme, not to
 * rounding. */
void hk_gas_carry(hk_gas *, double h);
/* The ball about x gives to the gas what the source says. */
void hk_gas_feed(hk_gas *, const hk_gas_source *, const double x[3], double h);
/* Fuel becomes heat and soot at burn_rate where it is hotter than `ignition`; heat is lost by cooling and radiation,
 * each exact for h. */
void hk_gas_burn(hk_gas *, double h);
/* Half of buoyancy (Boussinesq), and vorticity confinement: f = confinement cell N x curl u, N the direction of the
 * gradient of |curl u| (Fedkiw, Stam, Jensen 2001, Visual simulation of smoke). Confinement does not keep
 * momentum.
 */
void hk_gas_push(hk_gas *, double h);
/* Viscosity and conduction by explicit stages, as many as are stable, of order 2 in time. HK_BAD_PARAM: more than 51,
 * with a message. */
hk_status hk_gas_spread(hk_gas *, double h);
/* Takes the divergence away; after hk_gas_prepare with the same steps. HK_NOT_CONVERGED: with a message. */
hk_status hk_gas_project(hk_gas *, double h, double last);
/* Cells that the fastest gas passes in h, with this velocity. */
double hk_gas_courant(const hk_gas *, double *const velocity[3], double h);
/* The place x of a tracer after h in the gas as it is now, by the midpoint rule; it is kept out of walls, and beyond
 * open sides goes on with the wind that left there. */
void hk_gas_move(const hk_gas *, size_t particle, double h, double x[3]);
/* Takes x out of obstacles along their normals, then into the box where it is closed. */
void hk_gas_keep(const hk_gas *, size_t particle, double x[3]);
/* m/s, at x. */
void hk_gas_flow(const hk_gas *, const double x[3], double u[3]);
/* Whether the box has room, in space or a plane, and its grid fits into `most` bytes. HK_BAD_PARAM, with a message. */
hk_status hk_gas_check_box(const hk_host *, const double low[3], const double high[3], double cell, double most);
/* The value of a field at a place; of velocities the component. */
double hk_gas_value(const hk_gas *, const double *field, int f, const double x[3]);

/* Warns of obstacles between whose sides the grid has no cell that is closed, of narrow gaps between them, and of boxes
 * and sources, of that radius, m, that are too small for its cells. */
void hk_gas_warn_of_cells(const hk_gas *, double source_radius);

/* ---- for the files of this room ---- */

/* The number of the cell, along axis c, at place i of the row. */
static inline size_t hk_gas_at(const hk_liquid_grid *g, const hk_liquid_row *r, size_t i, int c) {
  return r->cell[c] + (c == hk_liquid_inner(g) ? i - r->first : 0);
}

/* Whether field f has a place there: faces are one more than cells along their axis. Rows with `beyond` = 1. */
static inline bool hk_gas_has(const hk_liquid_grid *g, const hk_liquid_row *r, size_t i, int f) {
  if (f < 3 && g->flat[f]) return false;
  for (int c = 0; c < 3; c++)
    if (hk_gas_at(g, r, i, c) > g->cells[c] + (c == f)) return false;
  return true;
}

/* m: that place. */
static inline void hk_gas_point(const hk_liquid_grid *g, const hk_liquid_row *r, size_t i, int f, double x[3]) {
  for (int c = 0; c < 3; c++)
    x[c] = g->flat[c] ? g->low[c] : g->low[c] + g->spacing[c] * ((double)hk_gas_at(g, r, i, c) - (c == f ? 1 : 0.5));
}

typedef struct hk_gas_task {
  hk_gas *gas;
  double h;
  int field;
  double factor;
  double *const *fields; /* whose buoyancy acts, */
  double *const *to;     /* on which velocity */
} hk_gas_task;

/* Buoyancy of task.fields for h on the velocity task.to. */
void hk_gas_lift(const hk_gas_task *);
/* body(task, row, i) for every place of the grid, faces beyond the last cells among them. */
typedef void (*hk_gas_body)(const hk_gas_task *, const hk_liquid_row *, size_t i);
void hk_gas_each(const hk_gas_task *, hk_gas_body);

#endif
