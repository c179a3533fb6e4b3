/* The cells of a data. Segments are the elements on pairs of particles, the pairs that constraints join and the scene's
 * edges, each pair once; triangles are the scene's and the elements on triples that can be strained, each once: those
 * that cannot are bends of two edges. Of two cells that are the same, the one of an element goes first, for it has a
 * strain. */
#include "plugins/common/frame_data/cells.h"

#include "plugins/common/frame_data/room.h"

#include <stdlib.h>
#include <string.h>

typedef struct candidate {
  uint32_t member[3]; /* rising, places among the particles shown; the third of a segment is 0 */
  uint32_t original[3];
  hk_cell_source source;
  size_t rank; /* in the order in which they were found */
} candidate;

typedef struct candidates {
  size_t count, room;
  candidate *item;
} candidates;

static int compare_members(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  int order = memcmp(p->member, q->member, sizeof p->member);
  if (order != 0) return order;
  return p->rank < q->rank ? -1 : p->rank > q->rank;
}

static int compare_ranks(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  return p->rank < q->rank ? -1 : p->rank > q->rank;
}

static void sort_members(uint32_t *m, unsigned arity) {
  for (unsigned i = 1; i < arity; i++)
    for (unsigned j = i; j > 0 && m[j] < m[j - 1]; j--) {
      uint32_t kept = m[j];
      m[j] = m[j - 1], m[j - 1] = kept;
    }
}

/* Of the tuples those whose members are all shown. */
static bool add_tuples(candidates *all, const hk_gatherer *s, const hk_tuples *t, uint32_t list) {
  if (!hk_make_room(&all->item, &all->room, all->count + t->count, sizeof *all->item)) return false;
  for (size_t k = 0; k < t->count; k++) {
    const uint32_t *index = hk_tuple(t, k);
    candidate c = {.source = {list, (uint32_t)k}, .rank = all->count};
    bool shown = true;
    for (unsigned m = 0; m < t->arity; m++) {
      c.original[m] = c.member[m] = s->place[index[m]];
      shown = shown && c.member[m] != UINT32_MAX;
    }
    sort_members(c.member, t->arity);
    if (shown) all->item[all->count++] = c;
  }
  return true;
}

/* Leaves each once, in the order in which they were found. */
static void drop_repeated(candidates *all) {
  size_t kept = 0;
  if (all->count == 0) return;
  qsort(all->item, all->count, sizeof *all->item, compare_members);
  for (size_t k = 0; k < all->count; k++)
    if (k == 0 || memcmp(all->item[k].member, all->item[k - 1].member, sizeof all->item[k].member) != 0)
      all->item[kept++] = all->item[k];
  all->count = kept;
  qsort(all->item, all->count, sizeof *all->item, compare_ranks);
}

static bool collect(const hk_gatherer *s, const hk_model *m, unsigned arity, candidates *all) {
  bool fine = true;
  for (size_t k = 0; k < m->element_lists && fine; k++) {
    const hk_elements *e = &m->element_list[k].elements;
    if (e->node.arity == arity && (arity == 2 || e->rest.count)) fine = add_tuples(all, s, &e->node, (uint32_t)k);
  }
  for (size_t k = 0; k < m->join_lists && arity == 2 && fine; k++) fine = add_tuples(all, s, m->join[k], UINT32_MAX);
  const hk_tuples *own = arity == 2 ? &m->edges : &m->triangles;
  if (fine && own->count) fine = add_tuples(all, s, own, UINT32_MAX);
  drop_repeated(all);
  return fine;
}

static bool reserve(hk_gatherer *s, size_t segments, size_t triangles) {
  hk_frame_cells *c = &s->data.cells;
  size_t cells = s->data.n + segments + triangles;
  return hk_make_room(&c->vertex, &s->room[HK_ROOM_VERTEX], s->data.n, sizeof *c->vertex) &&
         hk_make_room(&c->segment, &s->room[HK_ROOM_SEGMENT], segments, sizeof *c->segment) &&
         hk_make_room(&c->triangle, &s->room[HK_ROOM_TRIANGLE], triangles, sizeof *c->triangle) &&
         hk_make_room(&s->source, &s->room[HK_ROOM_SOURCE], cells, sizeof *s->source) &&
         (!s->strained || hk_make_room(&s->data.cell_strain, &s->room[HK_ROOM_CELL_STRAIN], cells, sizeof(double)));
}

static void find_vertices(hk_gatherer *s, const candidates *segments, const candidates *triangles) {
  hk_frame_cells *c = &s->data.cells;
  uint32_t *mark = c->vertex; /* room for n */
  memset(mark, 0, s->data.n * sizeof *mark);
  for (size_t k = 0; k < segments->count; k++)
    for (int m = 0; m < 2; m++) mark[segments->item[k].member[m]] = 1;
  for (size_t k = 0; k < triangles->count; k++)
    for (int m = 0; m < 3; m++) mark[triangles->item[k].member[m]] = 1;
  c->vertices = 0;
  for (uint32_t j = 0; j < s->data.n; j++) /* vertices <= j: what is overwritten was read */
    if (!mark[j]) c->vertex[c->vertices++] = j;
}

static void write_cells(hk_gatherer *s, const candidates *segments, const candidates *triangles) {
  hk_frame_cells *c = &s->data.cells;
  find_vertices(s, segments, triangles);
  c->segments = segments->count, c->triangles = triangles->count;
  hk_cell_source *source = s->source;
  for (size_t k = 0; k < c->vertices; k++) *source++ = (hk_cell_source){UINT32_MAX, 0};
  for (size_t k = 0; k < c->segments; k++) {
    memcpy(c->segment[k], segments->item[k].original, sizeof c->segment[k]);
    *source++ = segments->item[k].source;
  }
  for (size_t k = 0; k < c->triangles; k++) {
    memcpy(c->triangle[k], triangles->item[k].original, sizeof c->triangle[k]);
    *source++ = triangles->item[k].source;
  }
}

hk_status hk_gatherer_find_cells(hk_gatherer *s, const hk_view *view) {
  candidates segments = {0}, triangles = {0};
  bool fine = collect(s, view->model, 2, &segments) && collect(s, view->model, 3, &triangles) &&
              reserve(s, segments.count, triangles.count);
  if (fine) write_cells(s, &segments, &triangles);
  free(segments.item);
  free(triangles.item);
  return fine ? HK_OK : HK_NO_MEMORY;
}
