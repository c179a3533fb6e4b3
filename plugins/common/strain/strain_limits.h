/* Edges whose lengths are kept between limits by moves along them, one edge after the other, in sweeps (Provot
 * 1995). The move of an edge is shared by the inverse masses of its ends, so that the centre of mass stays; a
 * pinned end stays, and one that slides moves along its pin.
 *
 * Which edges are beyond their limits is found without roots, many at a time (strain_screen.c): most are not. A sweep
 * then visits those alone, and those that a move has touched. An edge that is not visited has the length at which it
 * was last found within its limits, so that the result is, bit for bit, that of a sweep over all of them. */
#ifndef HK_STRAIN_LIMITS_H
#define HK_STRAIN_LIMITS_H

#include "plugins/common/strain/marks.h"

typedef enum hk_strain_order {
  HK_STRAIN_GIVEN,    /* of the list */
  HK_STRAIN_OUTWARDS, /* from the pins outwards; the end that is nearer to a pin stays */
  HK_STRAIN_SORTED    /* what is farthest beyond its limit first */
} hk_strain_order;

/* Edges that are screened together. */
typedef struct hk_strain_block {
  size_t begin, count;
  bool run;                   /* the edges are (i+t, j+t) */
  double shortest2, longest2; /* m^2: of a square between the two no edge of the block is beyond its limits */
} hk_strain_block;

enum { HK_STRAIN_BLOCK = 256 /* edges at most: one that is beyond makes all of a block be looked at */ };

typedef struct hk_strain_limits {
  /* The caller's, to be set before hk_strain_build. */
  size_t n, count;           /* particles, edges */
  const uint32_t (*pair)[2]; /* count */
  const double (*limit)[2];  /* count: shortest and longest, m */
  double slack;              /* part of a limit by which it may be passed without a move */
  hk_strain_order order;
  /* strain_screen.c */
  size_t blocks;
  bool runs; /* there are any */
  hk_strain_block *block;
  bool *beyond;             /* blocks: an edge of it may be beyond */
  double *apart;            /* 3n: all x, all y, all z */
  uint32_t *edge_of;        /* count: the edge at each place of the blocks */
  uint32_t (*looked_at)[2]; /* count, by place: its ends */
  double (*square)[2];      /* count, by place: of its limits with the slack, m^2 */
  /* strain_order.c: the order of a sweep, and the ranks of each particle's edges, incident[start[i]] and so on */
  uint32_t *edge_at, *rank_of; /* count */
  size_t *start;               /* n + 1 */
  uint32_t *incident;          /* 2 count */
  uint32_t *level;             /* n: edges from the next pin; UINT32_MAX: no pin is connected */
  uint32_t *queue;             /* n, scratch */
  uint8_t *pin;                /* n: the pins that order and slides were made for */
  uint32_t *slide;             /* n: place in `projector`, or HK_NO_STRAIN_SLIDE */
  double (*projector)[9];      /* n at most; by rows: onto the directions that a slide allows */
  double *scratch;             /* 3n */
  bool ordered;
  /* strain_sweep.c */
  hk_marks now, next; /* of ranks: to be visited in this sweep, in the next */
  hk_marks moved;     /* in this step */
  double *excess;     /* count, for HK_STRAIN_SORTED */
  uint32_t *list;     /* count, scratch */
  /* strain_velocity.c: velocities from before the sweeps, of the particles that have been touched */
  size_t remembered;
  uint32_t *touched;   /* n */
  double (*before)[3]; /* n */
  bool *is_touched;    /* n */
} hk_strain_limits;

static const uint32_t HK_NO_STRAIN_SLIDE = UINT32_MAX;

/* In the host's memory. HK_NO_MEMORY: it can only be freed. */
hk_status hk_strain_build(hk_strain_limits *, const hk_host *host);
void hk_strain_free(hk_strain_limits *, const hk_host *host);

/* Takes note of the pins; cheap where they are as before. */
void hk_strain_pins(hk_strain_limits *, const hk_view *view, const hk_correction *c);

/* Sets `now` for edges that are beyond their limits; false: none is. */
bool hk_strain_screen(hk_strain_limits *, const hk_host *host, const double *x);

typedef struct hk_strain_state {
  double *x, *v; /* n x 3; v: NULL when velocities are to stay as they are */
  const double *inverse_mass;
} hk_strain_state;

/* What sweeps did, and what they left. */
typedef struct hk_strain_result {
  size_t sweeps, moves;
  size_t left;   /* edges that are still beyond a limit */
  double excess; /* of these the largest part of a limit by which one is beyond */
  size_t worst;  /* that edge */
} hk_strain_result;

/* At most `most` sweeps over what was screened, fewer where nothing is left to move. */
hk_strain_result hk_strain_sweep(hk_strain_limits *, const hk_strain_state *, size_t most);

/* m, by how much the worst edge is beyond its limit, without slack; 0: none is. */
double hk_strain_violation(const hk_strain_limits *, const double *x);

/* ---- strain_move.c: of one edge ---- */

/* The limit, m, that the edge is beyond, and its length; 0: it is within its limits and the slack. */
double hk_strain_passed(const hk_strain_limits *, size_t edge, const double *x, double *length);
/* Moves the ends to the limit that the edge is beyond, and remembers their velocities; false: it is not, or cannot be
 * moved. */
bool hk_strain_move(hk_strain_limits *, size_t edge, const hk_strain_state *);
/* Takes the speed with which an edge at a limit goes on beyond it by an impulse along it; false: there is none. */
bool hk_strain_stop(const hk_strain_limits *, size_t edge, const hk_strain_state *);

/* ---- strain_velocity.c ---- */

/* Gives velocities back as they were, and takes from them, in some sweeps, what leads the edges in `moved` beyond their
 * limits. */
void hk_strain_stop_moved(hk_strain_limits *, const hk_strain_state *);
/* At the end of a step: no velocity is remembered, no edge marked as moved. */
void hk_strain_forget(hk_strain_limits *);

/* ---- shared by these files ---- */

hk_status hk_strain_cut(hk_strain_limits *, const hk_host *host);
hk_status hk_strain_reserve(hk_strain_limits *, const hk_host *host);

/* Heap sort, since no memory may be taken during a step. `before`: whether e comes before f. */
typedef bool hk_strain_before(const hk_strain_limits *, uint32_t e, uint32_t f);
void hk_strain_sort(const hk_strain_limits *, uint32_t *list, size_t count, hk_strain_before *before);

#endif
