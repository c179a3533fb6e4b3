/* The blocks that a surface crosses, for a function that costs much: those of places found on a coarse grid, and from
 * there along the surface, from block to block through faces that have points inside and points outside. Each point of
 * such a block is evaluated once. Between two coarse neighbours on different sides an edge of the grid is found by
 * halving. What is missed is a piece of the surface that passes between the coarse points and is joined to nothing that
 * was found: a ball or a hole narrower than the coarse spacing may be missed, one whose diameter is sqrt(3) times it
 * is not. */
#include "plugins/common/isosurface/grid_blocks.h"

#include <string.h>

enum { FIRST_BLOCKS = 64, BATCH = HK_BLOCK_POINTS };

typedef struct search {
  hk_surface_work *w;
  hk_known_points *known;
  size_t coarse[3], next, listed; /* queue[next .. listed - 1] are to be visited */
  size_t capacity, room;          /* of values and of the queue, blocks */
  size_t *queue;
  hk_status status;
} search;

/* ---- values, each asked for once ---- */

/* Grows an array of `count` items to `room` ones. */
static hk_status grow(search *s, void *array, size_t count, size_t room, size_t size, const char *what) {
  void *old, *fresh = NULL;
  memcpy(&old, array, sizeof old);
  hk_status status = hk_surface_allocate(s->w, &fresh, room, size, what);
  if (status != HK_OK) return status;
  if (count) memcpy(fresh, old, count * size);
  s->w->host->release(s->w->host, old);
  s->w->bytes -= count * size;
  memcpy(array, &fresh, sizeof fresh);
  return HK_OK;
}

/* The values of a block, made where there are none yet; hk_no_slot with s->status where there is no memory. */
static uint32_t slot_of(search *s, size_t block) {
  hk_known_points *p = s->known;
  if (p->slot[block] != hk_no_slot) return p->slot[block];
  if (p->count == s->capacity) {
    size_t room = s->capacity ? 2 * s->capacity : FIRST_BLOCKS;
    s->status = grow(s, &p->value, p->count, room, sizeof *p->value, "blocks of values at the surface");
    if (s->status == HK_OK) s->status = grow(s, &p->is_known, p->count, room, sizeof *p->is_known, "bits of those");
    if (s->status != HK_OK) return hk_no_slot;
    s->capacity = room;
  }
  return p->slot[block] = (uint32_t)p->count++;
}

typedef struct unknown {
  size_t count;
  uint32_t slot[BATCH];
  uint16_t offset[BATCH];
  double place[BATCH][3];
} unknown;

/* Lists a point of the lattice unless its value is known or listed. */
static void ask_for(search *s, unknown *u, const size_t point[3]) {
  size_t block, offset = hk_known_place(s->w, point, &block);
  uint32_t slot = slot_of(s, block);
  if (slot == hk_no_slot) return;
  uint64_t *word = &s->known->is_known[slot][offset / 64], bit = 1ULL << offset % 64;
  if (*word & bit) return;
  *word |= bit;
  u->slot[u->count] = slot, u->offset[u->count] = (uint16_t)offset;
  for (int c = 0; c < 3; c++) u->place[u->count][c] = hk_point_place(s->w, c, point[c]);
  u->count++;
}

static void answer(search *s, unknown *u) {
  double value[BATCH];
  const hk_isosurface_field *f = s->w->field;
  if (u->count == 0 || s->status != HK_OK) return;
  f->evaluate(f->self, (const double(*)[3])u->place, u->count, value);
  for (size_t k = 0; k < u->count; k++) s->known->value[u->slot[k]][u->offset[k]] = value[k];
}

static void fill_block(search *s, size_t number) {
  unknown u = {.count = 0};
  size_t corner[3];
  hk_block_corner(s->w, number, corner);
  for (size_t k = 0; k < HK_BLOCK_POINTS && s->status == HK_OK; k++) {
    size_t point[3] = {corner[0] + k % HK_POINTS, corner[1] + k / HK_POINTS % HK_POINTS,
                       corner[2] + k / (HK_POINTS * HK_POINTS)};
    ask_for(s, &u, point);
  }
  answer(s, &u);
}

/* ---- along the surface ---- */

static void push(search *s, size_t block) {
  if (s->known->visited[block] || s->status != HK_OK) return;
  if (s->listed == s->room) {
    size_t room = s->room ? 2 * s->room : FIRST_BLOCKS;
    s->status = grow(s, &s->queue, s->listed, room, sizeof *s->queue, "blocks along the surface");
    if (s->status != HK_OK) return;
    s->room = room;
  }
  s->known->visited[block] = true;
  s->queue[s->listed++] = block;
}

static bool face_mixed(const uint16_t *inside, int axis, unsigned side) {
  unsigned any = 0, all = 1;
  for (unsigned k = 0; k < HK_BLOCK_POINTS; k++) {
    unsigned at[3] = {k % HK_POINTS, k / HK_POINTS % HK_POINTS, k / (HK_POINTS * HK_POINTS)};
    if (at[axis] != side * HK_SIDE) continue;
    unsigned bit = inside[k / HK_POINTS] >> at[0] & 1U;
    any |= bit, all &= bit;
  }
  return any && !all;
}

/* False: a value of the block is not allowed, so that the search has an end. */
static bool visit(search *s, size_t number) {
  hk_surface_work *w = s->w;
  double value[HK_BLOCK_POINTS];
  uint16_t inside[HK_BLOCK_ROWS];
  size_t corner[3], bad, step[3] = {1, w->blocks[0], w->blocks[0] * w->blocks[1]};
  fill_block(s, number);
  if (s->status != HK_OK || !hk_block_evaluate(w, number, value, inside, &bad)) return false;
  hk_block_corner(w, number, corner);
  for (int c = 0; c < 3; c++) {
    if (corner[c] > 0 && face_mixed(inside, c, 0)) push(s, number - step[c]);
    if (corner[c] / HK_SIDE + 1 < w->blocks[c] && face_mixed(inside, c, 1)) push(s, number + step[c]);
  }
  return true;
}

/* ---- the coarse grid ---- */

static size_t coarse_point(const search *s, int axis, size_t k) { /* on the grid */
  size_t last = s->w->grid->points[axis] - 1, i = k * s->w->options->coarse;
  return i < last ? i : last;
}

static double coarse_value(const search *s, const size_t k[3]) {
  return s->known->seed[(k[2] * s->coarse[1] + k[1]) * s->coarse[0] + k[0]];
}

static hk_status evaluate_coarse(search *s) {
  hk_surface_work *w = s->w;
  double place[BATCH][3];
  size_t k[3];
  for (k[2] = 0; k[2] < s->coarse[2]; k[2]++)
    for (k[1] = 0; k[1] < s->coarse[1]; k[1]++)
      for (size_t first = 0; first < s->coarse[0]; first += BATCH) {
        size_t end = first + BATCH < s->coarse[0] ? first + BATCH : s->coarse[0];
        double *value = s->known->seed + (k[2] * s->coarse[1] + k[1]) * s->coarse[0] + first;
        for (k[0] = first; k[0] < end; k[0]++)
          for (int c = 0; c < 3; c++) place[k[0] - first][c] = hk_point_place(w, c, coarse_point(s, c, k[c]) + 1);
        w->field->evaluate(w->field->self, (const double(*)[3])place, end - first, value);
        for (k[0] = first; k[0] < end; k[0]++) {
          if (hk_value_allowed(value[k[0] - first])) continue;
          size_t at[3] = {coarse_point(s, 0, k[0]), coarse_point(s, 1, k[1]), coarse_point(s, 2, k[2])};
          return hk_surface_refuse(w, at, value[k[0] - first]);
        }
      }
  return HK_OK;
}

static bool is_inside(search *s, const size_t point[3]) {
  unknown u;
  size_t block, offset = hk_known_place(s->w, point, &block);
  u.count = 0;
  ask_for(s, &u, point);
  answer(s, &u);
  return s->status == HK_OK && s->known->value[s->known->slot[block]][offset] >= s->w->options->level;
}

static size_t block_at(const hk_surface_work *w, const size_t point[3]) {
  return (point[2] / HK_SIDE * w->blocks[1] + point[1] / HK_SIDE) * w->blocks[0] + point[0] / HK_SIDE;
}

/* The block of an edge that the surface crosses, on the line from a coarse point to the next one along an axis. */
static void follow_edge(search *s, const size_t k[3], int axis, bool inside) {
  size_t point[3], low, high;
  for (int c = 0; c < 3; c++) point[c] = coarse_point(s, c, k[c]) + 1;
  low = point[axis], high = coarse_point(s, axis, k[axis] + 1) + 1;
  while (high - low > 1 && s->status == HK_OK) {
    point[axis] = low + (high - low) / 2;
    *(is_inside(s, point) == inside ? &low : &high) = point[axis];
  }
  point[axis] = low;
  push(s, block_at(s->w, point));
}

static void seed(search *s) {
  hk_surface_work *w = s->w;
  double level = w->options->level;
  size_t k[3];
  for (k[2] = 0; k[2] < s->coarse[2]; k[2]++)
    for (k[1] = 0; k[1] < s->coarse[1]; k[1]++)
      for (k[0] = 0; k[0] < s->coarse[0]; k[0]++) {
        bool inside = coarse_value(s, k) >= level, border = false;
        size_t point[3];
        for (int c = 0; c < 3; c++) {
          border = border || k[c] == 0 || k[c] + 1 == s->coarse[c];
          point[c] = coarse_point(s, c, k[c]) + 1;
          size_t next[3] = {k[0], k[1], k[2]};
          if (++next[c] < s->coarse[c] && (coarse_value(s, next) >= level) != inside) follow_edge(s, k, c, inside);
        }
        if (inside && border) push(s, block_at(w, point)); /* the surface is closed there, or leaves the box */
      }
}

hk_status hk_surface_seek(hk_surface_work *w) {
  size_t blocks = w->blocks[0] * w->blocks[1] * w->blocks[2];
  hk_known_points *p = &w->points;
  search s = {.w = w, .known = p};
  for (int c = 0; c < 3; c++) s.coarse[c] = (w->grid->points[c] - 2) / w->options->coarse + 2;
  p->seeds = s.coarse[0] * s.coarse[1] * s.coarse[2]; /* fewer than the blocks' points, which have been counted */
  s.status = hk_surface_allocate(w, &p->slot, blocks, sizeof *p->slot, "blocks of the box");
  if (s.status == HK_OK) s.status = hk_surface_allocate(w, &p->visited, blocks, sizeof *p->visited, "marks of blocks");
  if (s.status == HK_OK) s.status = hk_surface_allocate(w, &p->seed, p->seeds, sizeof *p->seed, "coarse points");
  if (s.status == HK_OK) s.status = evaluate_coarse(&s);
  if (s.status != HK_OK) return s.status;
  for (size_t k = 0; k < blocks; k++) p->slot[k] = hk_no_slot;
  w->known = p;
  seed(&s);
  while (s.next < s.listed && s.status == HK_OK && visit(&s, s.queue[s.next])) s.next++;
  for (size_t k = s.next + 1; k < s.listed; k++) p->visited[s.queue[k]] = false; /* those after a value not allowed */
  w->host->release(w->host, s.queue);
  return s.status;
}
