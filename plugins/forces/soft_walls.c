/* Walls for soft_spheres: planes and a funnel, with the same law of contact (plugins/common/grains/grain_law.h); a
 * wall has no end to its mass. A sphere touches each wall in its nearest point, and remembers the slip as between
 * spheres (contact_history.h).
 *
 * A plane leaves free what lies on the side of its normal. The funnel is two cones about an upright axis that open up-
 * and downwards from a neck: free is what is nearer to the axis than neck + slope |z - z_neck|, and the neck is an
 * edge. With a slope of 0 it is a pipe. Parameters and the energy of the spin mean what they mean in soft_spheres. */
#include "plugins/common/grains/funnel_mesh.h"
#include "plugins/common/grains/grain_tables.h"
#include "plugins/common/obstacles/obstacles_service.h"

enum { GRAIN = 256, PLANE = 4, FUNNEL = 5 /* numbers of one */ };

typedef struct soft_walls {
  hk_spheres spheres;
  hk_numbers planes, funnel;
  double restitution, tangential; /* tangential: k_t/k */
  hk_grain_law law;
  hk_grain_history history;
  uint32_t walls, number; /* of all walls, of planes */
  double (*plane)[PLANE]; /* with normals of length 1 */
  hk_obstacle *shown;     /* number: the planes, for outputs */
  hk_funnel_mesh *mesh;   /* for outputs */
  double *torque;         /* n x 3, N m, of the last evaluation */
  double *spin_then;      /* n x 3, rad/s, at the last accepted step */
  double *sums;           /* of a chunk */
  const hk_host *host;
} soft_walls;

static const hk_param params[] = {
    {"planes", "m",
     "four numbers each: x, y, z of the normal, distance from the origin; left out: the floor, if no funnel",
     .numbers = HK_AT(soft_walls, planes), .flags = HK_OPTIONAL},
    {"funnel", "m", "x, y and z of the middle of the neck, its radius, slope (m/m); left out: none",
     .numbers = HK_AT(soft_walls, funnel), .flags = HK_OPTIONAL},
    HK_GRAIN_PARAMS(soft_walls),
    {0},
};

static const hk_field fields[] = {
    HK_GRAIN_FIELDS(soft_walls),
    {0},
};

/* ---- where walls are ---- */

/* m, from the nearest point of the funnel to x, negative within the wall; n points into the open. In the half-plane of
 * x and the axis, p is the distance from the axis and h that from the neck's plane. */
static double from_funnel(const double *f, const double *x, double n[3]) {
  double dx = x[0] - f[0], dy = x[1] - f[1], dz = x[2] - f[2], p = sqrt(dx * dx + dy * dy), h = fabs(dz),
         up = dz < 0 ? -1 : 1;
  double neck = f[3], slope = f[4], length = sqrt(1 + slope * slope), gap = (neck + slope * h - p) / length;
  double out = -1 / length, along = slope / length;
  if (h - gap * along < 0) { /* the edge is nearest */
    double sign = gap < 0 ? -1 : 1;
    gap = sign * sqrt((p - neck) * (p - neck) + h * h);
    out = gap != 0 ? (p - neck) / gap : -1;
    along = gap != 0 ? h / gap : 0;
  }
  n[0] = p > 0 ? out * dx / p : out;
  n[1] = p > 0 ? out * dy / p : 0;
  n[2] = along * up;
  return gap;
}

static double from_wall(const soft_walls *s, uint32_t wall, const double *x, double n[3]) {
  if (wall >= s->number) return from_funnel(s->funnel.value, x, n);
  const double *plane = s->plane[wall];
  for (int a = 0; a < 3; a++) n[a] = plane[a];
  return hk_dot(plane, x) - plane[3];
}

/* ---- one contact ---- */

typedef struct task {
  soft_walls *self;
  const hk_view *view;
  double *F;
  bool fresh; /* what is remembered is not of the step before */
} task;

static size_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

/* Fills the contact of particle i with a wall; false: they do not touch. */
static bool contact_of(const task *t, size_t i, uint32_t wall, const hk_grain_touch *touch, hk_grain_contact *c) {
  const soft_walls *s = t->self;
  const double *x = t->view->x + 3 * i, *w = hk_sphere_spin(&s->spheres, t->view, i);
  double R = hk_sphere_radius(&s->spheres, t->view, i), rolled[3], then[3];
  *c = (hk_grain_contact){.mass = t->view->model->mass[i]};
  c->overlap = R - from_wall(s, wall, x, c->normal);
  if (!(c->overlap > 0)) return false;
  for (size_t a = 0; a < 3; a++) {
    c->u[a] = t->view->v[3 * i + a];
    if (touch) c->slip[a] = x[a] - touch->anchor[a];
  }
  double along = hk_dot(c->slip, c->normal), lever = R - c->overlap / 2;
  for (int a = 0; a < 3; a++) c->slip[a] -= along * c->normal[a];
  if (w) {
    double passed = touch ? (t->view->t - s->history.t) / 2 : 0;
    hk_cross(rolled, w, c->normal);
    hk_cross(then, s->spin_then + 3 * i, c->normal);
    for (int a = 0; a < 3; a++) {
      c->u[a] -= lever * rolled[a];
      c->slip[a] -= passed * lever * (rolled[a] + then[a]);
    }
  }
  hk_grain_force(&s->law, c);
  return true;
}

/* ---- force and energy ---- */

static double add_one(const task *t, size_t i) {
  const soft_walls *s = t->self;
  double torque[3] = {0}, moment[3], power = 0, R = hk_sphere_radius(&s->spheres, t->view, i);
  size_t at = s->history.row[i];
  for (uint32_t wall = 0; wall < s->walls; wall++) {
    hk_grain_contact c;
    if (!contact_of(t, i, wall, hk_grain_history_find(&s->history, i, &at, wall), &c)) continue;
    hk_cross(moment, c.normal, c.across);
    for (size_t a = 0; a < 3; a++) {
      t->F[3 * i + a] += c.force[a];
      torque[a] -= (R - c.overlap / 2) * moment[a];
    }
    power += c.power;
  }
  for (size_t a = 0; a < 3; a++) s->torque[3 * i + a] = torque[a];
  return power;
}

static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double power = 0;
  for (size_t k = first; k < end; k++) power += add_one(t, acting(t->view, k));
  t->self->sums[chunk] = power;
}

static double sum_of(const soft_walls *s, const hk_view *view) {
  double sum = 0;
  for (size_t k = 0; k * GRAIN < view->acting; k++) sum += s->sums[k];
  return sum;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t = {.self = self, .view = view, .F = F};
  hk_grain_history_index(&t.self->history, view);
  view->host->parallel_for(view->host, view->acting, GRAIN, add_chunk, &t);
  if (view->power) *view->power += sum_of(self, view);
  return HK_OK;
}

/* Of the torques of `add`, which the host calls just before. */
static hk_status rates(void *self, const hk_view *view, double *dy) {
  const soft_walls *s = self;
  hk_spheres_turn(&s->spheres, view, s->torque, dy);
  return HK_OK;
}

static double energy(void *self, const hk_view *view) {
  const soft_walls *s = self;
  double sum = 0, n[3];
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    for (uint32_t wall = 0; wall < s->walls; wall++) {
      double d = hk_sphere_radius(&s->spheres, view, i) - from_wall(s, wall, view->x + 3 * i, n);
      if (d > 0) sum += s->law.stiffness / 2 * d * d;
    }
    sum += hk_sphere_rotation(&s->spheres, view, i);
  }
  return sum;
}

/* ---- what is remembered ---- */

static void count_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double n[3];
  (void)chunk;
  for (size_t i = first; i < end; i++) {
    size_t count = 0;
    bool acts = !t->view->is_active || t->view->is_active[i];
    for (uint32_t wall = 0; acts && wall < t->self->walls; wall++)
      count += hk_sphere_radius(&t->self->spheres, t->view, i) - from_wall(t->self, wall, t->view->x + 3 * i, n) > 0;
    t->self->history.next_row[i + 1] = count;
  }
}

static void remember_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const hk_grain_history *h = &t->self->history;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    size_t i = acting(t->view, k), at = h->row[i];
    hk_grain_touch *into = (hk_grain_touch *)h->next.item + h->next_row[i];
    for (uint32_t wall = 0; wall < t->self->walls; wall++) {
      const hk_grain_touch *touch = hk_grain_history_find(h, i, &at, wall);
      hk_grain_contact c;
      if (!contact_of(t, i, wall, t->fresh ? NULL : touch, &c)) continue;
      *into = (hk_grain_touch){t->view->model->id[i], wall, {0}};
      for (size_t a = 0; a < 3; a++) into->anchor[a] = t->view->x[3 * i + a] - c.slip[a];
      into++;
    }
  }
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  soft_walls *s = self;
  task t = {.self = s, .view = view, .fresh = fabs(view->t - h - s->history.t) > h / 2};
  hk_grain_history_index(&s->history, view);
  view->host->parallel_for(view->host, view->n, GRAIN, count_chunk, &t);
  hk_status status = hk_grain_history_reserve(&s->history, view);
  if (status != HK_OK) return status;
  view->host->parallel_for(view->host, view->acting, GRAIN, remember_chunk, &t);
  hk_grain_history_commit(&s->history, view->n, view->t);
  hk_spheres_keep_spin(&s->spheres, view, s->spin_then);
  return HK_OK;
}

/* ---- the step ---- */

/* As if a sphere touched every wall. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const soft_walls *s = self;
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    hk_grain_bound one = hk_grain_stiffness(&s->law, part, view->model->mass[i]);
    for (int c = 0; c < 6; c += c < 3 ? 3 : 2) block[i][c] += s->walls * fmax(one.along, one.across);
  }
}

static double longest_step(void *self, const hk_view *view) {
  return hk_spheres_longest_step(&((const soft_walls *)self)->spheres, view);
}

static double shortest_collision(void *self, const hk_view *view) {
  return hk_grain_collision(&((const soft_walls *)self)->law, hk_spheres_least_mass(view, true));
}

/* ---- the plugin ---- */

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  soft_walls *s = self;
  (void)x_to, (void)pattern_changed;
  hk_status status = hk_spheres_check(&s->spheres, from);
  return status == HK_OK ? hk_grain_history_check(&s->history, from) : status;
}

static hk_status topology(void *self, const hk_view *view) {
  soft_walls *s = self;
  s->host->release(s->host, s->sums);
  s->sums = s->host->allocate(s->host, (view->n / GRAIN + 1) * sizeof *s->sums);
  if (!s->sums) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_spheres_topology(&s->spheres, view);
  return status == HK_OK ? hk_grain_history_adapt(&s->history, view, false) : status;
}

static hk_status check_walls(const soft_walls *s) {
  const double *f = s->funnel.value;
  if (s->planes.count % PLANE)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "planes: %zu numbers, expected four for each plane: nx, ny, nz, distance", s->planes.count);
  if (s->funnel.count && s->funnel.count != FUNNEL)
    return s->host->fail(s->host, HK_BAD_PARAM, "funnel: %zu numbers, expected x, y, z, radius of the neck, slope",
                         s->funnel.count);
  if (s->funnel.count && !(f[3] > 0 && f[4] >= 0))
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "funnel: a neck of %g m with a slope of %g: expected above 0, at least 0", f[3], f[4]);
  return HK_OK;
}

static hk_status set_plane(const soft_walls *s, uint32_t k, const double *given) {
  double length = sqrt(hk_dot(given, given));
  if (!(length > 0)) return s->host->fail(s->host, HK_BAD_PARAM, "planes: the normal of plane %u is zero", k + 1);
  for (int a = 0; a < 3; a++) s->plane[k][a] = given[a] / length;
  s->plane[k][3] = given[3];
  return HK_OK;
}

static hk_status set_planes(soft_walls *s) {
  static const double floor[PLANE] = {0, 0, 1, 0};
  hk_status status = HK_OK;
  bool any = s->planes.count || s->funnel.count;
  s->number = any ? (uint32_t)(s->planes.count / PLANE) : 1;
  s->walls = s->number + (s->funnel.count > 0);
  s->plane = s->host->allocate(s->host, (s->number + 1) * sizeof *s->plane);
  if (!s->plane) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the planes");
  for (uint32_t k = 0; k < s->number && status == HK_OK; k++)
    status = set_plane(s, k, any ? s->planes.value + (size_t)PLANE * k : floor);
  return status;
}

static hk_status show_planes(soft_walls *s, const hk_obstacles *all) {
  s->shown = s->host->allocate(s->host, (s->number + 1) * sizeof *s->shown);
  if (!s->shown) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the planes");
  for (uint32_t k = 0; k < s->number; k++) {
    hk_obstacle *o = s->shown + k;
    *o = (hk_obstacle){.shape = {.kind = HK_SHAPE_PLANE}, .motion.end.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (int a = 0; a < 3; a++)
      o->shape.normal[a] = s->plane[k][a], o->motion.end.origin[a] = s->plane[k][3] * s->plane[k][a];
    all->show(all->self, o);
  }
  return HK_OK;
}

/* A funnel has no ends: it is shown from the lowest particle, or the floor of these walls, to the highest. */
static hk_status show_funnel(soft_walls *s, const hk_obstacles *all, const hk_view *view) {
  const double *funnel = s->funnel.value;
  if (!s->funnel.count) return HK_OK;
  double low = funnel[2], high = funnel[2];
  for (uint32_t k = 0; k < s->number; k++)
    if (s->plane[k][2] > 0.999) low = fmin(low, s->plane[k][3]);
  for (size_t i = 0; i < view->n; i++) {
    double radius = hk_sphere_radius(&s->spheres, view, i);
    low = fmin(low, view->x[3 * i + 2] - radius), high = fmax(high, view->x[3 * i + 2] + radius);
  }
  s->mesh = s->host->allocate(s->host, sizeof *s->mesh);
  if (!s->mesh) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for the funnel");
  hk_funnel_mesh_make(s->mesh, funnel, low, high);
  all->show(all->self, &s->mesh->obstacle);
  return HK_OK;
}

static hk_status show(soft_walls *s, const hk_view *view) {
  const hk_obstacles *all = s->host->query(s->host, HK_OBSTACLES_INTERFACE);
  hk_status status = all ? show_planes(s, all) : HK_FAILED;
  return status == HK_OK ? show_funnel(s, all, view) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  soft_walls *s = self;
  s->host = host;
  s->law.damping = hk_grain_damping(s->restitution);
  s->law.tangential = s->tangential * s->law.stiffness;
  s->history.t = view->t;
  hk_status status = hk_spheres_open(&s->spheres, view);
  s->law.yielding = s->spheres.spin_channel ? 3.5 : 1;
  if (status == HK_OK) status = check_walls(s);
  if (status == HK_OK) status = set_planes(s);
  if (status == HK_OK) status = show(s, view);
  return status == HK_OK ? topology(self, view) : status;
}

static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const soft_walls *s = self;
  double n[3], at[3];
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    double R = hk_sphere_radius(&s->spheres, view, i);
    for (uint32_t wall = 0; wall < s->walls; wall++) {
      double gap = from_wall(s, wall, view->x + 3 * i, n);
      if (!(gap < R)) continue;
      for (int c = 0; c < 3; c++) at[c] = view->x[3 * i + (size_t)c] - gap * n[c];
      points->add(points->context, at, n);
    }
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS | HK_POWER | HK_STIFFENS,
    .add = add,
    .energy = energy,
    .rates = rates,
    .facets = HK_FACETS(HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound, .longest_step = longest_step,
                                        .shortest_collision = shortest_collision),
                        HK_STEPS_FACET(.update = update, .accepted = accepted),
                        HK_PICTURES_FACET(.contact_points = contact_points)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "soft_walls",
    .summary = "planes and a funnel that hold grains, with the springs, dashpots and friction of soft_spheres",
    .reference =
        "Cundall and Strack 1979, Geotechnique 29; Luding 2008, Granular Matter 10; Schwager and Poeschel 2007",
    .instance_size = sizeof(soft_walls),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
