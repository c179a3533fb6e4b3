/* The Lennard-Jones pair V = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) up to the cut-off, with a shifted force: a constant
 * force and an energy are taken off so that both are 0 there (plugins/common/pairs/lj_pair.h). Pairs come from the
 * service neighbours/1; each particle sums over its own row, in rising order, so threads leave no trace and opposite
 * forces have the same bits; in a periodic box it takes the nearest images (Allen and Tildesley 1987, section 1.5). The
 * blocks of K are the Hessian U'' n n^T + U'/r (1 - n n^T) of each pair, with n = r/|r|.
 *
 * Nearer than sigma/10000 the force is a convention that keeps everything finite. No motion leads there; a run that has
 * such a pair after a step ends with an error.
 *
 * A particle that goes far in a step would pass the core of another without a trace. The core rises as r^-13, by its
 * own size within r/13; steps are therefore asked for in which nobody goes further than sigma/8, so that no pair comes
 * nearer by more than 4 such lengths at r = 0.8 sigma, and there are no encounters to tell of (core/plugin/force.h). */
#include "plugins/common/pairs/lj_pair.h"

#include "core/plugin.h"

#include <string.h>

enum { GRAIN = 256 };

static const double travel = 0.125; /* of sigma, in a step */
static const size_t usual = 16;     /* pairs of a particle that there is room for from the start */

typedef struct lennard_jones {
  hk_lj_pair law;
  const char *first, *second;
  uint8_t *side;       /* n: IS_FIRST and IS_SECOND; NULL: all particles are both */
  double *sums;        /* J, of a chunk */
  bool *too_near;      /* of a chunk, at the last evaluation: there is a pair on the parabola */
  uint32_t (*pair)[2]; /* those whose blocks were named, i < j */
  size_t pairs, room;
  uint64_t number;  /* of the rows that they are from; 0: none */
  hk_status failed; /* of the last pattern */
  const hk_neighbours *service;
  const hk_host *host;
} lennard_jones;

enum { IS_FIRST = 1, IS_SECOND = 2 };

static const hk_param params[] = {
    {"epsilon", "J", "depth of the well", .number = HK_AT(lennard_jones, law.epsilon), .initial = {1},
     .limits = HK_AT_LEAST(0)},
    {"sigma", "m", "distance at which V is 0", .number = HK_AT(lennard_jones, law.sigma), .initial = {1},
     .limits = HK_ABOVE(0)},
    {"cutoff", "m", "distance at which the force ends; left out: 2.5 sigma", .number = HK_AT(lennard_jones, law.cutoff),
     .limits = HK_ABOVE(0), .flags = HK_OPTIONAL},
    {"first", "", "group of the one particle of a pair; left out: any", .string = HK_AT(lennard_jones, first)},
    {"second", "", "group of the other particle; left out: any", .string = HK_AT(lennard_jones, second)},
    {0},
};

/* From i to j, in a periodic box to its nearest image; `box` NULL is known to the compiler where loops are open. */
HK_INLINE double between(const double *x, const hk_periodic_box *box, size_t i, size_t j, double d[3]) {
  for (size_t c = 0; c < 3; c++) d[c] = x[3 * j + c] - x[3 * i + c];
  if (box) hk_nearest_image(box, d);
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

static double difference(const hk_view *view, size_t i, size_t j, double d[3]) {
  return between(view->x, view->model->box, i, j, d);
}

static bool attract(const lennard_jones *p, const hk_view *view, size_t i, size_t j) {
  if (view->is_active && !(view->is_active[i] && view->is_active[j])) return false;
  if (!p->side) return true;
  return (p->side[i] & IS_FIRST && p->side[j] & IS_SECOND) || (p->side[i] & IS_SECOND && p->side[j] & IS_FIRST);
}

/* ---- force and energy ---- */

typedef struct task {
  const lennard_jones *self;
  const hk_view *view;
  hk_neighbour_rows rows;
  double *F, cut2;
  double (*block)[6];
} task;

static hk_status begin(task *t, const lennard_jones *p, const hk_view *view) {
  *t = (task){.self = p, .view = view, .cut2 = p->law.cutoff * p->law.cutoff};
  return p->service->rows(p->service->self, view, view->x, &t->rows);
}

HK_INLINE size_t acting(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

HK_INLINE void add_rows(const task *t, const hk_periodic_box *box, size_t first, size_t end, size_t chunk) {
  double nearest2 = INFINITY;
  for (size_t k = first; k < end; k++) {
    size_t i = acting(t->view, k);
    double sum[3] = {0}, d[3];
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      size_t j = t->rows.other[e];
      double r2 = between(t->view->x, box, i, j, d);
      if (!(r2 < t->cut2) || !attract(t->self, t->view, i, j)) continue;
      nearest2 = fmin(nearest2, r2);
      double f = hk_lj_pair_at(&t->self->law, r2).push;
      for (int c = 0; c < 3; c++) sum[c] -= f * d[c];
    }
    for (size_t c = 0; c < 3; c++) t->F[3 * i + c] += sum[c];
  }
  t->self->too_near[chunk] = nearest2 < t->self->law.least2;
}

static void add_open(void *context, size_t first, size_t end, size_t chunk) {
  add_rows(context, NULL, first, end, chunk);
}

static void add_periodic(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  add_rows(t, t->view->model->box, first, end, chunk);
}

static hk_status add(void *self, const hk_view *view, double *F) {
  task t;
  hk_status status = begin(&t, self, view);
  t.F = F;
  if (status == HK_OK)
    view->host->parallel_for(view->host, view->acting, GRAIN, view->model->box ? add_periodic : add_open, &t);
  return status;
}

static void energy_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  double sum = 0, d[3];
  for (size_t k = first; k < end; k++) {
    size_t i = acting(t->view, k);
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      size_t j = t->rows.other[e];
      double r2 = difference(t->view, i, j, d);
      if (j > i && r2 < t->cut2 && attract(t->self, t->view, i, j)) sum += hk_lj_pair_at(&t->self->law, r2).energy;
    }
  }
  t->self->sums[chunk] = sum;
}

static double energy(void *self, const hk_view *view) {
  task t;
  double sum = 0;
  if (begin(&t, self, view) != HK_OK) return NAN;
  view->host->parallel_for(view->host, view->acting, GRAIN, energy_chunk, &t);
  for (size_t k = 0; k * GRAIN < view->acting; k++) sum += t.self->sums[k];
  return sum;
}

/* ---- implicit methods ---- */

/* Lists the pairs of the rows, which reach further than the cut-off; `into` NULL: counts them. */
static size_t list_pairs(const task *t, uint32_t (*into)[2]) {
  size_t count = 0;
  for (size_t i = 0; i < t->rows.n; i++)
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      uint32_t j = t->rows.other[e];
      if (j < i || !attract(t->self, t->view, i, j)) continue;
      if (into) into[count][0] = (uint32_t)i, into[count][1] = j;
      count++;
    }
  return count;
}

static hk_status reserve(lennard_jones *p, size_t n, size_t count) {
  if (count <= p->room) return HK_OK;
  size_t room = p->room + p->room / 2;
  if (room < count) room = count;
  if (room < usual * n) room = usual * n;
  p->host->release(p->host, p->pair);
  p->pair = p->host->allocate(p->host, room * sizeof *p->pair);
  p->room = p->pair ? room : 0;
  return p->pair ? HK_OK : p->host->fail(p->host, HK_NO_MEMORY, "no memory for the blocks of %zu pairs", count);
}

/* Blocks are named for all pairs that can come within the cut-off before the rows are found again. */
static void pattern(void *self, const hk_view *view, hk_pattern *into) {
  lennard_jones *p = self;
  task t;
  p->number = 0;
  p->pairs = 0;
  p->failed = begin(&t, p, view);
  if (p->failed == HK_OK) p->failed = reserve(p, view->n, list_pairs(&t, NULL));
  if (p->failed != HK_OK) return;
  p->pairs = list_pairs(&t, p->pair);
  p->number = t.rows.number;
  for (size_t k = 0; k < p->pairs; k++)
    for (int e = 0; e < 4; e++) into->block(into, p->pair[k][e / 2], p->pair[k][e % 2]);
}

static hk_status update(void *self, const hk_view *from, const double *x_to, bool *pattern_changed) {
  const lennard_jones *p = self;
  hk_neighbour_rows rows;
  hk_status status = p->service->rows(p->service->self, from, x_to, &rows);
  *pattern_changed = status == HK_OK && rows.number != p->number;
  return status;
}

static void add_block(double *K, const double H[6], double sign) {
  static const int at[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  for (int q = 0; q < 9; q++) K[q] += sign * H[at[q]];
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  const lennard_jones *p = self;
  const size_t *slot = into->slot;
  if (p->failed != HK_OK) return p->failed;
  for (size_t k = 0; k < p->pairs; k++, slot += 4) {
    double d[3], H[6], r2 = difference(view, p->pair[k][0], p->pair[k][1], d);
    if (!(r2 < p->law.cutoff * p->law.cutoff)) continue;
    hk_lj_pair_hessian(&p->law, d, r2, into->want & HK_WANT_DEFINITE, H);
    for (int e = 0; e < 4; e++) add_block(into->K + 9 * slot[e], H, e == 0 || e == 3 ? 1 : -1);
  }
  return HK_OK;
}

/* ---- the step ---- */

/* (u_i - u_j).H (u_i - u_j) <= 2 u_i.P u_i + 2 u_j.P u_j with the part P of H above 0. */
static void bound_chunk(void *context, size_t first, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = first; k < end; k++) {
    size_t i = acting(t->view, k);
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      size_t j = t->rows.other[e];
      double d[3], H[6], r2 = difference(t->view, i, j, d);
      if (!(r2 < t->cut2) || !attract(t->self, t->view, i, j)) continue;
      hk_lj_pair_hessian(&t->self->law, d, r2, true, H);
      for (int c = 0; c < 6; c++) t->block[i][c] += 2 * H[c];
    }
  }
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  task t;
  if (part == HK_DAMPING_WHOLE) return;
  bool known = begin(&t, self, view) == HK_OK;
  t.block = block;
  if (known) view->host->parallel_for(view->host, view->acting, GRAIN, bound_chunk, &t);
  for (size_t i = 0; !known && i < view->n; i++)
    for (int c = 0; c < 6; c++) block[i][c] = INFINITY;
}

static double longest_step(void *self, const hk_view *view) {
  const lennard_jones *p = self;
  double most2 = 0;
  for (size_t k = 0; k < view->acting; k++) {
    const double *v = view->v + 3 * acting(view, k);
    most2 = fmax(most2, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  return travel * p->law.sigma / sqrt(most2);
}

/* Names the first pair on the parabola. */
static hk_status refuse(const task *t) {
  for (size_t i = 0; i < t->rows.n; i++)
    for (size_t e = t->rows.row_start[i]; e < t->rows.row_start[i + 1]; e++) {
      double d[3], r2 = difference(t->view, i, t->rows.other[e], d);
      if (r2 < t->self->law.least2 && attract(t->self, t->view, i, t->rows.other[e]))
        return t->self->host->fail(t->self->host, HK_FAILED,
                                   "particles %u and %u are %g m apart at t = %g s, less than sigma/10000, where "
                                   "there is no Lennard-Jones force: start them apart, or take shorter steps",
                                   t->view->model->id[i], t->view->model->id[t->rows.other[e]], sqrt(r2), t->view->t);
    }
  return HK_OK; /* only an attempt within the step came so near */
}

static hk_status accepted(void *self, const hk_view *view, double h) {
  const lennard_jones *p = self;
  bool near = false;
  task t;
  (void)h;
  for (size_t k = 0; k * GRAIN < view->acting; k++) near |= p->too_near[k];
  if (!near) return HK_OK;
  hk_status status = begin(&t, p, view);
  return status == HK_OK ? refuse(&t) : status;
}

/* ---- the plugin ---- */

static hk_status find_group(const lennard_jones *p, const hk_model *model, const char *which, const char *name,
                            uint32_t *group) {
  for (*group = 0; *group < model->groups; ++*group)
    if (strcmp(model->group_name[*group], name) == 0) return HK_OK;
  return p->host->fail(p->host, HK_BAD_PARAM, "%s: the scene has no group '%s'", which, name);
}

static hk_status mark(lennard_jones *p, const hk_model *model, const char *which, const char *name, uint8_t side) {
  uint32_t group = 0;
  hk_status status = name ? find_group(p, model, which, name, &group) : HK_OK;
  for (size_t i = 0; status == HK_OK && i < model->n; i++)
    if (!name || model->group[i] == group) p->side[i] |= side;
  return status;
}

static hk_status topology(void *self, const hk_view *view) {
  lennard_jones *p = self;
  const hk_host *host = p->host;
  host->release(host, p->sums);
  host->release(host, p->too_near);
  host->release(host, p->side);
  p->side = NULL;
  p->number = 0;
  p->sums = host->allocate(host, (view->n / GRAIN + 1) * sizeof *p->sums);
  p->too_near = host->allocate(host, view->n / GRAIN + 1);
  bool chosen = p->first || p->second;
  if (chosen) p->side = host->allocate(host, view->n + 1);
  if (!p->sums || !p->too_near || (chosen && !p->side))
    return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles", view->n);
  if (!chosen) return HK_OK;
  hk_status status = mark(p, view->model, "first", p->first, IS_FIRST);
  return status == HK_OK ? mark(p, view->model, "second", p->second, IS_SECOND) : status;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  lennard_jones *p = self;
  p->host = host;
  p->service = host->query(host, "neighbours/1");
  if (!p->service)
    return host->fail(host, HK_FAILED,
                      "it needs the service 'neighbours/1', and no plugin of that name is installed in services/; see: "
                      "hooke plugins");
  if (isnan(p->law.cutoff)) p->law.cutoff = 2.5 * p->law.sigma;
  if (!(p->law.cutoff >= p->law.sigma / 2))
    return host->fail(host, HK_BAD_PARAM,
                      "cutoff: %g m is less than half of sigma: nothing would be left of the force; 2.5 sigma is usual",
                      p->law.cutoff);
  hk_lj_pair_prepare(&p->law);
  hk_status status = p->service->reach_images(p->service->self, p->law.cutoff);
  return status == HK_OK ? topology(self, view) : status;
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_OFFERS_DEFINITE | HK_PERIODIC,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound, .longest_step = longest_step),
                        HK_STEPS_FACET(.update = update, .accepted = accepted)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "lennard_jones",
    .summary =
        "pairs attract and repel, V = 4 epsilon ((sigma/r)^12 - (sigma/r)^6), with a shifted force up to a cut-off",
    .reference = "Allen and Tildesley 1987, Computer Simulation of Liquids, equation 5.10a",
    .instance_size = sizeof(lennard_jones),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
