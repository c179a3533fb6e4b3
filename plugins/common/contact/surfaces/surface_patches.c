/* Patches grow over items that share a particle, breadth first from the free item with the lowest number, so that they
 * are as round as the mesh lets them. What is then left over in a corner joins a patch that it touches. */
#include "plugins/common/contact/surfaces/surface_patches.h"

#include <stdlib.h>
#include <string.h>

enum { FEW = HK_PATCH_ITEMS / 4 /* items: less is no patch of its own where it can join one */ };

static const uint32_t none = UINT32_MAX;

typedef struct builder {
  const hk_surface_items *items;
  size_t n;
  size_t *start; /* n + 1: the items of a particle, in `user` */
  uint32_t *user;
  uint32_t *patch; /* items; none: as yet */
  uint32_t *queue; /* items */
  size_t *size;    /* patches */
  size_t patches;
} builder;

/* A corner that is repeated is one particle. */
static bool is_new_corner(const hk_surface_item *item, int c) {
  return c == 0 || item->vertex[c] != item->vertex[c - 1];
}

static void list_users(builder *b) {
  memset(b->start, 0, (b->n + 2) * sizeof *b->start);
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t k = 0; k < b->items->count; k++)
      for (int c = 0; c < 4; c++) {
        const hk_surface_item *item = &b->items->item[k];
        if (!is_new_corner(item, c)) continue;
        if (pass == 0)
          b->start[item->vertex[c] + 2]++;
        else
          b->user[b->start[item->vertex[c] + 1]++] = k;
      }
    for (size_t i = 0; pass == 0 && i < b->n; i++) b->start[i + 2] += b->start[i + 1];
  }
}

static size_t take(builder *b, uint32_t item, uint32_t patch, size_t count) {
  b->patch[item] = patch;
  b->queue[count] = item;
  return count + 1;
}

/* Returns the number of items that the patch has got. */
static size_t grow(builder *b, uint32_t seed, uint32_t patch) {
  size_t count = take(b, seed, patch, 0);
  for (size_t next = 0; next < count; next++)
    for (int c = 0; c < 4; c++) {
      uint32_t i = b->items->item[b->queue[next]].vertex[c];
      for (size_t u = b->start[i]; u < b->start[i + 1] && count < HK_PATCH_ITEMS; u++)
        if (b->patch[b->user[u]] == none) count = take(b, b->user[u], patch, count);
    }
  return count;
}

/* A patch that touches the last one, and has room for it. */
static uint32_t neighbour(const builder *b, size_t count, uint32_t patch) {
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 4; c++) {
      uint32_t i = b->items->item[b->queue[k]].vertex[c];
      for (size_t u = b->start[i]; u < b->start[i + 1]; u++) {
        uint32_t other = b->patch[b->user[u]];
        if (other != none && other != patch && b->size[other] + count <= HK_PATCH_MOST) return other;
      }
    }
  return none;
}

static void make_patches(builder *b) {
  memset(b->patch, 0xff, b->items->count * sizeof *b->patch);
  for (uint32_t k = 0; k < b->items->count; k++) {
    if (b->patch[k] != none) continue;
    uint32_t patch = (uint32_t)b->patches;
    size_t count = grow(b, k, patch);
    uint32_t other = count < FEW ? neighbour(b, count, patch) : none;
    if (other == none) b->size[b->patches++] = count;
    for (size_t e = 0; e < count && other != none; e++) b->patch[b->queue[e]] = other;
    if (other != none) b->size[other] += count;
  }
}

static void list_items(const builder *b, hk_surface_patch_set *p) {
  for (size_t k = 0; k < b->patches; k++) p->first[k + 1] = p->first[k] + b->size[k];
  for (uint32_t k = (uint32_t)b->items->count; k-- > 0;) {
    uint32_t patch = b->patch[k];
    p->item[p->first[patch] + --b->size[patch]] = k;
  }
}

static int rising(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

static void list_members(const builder *b, hk_surface_patch_set *p) {
  size_t kept = 0;
  for (size_t k = 0; k < b->patches; k++) {
    size_t first = kept, end = kept;
    for (size_t e = p->first[k]; e < p->first[k + 1]; e++)
      for (int c = 0; c < 4; c++) p->table.member[end++] = b->items->item[p->item[e]].vertex[c];
    qsort(p->table.member + first, end - first, sizeof *p->table.member, rising);
    for (size_t e = first; e < end; e++)
      if (kept == first || p->table.member[kept - 1] != p->table.member[e])
        p->table.member[kept++] = p->table.member[e];
    p->table.start[k] = first;
  }
  p->table.start[b->patches] = kept;
}

static bool reserve(hk_surface_patch_set *p, const hk_host *host, size_t items) {
  p->table.start = host->allocate(host, (items + 1) * sizeof *p->table.start);
  p->table.member = host->allocate(host, (4 * items + 1) * sizeof *p->table.member);
  p->first = host->allocate(host, (items + 1) * sizeof *p->first);
  p->item = host->allocate(host, (items + 1) * sizeof *p->item);
  p->whole = host->allocate(host, (items + 1) * sizeof *p->whole);
  p->used = host->allocate(host, (items + 1) * sizeof *p->used);
  p->list = host->allocate(host, (items + 1) * sizeof *p->list);
  return p->table.start && p->table.member && p->first && p->item && p->whole && p->used && p->list;
}

hk_status hk_surface_patches_open(hk_surface_patch_set *p, const hk_host *host, const hk_broad_phase *s) {
  size_t items = s->items.count;
  builder b = {.items = &s->items, .n = s->model->n};
  hk_surface_patches_free(p, host);
  b.start = host->allocate(host, (b.n + 2) * sizeof *b.start);
  b.user = host->allocate(host, (4 * items + 1) * sizeof *b.user);
  b.patch = host->allocate(host, (items + 1) * sizeof *b.patch);
  b.queue = host->allocate(host, (items + 1) * sizeof *b.queue);
  b.size = host->allocate(host, (items + 1) * sizeof *b.size);
  bool fine = b.start && b.user && b.patch && b.queue && b.size && reserve(p, host, items);
  if (fine) {
    list_users(&b);
    make_patches(&b);
    list_items(&b, p);
    list_members(&b, p);
    p->table.count = b.patches;
  }
  void *scratch[] = {b.start, b.user, b.patch, b.queue, b.size};
  for (size_t k = 0; k < sizeof scratch / sizeof *scratch; k++) host->release(host, scratch[k]);
  if (fine) return HK_OK;
  hk_surface_patches_free(p, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for patches of %zu particles", s->model->n);
}

void hk_surface_patches_free(hk_surface_patch_set *p, const hk_host *host) {
  void *memory[] = {p->table.start, p->table.member, p->first, p->item, p->whole, p->used, p->list};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  *p = (hk_surface_patch_set){0};
}
