/* The periodic box of a scene. */
#include "core/scene/scene/scene.h"

#include <string.h>

bool hk_box_repeats(const hk_periodic_box *box) { return box->repeats[0] || box->repeats[1] || box->repeats[2]; }

static hk_status find_axes(hk_periodic_box *box, const char *axes, hk_error *error) {
  for (const char *c = axes; *c; c++) {
    const char *found = strchr("xyz", *c);
    if (!found || box->repeats[found - "xyz"])
      return hk_error_set(error, HK_BAD_PARAM,
                          "periodic: axes: '%.20s' is no list of axes: give x, y, z, xy, ... or xyz", axes);
    box->repeats[found - "xyz"] = true;
  }
  if (hk_box_repeats(box)) return HK_OK;
  return hk_error_set(error, HK_BAD_PARAM, "periodic: axes: the box repeats along none: give x, y, z, xy, ... or xyz");
}

hk_status hk_scene_set_box(hk_scene *scene, const double low[3], const double high[3], const char *axes,
                           hk_error *error) {
  hk_periodic_box box = {.repeats = {false}};
  hk_status status = find_axes(&box, axes, error);
  for (int c = 0; c < 3 && status == HK_OK; c++) {
    box.low[c] = low[c], box.high[c] = high[c];
    double length = high[c] - low[c];
    if (box.repeats[c] && !(length > 0 && isfinite(length)))
      status =
          hk_error_set(error, HK_BAD_PARAM, "periodic: along %c the box goes from %g to %g m: high has to be above low",
                       "xyz"[c], low[c], high[c]);
  }
  if (status == HK_OK) scene->box = box;
  return status;
}
