#include "plugins/common/frame_data/solid.h"

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
