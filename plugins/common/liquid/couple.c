/* See couple.h. The flux that a body's motion takes out of a cell is that through the closed parts of its faces, as the
 * divergence has it, so both momenta change by the same pressure. Pressure is known in the centres of cells and acts on
 * the wall: the difference, its slope times the distance, is of first order in the cell, a body would float by steps of
 * cells, and so it is counted as a force. It is taken from the step before: within the matrix it would not be
 * symmetric. */
#include "plugins/common/liquid/couple.h"
#include "plugins/common/mac_grid/cut_cells.h"
#include "plugins/kit/vector3.h"

/* ---- the walls ---- */

/* The flux through the closed part of face i of component c, out of the cell on its lower side. */
static void add_flux(const hk_liquid *l, size_t i, int c, double sign, hk_moving_wall *w) {
  const hk_liquid_grid *g = &l->grid;
  const hk_liquid_body *b = &l->bodies.body[w->body];
  double part = sign * (1 - g->open[c][i]) / g->spacing[c], x[3], r[3], arm[3];
  const double along[3] = {c == 0, c == 1, c == 2};
  hk_liquid_face_place(g, i, c, x);
  hk_subtract(r, x, b->centre);
  for (int a = 0; a < 3; a++) r[a] = g->flat[a] ? 0 : r[a];
  hk_cross(arm, r, along); /* (w x r).e = w.(r x e) */
  hk_add_scaled(w->flux, part, along);
  hk_add_scaled(w->flux + 3, part, arm);
}

/* The walls of a row, one for each body. */
static hk_status add_walls(hk_liquid *l, size_t k) {
  const hk_liquid_bodies *bodies = &l->bodies;
  hk_moving_wall wall[6];
  size_t count = 0, i = l->pressure.cell[k];
  for (int f = 0; f < 6; f++) {
    size_t face = f & 1 ? i + l->grid.stride[f / 2] : i, n = 0;
    uint16_t owner = bodies->owner[f / 2][face];
    if (owner == 0 || !bodies->body[owner - 1].free) continue;
    while (n < count && wall[n].body + 1 != owner) n++;
    if (n == count) wall[count++] = (hk_moving_wall){(uint32_t)k, owner - 1U, {0}};
    add_flux(l, face, f / 2, f & 1 ? 1 : -1, &wall[n]);
  }
  hk_status status = HK_OK;
  for (size_t n = 0; n < count && status == HK_OK; n++)
    status = hk_moving_walls_add(&l->pressure.walls, l->host, &wall[n]);
  return status;
}

/* ---- what acts beyond the centres of cells ---- */

/* m/s, along axis c: the slope of the last pressure in cell i, the mean of its faces by how far they are open; false:
 * no face of it had a pressure on both sides. */
static bool own_slope(const hk_liquid *l, const double *last, size_t i, int c, double *slope) {
  const hk_liquid_grid *g = &l->grid;
  double sum = 0, all = 0;
  for (int far = 0; far < 2 && last[i] != 0; far++) {
    size_t face = far ? i + g->stride[c] : i, beside = far ? face : i - g->stride[c];
    double open = g->open[c][face], rise = -last[i];
    if (!(open > 0)) continue;
    bool liquid = g->unknown[beside] != HK_LIQUID_NONE;
    if (liquid && last[beside] == 0) continue;
    rise = liquid ? last[beside] - last[i] : rise / hk_liquid_part_to_surface(g, c, face, i);
    sum += open * (far ? rise : -rise) / g->spacing[c];
    all += open;
  }
  *slope = all > 0 ? sum / all : 0;
  return all > 0;
}

/* The same, and in a cell that the body has just uncovered that of the cells beside it. */
static double slope_at(const hk_liquid *l, const double *last, size_t i, int c) {
  const hk_liquid_grid *g = &l->grid;
  double slope, sum = 0, count = 0;
  if (own_slope(l, last, i, c, &slope)) return slope;
  for (int f = 0; f < 6; f++) {
    size_t s = g->stride[f / 2], face = f & 1 ? i + s : i, beside = f & 1 ? i + s : i - s;
    if (!(g->open[f / 2][face] > 0) || g->unknown[beside] == HK_LIQUID_NONE) continue;
    if (own_slope(l, last, beside, c, &slope)) sum += slope, count++;
  }
  return count > 0 ? sum / count : 0;
}

/* m^2/s: by how much the pressure on the wall is above that in the centre of the cell. */
static double beyond_centre(const hk_liquid *l, const double *last, const hk_moving_wall *w) {
  const hk_liquid_grid *g = &l->grid;
  size_t i = l->pressure.cell[w->row];
  double size = hk_length(w->flux), slope = 0, mean = hk_cut_cell_distance(g, i);
  if (!(size > 0)) return 0;
  for (int c = 0; c < 3; c++)
    if (w->flux[c] != 0) slope += w->flux[c] / size * slope_at(l, last, i, c);
  double most = 2 * fmax(g->spacing[0], fmax(g->spacing[1], g->spacing[2]));
  return fabs(mean) < most ? mean * slope : 0;
}

/* The faces that the bodies cover move as they do. */
static void move_rows(void *context, size_t begin, size_t end, size_t piece) {
  hk_liquid *l = context;
  hk_liquid_grid *g = &l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + g->cells[hk_liquid_inner(g)]; i++)
      for (int c = 0; c < 3; c++) {
        uint16_t owner = l->bodies.owner[c][i];
        double x[3], u[3];
        if (owner == 0 || !l->bodies.body[owner - 1].wet) continue;
        hk_liquid_face_place(g, i, c, x);
        hk_liquid_body_velocity(&l->bodies.body[owner - 1], x, u);
        g->wall[c][i] = u[c];
      }
  }
}

void hk_liquid_move_bodies(hk_liquid *l) {
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, move_rows, l);
}

/* N s, and N m s about the centre: gives the bodies what the slope of the last pressure comes to where their walls are
 * now. */
static void push_beyond(hk_liquid *l, const double *last) {
  double unit = l->density * hk_liquid_cell_volume(&l->grid);
  bool any = false;
  for (size_t k = 0; k < l->pressure.walls.count; k++) {
    const hk_moving_wall *w = &l->pressure.walls.wall[k];
    double part = unit * beyond_centre(l, last, w), impulse[6];
    for (int c = 0; c < 6; c++) impulse[c] = part * w->flux[c];
    hk_liquid_body_push(&l->bodies.body[w->body], impulse);
    l->bodies.body[w->body].wet = any = true;
  }
  if (any) hk_liquid_move_bodies(l);
}

hk_status hk_liquid_couple(hk_liquid *l, const double *last) {
  hk_moving_walls *walls = &l->pressure.walls;
  double mass = l->density * hk_liquid_cell_volume(&l->grid);
  hk_moving_walls_clear(walls);
  hk_status status = HK_OK;
  if (l->bodies.count == 0) return HK_OK;
  for (size_t b = 0; b < l->bodies.count; b++) {
    walls->body[b].mass = l->bodies.body[b].mass / mass;
    for (int c = 0; c < 9; c++) walls->body[b].inverse_inertia[c] = mass * l->bodies.body[b].inverse_inertia[c];
  }
  for (size_t k = 0; k < l->pressure.rows && status == HK_OK; k++) status = add_walls(l, k);
  if (status == HK_OK) push_beyond(l, last);
  return status;
}

/* ---- the reaction ---- */

void hk_liquid_react(hk_liquid *l) {
  hk_moving_walls *walls = &l->pressure.walls;
  if (walls->bodies == 0) return;
  hk_moving_walls_reply(walls, l->pressure.x);
  if (l->bodies.count == 0) return;
  for (size_t b = 0; b < l->bodies.count; b++) {
    if (!l->bodies.body[b].wet) continue;
    hk_add_scaled(l->bodies.body[b].velocity, 1, walls->body[b].reply);
    hk_add_scaled(l->bodies.body[b].spin, 1, walls->body[b].reply + 3);
  }
  hk_liquid_move_bodies(l);
}
