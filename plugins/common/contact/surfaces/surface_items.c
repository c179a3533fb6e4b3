#include "plugins/common/contact/surfaces/surface_items.h"

#include <string.h>

typedef struct builder {
  const hk_surface_mesh *mesh;
  hk_surface_items *items;
  uint32_t *item_of;      /* triangles; UINT32_MAX: none as yet */
  uint32_t (*edge_of)[3]; /* triangles: their edges */
  bool *owned;            /* n */
} builder;

static const uint32_t none = UINT32_MAX;

/* Each triangle's edges, in any order. */
static void list_edges(builder *b) {
  const hk_surface_mesh *m = b->mesh;
  memset(b->edge_of, 0xff, m->triangles * sizeof *b->edge_of);
  for (uint32_t e = 0; e < m->edges; e++)
    for (int f = 0; f < 2; f++) {
      uint32_t face = m->edge_faces[e][f];
      for (int c = 0; face != none && c < 3; c++)
        if (b->edge_of[face][c] == none) {
          b->edge_of[face][c] = e;
          break;
        }
    }
}

static uint32_t corner_beside(const uint32_t t[3], const uint32_t edge[2]) {
  for (int c = 0; c < 2; c++)
    if (t[c] != edge[0] && t[c] != edge[1]) return t[c];
  return t[2];
}

/* The free triangle with the lowest number at an edge of t, and that edge. It depends on the mesh alone. */
static uint32_t partner(const builder *b, uint32_t t, uint32_t *shared) {
  uint32_t found = none;
  for (int c = 0; c < 3; c++) {
    const uint32_t *face = b->mesh->edge_faces[b->edge_of[t][c]];
    uint32_t other = face[0] == t ? face[1] : face[0];
    if (other >= found || b->item_of[other] != none) continue; /* `none` is the largest number */
    found = other;
    *shared = b->edge_of[t][c];
  }
  return found;
}

static hk_surface_item *add(builder *b) {
  hk_surface_item *item = &b->items->item[b->items->count++];
  memset(item, 0xff, sizeof *item);
  item->points = 0;
  return item;
}

static void add_triangle(builder *b, uint32_t t) {
  uint32_t shared = none, other = partner(b, t, &shared), number = (uint32_t)b->items->count;
  const hk_surface_mesh *m = b->mesh;
  const uint32_t *v = m->triangle[t];
  hk_surface_item *item = add(b);
  item->triangle[0] = t;
  item->triangle[1] = other;
  b->item_of[t] = number;
  if (other == none) {
    memcpy(item->vertex, (uint32_t[]){v[0], v[1], v[2], v[2]}, sizeof item->vertex);
    return;
  }
  const uint32_t *e = m->edge[shared];
  uint32_t vertex[4] = {corner_beside(v, e), e[0], e[1], corner_beside(m->triangle[other], e)};
  memcpy(item->vertex, vertex, sizeof vertex);
  b->item_of[other] = number;
}

static void add_edge(builder *b, uint32_t e) {
  const uint32_t *end = b->mesh->edge[e];
  hk_surface_item *item = add(b);
  memcpy(item->vertex, (uint32_t[]){end[0], end[1], end[1], end[1]}, sizeof item->vertex);
  item->edge[0] = e;
}

/* The place of an edge of a triangle's item. */
static void own_edge(builder *b, uint32_t e) {
  const uint32_t *end = b->mesh->edge[e], *face = b->mesh->edge_faces[e];
  uint32_t k = b->item_of[face[0]];
  if (face[1] != none && b->item_of[face[1]] < k) k = b->item_of[face[1]];
  hk_surface_item *item = &b->items->item[k];
  for (int c = 0; c < HK_ITEM_EDGES; c++) {
    uint32_t p = item->vertex[hk_item_ends[c][0]], q = item->vertex[hk_item_ends[c][1]];
    if ((p != end[0] || q != end[1]) && (p != end[1] || q != end[0])) continue;
    item->edge[c] = e;
    return;
  }
}

static void own_points(builder *b) {
  for (size_t k = 0; k < b->items->count; k++)
    for (int c = 0; c < 4; c++) {
      uint32_t i = b->items->item[k].vertex[c];
      if (!b->owned[i]) b->items->item[k].points |= 1u << c;
      b->owned[i] = true;
    }
}

static void build(builder *b) {
  const hk_surface_mesh *m = b->mesh;
  list_edges(b);
  memset(b->item_of, 0xff, m->triangles * sizeof *b->item_of);
  for (uint32_t t = 0; t < m->triangles; t++)
    if (b->item_of[t] == none) add_triangle(b, t);
  for (uint32_t e = 0; e < m->edges; e++) {
    if (m->edge_faces[e][0] == none)
      add_edge(b, e);
    else
      own_edge(b, e);
  }
  own_points(b);
}

hk_status hk_surface_items_build(hk_surface_items *items, const hk_host *host, const hk_surface_mesh *m, size_t n) {
  builder b = {.mesh = m, .items = items};
  hk_surface_items_free(items, host);
  items->item = host->allocate(host, (m->triangles + m->edges) * sizeof *items->item);
  b.item_of = host->allocate(host, m->triangles * sizeof *b.item_of);
  b.edge_of = host->allocate(host, m->triangles * sizeof *b.edge_of);
  b.owned = host->allocate(host, n * sizeof *b.owned);
  bool fine = items->item && b.item_of && b.edge_of && b.owned;
  if (fine) build(&b);
  host->release(host, b.item_of);
  host->release(host, b.edge_of);
  host->release(host, b.owned);
  if (fine) return HK_OK;
  hk_surface_items_free(items, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for the surfaces of %zu particles", n);
}

void hk_surface_items_free(hk_surface_items *items, const hk_host *host) {
  host->release(host, items->item);
  *items = (hk_surface_items){0};
}
