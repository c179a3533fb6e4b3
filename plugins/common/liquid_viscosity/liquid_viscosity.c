/* The equations of a liquid's viscosity, face by face, and their solution by conjugate gradients. */
#include "plugins/common/liquid_viscosity/liquid_viscosity.h"
#include "plugins/common/mac_grid/cell_viscosity.h"

#include <string.h>

enum { GRAIN = 1024 };

typedef void (*strain_visitor)(void *context, const hk_strain *e);

/* Numbers that a face's row may have. */
static size_t width_of(const hk_liquid_viscosity *v) {
  size_t bodies = v->bodies.count < HK_VISCOUS_ROW - 1 ? v->bodies.count : HK_VISCOUS_ROW - 1;
  return HK_VISCOUS_ROW + 6 * bodies;
}

/* Pa s, of the strain along an axis in cell i; of that between axes a and b at its lowest corner of both. */
static double viscosity_in(const hk_liquid_viscosity *v, size_t i) {
  return v->cell && v->cell[i] > 0 ? v->cell[i] : v->viscosity;
}

static double viscosity_about(const hk_liquid_grid *g, const hk_liquid_viscosity *v, size_t i, int a, int b) {
  if (!v->cell) return v->viscosity;
  size_t s = g->stride[a], t = g->stride[b];
  double mean = hk_viscosity_between(v->cell, (const size_t[]){i, i - s, i - t, i - s - t}, 4);
  return mean > 0 ? mean : v->viscosity;
}

/* All strains that the face of component a at i is part of: those of the cells on both of its sides, and of the edges
 * about it. */
static void visit_strains(const hk_liquid *l, const hk_liquid_viscosity *v, int a, size_t i, strain_visitor each,
                          void *to) {
  const hk_liquid_grid *g = &l->grid;
  hk_strain e;
  for (int k = 0; k < 2; k++) {
    size_t cell = k ? i - g->stride[a] : i;
    hk_strain_along(l, cell, a, v->slip, &e);
    e.weight *= viscosity_in(v, cell);
    each(to, &e);
  }
  for (int b = 0; b < 3; b++)
    for (int k = 0; k < 2 && b != a && !g->flat[b]; k++) {
      size_t corner = k ? i + g->stride[b] : i;
      hk_strain_between(l, corner, a < b ? a : b, a < b ? b : a, v->slip, &e);
      e.weight *= viscosity_about(g, v, corner, a, b);
      each(to, &e);
    }
}

static void add_weight(void *context, const hk_strain *e) { *(double *)context += e->weight; }

/* ---- which faces ---- */

static hk_status make_room(hk_liquid_viscosity *v, const hk_host *host, size_t rows, size_t numbers) {
  if (rows <= v->most && numbers <= v->room) return HK_OK;
  void *old[] = {v->face, v->axis, v->start, v->column, v->value, v->b, v->x};
  for (size_t k = 0; k < sizeof old / sizeof *old; k++) host->release(host, old[k]);
  v->most = v->room = 0;
  v->face = host->allocate(host, rows * sizeof *v->face);
  v->axis = host->allocate(host, rows);
  v->start = host->allocate(host, (rows + 1) * sizeof *v->start);
  v->column = host->allocate(host, numbers * sizeof *v->column);
  v->value = host->allocate(host, numbers * sizeof *v->value);
  v->b = host->allocate(host, rows * sizeof *v->b);
  v->x = host->allocate(host, rows * sizeof *v->x);
  if (!v->face || !v->axis || !v->start || !v->column || !v->value || !v->b || !v->x)
    return host->fail(host, HK_NO_MEMORY, "no memory for the viscosity of %zu faces: take larger cells", rows);
  v->most = rows;
  v->room = numbers;
  return HK_OK;
}

/* Of a row: its equation of 15 numbers, as it is, by its upper half for products, and of that the incomplete factors;
 * right-hand side, solution and vectors of the iteration; of pieces' motions, and a part of their matrix and its
 * factors. Three numbers of rows in a cell. */
static const double bytes_of_row = 15 * 12 + 8 * 16 + 8 * 32 + 8 * 16 + 9 * 8 + 8 * 7 + 8 * 8,
                    bytes_of_cell = 3 * 4 + 8, bytes_of_lists = 9 * 3 * 8 + 8; /* viscous_flow.h */

double hk_liquid_viscosity_bytes(const hk_liquid_grid *g, bool by_cell) {
  double cells = (double)g->cells[0] * (double)g->cells[1] * (double)g->cells[2];
  int axes = !g->flat[0] + !g->flat[1] + !g->flat[2];
  return axes * cells * bytes_of_row + (double)g->size * (bytes_of_cell + (by_cell ? bytes_of_lists : 0));
}

/* Faces that are open, and have mass or are strained; with `list` they are entered. Returns how many. The three of a
 * cell have numbers behind each other: strains join them, and domains of incomplete factors keep what joins them. */
static size_t number_faces(const hk_liquid *l, hk_liquid_viscosity *v, bool list) {
  const hk_liquid_grid *g = &l->grid;
  size_t rows = hk_liquid_rows(g, 0), length = g->cells[hk_liquid_inner(g)], count = 0;
  for (size_t k = 0; k < rows; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + length; i++)
      for (int a = 0; a < 3; a++) {
        if (g->flat[a]) continue;
        if (!list) {
          bool held = hk_viscous_face_held(l, i, a, v->slip);
          double weight = held ? 0 : hk_liquid_part_of_face(l, i, a);
          if (!held && !(weight > 0)) visit_strains(l, v, a, i, add_weight, &weight);
          v->row[a][i] = weight > 0 ? (uint32_t)count : HK_LIQUID_NONE;
        } else if (v->row[a][i] != HK_LIQUID_NONE) {
          v->face[count] = (uint32_t)i;
          v->axis[count] = (uint8_t)a;
        }
        count += v->row[a][i] != HK_LIQUID_NONE;
      }
  }
  return count;
}

/* ---- the equations ---- */

typedef struct equation {
  const hk_liquid *l;
  const hk_liquid_viscosity *v;
  size_t face;
  int axis, count;
  double factor; /* h/density, s m^3/kg: by the viscosity an area, m^2 */
  double b;
  uint32_t column[HK_VISCOUS_MOST];
  double value[HK_VISCOUS_MOST];
} equation;

static void add_to(equation *q, uint32_t column, double value) {
  int k = 0;
  while (k < q->count && q->column[k] < column) k++;
  if (k == q->count || q->column[k] != column) {
    for (int m = q->count++; m > k; m--) q->column[m] = q->column[m - 1], q->value[m] = q->value[m - 1];
    q->column[k] = column;
    q->value[k] = 0;
  }
  q->value[k] += value;
}

/* What the strain's energy says of the face: its derivative, by that of the face's mass. */
static void add_strain(void *context, const hk_strain *e) {
  equation *q = context;
  double own = 0;
  if (!(e->weight > 0)) return;
  for (int k = 0; k < e->count; k++)
    if (e->axis[k] == q->axis && e->at[k] == q->face) own = q->factor * e->weight * e->by[k];
  q->b -= own * hk_strain_now(&q->l->grid, e);
  for (int k = 0; k < e->count; k++) add_to(q, q->v->row[e->axis[k]][e->at[k]], own * e->by[k]);
  for (int k = 0; k < e->covered; k++) {
    double by[6];
    hk_strain_by_body(q->l, e, k, by);
    for (size_t c = 0; c < 6; c++) add_to(q, (uint32_t)(q->v->bodies.row[e->body[k]] + c), own * by[c]);
  }
}

typedef struct task {
  hk_liquid *l;
  hk_liquid_viscosity *v;
  double factor;
} task;

static void fill_rows(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  size_t width = width_of(t->v);
  (void)piece;
  for (size_t r = begin; r < end; r++) {
    equation q;
    q.l = t->l, q.v = t->v, q.face = t->v->face[r], q.axis = t->v->axis[r], q.factor = t->factor;
    q.count = 0, q.b = 0; /* its numbers are as many as are counted */
    add_to(&q, (uint32_t)r, hk_liquid_part_of_face(t->l, q.face, q.axis));
    visit_strains(t->l, t->v, q.axis, q.face, add_strain, &q);
    memcpy(t->v->column + width * r, q.column, (size_t)q.count * sizeof *q.column);
    memcpy(t->v->value + width * r, q.value, (size_t)q.count * sizeof *q.value);
    t->v->start[r + 1] = (size_t)q.count;
    t->v->b[r] = q.b;
  }
}

/* Rows one behind the other. */
static hk_matrix close_up(hk_liquid_viscosity *v) {
  size_t rows = v->faces + 6 * v->bodies.count;
  v->start[0] = 0;
  for (size_t r = 0; r < v->faces; r++) {
    size_t count = v->start[r + 1], to = v->start[r];
    memmove(v->column + to, v->column + width_of(v) * r, count * sizeof *v->column);
    memmove(v->value + to, v->value + width_of(v) * r, count * sizeof *v->value);
    v->start[r + 1] = to + count;
  }
  hk_viscous_bodies_close_up(&v->bodies, v->start, v->column, v->value, v->b);
  return (hk_matrix){
      .rows = rows, .block = 1, .row_start = v->start, .column = v->column, .value = v->value, .symmetric = true};
}

/* Those of the bodies: every strain that one of them is part of, once. */
static void add_to_bodies(const hk_liquid *l, hk_liquid_viscosity *v, double factor) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < hk_liquid_rows(g, 1) && v->bodies.count; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i <= row.first + g->cells[hk_liquid_inner(g)]; i++)
      for (int a = 0; a < 3; a++) {
        hk_strain e;
        if (g->flat[a] || !hk_viscous_bodies_near(l, i)) continue;
        hk_strain_along(l, i, a, v->slip, &e);
        e.weight *= viscosity_in(v, i);
        hk_viscous_bodies_add(l, &v->bodies, &e, factor);
        for (int b = a + 1; b < 3; b++) {
          if (g->flat[b]) continue;
          hk_strain_between(l, i, a, b, v->slip, &e);
          e.weight *= viscosity_about(g, v, i, a, b);
          hk_viscous_bodies_add(l, &v->bodies, &e, factor);
        }
      }
  }
}

/* ---- the solution ---- */

static double precondition(void *context, const double *r, double *z) {
  hk_liquid_viscosity *v = context;
  double fine = hk_incomplete_apply(&v->factors, v->gradients.host, r, z);
  return v->coarse.pieces ? fine + hk_viscous_coarse_add(&v->coarse, r, z) : fine;
}

/* Whether viscosity reaches across a piece within the step: h mu/rho above its side squared somewhere. Below that
 * incomplete factors need fewer iterations than a piece has cells. */
static bool wants_pieces(const hk_liquid_viscosity *v, const hk_liquid_grid *g, double factor) {
  double side = HK_VISCOUS_PIECE * fmin(g->spacing[0], fmin(g->spacing[1], g->spacing[2])), most = v->viscosity;
  for (size_t i = 0; v->cell && i < g->size; i++) most = fmax(most, v->cell[i]);
  return factor * most > side * side;
}

/* factor: h/density, s m^3/kg. */
static hk_status solve(hk_liquid_viscosity *v, const hk_host *host, const hk_liquid_grid *grid, double factor,
                       const hk_matrix *A) {
  hk_gradients_system system = {precondition, v, v->tolerance, 0};
  hk_incomplete_free(&v->factors, host);
  hk_gradients_free(&v->gradients, host);
  hk_status status = hk_gradients_analyze(&v->gradients, host, A);
  if (status == HK_OK && hk_incomplete_analyze(&v->factors, host, A) != HK_OK) status = hk_gradients_no_memory(host, A);
  if (status == HK_OK) status = hk_gradients_fill(&v->gradients, host, A);
  if (status != HK_OK) return status;
  v->gradients.host = host;
  if (!hk_incomplete_factorize(&v->factors, host, A))
    return host->fail(host, HK_NOT_CONVERGED,
                      "the viscosity's equations of %zu faces are not finite: take shorter steps", A->rows);
  v->gradients.ready = true;
  const hk_viscous_faces faces = {grid, v->face, v->axis, v->faces, v->cell};
  if (wants_pieces(v, grid, factor))
    status = hk_viscous_coarse_build(&v->coarse, host, &faces, A);
  else
    hk_viscous_coarse_close(&v->coarse);
  if (status != HK_OK) return status;
  return hk_gradients_solve(&v->gradients, host, &system, v->b, v->x, NULL);
}

/* Faces that are open in part and have their centre in a solid move as it does. */
static void hold_faces(hk_liquid *l, const hk_liquid_viscosity *v) {
  hk_liquid_grid *g = &l->grid;
  size_t rows = hk_liquid_rows(g, 0), length = g->cells[hk_liquid_inner(g)];
  for (size_t k = 0; k < rows && !v->slip; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + length; i++)
      for (int a = 0; a < 3; a++)
        if (g->open[a][i] > 0 && hk_viscous_face_held(l, i, a, false)) g->u[a][i] = g->wall[a][i];
  }
}

hk_status hk_liquid_shear(hk_liquid *l, hk_liquid_viscosity *v, double h) {
  const hk_host *host = l->host;
  hk_liquid_grid *g = &l->grid;
  for (int a = 0; a < 3; a++) {
    if (!v->row[a]) v->row[a] = host->allocate(host, g->size * sizeof *v->row[a]);
    if (!v->row[a]) return host->fail(host, HK_NO_MEMORY, "no memory for the viscosity of %zu cells", g->size);
    memset(v->row[a], 0xff, g->size * sizeof *v->row[a]);
  }
  hk_status status = hk_viscous_bodies_open(&v->bodies, l);
  v->faces = number_faces(l, v, false);
  if (status != HK_OK || v->faces == 0) return status;
  hk_viscous_bodies_begin(&v->bodies, l, v->faces);
  size_t own = 6 * v->bodies.count, rows = v->faces + own;
  status = make_room(v, host, rows, width_of(v) * v->faces + own * own);
  if (status != HK_OK) return status;
  number_faces(l, v, true);
  task t = {l, v, h / l->density};
  add_to_bodies(l, v, t.factor);
  host->parallel_for(host, v->faces, GRAIN, fill_rows, &t);
  hk_matrix A = close_up(v);
  memset(v->x, 0, rows * sizeof *v->x);
  status = solve(v, host, g, t.factor, &A);
  if (status != HK_OK) return status;
  for (size_t r = 0; r < v->faces; r++) g->u[v->axis[r]][v->face[r]] += v->x[r];
  hk_viscous_bodies_end(&v->bodies, l, v->x);
  hold_faces(l, v);
  return HK_OK;
}

/* ---- what it takes ---- */

/* Shares the power of a strain among those of the cells that have particles. Returns what none of them took, W. */
static double share(const hk_liquid *l, double power, const size_t *cell, int cells, double *to) {
  int count = 0;
  for (int k = 0; k < cells; k++) count += l->start[cell[k]] < l->start[cell[k] + 1];
  for (int k = 0; k < cells; k++)
    if (l->start[cell[k]] < l->start[cell[k] + 1]) to[cell[k]] += power / count;
  return count ? 0 : power;
}

static double power_of(const hk_liquid *l, const hk_strain *e, double viscosity) {
  double strain = hk_strain_now(&l->grid, e);
  return e->weight > 0 ? viscosity * e->weight * hk_liquid_cell_volume(&l->grid) * strain * strain : 0;
}

/* Of all strains whose lowest cell is i. */
static double add_power(const hk_liquid *l, const hk_liquid_viscosity *v, size_t i, bool within) {
  const hk_liquid_grid *g = &l->grid;
  double left = 0;
  hk_strain e;
  for (int a = 0; a < 3; a++) {
    if (g->flat[a]) continue;
    if (within) {
      hk_strain_along(l, i, a, v->slip, &e);
      left += share(l, power_of(l, &e, viscosity_in(v, i)), &i, 1, v->power);
    }
    for (int b = a + 1; b < 3; b++) {
      if (g->flat[b]) continue;
      size_t s = g->stride[a], t = g->stride[b];
      hk_strain_between(l, i, a, b, v->slip, &e);
      left += share(l, power_of(l, &e, viscosity_about(g, v, i, a, b)), (size_t[]){i, i - s, i - t, i - s - t}, 4,
                    v->power);
    }
  }
  return left;
}

static bool is_within(const hk_liquid_grid *g, size_t i) {
  for (int c = 0; c < 3; c++)
    if (i / g->stride[c] % (g->cells[c] + 2) > g->cells[c]) return false;
  return true;
}

hk_status hk_liquid_dissipation(const hk_liquid *l, hk_liquid_viscosity *v, const hk_liquid_particles *p,
                                double *specific) {
  const hk_liquid_grid *g = &l->grid;
  if (!v->power) v->power = l->host->allocate(l->host, g->size * sizeof *v->power);
  if (!v->power)
    return l->host->fail(l->host, HK_NO_MEMORY, "no memory for the heat of viscosity of %zu cells", g->size);
  memset(v->power, 0, g->size * sizeof *v->power);
  double left = 0, taken = 0;
  for (size_t k = 0; k < hk_liquid_rows(g, 1); k++) {
    size_t first = hk_liquid_row_at(g, k, 1).first;
    for (size_t i = first; i <= first + g->cells[hk_liquid_inner(g)]; i++) left += add_power(l, v, i, is_within(g, i));
  }
  for (size_t c = 0; c < g->size; c++) taken += v->power[c];
  double scale = taken > 0 ? 1 + left / taken : 0; /* cells of the liquid without particles are few */
  for (size_t c = 0; c < g->size; c++) {
    double mass = 0;
    for (size_t k = l->start[c]; k < l->start[c + 1]; k++) mass += p->mass[p->index[l->sorted[k]]];
    for (size_t k = l->start[c]; k < l->start[c + 1]; k++)
      specific[p->index[l->sorted[k]]] = scale * v->power[c] / mass;
  }
  return HK_OK;
}

void hk_liquid_viscosity_close(hk_liquid_viscosity *v, const hk_host *host) {
  void *all[] = {v->row[0], v->row[1], v->row[2], v->face, v->axis,  v->start, v->column,
                 v->value,  v->b,      v->x,      v->cell, v->power, v->lists, v->guess};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  hk_viscous_bodies_close(&v->bodies, host);
  hk_viscous_coarse_close(&v->coarse);
  hk_incomplete_free(&v->factors, host);
  hk_gradients_free(&v->gradients, host);
  memset(v, 0, sizeof *v);
}
