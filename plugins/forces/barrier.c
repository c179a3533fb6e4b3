/* Contact that lets nothing through, for implicit methods: incremental potential contact. All surfaces of the scene,
 * cloth, soft bodies, strands, particles and pinned obstacles (service surfaces/1), push each other apart by the
 * barrier of plugins/common/barrier/barrier_pair.h, which is infinite where two surfaces touch. Every move of an
 * implicit method stays within the part that continuous collision detection finds safe (barrier_limit.c), so that no
 * gap is ever closed: there are no intersections, at no time, where there were none at the start.
 *
 * Friction is Coulomb's, smoothed below the speed epsilon_v and with the normal forces of the step before
 * (barrier_friction.h).
 *
 * Invariant: `stiffness` changes between steps only, so that a line search sees one potential. */
#include "plugins/common/barrier/barrier_bound.h"
#include "plugins/common/barrier/barrier_choice.h"
#include "plugins/common/barrier/barrier_friction.h"
#include "plugins/common/barrier/barrier_pair.h"
#include "plugins/common/barrier/barrier_sum.h"
#include "plugins/common/collision/contact_point.h"
#include "plugins/common/surfaces/surface_pair_names.h"

#include <float.h>
#include <string.h>

typedef struct barrier {
  double stiffness; /* Pa; NAN: chosen */
  hk_surface_request request;
  hk_tuples leave;
  hk_barrier_contacts contacts;
  hk_barrier_friction friction;
  int64_t began;                            /* whether a step was accepted */
  int64_t due;                              /* whether the stiffness was not looked at since the last accepted step */
  double chosen, density;                   /* Pa; kg/m^2 */
  double closest, impulse, lost, stiffened; /* m, since the last report; N s; J; J, that a rising stiffness gave */
} barrier;

/* clang-format off */
static const hk_param params[] = {
    {"d_hat", "m", "gap at which the barrier begins; the error of contact is some part of it, and so is the cost",
     HK_NUMBER, {1e-3}, 0, INFINITY, offsetof(barrier, contacts.law.distance), HK_ABOVE_MIN, NULL},
    {"stiffness", "Pa", "pressure kappa of the barrier; left out: chosen from weights and speeds",
     HK_NUMBER, {0}, 0, INFINITY, offsetof(barrier, stiffness), HK_OPTIONAL | HK_ABOVE_MIN, NULL},
    {"friction", "", "Coulomb's coefficient mu",
     HK_NUMBER, {0}, 0, INFINITY, offsetof(barrier, friction.coefficient), 0, NULL},
    {"epsilon_v", "m/s", "speed below which friction is less than Coulomb's: what sticks creeps with up to that",
     HK_NUMBER, {1e-3}, 0, INFINITY, offsetof(barrier, friction.speed), HK_ABOVE_MIN, NULL},
    {"thickness", "m", "of cloth: of surfaces of triangles whose particles can move; 0, as d_hat already holds them apart",
     HK_NUMBER, {0}, 0, INFINITY, offsetof(barrier, request.thickness), 0, NULL},
    {"body_thickness", "m", "of obstacles: of surfaces that are pinned as a whole",
     HK_NUMBER, {0}, 0, INFINITY, offsetof(barrier, request.body_thickness), 0, NULL},
    {"radius", "m", "of strands and lone particles",
     HK_NUMBER, {5e-4}, 0, INFINITY, offsetof(barrier, request.radius), 0, NULL},
    {"leave", "", "particles that have no part in contact, nor their triangles and edges: insides of solids, roots of hair",
     HK_PARTICLES, {0}, 0, 0, offsetof(barrier, leave), HK_OPTIONAL, NULL},
    {0},
};

static const hk_field fields[] = {
    {"shape", HK_FIELD_PER_PARTICLE, 2, offsetof(barrier, contacts.shape), 0},
    {"named", HK_FIELD_ARRAY, sizeof(hk_surface_pair), offsetof(barrier, contacts.named), 0},
    {"touches", HK_FIELD_ARRAY, sizeof(hk_barrier_touch), offsetof(barrier, friction.touches), 0},
    {"density", HK_FIELD_NUMBER, 1, offsetof(barrier, density), 0},
    {"due", HK_FIELD_INTEGER, 1, offsetof(barrier, due), 0},
    {"began", HK_FIELD_INTEGER, 1, offsetof(barrier, began), 0},
    {"chosen", HK_FIELD_NUMBER, 1, offsetof(barrier, chosen), 0},
    {"closest", HK_FIELD_NUMBER, 1, offsetof(barrier, closest), 0},
    {"impulse", HK_FIELD_NUMBER, 1, offsetof(barrier, impulse), 0},
    {"lost", HK_FIELD_NUMBER, 1, offsetof(barrier, lost), 0},
    {"stiffened", HK_FIELD_NUMBER, 1, offsetof(barrier, stiffened), 0},
    {"near", HK_FIELD_ARRAY, sizeof(hk_barrier_pair), offsetof(barrier, contacts.near), HK_SCRATCH},
    {"base", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.base), HK_SCRATCH},
    {"kept_of", HK_FIELD_ARRAY, sizeof(uint32_t), offsetof(barrier, contacts.kept_of), HK_SCRATCH},
    {"halves", HK_FIELD_ARRAY, sizeof(hk_surface_pair), offsetof(barrier, contacts.halves), HK_SCRATCH},
    {"values", HK_FIELD_ARRAY, sizeof(hk_barrier_value), offsetof(barrier, contacts.values), HK_SCRATCH},
    {"tally", HK_FIELD_ARRAY, sizeof(hk_barrier_tally), offsetof(barrier, contacts.tally), HK_SCRATCH},
    {"acting", HK_FIELD_ARRAY, sizeof(uint32_t), offsetof(barrier, contacts.acting), HK_SCRATCH},
    {"at", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.at), HK_SCRATCH},
    {"way", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.way), HK_SCRATCH},
    {"sums", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.sums), HK_SCRATCH},
    {"parts", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.parts), HK_SCRATCH},
    {"loads", HK_FIELD_ARRAY, sizeof(double), offsetof(barrier, contacts.loads), HK_SCRATCH},
    {"hessians", HK_FIELD_ARRAY, sizeof(hk_barrier_hessian), offsetof(barrier, contacts.hessians), HK_SCRATCH},
    {"start", HK_FIELD_ARRAY, sizeof(uint32_t), offsetof(barrier, contacts.sorter.start), HK_SCRATCH},
    {"order", HK_FIELD_ARRAY, sizeof(uint32_t), offsetof(barrier, contacts.sorter.order), HK_SCRATCH},
    {"spare", HK_FIELD_ARRAY, sizeof(uint32_t), offsetof(barrier, contacts.sorter.spare), HK_SCRATCH},
    {"pairs", HK_FIELD_ARRAY, sizeof(hk_surface_pair), offsetof(barrier, friction.pairs), HK_SCRATCH},
    {0},
};
/* clang-format on */

/* ---- life ---- */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  barrier *b = self;
  hk_barrier_contacts *c = &b->contacts;
  c->host = host;
  c->surfaces = host->query(host, HK_SURFACES_INTERFACE);
  if (!c->surfaces) return host->fail(host, HK_FAILED, "no service '%s' is installed", HK_SURFACES_INTERFACE);
  if (b->closest == 0) b->closest = INFINITY; /* 0: the run does not go on from a checkpoint */
  b->request.leave = &b->leave;
  return c->surfaces->join(c->surfaces->self, &b->request, view);
}

static hk_status topology(void *self, const hk_view *view) {
  barrier *b = self;
  hk_status status = hk_barrier_forget(&b->contacts);
  if (!b->began) b->chosen = b->contacts.law.stiffness = 0;
  return status == HK_OK ? hk_friction_renumber(&b->friction, view) : status;
}

/* ---- force ---- */

static hk_status add(void *self, const hk_view *view, double *F) {
  barrier *b = self;
  hk_status status = hk_barrier_add(&b->contacts, view, F);
  if (status != HK_OK) return status;
  double power = hk_friction_add(&b->friction, view->v, F);
  if (view->power) *view->power += power;
  return HK_OK;
}

static double energy(void *self, const hk_view *view) { return hk_barrier_energy(&((barrier *)self)->contacts, view); }

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  (void)view;
  hk_barrier_pattern(&((barrier *)self)->contacts, into);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  barrier *b = self;
  hk_status status = hk_barrier_jacobian(&b->contacts, view, into);
  if (status == HK_OK) hk_friction_damping(&b->friction, view->v, into);
  return status;
}

/* ---- contact ---- */

/* m, the least gap of a pair whose force is known to a part in a thousand, which Newton's iteration needs. The force
 * goes as 1/gap near 0, and a distance is off by some four roundings of the largest coordinate or radius. A smaller gap
 * is not opened by an iteration that doubles it each time: the change is lost in the rounding of positions. */
static double least_known(const hk_surface_pair *p, const double *x) {
  double at[12], largest = p->offset;
  hk_barrier_gather(p->vertex, x, at);
  for (int e = 0; e < 12; e++) largest = fmax(largest, fabs(at[e]));
  return 4e3 * DBL_EPSILON * largest;
}

/* A start, or a correction, that leaves surfaces in contact; of the start, also so near that the force is not known. */
static hk_status refuse_contact(const barrier *b, const hk_view *view) {
  const hk_barrier_pair *near = b->contacts.near.item;
  bool start = !(b->contacts.law.stiffness > 0);
  for (size_t k = 0; k < b->contacts.found; k++) {
    const hk_surface_pair *p = &near[k].pair;
    double least = start ? least_known(p, view->x) : 0;
    if (near[k].gap > least) continue;
    hk_surface_pair_names names = hk_surface_pair_name(p, view->model->id);
    return view->host->fail(
        view->host, HK_BAD_PARAM,
        "%s and %s are in contact: their gap is %.3g m with the thickness asked for, where it has to be above %.3g m; "
        "move them apart, or make thickness or radius smaller",
        names.one, names.other, near[k].gap, least);
  }
  return HK_OK;
}

/* Before the first step; a later one finds the choice made. */
static void choose(barrier *b, const hk_view *view) {
  hk_barrier_contacts *c = &b->contacts;
  if (!(b->chosen > 0) && isnan(b->stiffness)) {
    b->density = hk_barrier_density(c, view);
    b->chosen = hk_barrier_chosen(b->density, c->law.distance, hk_barrier_look(c, view).approach, 0);
  }
  c->law.stiffness = isnan(b->stiffness) ? b->chosen : b->stiffness;
}

/* At the start of a step whose pairs were found on the way that velocities predict: so what is about to hit is known
 * before it loads the barrier, and little energy is in it when its stiffness rises. */
static void follow_speeds(barrier *b, const hk_view *from, const double *x_to) {
  if (!b->due || !isnan(b->stiffness) || memcmp(from->x, x_to, 3 * from->n * sizeof *x_to) == 0) return;
  hk_barrier_survey s = hk_barrier_look(&b->contacts, from);
  double before = b->chosen;
  b->due = 0;
  b->chosen = b->contacts.law.stiffness = hk_barrier_chosen(b->density, b->contacts.law.distance, s.approach, before);
  b->stiffened += s.energy * (b->chosen / before - 1);
}

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *changed) {
  barrier *b = self;
  hk_status status = hk_friction_list(&b->friction, from->host);
  if (status == HK_OK)
    status = hk_barrier_find(&b->contacts, from, x_to, b->friction.pairs.item, b->friction.pairs.count, changed);
  if (status == HK_OK) status = refuse_contact(b, from);
  if (status != HK_OK) return status;
  if (!(b->contacts.law.stiffness > 0)) choose(b, from);
  follow_speeds(b, from, x_to);
  if (!b->began && !b->friction.touches.count) status = hk_friction_take(&b->friction, &b->contacts, from);
  hk_friction_tell_names(&b->friction, &b->contacts);
  return status;
}

static double step_limit(void *self, const hk_view *from, const double *dx) {
  return hk_barrier_limit(&((barrier *)self)->contacts, from, dx);
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  barrier *b = self;
  hk_barrier_bound(&b->contacts, &b->friction, view, part, block);
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  barrier *b = self;
  hk_barrier_survey s = hk_barrier_look(&b->contacts, view);
  b->began = 1;
  b->closest = fmin(b->closest, s.closest);
  b->impulse += h * s.load;
  b->lost -= h * hk_friction_power(&b->friction, view->v);
  b->due = 1;
  return hk_friction_take(&b->friction, &b->contacts, view);
}

static bool report(void *self, const hk_view *view, hk_contact_report *out) {
  barrier *b = self;
  const hk_surfaces *surfaces = b->contacts.surfaces;
  if (surfaces->report(surfaces->self, view, out) != HK_OK) return false;
  out->closest = b->closest;
  out->impulse = b->impulse;
  out->impact_energy = b->lost - b->stiffened;
  b->closest = INFINITY;
  return true;
}

/* The pairs that the barrier pushes apart. */
static void contact_points(const void *self, const hk_view *view, const hk_contact_points *points) {
  const hk_barrier_contacts *c = &((const barrier *)self)->contacts;
  const hk_barrier_pair *near = c->near.item;
  double x[12];
  for (size_t k = 0; k < c->found; k++) {
    for (int i = 0; i < 4; i++) memcpy(x + 3 * i, view->x + 3 * (size_t)near[k].pair.vertex[i], 3 * sizeof *x);
    hk_contact_point_of_pair(near[k].pair.kind, x, near[k].pair.offset + c->law.distance, points);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_SYMMETRIC_JACOBIAN | HK_OFFERS_DEFINITE |
             HK_STIFFENS | HK_POWER,
    .add = add,
    .energy = energy,
    .pattern = pattern,
    .jacobian = jacobian,
    .stiffness_bound = stiffness_bound,
    .update = update,
    .step_limit = step_limit,
    .accepted = accepted,
    .contacts = report,
    .contact_points = contact_points,
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "barrier",
    .summary = "contact that nothing passes, for implicit methods: E = -kappa A d_hat (u - 1)^2 ln u, and friction",
    .reference =
        "Li, Ferguson and others 2020, Incremental Potential Contact; Li, Kaufman and Jiang 2021, Codimensional "
        "Incremental Potential Contact",
    .instance_size = sizeof(barrier),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
