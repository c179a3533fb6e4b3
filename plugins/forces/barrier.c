/* Contact that lets nothing through, for implicit methods: incremental potential contact. All surfaces of the scene,
 * cloth, soft bodies, strands, particles and pinned obstacles (service surfaces/1), push each other apart by the
 * barrier of plugins/common/contact/barrier/barrier_pair.h, which is infinite where two surfaces touch. Every move of
 * an implicit method stays within the part that continuous collision detection finds safe (barrier_limit.c), so that no
 * gap is ever closed: there are no intersections, at no time, where there were none at the start.
 *
 * Friction is Coulomb's, with the normal forces of the same positions; what sticks is displaced by the elastic slip at
 * most, which contacts remember from step to step (contact/friction/friction.h).
 *
 * Invariant: `stiffness` changes between steps only, so that a line search sees one potential.
 *
 * Of those that keep surfaces apart the one for implicit methods: 75 steps of bdf2 for the sheet of
 * plugins/correctors/contact.c, where the others take 1,379 and more; it loses energy there where they make some.
 * A landing lasts less than such a step, and bdf2 damps what does: without friction or damping a card that falls
 * 50 mm stays down, at 1/240 s as at 1/1000 s, which the verdict says (`damps_below`).
 */
#include "plugins/common/contact/barrier/barrier_bound.h"
#include "plugins/common/contact/barrier/barrier_choice.h"
#include "plugins/common/contact/barrier/barrier_pair.h"
#include "plugins/common/contact/barrier/barrier_sum.h"
#include "plugins/common/contact/friction/friction.h"

#include <float.h>
#include <string.h>

typedef struct barrier {
  double stiffness; /* Pa; NAN: chosen */
  hk_surface_request request;
  hk_tuples leave;
  hk_barrier_contacts contacts;
  hk_friction friction;
  double elastic_slip;                      /* m; NAN: chosen */
  int64_t began;                            /* whether a step was accepted */
  bool checked;                             /* what a checkpoint may have given was looked at */
  int64_t survey_due;                       /* whether the stiffness was not looked at since the last accepted step */
  double chosen, density;                   /* Pa; kg/m^2 */
  double closest, impulse, lost, stiffened; /* m, since the last report; N s; J; J, that a rising stiffness gave */
} barrier;

static const hk_param params[] = {
    {"d_hat", "m", "gap at which the barrier begins; the error of contact is some part of it, and so is the cost",
     .number = HK_AT(barrier, contacts.law.distance), .initial = {1e-3}, .limits = HK_ABOVE(0)},
    {"stiffness", "Pa", "pressure kappa of the barrier; left out: chosen from weights and speeds",
     .number = HK_AT(barrier, stiffness), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"friction", "", "Coulomb's coefficient mu", .number = HK_AT(barrier, friction.coefficient),
     .limits = HK_AT_LEAST(0)},
    {"elastic_slip", "m",
     "displacement below which friction is less than Coulomb's: what sticks has less of it; left out: d_hat/2000",
     .number = HK_AT(barrier, elastic_slip), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"thickness", "m",
     "of cloth: of surfaces of triangles whose particles can move; 0, as d_hat already holds them apart",
     .number = HK_AT(barrier, request.thickness), .limits = HK_AT_LEAST(0)},
    {"body_thickness", "m", "of obstacles: of surfaces that are pinned as a whole",
     .number = HK_AT(barrier, request.body_thickness), .limits = HK_AT_LEAST(0)},
    {"radius", "m", "of strands, bars and isolated particles", .number = HK_AT(barrier, request.radius),
     .initial = {5e-4}, .limits = HK_AT_LEAST(0)},
    {"leave", "",
     "particles that have no part in contact, nor their triangles and edges: insides of solids, roots of hair",
     .particles = HK_AT(barrier, leave), .flags = HK_OPTIONAL},
    {0},
};

static const hk_field fields[] = {
    {"shape", .per_particle = HK_AT(barrier, contacts.shape), .width = 2},
    {"named", .array = HK_AT(barrier, contacts.named), .width = sizeof(hk_feature_pair)},
    {"density", .number = HK_AT(barrier, density)},
    {"survey_due", .integer = HK_AT(barrier, survey_due)},
    {"began", .integer = HK_AT(barrier, began)},
    {"chosen", .number = HK_AT(barrier, chosen)},
    {"closest", .number = HK_AT(barrier, closest)},
    {"impulse", .number = HK_AT(barrier, impulse)},
    {"lost", .number = HK_AT(barrier, lost)},
    {"stiffened", .number = HK_AT(barrier, stiffened)},
    {"sticks", .array = HK_AT(barrier, friction.sticks), .width = sizeof(hk_stick)},
    {"implicit", .integer = HK_AT(barrier, friction.implicit)},
    {"friction_taken", .number = HK_AT(barrier, friction.taken)},
    {"friction_missed", .number = HK_AT(barrier, friction.missed)},
    {"friction_most", .number = HK_AT(barrier, friction.most)},
    {"next_sticks", .array = HK_AT(barrier, friction.next), .width = sizeof(hk_stick), .flags = HK_SCRATCH},
    {"slips", .array = HK_AT(barrier, friction.slips), .width = sizeof(hk_slip), .flags = HK_SCRATCH},
    {"begun", .array = HK_AT(barrier, friction.begun), .width = sizeof(double), .flags = HK_SCRATCH},
    {"first_stick", .array = HK_AT(barrier, friction.first), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"sticks_of", .array = HK_AT(barrier, friction.member), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"near", .array = HK_AT(barrier, contacts.near), .width = sizeof(hk_barrier_pair), .flags = HK_SCRATCH},
    {"base", .array = HK_AT(barrier, contacts.base), .width = sizeof(double), .flags = HK_SCRATCH},
    {"kept_of", .array = HK_AT(barrier, contacts.kept_of), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"halves", .array = HK_AT(barrier, contacts.halves), .width = sizeof(hk_feature_pair), .flags = HK_SCRATCH},
    {"values", .array = HK_AT(barrier, contacts.values), .width = sizeof(hk_barrier_value), .flags = HK_SCRATCH},
    {"tally", .array = HK_AT(barrier, contacts.tally), .width = sizeof(hk_barrier_tally), .flags = HK_SCRATCH},
    {"acting", .array = HK_AT(barrier, contacts.acting), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"at", .array = HK_AT(barrier, contacts.at), .width = sizeof(double), .flags = HK_SCRATCH},
    {"way", .array = HK_AT(barrier, contacts.way), .width = sizeof(double), .flags = HK_SCRATCH},
    {"sums", .array = HK_AT(barrier, contacts.sums), .width = sizeof(double), .flags = HK_SCRATCH},
    {"parts", .array = HK_AT(barrier, contacts.parts), .width = sizeof(double), .flags = HK_SCRATCH},
    {"loads", .array = HK_AT(barrier, contacts.loads), .width = sizeof(double), .flags = HK_SCRATCH},
    {"hessians", .array = HK_AT(barrier, contacts.hessians), .width = sizeof(hk_barrier_hessian), .flags = HK_SCRATCH},
    {"start", .array = HK_AT(barrier, contacts.sorter.start), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"order", .array = HK_AT(barrier, contacts.sorter.order), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {"spare", .array = HK_AT(barrier, contacts.sorter.spare), .width = sizeof(uint32_t), .flags = HK_SCRATCH},
    {0},
};

/* ---- life ---- */

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  barrier *b = self;
  hk_barrier_contacts *c = &b->contacts;
  c->host = host;
  c->surfaces = host->query(host, HK_SURFACES_INTERFACE);
  if (!c->surfaces) return host->fail(host, HK_FAILED, "no service '%s' is installed", HK_SURFACES_INTERFACE);
  if (b->closest == 0) b->closest = INFINITY; /* 0: the run does not go on from a checkpoint */
  b->request.leave = &b->leave;
  b->request.plugin = "barrier";
  b->request.friction = b->friction.coefficient;
  b->friction.elastic_slip = isnan(b->elastic_slip) ? c->law.distance / 2000 : b->elastic_slip;
  return c->surfaces->join(c->surfaces->self, &b->request, view);
}

static hk_status topology(void *self, const hk_view *view) {
  barrier *b = self;
  if (!b->began) b->chosen = b->contacts.law.stiffness = 0;
  hk_status status = hk_barrier_forget(&b->contacts);
  return status == HK_OK ? hk_friction_renumber(&b->friction, view->host, view) : status;
}

/* ---- force ---- */

static hk_status add(void *self, const hk_view *view, double *F) {
  barrier *b = self;
  hk_status status = hk_barrier_add(&b->contacts, view, F);
  if (status != HK_OK) return status;
  double power = hk_friction_add(&b->friction, &b->contacts, view, F);
  if (view->power) *view->power += power;
  return HK_OK;
}

static double energy(void *self, const hk_view *view) { return hk_barrier_energy(&((barrier *)self)->contacts, view); }

static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  barrier *b = self;
  (void)view;
  b->friction.implicit = 1;
  hk_barrier_pattern(&b->contacts, into);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  barrier *b = self;
  hk_status status = hk_barrier_jacobian(&b->contacts, view, into);
  if (status == HK_OK) hk_friction_blocks(&b->friction, &b->contacts, view, into);
  return status;
}

/* ---- contact ---- */

/* m, the least gap of a pair whose force is known to a part in a thousand, which Newton's iteration needs. The force
 * goes as 1/gap near 0, and a distance is off by some four roundings of the largest coordinate or radius. A smaller gap
 * is not opened by an iteration that doubles it each time: the change is lost in the rounding of positions. */
static double least_known(const hk_feature_pair *p, const double *x) {
  double at[12], largest = p->offset;
  hk_pair_gather(p, x, at);
  for (int e = 0; e < 12; e++) largest = fmax(largest, fabs(at[e]));
  return 4e3 * DBL_EPSILON * largest;
}

/* A start, or a correction, that leaves surfaces in contact; of the start, also so near that the force is not known. */
static hk_status refuse_contact(const barrier *b, const hk_view *view) {
  const hk_barrier_pair *near = b->contacts.near.item;
  bool start = !(b->contacts.law.stiffness > 0);
  for (size_t k = 0; k < b->contacts.found; k++) {
    const hk_feature_pair *p = &near[k].pair;
    double least = start ? least_known(p, view->x) : 0;
    if (near[k].pair.gap > least) continue;
    hk_pair_names names = hk_pair_names_of(p, view->model->id);
    return view->host->fail(
        view->host, HK_BAD_PARAM,
        "%s and %s are in contact: their gap is %.3g m with the thickness asked for, where it has to be above %.3g m; "
        "move them apart, or make thickness or radius smaller",
        names.one, names.other, near[k].pair.gap, least);
  }
  return HK_OK;
}

/* Before the first step; a later one finds the choice made. */
static void choose(barrier *b, const hk_view *view) {
  hk_barrier_contacts *c = &b->contacts;
  if (!(b->chosen > 0) && isnan(b->stiffness)) {
    b->density = hk_barrier_density(c, view);
    b->chosen = hk_barrier_chosen(b->density, c->law.distance, hk_barrier_survey_at(c, view).approach, 0);
  }
  c->law.stiffness = isnan(b->stiffness) ? b->chosen : b->stiffness;
}

/* At the start of a step whose pairs were found on the way that velocities predict: so what is about to hit is known
 * before it loads the barrier, and little energy is in it when its stiffness rises. */
static void follow_speeds(barrier *b, const hk_view *from, const double *x_to) {
  if (!b->survey_due || !isnan(b->stiffness) || memcmp(from->x, x_to, 3 * from->n * sizeof *x_to) == 0) return;
  hk_barrier_survey s = hk_barrier_survey_at(&b->contacts, from);
  double before = b->chosen;
  b->survey_due = 0;
  b->chosen = b->contacts.law.stiffness = hk_barrier_chosen(b->density, b->contacts.law.distance, s.approach, before);
  b->stiffened += s.energy * (b->chosen / before - 1);
}

static bool is_pair(const hk_feature_pair *p, size_t n) {
  return p->vertex[0] < n && p->vertex[1] < n && p->vertex[2] < n && p->vertex[3] < n;
}

/* Indices that come from a checkpoint, which may be damaged. */
static hk_status check_pairs(const barrier *b, const hk_view *view) {
  const hk_feature_pair *named = b->contacts.named.item;
  bool fine = true;
  for (size_t k = 0; k < b->contacts.named.count; k++) fine = fine && is_pair(&named[k], view->n);
  if (fine) return HK_OK;
  return view->host->fail(view->host, HK_FAILED,
                          "its contacts name particles that are not there: the checkpoint is "
                          "damaged");
}

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *changed) {
  barrier *b = self;
  hk_status status = b->checked ? HK_OK : check_pairs(b, from);
  if (status == HK_OK && !b->checked) status = hk_friction_renumber(&b->friction, from->host, from);
  b->checked = true;
  if (status == HK_OK) status = hk_barrier_find(&b->contacts, from, x_to, changed);
  if (status == HK_OK) status = refuse_contact(b, from);
  if (status != HK_OK) return status;
  if (!(b->contacts.law.stiffness > 0)) choose(b, from);
  follow_speeds(b, from, x_to);
  return hk_friction_recall(&b->friction, &b->contacts, from);
}

static double step_limit(void *self, const hk_view *from, const double *dx) {
  return hk_barrier_limit(&((barrier *)self)->contacts, from, dx);
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  barrier *b = self;
  hk_barrier_bound(&b->contacts, view, part, block);
  if (part != HK_DAMPING_WHOLE) hk_friction_bound(&b->friction, &b->contacts, view, block);
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  barrier *b = self;
  hk_barrier_survey s = hk_barrier_survey_at(&b->contacts, view);
  b->began = 1;
  b->closest = fmin(b->closest, s.closest);
  b->impulse += h * s.load;
  b->survey_due = 1;
  return hk_friction_remember(&b->friction, &b->contacts, view, h, &b->lost);
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
  for (size_t k = 0; k < c->found; k++) hk_pair_contact_point(&near[k].pair, view->x, c->law.distance, points);
}

/* Of Coulomb's work, what friction may miss in a run that is ok. */
static const double most_missed = 1e-3;

static size_t figures(void *self, const hk_view *view, hk_own_figure *figure) {
  const barrier *b = self;
  (void)view;
  if (!(b->friction.coefficient > 0)) return 0;
  figure[0] =
      (hk_own_figure){"friction_missed", "of its work", hk_friction_missed(&b->friction, &b->contacts), most_missed};
  return 1;
}

static const char *remedy(void *self, const hk_view *view) {
  (void)self, (void)view;
  return "try a smaller elastic_slip or dt; neither was tried";
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_DEPENDS_ON_T | HK_CONSERVES_MOMENTUM | HK_OFFERS_SYMMETRIC |
             HK_OFFERS_DEFINITE | HK_STIFFENS | HK_POWER,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(
        HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_STEPS_FACET(.update = update, .accepted = accepted),
        HK_SURFACES_FACET(.step_limit = step_limit, .contacts = report),
        HK_FIGURES_FACET(.list = figures, .remedy = remedy), HK_PICTURES_FACET(.contact_points = contact_points)),
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
