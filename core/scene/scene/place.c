/* Lines of the script: where particles were added, for what a run finds to say about them. Builders that stand in one
 * line, as in a loop, are one place. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>
#include <string.h>

hk_status hk_scene_set_where(char **where, const char *text, hk_error *error) {
  char *copy = hk_string_copy(text);
  if (!copy) return hk_error_set(error, HK_NO_MEMORY, "no memory for a line of the script");
  free(*where);
  *where = copy;
  return HK_OK;
}

hk_status hk_scene_note_place(hk_scene *scene, uint32_t first_id, const char *where, hk_error *error) {
  hk_scene_places_list *list = &scene->places;
  if (list->count > 0 && strcmp(list->item[list->count - 1].where, where) == 0) return HK_OK;
  hk_scene_place *grown = realloc(list->item, (list->count + 1) * sizeof *grown), place = {.first = first_id - 1};
  if (grown) list->item = grown;
  hk_status status = grown ? hk_scene_set_where(&place.where, where, error)
                           : hk_error_set(error, HK_NO_MEMORY, "no memory for a line of the script");
  if (status == HK_OK) list->item[list->count++] = place;
  return status;
}

const char *hk_scene_place_of(const hk_scene *scene, uint32_t id) {
  const char *where = scene->name;
  for (size_t k = 0; k < scene->places.count && scene->places.item[k].first < id; k++)
    where = scene->places.item[k].where;
  return where;
}
