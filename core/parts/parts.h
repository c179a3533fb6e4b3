/* The parts of forces (core/plugin/parts.h): in which order an evaluation goes through them, and the pass over the
 * particles that does. */
#ifndef HK_PARTS_H
#define HK_PARTS_H

#include "core/state/state.h"

/* ---- window.c: which blocks are complete when; what acts across domains ---- */

enum { HK_CROSS_PARTS = HK_DOMAINS * (HK_DOMAINS - 1) / 2 + 1, HK_ROUNDS = 2 * HK_DOMAINS };

typedef struct hk_window {
  hk_partition partition;
  uint32_t *lowest; /* parts, see hk_part_use */
  bool *late;       /* blocks: complete after all rounds */
  size_t *done; /* blocks: after part b the blocks of its domain below done[b] are complete, but for the late ones */
  size_t rounds;
  size_t round[HK_ROUNDS + 1];  /* rounds + 1: position in `cross` */
  size_t cross[HK_CROSS_PARTS]; /* the parts across domains that have elements; those of a round share no domain */
} hk_window;

/* An order for no elements at all. false: no memory, the window can be closed or begun again. */
bool hk_window_begin(hk_window *, const hk_partition *);
hk_part_use hk_window_use(hk_window *); /* where forces note their elements */
void hk_window_end(hk_window *);        /* the order for what has been noted */
void hk_window_close(hk_window *);

/* ---- wave.c: several steps at once ---- */

typedef struct hk_wave_item {
  uint32_t part;
  uint32_t block; /* the highest that it touches */
  uint32_t done;  /* so many blocks are complete after it */
  uint32_t after; /* the item of the step before that has to be complete before it */
} hk_wave_item;

typedef struct hk_wave {
  size_t items;
  hk_wave_item *item; /* in the order of a step */
  size_t depth;       /* so many steps can be under way at once; 0: there can be no wave */
} hk_wave;

/* `reach`: where the forces have noted their elements as if all blocks were of one domain. false: no memory. */
bool hk_wave_arrange(hk_wave *, const hk_window *window, const hk_window *reach);
void hk_wave_close(hk_wave *);
/* The evaluations of all levels, and their powers; computing time is measured in level `sampled`, if there is one.
 * HK_NOT_FINITE: some F is not finite. */
struct hk_parts;
hk_status hk_wave_run(struct hk_parts *, hk_level *, size_t count, size_t sampled);

/* ---- pass.c: block by block ---- */

/* What is summed at one place of an evaluation's order: a domain, a part across domains, or what is left of a domain.
 */
enum { HK_SLOTS = 2 * HK_DOMAINS + HK_CROSS_PARTS };
typedef struct hk_pass_slot {
  double power;                        /* W */
  uint64_t bad;                        /* not 0: F is not finite */
  const hk_instance *volatile at_work; /* NULL: nobody */
  double room[5];                      /* slots are a cache line apart */
} hk_pass_slot;

/* What a pass needs of a run. */
typedef struct hk_parts {
  const hk_state *state;
  const hk_pins *pins;
  const hk_shared *shared;
  const hk_instances *forces;
  const hk_view *view;      /* one per force */
  const bool *acts, *takes; /* one per force: it acts at present; it is to be included */
  bool *chosen;             /* one per force: it adds by parts */
  hk_window window;
  hk_wave wave;
  hk_pass_slot *slot; /* HK_SLOTS */
  double *seconds;    /* (forces + 1) x HK_SLOTS: sampled time; last the host's and the method's */
} hk_parts;

/* Where and how a pass is made. */
typedef struct hk_sweep {
  double t, *x, *v;
  const double *y; /* NULL: there are no channels */
  double *a;
  const hk_pass *pass; /* NULL: the method does nothing */
  bool prepared;       /* x, v and a of all particles are prepared */
  bool unfinished;     /* the method's `finish` comes later */
  bool sampled;        /* computing time is measured */
} hk_sweep;

/* Of a run whose other members are set. false: no memory. */
bool hk_parts_open(hk_parts *);
void hk_parts_close(hk_parts *);
/* Asks all forces that have started for their parts; after every change of particles. */
hk_status hk_parts_arrange(hk_parts *, hk_error *);
void hk_parts_prepare(hk_parts *, const hk_sweep *); /* all particles */
void hk_parts_finish(hk_parts *, const hk_sweep *);  /* what the method does after the evaluation, all particles */
/* Adds the parts of the acting forces to `a`, and divides by the masses. `power`, W, gets theirs and that of the pins.
 * HK_NOT_FINITE: some F is not finite. */
hk_status hk_parts_run(hk_parts *, const hk_sweep *, double *power);
/* Whether a force has no energy function or one that depends on time: the host then counts all of its power F.v as
 * work. */
bool hk_work_unaccounted(const hk_instance *force);

#endif
