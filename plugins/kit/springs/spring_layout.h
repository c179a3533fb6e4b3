/* Forces of damped springs, many at a time. With d = x_j - x_i, l = |d|, u = v_j - v_i, each spring has the scale
 *     s = k (1 - L/l) + c (u.d)/l^2,      i gets the force s d and j gets -s d.
 * At l = 0 both are zero (the threshold is HK_SPRING_TINY in edge.h); a spring with L = 0 is smooth there.
 *
 * The layout is made once per topology. Springs are sorted by the parts of a sum (core/plugin/parts.h), which run on
 * several threads without conflicts; sums have a fixed order, so results do not depend on the number of threads. Inside
 * a part, runs of springs (i+t, j+t) are found, whose particles are read and written as contiguous vectors and need no
 * indices; a few may be missing in one, so that the rows of a grid, or the strands of a hair, are one run. The other
 * springs are a list, sorted by both ends. The loops over springs are in spring_kernel.h. */
#ifndef HK_SPRING_LAYOUT_H
#define HK_SPRING_LAYOUT_H

#include "plugins/kit/parts/part_lists.h"
#include "plugins/kit/springs/edge_order.h"
#include <stdlib.h>
#include <string.h>

/* The places of a run or list are a multiple of HK_SPRING_LANES; HK_SPRING_WIDEST equal numbers stand for a common
 * coefficient. */
enum { HK_SPRING_LANES = 4, HK_SPRING_WIDEST = 8 };

typedef enum hk_spring_kind {
  HK_SPRING_RUN,   /* (i+t, j+t), t = 0, 1, ..., but for a few t: as in a grid, whose rows follow each other */
  HK_SPRING_LIST,  /* any pairs without the last particle (vector loads reach one number beyond a particle) */
  HK_SPRING_SINGLE /* any pairs, one at a time */
} hk_spring_kind;

typedef struct hk_spring_run {
  hk_spring_kind kind;
  uint32_t i, j;        /* of a run: its first pair */
  size_t begin, count;  /* springs of the layout */
  size_t place, places; /* their coefficients; a run has places for springs that are missing in it as well */
  size_t bits;          /* of a run: position in `present` */
  size_t pair;          /* of the others: position of the first one in `pair` */
} hk_spring_run;

typedef struct hk_spring_layout {
  size_t count, places;
  uint32_t (*pair)[2];         /* of the springs in no run */
  uint8_t *present;            /* a bit for each place of a run, the lowest of a byte first; a run begins with a byte */
  double *k, *c, *L;           /* HK_SPRING_WIDEST times the number when all are equal; otherwise one for each place */
  bool each_k, each_c, each_L; /* the coefficient differs from spring to spring */
  bool damped;                 /* some c > 0 */
  int width;                   /* hk_host.lanes */
  hk_partition partition;
  size_t runs;
  hk_spring_run *run;
  size_t *part;  /* partition.parts + 1: runs of a part */
  double *power; /* partition.parts, W, of hk_spring_forces */
} hk_spring_layout;

/* The ends of the spring at place t of a run; false: there is none. */
static inline bool hk_spring_ends(const hk_spring_layout *s, const hk_spring_run *run, size_t t, uint32_t end[2]) {
  bool listed = run->kind != HK_SPRING_RUN;
  end[0] = listed ? s->pair[run->pair + t][0] : run->i + (uint32_t)t;
  end[1] = listed ? s->pair[run->pair + t][1] : run->j + (uint32_t)t;
  return listed || s->present[run->bits + t / 8] >> t % 8 & 1;
}

/* From edges and coefficients (common or one per edge), in the host's memory. Springs with an end where `is_active` is
 * false are omitted (NULL: all particles are active). After HK_NO_MEMORY the layout can only be freed. */
static inline hk_status hk_spring_layout_build(hk_spring_layout *, const hk_host *host, const hk_partition *,
                                               const hk_tuples *edges, const hk_per_tuple *k, const hk_per_tuple *c,
                                               const hk_per_tuple *L, const bool *is_active);
static inline void hk_spring_layout_free(hk_spring_layout *, const hk_host *host);
static inline void hk_spring_layout_touch(const hk_spring_layout *,
                                          const hk_part_use *use); /* what hk_force.parts has to do */

/* ---- how ---- */

/* The order in which springs are summed (see spring_kernel.h): by part, runs are found by a scan, and the other springs
 * are sorted. Everything is linear in the number of springs. */

/* The places of a run are a multiple of HK_SPRING_LANES; the springs at its end beyond that join the list. */
enum {
  HK_SPRING_PIECE = 1024, /* largest number of places in a run, whose particles fit the second-level cache with those of
                             other runs */
  HK_SPRING_SMALL = 8     /* up to this number springs are summed one at a time */
};

typedef struct hk_spring_builder {
  const hk_host *host;
  hk_spring_layout *layout;
  const hk_tuples *edges;
  size_t n;
  hk_part_lists by_part;
  uint32_t *order, *scratch; /* edges in the layout's order; room for all springs */
  size_t *count;             /* of keys */
  uint8_t *present;          /* room for those of any runs */
  size_t run_capacity, listed, bytes;
} hk_spring_builder;

/* The higher end, by which lists are sorted. */
static inline uint32_t hk_spring_edge_owner(const hk_spring_builder *b, uint32_t e) {
  const uint32_t *pair = hk_tuple(b->edges, e);
  return pair[0] > pair[1] ? pair[0] : pair[1];
}

static inline uint32_t hk_spring_edge_other(const hk_spring_builder *b, uint32_t e) {
  return hk_tuple(b->edges, e)[0] ^ hk_tuple(b->edges, e)[1] ^ hk_spring_edge_owner(b, e);
}

/* A stable counting sort, of the keys that occur. */
static inline void hk_spring_sort(hk_spring_builder *b, uint32_t *list, size_t count,
                                  uint32_t (*key)(const hk_spring_builder *b, uint32_t edge)) {
  uint32_t least = UINT32_MAX, most = 0;
  for (size_t e = 0; e < count; e++) {
    uint32_t value = key(b, list[e]);
    least = value < least ? value : least;
    most = value > most ? value : most;
  }
  if (count == 0) return;
  memset(b->count, 0, (most - least + 2) * sizeof *b->count);
  for (size_t e = 0; e < count; e++) b->count[key(b, list[e]) - least + 1]++;
  for (size_t k = 0; k < most - least; k++) b->count[k + 1] += b->count[k];
  for (size_t e = 0; e < count; e++) b->scratch[b->count[key(b, list[e]) - least]++] = list[e];
  memcpy(list, b->scratch, count * sizeof *list);
}

static inline bool hk_spring_add_run(hk_spring_builder *b, hk_spring_kind kind, size_t begin, size_t count) {
  hk_spring_layout *s = b->layout;
  if (count == 0) return true;
  if (s->runs == b->run_capacity) {
    size_t capacity = 2 * b->run_capacity + 16;
    hk_spring_run *grown = b->host->allocate(b->host, capacity * sizeof *grown);
    if (!grown) return false;
    if (s->runs) memcpy(grown, s->run, s->runs * sizeof *grown);
    b->host->release(b->host, s->run);
    s->run = grown;
    b->run_capacity = capacity;
  }
  const uint32_t *first = hk_tuple(b->edges, b->order[begin]);
  s->run[s->runs++] = (hk_spring_run){kind, first[0], first[1], begin, count, 0, count, 0, b->listed};
  if (kind != HK_SPRING_RUN) b->listed += count;
  return true;
}

static inline bool hk_spring_touches_last(const hk_spring_builder *b, uint32_t e) {
  return hk_tuple(b->edges, e)[0] == b->n - 1 || hk_tuple(b->edges, e)[1] == b->n - 1;
}

static inline int hk_spring_by_particle(const void *a, const void *b) {
  const hk_spring_run *p = a, *q = b;
  if (p->i != q->i) return p->i < q->i ? -1 : 1;
  return (p->begin > q->begin) - (p->begin < q->begin);
}

/* Sorts the runs of a part by their particles, so that runs of different directions use the same particles while these
 * are in the cache. */
static inline void hk_spring_sort_runs(hk_spring_builder *b, size_t first_run, size_t begin) {
  hk_spring_layout *s = b->layout;
  size_t placed = 0;
  if (s->runs - first_run < 2) return;
  qsort(s->run + first_run, s->runs - first_run, sizeof *s->run, hk_spring_by_particle);
  for (size_t r = first_run; r < s->runs; r++) {
    hk_spring_run *run = &s->run[r];
    memcpy(b->scratch + placed, b->order + run->begin, run->count * sizeof *b->scratch);
    run->begin = begin + placed;
    placed += run->count;
  }
  memcpy(b->order + begin, b->scratch, placed * sizeof *b->scratch);
}

/* A run of `count` springs from `begin` on, which is a piece of one whose first spring has the ends p. */
static inline bool hk_spring_add_piece(hk_spring_builder *b, const uint32_t p[2], size_t from, size_t places,
                                       size_t begin, size_t count) {
  if (count == 0) return true; /* nothing but a gap */
  if (!hk_spring_add_run(b, HK_SPRING_RUN, begin, count)) return false;
  hk_spring_run *run = &b->layout->run[b->layout->runs - 1];
  run->i = p[0] + (uint32_t)from, run->j = p[1] + (uint32_t)from;
  run->places = places;
  run->bits = b->bytes;
  for (size_t e = begin; e < begin + count; e++) {
    size_t t = hk_tuple(b->edges, b->order[e])[0] - run->i;
    b->present[b->bytes + t / 8] |= (uint8_t)(1u << t % 8);
  }
  b->bytes += (places + 7) / 8;
  return true;
}

/* `count` springs from `begin` on of one run, in pieces. */
static inline bool hk_spring_add_pieces(hk_spring_builder *b, size_t begin, size_t count, size_t places) {
  const uint32_t *first = hk_tuple(b->edges, b->order[begin]);
  size_t end = begin + count;
  for (size_t from = 0; from < places; from += HK_SPRING_PIECE) {
    size_t length = places - from < HK_SPRING_PIECE ? places - from : HK_SPRING_PIECE, after = begin;
    while (after < end && hk_tuple(b->edges, b->order[after])[0] - first[0] < from + length) after++;
    if (!hk_spring_add_piece(b, first, from, length, begin, after - begin)) return false;
    begin = after;
  }
  return true;
}

/* Of `length` springs those in the first `places` of their run. */
static inline size_t hk_spring_within(const hk_spring_builder *b, const uint32_t *order, size_t length, size_t places) {
  while (length > 0 && hk_tuple(b->edges, order[length - 1])[0] - hk_tuple(b->edges, order[0])[0] >= places) length--;
  return length;
}

/* Takes the runs out of `count` springs from `begin` on, which leaves others; *taken: how many springs runs have. */
static inline bool hk_spring_take_runs(hk_spring_builder *b, size_t begin, size_t count, uint32_t *others,
                                       size_t *taken) {
  uint32_t *order = b->order + begin;
  size_t placed = 0, rest = 0;
  for (size_t e = 0; e < count;) {
    size_t places, length = hk_edge_run(b->edges, order + e, count - e, &places);
    places -= places % HK_SPRING_LANES;
    size_t whole = places >= HK_RUN_MIN ? hk_spring_within(b, order + e, length, places) : 0;
    memcpy(others + rest, order + e + whole, (length - whole) * sizeof *order);
    memmove(order + placed, order + e, whole * sizeof *order); /* placed <= e */
    if (whole > 0 && !hk_spring_add_pieces(b, begin + placed, whole, places)) return false;
    placed += whole;
    rest += length - whole;
    e += length;
  }
  *taken = placed;
  return true;
}

/* Adds `count` springs from `begin` on as a list, and those beyond a multiple of HK_SPRING_LANES singly. */
static inline bool hk_spring_add_list(hk_spring_builder *b, size_t begin, size_t count) {
  const size_t singles = count % HK_SPRING_LANES;
  hk_spring_sort(b, b->order + begin, count, hk_spring_edge_other);
  hk_spring_sort(b, b->order + begin, count, hk_spring_edge_owner);
  return hk_spring_add_run(b, HK_SPRING_LIST, begin, count - singles) &&
         hk_spring_add_run(b, HK_SPRING_SINGLE, begin + count - singles, singles);
}

/* Springs begin..end of the order are one part: runs first, then the list, then those of the last particle. */
static inline bool hk_spring_arrange_part(hk_spring_builder *b, size_t begin, size_t end) {
  size_t first_run = b->layout->runs, count = end - begin, placed = 0, list = 0, singles = 0;
  uint32_t *others = b->scratch + b->layout->count; /* the scratch array has room for twice the springs */
  if (!hk_spring_take_runs(b, begin, count, others, &placed)) return false;
  hk_spring_sort_runs(b, first_run, begin);
  uint32_t *order = b->order + begin + placed;
  size_t rest = count - placed;
  for (size_t e = 0; e < rest; e++)
    if (!hk_spring_touches_last(b, others[e])) order[list++] = others[e];
  for (size_t e = 0; e < rest; e++)
    if (hk_spring_touches_last(b, others[e])) order[list + singles++] = others[e];
  if (count <= HK_SPRING_SMALL) return hk_spring_add_run(b, HK_SPRING_SINGLE, begin + placed, rest);
  return hk_spring_add_list(b, begin + placed, list) &&
         hk_spring_add_run(b, HK_SPRING_SINGLE, begin + placed + list, singles);
}

static inline bool hk_spring_arrange(hk_spring_builder *b) {
  hk_spring_layout *s = b->layout;
  for (size_t p = 0; p < s->partition.parts; p++) {
    s->part[p] = s->runs;
    if (!hk_spring_arrange_part(b, b->by_part.first[p], b->by_part.first[p + 1])) return false;
  }
  s->part[s->partition.parts] = s->runs;
  return true;
}

static inline bool hk_spring_all_equal(const hk_per_tuple *p) {
  for (size_t e = 1; e < p->count; e++)
    if (p->value[e] != p->value[0]) return false;
  return true;
}

/* Where the coefficients of each run are. */
static inline void hk_spring_number_places(hk_spring_layout *s) {
  for (size_t r = 0; r < s->runs; r++) {
    s->run[r].place = s->places;
    s->places += s->run[r].places;
  }
}

/* The coefficients by places, or the common coefficient. */
static inline double *hk_spring_arrange_numbers(const hk_spring_builder *b, const hk_per_tuple *from, bool *each) {
  const hk_spring_layout *s = b->layout;
  *each = !hk_spring_all_equal(from);
  double *list = b->host->allocate(b->host, ((*each ? s->places : 1) + HK_SPRING_WIDEST) * sizeof *list);
  for (size_t r = 0; list && !*each && from->count && r < HK_SPRING_WIDEST; r++) list[r] = from->value[0];
  for (size_t r = 0; list && *each && r < s->runs; r++) {
    const hk_spring_run *run = &s->run[r];
    size_t e = run->begin;
    uint32_t end[2];
    for (size_t t = 0; t < run->places; t++)
      if (hk_spring_ends(s, run, t, end)) list[run->place + t] = from->value[b->order[e++]];
  }
  return list;
}

/* The ends of the springs in no run; those of lists have their owner first. */
static inline void hk_spring_copy_pairs(hk_spring_builder *b, const hk_spring_run *run) {
  for (size_t t = 0; run->kind != HK_SPRING_RUN && t < run->count; t++) {
    uint32_t *pair = b->layout->pair[run->pair + t], e = b->order[run->begin + t];
    memcpy(pair, hk_tuple(b->edges, e), sizeof *b->layout->pair);
    if (run->kind == HK_SPRING_LIST) pair[0] = hk_spring_edge_owner(b, e), pair[1] = hk_spring_edge_other(b, e);
  }
}

static inline bool hk_spring_copy_springs(hk_spring_builder *b, const hk_per_tuple *k, const hk_per_tuple *c,
                                          const hk_per_tuple *L) {
  hk_spring_layout *s = b->layout;
  s->pair = b->host->allocate(b->host, (b->listed + 1) * sizeof *s->pair);
  s->present = b->host->allocate(b->host, b->bytes + 1);
  if (!s->pair || !s->present) return false;
  for (size_t r = 0; r < s->runs; r++) hk_spring_copy_pairs(b, &s->run[r]);
  memcpy(s->present, b->present, b->bytes);
  hk_spring_number_places(s);
  s->k = hk_spring_arrange_numbers(b, k, &s->each_k);
  s->c = hk_spring_arrange_numbers(b, c, &s->each_c);
  s->L = hk_spring_arrange_numbers(b, L, &s->each_L);
  if (!s->k || !s->c || !s->L) return false;
  for (size_t e = 0; e < (s->each_c ? s->places : 1); e++) s->damped |= s->c[e] > 0;
  return true;
}

static inline bool hk_spring_allocate(hk_spring_builder *b) {
  const hk_host *host = b->host;
  hk_spring_layout *s = b->layout;
  b->scratch = host->allocate(host, 2 * (s->count + 1) * sizeof *b->scratch);
  b->present = host->allocate(host, s->count + 1); /* half of the places have springs, and a run has at least 16 */
  b->count = host->allocate(host, (b->n + 2) * sizeof *b->count);
  s->part = host->allocate(host, (s->partition.parts + 1) * sizeof *s->part);
  s->power = host->allocate(host, s->partition.parts * sizeof *s->power);
  return b->scratch && b->present && b->count && s->part && s->power;
}

static inline hk_status hk_spring_layout_build(hk_spring_layout *s, const hk_host *host, const hk_partition *partition,
                                               const hk_tuples *edges, const hk_per_tuple *k, const hk_per_tuple *c,
                                               const hk_per_tuple *L, const bool *is_active) {
  hk_spring_builder b = {.host = host, .layout = s, .edges = edges, .n = partition->n};
  *s = (hk_spring_layout){.partition = *partition, .width = host->lanes};
  bool fine = hk_part_lists_sort(&b.by_part, host, partition, edges, is_active) == HK_OK;
  s->count = b.by_part.count;
  b.order = b.by_part.item;
  fine = fine && hk_spring_allocate(&b) && hk_spring_arrange(&b) && hk_spring_copy_springs(&b, k, c, L);
  hk_part_lists_free(&b.by_part, host);
  host->release(host, b.scratch);
  host->release(host, b.present);
  host->release(host, b.count);
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu springs", edges->count);
}

static inline void hk_spring_layout_touch(const hk_spring_layout *s, const hk_part_use *use) {
  for (size_t r = 0; r < s->runs; r++)
    for (size_t t = 0; t < s->run[r].places; t++) {
      uint32_t end[2];
      if (hk_spring_ends(s, &s->run[r], t, end)) hk_part_touch(use, end, 2);
    }
}

static inline void hk_spring_layout_free(hk_spring_layout *s, const hk_host *host) {
  host->release(host, s->pair);
  host->release(host, s->present);
  host->release(host, s->k);
  host->release(host, s->c);
  host->release(host, s->L);
  host->release(host, s->run);
  host->release(host, s->part);
  host->release(host, s->power);
  *s = (hk_spring_layout){0};
}

#endif
