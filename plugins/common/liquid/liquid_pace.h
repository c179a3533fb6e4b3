/* How fast a liquid is, and the longest step that it allows. */
#ifndef HK_LIQUID_PACE_H
#define HK_LIQUID_PACE_H

#include "plugins/common/liquid/liquid.h"

typedef struct hk_liquid_pace {
  double pull[3];     /* m/s^2, mean acceleration by forces, of the start: what obstacles give in a step would go to
                         infinity with shorter ones */
  double passed;      /* cells that a particle passed in a step, the most so far */
  double gain;        /* m/s^2, by which a particle's velocity changed in the last step, at most; INFINITY: not known */
  double wave;        /* m/s, hk_liquid_wave, of this step */
  double waved;       /* cells that it passed in a step, the most so far */
  double thin, steps; /* sum of hk_liquid_thin_part over the steps that it was looked at; steps so far */
  double *column;     /* 2 x hk_liquid_columns, for hk_liquid_wave */
} hk_liquid_pace;

/* Pa s: of each particle, n, or with `each` NULL the same of all; 0: it has none. */
typedef struct hk_liquid_thickness {
  const double *each;
  double all;
} hk_liquid_thickness;

/* Columns of cells along the axis with the fewest cells, the most that there are along any axis. */
size_t hk_liquid_columns(const hk_liquid_grid *);

/* Its column. HK_NO_MEMORY, with a message. */
hk_status hk_liquid_pace_open(hk_liquid_pace *, const hk_host *, const hk_liquid_grid *);

/* Cells that the fastest particle passes in a step of h, s. */
double hk_liquid_courant(const hk_liquid *, const hk_liquid_particles *, double h);
/* gain from velocities, n x 3, before a step of h, s, to those that the liquid has after it. */
void hk_liquid_gain(hk_liquid_pace *, const hk_liquid_particles *, const double *before, double h);
/* pull from n x 3 accelerations of the scene, m/s^2; or, as long as it is 0, from velocities, n x 3, before and after a
 * step of h, s. */
void hk_liquid_pull(hk_liquid_pace *, const hk_liquid_particles *, const double *acceleration);
void hk_liquid_pull_between(hk_liquid_pace *, const hk_liquid_particles *, const double *before, double h);
/* m/s, of a wave on the liquid's depth, sqrt(g d). Where a kinematic viscosity nu damps one as long as it is deep by
 * 2 nu/d^2 (Lamb 1932, Hydrodynamics, section 349, with the wave number 1/d) faster than it swings by sqrt(g/d), it
 * creeps with g d^2/(2 nu), and that speed counts; with viscosities of each, the largest root of the sum of g d over a
 * column of cells along the pull, of which each part counts by the square of the ratio of these speeds. */
double hk_liquid_wave(const hk_liquid *, const hk_liquid_pace *, const hk_liquid_particles *, hk_liquid_thickness);
/* s, in which neither a particle in free fall, nor such a wave, passes more than `courant` cells; nor, with a tension
 * above 0, N/m, the shortest waves by it half a period: sqrt(rho h^3 / (4 pi sigma)) with nothing above the liquid
 * (Brackbill, Kothe, Zemach 1992, eq. 61). Of a liquid with a viscosity the fall is that of the last step: what stands
 * on a floor does not fall. INFINITY: it is at rest, and nothing pulls. */
double hk_liquid_longest_step(const hk_liquid *, const hk_liquid_pace *, const hk_liquid_particles *, double courant,
                              double tension, double wave, bool viscous);
/* Takes note of a step: which part of it is thin, in one of sixteen. */
void hk_liquid_note_thin(const hk_liquid *, hk_liquid_pace *);
double hk_liquid_mean_thin(const hk_liquid_pace *); /* of the run so far */
/* Takes note of a step of h, s: cells that such a wave passed. */
void hk_liquid_note_wave(const hk_liquid *, hk_liquid_pace *, double h);
/* The part that hk_liquid_even gets for a step of h, s: 1 for what passes half a cell or more. By steps, not by time,
 * it had no limit for short ones: cells are denser and thinner by chance, and beside the surface the denser alone are
 * evened, so that a viscous current over a floor was 7 % slower with 8 times the steps (3 % now). off: the error of
 * the volume by the largest that may be, NAN: not known; near 1 the part is 1, as a source may bring more than goes by
 * time. */
double hk_liquid_part_to_even(const hk_liquid *, const hk_liquid_pace *, const hk_liquid_particles *, double h,
                              double off);

#endif
