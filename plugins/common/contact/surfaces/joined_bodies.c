#include "plugins/common/contact/surfaces/joined_bodies.h"

#include "plugins/kit/vector3.h"

#include <stdlib.h>

static const double one_place = 1e-9; /* of the coordinates: what points of a ball of scene:joint may be apart */

typedef struct finder {
  hk_joined_bodies *into;
  const hk_model *model;
  const double *x;
  double reach;   /* m, of points that contact would push apart */
  uint32_t *body; /* n: the first carrier of the body that a particle is of; UINT32_MAX: none */
} finder;

static int rising(const void *left, const void *right) {
  const uint32_t *p = left, *q = right;
  int c = p[0] == q[0];
  return (p[c] > q[c]) - (p[c] < q[c]);
}

/* ---- pairs of constraints ---- */

static void take_bodies(finder *f) {
  const hk_model *m = f->model;
  for (size_t i = 0; i < m->n; i++) f->body[i] = UINT32_MAX;
  for (size_t k = 0; k < m->riders; k++) {
    const hk_rider *r = &m->rider[k];
    f->body[r->particle] = r->carrier[0];
    for (uint32_t c = 0; c < r->carriers; c++) f->body[r->carrier[c]] = r->carrier[0];
  }
}

static bool is_near(const finder *f, const uint32_t *pair) {
  const double *x = f->x + 3 * (size_t)pair[0];
  double way[3], place = one_place * (fabs(x[0]) + fabs(x[1]) + fabs(x[2]));
  hk_subtract(way, f->x + 3 * (size_t)pair[1], x);
  return hk_length(way) <= f->reach + place;
}

static bool lets_meet(const finder *f, const uint32_t *pair) {
  const hk_rider *r[2] = {hk_model_rider(f->model, pair[0]), hk_model_rider(f->model, pair[1])};
  return (r[0] && r[0]->meets) || (r[1] && r[1]->meets);
}

/* Whether it is of scene:joint, of a body with a particle that is of another body. */
static bool is_joint(const finder *f, const uint32_t *pair) {
  const hk_rider *r[2] = {hk_model_rider(f->model, pair[0]), hk_model_rider(f->model, pair[1])};
  return (r[0] && r[0]->joints) || (r[1] && r[1]->joints);
}

static void add_apart(finder *f, uint32_t p, uint32_t q) {
  uint32_t *pair = f->into->apart[f->into->aparts];
  if (p == q) return;
  pair[0] = p < q ? p : q, pair[1] = p < q ? q : p;
  f->into->aparts++;
}

static void add_held(finder *f, const uint32_t *pair) {
  uint32_t a = f->body[pair[0]], b = f->body[pair[1]];
  if ((a == UINT32_MAX) == (b == UINT32_MAX) || !is_near(f, pair) || lets_meet(f, pair)) return;
  uint32_t *held = f->into->held[f->into->helds++];
  held[0] = a == UINT32_MAX ? pair[0] : pair[1], held[1] = a == UINT32_MAX ? b : a;
}

static void add_kept(finder *f, const uint32_t *pair) {
  uint32_t a = f->body[pair[0]], b = f->body[pair[1]];
  if (a == UINT32_MAX || b == UINT32_MAX || a == b || lets_meet(f, pair)) return;
  if (is_joint(f, pair) || is_near(f, pair)) add_apart(f, a, b);
}

static void each_kept(finder *f, void (*add)(finder *, const uint32_t *)) {
  const hk_model *m = f->model;
  for (size_t l = 0; l < m->kept_lists; l++)
    for (size_t k = 0; k < m->join[l]->count; k++) add(f, hk_tuple(m->join[l], k));
}

/* ---- joints of two bodies: one of their points has the ids of all of them ---- */

static void add_joint(finder *f, const hk_rider *r) {
  for (uint32_t k = 0; k < r->joints; k++) {
    size_t point = hk_model_find(f->model, r->joined + k);
    const hk_rider *other = point < f->model->n ? hk_model_rider(f->model, point) : NULL;
    if (other) add_apart(f, r->carrier[0], other->carrier[0]);
  }
}

/* ---- particles that several bodies hold ---- */

static size_t shared(const hk_joined_bodies *l) {
  size_t count = 0;
  for (size_t k = 0, first = 0; k < l->helds; k++) {
    if (l->held[k][0] != l->held[first][0]) first = k;
    count += k - first;
  }
  return count;
}

static void add_shared(finder *f) {
  const hk_joined_bodies *l = f->into;
  for (size_t k = 0, first = 0; k < l->helds; k++) {
    if (l->held[k][0] != l->held[first][0]) first = k;
    for (size_t q = first; q < k; q++) add_apart(f, l->held[q][1], l->held[k][1]);
  }
}

/* ---- all ---- */

static bool take_held(finder *f, const hk_host *host, size_t kept) {
  hk_joined_bodies *l = f->into;
  l->held = host->allocate(host, (kept + 1) * sizeof *l->held);
  if (!l->held) return false;
  each_kept(f, add_held);
  if (l->helds == 0) return true;
  l->is_held = host->allocate(host, f->model->n * sizeof *l->is_held);
  if (!l->is_held) return false;
  qsort(l->held, l->helds, sizeof *l->held, rising);
  for (size_t k = 0; k < l->helds; k++) l->is_held[l->held[k][0]] = true;
  return true;
}

static bool take_apart(finder *f, const hk_host *host, size_t count) {
  hk_joined_bodies *l = f->into;
  l->apart = host->allocate(host, (count + shared(l) + 1) * sizeof *l->apart);
  if (!l->apart) return false;
  for (size_t k = 0; k < f->model->riders; k++) add_joint(f, &f->model->rider[k]);
  each_kept(f, add_kept);
  add_shared(f);
  if (l->aparts) qsort(l->apart, l->aparts, sizeof *l->apart, rising);
  return true;
}

hk_status hk_joined_bodies_find(hk_joined_bodies *l, const hk_host *host, const hk_view *view,
                                const hk_surface_request *request) {
  const hk_model *m = view->model;
  size_t joints = 0, kept = 0;
  for (size_t k = 0; k < m->riders; k++) joints += m->rider[k].joints;
  for (size_t k = 0; k < m->kept_lists; k++) kept += m->join[k]->count;
  if (m->riders == 0 || joints + kept == 0) return HK_OK;
  finder f = {.into = l, .model = m, .x = view->x};
  f.reach = request->thickness / 2 + fmax(request->thickness / 2, request->radius);
  f.body = host->allocate(host, m->n * sizeof *f.body);
  if (f.body) take_bodies(&f);
  bool done = f.body && take_held(&f, host, kept) && take_apart(&f, host, joints + kept);
  host->release(host, f.body);
  return done ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu pairs of joined points", joints + kept);
}

void hk_joined_bodies_free(hk_joined_bodies *l, const hk_host *host) {
  void *memory[] = {l->apart, l->held, l->is_held};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  *l = (hk_joined_bodies){0};
}

/* ---- questions ---- */

bool hk_solids_apart(const hk_joined_bodies *l, uint32_t solid, uint32_t other) {
  uint32_t pair[2] = {solid < other ? solid : other, solid < other ? other : solid};
  if (solid == UINT32_MAX || other == UINT32_MAX) return false;
  return solid == other || (l->aparts && bsearch(pair, l->apart, l->aparts, sizeof *l->apart, rising));
}

bool hk_solid_holds(const hk_joined_bodies *l, uint32_t solid, const uint32_t *particle, int count) {
  bool holds = false;
  for (int c = 0; c < count && l->is_held && solid != UINT32_MAX && !holds; c++) {
    const uint32_t pair[2] = {particle[c], solid};
    holds = l->is_held[particle[c]] && bsearch(pair, l->held, l->helds, sizeof *l->held, rising);
  }
  return holds;
}
