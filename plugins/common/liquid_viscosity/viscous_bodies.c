/* See viscous_bodies.h. Bodies are few beside faces: one thread takes them in order. */
#include "plugins/common/liquid_viscosity/viscous_bodies.h"
#include "plugins/common/liquid/couple.h"
#include "plugins/common/solids/matrix3.h"
#include "plugins/kit/vector3.h"

#include <string.h>

double hk_strain_now(const hk_liquid_grid *g, const hk_strain *e) {
  double strain = e->walls;
  for (int k = 0; k < e->count; k++) strain += e->by[k] * g->u[e->axis[k]][e->at[k]];
  return strain;
}

void hk_strain_by_body(const hk_liquid *l, const hk_strain *e, int k, double by[6]) {
  const hk_liquid_grid *g = &l->grid;
  int c = e->covered_axis[k];
  double r[3];
  const double along[3] = {c == 0, c == 1, c == 2};
  hk_subtract(r, e->covered_at[k], l->bodies.body[e->body[k]].centre);
  for (int a = 0; a < 3; a++) r[a] = g->flat[a] ? 0 : r[a];
  hk_cross(by + 3, r, along); /* (w x r).e = w.(r x e) */
  for (int a = 0; a < 3; a++) {
    by[a] = e->covered_by[k] * along[a];
    by[3 + a] *= e->covered_by[k];
  }
}

static bool moves(const hk_liquid_body *b) { return b->free && b->wet; }

hk_status hk_viscous_bodies_open(hk_liquid_viscosity *v, const hk_liquid *l) {
  const hk_host *host = l->host;
  v->bodies = 0;
  if (l->bodies.count == 0) return HK_OK;
  if (!v->body_row) v->body_row = host->allocate(host, l->bodies.count * sizeof *v->body_row);
  if (!v->body_row) return host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies in a liquid", l->bodies.count);
  for (size_t b = 0; b < l->bodies.count; b++) v->bodies += moves(&l->bodies.body[b]);
  if (v->bodies <= v->most_bodies) return HK_OK;
  host->release(host, v->among);
  v->among = host->allocate(host, 36 * v->bodies * v->bodies * sizeof *v->among);
  v->most_bodies = v->among ? v->bodies : 0;
  return v->among ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies in a liquid", v->bodies);
}

void hk_viscous_bodies_begin(hk_liquid_viscosity *v, const hk_liquid *l) {
  size_t row = v->faces, width = 6 * v->bodies;
  double unit = l->density * hk_liquid_cell_volume(&l->grid);
  if (v->bodies) memset(v->among, 0, width * width * sizeof *v->among);
  for (size_t b = 0; b < l->bodies.count; b++) {
    const hk_liquid_body *body = &l->bodies.body[b];
    if (!moves(body)) continue;
    double cofactor[9], *own = v->among + (row - v->faces) * (width + 1);
    double volume = hk_matrix3_cofactor(body->inverse_inertia, cofactor);
    for (size_t c = 0; c < 3; c++) {
      own[c * width + c] = body->mass / unit;
      for (size_t a = 0; a < 3; a++) own[(3 + c) * width + 3 + a] = cofactor[3 * c + a] / volume / unit;
    }
    v->body_row[b] = row;
    row += 6;
  }
}

bool hk_viscous_bodies_near(const hk_liquid *l, size_t i) {
  const hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3; c++) {
    if (l->bodies.owner[c][i]) return true;
    for (int a = 0; a < 3; a++) {
      size_t s = g->stride[a];
      if (l->bodies.owner[c][i - s] || (i + s < g->size && l->bodies.owner[c][i + s])) return true;
    }
  }
  return false;
}

void hk_viscous_bodies_add(const hk_liquid *l, hk_liquid_viscosity *v, const hk_strain *e, double factor) {
  double by[4][6], size = factor * e->weight, width = 6 * (double)v->bodies;
  if (e->covered == 0 || !(e->weight > 0)) return;
  double strain = hk_strain_now(&l->grid, e);
  for (int k = 0; k < e->covered; k++) hk_strain_by_body(l, e, k, by[k]);
  for (int k = 0; k < e->covered; k++)
    for (size_t c = 0; c < 6; c++) {
      size_t row = v->body_row[e->body[k]] + c;
      v->b[row] -= size * by[k][c] * strain;
      for (int m = 0; m < e->covered; m++)
        for (size_t d = 0; d < 6; d++)
          v->among[(row - v->faces) * (size_t)width + v->body_row[e->body[m]] + d - v->faces] +=
              size * by[k][c] * by[m][d];
    }
}

void hk_viscous_bodies_close_up(hk_liquid_viscosity *v) {
  size_t width = 6 * v->bodies;
  for (size_t r = 0; r < width; r++) {
    size_t to = v->start[v->faces + r];
    for (size_t c = 0; c < width; c++) {
      if (v->among[r * width + c] == 0 && c != r) continue;
      v->column[to] = (uint32_t)(v->faces + c);
      v->value[to++] = v->among[r * width + c];
    }
    v->start[v->faces + r + 1] = to;
  }
}

void hk_viscous_bodies_end(const hk_liquid_viscosity *v, hk_liquid *l) {
  for (size_t b = 0; b < l->bodies.count; b++) {
    hk_liquid_body *body = &l->bodies.body[b];
    if (!moves(body)) continue;
    hk_add_scaled(body->velocity, 1, v->x + v->body_row[b]);
    hk_add_scaled(body->spin, 1, v->x + v->body_row[b] + 3);
  }
  if (v->bodies) hk_liquid_move_bodies(l);
}
