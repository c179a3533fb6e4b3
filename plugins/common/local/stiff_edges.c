/* Springs are put into classes by their own squared frequency r = k (1/m_i + 1/m_j), an octave each, and for every
 * class the work is foretold of taking it and all stiffer ones in short steps, with every shift of the filter
 * (local_filter.h); the least is chosen.
 *
 * For all u and any positions, u.K u <= sum_e r_e (m_i u_i^2 + m_j u_j^2): no squared frequency of a set of springs is
 * above the largest sum of r over the springs of one particle. That bounds the stiff part, component by component (and
 * gives the numbers of short steps), and estimates what is left (whose limit the host then measures). */
#include "plugins/common/local/stiff_edges.h"
#include "plugins/common/local/local_filter.h"

#include <string.h>

enum { CLASSES = 40, GROUPS = 40, SHIFTS = sizeof hk_local_shifts / sizeof *hk_local_shifts };

/* Work is counted in springs of a whole evaluation, of 1.6 ns on Zen 5. A spring is gathered once a long step; each
 * brings up to two particles. Groups have calls of their own. */
static const double work_of_evaluation = 100, work_of_spring = 2, work_of_gathering = 6, work_of_call = 30;
/* The largest damping ratio of a spring taken. Damped once a long step, springs of more leave no room to the others in
 * steps that all but resolve them, x = 2 to 20 (local_filter.h): longer steps would be stable, and some shorter ones
 * not. */
static const double most_damped = 0.06;
static const double worth = 0.8; /* part of leapfrog's work below which local steps are taken */

/* A particle, and, at the root of its tree, the component of the springs taken so far. */
typedef struct node {
  uint32_t parent, springs;
  double all, all_damping, stiff, damping; /* sums over its springs of r and of their damping rates; of those taken */
  double bound, rate, retardation;         /* of the component, as hk_local_modes */
} node;

typedef struct choice {
  const hk_model *model;
  double stiffest;        /* 1/s^2 */
  size_t in[CLASSES];     /* springs of a class */
  double damped[CLASSES]; /* s, their largest damping over stiffness */
  node *node;             /* n */
} choice;

/* Components, by octaves of their bounds. */
typedef struct group {
  hk_local_modes modes;
  size_t springs;
} group;

/* The groups of the springs taken, and bounds of the others, 1/s^2 and 1/s. */
typedef struct cut {
  int classes; /* taken; 0: none */
  group group[GROUPS];
  double rest, damped;
} cut;

typedef struct offer {
  double work, shift;
  int classes;
} offer;

static double damping_of(const hk_elements *list, size_t e) {
  return list->damping.count ? hk_tuple_value(&list->damping, e) : 0;
}

static double rate(const hk_model *model, const hk_elements *list, size_t e) {
  const uint32_t *pair = hk_tuple(&list->node, e);
  return hk_tuple_value(&list->stiffness, e) * (model->inverse_mass[pair[0]] + model->inverse_mass[pair[1]]);
}

static double damping_rate(const hk_model *model, const hk_elements *list, size_t e) {
  const uint32_t *pair = hk_tuple(&list->node, e);
  return damping_of(list, e) * (model->inverse_mass[pair[0]] + model->inverse_mass[pair[1]]);
}

static int class_of(const choice *c, double r) {
  return r > 0 ? (int)fmin(CLASSES - 1, log2(c->stiffest / r)) : CLASSES - 1;
}

static bool takes_part(const hk_element_list *list) { return list->acts && hk_elements_are_edges(&list->elements); }

/* Calls visit for every spring that may be taken. */
static void each(choice *c, void *context, void (*visit)(choice *, void *, const hk_elements *, size_t e, double r)) {
  for (size_t l = 0; l < c->model->element_lists; l++) {
    const hk_element_list *list = &c->model->element_list[l];
    for (size_t e = 0; takes_part(list) && e < list->elements.node.count; e++)
      visit(c, context, &list->elements, e, rate(c->model, &list->elements, e));
  }
}

static void find_stiffest(choice *c, void *context, const hk_elements *list, size_t e, double r) {
  (void)context, (void)list, (void)e;
  c->stiffest = fmax(c->stiffest, r);
}

static void count(choice *c, void *context, const hk_elements *list, size_t e, double r) {
  const uint32_t *pair = hk_tuple(&list->node, e);
  double damping = damping_of(list, e);
  int octave = class_of(c, r);
  (void)context;
  c->in[octave]++;
  if (damping > 0) c->damped[octave] = fmax(c->damped[octave], damping / hk_tuple_value(&list->stiffness, e));
  for (int end = 0; end < 2; end++) {
    c->node[pair[end]].all += r;
    c->node[pair[end]].all_damping += damping_rate(c->model, list, e);
  }
}

static uint32_t root_of(const choice *c, uint32_t i) {
  node *all = c->node;
  while (all[i].parent != i) i = all[i].parent = all[all[i].parent].parent;
  return i;
}

static void add_class(choice *c, void *context, const hk_elements *list, size_t e, double r) {
  if (class_of(c, r) != *(const int *)context) return;
  const uint32_t *pair = hk_tuple(&list->node, e);
  for (int end = 0; end < 2; end++) {
    c->node[pair[end]].stiff += r;
    c->node[pair[end]].damping += damping_rate(c->model, list, e);
  }
  uint32_t p = root_of(c, pair[0]), q = root_of(c, pair[1]);
  node *root = &c->node[p], *other = &c->node[q];
  double damping = damping_of(list, e), k = hk_tuple_value(&list->stiffness, e);
  root->springs++;
  root->retardation = fmax(root->retardation, damping > 0 ? damping / k : 0);
  if (p == q) return;
  other->parent = p;
  root->springs += other->springs;
  root->retardation = fmax(root->retardation, other->retardation);
}

/* ---- the work ---- */

/* Bounds of the components, and of what is not taken; the largest bound of a component. */
static double bound_all(choice *c, cut *found) {
  double most = 0;
  for (size_t i = 0; i < c->model->n; i++) c->node[i].bound = c->node[i].rate = 0;
  for (uint32_t i = 0; i < c->model->n; i++) {
    const node *p = &c->node[i];
    node *root = &c->node[root_of(c, i)];
    root->bound = fmax(root->bound, p->stiff);
    root->rate = fmax(root->rate, p->damping);
    most = fmax(most, p->stiff);
    found->rest = fmax(found->rest, p->all - p->stiff);
    found->damped = fmax(found->damped, p->all_damping - p->damping);
  }
  return most;
}

static void find_groups(choice *c, cut *found) {
  double most = bound_all(c, found);
  for (uint32_t i = 0; i < c->model->n; i++) {
    const node *p = &c->node[i];
    if (p->parent != i || p->springs == 0) continue;
    group *g = &found->group[p->bound > 0 ? (int)fmin(GROUPS - 1, log2(most / p->bound)) : GROUPS - 1];
    hk_local_modes *m = &g->modes;
    m->softest = g->springs ? fmin(m->softest, p->bound) : p->bound;
    m->stiffest = fmax(m->stiffest, p->bound);
    m->damping = fmax(m->damping, p->rate);
    m->retardation = fmax(m->retardation, p->retardation);
    g->springs += p->springs;
  }
}

static double room_of(const cut *taken, double shift, double h) {
  double room = 1;
  for (int k = 0; k < GROUPS; k++)
    if (taken->group[k].springs) room = fmin(room, hk_local_room(&taken->group[k].modes, shift, h));
  return room;
}

/* s, the largest step at which (h w)^2 + 4 h g <= 4 room, by iteration from above, as shorter steps have less room; 0:
 * there is none within a twentieth of what the other springs alone would allow. */
static double step_of(const cut *taken, double shift) {
  double w2 = taken->rest, g = taken->damped, room = 1, most = 0;
  for (int turn = 0; turn < 20; turn++) {
    double h = 2 * room / (g + sqrt(g * g + w2 * room));
    most = fmax(most, h);
    double now = room_of(taken, shift, h);
    if (!(now > 0) || h < most / 20) return 0;
    if (now > 0.99 * room) return h;
    room = now;
  }
  return 0;
}

/* The work of a second, with the best shift. */
static offer weigh(const cut *taken, double whole) {
  offer best = {.work = INFINITY, .shift = *hk_local_shifts, .classes = taken->classes};
  for (size_t k = 0; k < SHIFTS && taken->rest > 0; k++) {
    double shift = hk_local_shifts[k], h = step_of(taken, shift), work = whole;
    for (int j = 0; j < GROUPS && h > 0; j++) {
      const group *g = &taken->group[j];
      if (g->springs == 0) continue;
      double p = hk_local_count(h * h * g->modes.stiffest, shift);
      work += p * work_of_call + (double)g->springs * (p * work_of_spring + work_of_gathering);
    }
    if (h > 0 && work / h < best.work) best.work = work / h, best.shift = shift;
  }
  return best;
}

static offer best_offer(choice *c, size_t edges) {
  double whole = work_of_evaluation + (double)(edges + c->model->n);
  size_t taken = 0;
  cut found = {0};
  find_groups(c, &found);
  offer best = weigh(&found, whole);
  best.work *= worth;
  for (int octave = 0; octave < CLASSES && 2 * taken < edges; octave++) {
    if (c->in[octave] == 0) continue;
    if (c->damped[octave] * sqrt(ldexp(c->stiffest, -octave)) > 2 * most_damped) break;
    each(c, &octave, add_class);
    taken += c->in[octave];
    found = (cut){.classes = octave + 1};
    find_groups(c, &found);
    offer next = weigh(&found, whole);
    if (next.work < best.work) best = next;
  }
  return best;
}

typedef struct collector {
  hk_stiff_edges *into;
  int classes;
} collector;

static void collect(choice *c, void *context, const hk_elements *list, size_t e, double r) {
  const collector *to = context;
  hk_stiff_edges *s = to->into;
  if (class_of(c, r) >= to->classes) return;
  memcpy(s->pair[s->count], hk_tuple(&list->node, e), sizeof *s->pair);
  s->k[s->count] = hk_tuple_value(&list->stiffness, e);
  s->c[s->count] = damping_of(list, e);
  s->L[s->count++] = list->rest.count ? hk_tuple_value(&list->rest, e) : 0;
}

static hk_status take(hk_stiff_edges *s, const hk_host *host, choice *c, const offer *best) {
  size_t taken = 0;
  for (int octave = 0; octave < best->classes; octave++) taken += c->in[octave];
  s->shift = best->shift;
  if (taken == 0) return HK_OK;
  s->pair = host->allocate(host, taken * sizeof *s->pair);
  s->k = host->allocate(host, 3 * taken * sizeof *s->k);
  if (!s->pair || !s->k) return HK_NO_MEMORY;
  s->c = s->k + taken;
  s->L = s->c + taken;
  each(c, &(collector){s, best->classes}, collect);
  return HK_OK;
}

hk_status hk_stiff_edges_choose(hk_stiff_edges *s, const hk_host *host, const hk_model *model) {
  choice c = {.model = model};
  hk_stiff_edges_free(s, host);
  c.node = host->allocate(host, (model->n + 1) * sizeof *c.node);
  if (!c.node) return HK_NO_MEMORY;
  for (uint32_t i = 0; i < model->n; i++) c.node[i].parent = i;
  each(&c, NULL, find_stiffest);
  each(&c, NULL, count);
  for (int octave = 0; octave < CLASSES; octave++) s->edges += c.in[octave];
  offer best = best_offer(&c, s->edges);
  hk_status status = take(s, host, &c, &best);
  host->release(host, c.node);
  return status;
}

void hk_stiff_edges_free(hk_stiff_edges *s, const hk_host *host) {
  host->release(host, s->pair);
  host->release(host, s->k);
  *s = (hk_stiff_edges){0};
}
