#include "plugins/common/frame_data/skin_solids.h"

#include "plugins/common/snapshot/appearance.h"

static void combine(const hk_body_skin *skin, const double *x, const double weight[HK_CARRIERS], double to[3]) {
  to[0] = to[1] = to[2] = 0;
  for (uint32_t k = 0; k < skin->carriers; k++)
    for (int c = 0; c < 3; c++) to[c] += weight[k] * x[3 * (size_t)skin->carrier[k] + (size_t)c];
}

void hk_skin_solids(const hk_view *view, bool y_up, hk_frame_solid *solid, size_t count) {
  const hk_model *m = view->model;
  for (size_t k = 0; k < count; k++) {
    solid[k] = (hk_frame_solid){.kind = HK_SHAPE_MESH, .body = true};
    if (k >= m->skins) continue;
    const hk_body_skin *skin = &m->skin[k];
    solid[k].group = 1 + m->group[skin->carrier[0]];
    double at[3];
    combine(skin, view->x, skin->origin, at);
    hk_to_z_up(y_up, at, solid[k].centre);
    for (int a = 0; a < 3; a++) {
      combine(skin, view->x, skin->axis[a], at);
      hk_to_z_up(y_up, at, solid[k].axis[a]);
    }
    solid[k].vertices = skin->vertices, solid[k].faces = skin->triangles;
    solid[k].vertex = skin->vertex, solid[k].face = skin->triangle;
  }
}
