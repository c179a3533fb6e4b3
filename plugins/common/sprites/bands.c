#include "plugins/common/sprites/bands.h"

#include "plugins/common/sprites/projection.h"

#include <string.h>

/* The bands first <= b < end that a sprite reaches. Conversion to whole numbers rounds down: none is negative. */
static void bands_of(const hk_bands *bands, const hk_sprite *s, int bottom, size_t *first, size_t *end) {
  float half = hk_sprite_half(s->radius), at = s->y - (float)bottom, most = (float)bands->count;
  float low = (hk_min(at, at + s->tail[1]) - half) / HK_BAND_ROWS;
  float high = (hk_max(at, at + s->tail[1]) + half) / HK_BAND_ROWS + 1;
  *first = (size_t)(int)hk_min(hk_max(low, 0), most);
  *end = (size_t)(int)hk_min(hk_max(high, 0), most);
}

static hk_status no_memory(const hk_host *host) {
  return host->fail(host, HK_NO_MEMORY, "no memory to draw the particles");
}

static hk_status make_room(hk_bands *b, const hk_host *host) {
  if (b->room > b->count) return HK_OK;
  host->release(host, b->start);
  b->room = 0;
  b->start = host->allocate(host, (b->count + 1) * sizeof *b->start);
  if (!b->start) return no_memory(host);
  b->room = b->count + 1;
  return HK_OK;
}

static hk_status make_item_room(hk_bands *b, const hk_host *host, size_t items) {
  if (b->item && b->item_room >= items) return HK_OK;
  host->release(host, b->item);
  b->item_room = 0;
  b->item = host->allocate(host, (items + items / 2 + 1) * sizeof *b->item);
  if (!b->item) return no_memory(host);
  b->item_room = items + items / 2 + 1;
  return HK_OK;
}

/* Counts by differences: one is added where a sprite's bands begin and taken where they end. */
static size_t count_items(hk_bands *b, const hk_sprite *sprite, const uint32_t *order, size_t listed, int bottom) {
  size_t sum = 0, here = 0, first, end;
  memset(b->start, 0, (b->count + 1) * sizeof *b->start);
  for (size_t k = 0; k < listed; k++) {
    bands_of(b, sprite + order[k], bottom, &first, &end);
    if (first >= end) continue;
    b->start[first]++, b->start[end]--; /* wraps around, and back in the sum */
  }
  for (size_t i = 0; i <= b->count; i++) {
    here += b->start[i];
    b->start[i] = sum, sum += here;
  }
  return b->start[b->count];
}

hk_status hk_bands_fill(hk_bands *b, const hk_host *host, const hk_sprite *sprite, const uint32_t *order, size_t listed,
                        int bottom, int height) {
  size_t first, end;
  b->count = ((size_t)height + HK_BAND_ROWS - 1) / HK_BAND_ROWS;
  hk_status status = make_room(b, host);
  if (status != HK_OK) return status;
  status = make_item_room(b, host, count_items(b, sprite, order, listed, bottom));
  if (status != HK_OK) return status;
  for (size_t k = 0; k < listed; k++) {
    bands_of(b, sprite + order[k], bottom, &first, &end);
    for (size_t i = first; i < end; i++) b->item[b->start[i]++] = order[k];
  }
  memmove(b->start + 1, b->start, b->count * sizeof *b->start); /* every start has become the next one's */
  b->start[0] = 0;
  return HK_OK;
}

void hk_bands_free(hk_bands *b, const hk_host *host) {
  host->release(host, b->start);
  host->release(host, b->item);
  *b = (hk_bands){0};
}
