/* A rigid obstacle that particles bounce from, slide along and come to rest on. Impacts are found inside the step, on
 * the particle's path, and obey w' = w - (1 + e) (w.n) n - min(mu (1 + e) |w.n|, |w_t|) w_t/|w_t| in the frame of the
 * obstacle, which moves as `position` and `rotation` say; see plugins/common/obstacles/obstacle.h for the method. All
 * obstacles of a scene are handled together, when the last of them is called. Their work is reported, so that a ball
 * that loses half its energy in a bounce is in balance. A step with more impacts than can be counted, such as between
 * plates that close, is taken back; where shorter steps do not help, the run ends.
 *
 * Particles that constraints join are bodies, and what joins two of them is an edge: common/obstacles/body_obstacles.h
 * has their law, all of them together. Of a rigid body the points of its surface meet obstacles (body:surface()), and
 * not the particles that have its mass. They come after the particles on their own.
 *
 * Forces besides are the method's: where an implicit step is much longer than the period of stiff springs, contact
 * belongs into the step, as the force `penalty` has it. */
#include "plugins/common/contact/bodies/body_arms.h"
#include "plugins/common/obstacles/body_obstacles.h"
#include "plugins/common/obstacles/obstacle_params.h"
#include "plugins/common/obstacles/obstacles_service.h"

enum { GRAIN = 1024, MOST_DIVISIONS = 8 /* of 12 that the host allows */ };

static const double worth_saying = 1e-6; /* m, as the verdict has it of constraints */

/* Parts of the step: a landing is at its end from here on; so far beyond the landing, as the path is known, the
 * repeated step ends. What is left of that after the landing has the acceleration from before it, and so has that part
 * of its error. */
static const double at_end = 1 - 1e-4, beyond = 1e-5;

typedef struct chunk_result {
  double work, depth;              /* J, m */
  size_t deepest, slider, endless; /* indices; SIZE_MAX: none. Of the deepest; of one on a sliding pin */
  double landing;                  /* the first, as a part of the step; 1: none */
  size_t landings;
  bool changed;
} chunk_result;

typedef struct obstacle {
  hk_obstacle_params params;
  double restitution, rolling, spinning;
  int64_t divide;
  int64_t divisions;     /* of the step that ends at `divided` */
  double divided, whole; /* s; its length */
  hk_array history;      /* hk_pose[HK_POSES] */
  int64_t warned;        /* of a particle that came to be inside during the run */
  hk_obstacle obstacle;
  hk_surface surface;
  hk_tuples edges;
  hk_body_obstacles bodies; /* of the last obstacle of a scene alone */
  const hk_obstacles *all;
  chunk_result *result;
  size_t results;
  const hk_host *host;
} obstacle;

static const hk_param params[] = {
    HK_OBSTACLE_PARAM_ROWS(obstacle),
    {"restitution", "", "e, the part of the normal speed that an impact leaves", .number = HK_AT(obstacle, restitution),
     .limits = HK_WITHIN(0, 1)},
    {"rolling", "m",
     "rolling friction of round rigid bodies: a moment of at most so much times the normal force is against their "
     "rolling",
     .number = HK_AT(obstacle, rolling), .limits = HK_WITHIN(0, 1e6)},
    {"spinning", "m", "the same against their spinning about the normal", .number = HK_AT(obstacle, spinning),
     .limits = HK_WITHIN(0, 1e6)},
    {"divide", "",
     "a step in which at most so many particles land is divided at the landing, so that forces are evaluated "
     "anew after it; with more, they are taken from the path before, of order 1 where they change with the velocity",
     .integer = HK_AT(obstacle, divide), .initial = {4}, .limits = HK_WITHIN(0, 1e9)},
    {"edges", "",
     "pairs of particles between which the obstacles of the scene do not come either, such as springs; "
     "those that bars, cables and welds join are kept out without being named",
     .edges = HK_AT(obstacle, edges), .flags = HK_OPTIONAL},
    {0},
};

static const hk_field fields[] = {
    {"history", .array = HK_AT(obstacle, history), .width = sizeof(hk_pose), .flags = HK_COUNTED},
    {"force", .per_particle = HK_AT(obstacle, bodies.force), .width = 3},
    {"warned", .integer = HK_AT(obstacle, warned)},
    {"divisions", .integer = HK_AT(obstacle, divisions)},
    {"divided", .number = HK_AT(obstacle, divided)},
    {"whole", .number = HK_AT(obstacle, whole)},
    {0},
};

static hk_status check_enclosed(const obstacle *s, const hk_view *view) {
  hk_enclosed_obstacle found;
  hk_status status = hk_obstacle_enclosed(&s->obstacle, s->host, view, &found);
  if (status != HK_OK || !found.body.found || view->t > 0) return status;
  return s->host->fail(
      s->host, HK_BAD_PARAM,
      "the obstacle starts inside of a rigid body: its point (%g, %g, %g) m is %.3g m below the body's "
      "surface (particle %u), and nothing would bring it out; start them apart",
      found.point[0], found.point[1], found.point[2], found.body.depth, view->model->id[found.body.particle]);
}

/* What moves on its own comes out in the first step; a rigid body would be turned by that. */
static hk_status check_start(const obstacle *s, const hk_view *view) {
  hk_inside found = hk_obstacle_inside(&s->obstacle, view);
  if (found.count == 0) return check_enclosed(s, view);
  uint32_t id = view->model->id[found.deepest];
  if (view->model->pin[found.deepest] == HK_PIN_RIDES && found.depth > worth_saying && view->t <= 0)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "a rigid body starts inside the obstacle, by up to %.3g m at its particle %u: no law says "
                         "where it belongs; start it outside, or farther away by its radius",
                         found.depth, id);
  s->host->warn(s->host,
                "%zu particles start inside the obstacle, by up to %.3g m (particle %u): the first step puts them on "
                "its surface, which no force does; start them outside",
                found.count, found.depth, id);
  return check_enclosed(s, view);
}

static hk_status topology(void *self, const hk_view *view) {
  obstacle *s = self;
  s->host->release(s->host, s->result);
  s->results = (view->n + GRAIN - 1) / GRAIN;
  s->result = s->host->allocate(s->host, (s->results + 1) * sizeof *s->result);
  if (!s->result) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_body_obstacles_topology(&s->bodies);
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  obstacle *s = self;
  s->host = host;
  s->obstacle.restitution = s->restitution;
  s->obstacle.rolling = s->rolling;
  s->obstacle.spinning = s->spinning;
  hk_status status = hk_obstacle_open(&s->obstacle, &s->surface, &s->params, host, view);
  if (status == HK_OK) status = host->resize(host, &s->history, HK_POSES);
  if (status != HK_OK) return status;
  hk_pose now = hk_obstacle_pose(&s->params, view->t);
  hk_motion_begin(s->history.item, &now);
  hk_motion_of(&s->obstacle.motion, s->history.item);
  status = check_start(s, view);
  if (status != HK_OK) return status;
  if (s->obstacle.friction > 0) hk_body_warn_of_arms(host, view, s->obstacle.radius);
  s->all = host->query(host, HK_OBSTACLES_INTERFACE);
  if (!s->all) return HK_FAILED;
  s->obstacle.edges = s->edges.count ? &s->edges : NULL;
  status = hk_body_obstacles_open(&s->bodies, host, s->all->set);
  if (status == HK_OK) status = s->all->enter(s->all->self, &s->obstacle);
  return status == HK_OK ? topology(self, view) : status;
}

static const chunk_result nothing = {.deepest = SIZE_MAX, .slider = SIZE_MAX, .endless = SIZE_MAX, .landing = 1};

typedef struct task {
  const obstacle *self;
  const hk_view *view;
  hk_correction *c;
} task;

static void meet(const task *t, size_t i, chunk_result *r) {
  hk_correction *c = t->c;
  const hk_model *model = t->view->model;
  hk_obstacle_step step = {.i = i, .h = c->h, .mass = model->mass[i]};
  step.x_from = c->x_before + 3 * i;
  step.v_from = c->v_before + 3 * i;
  step.x = c->x + 3 * i;
  step.v = c->v + 3 * i;
  if (!hk_obstacles_near(t->self->all->set, &step)) return;
  hk_obstacles_meet(t->self->all->set, &step);
  if (step.endless) r->endless = i;
  if (step.landing < at_end) {
    r->landings++;
    r->landing = fmin(r->landing, step.landing);
  }
  if (!step.changed) return;
  r->changed = true;
  r->work += step.work;
  if (model->pin[i] != HK_FREE) r->slider = i;
  if (step.depth > r->depth) r->depth = step.depth, r->deepest = i;
}

static void meet_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  chunk_result *r = &t->self->result[chunk];
  *r = nothing;
  bool near[GRAIN];
  hk_obstacles_sift(t->self->all->set, &(hk_obstacle_moves){t->c->h, t->c->x_before, t->c->v_before, t->c->x, t->c->v},
                    begin, end, near);
  const bool *elsewhere = t->self->bodies.features ? t->self->bodies.taken : NULL;
  const hk_model *model = t->view->model;
  for (size_t i = begin; i < end; i++)
    if (near[i - begin] && model->inverse_mass[i] > 0 && hk_model_touches(model, i) && !(elsewhere && elsewhere[i]) &&
        !hk_obstacle_set_carried(t->self->all->set, i))
      meet(t, i, r);
}

static void warn_of_depth(obstacle *s, const hk_view *view, const chunk_result *all, double h) {
  bool start = s->warned == 0 && view->t - h <= 0;
  if (!(all->depth > worth_saying) || s->warned || start) return;
  s->warned = 1;
  s->host->warn(s->host,
                "particle %u was inside an obstacle by %.3g m before t = %g s (born there, or moved by a pin or a "
                "constraint): it was put on the surface",
                view->model->id[all->deepest], all->depth, view->t);
}

/* Whether the step is to end where the first particle lands. */
static bool divides(obstacle *s, const hk_view *view, double h, const chunk_result *all) {
  if (all->landings == 0 || all->landings > (size_t)s->divide) return false;
  if (view->t > s->divided) {
    s->divided = view->t;
    s->divisions = 0;
    s->whole = h;
  }
  if (h < (1 - at_end) * s->whole) return false;
  return s->divisions++ < MOST_DIVISIONS;
}

static chunk_result sum_of(const obstacle *s) {
  chunk_result all = nothing;
  for (size_t k = 0; k < s->results; k++) {
    const chunk_result *r = &s->result[k];
    all.work += r->work;
    all.changed |= r->changed;
    all.landings += r->landings;
    all.landing = fmin(all.landing, r->landing);
    if (r->slider < all.slider) all.slider = r->slider;
    if (r->endless < all.endless) all.endless = r->endless;
    if (r->depth > all.depth) all.depth = r->depth, all.deepest = r->deepest;
  }
  return all;
}

/* What bodies do joins what particles on their own have done. Returns the part of the step at which it is to end where
 * something lands. */
static double join(chunk_result *all, const hk_body_landing *bodies) {
  double particles = all->landing + beyond;
  if (bodies->depth > all->depth) all->depth = bodies->depth, all->deepest = bodies->deepest;
  bool first = bodies->landings && bodies->part < particles;
  all->landings += bodies->landings;
  all->landing = fmin(all->landing, bodies->part);
  return first ? bodies->part : particles;
}

static hk_status collect(obstacle *s, const hk_view *view, hk_correction *c) {
  const hk_obstacle_moves moves = {c->h, c->x_before, c->v_before, c->x, c->v};
  hk_body_landing bodies = {.part = 1};
  chunk_result all = sum_of(s);
  if (all.slider < SIZE_MAX)
    return s->host->fail(
        s->host, HK_FAILED,
        "particle %u slides on a pin and meets an obstacle at t = %g s: the law of impact is for particles "
        "that are free; keep it away from the obstacle",
        view->model->id[all.slider], view->t);
  hk_status status = s->bodies.features ? hk_body_obstacles_find(&s->bodies, &moves, &bodies) : HK_OK;
  if (status != HK_OK) return status;
  double part = join(&all, &bodies);
  warn_of_depth(s, view, &all, c->h);
  c->reject = all.endless < SIZE_MAX;
  if (!c->reject && !c->last && divides(s, view, c->h, &all)) {
    c->reject = true;
    c->part = part;
  }
  c->changed = all.changed;
  c->work = all.work;
  return c->reject || !s->bodies.features ? HK_OK : hk_body_obstacles_solve(&s->bodies, view, c);
}

static hk_status correct(void *self, const hk_view *view, hk_correction *c) {
  obstacle *s = self;
  const hk_obstacle_set *set = s->all->set;
  hk_pose now = hk_obstacle_pose(&s->params, view->t);
  hk_motion_advance(s->history.item, view->t - c->h, &now);
  hk_motion_of(&s->obstacle.motion, s->history.item);
  hk_obstacle_take_radii(&s->obstacle, &s->params, view);
  if (set->member[set->count - 1] != &s->obstacle) return HK_OK;
  hk_status status = hk_body_obstacles_begin(&s->bodies, view);
  if (status != HK_OK) return status;
  task t = {s, view, c};
  s->host->parallel_for(s->host, view->n, GRAIN, meet_chunk, &t);
  return collect(s, view, c);
}

static double violation(void *self, const hk_view *view) {
  const obstacle *s = self;
  return fmax(hk_obstacle_inside(&s->obstacle, view).depth, hk_body_obstacles_depth(&s->bodies, view));
}

/* What rests on the obstacle, or slides: rounding apart. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const obstacle *s = self;
  double n[3], at[3];
  for (size_t i = 0; i < view->n; i++) {
    const double *x = view->x + 3 * i;
    double gap = hk_obstacle_gap(&s->obstacle, &s->obstacle.motion.end, x, i, n);
    if (!hk_model_touches(view->model, i) || !(gap <= hk_obstacle_rounding(&s->obstacle, x, x, i))) continue;
    for (int c = 0; c < 3; c++) at[c] = x[c] - hk_obstacle_radius(&s->obstacle, i) * n[c];
    points->add(points->context, at, n);
  }
}

static void mean_forces(const void *self, const hk_view *view, double *F) {
  const obstacle *s = self;
  for (size_t e = 0; e < 3 * view->n && s->bodies.features; e++) F[e] += s->bodies.force[e];
}

static const hk_corrector corrector = {.size = sizeof(hk_corrector),
                                       .flags = HK_WANTS_BEFORE | HK_REPORTS_WORK | HK_MAY_REJECT | HK_TAKES_BODIES,
                                       .correct = correct,
                                       .violation = violation,
                                       .contact_points = contact_points,
                                       .mean_forces = mean_forces};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_CORRECTOR,
    .name = "obstacle",
    .summary =
        "a rigid obstacle: impacts inside the step, w' = w - (1 + e) (w.n) n with Coulomb's friction, and contact",
    .reference =
        "Moreau 1988, Unilateral contact and dry friction in finite freedom dynamics; Brogliato 2016, Nonsmooth "
        "Mechanics, chapters 2 and 4",
    .instance_size = sizeof(obstacle),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .corrector = &corrector,
};
