#include "plugins/common/frame_data/solid.h"
#include "plugins/kit/vector3.h"

#include <math.h>

const char *const hk_solid_names[] = {
    [HK_SHAPE_PLANE] = "plane",       [HK_SHAPE_SPHERE] = "sphere",   [HK_SHAPE_BOX] = "box",
    [HK_SHAPE_CYLINDER] = "cylinder", [HK_SHAPE_CAPSULE] = "capsule", [HK_SHAPE_MESH] = "mesh"};

static void enlarge(double low[3], double high[3], const double x[3]) {
  for (int c = 0; c < 3; c++) low[c] = fmin(low[c], x[c]), high[c] = fmax(high[c], x[c]);
}

static void mesh_box(const hk_frame_solid *s, double low[3], double high[3]) {
  for (size_t i = 0; i < s->vertices; i++) {
    double x[3];
    for (int c = 0; c < 3; c++) {
      x[c] = s->centre[c];
      for (int k = 0; k < 3; k++) x[c] += s->vertex[3 * i + (size_t)k] * s->axis[k][c];
    }
    enlarge(low, high, x);
  }
}

void hk_solid_box(const hk_frame_solid *solid, double low[3], double high[3]) {
  if (solid->kind == HK_SHAPE_MESH) {
    mesh_box(solid, low, high);
    return;
  }
  for (int c = 0; c < 3 && solid->kind != HK_SHAPE_PLANE; c++) {
    double a = fabs(solid->axis[0][c]), b = fabs(solid->axis[1][c]), d = fabs(solid->axis[2][c]);
    double half = solid->kind == HK_SHAPE_BOX                                           ? a + b + d
                  : solid->kind == HK_SHAPE_CYLINDER || solid->kind == HK_SHAPE_CAPSULE ? sqrt(a * a + b * b) + d
                                                                                        : sqrt(a * a + b * b + d * d);
    low[c] = fmin(low[c], solid->centre[c] - half);
    high[c] = fmax(high[c], solid->centre[c] + half);
  }
}

/* In its own frame: along its axes, which are orthogonal. */
static double distance_from(const hk_frame_solid *s, const double x[3], double n[3]) {
  hk_shape shape = {.kind = s->kind, .hollow = s->hollow, .normal = {0, 0, 1}};
  double unit[3][3], p[3], own[3], d[3] = {x[0] - s->centre[0], x[1] - s->centre[1], x[2] - s->centre[2]};
  for (int k = 0; k < 3; k++) {
    shape.half[k] = hk_length(s->axis[k]);
    for (int c = 0; c < 3; c++) unit[k][c] = shape.half[k] > 0 ? s->axis[k][c] / shape.half[k] : 0;
    p[k] = hk_dot(unit[k], d);
  }
  double distance = hk_shape_distance(&shape, p, own);
  for (int c = 0; c < 3; c++) n[c] = own[0] * unit[0][c] + own[1] * unit[1][c] + own[2] * unit[2][c];
  return distance;
}

double hk_solids_distance(const void *list, const double x[3], double n[3]) {
  const hk_solid_list *l = list;
  double least = INFINITY, normal[3];
  n[0] = n[1] = n[2] = 0;
  for (size_t k = 0; k < l->count; k++) {
    if (l->solid[k].kind == HK_SHAPE_MESH) continue;
    double distance = distance_from(&l->solid[k], x, normal);
    if (distance < least) least = distance, hk_copy(n, normal);
  }
  return least;
}
