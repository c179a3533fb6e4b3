/* Impacts of bodies: particles that constraints join (the service "bodies/1") receive the impulses of contact together
 * with the multipliers of their equations. An impulse p on the nearest points of an impact changes the velocities of
 * all particles of its bodies by U p, with the columns of U from hk_body_service.respond, so that the effective mass is
 * 1/(n.G n), G = P U, and the equations hold, to first order, at any time. The law of impact, complementarity and
 * Coulomb's cone, is that of impact.h and gauss_seidel.h with G in the place of the free particles' sum w^2/m, which
 * for them is the same: Gauss-Seidel sweeps over the impacts, each solved for its own impulse (Moreau 1988; Jean 1999),
 * to the solver's tolerance.
 *
 * Positions come first, then the equations are satisfied exactly at the new place (hk_body_service.settle), then the
 * velocities with the responses of that place. Where one-sided equations (cables) take part, which `settle` alone
 * knows, sweeps and `settle` alternate until the impacts hold. */
#ifndef HK_BODY_IMPACTS_H
#define HK_BODY_IMPACTS_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/gauss_seidel.h"

/* How the particles of an impact respond to an impulse on it. */
typedef struct hk_body_response {
  bool known;
  size_t first, count; /* in hk_body_impacts.particle and .block */
  double G[9];         /* 1/kg, row by row: of the nearest points' difference */
} hk_body_response;

typedef struct hk_body_impacts {
  const hk_host *host;
  const hk_body_service *bodies;
  size_t n;                /* particles */
  size_t count;            /* bodies of the present topology; 0: the free particles' solver does the same */
  const double *frictions; /* one per impact; NULL: hk_contact_solver.friction */
  const bool *touches;     /* impacts whose speeds are to obey the law without a push on positions; NULL: none */
  double t;                /* s, the end of the step */
  double slowest;          /* m/s: what sweeps leave of speeds; 0: the solver's tolerance over the step */
  bool keeps_energy;       /* what is met is at rest: impacts may not add to the kinetic energy (body_energy.c) */
  /* Room */
  size_t contacts;  /* of the impacts; those beyond are one-sided equations */
  hk_impact *row;   /* all of them */
  bool *takes_part; /* of each, at the present level */
  size_t rows_room, taking_room;
  hk_body_response *response;
  size_t impacts, used, room;
  uint32_t *particle; /* room */
  double (*block)[9]; /* room: U, row by row */
  double *before;     /* 6 n: speeds before impacts, and with the given restitution */
  double *column;     /* n x 3 */
  uint32_t *place;    /* n: of a particle in a response */
  double *matrix;     /* for Newton's iteration */
  size_t matrix_room;
  size_t *unknown, unknown_room;
} hk_body_impacts;

/* In `create`: the service. HK_FAILED: the host has none. */
hk_status hk_body_impacts_open(hk_body_impacts *, const hk_host *);
void hk_body_impacts_topology(hk_body_impacts *); /* in `topology` */
/* Before a step: `count`, which may have changed with the equations. Room for particles is made where there are bodies,
 * or where it is `needed` without. */
hk_status hk_body_impacts_begin(hk_body_impacts *, const hk_view *, bool needed);
/* As hk_gauss_seidel, for a move that ends at the time t, s. Errors are the constraints'. */
hk_status hk_body_gauss_seidel(hk_body_impacts *, hk_contact_solver *, hk_step_move *, hk_gauss_seidel_result *);

/* ---- body_response.c ---- */

/* The response of impact e. */
hk_status hk_body_response_find(hk_body_impacts *, const hk_contact_solver *, const hk_step_move *, size_t e,
                                const hk_body_response **);

/* ---- body_energy.c ---- */

/* Keeps the velocities before impacts; whether those after them, v, have more kinetic energy, where friction and
 * restitution are at work and nothing may add to it. */
void hk_body_energy_begin(hk_body_impacts *, const hk_step_move *);
bool hk_body_energy_grew(const hk_body_impacts *, const hk_contact_solver *, const hk_step_move *);
/* Takes the speeds back to those before, with targets without restitution. */
void hk_body_energy_restart(hk_body_impacts *, hk_contact_solver *, hk_step_move *);
/* After that solution: the mixture of both that has the kinetic energy from before. */
void hk_body_energy_blend(hk_body_impacts *, hk_step_move *);

/* ---- body_newton.c ---- */

/* Of impact e: Coulomb's coefficient; 0 of one-sided equations. */
double hk_body_friction(const hk_body_impacts *, const hk_contact_solver *, size_t e);

/* Solves all impacts of a level together that take part and have been met: `speeds`: their velocities, y = v; else y =
 * x. *solved: to the tolerance (m or m/s); else nothing was changed. */
hk_status hk_body_newton(hk_body_impacts *, hk_contact_solver *, bool speeds, double tolerance, double *y,
                         bool *solved);

/* ---- body_contact_law.c ---- */

/* Two unit vectors across n and each other. */
void hk_vectors_across(const double n[3], double a[3], double b[3]);

/* Solves one impact for its own impulses by its matrix G, with r = sum w y - origin: the changes of its normal and its
 * tangential impulse are added to change[3]. mu: friction. */
void hk_body_contact_solve(const hk_impact *, hk_impact_level *, const double G[9], double mu, const double r[3],
                           double change[3]);

#endif
