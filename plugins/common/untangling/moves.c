/* Closed curves: a vertex that a curve encloses on one surface is drawn to the nearest point of what it encloses on the
 * other, and beyond it by the radii of both, with the least change of the momenta's sum (each pair by inverse masses, a
 * vertex of several pairs by their mean). Curves that enclose nothing, or have ends, become shorter: contour
 * minimisation (Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
 * minimization"), here along the exact gradient of the curve's length. */
#include "plugins/common/untangling/moves.h"
#include "plugins/common/collision/distance.h"
#include "plugins/common/space/vector3.h"
#include "plugins/common/untangling/reserve.h"

enum { NONE = UINT32_MAX };

static const double stride = 0.2; /* of an edge: how far a curve's point moves at once while it becomes shorter */

static const double *place(const hk_tangle *t, uint32_t i) { return t->x + 3 * (size_t)i; }

/* ---- the triangles at each vertex, as long as the mesh stays ---- */

static hk_status list_around(hk_moves *m, const hk_host *host, const hk_surface_mesh *mesh, size_t n) {
  if (m->number == mesh->number && m->start) return HK_OK;
  hk_status status = hk_reserve(host, &m->start, &m->n_room[0], n + 2, sizeof *m->start);
  if (status == HK_OK) status = hk_reserve(host, &m->around, &m->mesh_room[0], 3 * mesh->triangles, sizeof *m->around);
  if (status == HK_OK) status = hk_reserve(host, &m->stamp, &m->mesh_room[1], mesh->triangles, sizeof *m->stamp);
  if (status == HK_OK) status = hk_reserve(host, &m->target, &m->mesh_room[2], mesh->triangles, sizeof *m->target);
  if (status == HK_OK) status = hk_reserve(host, &m->box, &m->box_room, mesh->triangles, sizeof *m->box);
  if (status != HK_OK) return status;
  m->number = mesh->number;
  m->stamps = 0;
  memset(m->stamp, 0, mesh->triangles * sizeof *m->stamp);
  memset(m->start, 0, (n + 2) * sizeof *m->start);
  for (size_t k = 0; k < 3 * mesh->triangles; k++) m->start[mesh->triangle[k / 3][k % 3] + 2]++;
  for (size_t i = 0; i < n; i++) m->start[i + 2] += m->start[i + 1];
  for (size_t k = 0; k < 3 * mesh->triangles; k++)
    m->around[m->start[mesh->triangle[k / 3][k % 3] + 1]++] = (uint32_t)(k / 3);
  return HK_OK;
}

/* ---- the part of a surface to which the other one is drawn ---- */

static void add_target(hk_moves *m, uint32_t triangle) {
  if (triangle == NONE || m->stamp[triangle] == m->stamps) return;
  m->stamp[triangle] = m->stamps;
  m->target[m->targets++] = triangle;
}

static void list_targets(hk_moves *m, const hk_tangle *t, size_t contour, uint32_t side) {
  const hk_contour *c = &t->contours->contour[contour];
  const hk_enclosed *inside = &t->regions->enclosed[contour][side];
  m->targets = 0;
  m->stamps++;
  for (size_t k = c->first; k < c->first + c->count; k++) {
    const hk_contour_point *p = &t->contours->point[k];
    if (p->side != side) add_target(m, p->triangle);
    for (int slot = 0; slot < 2 && p->side == side; slot++) add_target(m, t->mesh->edge_faces[p->edge][slot]);
  }
  for (size_t k = inside->first; k < inside->first + inside->count; k++) {
    uint32_t i = t->regions->vertex[k];
    for (uint32_t j = m->start[i]; j < m->start[i + 1]; j++) add_target(m, m->around[j]);
  }
}

static hk_status build_tree(hk_moves *m, const hk_host *host, const hk_tangle *t) {
  for (size_t k = 0; k < m->targets; k++) {
    const uint32_t *v = t->mesh->triangle[m->target[k]];
    for (int c = 0; c < 3; c++) {
      double a = place(t, v[0])[c], b = place(t, v[1])[c], d = place(t, v[2])[c];
      m->box[k].low[c] = fmin(a, fmin(b, d));
      m->box[k].high[c] = fmax(a, fmax(b, d));
    }
  }
  hk_status status = hk_bvh_build(&m->tree, host, m->box, m->targets);
  return status == HK_OK ? HK_OK : host->fail(host, status, "no memory for a tree of %zu triangles", m->targets);
}

/* ---- pulls ---- */

typedef struct search {
  const hk_moves *moves;
  const hk_tangle *tangle;
  uint32_t vertex, triangle;
  hk_nearest nearest;
} search;

static double distance2(void *context, uint32_t item, double best2) {
  search *s = context;
  uint32_t triangle = s->moves->target[item];
  const uint32_t *v = s->tangle->mesh->triangle[triangle];
  double x[12];
  if (v[0] == s->vertex || v[1] == s->vertex || v[2] == s->vertex) return INFINITY;
  hk_copy(x, place(s->tangle, s->vertex));
  for (int k = 0; k < 3; k++) hk_copy(x + 3 * (k + 1), place(s->tangle, v[k]));
  hk_nearest found = hk_nearest_of_pair(HK_POINT_TRIANGLE, x);
  if (found.squared < best2) s->nearest = found, s->triangle = triangle;
  return found.squared;
}

/* The vertex and the point nearest to it; false: there is none, or it is in the same place, so that no way is known. */
static bool make_pull(const hk_moves *m, const hk_tangle *t, uint32_t vertex, hk_pull *pull) {
  search s = {.moves = m, .tangle = t, .vertex = vertex, .triangle = NONE};
  hk_bvh_nearest(&m->tree, place(t, vertex), INFINITY, distance2, &s);
  double distance = sqrt(s.nearest.squared);
  if (s.triangle == NONE || !(distance > 0)) return false;
  const uint32_t *v = t->mesh->triangle[s.triangle];
  *pull = (hk_pull){.vertex = {vertex, v[0], v[1], v[2]}};
  memcpy(pull->w, s.nearest.w, sizeof pull->w);
  double radius = t->mesh->radius[v[0]];
  for (int k = 1; k < 3; k++) radius = fmax(radius, t->mesh->radius[v[k]]);
  double apart = t->mesh->radius[vertex] + radius + t->beyond;
  for (int c = 0; c < 3; c++) pull->way[c] = -s.nearest.d[c] * (1 + apart / distance);
  return true;
}

static hk_status pull_side(hk_moves *m, const hk_host *host, const hk_tangle *t, size_t contour, uint32_t side) {
  const hk_enclosed *inside = &t->regions->enclosed[contour][side];
  if (inside->count == 0) return HK_OK;
  list_targets(m, t, contour, 1 - side);
  hk_status status = build_tree(m, host, t);
  for (size_t k = inside->first; k < inside->first + inside->count && status == HK_OK; k++)
    m->pulls += make_pull(m, t, t->regions->vertex[k], &m->pull[m->pulls]);
  return status;
}

/* ---- moves ---- */

static double share_of(const hk_moves *m, const hk_tangle *t, const hk_pull *p) {
  uint32_t uses = 1;
  double weight = 0;
  for (int k = 0; k < 4; k++) {
    uint32_t i = p->vertex[k];
    weight += t->model->inverse_mass[i] * p->w[k] * p->w[k];
    if (t->model->inverse_mass[i] > 0 && p->w[k] != 0 && m->uses[i] > uses) uses = m->uses[i];
  }
  return weight > 0 ? 1 / (weight * uses) : 0;
}

static void apply(hk_moves *m, const hk_tangle *t, const hk_pull *p) {
  double share = share_of(m, t, p), speed = 0, length = hk_length(p->way);
  for (int k = 0; k < 4 && t->v; k++) speed += p->w[k] * hk_dot(t->v + 3 * (size_t)p->vertex[k], p->way) / length;
  for (int k = 0; k < 4; k++) {
    double part = share * t->model->inverse_mass[p->vertex[k]] * p->w[k];
    hk_add_scaled(m->move + 3 * (size_t)p->vertex[k], part, p->way);
    if (speed < 0) hk_add_scaled(m->kick + 3 * (size_t)p->vertex[k], -part * speed / length, p->way);
  }
}

static void apply_all(hk_moves *m, const hk_tangle *t) {
  memset(m->uses, 0, t->model->n * sizeof *m->uses);
  for (size_t k = 0; k < m->pulls; k++)
    for (int j = 0; j < 4; j++) m->uses[m->pull[k].vertex[j]] += m->pull[k].w[j] != 0;
  for (size_t k = 0; k < m->pulls; k++) apply(m, t, &m->pull[k]);
}

/* ---- shorter curves ---- */

/* The direction in the planes of two triangles, of length 1, from their common point on the edge into the triangle that
 * has the edge. False: they are parallel. */
static bool into_triangle(const double *x, const uint32_t g[3], const uint32_t e[2], const double normal[3],
                          double out[3]) {
  double p[3], q[3], own[3], along[3], inward[3];
  const double *a = x + 3 * (size_t)e[0];
  uint32_t third = g[0] != e[0] && g[0] != e[1] ? g[0] : g[1] != e[0] && g[1] != e[1] ? g[1] : g[2];
  hk_subtract(p, x + 3 * (size_t)e[1], a);
  hk_subtract(q, x + 3 * (size_t)third, a);
  hk_cross(own, p, q);
  hk_cross(out, own, normal);
  double length = hk_length(out), edge2 = hk_dot(p, p);
  if (!(length > 1e-12 * hk_length(own))) return false; /* the normal has length 1: roundings of a direction */
  hk_copy(along, p);
  for (int c = 0; c < 3; c++) inward[c] = q[c] - hk_dot(q, p) / edge2 * along[c];
  double sign = hk_dot(out, inward) < 0 ? -1 : 1;
  for (int c = 0; c < 3; c++) out[c] *= sign / length;
  return true;
}

/* Where the edge pierces the triangle: at a + s (b - a), with the triangle's weights u. */
static bool pierce(const double *x, const uint32_t e[2], const uint32_t f[3], double normal[3], double *s,
                   double u[3]) {
  const double *a = x + 3 * (size_t)e[0], *p = x + 3 * (size_t)f[0];
  double edge[3], first[3], second[3], from[3], at[3], part[3];
  hk_subtract(edge, x + 3 * (size_t)e[1], a);
  hk_subtract(first, x + 3 * (size_t)f[1], p);
  hk_subtract(second, x + 3 * (size_t)f[2], p);
  hk_cross(normal, first, second);
  double area = hk_length(normal), across = hk_dot(normal, edge);
  if (!(area > 0) || !(fabs(across) > 1e-12 * area * hk_length(edge))) return false;
  hk_subtract(from, p, a);
  *s = fmin(1, fmax(0, hk_dot(normal, from) / across));
  for (int c = 0; c < 3; c++) at[c] = a[c] + *s * edge[c] - p[c];
  hk_cross(part, at, second);
  u[1] = hk_dot(part, normal) / (area * area);
  hk_cross(part, first, at);
  u[2] = hk_dot(part, normal) / (area * area);
  u[0] = 1 - u[1] - u[2];
  for (int c = 0; c < 3; c++) normal[c] /= area;
  return true;
}

/* The point P of edge and plane moves by D_e - E ((D_e - D_f).N)/(E.N) where the edge there moves by D_e and the
 * triangle by D_f; the curve becomes shorter by S.dP, S the sum of the directions of its pieces at P. */
void hk_shortening(const hk_surface_mesh *m, const double *x, const hk_contour_point *p, uint32_t vertex[5],
                   double direction[5][3]) {
  const uint32_t *e = m->edge[p->edge], *f = m->triangle[p->triangle];
  double normal[3], s, u[3], sum[3] = {0}, edge[3];
  for (int k = 0; k < 5; k++) vertex[k] = k < 2 ? e[k] : f[k - 2];
  memset(direction, 0, 15 * sizeof(double));
  if (!pierce(x, e, f, normal, &s, u)) return;
  for (int slot = 0; slot < 2; slot++) {
    double piece[3];
    uint32_t g = m->edge_faces[p->edge][slot];
    if (g != NONE && into_triangle(x, m->triangle[g], e, normal, piece)) hk_add_scaled(sum, 1, piece);
  }
  hk_subtract(edge, x + 3 * (size_t)e[1], x + 3 * (size_t)e[0]);
  double lift = hk_dot(sum, edge) / hk_dot(edge, normal);
  for (int k = 0; k < 2; k++) {
    double share = k ? s : 1 - s;
    hk_add_scaled(direction[k], share, sum);
    hk_add_scaled(direction[k], -share * lift, normal);
  }
  for (int k = 0; k < 3; k++) hk_add_scaled(direction[2 + k], u[k] * lift, normal);
}

/* Moves of the point by a part of the edge. */
static void shorten_at(hk_moves *m, const hk_tangle *t, const hk_contour_point *p) {
  uint32_t vertex[5];
  double direction[5][3], edge[3], largest = 0;
  hk_shortening(t->mesh, t->x, p, vertex, direction);
  hk_subtract(edge, place(t, vertex[1]), place(t, vertex[0]));
  double heaviest = 0;
  for (int k = 0; k < 5; k++) heaviest = fmax(heaviest, t->model->inverse_mass[vertex[k]]);
  if (!(heaviest > 0)) return;
  for (int k = 0; k < 5; k++)
    largest = fmax(largest, t->model->inverse_mass[vertex[k]] / heaviest * hk_length(direction[k]));
  if (!(largest > 0)) return;
  for (int k = 0; k < 5; k++) {
    double part = t->model->inverse_mass[vertex[k]] / heaviest * stride * hk_length(edge) / fmax(1, largest);
    hk_add_scaled(m->move + 3 * (size_t)vertex[k], part, direction[k]);
  }
}

/* ---- */

static bool encloses(const hk_tangle *t, size_t contour) {
  const hk_contour *c = &t->contours->contour[contour];
  const hk_enclosed *side = t->regions->enclosed[contour];
  return c->kind == HK_CONTOUR_CLOSED && !c->twisted && side[0].known && side[1].known &&
         side[0].count + side[1].count > 0;
}

static hk_status reserve(hk_moves *m, const hk_host *host, const hk_tangle *t) {
  size_t n = t->model->n;
  hk_status status = hk_reserve(host, &m->move, &m->n_room[1], 3 * n, sizeof *m->move);
  if (status == HK_OK) status = hk_reserve(host, &m->kick, &m->n_room[2], 3 * n, sizeof *m->kick);
  if (status == HK_OK) status = hk_reserve(host, &m->uses, &m->n_room[3], n, sizeof *m->uses);
  if (status == HK_OK) status = hk_reserve(host, &m->pull, &m->pull_room, t->regions->vertices, sizeof *m->pull);
  return status == HK_OK ? list_around(m, host, t->mesh, n) : status;
}

hk_status hk_moves_find(hk_moves *m, const hk_host *host, const hk_tangle *t) {
  hk_status status = reserve(m, host, t);
  if (status != HK_OK) return status;
  memset(m->move, 0, 3 * t->model->n * sizeof *m->move);
  memset(m->kick, 0, 3 * t->model->n * sizeof *m->kick);
  m->pulls = 0;
  for (size_t k = 0; k < t->contours->count && status == HK_OK; k++) {
    const hk_contour *c = &t->contours->contour[k];
    if (encloses(t, k))
      for (uint32_t side = 0; side < 2 && status == HK_OK; side++) status = pull_side(m, host, t, k, side);
    else
      for (size_t j = c->first; j < c->first + c->count; j++) shorten_at(m, t, &t->contours->point[j]);
  }
  apply_all(m, t);
  return status;
}

void hk_moves_free(hk_moves *m, const hk_host *host) {
  void *all[] = {m->start, m->around, m->stamp, m->target, m->box, m->move, m->kick, m->uses, m->pull};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  hk_bvh_free(&m->tree, host);
  *m = (hk_moves){.pulls = 0};
}
