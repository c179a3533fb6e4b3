/* What a scene measures at every frame. */
#include "core/engine/base/base.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>
#include <string.h>

hk_status hk_scene_add_measure(hk_scene *scene, const char *name, const char *where, const hk_function *value,
                               hk_error *error) {
  for (size_t k = 0; k < scene->measures; k++)
    if (strcmp(scene->measure[k].name, name) == 0)
      return hk_error_set(error, HK_BAD_PARAM, "there is already a measure '%s'", name);
  hk_measure *grown = realloc(scene->measure, (scene->measures + 1) * sizeof *grown);
  if (grown) scene->measure = grown;
  hk_measure measure = {hk_string_copy(name), hk_string_copy(where ? where : ""), *value};
  if (!measure.name || !measure.where || !grown) {
    free(measure.name);
    free(measure.where);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the measure");
  }
  scene->measure[scene->measures++] = measure;
  return HK_OK;
}
