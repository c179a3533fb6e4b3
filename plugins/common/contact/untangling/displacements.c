/* Closed curves: a vertex that a curve encloses on one surface is drawn to the nearest point of what it encloses on the
 * other, and beyond it by the radii of both, with the least change of the momenta's sum (each pair by inverse masses, a
 * vertex of several pairs by their mean). Curves that enclose nothing, or have ends, become shorter: contour
 * minimisation (Volino and Magnenat-Thalmann 2006, "Resolving surface collisions through intersection contour
 * minimization"), here along the exact gradient of the curve's length. */
#include "plugins/common/contact/untangling/displacements.h"
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/kit/vector3.h"
#include "plugins/common/space/reserve.h"
#include "plugins/common/contact/untangling/shortening.h"

static const uint32_t NONE = UINT32_MAX;

/* Pulls are met in sweeps that each take what is left. Smoothed so often, a bump of 20 edges comes back as it is, with
 * strains of 0.3 where there were 0.8 without; so many sweeps meet the pulls to a percent or so, and the next round
 * sees what is left. */
enum { SWEEPS = 40, SMOOTHINGS = 10 };

static const double stride = 1; /* edges: how far a point of a curve moves in a round while the curve becomes shorter */

static const double *place(const hk_tangle *t, uint32_t i) { return t->x + 3 * (size_t)i; }

/* ---- the triangles at each vertex, as long as the mesh stays ---- */

static hk_status list_around(hk_displacements *m, const hk_host *host, const hk_surface_mesh *mesh, size_t n) {
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

static void add_target(hk_displacements *m, uint32_t triangle) {
  if (triangle == NONE || m->stamp[triangle] == m->stamps) return;
  m->stamp[triangle] = m->stamps;
  m->target[m->targets++] = triangle;
}

static void list_targets(hk_displacements *m, const hk_tangle *t, size_t contour, uint32_t side) {
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

/* The middle of a curve, and how far what it encloses reaches from there. */
static double reach_of(const hk_tangle *t, const hk_contour *c, const hk_enclosed *inside, double middle[3]) {
  double reach = 0;
  memset(middle, 0, 3 * sizeof *middle);
  for (size_t k = c->first; k < c->first + c->count; k++)
    for (int j = 0; j < 2; j++)
      hk_add_scaled(middle, 0.5 / (double)c->count, place(t, t->mesh->edge[t->contours->point[k].edge][j]));
  for (size_t k = inside->first; k < inside->first + inside->count; k++) {
    double d[3];
    hk_subtract(d, place(t, t->regions->vertex[k]), middle);
    reach = fmax(reach, hk_length(d));
  }
  return reach;
}

/* What a curve cuts off one surface is drawn to the surroundings of the curve on the other, as far as it reaches; where
 * both are one surface, not to itself. `degree` marks what is enclosed. */
static void grow_targets(hk_displacements *m, const hk_tangle *t, size_t contour, uint32_t side) {
  const hk_contour *c = &t->contours->contour[contour];
  const hk_enclosed *inside = &t->regions->enclosed[contour][side];
  double middle[3], reach = reach_of(t, c, inside, middle);
  memset(m->degree, 0, t->model->n * sizeof *m->degree);
  for (size_t k = inside->first; k < inside->first + inside->count; k++) m->degree[t->regions->vertex[k]] = 1;
  for (size_t k = 0; k < m->targets; k++)
    for (int j = 0; j < 3; j++) {
      uint32_t i = t->mesh->triangle[m->target[k]][j];
      double d[3];
      hk_subtract(d, place(t, i), middle);
      for (uint32_t a = m->start[i]; a < m->start[i + 1] && hk_length(d) <= reach; a++) {
        const uint32_t *v = t->mesh->triangle[m->around[a]];
        if (!m->degree[v[0]] && !m->degree[v[1]] && !m->degree[v[2]]) add_target(m, m->around[a]);
      }
    }
}

static hk_status build_tree(hk_displacements *m, const hk_host *host, const hk_tangle *t) {
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
  const hk_displacements *moves;
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
static bool make_pull(const hk_displacements *m, const hk_tangle *t, uint32_t vertex, hk_untangling_pull *pull) {
  search s = {.moves = m, .tangle = t, .vertex = vertex, .triangle = NONE};
  hk_bvh_nearest(&m->tree, place(t, vertex), INFINITY, distance2, &s);
  double distance = sqrt(s.nearest.squared);
  if (s.triangle == NONE || !(distance > 0)) return false;
  const uint32_t *v = t->mesh->triangle[s.triangle];
  *pull = (hk_untangling_pull){.vertex = {vertex, vertex, v[0], v[1], v[2]}, .w = {1}, .part = 1};
  for (int k = 1; k < 4; k++) pull->w[1 + k] = s.nearest.w[k];
  double radius = t->mesh->radius[v[0]];
  for (int k = 1; k < 3; k++) radius = fmax(radius, t->mesh->radius[v[k]]);
  double apart = t->mesh->radius[vertex] + radius + t->beyond;
  for (int c = 0; c < 3; c++) pull->way[c] = -s.nearest.d[c] * (1 + apart / distance);
  return true;
}

static hk_status pull_side(hk_displacements *m, const hk_host *host, const hk_tangle *t, size_t contour,
                           uint32_t side) {
  const hk_enclosed *inside = &t->regions->enclosed[contour][side];
  if (inside->count == 0) return HK_OK;
  list_targets(m, t, contour, 1 - side);
  if (t->contours->contour[contour].cuts[side]) grow_targets(m, t, contour, side);
  hk_status status = build_tree(m, host, t);
  for (size_t k = inside->first; k < inside->first + inside->count && status == HK_OK; k++)
    m->pulls += make_pull(m, t, t->regions->vertex[k], &m->pull[m->pulls]);
  return status;
}

/* ---- moves ---- */

static double share_of(const hk_displacements *m, const hk_tangle *t, const hk_untangling_pull *p) {
  uint32_t uses = 1;
  double weight = 0;
  for (int k = 0; k < HK_UNTANGLING_PULL; k++) {
    uint32_t i = p->vertex[k];
    weight += t->model->inverse_mass[i] * p->w[k] * p->w[k];
    if (t->model->inverse_mass[i] > 0 && p->w[k] != 0 && m->uses[i] > uses) uses = m->uses[i];
  }
  return weight > 0 ? p->part / (weight * uses) : 0;
}

static void count_uses(hk_displacements *m, const hk_tangle *t) {
  const hk_surface_mesh *mesh = t->mesh;
  memset(m->uses, 0, t->model->n * sizeof *m->uses);
  memset(m->degree, 0, t->model->n * sizeof *m->degree);
  for (size_t k = 0; k < m->pulls; k++)
    for (int j = 0; j < HK_UNTANGLING_PULL; j++) m->uses[m->pull[k].vertex[j]] += m->pull[k].w[j] != 0;
  for (size_t k = 0; k < 2 * mesh->edges; k++) m->degree[mesh->edge[k / 2][k % 2]]++;
}

/* Adds to `part` what of the pull is still to be moved. */
static void pull_on(hk_displacements *m, const hk_tangle *t, const hk_untangling_pull *p) {
  double left[3], share = share_of(m, t, p);
  hk_copy(left, p->way);
  for (int k = 0; k < HK_UNTANGLING_PULL; k++) hk_add_scaled(left, -p->w[k], m->move + 3 * (size_t)p->vertex[k]);
  if (p->along) {
    double size = hk_dot(left, p->way) / hk_dot(p->way, p->way);
    for (int c = 0; c < 3; c++) left[c] = size * p->way[c];
  }
  for (int k = 0; k < HK_UNTANGLING_PULL; k++) {
    uint32_t i = p->vertex[k];
    hk_add_scaled(m->part + 3 * (size_t)i, share * t->model->inverse_mass[i] * p->w[k], left);
  }
}

/* Moves flow between neighbours, and with them what is pulled takes its surroundings along. No momentum is lost: what
 * one vertex gives the other takes. With a half of the least degree, sweeps are stable whatever the masses. */
static void smooth(hk_displacements *m, const hk_tangle *t) {
  const double *inverse_mass = t->model->inverse_mass;
  memset(m->flow, 0, 3 * t->model->n * sizeof *m->flow);
  for (size_t e = 0; e < t->mesh->edges; e++) {
    size_t a = t->mesh->edge[e][0], b = t->mesh->edge[e][1];
    if (!(inverse_mass[a] > 0 && inverse_mass[b] > 0)) continue;
    double flow = 0.5 / fmax(inverse_mass[a] * m->degree[a], inverse_mass[b] * m->degree[b]), difference[3];
    hk_subtract(difference, m->part + 3 * b, m->part + 3 * a);
    hk_add_scaled(m->flow + 3 * a, flow * inverse_mass[a], difference);
    hk_add_scaled(m->flow + 3 * b, -flow * inverse_mass[b], difference);
  }
  for (size_t k = 0; k < 3 * t->model->n; k++) m->part[k] += m->flow[k];
}

static void move_pulled(hk_displacements *m, const hk_tangle *t) {
  for (int sweep = 0; sweep < SWEEPS && m->pulls > 0; sweep++) {
    memset(m->part, 0, 3 * t->model->n * sizeof *m->part);
    for (size_t k = 0; k < m->pulls; k++) pull_on(m, t, &m->pull[k]);
    for (int again = 0; again < SMOOTHINGS; again++) smooth(m, t);
    for (size_t k = 0; k < 3 * t->model->n; k++) m->move[k] += m->part[k];
  }
}

/* Takes the part of relative velocities that goes against the pulls. */
static void kick_pulled(hk_displacements *m, const hk_tangle *t) {
  for (size_t k = 0; k < m->pulls && t->v; k++) {
    const hk_untangling_pull *p = &m->pull[k];
    double speed = 0, length2 = hk_dot(p->way, p->way), share = share_of(m, t, p);
    for (int j = 0; j < HK_UNTANGLING_PULL; j++) speed += p->w[j] * hk_dot(t->v + 3 * (size_t)p->vertex[j], p->way);
    for (int j = 0; j < HK_UNTANGLING_PULL && speed < 0; j++) {
      uint32_t i = p->vertex[j];
      hk_add_scaled(m->kick + 3 * (size_t)i, -share * t->model->inverse_mass[i] * p->w[j] * speed / length2, p->way);
    }
  }
}

/* ---- shorter curves ---- */

/* The point is to move by a part of the edge, the less, the less shorter the curve becomes by it. What goes across the
 * gradient leaves the length as it is, and is free. Where the curve is straight the gradient is 0 but at its ends: the
 * points between are held the less, the smaller it is (its square: 1 at an end), and follow these. Held as they are,
 * they made a straight path of 51 crossings to the tip of a fold take 1.6 to 2 times the rounds. */
static void add_shortening(hk_displacements *m, const hk_tangle *t, const hk_contour_point *p) {
  const uint32_t *e = t->mesh->edge[p->edge], *f = t->mesh->triangle[p->triangle];
  hk_untangling_pull *pull = &m->pull[m->pulls];
  double edge[3];
  *pull = (hk_untangling_pull){.vertex = {e[0], e[1], f[0], f[1], f[2]}};
  if (!hk_shortening(t->mesh, t->x, p, pull->w, pull->way)) return;
  hk_subtract(edge, place(t, e[1]), place(t, e[0]));
  double length = hk_length(pull->way), size = stride * hk_length(edge) / fmax(1, length);
  pull->along = true;
  pull->part = fmin(1, length * length);
  for (int c = 0; c < 3; c++) pull->way[c] *= size;
  m->pulls += hk_length(pull->way) > 0;
}

/* ---- */

/* Whether what the curve encloses is known and no mere point. */
static bool encloses(const hk_tangle *t, size_t contour) {
  const hk_contour *c = &t->contours->contour[contour];
  const hk_enclosed *side = t->regions->enclosed[contour];
  for (int k = 0; k < 2; k++)
    if (c->cuts[k] && side[k].known && side[k].count > 0) return true;
  return c->kind == HK_CONTOUR_CLOSED && !c->twisted && side[0].known && side[1].known &&
         side[0].count + side[1].count > 0;
}

static hk_status list_pulls(hk_displacements *m, const hk_host *host, const hk_tangle *t) {
  hk_status status = HK_OK;
  m->pulls = 0;
  for (size_t k = 0; k < t->contours->count && status == HK_OK; k++) {
    const hk_contour *c = &t->contours->contour[k];
    bool fill = encloses(t, k);
    for (uint32_t side = 0; side < 2 && fill && status == HK_OK; side++) status = pull_side(m, host, t, k, side);
    for (size_t j = c->first; j < c->first + c->count && !fill; j++) add_shortening(m, t, &t->contours->point[j]);
  }
  return status;
}

static hk_status reserve(hk_displacements *m, const hk_host *host, const hk_tangle *t) {
  size_t n = t->model->n;
  hk_status status = hk_reserve(host, &m->move, &m->n_room[1], 3 * n, sizeof *m->move);
  if (status == HK_OK) status = hk_reserve(host, &m->kick, &m->n_room[2], 3 * n, sizeof *m->kick);
  if (status == HK_OK) status = hk_reserve(host, &m->uses, &m->n_room[3], n, sizeof *m->uses);
  if (status == HK_OK) status = hk_reserve(host, &m->degree, &m->n_room[4], n, sizeof *m->degree);
  if (status == HK_OK) status = hk_reserve(host, &m->flow, &m->n_room[5], 3 * n, sizeof *m->flow);
  if (status == HK_OK) status = hk_reserve(host, &m->part, &m->n_room[6], 3 * n, sizeof *m->part);
  if (status == HK_OK)
    status = hk_reserve(host, &m->pull, &m->pull_room, t->regions->vertices + t->contours->points, sizeof *m->pull);
  return status == HK_OK ? list_around(m, host, t->mesh, n) : status;
}

hk_status hk_displacements_find(hk_displacements *m, const hk_host *host, const hk_tangle *t) {
  hk_status status = reserve(m, host, t);
  if (status != HK_OK) return status;
  memset(m->move, 0, 3 * t->model->n * sizeof *m->move);
  memset(m->kick, 0, 3 * t->model->n * sizeof *m->kick);
  status = list_pulls(m, host, t);
  if (status != HK_OK) return status;
  count_uses(m, t);
  kick_pulled(m, t);
  move_pulled(m, t);
  return HK_OK;
}

void hk_displacements_free(hk_displacements *m, const hk_host *host) {
  void *all[] = {m->start, m->around, m->stamp, m->target, m->box,    m->move,
                 m->kick,  m->part,   m->flow,  m->uses,   m->degree, m->pull};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  hk_bvh_free(&m->tree, host);
  *m = (hk_displacements){.pulls = 0};
}
