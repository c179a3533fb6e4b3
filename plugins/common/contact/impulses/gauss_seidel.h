/* The impulses that keep all impacts of a step at once: complementarity with Coulomb friction, by Gauss-Seidel sweeps
 * over the impacts in their order, each solved for its own impulses with the others held (Moreau 1988; Jean 1999). The
 * sums of an impact's impulses are kept, not their changes: an impulse along the normal never pulls, and
 * is reduced where a neighbour's has replaced it. An impact is solved again only after one of its particles has moved,
 * so that sweeps become short. */
#ifndef HK_GAUSS_SEIDEL_H
#define HK_GAUSS_SEIDEL_H

#include "plugins/common/contact/impulses/impact.h"

typedef struct hk_contact_solver {
  size_t count;
  hk_impact *impact;
  double friction;
  double tolerance;  /* m: a solution that changes its own distance by no more does not count as a move */
  size_t most;       /* sweeps */
  uint64_t *moved;   /* n: the last solution that moved a particle; kept by the caller, 0 at first */
  uint64_t *touched; /* n: the same, tolerance 0 */
  uint64_t now;      /* the number of solutions so far; kept by the caller */
} hk_contact_solver;

typedef struct hk_gauss_seidel_result {
  size_t sweeps;  /* of the positions */
  size_t pushing; /* impacts with an impulse */
  double impulse; /* N s, sum of the sizes of the impulses along normals */
} hk_gauss_seidel_result;

/* Changes x and v of the move. */
hk_gauss_seidel_result hk_gauss_seidel(hk_contact_solver *, hk_step_move *);

#endif
