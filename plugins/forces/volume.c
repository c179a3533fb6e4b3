/* What is enclosed keeps its volume, by a pressure: E = sum over cells of 1/2 k (V - V_0)^2/V_0, where cells are the
 * insides of closed surfaces, each piece for itself, or tetrahedra one by one; V_0 is the initial volume times
 * `inflation`, and k the bulk modulus of what is inside. Damping is c (dV/dt)^2/V_0 lost. plugins/common/solids/cells.c
 * has the volume and its gradient.
 *
 * The volume of a cell couples each of its particles with every other one, so that implicit methods get the blocks of
 * surfaces with at most 512 of them, and refuse larger ones; explicit methods take all. Tetrahedra are elements, for
 * xpbd too. A surface that loses a particle is open, and its pressure is gone. */
#include "plugins/common/solids/cell_blocks.h"
#include "plugins/common/solids/tetrahedron.h"

#include <string.h>

typedef struct volume {
  hk_tuples triangles, tetrahedra;
  hk_per_tuple k, damping;
  double inflation;
  hk_cells cells;
  double (*modulus)[2];  /* k and damping of the cells of the start */
  double (*gradient)[3]; /* of the members of a cell, and as many more */
  hk_elements element;   /* of tetrahedra; values 0 for surfaces */
} volume;

static const hk_param params[] = {
    {"triangles", "", "closed surfaces, each piece of which keeps its volume", .triangles = HK_AT(volume, triangles),
     .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"tetrahedra", "", "in their place: each keeps its volume", .tetrahedra = HK_AT(volume, tetrahedra),
     .flags = HK_OPTIONAL | HK_NOT_EMPTY},
    {"k", "Pa", "bulk modulus of what is enclosed; of tetrahedra one number or one each", .per_tuple = HK_AT(volume, k),
     .limits = HK_AT_LEAST(0), .flags = HK_REQUIRED, .list = "tetrahedra"},
    {"damping", "Pa s", "the same for the rate of the volume", .per_tuple = HK_AT(volume, damping),
     .limits = HK_AT_LEAST(0), .list = "tetrahedra"},
    {"inflation", "", "volume at rest in parts of the initial one", .number = HK_AT(volume, inflation), .initial = {1},
     .limits = HK_ABOVE_TO(0, 1e6), .flags = HK_TIMED},
    {0},
};

/* ---- elements of tetrahedra: C = (V - V_0)/sqrt(V_0) --------------------------------------------------------------
 */

static double rest_of(const volume *s, const hk_cell *cell) { return s->inflation * s->cells.rest[cell->number]; }

static void evaluate(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const volume *s = self;
  for (size_t k = begin; k < end; k++, C++, dC += 4) {
    const uint32_t *member = hk_tuple(&s->element.node, k);
    double rest = rest_of(s, &s->cells.cell[k]), root = sqrt(fabs(rest));
    hk_tetrahedron_slopes(x, member, dC);
    for (int e = 0; e < 12; e++) dC[e / 3][e % 3] /= root;
    *C = (hk_tetrahedron_volume(x, member) - rest) / root;
  }
}

static void list_elements(volume *s) {
  uint32_t *index = (uint32_t *)(uintptr_t)s->element.node.index;
  size_t count = s->element.values > 0 ? s->cells.acting : 0;
  for (size_t k = 0; k < count; k++) {
    const hk_cell *cell = &s->cells.cell[k];
    for (size_t m = 0; m < 4; m++)
      index[4 * k + m] = s->cells.member[cell->member + (m + 3) % 4]; /* 1 2 3 0 in cells */
    s->element.stiffness.value[k] = s->modulus[cell->number][0];
    s->element.damping.value[k] = s->modulus[cell->number][1];
  }
  s->element.node.count = s->element.stiffness.count = s->element.damping.count = count;
}

/* ---- setting up -------------------------------------------------------------------------------------------------- */

static hk_status reserve(volume *s, const hk_host *host) {
  size_t count = s->cells.count, elements = s->tetrahedra.count, members = 2 * (3 * s->triangles.count + 4);
  s->modulus = host->allocate(host, (count + 1) * sizeof *s->modulus);
  s->gradient = host->allocate(host, members * sizeof *s->gradient);
  s->element = (hk_elements){.values = elements > 0, .evaluate = evaluate, .self = s};
  s->element.node = (hk_tuples){0, 4, host->allocate(host, (4 * elements + 4) * sizeof(uint32_t))};
  s->element.stiffness.value = host->allocate(host, (elements + 1) * sizeof(double));
  s->element.damping.value = host->allocate(host, (elements + 1) * sizeof(double));
  if (s->modulus && s->gradient && s->element.node.index && s->element.stiffness.value && s->element.damping.value)
    return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu volumes", count);
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  volume *s = self;
  if ((s->triangles.count > 0) == (s->tetrahedra.count > 0))
    return host->fail(host, HK_BAD_PARAM, "give triangles, closed surfaces, or tetrahedra");
  hk_status status = s->triangles.count > 0 ? hk_cells_of_surfaces(&s->cells, view, &s->triangles)
                                            : hk_cells_of_tetrahedra(&s->cells, view, &s->tetrahedra);
  if (status == HK_OK) status = reserve(s, host);
  for (size_t c = 0; c < s->cells.count && status == HK_OK; c++) {
    s->modulus[c][0] = hk_tuple_value(&s->k, c);
    s->modulus[c][1] = hk_tuple_value(&s->damping, c);
  }
  if (status == HK_OK) list_elements(s);
  return status;
}

static hk_status topology(void *self, const hk_view *view) {
  volume *s = self;
  hk_status status = hk_cells_topology(&s->cells, view);
  if (status == HK_OK) list_elements(s);
  return status;
}

/* ---- forces ------------------------------------------------------------------------------------------------------ */

static hk_cell_pressure pressure_of(const volume *s, const hk_cell *cell) {
  const double *modulus = s->modulus[cell->number];
  double rest = rest_of(s, cell);
  hk_cell_pressure p = {modulus[0] / fabs(rest), modulus[1] / fabs(rest), 0};
  p.z = p.stiffness * (cell->volume - rest) + p.damping * cell->rate;
  return p;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  volume *s = self;
  size_t triangles = s->cells.triangles.acting.count, at = 0;
  double(*load)[3] = s->cells.triangles.load;
  hk_cells_measure(&s->cells, view, true);
  for (size_t c = 0; c < s->cells.acting; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    hk_cell_pressure p = pressure_of(s, cell);
    memset(load + 3 * at, 0, 3 * (cell->first - at) * sizeof *load); /* of surfaces that are open now */
    for (at = cell->first; at < cell->first + cell->triangles; at++)
      for (size_t e = 0; e < 9; e++) load[3 * at + e / 3][e % 3] *= -p.z;
    if (view->power) *view->power -= p.damping * cell->rate * cell->rate;
  }
  memset(load + 3 * at, 0, 3 * (triangles - at) * sizeof *load);
  hk_living_tuples_gather(&s->cells.triangles, view, F);
  return HK_OK;
}

static double energy(void *self, const hk_view *view) {
  volume *s = self;
  double sum = 0;
  hk_cells_measure(&s->cells, view, false);
  for (size_t c = 0; c < s->cells.acting; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    double change = cell->volume - rest_of(s, cell);
    sum += pressure_of(s, cell).stiffness / 2 * change * change;
  }
  return sum;
}

static void elements(void *self, const hk_view *view, hk_elements *out) {
  (void)view;
  *out = ((volume *)self)->element;
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  (void)view;
  hk_cells_pattern(&((volume *)self)->cells, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  volume *s = self;
  size_t next = 0;
  hk_cells_measure(&s->cells, view, true);
  for (size_t c = 0; c < s->cells.acting; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    if (cell->members > HK_CELL_MEMBERS)
      return view->host->fail(
          view->host, HK_BAD_PARAM,
          "the volume inside a surface of %zu particles couples all of them: implicit steps take %d "
          "at most. Take an explicit integrator, or tetrahedra with the force neo_hookean",
          cell->members, HK_CELL_MEMBERS);
    hk_cells_jacobian(&s->cells, view, c, pressure_of(s, cell), into, &next, s->gradient);
  }
  return HK_OK;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  volume *s = self;
  hk_cells_measure(&s->cells, view, true);
  for (size_t c = 0; c < s->cells.acting; c++) {
    hk_cell_pressure p = pressure_of(s, &s->cells.cell[c]);
    if (part == HK_DAMPING_WHOLE) p.stiffness = p.damping;
    hk_cells_bound(&s->cells, view, c, p, part != HK_DAMPING_WHOLE, s->gradient, block);
  }
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_ELEMENTS_FACET(.list = elements)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "volume",
    .summary = "closed surfaces, or tetrahedra, keep their volume: E = 1/2 k (V - V_0)^2/V_0",
    .reference =
        "Teschner, Heidelberger, Mueller and Gross 2004, A versatile and robust model for geometrically complex "
        "deformable solids, 3.2",
    .instance_size = sizeof(volume),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
