#include "plugins/common/film/obstacle_solids.h"

#include "plugins/common/snapshot/look.h"

static const hk_solid_kind kinds[] = {
    [HK_SHAPE_PLANE] = HK_SOLID_PLANE,       [HK_SHAPE_SPHERE] = HK_SOLID_SPHERE,   [HK_SHAPE_BOX] = HK_SOLID_BOX,
    [HK_SHAPE_CYLINDER] = HK_SOLID_CYLINDER, [HK_SHAPE_CAPSULE] = HK_SOLID_CAPSULE, [HK_SHAPE_MESH] = HK_SOLID_MESH,
};

/* From the middle to the surface along axis k, in the shape's own frame. */
static void own_axis(const hk_shape *s, int k, double axis[3]) {
  axis[0] = axis[1] = axis[2] = 0;
  if (s->kind == HK_SHAPE_PLANE && k == 2)
    for (int c = 0; c < 3; c++) axis[c] = s->normal[c];
  else
    axis[k] = s->kind == HK_SHAPE_MESH ? 1 : s->half[k];
}

static hk_solid solid_of(const hk_obstacle *o, bool y_up) {
  const hk_shape *shape = &o->shape;
  hk_solid solid = {.kind = kinds[shape->kind], .hollow = shape->hollow};
  hk_look_turn(y_up, o->motion.end.origin, solid.centre);
  for (int k = 0; k < 3; k++) {
    double own[3], turned[3];
    own_axis(shape, k, own);
    hk_body_direction(&o->motion.end, own, turned);
    hk_look_turn(y_up, turned, solid.axis[k]);
  }
  if (shape->kind != HK_SHAPE_MESH) return solid;
  solid.vertices = shape->surface->vertices, solid.faces = shape->surface->faces;
  solid.vertex = shape->surface->vertex, solid.face = (const uint32_t(*)[3])shape->surface->face;
  return solid;
}

void hk_obstacle_solids(const hk_obstacle_set *set, bool y_up, hk_solid *solid) {
  for (size_t k = 0; k < set->count; k++) solid[k] = solid_of(set->member[k], y_up);
}
