/* Walls of a liquid by particles that its pressure moves: points of rigid bodies (riders), and particles of cloth and
 * strands that are named as walls (Akinci, Ihmsen, Akinci, Solenthaler and Teschner 2012, ACM Trans. Graphics 31,
 * article 62, section 4: what a wall does to the liquid acts on it with the opposite sign).
 *
 * An impulse on a point is one on its carriers, by their weights. What carriers that constraints join answer, dv = R p,
 * is asked of the host ("bodies/1") and kept as R = L L^T (Cholesky, with pivots): the columns of L, the modes, are as
 * many as the ways in which they can move, six of a free body. An answer then takes no solution of equations, and the
 * momentum of liquid and bodies together stays to rounding.
 *
 * For Jacobi's iteration the bodies' part of the pressure's matrix, the sum over modes of y y^T with y_i what a unit
 * multiplier of particle i gives to the mode, is bounded by the diagonal sum of |y_i| sum_j |y_j| (Gershgorin, mode by
 * mode): it converges however light a body is, the slower the lighter. */
#ifndef HK_SPH_BODIES_H
#define HK_SPH_BODIES_H

#include "plugins/common/sph/sph_list.h"

/* A wall that moves; its carriers count in hk_sph_bodies.carrier. */
typedef struct hk_sph_mover {
  uint32_t particle, carriers, carrier[HK_CARRIERS];
  double weight[HK_CARRIERS];
  double pressed[3], impulse[3]; /* N s, of the last solve; of all solves of a step */
} hk_sph_mover;

/* Carriers that move together, `carriers` of them from `first` on. */
typedef struct hk_sph_group {
  size_t first, carriers, modes, L; /* L: where in hk_sph_bodies.L its modes x 3 carriers begin, 1/sqrt(kg) */
  bool alone;                       /* one particle that no constraint has */
  bool touched;
} hk_sph_group;

typedef struct hk_sph_bodies {
  const hk_body_service *service;
  hk_sph_mover *mover;
  hk_sph_group *group;
  uint32_t *carrier;    /* particles */
  uint32_t *owner;      /* carriers: the group of each */
  uint32_t *mover_of;   /* n: the mover that a particle is, from 1; 0: none */
  uint32_t *carrier_of; /* n: the carrier that a particle is, from 1; 0: none */
  uint32_t *wet;        /* particles of the liquid beside movers */
  uint32_t *touched;    /* groups that one of them touches */
  double (*push)[3];    /* carriers: N s */
  double (*start)[3];   /* carriers: m/s, at the end of the free step */
  double *L, *R;        /* modes of all groups; answers of one, 1/kg */
  double *response;     /* n x 3, m/s */
  double (*share)[3];   /* carriers: of three modes, sum of |y_j|; a group has no more than three times its carriers */
  double *coupling;     /* n, as hk_sph_list.diagonal: the bound on the bodies' part of its row */
  size_t movers, groups, carriers, wets, touches, n;
  size_t mover_room, group_room, carrier_room, owner_room, mover_of_room, carrier_of_room, wet_room, touched_room,
      push_room, start_room, L_room, R_room, response_room, share_room, coupling_room;
  bool joined; /* constraints act in the scene */
  bool said;
} hk_sph_bodies;

/* In `create`. */
void hk_sph_bodies_open(hk_sph_bodies *, const hk_host *);
/* In `topology`. */
static inline void hk_sph_bodies_forget(hk_sph_bodies *b) { b->n = 0; }
/* The movers, and how they answer where the correction has them. HK_NO_MEMORY, HK_FAILED, with a message. */
hk_status hk_sph_bodies_begin(hk_sph_bodies *, const hk_sph *, const hk_view *, const hk_correction *);
/* With the list of neighbours, after _begin: `coupling`. */
void hk_sph_bodies_couple(hk_sph_bodies *, const hk_sph *, const hk_sph_list *, const hk_periodic_box *);
/* v (n x 4) of movers is the impulse on them, N s; they, and what carries them, get velocities instead. before: n x 3,
 * m/s, without impulses. */
void hk_sph_bodies_answer(hk_sph_bodies *, const double *before, double (*v)[4]);
/* Before the solves of a step: `impulse` is theirs. After one: its impulses count. */
void hk_sph_bodies_clear(hk_sph_bodies *);
void hk_sph_bodies_keep(hk_sph_bodies *);
/* What carries the movers moves by what pressure has changed in its velocity, for the length of the step, and is
 * brought onto its constraints; the movers follow. Whether anything has moved. The errors are the constraints'. */
hk_status hk_sph_bodies_move(hk_sph_bodies *, const hk_view *, hk_correction *, bool *moved);
/* As hk_corrector.mean_forces; h: s, of the last step. */
void hk_sph_bodies_forces(const hk_sph_bodies *, double h, double *F);

#endif
