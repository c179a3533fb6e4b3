/* See couple.h. The flux that a body's motion takes out of a cell is that through the closed parts of its faces, as the
 * divergence has it, so both momenta change by the same pressure. Pressure is known in the centres of cells and acts on
 * the wall: the difference, its slope times the distance, is of first order in the cell, a body would float by steps of
 * cells, and so it is counted as a force. It is taken from the step before: within the matrix it would not be
 * symmetric. */
#include "plugins/common/liquid/couple.h"
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

hk_status hk_liquid_couple(hk_liquid *l) {
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
  return status;
}

/* ---- the reaction ---- */

/* m^2/s: by how much the pressure on the wall is above that in the centre of the cell. */
static double beyond_centre(const hk_liquid *l, const hk_moving_wall *w) {
  const hk_liquid_grid *g = &l->grid;
  size_t i = l->pressure.cell[w->row];
  double size = hk_length(w->flux), slope = 0, mean = 0;
  if (!(size > 0)) return 0;
  for (int b = 0; b < 8; b++)
    mean +=
        g->solid[i + (b & 1) * g->stride[0] + (size_t)(b >> 1 & 1) * g->stride[1] + (size_t)(b >> 2) * g->stride[2]] /
        8;
  for (int c = 0; c < 3; c++) {
    size_t s = g->stride[c];
    double low = g->open[c][i], high = g->open[c][i + s];
    if (!(low + high > 0)) continue;
    double sum = low * hk_liquid_slope(l, c, i) + high * hk_liquid_slope(l, c, i + s);
    slope += w->flux[c] / size * sum / (low + high);
  }
  double most = 2 * fmax(g->spacing[0], fmax(g->spacing[1], g->spacing[2]));
  return fabs(mean) < most ? mean * slope : 0;
}

/* Those of both projections of a viscous liquid add up; hk_liquid_bodies_begin has taken those of the last step. */
static void find_forces(hk_liquid *l) {
  double unit = l->density * hk_liquid_cell_volume(&l->grid) / l->bodies.h;
  for (size_t k = 0; k < l->pressure.walls.count; k++) {
    const hk_moving_wall *w = &l->pressure.walls.wall[k];
    if (w->body >= l->bodies.count) continue;
    double part = unit * beyond_centre(l, w);
    for (int c = 0; c < 6; c++) l->bodies.force[12 * w->body + (size_t)c] += part * w->flux[c];
  }
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

void hk_liquid_react(hk_liquid *l) {
  hk_moving_walls *walls = &l->pressure.walls;
  if (walls->bodies == 0) return;
  hk_moving_walls_reply(walls, l->pressure.x);
  if (l->bodies.count == 0) return;
  for (size_t k = 0; k < walls->count; k++)
    if (walls->wall[k].body < l->bodies.count) l->bodies.body[walls->wall[k].body].wet = true;
  for (size_t b = 0; b < l->bodies.count; b++) {
    if (!l->bodies.body[b].wet) continue;
    hk_add_scaled(l->bodies.body[b].velocity, 1, walls->body[b].reply);
    hk_add_scaled(l->bodies.body[b].spin, 1, walls->body[b].reply + 3);
  }
  find_forces(l);
  hk_liquid_move_bodies(l);
}
