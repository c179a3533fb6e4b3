/* The order in which springs are summed (see spring_kernel.h): counting sorts by group, runs are found by a scan, and
 * the other springs are sorted by blocks of particles. Everything is linear in the number of springs. */
#include "plugins/common/springs/particle_order.h"
#include "plugins/common/springs/spring_kernel.h"

#include <stdlib.h>
#include <string.h>

enum {
  SPRINGS_PER_RANGE = 4096, /* below twice this number one thread is faster */
  RANGES_MAX = 16,
  LANES = 4,    /* the length of a run is a multiple of this; the springs at its end beyond that join the list */
  PIECE = 1024, /* largest number of springs in a run, whose particles fit the second-level cache with those of other
                   runs */
  RUN_MIN = 16, /* the call costs more than shorter runs save */
  BLOCK_BITS =
      6, /* particles of a cache block, 64: 2^3 ... 2^7 are equally fast with shuffled ids, larger ones are slower */
  SCATTERED_MIN = 2048, /* fewer particles fit the caches in any order */
  SMALL = 8             /* up to this number springs are summed one at a time */
};

typedef struct builder {
  const hk_host *host;
  hk_spring_layout *layout;
  const hk_tuples *edges;
  size_t n, ranges, width; /* particles, ranges of them, particles of a range */
  uint32_t *order, *scratch, *count;
  uint32_t *place; /* n: the particles' order for caches and ranges; NULL: by index */
  uint32_t group_of[RANGES_MAX][RANGES_MAX];
  size_t run_capacity;
} builder;

static uint32_t place_of(const builder *b, uint32_t particle) { return b->place ? b->place[particle] : particle; }

static size_t range_of(const builder *b, uint32_t particle) { return place_of(b, particle) / b->width; }

/* Groups for the pairs of ranges that have springs. A pair is put into the first round without either of its ranges;
 * round 0 has the pairs of each range with itself. For m = 2^q ranges with springs between all of them this gives m
 * rounds. */
static void pair_ranges(builder *b) {
  hk_spring_layout *s = b->layout;
  uint32_t busy[RANGES_MAX] = {0}, round_of[RANGES_MAX][RANGES_MAX]; /* busy: ranges in each round, a bit per round */
  bool used[RANGES_MAX][RANGES_MAX] = {{false}};
  for (size_t e = 0; e < s->count; e++) {
    size_t i = range_of(b, hk_tuple(b->edges, b->order[e])[0]), j = range_of(b, hk_tuple(b->edges, b->order[e])[1]);
    used[i < j ? i : j][i < j ? j : i] = true;
  }
  for (size_t i = 0; i < b->ranges; i++)
    for (size_t j = i; j < b->ranges; j++) {
      uint32_t round = 0;
      while (i != j && (round == 0 || ((busy[i] | busy[j]) >> round & 1))) round++;
      round_of[i][j] = round;
      if (!used[i][j]) continue;
      busy[i] |= 1u << round;
      busy[j] |= 1u << round;
      if (s->rounds <= round) s->rounds = round + 1;
    }
  for (uint32_t r = 0; r < s->rounds; r++) {
    for (size_t i = 0; i < b->ranges; i++)
      for (size_t j = i; j < b->ranges; j++)
        if (used[i][j] && round_of[i][j] == r) b->group_of[i][j] = b->group_of[j][i] = (uint32_t)s->groups++;
    s->round[r + 1] = s->groups;
  }
}

/* A stable sort; `key` is below `keys`. */
static void counting_sort(builder *b, uint32_t *list, size_t count, size_t keys,
                          uint32_t (*key)(const builder *b, uint32_t edge)) {
  memset(b->count, 0, (keys + 1) * sizeof *b->count);
  for (size_t e = 0; e < count; e++) b->count[key(b, list[e]) + 1]++;
  for (size_t k = 0; k < keys; k++) b->count[k + 1] += b->count[k];
  for (size_t e = 0; e < count; e++) b->scratch[b->count[key(b, list[e])]++] = list[e];
  memcpy(list, b->scratch, count * sizeof *list);
}

static uint32_t by_group(const builder *b, uint32_t e) {
  return b->group_of[range_of(b, hk_tuple(b->edges, e)[0])][range_of(b, hk_tuple(b->edges, e)[1])];
}

static uint32_t low_block(const builder *b, uint32_t e) {
  uint32_t i = place_of(b, hk_tuple(b->edges, e)[0]), j = place_of(b, hk_tuple(b->edges, e)[1]);
  return (i < j ? i : j) >> BLOCK_BITS;
}

static uint32_t high_block(const builder *b, uint32_t e) {
  uint32_t i = place_of(b, hk_tuple(b->edges, e)[0]), j = place_of(b, hk_tuple(b->edges, e)[1]);
  return (i < j ? j : i) >> BLOCK_BITS;
}

static bool follows(const builder *b, uint32_t e, uint32_t next) {
  return hk_tuple(b->edges, next)[0] == hk_tuple(b->edges, e)[0] + 1 &&
         hk_tuple(b->edges, next)[1] == hk_tuple(b->edges, e)[1] + 1;
}

static bool add_run(builder *b, hk_spring_kind kind, size_t begin, size_t count) {
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
  s->run[s->runs++] = (hk_spring_run){kind, begin, count};
  return true;
}

static bool touches_last(const builder *b, uint32_t e) {
  return hk_tuple(b->edges, e)[0] == b->n - 1 || hk_tuple(b->edges, e)[1] == b->n - 1;
}

typedef struct placed_run {
  uint32_t particle; /* first particle of the run */
  hk_spring_run run;
} placed_run;

static int by_particle(const void *a, const void *b) {
  const placed_run *p = a, *q = b;
  if (p->particle != q->particle) return p->particle < q->particle ? -1 : 1;
  return (p->run.begin > q->run.begin) - (p->run.begin < q->run.begin);
}

/* Sorts the runs of a group by their particles, so that runs of different directions use the same particles while these
 * are in the cache. */
static bool sort_runs(builder *b, size_t first_run, size_t begin) {
  hk_spring_layout *s = b->layout;
  size_t runs = s->runs - first_run, placed = 0;
  if (runs == 0) return true;
  placed_run *list = b->host->allocate(b->host, runs * sizeof *list);
  if (!list) return false;
  for (size_t r = 0; r < runs; r++) {
    hk_spring_run run = s->run[first_run + r];
    list[r] = (placed_run){hk_tuple(b->edges, b->order[run.begin])[0], run};
  }
  qsort(list, runs, sizeof *list, by_particle);
  for (size_t r = 0; r < runs; r++) {
    memcpy(b->scratch + placed, b->order + list[r].run.begin, list[r].run.count * sizeof *b->scratch);
    s->run[first_run + r] = (hk_spring_run){HK_SPRING_RUN, begin + placed, list[r].run.count};
    placed += list[r].run.count;
  }
  memcpy(b->order + begin, b->scratch, placed * sizeof *b->scratch);
  b->host->release(b->host, list);
  return true;
}

/* Springs begin..end of the order are one group: runs first, then the list, then those of the last particle. */
static bool arrange_group(builder *b, size_t begin, size_t end) {
  uint32_t *order = b->order + begin;
  size_t first_run = b->layout->runs, count = end - begin, placed = 0, rest = 0, singles = 0;
  uint32_t *others = b->scratch + count; /* the scratch array has room for twice the springs */
  for (size_t e = 0; e < count;) {
    size_t length = 1;
    while (e + length < count && follows(b, order[e + length - 1], order[e + length])) length++;
    size_t whole = length >= RUN_MIN ? length - length % LANES : 0;
    for (size_t piece = 0; piece < whole; piece += PIECE)
      if (!add_run(b, HK_SPRING_RUN, begin + placed + piece, whole - piece < PIECE ? whole - piece : PIECE))
        return false;
    memmove(order + placed, order + e, whole * sizeof *order); /* placed <= e */
    memcpy(others + rest, order + e + whole, (length - whole) * sizeof *order);
    placed += whole;
    rest += length - whole;
    e += length;
  }
  if (!sort_runs(b, first_run, begin)) return false;
  size_t list = 0;
  for (size_t e = 0; e < rest; e++)
    if (!touches_last(b, others[e])) order[placed + list++] = others[e];
  for (size_t e = 0; e < rest; e++)
    if (touches_last(b, others[e])) order[placed + list + singles++] = others[e];
  size_t keys = (b->n >> BLOCK_BITS) + 1;
  counting_sort(b, order + placed, list, keys, high_block);
  counting_sort(b, order + placed, list, keys, low_block);
  bool small = count <= SMALL;
  return add_run(b, small ? HK_SPRING_SINGLE : HK_SPRING_LIST, begin + placed, small ? rest : list) &&
         add_run(b, HK_SPRING_SINGLE, begin + placed + list, small ? 0 : singles);
}

static bool arrange(builder *b) {
  hk_spring_layout *s = b->layout;
  size_t begin = 0;
  if (s->groups > 1) counting_sort(b, b->order, s->count, s->groups, by_group);
  for (size_t g = 0; g < s->groups; g++) {
    size_t end = begin;
    while (end < s->count && by_group(b, b->order[end]) == g) end++;
    s->group[g] = s->runs;
    if (!arrange_group(b, begin, end)) return false;
    begin = end;
  }
  s->group[s->groups] = s->runs;
  return true;
}

/* The coefficients in the layout's order, or the common coefficient. */
static double *arrange_numbers(const builder *b, const hk_per_tuple *from, bool *each) {
  *each = from->count > 1;
  size_t count = *each ? b->layout->count : 1;
  double *list = b->host->allocate(b->host, (count + 1) * sizeof *list);
  for (size_t e = 0; list && e < count && from->count; e++) list[e] = from->value[*each ? b->order[e] : 0];
  return list;
}

static bool copy_springs(builder *b, const hk_per_tuple *k, const hk_per_tuple *c, const hk_per_tuple *L) {
  hk_spring_layout *s = b->layout;
  s->pair = b->host->allocate(b->host, (s->count + 1) * sizeof *s->pair);
  s->k = arrange_numbers(b, k, &s->each_k);
  s->c = arrange_numbers(b, c, &s->each_c);
  s->L = arrange_numbers(b, L, &s->each_L);
  if (!s->pair || !s->k || !s->c || !s->L) return false;
  for (size_t e = 0; e < s->count; e++) memcpy(s->pair[e], hk_tuple(b->edges, b->order[e]), sizeof *s->pair);
  for (size_t e = 0; e < (s->each_c ? s->count : 1); e++) s->damped |= s->c[e] > 0;
  return true;
}

static bool allocate(builder *b) {
  const hk_host *host = b->host;
  hk_spring_layout *s = b->layout;
  size_t keys = (b->n >> BLOCK_BITS) + RANGES_MAX * RANGES_MAX + 2;
  b->order = host->allocate(host, (s->count + 1) * sizeof *b->order);
  b->scratch = host->allocate(host, 2 * (s->count + 1) * sizeof *b->scratch);
  b->count = host->allocate(host, (keys + 1) * sizeof *b->count);
  s->group = host->allocate(host, (RANGES_MAX * (RANGES_MAX + 1) / 2 + 1) * sizeof *s->group);
  s->round = host->allocate(host, (2 * RANGES_MAX + 1) * sizeof *s->round);
  s->group_power = host->allocate(host, RANGES_MAX * (RANGES_MAX + 1) / 2 * sizeof *s->group_power);
  return b->order && b->scratch && b->count && s->group && s->round && s->group_power;
}

/* Whether joined particles have distant indices: shuffled ids of neighbours differ by n/3 on average, those of a grid
 * by at most a row or two. */
static bool scattered(const builder *b) {
  double apart = 0;
  for (size_t e = 0; e < b->edges->count; e++)
    apart += fabs((double)hk_tuple(b->edges, e)[0] - (double)hk_tuple(b->edges, e)[1]);
  return b->n > SCATTERED_MIN && apart > (double)b->n / 8 * (double)b->edges->count;
}

static size_t ranges_for(size_t springs) {
  size_t m = springs / SPRINGS_PER_RANGE;
  return m < 2 ? 1 : m > RANGES_MAX ? RANGES_MAX : m / 2 * 2;
}

hk_status hk_spring_layout_build(hk_spring_layout *s, const hk_host *host, size_t n, const hk_tuples *edges,
                                 const hk_per_tuple *k, const hk_per_tuple *c, const hk_per_tuple *L,
                                 const bool *is_active) {
  builder b = {.host = host, .layout = s, .edges = edges, .n = n};
  *s = (hk_spring_layout){.count = edges->count};
  bool fine = allocate(&b);
  if (fine && scattered(&b)) {
    b.place = host->allocate(host, n * sizeof *b.place);
    fine = b.place && hk_particle_order(host, n, edges, b.place);
  }
  if (fine) {
    s->count = 0;
    for (size_t e = 0; e < edges->count; e++)
      if (!is_active || (is_active[hk_tuple(edges, e)[0]] && is_active[hk_tuple(edges, e)[1]]))
        b.order[s->count++] = (uint32_t)e;
    b.ranges = ranges_for(s->count);
    b.width = (n + b.ranges - 1) / b.ranges + (n == 0);
    pair_ranges(&b);
    fine = arrange(&b) && copy_springs(&b, k, c, L);
  }
  host->release(host, b.order);
  host->release(host, b.scratch);
  host->release(host, b.count);
  host->release(host, b.place);
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu springs", edges->count);
}

void hk_spring_layout_free(hk_spring_layout *s, const hk_host *host) {
  host->release(host, s->pair);
  host->release(host, s->k);
  host->release(host, s->c);
  host->release(host, s->L);
  host->release(host, s->run);
  host->release(host, s->group);
  host->release(host, s->round);
  host->release(host, s->group_power);
  *s = (hk_spring_layout){0};
}
