#include "plugins/common/volume/volume_pass.h"

static hk_patch join(const hk_patch *a, const hk_patch *b) {
  if (hk_patch_is_empty(a)) return *b;
  if (hk_patch_is_empty(b)) return *a;
  hk_patch p = {a->left < b->left ? a->left : b->left, a->bottom < b->bottom ? a->bottom : b->bottom, 0, 0};
  int right = a->left + a->width, right_b = b->left + b->width, top = a->bottom + a->height;
  int top_b = b->bottom + b->height;
  p.width = (right > right_b ? right : right_b) - p.left;
  p.height = (top > top_b ? top : top_b) - p.bottom;
  return p;
}

static hk_status draw_one(hk_volume_draw *d, const hk_canvas *canvas, unsigned char *rgba) {
  const hk_patch *p = &d->patch;
  size_t pixels = (size_t)p->width * (size_t)p->height;
  float *distance = d->host->allocate(d->host, pixels * sizeof *distance);
  if (!distance) return d->host->fail(d->host, HK_NO_MEMORY, "no memory for the depths of a picture");
  hk_canvas_read_depth(canvas, p->left, p->bottom, p->width, p->height, distance);
  hk_camera_distances(&d->setup->camera, pixels, distance);
  d->distance = distance;
  hk_status status = hk_volume_draw_on(d, rgba);
  d->host->release(d->host, distance);
  return status;
}

hk_status hk_volume_pass(const hk_volumes *all, const hk_volume_draw *like, const hk_canvas *canvas,
                         const hk_lens *lens, hk_patch *changed, unsigned char *rgba) {
  hk_status status = HK_OK;
  *changed = (hk_patch){0};
  for (size_t k = 0; k < all->count && status == HK_OK; k++) {
    hk_volume_draw d = *like;
    d.volume = all->member[k];
    d.patch = hk_volume_patch(&d, lens);
    if (hk_patch_is_empty(&d.patch)) continue;
    *changed = join(changed, &d.patch);
    status = draw_one(&d, canvas, rgba);
  }
  return status;
}
