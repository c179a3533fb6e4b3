/* Gravitation between bodies, with Plummer's softening: with d = x_j - x_i and s^2 = d^2 + softening^2,
 *     F_i = sum_j G m_i m_j d/s^3,      energy = -sum over pairs G m_i m_j/s.
 * Two bodies at one place have no force on each other with softening; without, it is infinite, which is an error. */
#include "plugins/common/gravity/direct_sum.h"
#include "plugins/common/gravity/flybys.h"
#include "plugins/common/gravity/pair_blocks.h"
#include "plugins/common/gravity/tree/tree_errors.h"

#include <string.h>

typedef struct nbody {
  double G, softening;
  hk_tuples sources;
  bool among;
  bool chosen;     /* there are sources, whose last one may have died */
  bool *is_source; /* n */
  double *pull;    /* n, of stiffness_bound */
  int method;
  hk_tree_accuracy accuracy;
  hk_gravity_bodies bodies;
  hk_gravity_tree tree;
  const hk_octrees *octrees;
  const hk_host *host;
} nbody;

enum { AUTO, DIRECT, TREE };

/* Where nothing is said: the tree is faster from 2000 bodies on, three times at this number (tests/bench/nbody.c);
 * below it all pairs take 0.06 s, and have no error. */
enum { TREE_FROM = 8192 };

static const hk_param params[] = {
    {"G", "m^3/(kg s^2)", "gravitational constant", .number = HK_AT(nbody, G), .initial = {6.67430e-11},
     .limits = HK_AT_LEAST(0)},
    {"softening", "m", "added to distances in quadrature; 0: point masses", .number = HK_AT(nbody, softening),
     .limits = HK_WITHIN(0, 1e150)},
    {"sources", "", "only pairs with one of these or two act; left out: all pairs", .particles = HK_AT(nbody, sources),
     .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"among", "", "whether the sources attract each other as well", .boolean = HK_AT(nbody, among), .initial = {1}},
    {"method", "", "sum over all pairs, or an octree; auto: by the number of bodies", .choice = HK_AT(nbody, method),
     .choices = "auto|direct|tree"},
    {"alpha", "", "of the tree: error that a cell may have, as a part of the body's acceleration",
     .number = HK_AT(nbody, accuracy.alpha), .initial = {0.005}, .limits = HK_WITHIN(0, 1)},
    {"opening_angle", "rad", "of the tree, instead of alpha: the angle below which a cell is taken whole",
     .number = HK_AT(nbody, accuracy.angle), .limits = HK_WITHIN(0, 1), .flags = HK_OPTIONAL},
    {0},
};

/* ---- the bodies ---- */

static bool uses_tree(const nbody *p, const hk_view *view) {
  return !p->chosen && (p->method == TREE || (p->method == AUTO && view->acting >= TREE_FROM));
}

static hk_status topology(void *self, const hk_view *view) {
  nbody *p = self;
  p->host->release(p->host, p->is_source);
  p->host->release(p->host, p->pull);
  p->is_source = p->host->allocate(p->host, view->n * sizeof *p->is_source);
  p->pull = p->host->allocate(p->host, view->n * sizeof *p->pull);
  if (!p->is_source || !p->pull || hk_gravity_reserve(&p->bodies, p->host, view->n) != HK_OK ||
      (uses_tree(p, view) && hk_tree_reserve(&p->tree, p->host, view->n) != HK_OK))
    return p->host->fail(p->host, HK_NO_MEMORY, "no memory for %zu bodies", view->n);
  for (size_t k = 0; k < p->sources.count; k++) p->is_source[p->sources.index[k]] = true;
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  nbody *p = self;
  p->host = host;
  p->chosen = p->sources.count > 0;
  if (view->model->box)
    return host->fail(host, HK_BAD_PARAM,
                      "gravity reaches all images of a periodic box, and no sum over them (Ewald's) is made: leave "
                      "scene:periodic out, or take a force with a cut-off");
  if (p->chosen && p->method == TREE)
    return host->fail(host, HK_BAD_PARAM,
                      "method: a tree sums over all pairs, and `sources` chooses some: use \"direct\"");
  p->octrees = host->query(host, "octree/1");
  if (!p->octrees)
    return host->fail(host, HK_FAILED,
                      "it needs the service 'octree/1', and no plugin of that name is installed in services/; see: "
                      "hooke plugins");
  return topology(self, view);
}

static void destroy(void *self, const hk_host *host) {
  hk_gravity_release(&((nbody *)self)->bodies);
  hk_tree_release(&((nbody *)self)->tree, host);
}

static uint32_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : (uint32_t)k; }

/* Sources first. */
static void order_bodies(nbody *p, const hk_view *view) {
  hk_gravity_bodies *g = &p->bodies;
  g->count = 0;
  for (size_t k = 0; k < view->acting; k++)
    if (!p->chosen || p->is_source[acting(view, k)]) g->order[g->count++] = acting(view, k);
  g->sources = g->count;
  g->mutual = !p->chosen || p->among;
  for (size_t k = 0; k < view->acting && p->chosen; k++)
    if (!p->is_source[acting(view, k)]) g->order[g->count++] = acting(view, k);
}

/* The bodies in the order of the sum: that of the tree, with its moments, or sources first. */
static hk_status gather(nbody *p, const hk_view *view) {
  hk_octree octree;
  order_bodies(p, view);
  if (!uses_tree(p, view)) {
    hk_gravity_gather(&p->bodies, view->x, view->model->mass, p->softening);
    return HK_OK;
  }
  hk_status status = p->octrees->tree(p->octrees->self, view, view->x, view->active, view->acting, &octree);
  if (status != HK_OK) return status;
  if (octree.points) memcpy(p->bodies.order, octree.order, octree.points * sizeof *octree.order);
  hk_gravity_gather(&p->bodies, view->x, view->model->mass, p->softening);
  hk_tree_moments(&p->tree, &p->bodies, &octree, &p->accuracy);
  return HK_OK;
}

/* ---- force and energy ---- */

static hk_status fail_coincident(const nbody *p, const hk_view *view) {
  uint32_t pair[2] = {0};
  hk_gravity_coincident(&p->bodies, pair);
  const double *x = view->x + 3 * (size_t)pair[0];
  const uint32_t *id = view->model->id;
  return p->host->fail(
      p->host, HK_FAILED,
      "particles %u and %u are both at (%g, %g, %g) m at t = %g s, where their force is infinite: move "
      "one of them, or give a softening",
      id[pair[0]], id[pair[1]], x[0], x[1], x[2], view->t);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  nbody *p = self;
  hk_status status = gather(p, view);
  if (status != HK_OK) return status;
  bool apart = uses_tree(p, view) ? hk_tree_forces(&p->tree, &p->bodies, &p->accuracy, p->G, F)
                                  : hk_direct_forces(&p->bodies, p->G, F);
  return apart ? HK_OK : fail_coincident(p, view);
}

static double energy(void *self, const hk_view *view) {
  nbody *p = self;
  if (gather(p, view) != HK_OK) return NAN;
  return uses_tree(p, view) ? hk_tree_energy(&p->tree, &p->bodies, &p->accuracy, p->G)
                            : hk_direct_energy(&p->bodies, p->G);
}

/* ---- errors of the tree ---- */

static bool errors(void *self, const hk_view *view, hk_force_errors *out) {
  nbody *p = self;
  if (!uses_tree(p, view) || view->acting == 0 || gather(p, view) != HK_OK) return false;
  hk_tree_errors(&p->tree, &p->bodies, &p->accuracy, p->G, view->v, out);
  return true;
}

/* Errors of Plummer spheres of 1e4 bodies go as alpha to the power of 0.58 (below 0.002) to 0.75, and as the third
 * power of the angle. */
static void sharpen(void *self, double part) {
  hk_tree_accuracy *a = &((nbody *)self)->accuracy;
  a->alpha *= pow(part, 1 / 0.58);
  a->angle *= sqrt(part);
}

/* ---- implicit steps and stable ones ---- */

static void pattern(void *self, const hk_view *view, hk_pattern *pattern) {
  nbody *p = self;
  order_bodies(p, view);
  if (p->bodies.count <= HK_PAIR_BLOCKS_MOST) hk_pair_pattern(&p->bodies, pattern);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  nbody *p = self;
  order_bodies(p, view);
  if (p->bodies.count > HK_PAIR_BLOCKS_MOST)
    return p->host->fail(
        p->host, HK_FAILED,
        "an implicit method needs a block for each of the pairs of %zu bodies, and %d is the most: use "
        "an explicit integrator (leapfrog, blanes_moan, dopri5)",
        p->bodies.count, HK_PAIR_BLOCKS_MOST);
  hk_pair_jacobian(&p->bodies, view, p->G, p->softening, into);
  return HK_OK;
}

/* A pair's K is at most G m_i m_j/s^3 |u_i - u_j|^2, and |u_i - u_j|^2 <= 2 |u_i|^2 + 2 |u_j|^2. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  nbody *p = self;
  if (part == HK_DAMPING_WHOLE || gather(p, view) != HK_OK) return;
  if (uses_tree(p, view))
    hk_tree_stiffness(&p->tree, &p->bodies, p->G, p->pull);
  else
    hk_direct_stiffness(&p->bodies, p->G, p->pull);
  for (size_t k = 0; k < p->bodies.count; k++) {
    uint32_t i = p->bodies.order[k];
    double bound = 2 * view->model->mass[i] * p->pull[k];
    block[i][0] += bound, block[i][3] += bound, block[i][5] += bound;
  }
}

/* ---- flybys ---- */

static bool acts(const void *self, uint32_t i, uint32_t j) {
  const nbody *p = self;
  if (!p->chosen) return true;
  return p->among ? p->is_source[i] || p->is_source[j] : p->is_source[i] != p->is_source[j];
}

static bool encounters(const void *self, const hk_view *to, const double *x_from, hk_encounters *into) {
  const nbody *p = self;
  hk_octree tree;
  hk_flybys f = {p->G, p->softening, to, x_from, into, acts, self};
  if (hk_flybys_possible(&f) && p->octrees->tree(p->octrees->self, to, to->x, to->active, to->acting, &tree) == HK_OK)
    hk_flybys_find(&f, &tree);
  return true;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ENCOUNTERS_FACET(.find = encounters),
                        HK_APPROXIMATION_FACET(.errors = errors, .sharpen = sharpen)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "nbody",
    .summary = "gravitation between bodies, F = G m_i m_j d/s^3, s^2 = d^2 + softening^2",
    .reference = "Newton 1687; softening: Plummer 1911, MNRAS 71; Aarseth 1963, MNRAS 126",
    .instance_size = sizeof(nbody),
    .params = params,
    .create = create,
    .destroy = destroy,
    .topology = topology,
    .force = &force,
};
