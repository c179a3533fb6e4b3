/* The impulses that keep all impacts of a step at once: complementarity with Coulomb friction, by Gauss-Seidel sweeps
 * over the impacts in their order, each solved for its own impulses with the others held (Moreau 1988; Jean 1999). The
 * sums of an impact's impulses are kept, not their changes: an impulse along the normal never pulls, and what a
 * neighbour has made needless is taken back. An impact of which no particle has moved since it was solved is passed
 * over, so that sweeps become short. */
#ifndef HK_SWEEPS_H
#define HK_SWEEPS_H

#include "plugins/common/impacts/impact.h"

typedef struct hk_impacts {
  size_t count;
  hk_impact *impact;
  double friction;
  double tolerance;  /* m: an impact that changes its own distance by no more wakes no other */
  size_t most;       /* sweeps */
  uint64_t *moved;   /* n: when a particle was moved last, counted in impacts solved; kept by the caller, 0 at first */
  uint64_t *touched; /* n: the same, by however little */
  uint64_t now;      /* that count; kept by the caller */
} hk_impacts;

typedef struct hk_sweeps_done {
  size_t sweeps;  /* of the positions */
  size_t pushing; /* impacts with an impulse */
  double impulse; /* N s, sum of the sizes of the impulses along normals */
} hk_sweeps_done;

/* Changes x and v of the move. */
hk_sweeps_done hk_impacts_solve(hk_impacts *, hk_step_move *);

#endif
