/* Springs are put into classes by their own squared frequency r = k (1/m_i + 1/m_j), an octave each, and for every
 * class the work is foretold of taking it and all stiffer ones in short steps; the least is chosen.
 *
 * For all u and any positions, u.K u <= sum_e r_e (m_i u_i^2 + m_j u_j^2): no squared frequency of a set of springs is
 * above the largest sum of r over the springs of one particle. That bounds the stiff part (and gives the number of
 * short steps) and estimates what is left (whose limit the host then measures). */
#include "plugins/common/local/stiff_edges.h"
#include "plugins/common/local/local_filter.h"

#include <string.h>

enum { CLASSES = 40 };

/* Work is counted in springs of a whole evaluation. Springs of a short step are scattered, but lie in the first cache;
 * each brings up to two particles, and a short step has calls of its own. */
static const double work_of_evaluation = 100, work_of_spring = 2, work_of_call = 30;
/* The largest damping ratio of a stiff spring. A mode that the long step just does not resolve is damped by up to
 * 4 times its ratio of what leapfrog can bear, and leaves the less to others (local_filter.h). */
static const double most_damped = 0.06;
static const double worth = 0.8; /* part of leapfrog's work below which local steps are taken */

typedef struct choice {
  const hk_model *model;
  double stiffest;        /* 1/s^2 */
  size_t in[CLASSES];     /* springs of a class */
  double damped[CLASSES]; /* s, their largest damping over stiffness */
  double *all, *stiff;    /* n x 2 each: sums over a particle's springs of r and of their own damping rates */
} choice;

/* Bounds of the springs taken, 1/s^2, and of the others, 1/s^2 and 1/s. */
typedef struct cut {
  int classes; /* taken; 0: none */
  double work, stiff, rest, damped;
} cut;

static double damping_of(const hk_elements *list, size_t e) {
  return list->damping.count ? hk_tuple_value(&list->damping, e) : 0;
}

/* To `sum` of both ends of a spring: r, and its damping rate. */
static void add_rates(const choice *c, double *sum, const hk_elements *list, size_t e, double r) {
  const uint32_t *pair = hk_tuple(&list->node, e);
  double g = damping_of(list, e) * (c->model->inverse_mass[pair[0]] + c->model->inverse_mass[pair[1]]);
  for (int end = 0; end < 2; end++) {
    sum[2 * (size_t)pair[end]] += r;
    sum[2 * (size_t)pair[end] + 1] += g;
  }
}

static double rate(const hk_model *model, const hk_elements *list, size_t e) {
  const uint32_t *pair = hk_tuple(&list->node, e);
  return hk_tuple_value(&list->stiffness, e) * (model->inverse_mass[pair[0]] + model->inverse_mass[pair[1]]);
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
  double k = hk_tuple_value(&list->stiffness, e), damping = damping_of(list, e);
  int octave = class_of(c, r);
  (void)context;
  c->in[octave]++;
  if (damping > 0) c->damped[octave] = fmax(c->damped[octave], damping / k);
  add_rates(c, c->all, list, e, r);
}

static void add_class(choice *c, void *context, const hk_elements *list, size_t e, double r) {
  if (class_of(c, r) == *(const int *)context) add_rates(c, c->stiff, list, e, r);
}

/* Estimated class by class, two springs of a class to a particle; what parts the springs make decides in the end. */
static double room_of(const choice *c, const cut *taken, double h) {
  double room = 1;
  for (int octave = 0; octave < taken->classes; octave++) {
    double stiffest = 2 * ldexp(c->stiffest, -octave), retardation = c->damped[octave];
    const hk_local_modes modes = {stiffest, retardation * stiffest, retardation};
    if (c->in[octave]) room = fmin(room, hk_local_room(&modes, h));
  }
  return room;
}

/* s, the largest step at which (h w)^2 + 4 h g <= 4 room, to 3 %; 0: there is none within a twentieth of what the
 * stiffness of the other springs alone would allow. */
static double step_of(const choice *c, const cut *taken) {
  double most = 2 / sqrt(taken->rest);
  for (double h = most; h > most / 20; h *= 0.97)
    if (h * h * taken->rest + 4 * h * taken->damped <= 4 * room_of(c, taken, h)) return h;
  return 0;
}

/* The work of a second, with all classes up to the last one added in short steps. */
static cut weigh(const choice *c, int classes, size_t taken, double whole) {
  cut found = {.classes = classes, .work = INFINITY};
  for (size_t i = 0; i < c->model->n; i++) {
    found.stiff = fmax(found.stiff, c->stiff[2 * i]);
    found.rest = fmax(found.rest, c->all[2 * i] - c->stiff[2 * i]);
    found.damped = fmax(found.damped, c->all[2 * i + 1] - c->stiff[2 * i + 1]);
  }
  double h = found.rest > 0 ? step_of(c, &found) : 0, each = work_of_spring * (double)taken + work_of_call;
  if (h > 0) found.work = (whole + (classes ? hk_local_count(h * h * found.stiff) * each : 0)) / h;
  return found;
}

static cut best_cut(choice *c, size_t edges) {
  double whole = work_of_evaluation + (double)(edges + c->model->n);
  size_t taken = 0;
  cut best = weigh(c, 0, 0, whole);
  best.work *= worth;
  for (int octave = 0; octave < CLASSES && 2 * taken < edges; octave++) {
    if (c->in[octave] == 0) continue;
    if (c->damped[octave] * sqrt(ldexp(c->stiffest, -octave)) > 2 * most_damped) break;
    each(c, &octave, add_class);
    taken += c->in[octave];
    cut next = weigh(c, octave + 1, taken, whole);
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

static hk_status take(hk_stiff_edges *s, const hk_host *host, choice *c, const cut *best) {
  size_t taken = 0;
  for (int octave = 0; octave < best->classes; octave++) taken += c->in[octave];
  s->stiffest = best->stiff;
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
  c.all = host->allocate(host, 4 * (model->n + 1) * sizeof *c.all);
  if (!c.all) return HK_NO_MEMORY;
  c.stiff = c.all + 2 * model->n;
  each(&c, NULL, find_stiffest);
  each(&c, NULL, count);
  for (int octave = 0; octave < CLASSES; octave++) s->edges += c.in[octave];
  cut best = best_cut(&c, s->edges);
  hk_status status = take(s, host, &c, &best);
  host->release(host, c.all);
  return status;
}

void hk_stiff_edges_free(hk_stiff_edges *s, const hk_host *host) {
  host->release(host, s->pair);
  host->release(host, s->k);
  *s = (hk_stiff_edges){0};
}
