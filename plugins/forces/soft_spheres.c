/* Sand: spheres that push each other apart where they overlap, damped and with friction (the discrete element method of
 * Cundall and Strack 1979, Geotechnique 29). The law of a contact is in plugins/common/grains/grain_law.h; its
 * dashpot is chosen by the coefficient of restitution of two spheres that meet head-on.
 *
 * Pairs come from the service neighbours/1, and each particle sums over its own row in rising order, so that threads
 * leave no trace and opposite forces have the same bits. What a contact remembers, the slip of its tangential spring,
 * belongs to the pair of ids and changes at accepted steps alone (contact_history.h).
 *
 * With a channel of angular velocities spheres are solid balls that roll and spin:
 *     scene:channel("spin", { size = 3 })
 *     scene:force("soft_spheres", { spin = "spin", ... })
 * Forces act at the middle of the overlap, so angular momentum is kept as well. The energy is that of the normal
 * springs and, unless another force of grains has it (spins.h), of the spin; dashpots, friction and the tangential
 * springs work (HK_POWER).
 *
 * The stable step follows from the contacts that a sphere can have, overlapping a little, as derived in crowd.c, or
 * from those that it has now, if they are more. A chosen step is at most a twentieth of the shortest collision. */
#include "plugins/common/grains/crowd.h"
#include "plugins/common/grains/grain_tables.h"

enum { GRAIN = 256 };

typedef struct soft_spheres {
  hk_spheres spheres;
  double restitution, tangential; /* tangential: k_t/k */
  hk_grain_law law;
  hk_grain_history history;
  double *torque;    /* n x 3, N m, of the last evaluation */
  double *spin_then; /* n x 3, rad/s, at the last accepted step */
  double *sums;      /* of a chunk */
  const hk_neighbours *service;
  const hk_host *host;
} soft_spheres;

/* clang-format off */
static const hk_param params[] = {
    HK_GRAIN_PARAMS(soft_spheres),
    {0},
};

static const hk_field fields[] = {
    HK_GRAIN_FIELDS(soft_spheres),
    {0},
};
/* clang-format on */

/* ---- one contact ---- */

typedef struct task {
  soft_spheres *self;
  const hk_view *view;
  hk_neighbour_rows rows;
  const hk_periodic_box *box; /* NULL: space is open */
  double *F;
  bool fresh; /* what is remembered is not of the step before */
} task;

static hk_status begin(task *t, soft_spheres *s, const hk_view *view) {
  *t = (task){.self = s, .view = view, .box = view->model->box};
  hk_grain_history_index(&s->history, view);
  return s->service->rows(s->service->self, view, view->x, &t->rows);
}

#define EACH_SPACE(t, f, ...) ((t)->box ? f(t, (t)->box, __VA_ARGS__) : f(t, NULL, __VA_ARGS__))

HK_INLINE size_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

/* m, how far i and j overlap; r: from j to i. `box` is the task's; that it is NULL is known to the compiler where rows
 * are summed in open space (EACH_SPACE). */
HK_INLINE double overlap(const task *t, const hk_periodic_box *box, size_t i, size_t j, double r[3], double *distance) {
  const double *x = t->view->x;
  double reach = hk_sphere_radius(&t->self->spheres, t->view, i) + hk_sphere_radius(&t->self->spheres, t->view, j);
  for (size_t c = 0; c < 3; c++) r[c] = x[3 * i + c] - x[3 * j + c];
  if (box) hk_nearest_image(box, r);
  double r2 = hk_dot(r, r);
  if (!(r2 < reach * reach) || (t->view->is_active && !t->view->is_active[j])) return 0;
  *distance = sqrt(r2);
  return reach - *distance;
}

/* u -= (l_i w_i + l_j w_j) x n, and the slip with it, by the mean of the spins then and now. */
static void roll(const task *t, size_t i, size_t j, double lever_i, double lever_j, bool remembered,
                 hk_grain_contact *c) {
  const soft_spheres *s = t->self;
  const double *wi = hk_sphere_spin(&s->spheres, t->view, i), *wj = hk_sphere_spin(&s->spheres, t->view, j);
  double now[3], then[3], u[3], du[3], passed = remembered ? (t->view->t - s->history.t) / 2 : 0;
  for (size_t a = 0; a < 3; a++) {
    now[a] = lever_i * wi[a] + lever_j * wj[a];
    then[a] = now[a] + lever_i * s->spin_then[3 * i + a] + lever_j * s->spin_then[3 * j + a];
  }
  hk_cross(u, now, c->normal);
  hk_cross(du, then, c->normal);
  for (int a = 0; a < 3; a++) c->u[a] -= u[a], c->slip[a] -= passed * du[a];
}

/* Spheres in one place have no direction: they push each other nowhere, and `accepted` ends the run. */
static void contact_of(const task *t, size_t i, size_t j, double d, const double r[3], double distance,
                       const hk_grain_touch *touch, hk_grain_contact *c) {
  const soft_spheres *s = t->self;
  const double *m = t->view->model->mass, *v = t->view->v;
  *c = (hk_grain_contact){.overlap = d, .mass = m[i] * m[j] / (m[i] + m[j])};
  for (size_t a = 0; a < 3; a++) {
    c->normal[a] = distance > 0 ? r[a] / distance : 0;
    c->u[a] = v[3 * i + a] - v[3 * j + a];
    if (touch) c->slip[a] = r[a] - touch->anchor[a];
  }
  double along = hk_dot(c->slip, c->normal);
  for (int a = 0; a < 3; a++) c->slip[a] -= along * c->normal[a];
  if (s->spheres.spin_channel)
    roll(t, i, j, hk_sphere_radius(&s->spheres, t->view, i) - d / 2, hk_sphere_radius(&s->spheres, t->view, j) - d / 2,
         touch, c);
  hk_grain_force(&s->law, c);
}

/* ---- force and energy ---- */

HK_INLINE double add_one(const task *t, const hk_periodic_box *box, size_t i) {
  const soft_spheres *s = t->self;
  double force[3] = {0}, torque[3] = {0}, power = 0, r[3], distance = 0, R = hk_sphere_radius(&s->spheres, t->view, i);
  size_t at = s->history.row[i];
  for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
    size_t j = t->rows.other[e];
    double d = overlap(t, box, i, j, r, &distance), moment[3];
    if (!(d > 0)) continue;
    hk_grain_contact c;
    contact_of(t, i, j, d, r, distance, hk_grain_history_find(&s->history, i, &at, t->view->model->id[j]), &c);
    hk_cross(moment, c.normal, c.across);
    for (int a = 0; a < 3; a++) force[a] += c.force[a], torque[a] -= (R - d / 2) * moment[a];
    power += c.power / 2;
  }
  for (size_t a = 0; a < 3; a++) t->F[3 * i + a] += force[a], s->torque[3 * i + a] = torque[a];
  return power;
}

static void add_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double power = 0;
  for (size_t k = first; k < end; k++) power += EACH_SPACE(t, add_one, acting(t->view, k));
  t->self->sums[chunk] = power;
}

static double sum_of(const soft_spheres *s, const hk_view *view) {
  double sum = 0;
  for (size_t k = 0; k * GRAIN < view->acting; k++) sum += s->sums[k];
  return sum;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  hk_status status = begin(&t, self, view);
  if (status != HK_OK) return status;
  t.F = F;
  view->host->parallel_for(view->host, view->acting, GRAIN, add_chunk, &t);
  if (view->power) *view->power += sum_of(t.self, view);
  return HK_OK;
}

/* Of the torques of `add`, which the host calls just before. */
static hk_status rates(void *self, const hk_view *view, double *dy) {
  const soft_spheres *s = self;
  hk_spheres_turn(&s->spheres, view, s->torque, dy);
  return HK_OK;
}

static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  const soft_spheres *s = t->self;
  double sum = 0, r[3], distance = 0;
  for (size_t k = first; k < end; k++) {
    size_t i = acting(t->view, k);
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      double d = overlap(t, t->box, i, t->rows.other[e], r, &distance);
      sum += s->law.stiffness / 4 * d * d; /* of each pair twice */
    }
    sum += hk_sphere_rotation(&s->spheres, t->view, i);
  }
  s->sums[chunk] = sum;
}

static double energy(void *self, const hk_view *view) {
  task t;
  if (begin(&t, self, view) != HK_OK) return NAN;
  view->host->parallel_for(view->host, view->acting, GRAIN, energy_chunk, &t);
  return sum_of(t.self, view);
}

/* ---- what is remembered ---- */

HK_INLINE size_t count_touching(const task *t, const hk_periodic_box *box, size_t i) {
  double r[3], distance;
  size_t count = 0;
  for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++)
    count += overlap(t, box, i, t->rows.other[e], r, &distance) > 0;
  return count;
}

static size_t touching(const task *t, size_t i) { return EACH_SPACE(t, count_touching, i); }

static void count_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t i = first; i < end; i++) {
    bool acts = !t->view->is_active || t->view->is_active[i];
    t->self->history.next_row[i + 1] = acts ? touching(t, i) : 0;
  }
}

/* False: another sphere is in the same place. */
HK_INLINE bool remember_one(const task *t, const hk_periodic_box *box, size_t i) {
  const hk_grain_history *h = &t->self->history;
  const uint32_t *id = t->view->model->id;
  hk_grain_touch *into = (hk_grain_touch *)h->next.item + h->next_row[i];
  double r[3], distance = 0;
  size_t at = h->row[i];
  bool apart = true;
  for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
    size_t j = t->rows.other[e];
    double d = overlap(t, box, i, j, r, &distance);
    if (!(d > 0)) continue;
    const hk_grain_touch *touch = hk_grain_history_find(h, i, &at, id[j]);
    hk_grain_contact c;
    contact_of(t, i, j, d, r, distance, t->fresh ? NULL : touch, &c);
    *into = (hk_grain_touch){id[i], id[j], {0}};
    for (int a = 0; a < 3; a++) into->anchor[a] = r[a] - c.slip[a];
    into++;
    apart &= distance > 0;
  }
  return apart;
}

/* sums: the last sphere of a chunk that shares its place, from 1. */
static void remember_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  t->self->sums[chunk] = 0;
  for (size_t k = first; k < end; k++)
    if (!EACH_SPACE(t, remember_one, acting(t->view, k))) t->self->sums[chunk] = (double)(acting(t->view, k) + 1);
}

static hk_status check_places(const soft_spheres *s, const hk_view *view) {
  double i = 0;
  for (size_t k = 0; k * GRAIN < view->acting; k++) i = fmax(i, s->sums[k]);
  if (i == 0) return HK_OK;
  return s->host->fail(
      s->host, HK_FAILED,
      "particle %u has the same centre as another one at t = %g s: their contact has no direction; start "
      "them apart",
      view->model->id[(size_t)i - 1], view->t);
}

/* Radii of a channel may change, and be others after a checkpoint was read. */
static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  soft_spheres *s = self;
  (void)x_to, (void)pattern_changed;
  hk_status status = hk_spheres_check(&s->spheres, from);
  if (status == HK_OK) status = hk_grain_history_check(&s->history, from);
  return status == HK_OK ? s->service->reach_images(s->service->self, 2 * hk_spheres_measure(&s->spheres, from).largest)
                         : status;
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  soft_spheres *s = self;
  task t;
  hk_status status = begin(&t, s, view);
  if (status != HK_OK) return status;
  t.fresh = fabs(view->t - h - s->history.t) > h / 2; /* it did not act in the step before */
  view->host->parallel_for(view->host, view->n, GRAIN, count_chunk, &t);
  status = hk_grain_history_reserve(&s->history, view);
  if (status != HK_OK) return status;
  view->host->parallel_for(view->host, view->acting, GRAIN, remember_chunk, &t);
  hk_grain_history_commit(&s->history, view->n, view->t);
  hk_spheres_keep_spin(&s->spheres, view, s->spin_then);
  return check_places(s, view);
}

/* ---- the step ---- */

static double largest_mass(const hk_view *view) {
  double most = 0;
  for (size_t i = 0; i < view->n; i++) most = fmax(most, view->model->mass[i]);
  return most;
}

/* No more touch a sphere than there are others: a periodic box has at most one image of each within reach. */
static hk_crowd crowd_around(const soft_spheres *s, const hk_view *view, size_t i, double smallest) {
  hk_crowd around = hk_crowd_of(hk_sphere_radius(&s->spheres, view, i), smallest);
  double others = (double)view->acting - 1;
  return (hk_crowd){fmin(around.number, others), fmin(around.along, others)};
}

/* Of a pair, k (u_i - u_j)^2 <= 2 k u_i^2 + 2 k u_j^2. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const soft_spheres *s = self;
  task t;
  bool known = begin(&t, self, view) == HK_OK;
  double smallest = hk_spheres_measure(&s->spheres, view).smallest, heaviest = largest_mass(view);
  for (size_t k = 0; k < view->acting; k++) {
    size_t i = acting(view, k);
    double m = view->model->mass[i];
    hk_crowd around = crowd_around(s, view, i, smallest);
    hk_grain_bound one = hk_grain_stiffness(&s->law, part, m * heaviest / (m + heaviest));
    double sum = one.across * around.number + fmax(0, one.along - one.across) * around.along;
    double now = known ? fmax(one.along, one.across) * (double)touching(&t, i) : INFINITY;
    sum = 2 * fmax(sum, now);
    for (int c = 0; c < 6; c += c < 3 ? 3 : 2) block[i][c] += sum;
  }
}

static double longest_step(void *self, const hk_view *view) {
  return hk_spheres_longest_step(&((const soft_spheres *)self)->spheres, view);
}

static double shortest_collision(void *self, const hk_view *view) {
  return hk_grain_collision(&((const soft_spheres *)self)->law, hk_spheres_least_mass(view, false));
}

/* ---- the plugin ---- */

static hk_status topology(void *self, const hk_view *view) {
  soft_spheres *s = self;
  s->host->release(s->host, s->sums);
  s->sums = s->host->allocate(s->host, (view->n / GRAIN + 1) * sizeof *s->sums);
  if (!s->sums) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  hk_status status = hk_spheres_topology(&s->spheres, view);
  if (status == HK_OK) status = hk_grain_history_adapt(&s->history, view, true);
  return status == HK_OK ? s->service->reach_images(s->service->self, 2 * hk_spheres_measure(&s->spheres, view).largest)
                         : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  soft_spheres *s = self;
  s->host = host;
  s->service = host->query(host, "neighbours/1");
  if (!s->service)
    return host->fail(host, HK_FAILED,
                      "it needs the service 'neighbours/1', and no plugin of that name is installed in services/; see: "
                      "hooke plugins");
  s->law.damping = hk_grain_damping(s->restitution);
  s->law.tangential = s->tangential * s->law.stiffness;
  s->history.t = view->t;
  hk_status status = hk_spheres_open(&s->spheres, view);
  s->law.yielding = s->spheres.spin_channel ? 3.5 : 1;
  return status == HK_OK ? topology(self, view) : status;
}

/* Those that are remembered, each of them once. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const soft_spheres *s = self;
  const hk_grain_touch *touch = s->history.touches.item;
  for (int64_t k = 0; s->history.whole && k < s->history.count; k++) {
    if (touch[k].self >= touch[k].other) continue;
    size_t i = hk_model_find(view->model, touch[k].self), j = hk_model_find(view->model, touch[k].other);
    double R = hk_sphere_radius(&s->spheres, view, i), at[3], n[3];
    for (size_t c = 0; c < 3; c++) n[c] = view->x[3 * i + c] - view->x[3 * j + c];
    if (view->model->box) hk_nearest_image(view->model->box, n);
    double length = sqrt(hk_dot(n, n));
    for (size_t c = 0; c < 3; c++) n[c] /= length, at[c] = view->x[3 * i + c] - R * n[c];
    points->add(points->context, at, n);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_DEPENDS_ON_CHANNELS | HK_CONSERVES_MOMENTUM |
             HK_POWER | HK_STIFFENS | HK_PERIODIC,
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
    .name = "soft_spheres",
    .summary = "grains: spheres with springs, dashpots and friction where they overlap (discrete element method)",
    .reference =
        "Cundall and Strack 1979, Geotechnique 29; Luding 2008, Granular Matter 10; Schwager and Poeschel 2007",
    .instance_size = sizeof(soft_spheres),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
