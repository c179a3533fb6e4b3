/* The impulses that keep all impacts of a step at once: complementarity with Coulomb friction, by Gauss-Seidel sweeps
 * over the impacts in their order, each solved for its own impulses with the others held (Moreau 1988; Jean 1999). The
 * sums of an impact's impulses are kept, not their changes: an impulse along the normal never pulls, and
 * is reduced where a neighbour's has replaced it. An impact is solved again only after one of its particles has moved,
 * so that sweeps become short (awake.h).
 *
 * What sweeps leave becomes motion: speeds of about tolerance/h. Where nothing else moves, hk_gauss_seidel_calm lowers
 * the tolerance with the motion, step by step, so that what rests comes to rest. */
#ifndef HK_GAUSS_SEIDEL_H
#define HK_GAUSS_SEIDEL_H

#include "plugins/common/contact/impulses/awake.h"

typedef struct hk_contact_solver {
  size_t count;
  hk_impact *impact;
  double friction;
  double tolerance;  /* m: a solution that changes its own distance by no more does not count as a move */
  double calm;       /* 0: with this tolerance; to 1: with a lower one, by this part (hk_gauss_seidel_calm) */
  double near;       /* m, with `calm`: the tolerance before; gaps that are no larger are contact that lasts */
  size_t most;       /* sweeps */
  uint64_t *moved;   /* n: the last solution that moved a particle; kept by the caller, 0 at first */
  uint64_t *touched; /* n: the same, tolerance 0 */
  uint64_t now;      /* the number of solutions so far; kept by the caller */
  hk_awake *awake;   /* for hk_gauss_seidel: filled with the impacts by hk_awake_list */
} hk_contact_solver;

typedef struct hk_gauss_seidel_result {
  size_t sweeps;  /* of the positions */
  size_t pushing; /* impacts with an impulse */
  double impulse; /* N s, sum of the sizes of the impulses along normals */
} hk_gauss_seidel_result;

/* Of a step of h s, before the impacts are solved: lowers the tolerance to a hundredth of h times the largest motion of
 * the impacts at the start of the step (hk_impact.motion), down to `least` m, and says in `calm` by how much. It is one
 * for all impacts: where those of a step differ, what the coarse ones leave keeps the fine ones moving. */
void hk_gauss_seidel_calm(hk_contact_solver *, double h, double least);
/* Changes x and v of the move. */
hk_gauss_seidel_result hk_gauss_seidel(hk_contact_solver *, hk_step_move *);

#endif
