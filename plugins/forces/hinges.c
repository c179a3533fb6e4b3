/* Surfaces that resist bending: every two triangles that share an edge are a hinge, which has the energy
 * 1/2 k (theta - theta_0)^2, theta the angle between their normals (plugins/common/shells/hinge.c, with its exact
 * gradient and Hessian) and theta_0 that at rest, and the damping -c dtheta/dt dtheta/dx. k and c come from numbers of
 * the material by area; plugins/common/shells/bending.c says how, and which plate that is.
 *
 * Invariant: `turned` has the angle of every hinge of the start at the last accepted step, counted on through pi and
 * whole turns, to a quarter of a turn. The angle of a state is that of its positions up to multiples of 2 pi, and of
 * those the one nearest to `turned`: so a hinge that folds beyond pi is pushed back the way it came. A hinge has no
 * force while one of its triangles has no area (is thinner than 1e-12 of its edge). */
#include "plugins/common/shells/hinge_kernel.h"
#include "plugins/common/shells/hinge_lane.h"

#include <string.h>

typedef struct hinges {
  hk_bending bending; /* first member */
  hk_bending_params given;
  double *rest; /* of all hinges of the start, rad */
  hk_array turned;
} hinges;

static const hk_param params[] = {
    HK_BENDING_PARAMS(hinges, given),
    {"damping", "N m s", "the same for the rate of bending: B times the time in which the material creeps",
     .per_tuple = HK_AT(hinges, given.damping), .limits = HK_AT_LEAST(0), .list = "hinges"},
    {"rest", "rad", "angle at rest, 0: flat; left out: the initial angle", .per_tuple = HK_AT(hinges, given.rest),
     .flags = HK_OPTIONAL, .list = "hinges"},
    {0},
};

static const hk_field fields[] = {
    {"turned", .array = HK_AT(hinges, turned), .width = sizeof(double), .flags = HK_COUNTED},
    {0},
};

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hinges *h = self;
  const double *turned = h->turned.item;
  for (size_t k = begin; k < end; k++, C++, dC += 4) {
    size_t q = h->bending.number[k];
    if (hk_hinge_angle(x, hk_tuple(&h->bending.element.acting.node, k), C, dC))
      *C = hk_hinge_unwrap(*C, turned[q]) - h->rest[q];
  }
}

static void hessian(const void *self, const double *x, size_t k, unsigned e, double *H) {
  const hinges *h = self;
  (void)e;
  hk_hinge_hessian(x, hk_tuple(&h->bending.element.acting.node, k), H);
}

/* Angles at rest and at the start. At the start every hinge of the list is an element, in its order. */
static hk_status begin(hinges *h, const hk_view *view) {
  const hk_host *host = view->host;
  size_t count = h->bending.count;
  h->rest = host->allocate(host, (count + 1) * sizeof *h->rest);
  if (!h->rest) return host->fail(host, HK_NO_MEMORY, "no memory for %zu hinges", count);
  hk_status status = host->resize(host, &h->turned, count);
  for (size_t k = 0; k < count && status == HK_OK; k++) {
    double angle, *turned = h->turned.item;
    hk_hinge_angle(view->x, hk_tuple(&h->bending.element.acting.node, k), &angle, NULL);
    h->rest[k] = h->given.rest.count ? hk_tuple_value(&h->given.rest, k) : angle;
    turned[k] = hk_hinge_unwrap(angle, h->rest[k]);
  }
  return status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  hinges *h = self;
  (void)host;
  h->bending.element = (hk_element_force){.acting = {.values = 1, .evaluate = evaluate, .self = h}, .hessian = hessian};
  hk_status status = hk_bending_create(&h->bending, view, &h->given);
  return status == HK_OK ? begin(h, view) : status;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  const hinges *h = self;
  hk_hinge_forces(&h->bending, h->rest, h->turned.item, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const hinges *h = self;
  hk_hinge_forces(&h->bending, h->rest, h->turned.item, view, part, F);
}

static bool damped(const hinges *h) {
  const hk_elements *a = &h->bending.element.acting;
  for (size_t k = 0; k < a->node.count; k++)
    if (a->damping.value[k] != 0) return true;
  return false;
}

/* How the direction of the damping turns is not symmetric, and rarely asked for: hinge by hinge. */
static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const hinges *h = self;
  if (!(into->want & (HK_WANT_SYMMETRIC | HK_WANT_DEFINITE)) && damped(h)) return hk_bending_jacobian(self, view, into);
  hk_hinge_blocks(&h->bending, h->rest, h->turned.item, view, into);
  return HK_OK;
}

/* An open hinge is left at its whole turn: then its angle is needed in folds alone. */
static void follow(void *context, size_t begin, size_t end, size_t chunk) {
  const void *const *of = context;
  const hinges *h = of[0];
  const double *x = of[1];
  double *turned = h->turned.item, angle;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const uint32_t *member = hk_tuple(&h->bending.element.acting.node, k);
    double *near = &turned[h->bending.number[k]];
    if (hk_hinge_is_open(x, member))
      *near = hk_hinge_unwrap(0, *near);
    else if (hk_hinge_angle(x, member, &angle, NULL))
      *near = hk_hinge_unwrap(angle, *near);
  }
}

static hk_status accepted(void *self, const hk_view *view, double step) {
  const hinges *h = self;
  const void *of[2] = {h, view->x};
  (void)step;
  view->host->parallel_for(view->host, h->bending.element.acting.node.count, HK_BENDING_GRAIN, follow, of);
  return HK_OK;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const hinges *h = self;
  hk_hinge_transposed(&h->bending, h->rest, h->turned.item, view, &h->given, u, into);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const hinges *h = self;
  hk_hinge_along(&h->bending, h->rest, h->turned.item, view, &h->given, directions, count);
  return HK_OK;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = hk_bending_energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_bending_pattern, .jacobian = jacobian, .transposed = transposed,
                                          .of_start = true, .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = hk_bending_stiffness_bound),
                        HK_ELEMENTS_FACET(.list = hk_bending_elements), HK_PARTS_FACET(.touch = hk_bending_parts),
                        HK_STEPS_FACET(.accepted = accepted, .keeps_branch = true)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "hinges",
    .summary = "surfaces resist bending at their edges, E = 1/2 k (theta - theta_0)^2, k from a rigidity",
    .reference = "Grinspun, Hirani, Desbrun and Schroeder 2003, Discrete shells; Tamstorf and Grinspun 2013, Discrete "
                 "bending forces and their Jacobians",
    .instance_size = sizeof(hinges),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = hk_bending_topology,
    .force = &force,
};
