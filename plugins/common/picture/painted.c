#include "plugins/common/picture/painted.h"

/* A tube is raised by its radius and longer by it at both ends, and never thinner than a pixel and a half. */
hk_patch hk_things_patch(const hk_painter *p, const hk_view_setup *setup, const hk_lens *lens) {
  hk_patch_maker m;
  float side = (float)setup->thickness / 2;
  hk_patch_begin(&m, lens, p->canvas.width, p->canvas.height);
  for (size_t k = 0; k < p->triangles && !m.whole; k++)
    for (int i = 0; i < 3; i++) hk_patch_add(&m, p->vertex[p->triangle[k][i]].x, side, 2);
  for (size_t k = 0; k < p->tubes && !m.whole; k++) {
    hk_patch_add(&m, p->tube[k].a, 2 * p->tube[k].radius, 3);
    hk_patch_add(&m, p->tube[k].b, 2 * p->tube[k].radius, 3);
  }
  return hk_patch_end(&m);
}

/* Around the texels of the floor's shadow that are not light. */
hk_patch hk_shadow_patch(const hk_painter *p, const hk_lens *lens) {
  int low[2] = {HK_SHADOW_SIZE, HK_SHADOW_SIZE}, high[2] = {-1, -1};
  hk_patch_maker m;
  hk_patch_begin(&m, lens, p->canvas.width, p->canvas.height);
  for (int y = 0; y < HK_SHADOW_SIZE; y++)
    for (int x = 0; x < HK_SHADOW_SIZE; x++) {
      if (!p->shade[y * HK_SHADOW_SIZE + x]) continue;
      low[0] = x < low[0] ? x : low[0], high[0] = x > high[0] ? x : high[0];
      low[1] = y < low[1] ? y : low[1], high[1] = y;
    }
  for (int corner = 0; corner < 4 && high[0] >= 0; corner++) {
    float at[3] = {0, 0, p->map.floor};
    for (int c = 0; c < 2; c++) { /* a texel more: the filter reaches over its side */
      int texel = corner >> c & 1 ? high[c] + 2 : low[c] - 1;
      at[c] = p->map.corner[c] + p->map.side * (float)texel / HK_SHADOW_SIZE;
    }
    hk_patch_add(&m, at, 0, 2);
  }
  return hk_patch_end(&m);
}
