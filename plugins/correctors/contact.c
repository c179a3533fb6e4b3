/* Contact of surfaces, never passed: after each step a narrow phase examines the candidate pairs. Where a gap would
 * close, impulses along the normals, and Coulomb's friction across them, bring the step back to its law of impact
 * (plugins/common/contact/impulses/impact.h), all impacts of a step together, from the impulses of the last step on
 * (gauss_seidel.h, warm_start.h), until every pair is proved to have stayed apart on its way (contact_candidates.h). A
 * step of which that cannot be proved is taken back and halved. Pairs that are far, and most of those that are near,
 * cost nothing in most steps (pair_cache.h).
 *
 * What lies still comes to rest: sweeps go on where nothing moves (hk_gauss_seidel_calm), and pairs of the last step
 * whose gaps are below what sweeps leave are contact that lasts (hk_impact_last). The speeds fall below 1e-11 m/s for
 * ten layers of 5 x 5 particles; they kept 2e-8 where errors of 1e-13 m told impacts from rest. Wider layers need more
 * than 100 sweeps a step and keep more: ten of 9 x 9 (stack.lua) had 1e-6 m/s before that, and were not measured since.
 * It is one tolerance for all of a scene: a heap beside something that touches and moves keeps speeds of some 1e-4 m/s.
 *
 * Where several bodies hit each other in one step, the law of impact holds for every pair by its own speeds before;
 * chains of impacts (a row of balls) are not determined by restitution alone. A particle that bounces and hits a
 * surface again in the same step would lose bounces: where it moves by more than about half of the thickness in
 * a step, the step is taken back and halved, and where no halves are short enough, the run ends. Slower particles
 * lose less than that.
 *
 * Particles that constraints join are bodies: their impulses and multipliers are solved together, and positions are
 * brought onto the equations before pairs are examined again (contact/bodies/body_impacts.h). Where they bounce, a step
 * is cut at the landing. Rigid bodies are such bodies, and their surface is what body:surface() names.
 *
 * Beside it, the force `repulsion` pushes before surfaces touch: methods of high order keep their accuracy with it, and
 * this corrector the last word. By itself the corrector is accurate to order 1 while contact lasts, as positions are
 * brought back at the ends of steps, and of order 2 in impacts that are apart.
 *
 * The cheapest of the four that keep surfaces apart. A sheet that is wound up for 0.6 s takes it 2.1 s of one thread of
 * a Xeon and 1,379 steps of an explicit method, impact_zones 2.7 s, the force `barrier` 6.1 s and 75 implicit steps,
 * the force `repulsion` 60 s for 0.43 s of it, 38,796 steps (hooke run scripts/scenes/twist.lua contact=impulses,
 * zones, barrier, force --until 0.6 --no-output --threads 1).
 */
#include "plugins/common/contact/bodies/body_impacts.h"
#include "plugins/common/contact/faces/face_contacts.h"
#include "plugins/common/contact/bodies/surface_arms.h"
#include "plugins/common/contact/impulses/impulse_contact.h"
#include "plugins/common/contact/impulses/warm_start.h"
#include "plugins/kit/vector3.h"

#include <string.h>

enum {
  ROUNDS = 6 /* of solutions and narrow phases in a step */,
  FACES = 4 /* of these with corners of faces alone */,
  MOST_DIVISIONS = 5 /* of 12 that the host allows */
};

/* Of the thickness: gaps may be closed by so much at the end of a step; what sweeps leave; what they leave where
 * nothing moves; and of bodies, which have fewer impacts. */
static const double slack = 0.01, left_by_sweeps = 1e-4, left_at_rest = 1e-12, left_by_bodies = 1e-5;

/* Of the thickness: what gaps between two faces may be off a plane, so that their corners stand for all. */
static const double flat = 1e-5;

/* Of the distance at which bodies touch: an overlap that is none of a thickness. */
static const double overlapping = 0.1;

/* Processor time so far, s, for benchmarks, which find it by the names of fields. */
typedef struct contact_times {
  double all, pairs, narrow_phase, impulses; /* all of it; hk_pair_cache_find, with its searches; solve */
} contact_times;

typedef struct contact {
  hk_impulse_contact base;
  hk_body_impacts bodies; /* particles that constraints join */
  double rolling, spinning;
  int64_t began;     /* the first step was examined */
  int64_t divisions; /* of the step that ends at `divided`, s */
  double divided;
  uint64_t *moved, *touched, now; /* for gauss_seidel.h */
  hk_awake awake;
  hk_array known; /* hk_warm_pair: the impulses of the last step */
  double *force;  /* n x 3, N: the mean of the last step's impulses, where there are bodies */
  contact_times seconds;
} contact;

static const hk_param params[] = {
    HK_CONTACT_PARAM_ROWS(hk_impulse_contact),
    {"restitution", "", "e, the part of the normal speed that an impact leaves",
     .number = HK_AT(hk_impulse_contact, restitution), .limits = HK_WITHIN(0, 1)},
    {"rolling", "m",
     "rolling friction of rigid bodies: a moment of at most so much times the normal force is against their rolling on "
     "each other and on what is pinned",
     .number = HK_AT(contact, rolling), .limits = HK_WITHIN(0, 1e6)},
    {"spinning", "m", "the same against their spinning about the normal", .number = HK_AT(contact, spinning),
     .limits = HK_WITHIN(0, 1e6)},
    {"sweeps", "", "over the impacts of a step, at most; fewer where they change nothing more",
     .integer = HK_AT(hk_impulse_contact, sweeps), .initial = {100}, .limits = HK_WITHIN(1, 1e9)},
    {0},
};

static const hk_field fields[] = {
    HK_IMPULSE_CONTACT_FIELDS,
    {"began", .integer = HK_AT(contact, began)},
    {"known", .array = HK_AT(contact, known), .width = sizeof(hk_warm_pair)},
    {"force", .per_particle = HK_AT(contact, force), .width = 3},
    {"divisions", .integer = HK_AT(contact, divisions)},
    {"divided", .number = HK_AT(contact, divided)},
    {"seconds", .number = HK_AT(contact, seconds.all), .flags = HK_SCRATCH},
    {"seconds_of_pairs", .number = HK_AT(contact, seconds.pairs), .flags = HK_SCRATCH},
    {"seconds_of_searches", .number = HK_AT(hk_impulse_contact, cache.seconds), .flags = HK_SCRATCH},
    {"seconds_of_narrow_phase", .number = HK_AT(contact, seconds.narrow_phase), .flags = HK_SCRATCH},
    {"seconds_of_impulses", .number = HK_AT(contact, seconds.impulses), .flags = HK_SCRATCH},
    {0},
};

static hk_status open_particles(contact *s, const hk_view *view) {
  const hk_host *host = s->base.host;
  host->release(host, s->moved);
  host->release(host, s->touched);
  s->moved = host->allocate(host, (view->n + 1) * sizeof *s->moved);
  s->touched = host->allocate(host, (view->n + 1) * sizeof *s->touched);
  if (!s->moved || !s->touched) return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_awake_open(&s->awake, host, view->n);
  if (status != HK_OK) return status;
  hk_body_impacts_topology(&s->bodies);
  /* Bodies that lie on each other fall together in the step before its impulses: their contacts do not close in it. */
  s->base.cache.reach = view->model->riders > 0 ? slack * hk_contact_scale(&s->base.params) : 0;
  return hk_impulse_contact_topology(&s->base, view);
}

static hk_status topology(void *self, const hk_view *view) {
  contact *s = self;
  hk_status status = s->base.host->resize(s->base.host, &s->known, 0);
  return status == HK_OK ? open_particles(s, view) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  contact *s = self;
  hk_status status = hk_impulse_contact_create(&s->base, "contact", host, view);
  s->base.candidates.slack = slack * hk_contact_scale(&s->base.params);
  if (status == HK_OK) status = hk_body_impacts_open(&s->bodies, host);
  if (status == HK_OK && s->base.params.friction > 0) hk_body_warn_of_arms(host, view, s->base.params.radius);
  return status == HK_OK ? open_particles(s, view) : status;
}

static hk_status refuse_slides(const contact *s, const hk_view *view, const hk_contact_solver *all) {
  for (size_t e = 0; e < all->count; e++)
    for (int i = 0; i < 4; i++) {
      uint32_t k = all->impact[e].pair.vertex[i];
      bool slides = view->model->pin[k] == HK_PIN_LINE || view->model->pin[k] == HK_PIN_PLANE;
      if (slides && all->impact[e].frame.w[i] != 0 && all->impact[e].place.push > 0)
        return s->base.host->fail(
            s->base.host, HK_FAILED,
            "particle %u slides on a pin and meets a surface at t = %g s: the law of impact is for "
            "particles that are free; keep it away, or name it in `leave`",
            view->model->id[k], view->t);
    }
  return HK_OK;
}

/* The impacts of bodies as they are solved. */
static hk_status prepare_bodies(contact *s, const hk_step_move *move, bool faces, hk_contact_solver *solver) {
  const hk_surface_mesh *mesh = s->base.surfaces->mesh(s->base.surfaces->self);
  hk_status status = HK_OK;
  if (faces)
    status = hk_face_contacts_reduce(&s->bodies, mesh, move, flat * hk_contact_scale(&s->base.params), solver,
                                     s->base.candidates.chosen);
  if (status == HK_OK) status = hk_surface_arms_find(&s->bodies, mesh, solver, move);
  return status == HK_OK ? hk_surface_moments_find(&s->bodies, solver, move, s->rolling, s->spinning) : status;
}

/* Whether no surface that is met moves on a path, so that impacts may not add to the kinetic energy. */
static bool paths_stand_still(const hk_model *model, const hk_contact_solver *all, const hk_step_move *move) {
  for (size_t e = 0; e < all->count; e++)
    for (int i = 0; i < 4; i++) {
      size_t k = all->impact[e].pair.vertex[i];
      bool held = !hk_model_moves(model, (uint32_t)k) && model->pin[k] != HK_PIN_RIDES;
      if (!held || all->impact[e].frame.w[i] == 0) continue;
      if (hk_length(move->v_from + 3 * k) > 0 || hk_length(move->v + 3 * k) > 0) return false;
    }
  return true;
}

static hk_status solve(contact *s, const hk_view *view, hk_correction *c, hk_step_move *move, bool faces) {
  double begin = hk_own_time();
  hk_contact_solver solver = {.friction = s->base.params.friction, .most = (size_t)s->base.sweeps};
  solver.moved = s->moved, solver.touched = s->touched, solver.now = s->now, solver.awake = &s->awake;
  bool single = s->bodies.count == 0, first = !s->base.candidates.solved;
  solver.tolerance = (single ? left_by_sweeps : left_by_bodies) * hk_contact_scale(&s->base.params);
  if (!c->changed) hk_impulse_contact_keep_free(&s->base, view, c);
  hk_status status = hk_contact_candidates_impacts(&s->base.candidates, move, HK_CANDIDATES_ALL, &solver);
  if (status != HK_OK) return status;
  hk_gauss_seidel_result done = {0};
  s->bodies.t = view->t;
  s->bodies.keeps_energy = !single && paths_stand_still(view->model, &solver, move);
  bool bounces = !single && s->base.restitution > 0; /* the last impulses are no guess of these */
  if (single) hk_gauss_seidel_calm(&solver, move->h, left_at_rest * hk_contact_scale(&s->base.params));
  if (first && !bounces) hk_warm_start_give(&s->known, &solver, move, !single);
  if (!single) status = prepare_bodies(s, move, faces, &solver);
  if (status != HK_OK) return status;
  if (single) status = hk_awake_list(&s->awake, solver.impact, solver.count, move->inverse_mass);
  if (status != HK_OK) return status;
  if (single)
    done = hk_gauss_seidel(&solver, move);
  else
    status = hk_body_gauss_seidel(&s->bodies, &solver, move, &done);
  if (status != HK_OK) return status;
  s->base.candidates.touched = single ? s->touched : NULL; /* constraints move more than impacts touch */
  s->base.candidates.since = s->now;
  s->now = solver.now;
  hk_contact_candidates_remember(&s->base.candidates, &solver);
  if (first) status = hk_warm_start_keep(&s->known, s->base.host, &solver, move->h);
  if (status != HK_OK) return status;
  c->changed |= done.pushing > 0;
  s->base.last.impulse += done.impulse;
  if (!single) hk_impact_add_forces(solver.impact, solver.count, c->h, s->force);
  s->seconds.impulses += hk_own_time() - begin;
  return c->filter ? refuse_slides(s, view, &solver) : HK_OK;
}

static hk_status find_candidates(contact *s, hk_step_move *move) {
  double begin = hk_own_time();
  hk_status status = hk_pair_cache_find(&s->base.cache, move->x_from, move->x);
  double between = hk_own_time();
  if (status == HK_OK) status = hk_contact_candidates_find(&s->base.candidates, move);
  s->seconds.pairs += between - begin;
  s->seconds.narrow_phase += hk_own_time() - between;
  return status;
}

/* Whether both sides are of rigid bodies, or pinned, so that nothing gives way. */
static bool is_rigid(const hk_model *m, const hk_feature_pair *pair) {
  bool rigid = true;
  for (int i = 0; i < 4; i++) rigid &= m->pin[pair->vertex[i]] == HK_PIN_RIDES || !hk_model_moves(m, pair->vertex[i]);
  return rigid;
}

/* What starts nearer than its thickness is opened without a speed, so that no energy shows it. Rigid bodies that
 * overlap by more than a tenth of their distance, such as balls in each other, are refused. */
static hk_status check_start(contact *s, const hk_view *view, double h) {
  hk_closed_candidates closed = hk_contact_candidates_closed(&s->base.candidates);
  bool began = s->began;
  s->began = true;
  if (began || closed.count == 0) return HK_OK;
  hk_pair_names names = hk_pair_names_of(closed.pair, view->model->id);
  if (view->t - h <= 0 && closed.depth > fmax(s->base.params.thickness, overlapping * closed.pair->offset) &&
      is_rigid(view->model, closed.pair))
    return s->base.host->fail(s->base.host, HK_BAD_PARAM,
                              "rigid bodies overlap at the start, by %.3g m (%s and %s): start them apart by that, or "
                              "make thickness or radius smaller",
                              closed.depth, names.one, names.other);
  s->base.host->warn(
      s->base.host,
      "%zu pairs start nearer than their thickness, by up to %.3g m (%s and %s): every step opens such a gap "
      "by half of what is missing, which no force does; start them apart, or make thickness or radius smaller",
      closed.count, closed.depth, names.one, names.other);
  return HK_OK;
}

/* Where bodies bounce, a step ends at the first impact, so that the law holds at one instant: a body turns in what is
 * left of a step after it, and would gain or lose energy by that. *part: of the step; 1: it is taken as it is. */
static hk_status find_landing(contact *s, const hk_view *view, const hk_correction *c, const hk_step_move *move,
                              double *part) {
  hk_contact_solver all = {.count = 0};
  double slight = left_by_sweeps * hk_contact_scale(&s->base.params);
  *part = 1;
  if (s->bodies.count == 0 || !(s->base.restitution > 0) || c->last) return HK_OK;
  if (s->base.candidates.unsafe + s->base.candidates.unsolved == 0) return HK_OK;
  hk_status status = hk_contact_candidates_impacts(&s->base.candidates, move, HK_CANDIDATES_ALL, &all);
  for (size_t e = 0; e < all.count && status == HK_OK; e++) {
    const hk_impact *k = &all.impact[e];
    bool body = false, shows = -k->speed_then * (1 - k->part) * c->h > slight && k->part > 0;
    for (int i = 0; i < 4; i++)
      body |= k->frame.w[i] != 0 && s->bodies.bodies->of(s->bodies.bodies->self, k->pair.vertex[i]) != UINT32_MAX;
    if (body && shows) *part = fmin(*part, k->part - slight / (2 * k->speed_then * c->h)); /* just closed then */
  }
  if (view->t > s->divided) {
    s->divided = view->t;
    s->divisions = 0;
  }
  if (*part < 1 && s->divisions++ >= MOST_DIVISIONS) *part = 1;
  return status;
}

static hk_status keep_apart(contact *s, const hk_view *view, hk_correction *c) {
  hk_step_move move = {c->h, c->x_before, c->v_before, c->x, c->v, view->model->inverse_mass};
  const hk_contact_candidates *found = &s->base.candidates;
  hk_impulse_contact_begin(&s->base, view, c);
  uint64_t began = s->now;
  hk_status status = hk_body_impacts_begin(&s->bodies, view, false);
  if (s->bodies.count) memset(s->force, 0, 3 * view->n * sizeof *s->force);
  if (status == HK_OK) status = find_candidates(s, &move);
  if (status == HK_OK) status = check_start(s, view, c->h);
  if (status == HK_OK) status = find_landing(s, view, c, &move, &c->part);
  if (status != HK_OK) return status;
  c->reject = c->part < 1;
  if (!c->reject) c->part = 0;
  for (int round = 0; round < ROUNDS && found->unsafe + found->unsolved > 0; round++) {
    if (status != HK_OK || c->reject) break;
    status = solve(s, view, c, &move, round < FACES);
    if (status == HK_OK) status = find_candidates(s, &move);
    bool returns = s->base.restitution > 0 && hk_contact_candidates_return(found, s->moved, began);
    c->reject = returns && !(c->last && s->bodies.count); /* a body rocks in ever shorter bounces: there they end */
  }
  if (status != HK_OK) return status;
  c->reject |= found->unsafe > 0;
  hk_impulse_contact_end(&s->base, view, c, c->x);
  return HK_OK;
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  contact *s = self;
  double begin = hk_own_time();
  hk_status status = keep_apart(s, view, c);
  s->seconds.all += hk_own_time() - begin;
  return status;
}

/* Pairs whose gap is closed, but for what the end of a step may leave on either side. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const contact *s = self;
  hk_pair_cache_points(&s->base.cache, view->x, slack, points);
}

static void mean_forces(const void *self, const hk_view *view, double *F) {
  const contact *s = self;
  for (size_t e = 0; e < 3 * view->n && s->bodies.count; e++) F[e] += s->force[e];
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_REPORTS_WORK | HK_MAY_REJECT | HK_TAKES_BODIES,
                                       .correct = correct,
                                       .contacts = hk_impulse_contact_report,
                                       .contact_points = contact_points,
                                       .mean_forces = mean_forces};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "contact",
    .summary =
        "surfaces never pass each other: impulses by Newton's law of impact, v_n' = -e v_n, and Coulomb's friction",
    .reference =
        "Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Chen and others 2025, "
        "Offset geometric contact, section 3.4; Li, Kaufman and Jiang 2021, Codimensional incremental potential "
        "contact, section 5",
    .instance_size = sizeof(contact),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
