/* The pairs among which a barrier acts.
 *
 * `near` holds all pairs that may come nearer than the barrier's distance on the present move, and more: it is found
 * with a margin, and kept while no particle is farther than that from where it was then. `named` holds the pairs that
 * have blocks in the matrix: it changes when a pair comes near that has none, so that contacts that open and close
 * again leave the pattern as it is. Invariants: both rise by hk_barrier_order, so that sums over pairs that act have
 * one order whatever else was found; a pair that acts has a name. */
#ifndef HK_BARRIER_CONTACTS_H
#define HK_BARRIER_CONTACTS_H

#include "plugins/common/barrier/barrier_shape.h"

enum {
  HK_BARRIER_GRAIN = 512, /* pairs of a chunk, some 30 us */
  HK_BARRIER_BATCH = 2048 /* pairs whose Hessians are computed, by all threads, before they are added */
};

typedef struct hk_barrier_contacts {
  const hk_host *host;
  const hk_surfaces *surfaces;
  hk_barrier_law law;
  /* fields */
  hk_array near;     /* hk_barrier_pair; scratch */
  hk_array named;    /* hk_surface_pair */
  hk_array base;     /* double, n x 3: the positions for which `near` was found; scratch */
  hk_array sums;     /* double, one of each chunk of `near`; scratch */
  hk_array loads;    /* double, 12 of each pair of `near`; scratch */
  hk_array acting;   /* uint32_t, positions in `near`; scratch */
  hk_array hessians; /* double, HK_BARRIER_BATCH x 144; scratch */
  double *shape;     /* hk_barrier_shape of the n particles */
  /* others */
  size_t found;
  bool *on_surface; /* n, whether the particle belongs to a triangle */
  uint64_t number;  /* of the surfaces' lists that `near` and `shape` belong to; 0: none */
  bool kept;        /* `near` holds for all moves within the margin around `base` */
} hk_barrier_contacts;

int hk_barrier_order(const hk_surface_pair *, const hk_surface_pair *); /* as strcmp */
/* Forgets all pairs, when particles have other indices. HK_NO_MEMORY. */
hk_status hk_barrier_forget(hk_barrier_contacts *);
/* For hk_force.update: finds what may act on the straight move to x_to. `also`: pairs that need blocks as well, rising;
 * *changed is set where the blocks differ. */
hk_status hk_barrier_find(hk_barrier_contacts *, const hk_view *from, const double *x_to, const hk_surface_pair *also,
                          size_t also_count, bool *changed);
/* For hk_force.step_limit. */
double hk_barrier_limit(hk_barrier_contacts *, const hk_view *from, const double *dx);

#endif
