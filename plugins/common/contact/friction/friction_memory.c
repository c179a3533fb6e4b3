/* See friction.h: what contacts remember from step to step. A pair that carried nothing before takes over what its
 * neighbours remember, the contacts of a particle of its first feature with one of its second: where a corner rolls
 * from one triangle to the next, or an edge takes the load of its end, what sticks stays where it is. */
#include "plugins/common/contact/friction/friction.h"
#include "plugins/common/space/reserve.h"
#include "plugins/kit/vector3.h"

#include <stdlib.h>
#include <string.h>

static const double fast = 1e-3;      /* m/s: what is slower may stick where it lands */
static const double rest_part = 5e-4; /* of the way in which friction turns a contact back: L of what rests */
static const double quiet = 8;        /* steps after which a contact rests */
static const double least_way = 10;   /* distances of the barrier: what slides less is judged by the work on that */
static const double unknown = -1;     /* for hk_slip.stuck: what it begins with is found when the pair acts */
static const double alike = 0.5;      /* cosine of two normals, of which one contact may follow the other */

static void across(double *u, const double *n) { hk_add_scaled(u, -hk_dot(u, n), n); }

static const hk_stick *sticks_of(const hk_friction *f) { return f->sticks.item; }

/* ---- the elastic slip ---- */

double hk_friction_rest_length(const hk_friction *f, const hk_slip *slip, double T) {
  return fmin(f->elastic_slip, rest_part * slip->change * T * T);
}

/* Steps that resolve the swing on an elastic slip of the parameter, by a radian or less, keep that. */
double hk_friction_length(const hk_friction *f, const hk_slip *slip, double T) {
  bool resolved = 2 * slip->change * T * T < f->elastic_slip;
  if (!f->implicit || resolved) return f->elastic_slip;
  return slip->stuck >= quiet ? hk_friction_rest_length(f, slip, T) : fmax(f->elastic_slip, fast * T);
}

/* ---- by particles ---- */

/* Lists the contacts of every particle. */
static hk_status list_members(hk_friction *f, const hk_host *host, size_t n) {
  const hk_stick *stick = sticks_of(f);
  hk_status status = hk_reserve_array(host, &f->first, n + 2);
  if (status == HK_OK) status = hk_reserve_array(host, &f->member, 4 * f->sticks.count);
  if (status != HK_OK) return status;
  uint32_t *first = f->first.item, *member = f->member.item;
  memset(first, 0, (n + 2) * sizeof *first);
  for (size_t k = 0; k < f->sticks.count; k++)
    for (int a = 0; a < 4; a++) first[stick[k].pair.vertex[a] + 2]++;
  for (size_t i = 2; i < n + 2; i++) first[i] += first[i - 1];
  for (size_t k = 0; k < f->sticks.count; k++)
    for (int a = 0; a < 4; a++) member[first[stick[k].pair.vertex[a] + 1]++] = (uint32_t)k;
  return HK_OK;
}

/* What a pair takes over. */
typedef struct heritage {
  hk_slip slip;
  double load;
} heritage;

static bool has(const uint32_t *list, int begin, int end, uint32_t vertex) {
  for (int a = begin; a < end; a++)
    if (list[a] == vertex) return true;
  return false;
}

/* 1 or -1, as a contact has the two features the same way round as the pair; 0: it is not between them. */
static int sense_of(const hk_stick *s, const hk_feature_pair *p) {
  int split = hk_pair_split(p->kind), at = hk_pair_split(s->pair.kind);
  const uint32_t *v = s->pair.vertex;
  bool one[2] = {false, false}, other[2] = {false, false};
  for (int a = 0; a < split; a++) one[0] |= has(v, 0, at, p->vertex[a]), one[1] |= has(v, at, 4, p->vertex[a]);
  for (int a = split; a < 4; a++) other[0] |= has(v, 0, at, p->vertex[a]), other[1] |= has(v, at, 4, p->vertex[a]);
  return one[0] && other[1] ? 1 : one[1] && other[0] ? -1 : 0;
}

static void inherit(const hk_friction *f, const hk_barrier_pair *p, uint32_t vertex, heritage *to) {
  const uint32_t *first = f->first.item, *member = f->member.item;
  for (uint32_t m = first[vertex]; m < first[vertex + 1]; m++) {
    const hk_stick *s = sticks_of(f) + member[m];
    int sense = sense_of(s, &p->pair);
    if (sense == 0 || sense * hk_dot(s->n, p->axis) < alike) continue;
    hk_add_scaled(to->slip.s, sense * s->load, s->slip.s);
    to->slip.change += s->load * s->slip.change;
    to->slip.slid = fmax(to->slip.slid, s->slip.slid);
    to->load += s->load;
  }
}

/* Asked are the particles of that feature which has fewer contacts: below a heap a floor has all of them. */
static bool take_over(const hk_friction *f, const hk_barrier_pair *p, hk_slip *slip) {
  const uint32_t *first = f->first.item;
  int split = hk_pair_split(p->pair.kind);
  size_t count[2] = {0};
  heritage h = {0};
  for (int a = 0; a < 4; a++) {
    uint32_t v = p->pair.vertex[a];
    count[a >= split] += first[v + 1] - first[v];
  }
  if (count[0] == 0 || count[1] == 0) return false;
  int begin = count[0] <= count[1] ? 0 : split, end = count[0] <= count[1] ? split : 4;
  for (int a = begin; a < end; a++) inherit(f, p, p->pair.vertex[a], &h);
  if (!(h.load > 0)) return false;
  hk_add_scaled(slip->s, 1 / h.load, h.slip.s);
  slip->change = h.slip.change / h.load;
  slip->slid = h.slip.slid;
  return true;
}

/* ---- what pairs remember ---- */

typedef struct task {
  const hk_friction *friction;
  const hk_barrier_pair *near;
  hk_slip *slips;
} task;

static size_t place_of(const hk_friction *f, const hk_feature_pair *pair) {
  size_t low = 0, high = f->sticks.count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (hk_pair_compare(&sticks_of(f)[middle].pair, pair) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static void recall_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_friction *f = t->friction;
  size_t at = place_of(f, &t->near[begin].pair);
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    hk_slip *slip = &t->slips[k];
    int order = -1;
    *slip = (hk_slip){0};
    for (; at < f->sticks.count && (order = hk_pair_compare(&sticks_of(f)[at].pair, &t->near[k].pair)) < 0;) at++;
    if (at < f->sticks.count && order == 0)
      *slip = sticks_of(f)[at].slip;
    else if (!f->sticks.count || !take_over(f, &t->near[k], slip))
      slip->stuck = unknown;
  }
}

/* What lands slides from the first on, along its velocity at the start of the step, unless it is slow. */
static hk_slip landing(const hk_friction *f, const hk_feature_pair *p, size_t n) {
  const double *x = f->begun.item, *v = x + 3 * n;
  hk_nearest at = hk_pair_nearest(p, x);
  hk_slip slip = {0};
  double u[3] = {0};
  for (int a = 0; a < 4; a++) hk_add_scaled(u, at.w[a], v + 3 * (size_t)p->vertex[a]);
  across(u, hk_pair_frame_of(&at).n);
  double size = fmax(fast, hk_length(u));
  hk_add_scaled(slip.s, 1 / size, u);
  if (size > fast) slip.slid = INFINITY;
  return slip;
}

const hk_slip *hk_friction_slip(const hk_friction *f, const hk_barrier_contacts *c, size_t near, size_t n) {
  hk_slip *slip = (hk_slip *)f->slips.item + near;
  if (slip->stuck == unknown) *slip = landing(f, &((const hk_barrier_pair *)c->near.item)[near].pair, n);
  return slip;
}

static hk_status note_start(hk_friction *f, const hk_host *host, const hk_view *view) {
  hk_status status = hk_reserve_array(host, &f->begun, 6 * view->n);
  if (status != HK_OK) return status;
  memcpy(f->begun.item, view->x, 3 * view->n * sizeof *view->x);
  memcpy((double *)f->begun.item + 3 * view->n, view->v, 3 * view->n * sizeof *view->v);
  return HK_OK;
}

/* ---- the end of a step ---- */

/* Coulomb's work on a slide of the contact, and what was missed of it before it slid, over the elastic slip L: counted
 * once it has slid as far. */
static void note_work(hk_friction *f, double most, hk_slip *s, double way, double L) {
  double before = s->slid;
  s->slid += way;
  f->taken += most * way;
  if (before < L && s->slid >= L) f->missed += most * L;
}

/* The way of the step across n, m. */
static void find_way(const hk_friction *f, const hk_stick *s, const double w[4], const double *x, double way[3]) {
  const double *begun = f->begun.item;
  way[0] = way[1] = way[2] = 0;
  for (int a = 0; a < 4; a++) {
    size_t i = 3 * (size_t)s->pair.vertex[a];
    hk_add_scaled(way, w[a], x + i);
    hk_add_scaled(way, -w[a], begun + i);
  }
  across(way, s->n);
}

/* Where the contact is after a step of h s. */
static hk_stick stick_of(hk_friction *f, const hk_barrier_contacts *c, const hk_barrier_value *v, const hk_view *view,
                         double h, double *lost) {
  const hk_barrier_pair *p = (const hk_barrier_pair *)c->near.item + v->near;
  hk_pair_frame frame = hk_pair_frame_of(&v->nearest);
  hk_stick s = {.pair = p->pair, .slip = *hk_friction_slip(f, c, v->near, view->n), .load = hk_barrier_load(v)};
  double way[3], u[3], mobility = 0, L = hk_friction_length(f, &s.slip, h), most = f->coefficient * s.load;
  for (int a = 0; a < 4; a++) {
    s.id[a] = view->model->id[s.pair.vertex[a]];
    mobility += frame.w[a] * frame.w[a] * view->model->inverse_mass[s.pair.vertex[a]];
  }
  s.slip.change = most * mobility;
  hk_copy(s.n, frame.n);
  across(s.slip.s, s.n);
  find_way(f, &s, frame.w, view->x, way);
  hk_copy(u, s.slip.s);
  hk_add_scaled(u, 1 / L, way);
  double size = hk_length(u);
  if (size > 1) {
    note_work(f, most, &s.slip, hk_length(way), L);
    *lost += most * (size - 1) * L;
    if (s.slip.slid > f->elastic_slip) s.slip.stuck = 0;
  } else {
    s.slip.slid = 0;
    if (s.slip.stuck < quiet)
      s.slip.stuck = hk_length(way) <= hk_friction_rest_length(f, &s.slip, h) ? s.slip.stuck + 1 : 0;
  }
  for (int e = 0; e < 3; e++) s.slip.s[e] = u[e] / fmax(1, size);
  return s;
}

hk_status hk_friction_remember(hk_friction *f, hk_barrier_contacts *c, const hk_view *view, double h, double *lost) {
  if (!(f->coefficient > 0)) return HK_OK;
  hk_barrier_values_at(c, view);
  hk_status status = hk_reserve_array(c->host, &f->next, c->acting_count);
  if (status != HK_OK) return status;
  hk_stick *next = f->next.item;
  size_t count = 0;
  double sum = 0;
  for (size_t k = 0; k < c->acting_count; k++) {
    const hk_barrier_value *v = hk_barrier_acting(c, k);
    if (!(hk_barrier_load(v) > 0)) continue;
    next[count] = stick_of(f, c, v, view, h, lost);
    sum += f->coefficient * next[count++].load;
  }
  f->most = fmax(f->most, sum);
  status = c->host->resize(c->host, &f->sticks, count);
  if (status != HK_OK) return status;
  if (count) memcpy(f->sticks.item, next, count * sizeof *next);
  return HK_OK;
}

/* ---- the start of a run, of a step, and its moves ---- */

static void recall(const hk_friction *f, const hk_barrier_contacts *c) {
  task t = {f, c->near.item, f->slips.item};
  c->host->parallel_for(c->host, c->found, HK_BARRIER_GRAIN, recall_chunk, &t);
}

/* A contact of the start slides where it moves faster than the whole friction would bring it on the elastic slip. */
static void set_going(const hk_friction *f, hk_stick *s, const hk_view *view) {
  hk_nearest at = hk_pair_nearest(&s->pair, view->x);
  double u[3] = {0}, speed = sqrt(f->elastic_slip * s->slip.change);
  for (int a = 0; a < 4; a++) hk_add_scaled(u, at.w[a], view->v + 3 * (size_t)s->pair.vertex[a]);
  across(u, s->n);
  double size = fmax(speed, hk_length(u));
  for (int e = 0; e < 3 && size > 0; e++) s->slip.s[e] = u[e] / size;
  if (size > speed)
    s->slip.slid = INFINITY;
  else
    s->slip.stuck = quiet;
}

/* What carries something at the start of a run. */
static hk_status begin(hk_friction *f, hk_barrier_contacts *c, const hk_view *view) {
  hk_stick *stick;
  double lost = 0;
  hk_status status = HK_OK;
  if (f->ready || f->sticks.count) return HK_OK;
  recall(f, c);
  status = hk_friction_remember(f, c, view, 0, &lost);
  stick = f->sticks.item;
  for (size_t k = 0; k < f->sticks.count; k++) set_going(f, &stick[k], view);
  f->ready = status == HK_OK;
  return status;
}

hk_status hk_friction_recall(hk_friction *f, hk_barrier_contacts *c, const hk_view *from) {
  bool starts = from->t == from->model->t;
  if (!(f->coefficient > 0)) return HK_OK;
  hk_status status = starts ? note_start(f, c->host, from) : HK_OK;
  if (status == HK_OK) status = hk_reserve_array(c->host, &f->slips, c->found);
  if (status == HK_OK && starts) status = begin(f, c, from);
  if (status == HK_OK) status = list_members(f, c->host, from->n);
  if (status == HK_OK) recall(f, c);
  return status;
}

double hk_friction_missed(const hk_friction *f, const hk_barrier_contacts *c) {
  double all = fmax(f->taken, least_way * f->most * c->law.distance);
  return all > 0 ? f->missed / all : 0;
}

/* ---- other indices ---- */

static int compare(const void *a, const void *b) {
  return hk_pair_compare(&((const hk_stick *)a)->pair, &((const hk_stick *)b)->pair);
}

hk_status hk_friction_renumber(hk_friction *f, const hk_host *host, const hk_view *view) {
  hk_stick *stick = f->sticks.item;
  size_t kept = 0;
  for (size_t k = 0; k < f->sticks.count; k++) {
    hk_stick s = stick[k];
    bool there = s.pair.kind == HK_POINT_TRIANGLE || s.pair.kind == HK_EDGE_EDGE;
    for (int a = 0; a < 4; a++) {
      size_t i = hk_model_find(view->model, s.id[a]);
      there = there && i < view->n;
      s.pair.vertex[a] = (uint32_t)i;
    }
    if (there) stick[kept++] = s;
  }
  hk_status status = host->resize(host, &f->sticks, kept);
  if (status != HK_OK) return status;
  if (kept) qsort(f->sticks.item, kept, sizeof *stick, compare);
  return status;
}
