/* A pull: particles are drawn to a point, which may move, by a spring of no length and a damper,
 *     F = h (k (target - x) - damping v).
 * The point is `target`, with h = 1, or the hand of a user who watches the run (plugins/common/hand/hand.h): it holds
 * one particle, and h grows from 0 and fades to 0 over a frame, so that F is continuous. Stiffness and damping of the
 * hand are chosen for the particle where they are left out: k = sqrt(m M) w^2 with the particle's mass m, the mass M of
 * all that is free, and w = 20/60 a frame, so that the hand can move a particle alone in some 20 frames and still lift
 * something of a sheet of many; damping sqrt(k m), half of the critical one of the particle alone. Steps are then at
 * most sqrt(m/k)/5, a thirtieth of the period of the particle alone.
 *
 * All of its power is counted as work from outside; it has no energy. The hand's work is the sum of (F0 + F1)/2 dx over
 * the steps, right to second order. After the springs of the mouse in Witkin, Particle System Dynamics, in
 * Physically Based Modeling (SIGGRAPH course notes, 1997). */
#include "plugins/common/hand/hand.h"

#include <string.h>

typedef struct pull {
  hk_tuples particles;
  double target[3], k, damping;
  bool by_hand;

  const hk_hand *hand; /* NULL: `target` */
  bool all;            /* no particles were named: a list that deaths have emptied is another thing */
  double free_mass;    /* kg, M */
  double work;         /* J, of the hand */
  int64_t held;        /* id at the last accepted step; 0: none */
  double F[3], x[3];   /* of that particle, at that step */
  int64_t touched;     /* whether the hand ever held something */
} pull;

static const hk_param params[] = {
    {"particles", "", "ids of the particles that are pulled; left out: all on which the force acts; not with by_hand",
     .particles = HK_AT(pull, particles), .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"target", "m", "the point that they are pulled to; not with by_hand", .vector = HK_AT(pull, target),
     .flags = HK_TIMED},
    {"k", "N/m", "stiffness; required without by_hand, and else chosen for the particle that is held",
     .number = HK_AT(pull, k), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"damping", "N s/m", "of the particle's velocity; left out: none, or by_hand as is good for the particle",
     .number = HK_AT(pull, damping), .limits = HK_AT_LEAST(0), .flags = HK_OPTIONAL},
    {"by_hand", "", "the particle and the point are those of the user's hand (hooke run --watch)",
     .boolean = HK_AT(pull, by_hand)},
    {0},
};

static const hk_field fields[] = {
    {"work", .number = HK_AT(pull, work)},
    {"touched", .integer = HK_AT(pull, touched)},
    {0},
};

static void weigh(pull *p, const hk_view *view) {
  p->free_mass = 0;
  for (size_t i = 0; i < view->n; i++)
    if (view->model->inverse_mass[i] > 0) p->free_mass += view->model->mass[i];
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  pull *p = self;
  p->work = 0;
  p->touched = p->held = 0;
  if (p->by_hand && p->particles.count)
    return host->fail(host, HK_BAD_PARAM, "particles: with by_hand the user chooses them: leave one of the two out");
  if (!p->by_hand && isnan(p->k)) return host->fail(host, HK_BAD_PARAM, "k: the stiffness (N/m) is required");
  weigh(p, view);
  p->all = p->particles.count == 0;
  p->hand = p->by_hand ? host->query(host, HK_HAND_INTERFACE) : NULL;
  return p->by_hand && !p->hand ? HK_FAILED : HK_OK;
}

static hk_status topology(void *self, const hk_view *view) {
  weigh(self, view);
  return HK_OK;
}

/* What pulls the particle i at present. */
typedef struct spring {
  size_t i;
  double k, damping, target[3];
} spring;

/* k of the hand; see the head. */
static double hand_stiffness(const pull *p, const hk_grip *g, double mass) {
  double w = 20 / (60 * g->frame);
  return g->strength * (isnan(p->k) ? sqrt(mass * p->free_mass) * w * w : p->k);
}

/* False: the hand holds nothing that is free. */
static bool hand_spring(const pull *p, const hk_view *view, spring *s) {
  hk_grip g = p->hand->grip(p->hand->self, view->t);
  s->i = g.id ? hk_model_find(view->model, g.id) : view->n;
  if (s->i == view->n || !(g.frame > 0) || view->model->inverse_mass[s->i] == 0) return false;
  double mass = view->model->mass[s->i], k = hand_stiffness(p, &g, mass);
  s->k = g.hold * k;
  s->damping = g.hold * (isnan(p->damping) ? sqrt(k * mass) : p->damping);
  memcpy(s->target, g.place, sizeof g.place);
  return true;
}

static size_t springs(const pull *p, const hk_view *view) {
  return p->hand ? 1 : p->all ? view->acting : p->particles.count;
}

static uint32_t pulled(const pull *p, const hk_view *view, size_t e) {
  if (!p->all) return *hk_tuple(&p->particles, e);
  return view->active ? view->active[e] : (uint32_t)e;
}

/* The e-th of all springs; false: it does not act. */
static bool spring_at(const pull *p, const hk_view *view, size_t e, spring *s) {
  if (p->hand) return hand_spring(p, view, s) && (!view->is_active || view->is_active[s->i]);
  *s = (spring){pulled(p, view, e), p->k, isnan(p->damping) ? 0 : p->damping, {0}};
  memcpy(s->target, p->target, sizeof p->target);
  return !view->is_active || view->is_active[s->i];
}

static void force_of(const spring *s, const hk_view *view, double F[3]) {
  for (int c = 0; c < 3; c++) F[c] = s->k * (s->target[c] - view->x[3 * s->i + c]) - s->damping * view->v[3 * s->i + c];
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const pull *p = self;
  for (size_t e = 0; e < springs(p, view); e++) {
    spring s;
    double f[3], power = 0;
    if (!spring_at(p, view, e, &s)) continue;
    force_of(&s, view, f);
    for (int c = 0; c < 3; c++) {
      F[3 * s.i + c] += f[c];
      power += f[c] * view->v[3 * s.i + c];
    }
    if (view->power) *view->power += power;
  }
  return HK_OK;
}

/* The hand may hold any particle, so that it names the blocks of all: they are in the pattern anyway. */
static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  const pull *p = self;
  size_t count = p->hand ? view->n : springs(p, view);
  for (size_t e = 0; e < count; e++) {
    uint32_t i = p->hand ? (uint32_t)e : pulled(p, view, e);
    if (p->hand || !view->is_active || view->is_active[i]) pattern->block(pattern, i, i);
  }
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const pull *p = self;
  const size_t *slot = into->slot;
  for (size_t e = 0; e < springs(p, view); e++) {
    spring s;
    if (!spring_at(p, view, e, &s)) continue;
    size_t at = 9 * (p->hand ? slot[s.i] : *slot++);
    for (int c = 0; c < 3; c++) {
      into->K[at + 4 * (size_t)c] += s.k;
      into->D[at + 4 * (size_t)c] += s.damping;
    }
  }
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  static const size_t diagonal[] = {0, 3, 5};
  const pull *p = self;
  for (size_t e = 0; e < springs(p, view); e++) {
    spring s;
    if (!spring_at(p, view, e, &s)) continue;
    for (int c = 0; c < 3; c++) block[s.i][diagonal[c]] += part == HK_DAMPING_WHOLE ? s.damping : s.k;
  }
}

/* Of the hand, by its full stiffness, before the hold has grown. */
static double longest_step(void *self, const hk_view *view) {
  const pull *p = self;
  spring s;
  if (!p->hand || !hand_spring(p, view, &s)) return INFINITY;
  hk_grip g = p->hand->grip(p->hand->self, view->t);
  double mass = view->model->mass[s.i];
  return 0.2 * sqrt(mass / hand_stiffness(p, &g, mass));
}

static void begin_hold(pull *p, const hk_view *view, const spring *s, double h) {
  p->held = view->model->id[s->i];
  p->touched = 1;
  for (int c = 0; c < 3; c++) {
    p->F[c] = 0; /* the hold has just begun to grow */
    p->x[c] = view->x[3 * s->i + c] - h * view->v[3 * s->i + c];
  }
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  pull *p = self;
  spring s;
  double F[3];
  if (!p->hand || !hand_spring(p, view, &s)) {
    p->held = 0;
    return HK_OK;
  }
  if (p->held != view->model->id[s.i]) begin_hold(p, view, &s, h);
  force_of(&s, view, F);
  for (int c = 0; c < 3; c++) {
    double x = view->x[3 * s.i + c];
    p->work += (F[c] + p->F[c]) / 2 * (x - p->x[c]);
    p->F[c] = F[c];
    p->x[c] = x;
  }
  return HK_OK;
}

static bool moved(const void *self, double *work) {
  const pull *p = self;
  *work = p->work;
  return p->touched != 0;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_POWER | HK_SYMMETRIC_JACOBIAN | HK_PERIODIC,
    .add = add,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound, .longest_step = longest_step),
                        HK_STEPS_FACET(.accepted = accepted), HK_BY_HAND_FACET(.moved = moved)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "pull",
    .summary = "pulls particles to a point that may move, F = k (target - x) - damping v; also the user's hand",
    .reference = "Witkin, Particle System Dynamics, Physically Based Modeling, SIGGRAPH course notes, 1997",
    .instance_size = sizeof(pull),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
