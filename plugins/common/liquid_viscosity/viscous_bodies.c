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

hk_status hk_viscous_bodies_open(hk_viscous_bodies *s, const hk_liquid *l) {
  const hk_host *host = l->host;
  s->count = 0;
  if (l->bodies.count == 0) return HK_OK;
  for (size_t b = 0; b < l->bodies.count; b++) s->count += moves(&l->bodies.body[b]);
  if (!s->row) s->row = host->allocate(host, l->bodies.count * sizeof *s->row);
  if (s->row && s->count <= s->most) return HK_OK;
  host->release(host, s->among);
  host->release(host, s->b);
  s->among = host->allocate(host, 36 * s->count * s->count * sizeof *s->among);
  s->b = host->allocate(host, 6 * s->count * sizeof *s->b);
  s->most = s->row && s->among && s->b ? s->count : 0;
  if (s->row && s->among && s->b) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies in a viscous liquid", l->bodies.count);
}

void hk_viscous_bodies_begin(hk_viscous_bodies *s, const hk_liquid *l, size_t faces) {
  size_t row = faces, width = 6 * s->count;
  double unit = l->density * hk_liquid_cell_volume(&l->grid);
  s->first = faces;
  if (s->count == 0) return;
  memset(s->among, 0, width * width * sizeof *s->among);
  memset(s->b, 0, width * sizeof *s->b);
  for (size_t b = 0; b < l->bodies.count; b++) {
    const hk_liquid_body *body = &l->bodies.body[b];
    if (!moves(body)) continue;
    double cofactor[9], *own = s->among + (row - faces) * (width + 1);
    double volume = hk_matrix3_cofactor(body->inverse_inertia, cofactor);
    for (size_t c = 0; c < 3; c++) {
      own[c * width + c] = body->mass / unit;
      for (size_t a = 0; a < 3; a++) own[(3 + c) * width + 3 + a] = cofactor[3 * c + a] / volume / unit;
    }
    s->row[b] = row;
    row += 6;
  }
}

bool hk_viscous_bodies_near(const hk_liquid *l, size_t i) {
  const hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3; c++) {
    if (l->bodies.owner[c][i]) return true;
    for (int a = 0; a < 3; a++) {
      size_t step = g->stride[a];
      if (l->bodies.owner[c][i - step] || (i + step < g->size && l->bodies.owner[c][i + step])) return true;
    }
  }
  return false;
}

void hk_viscous_bodies_add(const hk_liquid *l, hk_viscous_bodies *s, const hk_strain *e, double factor) {
  double by[4][6], size = factor * e->weight;
  size_t width = 6 * s->count;
  if (e->covered == 0 || !(e->weight > 0)) return;
  double strain = hk_strain_now(&l->grid, e);
  for (int k = 0; k < e->covered; k++) hk_strain_by_body(l, e, k, by[k]);
  for (int k = 0; k < e->covered; k++)
    for (size_t c = 0; c < 6; c++) {
      size_t row = s->row[e->body[k]] + c - s->first;
      s->b[row] -= size * by[k][c] * strain;
      for (int m = 0; m < e->covered; m++)
        for (size_t d = 0; d < 6; d++)
          s->among[row * width + s->row[e->body[m]] + d - s->first] += size * by[k][c] * by[m][d];
    }
}

void hk_viscous_bodies_close_up(const hk_viscous_bodies *s, size_t *start, uint32_t *column, double *value, double *b) {
  size_t width = 6 * s->count;
  for (size_t r = 0; r < width; r++) {
    size_t to = start[s->first + r];
    b[s->first + r] = s->b[r];
    for (size_t c = 0; c < width; c++) {
      if (s->among[r * width + c] == 0 && c != r) continue;
      column[to] = (uint32_t)(s->first + c);
      value[to++] = s->among[r * width + c];
    }
    start[s->first + r + 1] = to;
  }
}

void hk_viscous_bodies_end(const hk_viscous_bodies *s, hk_liquid *l, const double *x) {
  for (size_t b = 0; b < l->bodies.count; b++) {
    hk_liquid_body *body = &l->bodies.body[b];
    if (!moves(body)) continue;
    hk_add_scaled(body->velocity, 1, x + s->row[b]);
    hk_add_scaled(body->spin, 1, x + s->row[b] + 3);
  }
  if (s->count) hk_liquid_move_bodies(l);
}

void hk_viscous_bodies_close(hk_viscous_bodies *s, const hk_host *host) {
  host->release(host, s->row);
  host->release(host, s->among);
  host->release(host, s->b);
  *s = (hk_viscous_bodies){0};
}
