/* The pairs among which a barrier acts.
 *
 * `near` holds the candidate pairs of the present move, those that may come within the barrier's distance: they are
 * searched with a margin, and kept while no particle has moved by more than that since the search. `named` holds the
 * pairs that have blocks in the matrix: it changes when a pair without blocks comes near, so that contacts that open
 * and close again leave the pattern as it is. Invariants: both rise by hk_pair_compare, so that sums over acting pairs
 * have one order whatever else the search found; an acting pair has a name.
 *
 * Both this and the pair cache ask the service surfaces, and so the one broad phase of contact/candidates; they differ
 * in how long they keep what it finds. The margin here is of all particles, where the pair cache has budgets of
 * patches: implicit steps ask at every iteration, far from their start, and names need every pair within the margin,
 * whenever the last search was. Tried: the pair cache in place of the margin. Of a sheet that is wound up a search took
 * 2.2e6 instructions in place of 3.8e6, with the same bits after 0.1 s. Of a stack of sheets, 0.2 s, one thread of a
 * Xeon, searches took 2.9 s in place of 3.6, of a run of 67 s, and the bits were others: the run went another way, in
 * 34 steps for 24 (scripts/scenes/twist.lua and stack.lua, contact=barrier). */
#ifndef HK_BARRIER_CONTACTS_H
#define HK_BARRIER_CONTACTS_H

#include "plugins/common/contact/candidates/pair_order.h"
#include "plugins/common/contact/barrier/barrier_shape.h"

enum {
  HK_BARRIER_GRAIN = 512, /* pairs of a chunk, some 30 us */
  HK_BARRIER_BATCH = 1024 /* pairs whose Hessians are computed, by all threads, before they are added */
};

/* The margin of the search and of the names, in parts of the barrier's distance. */
#define HK_BARRIER_MARGIN 0.5

/* Of a chunk of `near`. */
typedef struct hk_barrier_tally {
  uint32_t acting, touching; /* pairs */
} hk_barrier_tally;

typedef struct hk_barrier_contacts {
  const hk_host *host;
  const hk_surfaces *surfaces;
  hk_barrier_law law;
  /* fields */
  hk_array near;     /* hk_barrier_pair; scratch */
  hk_array named;    /* hk_feature_pair */
  hk_array base;     /* double, n x 3: the positions for which `near` was found; scratch */
  hk_array kept_of;  /* uint32_t, of each chunk of what was found; scratch */
  hk_array halves;   /* hk_feature_pair: what was found, and ends of strands; scratch */
  hk_array values;   /* hk_barrier_value, as many as `near`; see below; scratch */
  hk_array tally;    /* hk_barrier_tally, one of each chunk of `near`; scratch */
  hk_array acting;   /* uint32_t, positions in `values`; scratch */
  hk_array at;       /* double, n x 3: the positions of `values`; scratch */
  hk_array way;      /* double, n x 3: the present move; scratch */
  hk_array sums;     /* double, one of each chunk; scratch */
  hk_array parts;    /* double, two of each chunk; scratch */
  hk_array loads;    /* double, 12 of each pair that acts; scratch */
  hk_array hessians; /* hk_barrier_hessian, HK_BARRIER_BATCH; scratch */
  hk_pair_sorter sorter;
  double *shape; /* hk_barrier_shape of the n particles */
  /* others */
  size_t found, acting_count, touching; /* pairs: near, acting, and of these without a gap */
  bool evaluated;                       /* `acting` is that of `at` and of this stiffness */
  double evaluated_stiffness;           /* Pa */
  bool *on_surface;                     /* n, whether the particle belongs to a triangle */
  uint64_t number;                      /* of the surfaces' lists that `near` and `shape` belong to; 0: none */
  bool kept;                            /* `near` holds for all moves within the margin around `base` */
} hk_barrier_contacts;

/* Forgets all pairs, when particles have other indices. HK_NO_MEMORY. */
hk_status hk_barrier_forget(hk_barrier_contacts *);
/* For hk_force.update: finds the candidates of the straight move to x_to. *changed is set where the blocks differ. */
hk_status hk_barrier_find(hk_barrier_contacts *, const hk_view *from, const double *x_to, bool *changed);
/* Its last part: tells the pairs their names, and gives names where one has none that may act on the first `part` of
 * the move. */
hk_status hk_barrier_update_names(hk_barrier_contacts *, double part, bool *changed);
/* For hk_force.step_limit. */
double hk_barrier_limit(hk_barrier_contacts *, const hk_view *from, const double *dx);

/* ---- barrier_values.c: the pairs that act at some positions, with their energies and derivatives: evaluated once for
 * each state, whatever asks for it, force, energy, blocks or the record of an accepted step ---- */

/* Makes `acting`, in the order of `near`, those of the positions x. Evaluates nothing where they are already. */
void hk_barrier_values_at(hk_barrier_contacts *, const hk_view *view);
const hk_barrier_value *hk_barrier_acting(const hk_barrier_contacts *, size_t k); /* k < acting_count */

#endif
