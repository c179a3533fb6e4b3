/* See face_contacts.h. Impacts are sorted by the two bodies; those of a pair whose normals are nearly the same are a
 * patch. Three places of it that are far apart give the affine functions, which all others have to obey, and Andrew's
 * monotone chain the hull (Andrew 1979, Inf. Process. Lett. 9, 216). */
#include "plugins/common/contact/faces/face_contacts.h"
#include "plugins/common/contact/bodies/body_contact_law.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

#include <stdlib.h>
#include <string.h>

enum { FEW = 5 /* that are not worth it */ };

/* Of the cosine of the angle between the normals of a patch; of its extent, what is one place of the hull; of the
 * square of that, an area that is a line. */
static const double parallel = 1e-3, one_place = 1e-5, thin = 1e-6;

typedef struct hk_face_contact {
  uint32_t side[2], impact;
  bool turned, kept;     /* its normal is from the lower side to the higher one */
  double at[2], left[2]; /* m, in the patch; of the places, m, and of the speeds times the step, m */
  double push;           /* kg m, that it begins with */
} contact;

typedef struct patch {
  contact *k;
  size_t count;
} patch;

/* ---- sides ---- */

static uint32_t side_of(const hk_body_impacts *s, const hk_surface_mesh *mesh, const hk_impact *k, int side) {
  int split = hk_pair_split(k->pair.kind), first = side == 0 ? 0 : split, last = side == 0 ? split : 4;
  uint32_t of = UINT32_MAX;
  for (int i = first; i < last; i++) {
    uint32_t particle = k->pair.vertex[i], now;
    const hk_rider *r = hk_model_rider(s->model, particle);
    if (!r && hk_model_moves(s->model, particle)) return UINT32_MAX;
    now = r ? r->carrier[0] : (uint32_t)s->n + mesh->part[particle];
    if (i > first && now != of) return UINT32_MAX;
    of = now;
  }
  return of;
}

static int in_order(const void *left, const void *right) {
  const contact *a = left, *b = right;
  for (int c = 0; c < 2; c++)
    if (a->side[c] != b->side[c]) return a->side[c] < b->side[c] ? -1 : 1;
  return (a->impact > b->impact) - (a->impact < b->impact);
}

/* The pair of bodies in rising order, so that both kinds of pairs are in one patch. */
static void list(const hk_body_impacts *s, const hk_surface_mesh *mesh, const hk_contact_solver *solver, contact *all) {
  for (size_t e = 0; e < solver->count; e++) {
    uint32_t a = side_of(s, mesh, &solver->impact[e], 0), b = side_of(s, mesh, &solver->impact[e], 1);
    all[e] = (contact){.side = {a < b ? a : b, a < b ? b : a}, .impact = (uint32_t)e, .turned = a < b, .kept = true};
  }
  qsort(all, solver->count, sizeof *all, in_order);
}

/* ---- a patch ---- */

static double along(const hk_contact_solver *solver, const contact *a, const contact *b) {
  double cosine = hk_dot(solver->impact[a->impact].frame.n, solver->impact[b->impact].frame.n);
  return a->turned == b->turned ? cosine : -cosine;
}

/* The impact of which the normal is that of a face: a point within a triangle, where there is one. */
static size_t seed_of(const hk_contact_solver *solver, const patch *p) {
  for (size_t k = 0; k < p->count; k++) {
    const hk_impact *i = &solver->impact[p->k[k].impact];
    if (i->pair.kind == HK_POINT_TRIANGLE && i->frame.w[1] * i->frame.w[2] * i->frame.w[3] != 0) return k;
  }
  return 0;
}

/* Takes those along the normal of the seed to the front; the rest is looked at later. */
static patch front_of(const hk_contact_solver *solver, const patch *all) {
  patch front = {all->k, 0};
  const contact seed = all->k[seed_of(solver, all)];
  for (size_t k = 0; k < all->count; k++) {
    if (along(solver, &all->k[k], &seed) < 1 - parallel) continue;
    contact moved = all->k[k];
    all->k[k] = all->k[front.count];
    all->k[front.count++] = moved;
  }
  return front;
}

/* By how much an inequality holds, m or m/s. */
static double left_of(const hk_impact *k, const hk_impact_level *level, const double *y) {
  double sum = -level->target;
  for (int c = 0; c < 3; c++) sum -= k->frame.n[c] * level->origin[c];
  for (int i = 0; i < 4; i++) sum += k->frame.w[i] * hk_dot(k->frame.n, y + 3 * (size_t)k->pair.vertex[i]);
  return sum;
}

static void measure(const hk_contact_solver *solver, const hk_step_move *m, const patch *p) {
  double a[3], b[3];
  hk_vectors_across(solver->impact[p->k[0].impact].frame.n, a, b);
  for (size_t k = 0; k < p->count; k++) {
    contact *q = &p->k[k];
    const hk_impact *i = &solver->impact[q->impact];
    double at[3] = {0, 0, 0};
    for (int j = 0; j < 4; j++) hk_add_scaled(at, fabs(i->frame.w[j]) / 2, m->x + 3 * (size_t)i->pair.vertex[j]);
    q->at[0] = hk_dot(at, a), q->at[1] = hk_dot(at, b);
    q->left[0] = left_of(i, &i->place, m->x);
    q->left[1] = left_of(i, &i->speed, m->v) * m->h;
    q->push = i->place.push;
  }
}

/* ---- affine functions ---- */

static double area(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double distance2(const double a[2], const double b[2]) {
  return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/* Three far from each other: the farthest from the first, from that, and from their line. Returns the square of the
 * distance of the first two. */
static double spread(const patch *p, size_t three[3]) {
  three[0] = three[1] = three[2] = 0;
  for (int turn = 0; turn < 2; turn++) {
    size_t from = three[turn], to = from;
    for (size_t k = 0; k < p->count; k++)
      if (distance2(p->k[k].at, p->k[from].at) > distance2(p->k[to].at, p->k[from].at)) to = k;
    three[1 - turn] = to;
  }
  const double *a = p->k[three[0]].at, *b = p->k[three[1]].at;
  for (size_t k = 0; k < p->count; k++)
    if (fabs(area(a, b, p->k[k].at)) > fabs(area(a, b, p->k[three[2]].at))) three[2] = k;
  return distance2(a, b);
}

/* The largest difference of a function from the affine one of the three; along a line, of two. */
static double bend(const patch *p, const size_t three[3], double extent2, int level) {
  const contact *a = &p->k[three[0]], *b = &p->k[three[1]], *c = &p->k[three[2]];
  double whole = area(a->at, b->at, c->at), most = 0;
  bool line = !(fabs(whole) > thin * extent2);
  for (size_t k = 0; k < p->count; k++) {
    const double *at = p->k[k].at;
    double beta =
        line ? ((at[0] - a->at[0]) * (b->at[0] - a->at[0]) + (at[1] - a->at[1]) * (b->at[1] - a->at[1])) / extent2
             : area(a->at, at, c->at) / whole;
    double gamma = line ? 0 : area(a->at, b->at, at) / whole;
    double affine = (1 - beta - gamma) * a->left[level] + beta * b->left[level] + gamma * c->left[level];
    most = fmax(most, fabs(p->k[k].left[level] - affine));
  }
  return most;
}

/* ---- the hull ---- */

static int by_place(const void *left, const void *right) {
  const contact *a = left, *b = right;
  for (int c = 0; c < 2; c++)
    if (a->at[c] != b->at[c]) return a->at[c] < b->at[c] ? -1 : 1;
  if (a->push != b->push) return a->push > b->push ? -1 : 1;
  return (a->impact > b->impact) - (a->impact < b->impact);
}

/* One of the two chains from end to end: keeps its corners. `chain` has room for all. */
static void keep_chain(const patch *p, bool back, size_t *chain) {
  size_t count = 0;
  for (size_t j = 0; j < p->count; j++) {
    size_t k = back ? p->count - 1 - j : j;
    if (k > 0 && distance2(p->k[k].at, p->k[k - 1].at) == 0) continue;
    while (count >= 2 && area(p->k[chain[count - 2]].at, p->k[chain[count - 1]].at, p->k[k].at) <= 0) count--;
    chain[count++] = k;
  }
  for (size_t j = 0; j < count; j++) p->k[chain[j]].kept = true;
}

/* Places are rounded to whole numbers, so that the areas are exact. */
static void keep_hull(const patch *p, double extent2, size_t *chain) {
  double unit = one_place * sqrt(extent2), from[2] = {p->k[0].at[0], p->k[0].at[1]};
  for (size_t k = 0; k < p->count; k++)
    for (int c = 0; c < 2; c++) p->k[k].at[c] = nearbyint((p->k[k].at[c] - from[c]) / unit);
  qsort(p->k, p->count, sizeof *p->k, by_place);
  for (size_t k = 0; k < p->count; k++) p->k[k].kept = false;
  keep_chain(p, false, chain);
  keep_chain(p, true, chain);
}

static void reduce(const hk_contact_solver *solver, const hk_step_move *m, double close, const patch *p,
                   size_t *chain) {
  size_t three[3];
  if (p->count < FEW) return;
  measure(solver, m, p);
  double extent2 = spread(p, three);
  if (!(extent2 > 0)) return;
  for (int level = 0; level < 2; level++)
    if (!(bend(p, three, extent2, level) <= close)) return;
  keep_hull(p, extent2, chain);
}

/* ---- all ---- */

static void take_apart(const hk_contact_solver *solver, const hk_step_move *m, double close, contact *all,
                       size_t *chain) {
  for (size_t begin = 0, end; begin < solver->count; begin = end) {
    for (end = begin + 1; end < solver->count && memcmp(all[end].side, all[begin].side, sizeof all->side) == 0;) end++;
    patch rest = {all + begin, end - begin};
    if (all[begin].side[1] == UINT32_MAX) continue; /* it bends */
    while (rest.count > 0) {
      patch p = front_of(solver, &rest);
      reduce(solver, m, close, &p, chain);
      rest = (patch){rest.k + p.count, rest.count - p.count};
    }
  }
}

static int by_keeping(const void *left, const void *right) {
  const contact *a = left, *b = right;
  if (a->kept != b->kept) return a->kept ? -1 : 1;
  return (a->impact > b->impact) - (a->impact < b->impact);
}

hk_status hk_face_contacts_reduce(hk_body_impacts *s, const hk_surface_mesh *mesh, const hk_step_move *m, double close,
                                  hk_contact_solver *solver, uint32_t *chosen) {
  size_t kept = 0;
  hk_status status = hk_reserve(s->host, &s->face, &s->face_room, solver->count, sizeof *s->face);
  if (status == HK_OK) status = hk_reserve(s->host, &s->chain, &s->chain_room, solver->count, sizeof *s->chain);
  if (status != HK_OK) return status;
  list(s, mesh, solver, s->face);
  take_apart(solver, m, close, s->face, s->chain);
  qsort(s->face, solver->count, sizeof *s->face, by_keeping);
  while (kept < solver->count && s->face[kept].kept) kept++;
  for (size_t e = 0; e < kept; e++) { /* those in front are exchanged: none comes from further ahead */
    size_t from = s->face[e].impact;
    if (from == e) continue;
    hk_impact impact = solver->impact[from];
    uint32_t which = chosen[from];
    solver->impact[from] = solver->impact[e], chosen[from] = chosen[e];
    solver->impact[e] = impact, chosen[e] = which;
  }
  solver->count = kept;
  return HK_OK;
}
