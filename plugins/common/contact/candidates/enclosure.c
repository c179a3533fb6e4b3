/* See enclosure.h. A point is inside of closed triangles where their solid angles sum up to 4 pi times 1, the winding
 * number (Jacobson, Kavan and Sorkine-Hornung 2013, "Robust inside-outside segmentation using generalized winding
 * numbers", ACM Trans. Graph. 32, equation 5). On a face it is a half, so that what only touches is outside. */
#include "plugins/common/contact/candidates/enclosure.h"

#include "plugins/common/contact/geometry/distance.h"
#include "plugins/common/contact/geometry/solid_angle.h"
#include "plugins/common/space/bvh.h"
#include "plugins/kit/vector3.h"

#include <stdlib.h>

static const double inside = 0.75;

/* What particles move with: the first carrier of their body, or one of these. */
static const uint32_t pinned = UINT32_MAX - 1, on_its_own = UINT32_MAX;

typedef struct owned {
  uint32_t owner, index; /* of a triangle or a point */
} owned;

typedef struct solid {
  uint32_t owner;
  size_t first, count; /* of `triangle` */
  hk_box box;          /* m */
} solid;

typedef struct search {
  const hk_surface_lists *lists;
  const hk_surface_mesh *mesh;
  const hk_model *model;
  const double *x;
  uint32_t *owner; /* of the parts that are one body or pinned, else on_its_own */
  bool *open;      /* parts that no solid is made of */
  owned *triangle; /* of solids, by these */
  owned *point;    /* by parts */
  solid *solid;
  size_t solids;
} search;

static uint32_t owner_of(const hk_model *m, uint32_t particle) {
  if (!hk_model_moves(m, particle)) return pinned;
  const hk_rider *r = hk_model_rider(m, particle);
  return r ? r->carrier[0] : on_its_own;
}

static int in_order(const void *left, const void *right) {
  const owned *a = left, *b = right;
  if (a->owner != b->owner) return a->owner < b->owner ? -1 : 1;
  return (a->index > b->index) - (a->index < b->index);
}

/* ---- parts ---- */

static void know_parts(search *s) {
  const hk_surface_mesh *m = s->mesh;
  bool *seen = s->open; /* before it says what is open */
  for (size_t k = 0; k < m->points; k++) {
    uint32_t part = m->part[m->point[k]], owner = owner_of(s->model, m->point[k]);
    s->point[k] = (owned){part, m->point[k]};
    if (seen[part] && s->owner[part] != owner) owner = on_its_own;
    s->owner[part] = owner;
    seen[part] = true;
  }
  qsort(s->point, m->points, sizeof *s->point, in_order);
  for (size_t k = 0; k < m->parts; k++) s->open[k] = s->owner[k] == on_its_own;
  for (size_t e = 0; e < m->edges; e++)
    if (m->edge_faces[e][0] == UINT32_MAX || m->edge_faces[e][1] == UINT32_MAX) s->open[m->part[m->edge[e][0]]] = true;
}

/* ---- solids ---- */

static void include(hk_box *box, const double p[3]) {
  for (int c = 0; c < 3; c++) box->low[c] = fmin(box->low[c], p[c]), box->high[c] = fmax(box->high[c], p[c]);
}

static void list_solids(search *s) {
  const hk_surface_mesh *m = s->mesh;
  size_t count = 0;
  for (size_t k = 0; k < m->triangles; k++) {
    uint32_t part = m->part[m->triangle[k][0]];
    if (!s->open[part]) s->triangle[count++] = (owned){s->owner[part], (uint32_t)k};
  }
  qsort(s->triangle, count, sizeof *s->triangle, in_order);
  for (size_t k = 0; k < count; k++) {
    if (k == 0 || s->triangle[k].owner != s->triangle[k - 1].owner)
      s->solid[s->solids++] =
          (solid){s->triangle[k].owner, k, 0, {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}};
    solid *last = &s->solid[s->solids - 1];
    last->count++;
    for (int c = 0; c < 3; c++) include(&last->box, s->x + 3 * (size_t)m->triangle[s->triangle[k].index][c]);
  }
}

static bool is_inside(const search *s, const solid *b, const double p[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++)
    if (!(p[c] > b->box.low[c] && p[c] < b->box.high[c])) return false;
  for (size_t k = b->first; k < b->first + b->count; k++)
    sum += hk_solid_angle(s->x, s->mesh->triangle[s->triangle[k].index], p);
  return sum > inside * HK_WHOLE_SOLID_ANGLE;
}

/* m, the distance to the surface; *nearest: a particle of the triangle there. */
static double depth_in(const search *s, const solid *b, const double p[3], uint32_t *nearest) {
  double least = INFINITY;
  *nearest = s->mesh->triangle[s->triangle[b->first].index][0];
  for (size_t k = b->first; k < b->first + b->count; k++) {
    const uint32_t *t = s->mesh->triangle[s->triangle[k].index];
    double x[12];
    hk_copy(x, p);
    for (int c = 0; c < 3; c++) hk_copy(x + 3 + 3 * c, s->x + 3 * (size_t)t[c]);
    double squared = hk_nearest_of_pair(HK_POINT_TRIANGLE, x).squared;
    if (squared < least) least = squared, *nearest = t[0];
  }
  return sqrt(least);
}

/* ---- all ---- */

static bool try_part(const search *s, const owned *point, size_t count, const solid *b, hk_enclosure *out) {
  for (size_t k = 0; k < count; k++)
    if (!is_inside(s, b, s->x + 3 * (size_t)point[k].index)) return false;
  for (size_t k = 0; k < count; k++) {
    uint32_t nearest = point[k].index;
    double depth = depth_in(s, b, s->x + 3 * (size_t)point[k].index, &nearest);
    if (out->found && depth <= out->depth) continue;
    *out = (hk_enclosure){true, point[k].index, nearest, depth};
  }
  return true;
}

/* A particle on its own that the body holds. */
static bool holds(const search *s, const solid *b, const owned *point, size_t count) {
  return count == 1 && hk_solid_holds(&s->lists->joined, b->owner, &point->index, 1);
}

static void try_parts(const search *s, hk_enclosure *out) {
  for (size_t begin = 0, end; begin < s->mesh->points; begin = end) {
    uint32_t part = s->point[begin].owner;
    for (end = begin + 1; end < s->mesh->points && s->point[end].owner == part;) end++;
    if (end - begin == 1 && s->owner[part] == pinned) continue;
    for (size_t b = 0; b < s->solids; b++)
      if (!hk_solids_apart(&s->lists->joined, s->solid[b].owner, s->owner[part]) &&
          !holds(s, &s->solid[b], s->point + begin, end - begin) &&
          try_part(s, s->point + begin, end - begin, &s->solid[b], out))
        return;
  }
}

static bool reserve(search *s, const hk_host *host) {
  s->owner = host->allocate(host, (s->mesh->parts + 1) * sizeof *s->owner);
  s->open = host->allocate(host, (s->mesh->parts + 1) * sizeof *s->open);
  s->triangle = host->allocate(host, (s->mesh->triangles + 1) * sizeof *s->triangle);
  s->point = host->allocate(host, (s->mesh->points + 1) * sizeof *s->point);
  s->solid = host->allocate(host, (s->mesh->parts + 1) * sizeof *s->solid);
  return s->owner && s->open && s->triangle && s->point && s->solid;
}

hk_status hk_enclosure_find(const hk_surface_lists *l, const hk_host *host, const hk_model *model, const double *x,
                            hk_enclosure *out) {
  search s = {.lists = l, .mesh = &l->mesh, .model = model, .x = x};
  hk_status status = HK_OK;
  *out = (hk_enclosure){0};
  if (reserve(&s, host)) {
    know_parts(&s);
    list_solids(&s);
    try_parts(&s, out);
  } else {
    status = host->fail(host, HK_NO_MEMORY, "no memory for the solids among %zu surfaces", l->mesh.parts);
  }
  void *scratch[] = {s.owner, s.open, s.triangle, s.point, s.solid};
  for (size_t k = 0; k < sizeof scratch / sizeof *scratch; k++) host->release(host, scratch[k]);
  return status;
}
