/* A soft obstacle: a force that grows with the depth d at which a particle of radius r is inside,
 *     F = N n - mu N u/sqrt(u^2 + s^2),   N = max(0, k d (1 - b w.n)),   d = max(0, r - distance)
 * with n the normal, w the velocity relative to the obstacle and u its part along the surface. Damping by the depth
 * (Hunt and Crossley 1975) is continuous when the particle touches; e is about 1 - 2/3 b v for slow impacts at v.
 * Friction is Coulomb's, made smooth below the speed s: a body on a slope creeps at up to s. The energy of the elastic
 * part is k d^2/2.
 *
 * Against the corrector of the name obstacle, whose contact is rigid: it acts within implicit steps and beside
 * constraints, and particles sink in by their weight over k. The blocks are central differences of one particle's
 * force, over 1e-6 of the obstacle and of the speeds. */
#include "plugins/common/obstacles/obstacle_params.h"
#include "plugins/common/obstacles/obstacles_service.h"
#include "plugins/common/obstacles/parabola.h"
#include "plugins/kit/parts/particle_sums.h"
#include "plugins/kit/vector3.h"

typedef struct penalty {
  hk_obstacle_params params;
  double k, damping, slip; /* N/m, s/m, m/s */
  double velocity[3], spin[3];
  hk_pose first;
  hk_obstacle obstacle;
  hk_surface surface;
  double scale; /* m, for differences */
} penalty;

static const hk_param params[] = {
    HK_OBSTACLE_PARAM_ROWS(penalty),
    {"k", "N/m", "stiffness of the contact", .number = HK_AT(penalty, k), .initial = {1e4},
     .limits = HK_WITHIN(0, 1e30), .flags = HK_TIMED},
    {"damping", "s/m", "b, of the normal speed; 1.5 (1 - e)/v for a restitution e at the speed v",
     .number = HK_AT(penalty, damping), .limits = HK_WITHIN(0, 1e6)},
    {"slip", "m/s", "s, the speed below which friction is smooth", .number = HK_AT(penalty, slip), .initial = {1e-3},
     .limits = HK_ABOVE_TO(0, 1e6)},
    {"velocity", "m/s", "of the obstacle, where `position` moves it", .vector = HK_AT(penalty, velocity),
     .flags = HK_TIMED},
    {"spin", "rad/s", "of the obstacle, where `rotation` turns it", .vector = HK_AT(penalty, spin), .flags = HK_TIMED},
    {0},
};

/* The obstacle of this evaluation, on the caller's stack: nothing of an evaluation outlives it. */
typedef struct contact {
  const penalty *self;
  const hk_view *view;
  hk_obstacle obstacle;
  hk_body_frame frame;
} contact;

static contact contact_at(const penalty *s, const hk_view *view) {
  contact c = {s, view, s->obstacle, hk_obstacle_frame(&s->params, view->t)};
  hk_copy(c.frame.velocity, s->velocity);
  hk_copy(c.frame.spin, s->spin);
  hk_obstacle_take_radii(&c.obstacle, &s->params, view);
  return c;
}

/* The elastic part and the rest of the force on a particle at x; returns the depth, 0: none. */
static double push(const contact *c, size_t i, const double x[3], const double v[3], double elastic[3],
                   double rest[3]) {
  double n[3], p[3], own[3], w[3], turned[3];
  double depth = -hk_obstacle_gap(&c->obstacle, &c->frame, x, i, n), k = c->self->k;
  for (int q = 0; q < 3; q++) elastic[q] = rest[q] = 0;
  if (!(depth > 0)) return 0;
  hk_body_point(&c->frame, x, p);
  hk_body_velocity(&c->frame, x, v, own);
  hk_body_direction(&c->frame, own, w);
  double closing = hk_dot(w, n), N = fmax(0, k * depth * (1 - c->self->damping * closing));
  for (int q = 0; q < 3; q++) turned[q] = w[q] - closing * n[q];
  double slip = c->self->slip, drag = c->obstacle.friction * N / sqrt(hk_dot(turned, turned) + slip * slip);
  for (int q = 0; q < 3; q++) {
    elastic[q] = k * depth * n[q];
    rest[q] = (N - k * depth) * n[q] - drag * turned[q];
  }
  return depth;
}

static double add_range(const void *context, const hk_view *view, size_t begin, size_t end, double *F) {
  const contact *c = context;
  double elastic[3], rest[3], power = 0;
  for (size_t k = begin; k < end; k++) {
    size_t i = hk_acting_particle(view, k);
    if (!(push(c, i, view->x + 3 * i, view->v + 3 * i, elastic, rest) > 0)) continue;
    for (size_t q = 0; q < 3; q++) F[3 * i + q] += elastic[q] + rest[q];
    power += hk_dot(rest, view->v + 3 * i);
  }
  return power;
}

/* Friction and damping act against the motion relative to the obstacle: its velocity has to be known. */
static hk_status check_velocity(const penalty *s, const hk_view *view) {
  hk_pose now = hk_obstacle_pose(&s->params, view->t);
  double moved = 0, turned = 0;
  for (int c = 0; c < 3; c++) {
    moved += fabs(now.position[c] - s->first.position[c]) * (hk_length(s->velocity) == 0);
    turned += fabs(now.rotation[c] - s->first.rotation[c]) * (hk_length(s->spin) == 0);
  }
  bool matters = s->params.friction > 0 || s->damping > 0;
  if (!matters || moved + turned == 0) return HK_OK;
  return view->host->fail(view->host, HK_BAD_PARAM,
                          "the obstacle moves, and friction and damping need its %s: give it, as a "
                          "function of time, the derivative of `%s`",
                          moved > 0 ? "velocity" : "spin", moved > 0 ? "position" : "rotation");
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const contact c = contact_at(self, view);
  hk_particle_sums_add(view, part, add_range, &c, F);
}

/* An obstacle that moves has parameters of time, so that all of its particles are summed here. */
static hk_status add(void *self, const hk_view *view, double *F) {
  hk_status status = check_velocity(self, view);
  if (status == HK_OK) add_part(self, view, HK_ALL_PARTS, F);
  return status;
}

static double energy(void *self, const hk_view *view) {
  const penalty *s = self;
  contact c = contact_at(s, view);
  double sum = 0, elastic[3], rest[3];
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    double depth = push(&c, i, view->x + 3 * i, view->v + 3 * i, elastic, rest);
    sum += s->k / 2 * depth * depth;
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  (void)self;
  for (size_t k = 0; k < view->acting; k++) {
    uint32_t i = (uint32_t)hk_acting_particle(view, k);
    pattern->block(pattern, i, i);
  }
}

/* Adds -dF/dz to the block, z being x or v; a column is a difference over 2 `step`. */
static void differences(const contact *c, size_t i, bool by_v, double step, double block[9]) {
  double x[3], v[3], *z = by_v ? v : x, a[2][3], b[2][3];
  hk_copy(x, c->view->x + 3 * i);
  hk_copy(v, c->view->v + 3 * i);
  for (int q = 0; q < 3; q++) {
    double kept = z[q];
    z[q] = kept + step;
    push(c, i, x, v, a[0], a[1]);
    z[q] = kept - step;
    push(c, i, x, v, b[0], b[1]);
    z[q] = kept;
    for (int p = 0; p < 3; p++) block[3 * p + q] -= (a[0][p] + a[1][p] - b[0][p] - b[1][p]) / (2 * step);
  }
}

/* K or D may be NULL. */
static void blocks(const contact *c, size_t i, double *K, double *D) {
  const penalty *s = c->self;
  const double *v = c->view->v + 3 * i;
  double elastic[3], rest[3];
  if (!(push(c, i, c->view->x + 3 * i, v, elastic, rest) > 0)) return;
  if (K) differences(c, i, false, 1e-6 * s->scale, K);
  if (D) differences(c, i, true, 1e-3 * s->slip + 1e-6 * hk_length(v), D);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  contact c = contact_at(self, view);
  for (size_t k = 0; k < view->acting; k++)
    blocks(&c, hk_acting_particle(view, k), into->K + 9 * into->slot[k], into->D + 9 * into->slot[k]);
  return HK_OK;
}

static double size_of(const double block[9]) {
  double sum = 0;
  for (int q = 0; q < 9; q++) sum += block[q] * block[q];
  return sqrt(sum);
}

/* What touches has its own blocks, bounded by the root of the sum of squares (and the error of differences). What does
 * not may come to touch with k n n^T, on surfaces that do not curve inward. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const penalty *s = self;
  contact c = contact_at(s, view);
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    double own[9] = {0};
    blocks(&c, i, part == HK_DAMPING_WHOLE ? NULL : own, part == HK_DAMPING_WHOLE ? own : NULL);
    double bound = fmax(size_of(own) * (1 + 1e-6), part == HK_DAMPING_WHOLE ? 0 : s->k);
    block[i][0] += bound;
    block[i][3] += bound;
    block[i][5] += bound;
  }
}

/* ---- what passes through between two steps ---- */

typedef struct law {
  const contact *c;
  size_t i;
  double middle[3];    /* of the way inside, in the obstacle's frame */
  const double *along; /* the way, where the particle has too little energy to reach the middle; NULL: it has enough */
} law;

static void law_at(const void *self, const double r[3], double F[3]) {
  const law *l = self;
  double p[3], x[3], rest[3];
  for (int q = 0; q < 3; q++) p[q] = l->middle[q] + r[q];
  hk_body_place(&l->c->frame, p, x);
  push(l->c, l->i, x, l->c->view->v + 3 * l->i, F, rest);
  hk_add_scaled(F, 1, rest);
  for (int q = 0; q < 3 && l->along && hk_dot(r, l->along) > 0; q++) F[q] = 0;
}

/* What pushes back on the way in pushes on as much on the way out, so the straight way shows next to nothing. But a
 * particle that the obstacle stops does not come to the second half of it. */
static bool is_stopped(const law *l) {
  double x[3], elastic[3], rest[3];
  const double *v = l->c->view->v + 3 * l->i;
  hk_body_place(&l->c->frame, l->middle, x);
  double depth = push(l->c, l->i, x, v, elastic, rest);
  return l->c->self->k * depth * depth > l->c->view->model->mass[l->i] * hk_dot(v, v);
}

/* Where the straight way from p to q is inside: parts of it from either end; false: nowhere, or at an end. */
static bool crosses(const contact *c, size_t i, const double p[3], const double q[3], double part[2]) {
  const hk_shape *shape = &c->obstacle.shape;
  double radius = hk_obstacle_radius(&c->obstacle, i), least = 1e-12 * c->self->scale;
  hk_parabola there = {.span = 1}, back = {.span = 1};
  hk_copy(there.p, p);
  hk_copy(back.p, q);
  hk_subtract(there.w, q, p);
  hk_subtract(back.w, p, q);
  part[0] = hk_parabola_contact(&there, shape, radius, least);
  part[1] = part[0] < 1 ? hk_parabola_contact(&back, shape, radius, least) : INFINITY;
  return part[0] > 0 && part[1] > 0 && part[0] + part[1] < 1;
}

static void add_encounter(const contact *c, size_t i, const double *x_from, hk_encounters *into) {
  double p[3], q[3], part[2], n[3];
  hk_encounter way = {.i = (uint32_t)i, .other = (uint32_t)i};
  law l = {.c = c, .i = i};
  hk_body_point(&c->frame, x_from, p);
  hk_body_point(&c->frame, c->view->x + 3 * i, q);
  hk_subtract(way.dr, q, p);
  double length = hk_length(way.dr), gap = hk_shape_distance(&c->obstacle.shape, p, n);
  if (gap > length + hk_obstacle_radius(&c->obstacle, i) || !crosses(c, i, p, q, part)) return;
  for (int e = 0; e < 3; e++) {
    l.middle[e] = p[e] + way.dr[e] * (part[0] + 1 - part[1]) / 2;
    way.r[e] = p[e] - l.middle[e];
  }
  if (is_stopped(&l)) l.along = way.dr;
  way.range = length * (1 - part[1] - part[0]) / 2;
  into->add(into, &way, law_at, &l);
}

/* What has passed a plane is inside, and pushed back. */
static bool encounters(const void *self, const hk_view *to, const double *x_from, hk_encounters *into) {
  const penalty *s = self;
  if (s->params.shape == HK_SHAPE_PLANE || s->params.hollow) return false;
  contact c = contact_at(s, to);
  for (size_t k = 0; k < to->acting; k++)
    add_encounter(&c, hk_acting_particle(to, k), x_from + 3 * hk_acting_particle(to, k), into);
  return true;
}

/* Half a period of the lightest particle that is free; damping hardly shortens it. */
static double shortest_collision(void *self, const hk_view *view) {
  const penalty *s = self;
  double lightest = INFINITY;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    if (view->model->inverse_mass[i] > 0) lightest = fmin(lightest, view->model->mass[i]);
  }
  return s->k > 0 ? M_PI * sqrt(lightest / s->k) : INFINITY;
}

/* For outputs: where it was in the last evaluation of the step. */
static hk_status accepted(void *self, const hk_view *view, double h) {
  penalty *s = self;
  (void)h;
  s->obstacle.motion.end = contact_at(s, view).frame;
  return HK_OK;
}

static hk_status say_enclosed(const penalty *s, const hk_host *host, const hk_view *view) {
  hk_enclosed_obstacle found;
  hk_status status = hk_obstacle_enclosed(&s->obstacle, host, view, &found);
  if (status != HK_OK || !found.body.found) return status;
  host->warn(host,
             "the obstacle starts inside of a rigid body: its point (%g, %g, %g) m is %.3g m below the body's surface "
             "(particle %u), and it pushes none of the body's points; start them apart",
             found.point[0], found.point[1], found.point[2], found.body.depth, view->model->id[found.body.particle]);
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  penalty *s = self;
  hk_status status = hk_obstacle_open(&s->obstacle, &s->surface, &s->params, host, view);
  if (status != HK_OK) return status;
  s->first = hk_obstacle_pose(&s->params, view->t);
  s->scale = s->params.shape == HK_SHAPE_PLANE ? 1 : hk_shape_size(&s->obstacle.shape);
  s->obstacle.motion.end = contact_at(s, view).frame;
  const hk_obstacles *all = host->query(host, HK_OBSTACLES_INTERFACE);
  if (!all) return HK_FAILED;
  all->show(all->self, &s->obstacle);
  hk_inside found = hk_obstacle_inside(&s->obstacle, view);
  if (found.count)
    host->warn(host,
               "%zu particles start inside the obstacle, by up to %.3g m (particle %u): it pushes them out with up to "
               "%.3g N",
               found.count, found.depth, view->model->id[found.deepest], s->k * found.depth);
  return say_enclosed(s, host, view);
}

static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  contact c = contact_at(self, view);
  double n[3], at[3];
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = hk_acting_particle(view, k);
    const double *x = view->x + 3 * i;
    if (!(hk_obstacle_gap(&c.obstacle, &c.frame, x, i, n) < 0)) continue;
    for (int q = 0; q < 3; q++) at[q] = x[q] - hk_obstacle_radius(&c.obstacle, i) * n[q];
    points->add(points->context, at, n);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_CHANNELS | HK_POWER | HK_STIFFENS,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound, .shortest_collision = shortest_collision),
                        HK_STEPS_FACET(.accepted = accepted), HK_ENCOUNTERS_FACET(.find = encounters),
                        HK_PICTURES_FACET(.contact_points = contact_points)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "penalty",
    .summary = "a soft obstacle, N = max(0, k d (1 - b w.n)) at the depth d, and friction mu N u/sqrt(u^2 + s^2)",
    .reference = "Hunt and Crossley 1975, Coefficient of restitution interpreted as damping in vibroimpact",
    .instance_size = sizeof(penalty),
    .params = params,
    .create = create,
    .force = &force,
};
