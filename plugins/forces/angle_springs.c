/* Angle springs: bending of chains of particles. Where a chain turns from the edge e_1 = x_j - x_i to e_2 = x_k - x_j
 * by the angle theta, the energy is 1/2 k (theta - theta_0)^2 and the damping -c d(theta)/dt grad theta. In space theta
 * = atan2(|e_1 x e_2|, e_1.e_2), 0 to pi; with `normal` it is measured in the plane across that, with a sign. joint.c
 * has the derivatives, and says what happens where an angle has no direction (folded: no force).
 *
 * A stiffness in N m of a joint is that of one mesh only. Given as EI (N m^2) it is that of the rod: k = EI/l with l
 * half the length of both edges, so that a finer chain bends as a coarse one does, up to its discretisation error of
 * order l^2. Where EI differs between the edges, the halves yield one after the other: 1/k = l_1/(2 EI_1) + l_2/(2
 * EI_2). An edge between two pinned particles is a wall, which does not yield: at a clamp k = 2 EI/l_2, and the rod
 * begins at the second pinned particle. `curvature` (1/m) likewise is the angle at rest per length. */
#include "plugins/common/elements/element_force.h"
#include "plugins/common/joints/joint.h"
#include "plugins/common/joints/joint_jacobian.h"
#include "plugins/common/joints/joint_kernel.h"
#include "plugins/common/joints/joint_list.h"
#include "plugins/common/joints/joint_transposed.h"
#include "plugins/kit/springs/edge_stiffness.h"

typedef struct angle_springs {
  hk_tuples edges, joints;
  hk_per_tuple k, EI, rest, damping;
  double curvature, retardation, normal[3];
  const double *plane; /* the unit normal; NULL: angles in space */
  hk_element_force list;
  hk_joint_layout layout;
} angle_springs;

static const hk_param params[] = {
    {"joints", "", "triples of particles i, j, k, which bend at j", .triangles = HK_AT(angle_springs, joints)},
    {"edges", "", "pairs of particles; where one shares an end with the one before there is a joint",
     .edges = HK_AT(angle_springs, edges)},
    {"EI", "N m^2", "bending stiffness of the rod: k = EI/l, l half the length of both edges; of each edge, or of all",
     .per_tuple = HK_AT(angle_springs, EI), .limits = HK_AT_LEAST(0), .list = "edges"},
    {"k", "N m/rad", "stiffness of a joint, in addition to EI/l", .per_tuple = HK_AT(angle_springs, k),
     .limits = HK_AT_LEAST(0), .list = "joints"},
    {"damping", "N m s/rad", "damping of a joint", .per_tuple = HK_AT(angle_springs, damping), .limits = HK_AT_LEAST(0),
     .list = "joints"},
    {"retardation", "s", "damping as a time, c = retardation k (Kelvin and Voigt), in addition to `damping`",
     .number = HK_AT(angle_springs, retardation), .limits = HK_AT_LEAST(0)},
    {"rest", "rad", "angle at rest; left out: the initial angle", .per_tuple = HK_AT(angle_springs, rest),
     .limits = HK_WITHIN(-3.14159265358979323846, 3.14159265358979323846), .flags = HK_OPTIONAL, .list = "joints"},
    {"curvature", "1/m", "curvature at rest, instead of `rest`", .number = HK_AT(angle_springs, curvature),
     .flags = HK_OPTIONAL},
    {"normal", "", "of the plane in which angles are measured, with a sign; left out: in space",
     .vector = HK_AT(angle_springs, normal), .flags = HK_OPTIONAL},
    {0},
};

static void measure(const angle_springs *s, const double *x, size_t k, hk_joint *joint) {
  const hk_elements *a = &s->list.acting;
  hk_joint_measure(x, hk_tuple(&a->node, k), s->plane, hk_tuple_value(&a->rest, k) == 0, joint);
}

static void gradient(const hk_joint *joint, double dC[3][3]) {
  for (int c = 0; c < 3; c++) {
    double g1 = joint->l[0] > 0 ? joint->across[0][c] / joint->l[0] : 0;
    double g2 = joint->l[1] > 0 ? joint->across[1][c] / joint->l[1] : 0;
    dC[0][c] = -g1;
    dC[1][c] = g1 - g2;
    dC[2][c] = g2;
  }
}

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const angle_springs *s = self;
  for (size_t k = begin; k < end; k++, dC += 3) {
    hk_joint joint;
    measure(s, x, k, &joint);
    C[k - begin] = hk_joint_off(joint.angle, hk_tuple_value(&s->list.acting.rest, k));
    gradient(&joint, dC);
  }
}

/* ---- the force ---- */

static hk_status topology(void *self, const hk_view *view) {
  angle_springs *s = self;
  hk_status status = hk_element_force_take(&s->list, view, &s->joints, &s->k, &s->damping, &s->rest);
  return status == HK_OK ? hk_joint_layout_build(&s->layout, view, &s->list.acting) : status;
}

static hk_status check(const angle_springs *s, const hk_host *host) {
  if (!s->edges.count && !s->joints.count)
    return host->fail(host, HK_BAD_PARAM, "edges or joints are required: where should there be joints?");
  if (!isnan(s->curvature) && s->rest.count) return host->fail(host, HK_BAD_PARAM, "give rest or curvature, not both");
  if (s->plane) return HK_OK;
  for (size_t k = 0; k < s->rest.count; k++)
    if (s->rest.value[k] < 0)
      return host->fail(host, HK_BAD_PARAM, "rest: %g rad: an angle in space has no sign; give the normal of a plane",
                        s->rest.value[k]);
  if (s->curvature < 0)
    return host->fail(host, HK_BAD_PARAM, "curvature: %g/m: an angle in space has no sign; give the normal of a plane",
                      s->curvature);
  return HK_OK;
}

static hk_status set_plane(angle_springs *s, const hk_host *host) {
  double length = sqrt(s->normal[0] * s->normal[0] + s->normal[1] * s->normal[1] + s->normal[2] * s->normal[2]);
  if (isnan(length)) return HK_OK;
  if (!(length > 0 && length < INFINITY)) return host->fail(host, HK_BAD_PARAM, "normal: must not be zero");
  for (int c = 0; c < 3; c++) s->normal[c] /= length;
  s->plane = s->normal;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  angle_springs *s = self;
  s->list = (hk_element_force){.acting = {.values = 1, .evaluate = evaluate, .self = s}};
  hk_status status = set_plane(s, host);
  if (status == HK_OK) status = check(s, host);
  const hk_joint_numbers numbers = {&s->k, &s->EI, &s->damping, &s->rest, s->curvature, s->retardation};
  if (status == HK_OK) status = hk_joint_list_make(view, &s->edges, &s->joints, &numbers);
  return status == HK_OK ? topology(self, view) : status;
}

static void add_part(void *self, const hk_view *view, size_t part, double *F) {
  const angle_springs *s = self;
  hk_joint_forces(&s->layout, view, s->plane, part, F);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  add_part(self, view, HK_ALL_PARTS, F);
  return HK_OK;
}

static void parts(void *self, const hk_view *view, const hk_part_use *use) {
  const hk_joint_layout *l = &((const angle_springs *)self)->layout;
  const hk_tuples nodes = hk_joint_nodes(l);
  (void)view;
  hk_part_lists_touch(&l->sums.lists, &nodes, use);
}

static double energy(void *self, const hk_view *view) {
  const angle_springs *s = self;
  return hk_element_force_energy(&s->list, view);
}

static void elements(void *self, const hk_view *view, hk_elements *out) {
  const angle_springs *s = self;
  (void)view;
  *out = s->list.acting;
  out->rest = (hk_per_tuple){0}; /* no strain: joints that are straight at rest have no angle to refer to */
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  const angle_springs *s = self;
  (void)view;
  hk_element_force_pattern(&s->list, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const angle_springs *s = self;
  hk_joint_jacobian(&s->layout, view, s->plane, into);
  return HK_OK;
}

/* ---- transposed ---- */

enum { STIFFNESS = 3, DAMPING = 4, REST = 6, NORMAL = 8 }; /* rows of the table */

/* Goes through the list along with those that act. */
typedef struct slopes {
  const angle_springs *self;
  const hk_view *view;
  double *const *row;
  size_t next;
} slopes;

static void add_slopes(void *context, double by_k, double by_c, double by_rest) {
  slopes *to = context;
  while (!hk_joint_acts(to->view, hk_tuple(&to->self->joints, to->next))) to->next++;
  to->row[STIFFNESS][to->next] += by_k;
  to->row[DAMPING][to->next] += by_c;
  to->row[REST][to->next++] += by_rest;
}

static hk_status transposed(void *self, const hk_view *view, const double *u, const hk_transposed *into) {
  const angle_springs *s = self;
  slopes to = {s, view, into->parameter, 0};
  hk_joint_transposed(&s->list.acting, view, s->plane, u, into->x, into->v, into->parameter ? add_slopes : NULL, &to);
  return HK_OK;
}

static hk_status along(void *self, const hk_view *view, const hk_tangent *directions, size_t count) {
  const angle_springs *s = self;
  const hk_joint_rows rows = {STIFFNESS, DAMPING, REST};
  hk_joint_along(&s->list.acting, view, s->plane, &s->joints, &rows, directions, count);
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const angle_springs *s = self;
  for (size_t e = 0; e < s->layout.count; e++) {
    const uint32_t *node = s->layout.node[e];
    double along[2], across[2];
    hk_joint_state now;
    hk_joint_evaluate(&s->layout, view, s->plane, e, &now);
    if (part == HK_DAMPING_WHOLE)
      hk_joint_bound(&now.joint, now.c, 0, true, along, across);
    else
      hk_joint_bound(&now.joint, now.k, now.moment, part == HK_STIFFNESS_WHOLE, along, across);
    for (int m = 0; m < 2; m++) hk_edge_stiffness_add(view, node + m, now.joint.t[m], along[m], across[m], block);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force), /* The moment of momentum is kept by angles in space, not by those in a plane when a chain
                                 leaves it. */
    .flags =
        HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_POWER | HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .add_part = add_part,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian, .transposed = transposed,
                                          .not_by = 1 << NORMAL, .along = along),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ELEMENTS_FACET(.list = elements),
                        HK_PARTS_FACET(.touch = parts)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "angle_springs",
    .summary = "bending of chains, E = 1/2 k (theta - theta_0)^2 at every joint, k given or EI/l",
    .reference = "Rosenblum, Carlson and Tripp 1991, Simulating the structure and dynamics of human hair; Hairer and "
                 "Wanner 1996, Solving Ordinary Differential Equations II, IV.1 (beam)",
    .instance_size = sizeof(angle_springs),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
