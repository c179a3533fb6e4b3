#include "plugins/common/frame_data/obstacle_solids.h"

#include "plugins/common/snapshot/appearance.h"

/* From the middle to the surface along axis k, in the shape's own frame. */
static void own_axis(const hk_shape *s, int k, double axis[3]) {
  axis[0] = axis[1] = axis[2] = 0;
  if (s->kind == HK_SHAPE_PLANE && k == 2)
    for (int c = 0; c < 3; c++) axis[c] = s->normal[c];
  else
    axis[k] = s->kind == HK_SHAPE_MESH ? 1 : s->half[k];
}

static hk_frame_solid solid_of(const hk_obstacle *o, bool y_up) {
  const hk_shape *shape = &o->shape;
  hk_frame_solid solid = {.kind = shape->kind, .hollow = shape->hollow};
  hk_to_z_up(y_up, o->motion.end.origin, solid.centre);
  for (int k = 0; k < 3; k++) {
    double own[3], turned[3];
    own_axis(shape, k, own);
    hk_body_direction(&o->motion.end, own, turned);
    hk_to_z_up(y_up, turned, solid.axis[k]);
  }
  if (shape->kind != HK_SHAPE_MESH) return solid;
  solid.vertices = shape->surface->vertices, solid.faces = shape->surface->faces;
  solid.vertex = shape->surface->vertex, solid.face = (const uint32_t(*)[3])shape->surface->face;
  return solid;
}

void hk_obstacle_solids(const hk_obstacle_set *set, bool y_up, hk_frame_solid *solid) {
  for (size_t k = 0; k < set->count; k++) solid[k] = solid_of(set->member[k], y_up);
}
