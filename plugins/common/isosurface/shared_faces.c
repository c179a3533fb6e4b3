/* Whether blocks agree on the points of the faces that they share. Where one is left out, by its bounds or as without a
 * surface, the face has to be all inside or all outside; otherwise triangles would be missing there. A field of numbers
 * in an array always agrees with itself. */
#include "plugins/common/isosurface/grid_blocks.h"

/* Point k of 81 of a face of a block: side 0 or 1 of an axis. */
static unsigned face_point(const hk_surface_block *b, unsigned axis, unsigned side, unsigned k) {
  unsigned at[3];
  at[axis] = side * HK_SIDE;
  at[(axis + 1) % 3] = k % HK_POINTS, at[(axis + 2) % 3] = k / HK_POINTS;
  return b->inside[at[2] * HK_POINTS + at[1]] >> at[0] & 1U;
}

static bool same_face(const hk_surface_block *b, const hk_surface_block *other, unsigned axis, unsigned side) {
  unsigned first = face_point(b, axis, side, 0);
  for (unsigned k = 0; k < HK_POINTS * HK_POINTS; k++) {
    unsigned expected = other ? face_point(other, axis, 1 - side, k) : first;
    if (face_point(b, axis, side, k) != expected) return false;
  }
  return true;
}

static bool agrees(const hk_surface_work *w, const hk_surface_block *b) {
  size_t corner[3], step[3] = {1, w->blocks[0], w->blocks[0] * w->blocks[1]};
  hk_block_corner(w, b->number, corner);
  for (unsigned face = 0; face < 6; face++) {
    unsigned axis = face / 2, side = face % 2;
    size_t at = corner[axis] / HK_SIDE;
    if (side ? at + 1 == w->blocks[axis] : at == 0) continue; /* all outside, in the layer */
    uint32_t slot = w->slot[side ? b->number + step[axis] : b->number - step[axis]];
    if (!same_face(b, slot == hk_no_slot ? NULL : &w->block[slot], axis, side)) return false;
  }
  return true;
}

hk_status hk_blocks_agree(const hk_surface_work *w) {
  for (size_t slot = 0; slot < w->count; slot++) {
    size_t corner[3];
    double low[3], high[3];
    if (agrees(w, &w->block[slot])) continue;
    hk_block_corner(w, w->block[slot].number, corner);
    for (int c = 0; c < 3; c++)
      low[c] = hk_point_place(w, c, corner[c]), high[c] = hk_point_place(w, c, corner[c] + HK_SIDE);
    return w->host->fail(
        w->host, HK_FAILED,
        "isosurface: the field contradicts itself around the block from (%g, %g, %g) to (%g, %g, %g): make its "
        "bounds contain all of its values, and its values depend on the place alone",
        low[0], low[1], low[2], high[0], high[1], high[2]);
  }
  return HK_OK;
}
