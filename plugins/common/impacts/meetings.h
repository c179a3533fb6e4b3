/* What the near pairs of a step do on its straight moves, and which of them may not: the certificate that nothing has
 * passed, and the impacts to be solved. A pair whose distances at the two ends are d_0 and d_1, and whose points move
 * by l relative to each other, is never nearer than d_0 - l and (d_0 + d_1 - l)/2; where that says nothing, continuous
 * collision detection decides. The end of a pair that moves by a small part of its distance is predicted by its normal
 * at the start. */
#ifndef HK_MEETINGS_H
#define HK_MEETINGS_H

#include "plugins/common/impacts/nearby.h"
#include "plugins/common/impacts/sweeps.h"

typedef struct hk_meetings {
  hk_nearby *nearby;
  double restitution;
  /* n, when a particle was touched last, and when the last look was: a look within a step leaves out what has not been
   * touched since. NULL: it looks at all. hk_meetings_begin sets it to that. */
  const uint64_t *touched;
  uint64_t since;
  double slack; /* m: gaps that are closed by less than this at the end of the step are accepted */
  /* What hk_meetings_look found */
  size_t unsafe;   /* pairs whose distance on the way may be less than a tenth of the thickness, or half of the first */
  size_t first;    /* the first of them: a pair of `nearby` */
  size_t unsolved; /* pairs whose gap closes, on the way or at the end; once impacts were solved, only by more than
                      `slack`, and where it was closed at the start, by more than half of that */
  double closest;  /* m, the least gap at the start; INFINITY: no pair can meet */
  /* Room */
  struct hk_pair_look *look;          /* of each of nearby->index */
  struct hk_pair_look *before;        /* the last look */
  uint32_t *before_index, *before_at; /* the pairs that it was of; of each pair, its position there */
  size_t befores, looked;             /* of them; pairs of the last look */
  uint32_t *meeting;                  /* those that may meet: positions in `look` */
  uint32_t *chosen;                   /* those of the last hk_meetings_impacts */
  bool *met;                          /* of each pair: its impact was solved in this step */
  hk_surface_pair *pushed;            /* the same pairs, for when a search within the step numbers them anew */
  size_t pushes, pushed_room;
  size_t room, meetings, choice, searches, impacts_room;
  bool solved; /* impacts of this step were solved */
  hk_impact *impact;
} hk_meetings;

/* Before the first look of a step. */
void hk_meetings_begin(hk_meetings *);
/* Looks at the pairs of nearby->index. HK_NO_MEMORY. */
hk_status hk_meetings_look(hk_meetings *, const hk_step_move *);
typedef enum hk_meetings_kind {
  HK_MEETINGS_ALL,    /* pairs that may meet in the step */
  HK_MEETINGS_CLOSED, /* pairs whose gap is closed at the start */
  HK_MEETINGS_UNSAFE
} hk_meetings_kind;

/* The impacts of these pairs, in the order of the list, valid until the next call. HK_NO_MEMORY. */
hk_status hk_meetings_impacts(hk_meetings *, const hk_step_move *, hk_meetings_kind, hk_impacts *);
/* After all that may meet are solved: remembers which of them were. */
void hk_meetings_remember(hk_meetings *, const hk_impacts *);
/* Whether, on the way that was looked at last, a pair goes into each other, fast, of which impulses have moved a
 * particle since the count `since` of hk_impacts.now: it meets after another impact, or once more, which one straight
 * move does not tell. */
bool hk_meetings_again(const hk_meetings *, const hk_step_move *, const uint64_t *moved, uint64_t since);
/* Of the look before: the pairs whose gap was closed at the start of the step by more than the slack. */
typedef struct hk_meetings_closed {
  size_t count;
  double depth;                /* m, the largest */
  const hk_surface_pair *pair; /* of it; NULL: none */
} hk_meetings_closed;

hk_meetings_closed hk_meetings_closed_at_start(const hk_meetings *);
void hk_meetings_free(hk_meetings *);

#endif
