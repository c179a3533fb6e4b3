/* The sum of forces block by block (core/plugin/parts.h), for one step or for several in one sweep over memory.
 *
 *   block            particles of neighbouring indices, and the elements whose highest particle is among them
 *   domain           blocks that follow each other; domains are evaluated at the same time
 *   interface block  the elements between two domains, or between more
 *   front            how far blocks are complete: no element still to come reaches down to them
 *   tile             the evaluations of one step or of several, taken together while their blocks are in the cache
 *   step in tile     one of these
 *   strip            the steps in a tile that one thread takes
 *
 * Blocks and interface blocks are the `part` of hk_force.add_part. */
#ifndef HK_BLOCKS_H
#define HK_BLOCKS_H

#include "core/engine/state/state.h"

/* ---- front.c: the order of a step, and which blocks are complete when ---- */

enum { HK_INTERFACES = HK_DOMAINS * (HK_DOMAINS - 1) / 2 + 1, HK_ROUNDS = 2 * HK_DOMAINS };

/* For a tile of one step: domains at the same time, then interface blocks in rounds, then the deferred blocks. */
typedef struct hk_front {
  hk_partition partition;
  uint32_t *lowest; /* parts, see hk_part_use */
  bool *deferred;   /* blocks: complete after all rounds */
  size_t *complete; /* blocks: after block b those of its domain below complete[b] are, but for the deferred ones */
  size_t rounds;
  size_t round[HK_ROUNDS + 1];     /* rounds + 1: position in `interface` */
  size_t interface[HK_INTERFACES]; /* interface blocks with elements; those of a round share no domain */
} hk_front;

/* An order for no elements at all. false: no memory, the front can be closed or begun again. */
bool hk_front_begin(hk_front *, const hk_partition *);
hk_part_use hk_front_use(hk_front *); /* where forces note their elements */
void hk_front_end(hk_front *);        /* the order for what has been noted */
void hk_front_close(hk_front *);

typedef struct hk_tile_item {
  uint32_t part;
  uint32_t block;    /* the highest that it touches */
  uint32_t complete; /* so many blocks are complete after it */
  uint32_t after;    /* the item of the step before that has to be done before it */
} hk_tile_item;

/* For a tile of several steps: blocks and interface blocks one after the other. */
typedef struct hk_tile_order {
  size_t items;
  hk_tile_item *item;
  size_t depth; /* so many steps can be under way at once; 0: a tile has one step */
} hk_tile_order;

/* `reach`: where the forces have noted their elements as if all blocks were of one domain. false: no memory. */
bool hk_tile_order_make(hk_tile_order *, const hk_front *, const hk_front *reach);

/* ---- tiles ---- */

/* What is summed at one place of the order: a domain, an interface block, the deferred blocks of a domain; in a tile of
 * several steps, one of them. */
enum { HK_TILE_SUMS = 2 * HK_DOMAINS + HK_INTERFACES };
typedef struct hk_tile_sum {
  double power;                        /* W */
  uint64_t bad;                        /* not 0: F is not finite */
  const hk_instance *volatile at_work; /* NULL: nobody */
  double room[5];                      /* sums are a cache line apart */
} hk_tile_sum;

/* What tiles need of a run. */
typedef struct hk_tiles {
  const hk_state *state;
  const hk_pins *pins;
  const hk_shared *shared;
  const hk_instances *forces;
  const hk_view *view;      /* one per force */
  const bool *acts, *takes; /* one per force: it acts at present; it is to be included */
  bool *chosen, *between;   /* one per force: it adds by parts; it has elements, which may lie between domains */
  hk_front front;
  hk_tile_order order;
  hk_tile_sum *sum;          /* HK_TILE_SUMS */
  double *seconds;           /* (forces + 1) x HK_TILE_SUMS: sampled time; last the host's and the method's */
  size_t sums;               /* in use in the present tile */
  const hk_instance *client; /* who asked for it */
} hk_tiles;

typedef struct hk_step_in_tile hk_step_in_tile;
struct hk_step_in_tile {
  double t, *x, *v;
  const double *y; /* NULL: there are no channels */
  double *a;
  const hk_fused *fused;       /* NULL: the method does nothing before and after */
  bool prepared;               /* x, v and a of all particles are prepared */
  bool counts;                 /* of the F that is there when a block is taken, the power is counted */
  bool unfinished;             /* what the method does after the evaluation comes later */
  bool sampled;                /* computing time is measured */
  const hk_step_in_tile *next; /* each block that is finished is prepared for this step; NULL: there is none */
};

/* ---- arrange.c: which forces are asked for parts, and in which order ---- */

/* Of a run whose other members are set. false: no memory. */
bool hk_tiles_open(hk_tiles *);
void hk_tiles_close(hk_tiles *);
/* Asks all forces that have started for their parts; after every change of particles. */
hk_status hk_tiles_arrange(hk_tiles *, hk_error *);
/* Whether a force has no energy function or one that depends on time: the host then counts all of its power F.v as
 * work. */
bool hk_work_unaccounted(const hk_instance *force);

/* ---- tile.c: the evaluations ---- */

/* What the method does before and after, for all particles. */
void hk_tiles_prepare(hk_tiles *, const hk_step_in_tile *);
void hk_tiles_finish(hk_tiles *, const hk_step_in_tile *);
/* Adds the parts of the acting forces to `a`, and divides by the masses: of one step, domain by domain, or of several,
 * up to HK_TILE_STEPS, in strips. The two orders of summation differ. `power`, W: one per step, to which that of the
 * forces and of the pins is added. HK_NOT_FINITE: some F is not finite. */
hk_status hk_tile_evaluate(hk_tiles *, const hk_step_in_tile *, double *power);
hk_status hk_tile_evaluate_several(hk_tiles *, const hk_step_in_tile *, size_t steps, double *power);

/* W, the sum of F.v over the numbers begin to end - 1. */
double hk_step_power(const double *F, const double *v, size_t begin, size_t end);

/* ---- whole.c: F of one force, whether it has `add` or parts ---- */

hk_status hk_force_add(const hk_instance *force, const hk_view *view, double *F);

#endif
