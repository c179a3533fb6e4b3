#include "plugins/common/obstacles/obstacle_params.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static hk_status check_size(const hk_obstacle_params *p, const hk_host *host) {
  static const char *const names[] = {"plane", "sphere", "box", "cylinder", "capsule"};
  const double *size = p->size;
  bool round = p->shape == HK_SHAPE_SPHERE || p->shape == HK_SHAPE_CYLINDER || p->shape == HK_SHAPE_CAPSULE;
  if (p->shape == HK_SHAPE_PLANE) return HK_OK;
  for (int c = 0; c < 3; c++)
    if (!(size[c] > 0))
      return host->fail(host, HK_BAD_PARAM, "size: %g m along axis %d must be above 0", size[c], c + 1);
  if (round && size[0] != size[1])
    return host->fail(host, HK_BAD_PARAM, "size: a %s is round, but its diameters are %g and %g m", names[p->shape],
                      size[0], size[1]);
  if (p->shape == HK_SHAPE_SPHERE && size[0] != size[2])
    return host->fail(host, HK_BAD_PARAM, "size: a sphere is round, but its diameters are %g and %g m", size[0],
                      size[2]);
  if (p->shape == HK_SHAPE_CAPSULE && size[2] < size[0])
    return host->fail(host, HK_BAD_PARAM, "size: a capsule of %g m is shorter than its diameter, %g m: take a sphere",
                      size[2], size[0]);
  return HK_OK;
}

static hk_status find_channel(hk_obstacle_params *p, const hk_host *host, const hk_model *model) {
  if (!p->radius_channel) return HK_OK;
  while (p->channel < model->channels && strcmp(model->channel[p->channel].name, p->radius_channel) != 0) p->channel++;
  if (p->channel == model->channels)
    return host->fail(host, HK_BAD_PARAM, "radius_channel: the scene has no channel '%s'", p->radius_channel);
  if (model->channel[p->channel].size != 1)
    return host->fail(host, HK_BAD_PARAM, "radius_channel: '%s' has %zu numbers a particle, a radius is one",
                      p->radius_channel, model->channel[p->channel].size);
  return HK_OK;
}

hk_status hk_obstacle_open(hk_obstacle *o, hk_surface *surface, hk_obstacle_params *p, const hk_host *host,
                           const hk_view *view) {
  bool mesh = p->shape == HK_SHAPE_MESH;
  hk_status status = mesh ? hk_surface_open(surface, host, &p->vertices, &p->faces, p->file) : check_size(p, host);
  if (status == HK_OK) status = find_channel(p, host, view->model);
  if (status != HK_OK) return status;
  double length = hk_length(p->normal);
  if (!(length > 0)) return host->fail(host, HK_BAD_PARAM, "normal: it has no length, so no direction");
  o->shape = (hk_shape){.kind = (hk_shape_kind)p->shape, .hollow = p->hollow, .surface = surface};
  for (int c = 0; c < 3; c++) {
    o->shape.normal[c] = p->normal[c] / length;
    o->shape.half[c] = p->size[c] / 2;
  }
  o->friction = p->friction;
  hk_obstacle_take_radii(o, p, view);
  return HK_OK;
}

hk_pose hk_obstacle_pose(const hk_obstacle_params *p, double t) {
  hk_pose pose = {.t = t};
  hk_copy(pose.position, p->position);
  hk_copy(pose.rotation, p->rotation);
  return pose;
}

hk_body_frame hk_obstacle_frame(const hk_obstacle_params *p, double t) {
  hk_pose poses[HK_POSES], now = hk_obstacle_pose(p, t);
  hk_motion motion;
  hk_motion_begin(poses, &now);
  hk_motion_of(&motion, poses);
  return motion.end;
}

void hk_obstacle_take_radii(hk_obstacle *o, const hk_obstacle_params *p, const hk_view *view) {
  o->radius = p->radius;
  o->radii = p->radius_channel && view->y ? view->y + view->model->channel[p->channel].offset * view->n : NULL;
  o->largest = 0;
  for (size_t k = 0; k < view->model->riders; k++) o->largest = fmax(o->largest, view->model->rider[k].radius);
  o->rounded = o->largest > 0 ? view->model : NULL;
}

hk_inside hk_obstacle_inside(const hk_obstacle *o, const hk_view *view) {
  hk_inside found = {0};
  double n[3];
  for (size_t i = 0; i < view->n; i++) {
    if (!hk_model_touches(view->model, i)) continue;
    double depth = -hk_obstacle_gap(o, &o->motion.end, view->x + 3 * i, i, n);
    if (!(depth > hk_obstacle_rounding(o, view->x + 3 * i, view->x + 3 * i, i))) continue;
    found.count++;
    if (depth > found.depth) found.depth = depth, found.deepest = i;
  }
  return found;
}

hk_status hk_obstacle_enclosed(const hk_obstacle *o, const hk_host *host, const hk_view *view,
                               hk_enclosed_obstacle *out) {
  static const double centre[3];
  const hk_shape *shape = &o->shape;
  *out = (hk_enclosed_obstacle){0};
  if (shape->kind == HK_SHAPE_PLANE || shape->hollow) return HK_OK;
  hk_body_place(&o->motion.end, shape->kind == HK_SHAPE_MESH ? shape->surface->vertex : centre, out->point);
  return hk_body_around_find(view, host, out->point, &out->body);
}
