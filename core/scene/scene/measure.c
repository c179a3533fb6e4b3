/* What a scene measures at every frame. The unit of a measure stands behind its name on axes, in summaries and at the
 * head of a sweep's columns, between brackets: so it is a short text in one line, without brackets. */
#include "core/engine/base/base.h"
#include "core/engine/text/text.h"
#include "core/scene/scene/scene.h"

#include <stdlib.h>
#include <string.h>

enum { LONGEST_UNIT = 24 }; /* bytes */

static bool is_unit(const char *text) {
  size_t length = strlen(text);
  if (strcmp(text, "1") == 0) return false;
  if (length > LONGEST_UNIT || *text == ' ' || (length > 0 && text[length - 1] == ' ')) return false;
  while (*text) {
    uint32_t code;
    size_t bytes = hk_utf8_next(text, &code);
    if (bytes == 0 || code < 0x20 || hk_commands_terminal(code) || strchr("[]\"", (int)(code < 0x80 ? code : 'm')))
      return false;
    text += bytes;
  }
  return true;
}

hk_status hk_scene_add_measure(hk_scene *scene, const char *name, const char *unit, const char *where,
                               const hk_function *value, hk_error *error) {
  if (unit && !is_unit(unit))
    return hk_error_set(error, HK_BAD_PARAM,
                        "measure: unit of '%s': expected a plain text of at most %d characters without brackets, as "
                        "\"m\" or \"kg m/s\"; leave it out for a pure number",
                        name, LONGEST_UNIT);
  for (size_t k = 0; k < scene->measures; k++)
    if (strcmp(scene->measure[k].name, name) == 0)
      return hk_error_set(error, HK_BAD_PARAM, "there is already a measure '%s'", name);
  hk_measure *grown = realloc(scene->measure, (scene->measures + 1) * sizeof *grown);
  if (grown) scene->measure = grown;
  hk_measure measure = {hk_string_copy(name), hk_string_copy(unit ? unit : ""), hk_string_copy(where ? where : ""),
                        *value};
  if (!measure.name || !measure.unit || !measure.where || !grown) {
    free(measure.name);
    free(measure.unit);
    free(measure.where);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the measure");
  }
  scene->measure[scene->measures++] = measure;
  return HK_OK;
}
