/* The pipeline of Bridson, Fedkiw and Anderson 2002 in its order, to compare with the corrector `contact`. From the
 * positions before the step and those after it, whatever made them,
 *   1. the mean velocities u = (x_1 - x_0)/h of the step;
 *   2. proximity at x_0: what is nearer than its thickness is stopped and pushed apart, with friction (section 6);
 *   3. collisions on the way x_0 to x_0 + h u: sweeps of impulses, each after a new search (section 7.1);
 *   4. what still collides moves as rigid bodies, which grow until nothing does (section 7.3);
 *   5. x_1 = x_0 + h u, and v_1 changes as u did: the half step of forces that follows in the paper is the one that v_1
 *      has already.
 * Collisions are those of the narrow phase, which is proved; the paper's has a tolerance instead. A step whose
 * zones hold pinned particles that do not move as one rigid body is taken back.
 *
 * Beside `contact` it takes 1.3 times as long and makes three times the energy in the sheet that is wound up
 * (contact.c): 1.58 of the largest kinetic energy, where that makes 0.50.
 */
#include "plugins/common/contact/impulses/impulse_contact.h"
#include "plugins/common/contact/impulses/proximity.h"
#include "plugins/common/contact/impulses/zones.h"

#include <string.h>

enum { MOST_GROWTHS = 200 /* of the zones in a step */ };

typedef struct impact_zones {
  hk_impulse_contact base;
  double stiffness;
  hk_zones zones;
  double *u;     /* n x 3, m/s: mean velocities */
  double *x, *v; /* n x 3: the end without zones */
} impact_zones;

static const hk_param params[] = {
    HK_CONTACT_PARAM_ROWS(hk_impulse_contact),
    {"restitution", "", "e, the part of the normal speed that a collision leaves",
     .number = HK_AT(hk_impulse_contact, restitution), .limits = HK_WITHIN(0, 1)},
    {"stiffness", "N/m",
     "k, of the repulsion of what is nearer than its thickness; the paper takes that of the stretch springs",
     .number = HK_AT(impact_zones, stiffness), .initial = {1e3}, .limits = HK_WITHIN(0, 1e30)},
    {"sweeps", "", "of impulses over the collisions of a step, each after a new search, before zones become rigid",
     .integer = HK_AT(hk_impulse_contact, sweeps), .initial = {5}, .limits = HK_WITHIN(0, 1e6)},
    {0},
};

static const hk_field fields[] = {
    HK_IMPULSE_CONTACT_FIELDS,
    {0},
};

static hk_status topology(void *self, const hk_view *view) {
  impact_zones *s = self;
  const hk_host *host = s->base.host;
  double **room[] = {&s->u, &s->x, &s->v};
  for (int k = 0; k < 3; k++) {
    host->release(host, *room[k]);
    *room[k] = host->allocate(host, (3 * view->n + 1) * sizeof **room[k]);
    if (!*room[k]) return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  }
  hk_status status = hk_zones_open(&s->zones, host, view->n);
  return status == HK_OK ? hk_impulse_contact_topology(&s->base, view) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  impact_zones *s = self;
  hk_status status = hk_impulse_contact_create(&s->base, "impact_zones", host, view);
  return status == HK_OK ? topology(self, view) : status;
}

typedef struct step {
  impact_zones *s;
  hk_correction *c;
  size_t n;
  hk_step_move move; /* to s->x with s->v */
  hk_proximity law;
} step;

/* The end that the mean velocities u lead to. Where they are those of the free step it is its end, to the bit. */
static void find_end(const step *p) {
  const impact_zones *s = p->s;
  for (size_t i = 0; i < 3 * p->n; i++) {
    double change = s->u[i] - (p->c->x[i] - p->c->x_before[i]) / p->c->h;
    s->x[i] = p->c->x[i] + p->c->h * change;
    s->v[i] = p->c->v[i] + change;
  }
}

static hk_status find_candidates(const step *p) {
  hk_status status = hk_pair_cache_find(&p->s->base.cache, p->move.x_from, p->move.x);
  return status == HK_OK ? hk_contact_candidates_find(&p->s->base.candidates, &p->move) : status;
}

static hk_status repel(const step *p) {
  hk_contact_solver closed = {0};
  hk_status status = hk_contact_candidates_impacts(&p->s->base.candidates, &p->move, HK_CANDIDATES_CLOSED, &closed);
  if (status != HK_OK || closed.count == 0) return status;
  double impulse = hk_proximity_repel(&p->law, &closed, p->s->u);
  if (impulse == 0) return HK_OK;
  p->s->base.last.impulse += impulse;
  p->c->changed = true;
  find_end(p);
  return find_candidates(p);
}

static hk_status collide(const step *p) {
  hk_status status = HK_OK;
  hk_contact_solver unsafe = {0};
  for (int64_t k = 0; k < p->s->base.sweeps && p->s->base.candidates.unsafe > 0 && status == HK_OK; k++) {
    status = hk_contact_candidates_impacts(&p->s->base.candidates, &p->move, HK_CANDIDATES_UNSAFE, &unsafe);
    if (status != HK_OK) return status;
    p->s->base.last.impulse += hk_proximity_collide(&p->law, &unsafe, p->s->u);
    p->c->changed = true;
    find_end(p);
    status = find_candidates(p);
  }
  return status;
}

/* Zones always move from the end that u leads to. */
static hk_status make_rigid(const step *p, const hk_view *view) {
  impact_zones *s = p->s;
  hk_status status = HK_OK;
  hk_zones_move move = {p->c->h, view->model->mass, p->c->x_before, s->x, s->v, view->model->inverse_mass};
  hk_contact_solver unsafe = {0};
  hk_zones_clear(&s->zones);
  for (int k = 0; k < MOST_GROWTHS && s->base.candidates.unsafe > 0 && status == HK_OK; k++) {
    status = hk_contact_candidates_impacts(&s->base.candidates, &p->move, HK_CANDIDATES_UNSAFE, &unsafe);
    if (status != HK_OK) return status;
    hk_zones_merge(&s->zones, &unsafe);
    p->c->changed = true;
    find_end(p);
    if (!hk_zones_apply(&s->zones, &move)) return HK_OK;
    status = find_candidates(p);
  }
  return status;
}

static hk_status run_pipeline(const step *p, const hk_view *view) {
  impact_zones *s = p->s;
  for (size_t i = 0; i < 3 * p->n; i++) s->u[i] = (p->c->x[i] - p->c->x_before[i]) / p->c->h;
  find_end(p);
  hk_status status = find_candidates(p);
  if (status == HK_OK) status = repel(p);
  if (status == HK_OK) status = collide(p);
  return status == HK_OK && s->base.candidates.unsafe > 0 ? make_rigid(p, view) : status;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  impact_zones *s = self;
  const double *inverse_mass = view->model->inverse_mass;
  step p = {.s = s, .c = c, .n = view->n};
  p.move = (hk_step_move){c->h, c->x_before, c->v_before, s->x, s->v, inverse_mass};
  p.law = (hk_proximity){c->h, s->stiffness, s->base.params.friction, s->base.restitution, inverse_mass};
  hk_impulse_contact_begin(&s->base, view, c);
  hk_status status = run_pipeline(&p, view);
  if (status != HK_OK) return status;
  c->reject = s->base.candidates.unsafe > 0;
  if (c->changed) {
    hk_impulse_contact_keep_free(&s->base, view, c);
    memcpy(c->x, s->x, 3 * view->n * sizeof *c->x);
    memcpy(c->v, s->v, 3 * view->n * sizeof *c->v);
  }
  hk_impulse_contact_end(&s->base, view, c, s->x);
  return HK_OK;
}

/* What the next step's repulsion would act on. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const impact_zones *s = self;
  hk_pair_cache_points(&s->base.cache, view->x, 0, points);
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_REPORTS_WORK | HK_MAY_REJECT,
                                       .correct = correct,
                                       .contacts = hk_impulse_contact_report,
                                       .contact_points = contact_points};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "impact_zones",
    .summary = "contact by proximity repulsion, impulses of collisions, and rigid impact zones, in this order",
    .reference = "Bridson, Fedkiw and Anderson 2002, Robust treatment of collisions, contact and friction for cloth "
                 "animation, sections 4 to 7",
    .instance_size = sizeof(impact_zones),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
