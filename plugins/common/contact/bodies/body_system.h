/* The impacts of bodies in one solution, with their responses: what its parts share. */
#ifndef HK_BODY_SYSTEM_H
#define HK_BODY_SYSTEM_H

#include "core/plugin.h"
#include "plugins/common/contact/bodies/body_arms.h"
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/common/contact/bodies/body_moments.h"
#include "plugins/common/cones/solid_program.h"
#include "plugins/common/contact/impulses/gauss_seidel.h"

/* How the particles of an impact respond to an impulse on it. */
typedef struct hk_body_response {
  bool known;
  size_t first, count; /* in hk_body_impacts.particle and .block */
  double G[9];         /* 1/kg, row by row: of the nearest points' difference */
  bool gives_way;      /* something moves by the impact: pins and constraints may hold it */
  hk_contact_tangent tangent;
} hk_body_response;

typedef struct hk_body_impacts {
  const hk_host *host;
  const hk_body_service *bodies;
  const hk_model *model;
  size_t n;                 /* particles */
  size_t count;             /* bodies of the present topology; 0: the free particles' solver does the same */
  const double *frictions;  /* one per impact; NULL: hk_contact_solver.friction */
  const bool *touches;      /* impacts whose speeds are to obey the law without a push on positions; NULL: none */
  hk_body_arms *arms;       /* one per impact, with carriers and radii: where friction acts; NULL: at their places */
  hk_body_moments *moments; /* one per impact, with carriers, lengths, way and rest; NULL: none */
  double t;                 /* s, the end of the step */
  double slowest;           /* m/s: what sweeps leave of speeds; 0: the solver's tolerance over the step */
  bool keeps_energy;        /* what is met is at rest: impacts may not add to the kinetic energy (body_energy.c) */
  /* Room */
  size_t contacts;  /* of the impacts; those beyond are one-sided equations */
  hk_impact *row;   /* all of them */
  bool *takes_part; /* of each, at the present level */
  size_t rows_room, taking_room;
  hk_body_arms *arms_found;       /* surface_arms.c */
  hk_body_moments *moments_found; /* surface_arms.c */
  size_t arms_room, found_room;
  hk_body_response *response;
  size_t impacts, used, room;
  uint64_t epoch; /* counts the places of the bodies at which responses were found */
  struct {
    uint64_t epoch;
    size_t first; /* in `block`, of that epoch */
  } * carrier;    /* room: n, of unit impulses on each */
  size_t carriers_room;
  uint32_t *particle; /* room */
  double (*block)[9]; /* room: U, row by row */
  double (*turn)[9];  /* room: the same of moments, by the axes */
  double *before;     /* 6 n: speeds before impacts, and with the given restitution */
  double *column;     /* n x 3 */
  double *start;      /* n x 3: positions before impacts */
  uint32_t *place;    /* n: of a particle in a response */
  double *matrix;     /* for Newton's iteration */
  size_t matrix_room;
  size_t *unknown, unknown_room;
  hk_solid_program program; /* solid_newton.c */
  struct hk_solid_frame *frame;
  size_t frame_room;
  struct hk_face_contact *face; /* face_contacts.c */
  size_t *chain, face_room, chain_room;
} hk_body_impacts;

/* 1/kg: what the mobility of the particle would be if no equation held it, or what carries it. */
static inline double hk_free_mobility(const hk_model *m, uint32_t particle) {
  const hk_rider *r = m->pin[particle] == HK_PIN_RIDES ? hk_model_rider(m, particle) : NULL;
  double sum = m->inverse_mass[particle];
  for (uint32_t k = 0; r && k < r->carriers; k++) sum += r->weight[k] * r->weight[k] * m->inverse_mass[r->carrier[k]];
  return sum;
}

/* Of impact e: Coulomb's coefficient; 0 of one-sided equations. */
static inline double hk_body_friction(const hk_body_impacts *s, const hk_contact_solver *solver, size_t e) {
  if (e >= s->contacts) return 0;
  return s->frictions ? s->frictions[e] : solver->friction;
}

/* Of impact e; NULL: it has none. */
static inline hk_body_arms *hk_body_arms_of(const hk_body_impacts *s, size_t e) {
  return s->arms && e < s->contacts && hk_body_arms_any(&s->arms[e]) ? &s->arms[e] : NULL;
}

/* Of impact e; NULL: it has none. */
static inline hk_body_moments *hk_body_moments_of(const hk_body_impacts *s, size_t e) {
  return s->moments && e < s->contacts && hk_body_moments_any(&s->moments[e]) ? &s->moments[e] : NULL;
}

#endif
