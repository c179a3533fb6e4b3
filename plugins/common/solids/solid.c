/* Forces and energies of tetrahedra, part by part and in chunks; their sums are in an order of their own, so that
 * results have the same bits for any number of threads. */
#include "plugins/common/solids/solid.h"

/* Volume over the cube of the longest edge below which a tetrahedron is taken to be flat: its slopes would have fewer
 * than four digits. */
static const double FLAT = 1e-12;

/* ---- setting up -------------------------------------------------------------------------------------------------- */

static hk_status reserve(hk_solid *s, const hk_host *host, size_t count) {
  s->part = host->allocate(host, (count + 1) * sizeof *s->part);
  s->sum = host->allocate(host, (count / HK_SOLID_GRAIN + 2) * sizeof *s->sum);
  s->matrix = host->allocate(host, HK_SOLID_GRAIN * sizeof *s->matrix);
  bool fine = s->part && s->sum && s->matrix;
  for (int l = 0; l < HK_SOLID_LISTS; l++) {
    s->weight[l] = host->allocate(host, (count + 1) * sizeof *s->weight[l]);
    fine = fine && s->weight[l];
  }
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu tetrahedra", count);
}

static hk_status refuse(const hk_view *view, const uint32_t member[4], double volume, bool flat) {
  const hk_host *host = view->host;
  uint32_t id[4];
  for (int m = 0; m < 4; m++) id[m] = view->model->id[member[m]];
  if (flat)
    return host->fail(host, HK_BAD_PARAM,
                      "the tetrahedron {%u, %u, %u, %u} has no volume at the start: its corners lie in a plane", id[0],
                      id[1], id[2], id[3]);
  return host->fail(host, HK_BAD_PARAM,
                    "the tetrahedron {%u, %u, %u, %u} is inside out at the start (%.3g m^3): exchange two of its "
                    "corners, {%u, %u, %u, %u}",
                    id[0], id[1], id[2], id[3], volume, id[1], id[0], id[2], id[3]);
}

static hk_status measure(hk_solid *s, const hk_view *view, const hk_solid_params *given, size_t k) {
  const uint32_t *member = hk_tuple(&given->tetrahedra, k);
  double longest = hk_tetrahedron_longest(view->x, member), volume = hk_tetrahedron_volume(view->x, member);
  double nu = hk_tuple_value(&given->nu, k), damping = hk_tuple_value(&given->damping, k);
  bool flat = !(fabs(volume) > FLAT * longest * longest * longest);
  if (flat || volume < 0) return refuse(view, member, volume, flat);
  if (nu >= 0.5)
    return view->host->fail(view->host, HK_BAD_PARAM,
                            "nu: %g: what keeps its volume exactly has no finite stiffness; take 0.49", nu);
  s->part[k] = (hk_solid_part){hk_tetrahedron_of(view->x, member), hk_neo_hookean_of(hk_tuple_value(&given->E, k), nu),
                               hk_viscosity_of(damping, nu)};
  s->damped |= damping > 0;
  return HK_OK;
}

hk_status hk_solid_create(hk_solid *s, const hk_view *view, const hk_solid_params *given) {
  size_t count = given->tetrahedra.count;
  if (count == 0)
    return view->host->fail(view->host, HK_BAD_PARAM,
                            "tetrahedra: there are none; scene:block and scene:tetrahedra make some");
  hk_status status = reserve(s, view->host, count);
  for (size_t k = 0; k < count && status == HK_OK; k++) status = measure(s, view, given, k);
  if (status == HK_OK) status = hk_living_tuples_create(&s->tuples, view, &given->tetrahedra, "tetrahedra");
  return status == HK_OK ? hk_solid_topology(s, view) : status;
}

hk_status hk_solid_topology(hk_solid *s, const hk_view *view) {
  hk_status status = hk_living_tuples_find(&s->tuples, view);
  for (size_t k = 0; k < s->tuples.acting.count; k++) {
    const hk_solid_part *p = hk_solid_part_of(s, k);
    s->weight[0][k] = p->shape.volume * p->elastic.mu;
    s->weight[1][k] = p->shape.volume * 2 * p->viscous.mu;
    s->weight[2][k] = p->shape.volume * p->viscous.lambda;
  }
  return status == HK_OK ? hk_part_sums_sort(&s->sums, view, &s->tuples.acting, NULL) : status;
}

/* ---- forces ------------------------------------------------------------------------------------------------------ */

/* The load on the members of a tetrahedron; returns the power that it loses. */
static double load_of(const hk_solid_part *p, const hk_view *view, const uint32_t *member, double load[4][3]) {
  double F[9], rate[9], P[9], lost[9], power = 0;
  hk_tetrahedron_gradient(&p->shape, view->x, member, F);
  hk_neo_hookean_stress(p->elastic, F, P);
  if (p->viscous.mu > 0) {
    hk_tetrahedron_gradient(&p->shape, view->v, member, rate);
    power = p->shape.volume * hk_viscosity_stress(p->viscous, F, rate, lost);
    for (int e = 0; e < 9; e++) P[e] += lost[e];
  }
  hk_tetrahedron_load(&p->shape, P, load);
  return power;
}

static double add_items(const void *context, const hk_view *view, const uint32_t *item, size_t count, double *F) {
  const hk_solid *s = context;
  double load[4][3], power = 0;
  for (size_t k = 0; k < count; k++) {
    const uint32_t *member = hk_tuple(&s->tuples.acting, item[k]);
    power -= load_of(hk_solid_part_of(s, item[k]), view, member, load);
    for (size_t e = 0; e < 12; e++) F[3 * (size_t)member[e / 3] + e % 3] += load[e / 3][e % 3];
  }
  return power;
}

void hk_solid_add(const hk_solid *s, const hk_view *view, size_t part, double *F) {
  hk_part_sums_add(&s->sums, view, part, add_items, s, F);
}

/* ---- energy ------------------------------------------------------------------------------------------------------ */

typedef struct task {
  hk_solid *s;
  const hk_view *view;
} task;

static void energy_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  double F[9], sum = 0;
  for (size_t k = begin; k < end; k++) {
    const hk_solid_part *p = hk_solid_part_of(t->s, k);
    hk_tetrahedron_gradient(&p->shape, t->view->x, hk_tuple(&t->s->tuples.acting, k), F);
    sum += p->shape.volume * hk_neo_hookean_energy(p->elastic, F);
  }
  t->s->sum[chunk] = sum;
}

double hk_solid_energy(hk_solid *s, const hk_view *view) {
  task t = {s, view};
  double sum = 0;
  if (s->tuples.acting.count == 0) return 0;
  view->host->parallel_for(view->host, s->tuples.acting.count, HK_SOLID_GRAIN, energy_chunk, &t);
  for (size_t chunk = 0; chunk * HK_SOLID_GRAIN < s->tuples.acting.count; chunk++) sum += s->sum[chunk];
  return sum;
}
