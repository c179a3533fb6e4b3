/* The liquid and cloth: couple.h for walls without thickness. */
#include "plugins/common/liquid/couple.h"

#include <string.h>

/* Side `upper` of the cell i along axis c, which cloth crosses. */
typedef struct thin_side {
  const hk_thin_crossing *at;
  size_t cell, row;
  int c;
  bool upper;
} thin_side;

/* 1/m: by which a velocity outwards becomes the flux out of the cell. */
static double outwards(const hk_liquid_grid *g, const thin_side *side) {
  return (side->upper ? 1 : -1) / g->spacing[side->c];
}

/* Points move by the second half of a body's six numbers, whose mass is a matrix: pins may forbid directions. */
static hk_status add_walls(hk_liquid *l, const thin_side *side) {
  hk_status status = HK_OK;
  for (int k = 0; k < 3 && status == HK_OK; k++) {
    hk_moving_wall wall = {(uint32_t)side->row, (uint32_t)(l->bodies.count + side->at->vertex[k]), {0}};
    wall.flux[3 + side->c] = side->at->weight[k] * outwards(&l->grid, side);
    status = hk_moving_walls_add(&l->pressure.walls, l->host, &wall);
  }
  return status;
}

/* m/s, outwards: the slope of the last pressure in the cell, from the face that is opposite; 0 where a cell had none.
 */
static double slope_across(const hk_liquid *l, const thin_side *side, const double *last) {
  const hk_liquid_grid *g = &l->grid;
  size_t s = g->stride[side->c], i = side->cell, beyond = side->upper ? i - s : i + s;
  double open = g->open[side->c][side->upper ? i : i + s];
  if (!(open > 0) || last[i] == 0) return 0;
  if (g->unknown[beyond] != HK_LIQUID_NONE)
    return last[beyond] == 0 ? 0 : (last[i] - last[beyond]) / g->spacing[side->c];
  return last[i] / (hk_liquid_part_to_surface(g, side->c, side->upper ? i : i + s, i) * g->spacing[side->c]);
}

/* Gives the points what acts on this side beyond the pressure in the centre. */
static void push_beyond(hk_liquid *l, const thin_side *side, const double *last) {
  const hk_liquid_grid *g = &l->grid;
  double centre[3], out = side->upper ? 1 : -1;
  hk_liquid_face_place(g, side->cell, side->c, centre);
  double way = out * (side->at->place - centre[side->c] - g->spacing[side->c] / 2);
  double impulse = l->density * hk_liquid_cell_volume(g) * way * slope_across(l, side, last) * outwards(g, side);
  for (int k = 0; k < 3; k++) {
    hk_thin_vertex *v = &l->thin.vertex[side->at->vertex[k]];
    for (int c = 0; c < 3; c++) v->v[c] += v->inverse[3 * c + side->c] * side->at->weight[k] * impulse;
  }
}

static hk_status couple_row(hk_liquid *l, size_t row, const double *last) {
  hk_status status = HK_OK;
  for (int f = 0; f < 6 && status == HK_OK; f++) {
    thin_side side = {.cell = l->pressure.cell[row], .row = row, .c = f / 2, .upper = f & 1};
    side.at = hk_thin_walls_at(&l->thin, side.c, side.cell + (side.upper ? l->grid.stride[side.c] : 0));
    if (!side.at) continue;
    push_beyond(l, &side, last);
    status = add_walls(l, &side);
  }
  return status;
}

void hk_liquid_move_thin_faces(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < g->size; i++) {
      const hk_thin_crossing *at = hk_thin_walls_at(&l->thin, c, i);
      if (at) g->wall[c][i] = hk_thin_walls_speed(&l->thin, at, c);
    }
}

hk_status hk_liquid_couple_thin(hk_liquid *l, const double *last) {
  hk_status status = HK_OK;
  if (l->thin.triangles == 0) return HK_OK;
  hk_moving_body *body = l->pressure.walls.body + l->bodies.count;
  double mass = l->density * hk_liquid_cell_volume(&l->grid);
  for (size_t k = 0; k < l->thin.vertices; k++) {
    memset(&body[k], 0, sizeof body[k]);
    body[k].mass = INFINITY;
    for (int c = 0; c < 9; c++) body[k].inverse_inertia[c] = mass * l->thin.vertex[k].inverse[c];
  }
  for (size_t k = 0; k < l->pressure.rows && status == HK_OK; k++) status = couple_row(l, k, last);
  hk_liquid_move_thin_faces(l);
  return status;
}

void hk_liquid_move_thin(hk_liquid *l) {
  if (l->thin.triangles == 0) return;
  const hk_moving_body *body = l->pressure.walls.body + l->bodies.count;
  for (size_t k = 0; k < l->thin.vertices; k++)
    for (int c = 0; c < 3; c++) l->thin.vertex[k].v[c] += body[k].reply[3 + c];
  hk_liquid_move_thin_faces(l);
}
