/* The pattern of a symmetric matrix's upper triangle, and its numbers in the order in which products read them. A
 * group's blocks are merged by their distance from the diagonal: a distance that three or four rows share makes an even
 * slot, the other blocks fill uneven slots. On a grid nearly all slots are even and full. */
#include "plugins/common/linear/upper_matrix.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = HK_UPPER_LANES, CHUNK_LEAST = 1024, CHUNK_MOST = 4096, SHARED = 3 };

size_t hk_upper_first(const hk_matrix *A, size_t r) {
  size_t low = A->row_start[r], high = A->row_start[r + 1];
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (A->column[middle] < r)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* ---- Numbers --------------------------------------------------------------------------------------------------- */

typedef struct fill_task {
  const hk_upper *m;
  const hk_matrix *A;
} fill_task;

/* Where element (i, j) of a packed block is: xx, xy, xz, yy, yz, zz. */
static const size_t packed_place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};

static void fill_lane(const hk_upper *m, const hk_matrix *A, const uint32_t *source, double *to, bool packed) {
  size_t b = m->block, e = *source;
  for (size_t k = b * b; k-- > 0;) /* of two mirrored elements the upper one is kept */
    to[LANES * (packed ? packed_place[k] : k)] = e == UINT32_MAX ? 0 : A->value[b * b * e + k];
}

/* Makes a diagonal block symmetric by its upper triangle. */
static void mirror_lane(const hk_upper *m, double *to) {
  for (size_t i = 1; i < m->block; i++)
    for (size_t j = 0; j < i; j++) to[LANES * (m->block * i + j)] = to[LANES * (m->block * j + i)];
}

/* Whether a block equals its transpose up to the rounding errors of its assembly. */
static bool is_symmetric(const double *B) {
  double most = 0, off = fmax(fabs(B[1] - B[3]), fmax(fabs(B[2] - B[6]), fabs(B[5] - B[7])));
  for (size_t k = 0; k < 9; k++) most = fmax(most, fabs(B[k]));
  return off <= 8 * DBL_EPSILON * most;
}

/* Whether all blocks of these groups are symmetric; diagonal blocks are made symmetric. */
static bool can_pack(const hk_upper *m, const hk_matrix *A, size_t first, size_t last) {
  if (m->block != 3) return false;
  for (size_t g = first; g < last; g++)
    for (size_t s = LANES * (m->slot_start[g] + 1); s < LANES * m->slot_start[g + 1]; s++)
      if (m->source[s] != UINT32_MAX && !is_symmetric(A->value + 9 * (size_t)m->source[s])) return false;
  return true;
}

static void fill_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const fill_task *t = context;
  const hk_upper *m = t->m;
  size_t first = begin / LANES, last = (end + LANES - 1) / LANES, bb = m->block * m->block;
  bool packed = m->packed[chunk] = can_pack(m, t->A, first, last);
  double *to = m->value + LANES * bb * m->slot_start[first];
  for (size_t g = first; g < last; g++)
    for (size_t s = m->slot_start[g]; s < m->slot_start[g + 1]; s++, to += LANES * (packed ? 6 : bb))
      for (size_t lane = 0; lane < LANES; lane++) {
        const uint32_t *source = m->source + LANES * s + lane;
        double whole[9 * LANES] = {0};
        bool diagonal = s == m->slot_start[g];
        fill_lane(m, t->A, source, packed && !diagonal ? to + lane : whole, packed && !diagonal);
        if (packed && !diagonal) continue;
        if (diagonal) mirror_lane(m, whole);
        for (size_t k = 0; k < bb; k++) to[lane + LANES * (packed ? packed_place[k] : k)] = whole[LANES * k];
      }
}

void hk_upper_fill(hk_upper *m, const hk_host *host, const hk_matrix *A) {
  fill_task task = {m, A};
  host->parallel_for(host, m->rows, m->chunk, fill_chunk, &task);
}

/* ---- Places ---------------------------------------------------------------------------------------------------- */

static size_t end_of(const hk_upper *m, size_t chunk) {
  size_t end = (chunk + 1) * m->chunk;
  return end < m->rows ? end : m->rows;
}

static int by_number(const void *a, const void *b) {
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

/* Writes the columns beyond chunk k to `list`, in increasing order, each once; returns their number. */
static size_t list_places(const hk_upper *m, const hk_matrix *A, size_t k, uint32_t *list) {
  size_t count = 0, kept = 0;
  for (size_t r = k * m->chunk; r < end_of(m, k); r++)
    for (size_t e = A->row_start[r + 1]; e > A->row_start[r] && A->column[e - 1] >= end_of(m, k); e--)
      list[count++] = A->column[e - 1];
  if (count) qsort(list, count, sizeof *list, by_number);
  for (size_t p = 0; p < count; p++)
    if (p == 0 || list[p] != list[p - 1]) list[kept++] = list[p];
  return kept;
}

/* Finds the places of all chunks; returns the largest number of values of x that a chunk uses. */
static size_t find_places(hk_upper *m, const hk_matrix *A) {
  size_t most = 0;
  for (size_t k = 0; k < m->chunks; k++) {
    m->place_start[k + 1] = m->place_start[k] + list_places(m, A, k, m->place_row + m->place_start[k]);
    if (hk_upper_touched(m, k) > most) most = hk_upper_touched(m, k);
  }
  return most;
}

/* Chooses a sixteenth of the rows as chunk, within limits: enough chunks for several threads, and few blocks outside of
 * their own chunk. Chunks are shorter where many columns lie outside. */
static void choose_chunks(hk_upper *m, const hk_matrix *A) {
  m->chunk = (m->rows / 16 + LANES - 1) / LANES * LANES;
  if (m->chunk < CHUNK_LEAST) m->chunk = CHUNK_LEAST;
  if (m->chunk > CHUNK_MOST) m->chunk = CHUNK_MOST;
  for (;;) {
    m->chunks = (m->rows + m->chunk - 1) / m->chunk;
    if (find_places(m, A) <= HK_UPPER_LOCAL || m->chunk / 2 < CHUNK_LEAST) return;
    m->chunk = m->chunk / 2 / LANES * LANES;
  }
}

static void list_receivers(hk_upper *m, size_t *next) {
  for (size_t p = 0; p < m->place_start[m->chunks]; p++) m->take_start[m->place_row[p] / m->chunk + 1]++;
  for (size_t k = 0; k < m->chunks; k++) m->take_start[k + 1] += m->take_start[k];
  memcpy(next, m->take_start, m->chunks * sizeof *next);
  for (size_t p = 0; p < m->place_start[m->chunks]; p++) m->take[next[m->place_row[p] / m->chunk]++] = (uint32_t)p;
}

/* ---- Slots ----------------------------------------------------------------------------------------------------- */

/* A cursor over the blocks of one group right of the diagonal, with a position for each lane. */
typedef struct group_cursor {
  const hk_upper *m;
  const hk_matrix *A;
  const uint32_t *place; /* rows: place of each column beyond the chunk, from the chunk's first place */
  size_t begin, end;     /* rows of the chunk */
  size_t row;            /* row of the first lane */
  size_t next[LANES], last[LANES];
} group_cursor;

/* The local number of the column of block e in the chunk. */
static size_t number_of(const group_cursor *c, size_t e) {
  size_t column = c->A->column[e], rows = (c->end - c->begin + LANES - 1) / LANES * LANES;
  return column < c->end ? column - c->begin : rows + c->place[column];
}

static void begin_group(group_cursor *c, size_t row) {
  c->row = row;
  for (size_t lane = 0; lane < LANES; lane++) {
    size_t r = row + lane;
    c->next[lane] = r < c->end ? hk_upper_first(c->A, r) : 0;
    c->last[lane] = r < c->end ? c->A->row_start[r + 1] : 0;
    if (c->next[lane] < c->last[lane] && c->A->column[c->next[lane]] == r) c->next[lane]++;
  }
}

/* The next distance from row to column that at least one lane has; returns the number of these lanes, and their blocks
 * in `source`. */
static size_t next_distance(group_cursor *c, uint32_t source[LANES], size_t *distance) {
  size_t least = SIZE_MAX, count = 0, own = c->row - c->begin;
  for (size_t lane = 0; lane < LANES; lane++)
    if (c->next[lane] < c->last[lane]) {
      size_t far = number_of(c, c->next[lane]) - own - lane;
      if (far < least) least = far;
    }
  for (size_t lane = 0; lane < LANES; lane++) {
    bool has = c->next[lane] < c->last[lane] && number_of(c, c->next[lane]) - own - lane == least;
    source[lane] = has ? (uint32_t)c->next[lane]++ : UINT32_MAX;
    count += has;
  }
  *distance = least;
  return count;
}

/* Counts the even and uneven slots of the group. */
static void count_slots(group_cursor *c, size_t row, size_t *even, size_t *uneven) {
  size_t left[LANES] = {0}, count, distance;
  uint32_t source[LANES];
  *even = *uneven = 0;
  begin_group(c, row);
  while ((count = next_distance(c, source, &distance)) > 0) {
    if (count >= SHARED) ++*even;
    for (size_t lane = 0; lane < LANES && count < SHARED; lane++)
      if (source[lane] != UINT32_MAX && ++left[lane] > *uneven) *uneven = left[lane];
  }
}

static void write_diagonal(group_cursor *c, uint32_t *source) {
  for (size_t lane = 0; lane < LANES; lane++) {
    size_t r = c->row + lane, e = r < c->end ? hk_upper_first(c->A, r) : 0;
    bool there = r < c->end && e < c->A->row_start[r + 1] && c->A->column[e] == r;
    source[lane] = there ? (uint32_t)e : UINT32_MAX;
  }
}

static void write_slots(hk_upper *m, group_cursor *c, size_t row) {
  size_t g = row / LANES, slot = m->slot_start[g] + 1, count, distance, own = row - c->begin;
  uint32_t source[LANES], *index = m->index + m->index_start[g], *rest = index + m->even[g];
  size_t left[LANES], uneven = slot + m->even[g], slots = m->slot_start[g + 1];
  memset(m->source + LANES * (slot - 1), 0xFF, (slots - slot + 1) * LANES * sizeof *m->source);
  /* an empty lane uses its own row */
  for (size_t k = 0; k < LANES * (slots - uneven); k++) rest[k] = (uint32_t)(own + k % LANES);
  for (size_t lane = 0; lane < LANES; lane++) left[lane] = 0;
  begin_group(c, row);
  write_diagonal(c, m->source + LANES * (slot - 1));
  while ((count = next_distance(c, source, &distance)) > 0)
    if (count >= SHARED) {
      *index++ = (uint32_t)(own + distance);
      memcpy(m->source + LANES * slot++, source, sizeof source);
    } else
      for (size_t lane = 0; lane < LANES; lane++) {
        if (source[lane] == UINT32_MAX) continue;
        size_t at = LANES * left[lane]++ + lane;
        rest[at] = (uint32_t)(own + lane + distance);
        m->source[LANES * uneven + at] = source[lane];
      }
}

/* Counts the slots, or writes them when there is memory for them. */
static void lay_out(hk_upper *m, const hk_matrix *A, uint32_t *place, bool write) {
  for (size_t k = 0; k < m->chunks; k++) {
    group_cursor c = {m, A, place, k * m->chunk, end_of(m, k), 0, {0}, {0}};
    for (size_t p = m->place_start[k]; p < m->place_start[k + 1]; p++)
      place[m->place_row[p]] = (uint32_t)(p - m->place_start[k]);
    for (size_t row = c.begin, even, uneven; row < c.end; row += LANES) {
      size_t g = row / LANES;
      if (write) {
        write_slots(m, &c, row);
        continue;
      }
      count_slots(&c, row, &even, &uneven);
      m->even[g] = (uint32_t)even;
      m->slot_start[g + 1] = m->slot_start[g] + 1 + even + uneven;
      m->index_start[g + 1] = m->index_start[g] + even + LANES * uneven;
    }
  }
}

/* ---- Memory ---------------------------------------------------------------------------------------------------- */

static hk_status get_places(hk_upper *m, const hk_host *host, const hk_matrix *A) {
  size_t most = m->rows / CHUNK_LEAST + 1;
  m->place_start = host->allocate(host, (most + 1) * sizeof *m->place_start);
  m->take_start = host->allocate(host, (most + 1) * sizeof *m->take_start);
  m->own = host->allocate(host, (most + 1) * sizeof *m->own);
  m->part = host->allocate(host, (most + 1) * sizeof *m->part);
  m->packed = host->allocate(host, (most + 1) * sizeof *m->packed);
  m->place_row = host->allocate(host, (A->row_start[A->rows] + 1) * sizeof *m->place_row);
  size_t *next = host->allocate(host, (most + 1) * sizeof *next);
  bool fine = m->place_start && m->take_start && m->own && m->part && m->packed && m->place_row && next;
  if (fine) choose_chunks(m, A);
  size_t places = fine ? m->place_start[m->chunks] : 0;
  m->halo = host->allocate(host, (places * m->block + 1) * sizeof *m->halo);
  m->take = host->allocate(host, (places + 1) * sizeof *m->take);
  fine = fine && m->halo && m->take;
  if (fine) list_receivers(m, next);
  host->release(host, next);
  for (size_t k = 0; fine && k < m->chunks; k++) {
    if (hk_upper_touched(m, k) <= HK_UPPER_LOCAL) continue;
    m->own[k] = host->allocate(host, 2 * m->block * hk_upper_stride(hk_upper_touched(m, k)) * sizeof **m->own);
    fine = m->own[k] != NULL;
  }
  return fine ? HK_OK : HK_NO_MEMORY;
}

static hk_status get_slots(hk_upper *m, const hk_host *host, const hk_matrix *A) {
  size_t groups = (m->rows + LANES - 1) / LANES;
  uint32_t *place = host->allocate(host, (m->rows + 1) * sizeof *place);
  m->slot_start = host->allocate(host, (groups + 1) * sizeof *m->slot_start);
  m->index_start = host->allocate(host, (groups + 1) * sizeof *m->index_start);
  m->even = host->allocate(host, (groups + 1) * sizeof *m->even);
  bool fine = place && m->slot_start && m->index_start && m->even;
  if (fine) {
    lay_out(m, A, place, false);
    size_t slots = m->slot_start[groups];
    m->index = host->allocate(host, (m->index_start[groups] + 1) * sizeof *m->index);
    m->source = host->allocate(host, (LANES * slots + 1) * sizeof *m->source);
    m->value = host->allocate(host, (LANES * slots * m->block * m->block + 1) * sizeof *m->value);
    fine = m->index && m->source && m->value;
  }
  if (fine) lay_out(m, A, place, true);
  host->release(host, place);
  return fine ? HK_OK : HK_NO_MEMORY;
}

hk_status hk_upper_analyze(hk_upper *m, const hk_host *host, const hk_matrix *A) {
  *m = (hk_upper){.rows = A->rows, .block = A->block};
  hk_status status = get_places(m, host, A);
  return status == HK_OK ? get_slots(m, host, A) : status;
}

void hk_upper_free(hk_upper *m, const hk_host *host) {
  for (size_t k = 0; m->own && k < m->chunks; k++) host->release(host, m->own[k]);
  void *list[] = {m->slot_start, m->index_start, m->even, m->index,      m->source, m->value, m->place_start,
                  m->place_row,  m->halo,        m->take, m->take_start, m->own,    m->part,  m->packed};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) host->release(host, list[k]);
  *m = (hk_upper){0};
}
