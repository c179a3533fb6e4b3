/* Rigid groups that the other equations of a scene join as trees: chains, ragdolls, pendulums of bodies. RATTLE's two
 * corrections then take time in proportion to the bodies. The distances within a group have a factor that is made once
 * (rigid/rigid.c) and are eliminated: what they leave of a group is a body with six velocities, and of the equations
 * between two groups, or between one and what is held, a link of at most six rows (rigid/tree.c).
 *
 * A round of SHAKE brings each group closer to its distances by its own factor, looks what the links' equations then
 * are, and moves the bodies, rigid as they were at the start of the step, so that they hold. It is a step of Newton's
 * iteration with the matrix of the start for all equations, whose two halves are each as exact as both together. Where
 * links form a loop, are of more than two groups or more than six rows, or follow from each other, and where the rounds
 * converge slowly, all equations are solved together (constraint_projection.c), from where the rounds began.
 *
 * Invariant: as there, factors are a function of (x, t) alone, which says whether they are those asked for. */
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/rigid/rigid.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 40, PATIENCE = 3 };

/* As those of constraint_projection.c: g left, relative to the largest coordinate, and in parts of that before. */
static const double rounding = 4 * DBL_EPSILON, position_tolerance = 1e-12, tardy = 0.5, foreseen = 0.1,
                    stagnant = 0.25;

static const uint32_t unknown = UINT32_MAX - 1; /* of a particle: it is of no one group, and may move */

/* An equation and the groups that it joins; b may be HK_RIGID_NOTHING. */
typedef struct joined {
  uint32_t a, b, equation;
  size_t block; /* its first, among those that plugins name */
} joined;

struct hk_rigid_links {
  size_t nodes, rows, terms, pairs;
  hk_rigid_node *node;
  uint32_t *equation; /* rows */
  hk_rigid_term *term;
  hk_rigid_pair *pair; /* all rows, if they are in pairs; otherwise there are none */
  double *g;           /* rows */
  double *all;         /* bundles: the multipliers of SHAKE's rounds, 6 x HK_RIGID_BUNDLE each */
  bool kept;           /* the factors are those of kept_x and kept_t */
  double kept_t, *kept_x;
  double *before; /* n x 3: positions before the rounds */
};

/* ---- the trees ---- */

typedef struct search {
  const hk_dynamics *d;
  const hk_rigid_group *group;
  size_t groups;
  const uint32_t *of;
  const bool *kept;
  size_t blocks;
  uint32_t (*pair)[2];
  size_t equations, links;
  joined *list;              /* equations, afterwards sorted by their groups */
  size_t *link;              /* links: the first of their equations, and behind the last */
  size_t *start, *incident;  /* groups: their first in `incident`, which lists links */
  uint32_t *queue, *node_of; /* groups: in the order of the nodes; and their places there */
  size_t *upward;            /* groups: the link to the parent; SIZE_MAX: none */
  bool all_pairs;            /* so far all links are pairs */
  hk_rigid_links *into;
} search;

void hk_rigid_links_close(hk_rigid_links *l) {
  if (!l) return;
  void *arrays[] = {l->node, l->equation, l->term, l->pair, l->g, l->all, l->kept_x, l->before};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  free(l);
}

/* The group of a particle, or of all carriers of a rider; HK_RIGID_NOTHING: it is held to the end of the run. */
static uint32_t group_of(const search *s, uint32_t particle) {
  const hk_rider *r = hk_model_rider(&s->d->state->model, particle);
  if (!r && s->d->state->pin[particle] == HK_PIN_FIXED) return HK_RIGID_NOTHING;
  uint32_t group = s->of[r ? r->carrier[0] : particle];
  for (uint32_t c = 1; r && c < r->carriers; c++)
    if (s->of[r->carrier[c]] != group) group = UINT32_MAX;
  return group == UINT32_MAX ? unknown : group;
}

static bool join(joined *row, uint32_t group) {
  if (group == unknown) return false;
  if (group == HK_RIGID_NOTHING || group == row->a || group == row->b) return true;
  if (row->a != HK_RIGID_NOTHING && row->b != HK_RIGID_NOTHING) return false;
  *(row->a == HK_RIGID_NOTHING ? &row->a : &row->b) = group;
  return true;
}

/* Pins that let go would have to be looked for again. */
static bool holds_for_ever(const search *s) {
  const hk_constraints *c = s->d->constraints;
  for (size_t b = 0; b < c->blocks; b++)
    if (s->d->state->pin[c->list.pair[b][1]] == HK_PIN_FIXED && !hk_constraint_held(s->d, c->pin[b])) return false;
  return true;
}

static int by_groups(const void *a, const void *b) {
  const joined *p = a, *q = b;
  if (p->a != q->a) return p->a < q->a ? -1 : 1;
  if (p->b != q->b) return p->b < q->b ? -1 : 1;
  return (p->equation > q->equation) - (p->equation < q->equation);
}

/* Lists the equations beside those within groups. */
static bool read_equations(search *s) {
  for (size_t b = 0; b < s->blocks; b++) {
    uint32_t e = s->pair[b][0];
    if (b > 0 && e < s->pair[b - 1][0]) return false;
    if (s->kept[e]) continue;
    if (b == 0 || e != s->pair[b - 1][0]) s->list[s->equations++] = (joined){HK_RIGID_NOTHING, HK_RIGID_NOTHING, e, b};
    if (!join(&s->list[s->equations - 1], group_of(s, s->pair[b][1]))) return false;
  }
  for (size_t k = 0; k < s->equations; k++) {
    joined *row = &s->list[k];
    if (row->a == HK_RIGID_NOTHING) return false;
    if (row->a > row->b) *row = (joined){row->b, row->a, row->equation, row->block};
  }
  qsort(s->list, s->equations, sizeof *s->list, by_groups);
  return true;
}

/* Equations of the same groups are a link. */
static bool find_links(search *s) {
  for (size_t k = 0; k < s->equations; k++) {
    const joined *row = &s->list[k];
    if (k == 0 || row->a != row[-1].a || row->b != row[-1].b) s->link[s->links++] = k;
    if (k >= s->link[s->links - 1] + HK_RIGID_ROWS) return false;
  }
  s->link[s->links] = s->equations;
  for (size_t k = 0; k < s->links; k++) {
    const joined *row = &s->list[s->link[k]];
    s->start[row->a + 2]++;
    if (row->b != HK_RIGID_NOTHING) s->start[row->b + 2]++;
  }
  for (size_t g = 0; g < s->groups; g++) s->start[g + 2] += s->start[g + 1];
  for (size_t k = 0; k < s->links; k++) {
    const joined *row = &s->list[s->link[k]];
    s->incident[s->start[row->a + 1]++] = k;
    if (row->b != HK_RIGID_NOTHING) s->incident[s->start[row->b + 1]++] = k;
  }
  return true;
}

static void take(search *s, uint32_t group, size_t upward) {
  s->node_of[group] = (uint32_t)s->into->nodes;
  s->queue[s->into->nodes++] = group;
  s->upward[group] = upward;
}

/* Takes what is linked to those that have been taken; false: links form a loop. */
static bool follow_links(search *s, size_t *done) {
  for (; *done < s->into->nodes; ++*done) {
    uint32_t group = s->queue[*done];
    for (size_t k = s->start[group]; k < s->start[group + 1]; k++) {
      size_t link = s->incident[k];
      const joined *row = &s->list[s->link[link]];
      uint32_t next = row->a == group ? row->b : row->a;
      if (link == s->upward[group]) continue;
      if (next == HK_RIGID_NOTHING || s->node_of[next] != UINT32_MAX) return false;
      take(s, next, link);
    }
  }
  return true;
}

/* Roots are the groups that are linked to what is held, of free trees the first, and groups without a link. */
static bool order(search *s) {
  size_t done = 0;
  memset(s->node_of, 0xff, s->groups * sizeof *s->node_of);
  for (size_t k = 0; k < s->links; k++) {
    const joined *row = &s->list[s->link[k]];
    if (row->b != HK_RIGID_NOTHING) continue;
    if (s->node_of[row->a] != UINT32_MAX) return false;
    take(s, row->a, k);
  }
  if (!follow_links(s, &done)) return false;
  for (uint32_t g = 0; g < s->groups; g++) {
    if (s->node_of[g] != UINT32_MAX) continue;
    take(s, g, SIZE_MAX);
    if (!follow_links(s, &done)) return false;
  }
  return true;
}

static void add_terms(search *s, uint32_t node, const joined *row, uint32_t number) {
  hk_rigid_links *l = s->into;
  for (size_t b = row->block; b < s->blocks && s->pair[b][0] == row->equation; b++) {
    uint32_t group = group_of(s, s->pair[b][1]);
    if (group == HK_RIGID_NOTHING) continue;
    l->term[l->terms++] = (hk_rigid_term){(uint32_t)b, s->pair[b][1], node, number, s->node_of[group] != node};
  }
}

/* The pair that begins with the equation, if any does; false: it is of another kind. */
static bool add_pair(search *s, uint32_t node, const joined *row, uint32_t number) {
  hk_rigid_pair *p = &s->into->pair[s->into->pairs];
  uint32_t end[2];
  int begun = hk_rigid_pair_of(s->d, row->equation, end, p);
  if (begun <= 0) return begun == 0;
  p->node = node, p->row = number, p->equation = s->into->node[node].row + number;
  for (int e = 0; e < 2; e++) {
    uint32_t group = group_of(s, end[e]);
    p->of[e] = group == HK_RIGID_NOTHING ? HK_HELD : s->node_of[group] == node ? HK_OWN : HK_OTHER;
  }
  s->into->pairs++;
  return true;
}

static void fill_node(search *s, uint32_t node) {
  hk_rigid_links *l = s->into;
  hk_rigid_node *n = &l->node[node];
  uint32_t group = s->queue[node];
  const hk_rigid_group *g = &s->group[group];
  size_t link = s->upward[group];
  n->parent = HK_RIGID_NOTHING;
  n->size = g->size;
  for (int k = 0; k < g->size; k++) {
    n->particle[k] = g->particle[k];
    n->mass[k] = 1 / s->d->state->inverse_mass[g->particle[k]];
  }
  n->row = l->rows;
  if (link == SIZE_MAX) return;
  const joined *row = &s->list[s->link[link]];
  uint32_t other = row->a == group ? row->b : row->a;
  if (other != HK_RIGID_NOTHING) n->parent = s->node_of[other];
  n->rows = (uint32_t)(s->link[link + 1] - s->link[link]);
  for (uint32_t r = 0; r < n->rows; r++) {
    l->equation[l->rows++] = row[r].equation;
    add_terms(s, node, &row[r], r);
    s->all_pairs = s->all_pairs && add_pair(s, node, &row[r], r);
  }
}

static bool open_search(search *s) {
  size_t equations = s->d->constraints->equations + 1;
  s->list = malloc(equations * sizeof *s->list);
  s->link = malloc((equations + 1) * sizeof *s->link);
  s->start = calloc(s->groups + 2, sizeof *s->start);
  s->incident = malloc(2 * equations * sizeof *s->incident);
  s->queue = malloc((s->groups + 1) * sizeof *s->queue);
  s->node_of = malloc((s->groups + 1) * sizeof *s->node_of);
  s->upward = malloc((s->groups + 1) * sizeof *s->upward);
  s->into = calloc(1, sizeof *s->into);
  return s->list && s->link && s->start && s->incident && s->queue && s->node_of && s->upward && s->into;
}

static bool open_links(search *s, size_t bundles) {
  hk_rigid_links *l = s->into;
  l->node = calloc(l->nodes + 1, sizeof *l->node);
  l->equation = malloc((s->equations + 1) * sizeof *l->equation);
  l->term = malloc((s->blocks + 1) * sizeof *l->term);
  l->pair = malloc((s->equations + 1) * sizeof *l->pair);
  l->g = malloc((s->equations + 1) * sizeof *l->g);
  l->all = malloc((6 * HK_RIGID_BUNDLE * bundles + 1) * sizeof *l->all);
  l->kept_x = malloc((3 * s->d->state->model.n + 1) * sizeof *l->kept_x);
  l->before = malloc((3 * s->d->state->model.n + 1) * sizeof *l->before);
  return l->node && l->equation && l->term && l->pair && l->g && l->all && l->kept_x && l->before;
}

static void close_search(search *s) {
  void *arrays[] = {s->list, s->link, s->start, s->incident, s->queue, s->node_of, s->upward};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  hk_rigid_links_close(s->into);
}

hk_status hk_rigid_links_find(const hk_dynamics *d, const hk_rigid_group *group, size_t count, const uint32_t *of,
                              const bool *kept, size_t bundles, hk_rigid_links **links) {
  const hk_constraints *c = d->constraints;
  search s = {.d = d, .group = group, .groups = count, .of = of, .kept = kept, .all_pairs = true};
  s.blocks = c->riding.given ? c->riding.given : c->blocks;
  s.pair = c->riding.given ? c->riding.pair : c->list.pair;
  *links = NULL;
  hk_status status = open_search(&s) ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK && holds_for_ever(&s) && read_equations(&s) && find_links(&s) && order(&s)) {
    status = open_links(&s, bundles) ? HK_OK : HK_NO_MEMORY;
    for (uint32_t k = 0; k < s.into->nodes && status == HK_OK; k++) fill_node(&s, k);
    if (!s.all_pairs) s.into->pairs = 0;
    if (status == HK_OK) *links = s.into, s.into = NULL;
  }
  close_search(&s);
  return status;
}

/* ---- the corrections ---- */

/* Makes the factors those of x and t. */
static bool begin(hk_dynamics *d, hk_rigid_links *l, double t, double *x) {
  hk_constraints *c = d->constraints;
  size_t n = d->state->model.n;
  if (l->kept && l->kept_t == t && memcmp(l->kept_x, x, 3 * n * sizeof *x) == 0) return true;
  double(*J)[3] = c->riding.given ? c->riding.J : c->J;
  hk_error before = *d->error;
  l->kept = c->kept = false;
  if (!l->pairs) hk_riders_follow(c->model, x);
  if (hk_dynamics_set_time(d, t) != HK_OK || (!l->pairs && hk_constraint_gradients(d, t, x, x + 3 * n, J) != HK_OK)) {
    *d->error = before; /* the general way meets it again, and says so */
    return false;
  }
  if (l->pairs)
    hk_rigid_pairs_place(d->shared->lanes, l->node, l->nodes, l->pair, l->pairs, x);
  else
    hk_rigid_tree_place(d->shared->lanes, l->node, l->nodes, l->term, l->terms, x, J);
  if (!hk_rigid_tree_factorize(d->shared->lanes, l->node, l->nodes)) return false;
  memcpy(l->kept_x, x, 3 * n * sizeof *x);
  l->kept_t = t;
  l->kept = true;
  return true;
}

static void take_larger(double *most, double g) {
  if (!(fabs(g) <= *most) && !isnan(*most)) *most = fabs(g);
}

/* The groups' half of a round, and the links' equations after it; the largest violation before. NaN: some is unknown.
 */
static double look(hk_dynamics *d, hk_rigid_links *l, const hk_rigid_bundle *bundle, size_t bundles,
                   const hk_rattle_step *s) {
  const hk_constraints *c = d->constraints;
  hk_error before = *d->error;
  double left = 0;
  for (size_t k = 0; k < bundles; k++)
    take_larger(&left,
                hk_rigid_bundle_round(d->shared->lanes, &bundle[k], s->from, s->x, l->all + 6 * HK_RIGID_BUNDLE * k));
  if (l->pairs) {
    hk_rigid_pairs_value(d->shared->lanes, l->pair, l->pairs, s->x, l->g);
  } else {
    hk_riders_follow(c->model, s->x);
    if (hk_constraint_value(d, s->t, s->x, s->v) != HK_OK) {
      *d->error = before;
      return NAN;
    }
    for (size_t r = 0; r < l->rows; r++) l->g[r] = c->g[l->equation[r]];
  }
  for (size_t r = 0; r < l->rows; r++) take_larger(&left, l->g[r]);
  return left;
}

static void move_links(hk_dynamics *d, hk_rigid_links *l, double *x) {
  for (size_t k = 0; k < l->nodes; k++) memset(l->node[k].wrench, 0, sizeof l->node[k].wrench);
  hk_rigid_tree_solve(d->shared->lanes, l->node, l->nodes, l->g);
  for (size_t k = 0; k < l->nodes; k++)
    for (int c = 0; c < HK_RIGID_ROWS; c++) l->node[k].moved[c] += l->node[k].twist[c];
  hk_rigid_tree_turn(d->shared->lanes, l->node, l->nodes, 1, x);
}

/* What the rounds have moved, over h, goes into the velocities at their end, all together. Riders are put where they
 * belong by the evaluation that follows, or by the general way. */
static void push(hk_dynamics *d, const hk_rigid_links *l, const hk_rigid_bundle *bundle, size_t bundles,
                 const hk_rattle_step *s) {
  for (size_t k = 0; k < bundles; k++)
    hk_rigid_bundle_push(d->shared->lanes, &bundle[k], s->from, l->all + 6 * HK_RIGID_BUNDLE * k, 1 / s->h, s->v);
  hk_rigid_tree_push(d->shared->lanes, l->node, l->nodes, 1 / s->h, s->v);
}

bool hk_rigid_links_shake(hk_dynamics *d, hk_rigid_links *l, const hk_rigid_bundle *bundle, size_t bundles,
                          const hk_rattle_step *s) {
  double last = INFINITY, size = hk_rigid_tree_extent(l->node, l->nodes, s->x);
  bool arrived = false;
  int slowly = 0;
  if (!begin(d, l, s->t_from, s->from)) return false;
  memset(l->all, 0, 6 * HK_RIGID_BUNDLE * bundles * sizeof *l->all);
  for (size_t k = 0; k < l->nodes; k++) memset(l->node[k].moved, 0, sizeof l->node[k].moved);
  memcpy(l->before, s->x, 3 * d->state->model.n * sizeof *s->x);
  hk_status status = hk_dynamics_set_time(d, s->t);
  for (int round = 0; round < ROUNDS && status == HK_OK && !arrived && slowly < PATIENCE; round++) {
    double left = look(d, l, bundle, bundles, s);
    if (!isfinite(left) || left > 10 * last) break; /* it diverges */
    arrived = left <= rounding * size || (left <= position_tolerance * size && left > stagnant * last);
    if (arrived) break;
    slowly += left > tardy * last;
    arrived = isfinite(last) && left / last * left <= foreseen * rounding * size;
    last = left;
    move_links(d, l, s->x);
  }
  if (arrived)
    push(d, l, bundle, bundles, s);
  else
    memcpy(s->x, l->before, 3 * d->state->model.n * sizeof *s->x);
  return arrived;
}

bool hk_rigid_links_rattle(hk_dynamics *d, hk_rigid_links *l, double t, double *x, double *v) {
  if (!begin(d, l, t, x)) return false;
  for (size_t r = 0; r < l->rows; r++) l->g[r] = 0;
  hk_rigid_tree_take(d->shared->lanes, l->node, l->nodes, v);
  hk_rigid_tree_solve(d->shared->lanes, l->node, l->nodes, l->g);
  for (const hk_rigid_node *n = l->node; n < l->node + l->nodes; n++)
    for (int i = 0; i < n->size; i++) memset(v + 3 * (size_t)n->particle[i], 0, 3 * sizeof *v);
  hk_rigid_tree_turn(d->shared->lanes, l->node, l->nodes, 1, v);
  hk_riders_follow(d->constraints->model, v);
  return true;
}
