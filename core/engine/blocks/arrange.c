/* Which forces are asked for parts, and in which order, decided when particles, elements or forces are others. */
#include "core/engine/blocks/blocks.h"
#include "core/engine/contract/contract.h"

#include <stdlib.h>

/* Its work is computed from the F of that force alone. */
bool hk_work_unaccounted(const hk_instance *force) {
  const hk_force *functions = force->plugin->force;
  return functions->energy ? force->spec->timed_count > 0 : !(functions->flags & HK_POWER);
}

static bool publishes(const hk_plugin *plugin) {
  bool any = false;
  for (const hk_field *f = plugin->fields; f && f->name; f++) any |= (f->flags & HK_PUBLISHED) != 0;
  return any;
}

static bool adds_by_parts(const hk_instance *force) {
  const hk_force *functions = force->plugin->force;
  return force->started && functions->add_part && !functions->rates && !publishes(force->plugin) &&
         !hk_work_unaccounted(force);
}

bool hk_tiles_open(hk_tiles *tiles) {
  tiles->chosen = calloc(tiles->forces->count + 1, sizeof *tiles->chosen);
  tiles->between = calloc(tiles->forces->count + 1, sizeof *tiles->between);
  tiles->sum = calloc(HK_TILE_SUMS, sizeof *tiles->sum);
  tiles->seconds = calloc((tiles->forces->count + 1) * HK_TILE_SUMS, sizeof *tiles->seconds);
  return tiles->chosen && tiles->between && tiles->sum && tiles->seconds;
}

void hk_tiles_close(hk_tiles *tiles) {
  hk_front_close(&tiles->front);
  free(tiles->order.item);
  free(tiles->chosen);
  free(tiles->between);
  free(tiles->sum);
  free(tiles->seconds);
}

/* What all forces touch, in a partition like that of the state or as if it had one domain. */
static bool ask(hk_tiles *tiles, hk_front *front, const hk_partition *partition) {
  if (!hk_front_begin(front, partition)) return false;
  hk_part_use use = hk_front_use(front);
  for (size_t k = 0; k < tiles->forces->count; k++) {
    const hk_instance *force = tiles->forces->item[k];
    if (!tiles->between[k]) continue;
    const hk_instance *outer = hk_enter(force);
    hk_force_of(force->plugin)->parts.touch(force->self, &tiles->view[k], &use);
    hk_leave(force, outer);
  }
  return true;
}

static bool order_several(hk_tiles *tiles) {
  hk_partition whole = tiles->state->partition;
  hk_front reach = {0};
  whole.width = whole.blocks, whole.domains = 1, whole.parts = whole.blocks + 1;
  bool fine = ask(tiles, &reach, &whole) && hk_tile_order_make(&tiles->order, &tiles->front, &reach);
  hk_front_close(&reach);
  return fine;
}

hk_status hk_tiles_arrange(hk_tiles *tiles, hk_error *error) {
  for (size_t k = 0; k < tiles->forces->count; k++) {
    const hk_instance *force = tiles->forces->item[k];
    tiles->chosen[k] = adds_by_parts(force);
    tiles->between[k] = tiles->chosen[k] && hk_force_of(force->plugin)->parts.touch;
  }
  bool fine = ask(tiles, &tiles->front, &tiles->state->partition);
  if (fine) hk_front_end(&tiles->front);
  if (!fine || !order_several(tiles))
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the blocks of %zu particles", tiles->state->model.n);
  return HK_OK;
}
