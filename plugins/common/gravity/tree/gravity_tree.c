/* The moments of all cells, from the last to the first: the parts of a cell come after it. */
#include "plugins/common/gravity/tree/gravity_tree.h"

#include <string.h>

hk_status hk_tree_reserve(hk_gravity_tree *t, const hk_host *host, size_t n) {
  if (t->room && n <= t->room) return HK_OK;
  hk_tree_release(t, host);
  size_t room = n + n / 2 + 1;
  t->walk = host->allocate(host, 2 * room * sizeof *t->walk);
  t->moment = host->allocate(host, 2 * room * sizeof *t->moment);
  t->size = host->allocate(host, 2 * room * sizeof *t->size);
  t->group = host->allocate(host, (room + 1) * sizeof *t->group);
  t->body = host->allocate(host, room * sizeof *t->body);
  t->cell = host->allocate(host, 2 * room * sizeof *t->cell);
  if (!t->walk || !t->moment || !t->size || !t->group || !t->body || !t->cell) {
    hk_tree_release(t, host);
    return HK_NO_MEMORY;
  }
  t->room = room;
  return HK_OK;
}

void hk_tree_release(hk_gravity_tree *t, const hk_host *host) {
  host->release(host, t->walk);
  host->release(host, t->moment);
  host->release(host, t->size);
  host->release(host, t->group);
  host->release(host, t->body);
  host->release(host, t->cell);
  *t = (hk_gravity_tree){0};
}

/* Mass and centre; of massless bodies the centre of the box. */
static void finish_centre(double *m, const double first[3], const double low[3], const double high[3]) {
  for (size_t c = 0; c < 3; c++) m[c] = m[HK_CELL_M] > 0 ? first[c] / m[HK_CELL_M] : (low[c] + high[c]) / 2;
}

/* Second moments of a mass at `r` from the centre. */
static void add_second(double *m, double mass, const double r[3]) {
  double *S = m + HK_CELL_S;
  for (size_t a = 0, at = 0; a < 3; a++)
    for (size_t b = a; b < 3; b++) S[at++] += 3 * mass * r[a] * r[b];
  m[HK_CELL_TRACE] += 1.5 * mass * (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
}

static double length2(const double r[3]) { return r[0] * r[0] + r[1] * r[1] + r[2] * r[2]; }

/* Returns R^2. */
static double of_bodies(const hk_gravity_bodies *g, const hk_octree_cell *cell, const double low[3],
                        const double high[3], double *m) {
  const hk_bodies *at = &g->at;
  double first[3] = {0}, most = 0;
  size_t end = (size_t)cell->begin + cell->count;
  for (size_t k = cell->begin; k < end; k++) {
    m[HK_CELL_M] += at->m[k];
    first[0] += at->m[k] * at->x[k], first[1] += at->m[k] * at->y[k], first[2] += at->m[k] * at->z[k];
  }
  finish_centre(m, first, low, high);
  for (size_t k = cell->begin; k < end; k++) {
    const double r[3] = {at->x[k] - m[0], at->y[k] - m[1], at->z[k] - m[2]};
    add_second(m, at->m[k], r);
    most = fmax(most, length2(r));
  }
  return most;
}

static double of_parts(const hk_gravity_tree *t, const hk_octree *tree, size_t index, const double low[3],
                       const double high[3], double *m) {
  double first[3] = {0}, most = 0, corner = 0;
  size_t end = tree->cell[index].next;
  for (size_t k = index + 1; k < end; k = tree->cell[k].next) {
    const double *part = t->moment[k];
    m[HK_CELL_M] += part[HK_CELL_M];
    for (size_t c = 0; c < 3; c++) first[c] += part[HK_CELL_M] * part[c];
  }
  finish_centre(m, first, low, high);
  for (size_t k = index + 1; k < end; k = tree->cell[k].next) {
    const double *part = t->moment[k], r[3] = {part[0] - m[0], part[1] - m[1], part[2] - m[2]};
    for (size_t q = HK_CELL_S; q < HK_CELL_NUMBERS; q++) m[q] += part[q];
    add_second(m, part[HK_CELL_M], r);
    most = fmax(most, sqrt(length2(r)) + sqrt(t->walk[k].radius2));
  }
  for (size_t c = 0; c < 3; c++) corner += pow(fmax(m[c] - low[c], high[c] - m[c]), 2);
  return fmin(most * most, corner);
}

/* The largest cells with few enough bodies; those that have more at one place are cut. */
static void find_groups(hk_gravity_tree *t, const hk_octree *tree) {
  t->groups = 0;
  for (size_t k = 0; k < tree->cells;) {
    const hk_octree_cell *cell = &tree->cell[k];
    bool leaf = cell->next == k + 1;
    for (uint32_t at = 0; at < cell->count && (leaf || cell->count <= HK_GROUP); at += HK_GROUP)
      t->group[t->groups++] = cell->begin + at;
    k = cell->count <= HK_GROUP ? cell->next : k + 1;
  }
  t->group[t->groups] = (uint32_t)tree->points;
}

/* ---- single precision ---- */

/* Errors that are far above what single precision leaves, some 1e-7: at these they are 1e-5 and more (RMS). */
static bool is_rough(const hk_tree_accuracy *a) { return isnan(a->angle) ? a->alpha >= 1e-4 : a->angle >= 0.2; }

static double mass_scale_of(const hk_gravity_bodies *g) {
  double sum = 0;
  int exponent;
  for (size_t k = 0; k < g->count; k++) sum += g->at.m[k];
  if (!(sum > 0) || !isfinite(sum)) return 1;
  frexp(sum, &exponent);
  return ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

static void fill_cell(const double *moment, double mass_scale, float *into) {
  hk_single_place(into, moment);
  into[HK_SINGLE_M] = (float)(moment[HK_CELL_M] * mass_scale);
  into[HK_SINGLE_TRACE] = (float)(moment[HK_CELL_TRACE] * mass_scale);
  for (int q = 0; q < 6; q++) into[HK_SINGLE_S + q] = (float)(moment[HK_CELL_S + q] * mass_scale);
}

static void fill_singles(hk_gravity_tree *t, const hk_gravity_bodies *g) {
  t->mass_scale = mass_scale_of(g);
  for (size_t k = 0; k < g->count; k++) {
    const double at[3] = {g->at.x[k], g->at.y[k], g->at.z[k]};
    hk_single_place(t->body[k], at);
    t->body[k][HK_SINGLE_M] = (float)(g->at.m[k] * t->mass_scale);
    t->body[k][HK_SINGLE_BODY - 1] = 0;
  }
  for (size_t k = 0; k < t->cells; k++) fill_cell(t->moment[k], t->mass_scale, t->cell[k]);
}

void hk_tree_moments(hk_gravity_tree *t, const hk_gravity_bodies *g, const hk_octree *tree,
                     const hk_tree_accuracy *accuracy) {
  t->cells = tree->cells;
  find_groups(t, tree);
  for (size_t k = tree->cells; k-- > 0;) {
    const hk_octree_cell *cell = &tree->cell[k];
    double *m = t->moment[k], low[3], high[3];
    memset(m, 0, sizeof t->moment[k]);
    for (size_t c = 0; c < 3; c++) low[c] = cell->low[c] * g->scale, high[c] = cell->high[c] * g->scale;
    double radius2 = cell->next == k + 1 ? of_bodies(g, cell, low, high, m) : of_parts(t, tree, k, low, high, m);
    double needs = isnan(accuracy->angle) ? pow(m[HK_CELL_M] * radius2 * sqrt(radius2), 0.4) : 4 * radius2;
    t->walk[k] = (hk_walk_cell){{m[0], m[1], m[2]}, radius2, needs, cell->next, cell->begin, cell->count};
  }
  t->single = is_rough(accuracy) ? hk_single_path_of(g->host->lanes) : NULL;
  if (t->single) fill_singles(t, g);
}
