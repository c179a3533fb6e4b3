#include "plugins/common/grains/funnel_mesh.h"

#include <math.h>

enum { RINGS = HK_FUNNEL_RINGS, SIDES = HK_FUNNEL_SIDES };

static void set_ring(hk_funnel_mesh *m, int ring, double z, double radius) {
  for (int k = 0; k < SIDES; k++) {
    double angle = 2 * acos(-1) * k / SIDES, *at = m->vertex[ring * SIDES + k];
    at[0] = radius * cos(angle), at[1] = radius * sin(angle), at[2] = z;
  }
}

/* Anticlockwise seen from outside of the cone. */
static void join(hk_funnel_mesh *m, int ring, int k) {
  uint32_t a = (uint32_t)(ring * SIDES + k), b = (uint32_t)(ring * SIDES + (k + 1) % SIDES);
  uint32_t(*face)[3] = m->face + 2 * (ring * SIDES + k);
  face[0][0] = a, face[0][1] = b, face[0][2] = b + SIDES;
  face[1][0] = a, face[1][1] = b + SIDES, face[1][2] = a + SIDES;
}

void hk_funnel_mesh_make(hk_funnel_mesh *m, const double funnel[5], double low, double high) {
  double neck = funnel[3], slope = funnel[4], below = low - funnel[2], above = high - funnel[2];
  *m = (hk_funnel_mesh){.surface = {.vertices = RINGS * SIDES, .faces = 2 * (RINGS - 1) * SIDES}};
  set_ring(m, 0, below, neck - slope * below);
  set_ring(m, 1, 0, neck);
  set_ring(m, 2, above, neck + slope * above);
  for (int ring = 0; ring + 1 < RINGS; ring++)
    for (int k = 0; k < SIDES; k++) join(m, ring, k);
  m->surface.vertex = m->vertex[0], m->surface.face = m->face;
  m->obstacle.shape = (hk_shape){.kind = HK_SHAPE_MESH, .hollow = true, .surface = &m->surface};
  m->obstacle.motion.end =
      (hk_body_frame){.origin = {funnel[0], funnel[1], funnel[2]}, .turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}
