/* The impulses of the last step as the first guess of this one's: in a heap at rest they are nearly the same, and
 * without them each step would hand the weight down from layer to layer once more, a layer a sweep (Moreau 1999,
 * Numerical aspects of the sweeping process, section 5; Catto 2005, Iterative dynamics with temporal coherence). They
 * are kept as forces, which hold for another length of the step. What is no longer needed the sweeps take away: the sum
 * of the impulses of a pair may shrink to 0. Nine tenths are given, and all of them where the solver is calm or
 * impacts are of bodies, which are solved together.
 *
 * The memory is a table with free places, found by the features of a pair (Knuth 1998, The Art of Computer Programming,
 * volume 3, 6.4, linear probing), as lists number pairs anew. It is a field of the plugin, width sizeof(hk_warm_pair),
 * so that checkpoints carry it; particles in it are compared, and never used as indices. */
#ifndef HK_WARM_START_H
#define HK_WARM_START_H

#include "core/plugin.h"
#include "plugins/common/contact/impulses/gauss_seidel.h"

typedef struct hk_warm_pair {
  uint64_t key[2];                  /* of two edges the lesser one first */
  double push[2], slide[2][3];      /* N: of the positions, push/h^2, and of the velocities, push/h */
  uint32_t first[2], kind, present; /* the first two particles, for the sense of the slide; 0: the place is free */
} hk_warm_pair;

/* Gives the solver's impacts, whose levels are set, the impulses of the pairs that are known. bodies: impacts whose
 * mobility is not known as yet may be of bodies, and are given theirs as well. */
void hk_warm_start_give(const hk_array *known, const hk_contact_solver *, const hk_step_move *, bool bodies);
/* After a solution: forgets what was known and keeps the impulses of the impacts that push. HK_NO_MEMORY. */
hk_status hk_warm_start_keep(hk_array *known, const hk_host *, const hk_contact_solver *, double h);

#endif
