/* A surface i whose nearest point is p_i, with the direction n_i from there to the vertex x, asks for n_i.(x - p_i) >=
 * o_i. Two of them that look at each other, n_i.n_j < 0, can both be obeyed only where, with n along n_i - n_j,
 * (p_j - p_i).n is at least o_i n_i.n - o_j n_j.n after the step. Where it is not, the vertex keeps the part f of the
 * way from p_i to p_j that it had before the step: it moves by (1 - f) dp_i + f dp_j, and has their mean velocity with
 * the same weights. With f = 1/2 that is the plain average; with any f it never passes either surface. */
#include "plugins/common/contact/untangling/flypaper.h"
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/kit/vector3.h"
#include "plugins/common/space/reserve.h"

#include <stdlib.h>

bool hk_flypaper_needed(const hk_surface_mesh *m, const hk_model *model) {
  uint32_t first = UINT32_MAX;
  for (size_t t = 0; t < m->triangles; t++) {
    const uint32_t *v = m->triangle[t];
    if (model->inverse_mass[v[0]] > 0 || model->inverse_mass[v[1]] > 0 || model->inverse_mass[v[2]] > 0) continue;
    if (first != UINT32_MAX && m->part[v[0]] != first) return true;
    first = m->part[v[0]];
  }
  return false;
}

/* ---- vertices near pinned triangles ---- */

static bool is_hold(const hk_feature_pair *p, const hk_model *model) {
  const double *w = model->inverse_mass;
  return p->kind == HK_POINT_TRIANGLE && w[p->vertex[0]] > 0 && w[p->vertex[1]] == 0 && w[p->vertex[2]] == 0 &&
         w[p->vertex[3]] == 0;
}

/* False: the vertex is in the triangle, and on no side of it. */
static bool make_hold(hk_hold *h, const hk_feature_pair *p, const hk_surface_mesh *m, const hk_correction *c) {
  double x[12];
  hk_pair_gather(p, c->x_before, x);
  hk_nearest found = hk_nearest_of_pair(HK_POINT_TRIANGLE, x);
  double distance = sqrt(found.squared);
  if (!(distance > 0)) return false;
  *h = (hk_hold){.vertex = p->vertex[0], .part = m->part[p->vertex[1]], .offset = p->offset};
  for (int k = 0; k < 3; k++) h->normal[k] = found.d[k] / distance;
  for (int k = 1; k < 4; k++) {
    hk_add_scaled(h->from, -found.w[k], x + 3 * k);
    hk_add_scaled(h->to, -found.w[k], c->x + 3 * (size_t)p->vertex[k]);
    hk_add_scaled(h->v, -found.w[k], c->v + 3 * (size_t)p->vertex[k]);
  }
  return true;
}

static int by_vertex(const void *a, const void *b) {
  const hk_hold *p = a, *q = b;
  if (p->vertex != q->vertex) return p->vertex < q->vertex ? -1 : 1;
  for (int c = 0; c < 3; c++)
    if (p->from[c] != q->from[c]) return p->from[c] < q->from[c] ? -1 : 1;
  return 0;
}

static hk_status list_holds(hk_flypaper *f, const hk_host *host, const hk_surfaces *surfaces, const hk_model *model,
                            const hk_correction *c) {
  hk_feature_pairs near;
  const hk_surface_mesh *mesh = surfaces->mesh(surfaces->self);
  hk_status status = surfaces->pairs(surfaces->self, c->x_before, c->x, 0, &near);
  if (status == HK_OK) status = hk_reserve(host, &f->hold, &f->room, near.count, sizeof *f->hold);
  f->holds = 0;
  for (size_t k = 0; k < near.count && status == HK_OK; k++)
    if (is_hold(&near.pair[k], model)) f->holds += make_hold(&f->hold[f->holds], &near.pair[k], mesh, c);
  if (f->holds) qsort(f->hold, f->holds, sizeof *f->hold, by_vertex);
  return status;
}

/* ---- what is pinched ---- */

/* m: the room between two surfaces less what they ask for; below 0, the vertex is pinched. *part is that of the way
 * from the first to the second at which it is. */
static double room_between(const hk_hold *a, const hk_hold *b, const double *x_before, double *part) {
  double n[3], apart[3], before[3], from[3];
  if (a->part == b->part || !(hk_dot(a->normal, b->normal) < 0)) return INFINITY;
  hk_subtract(n, a->normal, b->normal);
  double length = hk_length(n);
  for (int c = 0; c < 3; c++) n[c] /= length;
  hk_subtract(apart, b->to, a->to);
  hk_subtract(before, b->from, a->from);
  hk_subtract(from, x_before + 3 * (size_t)a->vertex, a->from);
  double gap = hk_dot(before, n);
  *part = gap > 0 ? fmin(1, fmax(0, hk_dot(from, n) / gap)) : 0.5;
  return hk_dot(apart, n) - a->offset * hk_dot(a->normal, n) + b->offset * hk_dot(b->normal, n);
}

static void stick(const hk_hold *a, const hk_hold *b, double part, hk_correction *c) {
  double *x = c->x + 3 * (size_t)a->vertex, *v = c->v + 3 * (size_t)a->vertex;
  for (int k = 0; k < 3; k++) {
    x[k] = c->x_before[3 * (size_t)a->vertex + (size_t)k] + (1 - part) * (a->to[k] - a->from[k]) +
           part * (b->to[k] - b->from[k]);
    v[k] = (1 - part) * a->v[k] + part * b->v[k];
  }
  c->changed = true;
}

/* The two of the holds from `begin` to `end`, of one vertex, with the least room. */
static bool hold_vertex(const hk_flypaper *f, size_t begin, size_t end, hk_correction *c) {
  double least = 0, at = 0;
  size_t first = 0, second = 0;
  for (size_t i = begin; i < end; i++)
    for (size_t j = i + 1; j < end; j++) {
      double part, room = room_between(&f->hold[i], &f->hold[j], c->x_before, &part);
      if (room < least) least = room, at = part, first = i, second = j;
    }
  if (least < 0) stick(&f->hold[first], &f->hold[second], at, c);
  return least < 0;
}

hk_status hk_flypaper_hold(hk_flypaper *f, const hk_host *host, const hk_surfaces *surfaces, const hk_model *model,
                           hk_correction *c, double *mark) {
  hk_status status = list_holds(f, host, surfaces, model, c);
  f->pinched = 0;
  for (size_t k = 0, end; k < f->holds && status == HK_OK; k = end) {
    for (end = k + 1; end < f->holds && f->hold[end].vertex == f->hold[k].vertex; end++) continue;
    if (!hold_vertex(f, k, end, c)) continue;
    mark[f->hold[k].vertex] += HK_MARK_PINCHED;
    f->pinched++;
  }
  return status;
}

void hk_flypaper_free(hk_flypaper *f, const hk_host *host) {
  host->release(host, f->hold);
  *f = (hk_flypaper){.holds = 0};
}
