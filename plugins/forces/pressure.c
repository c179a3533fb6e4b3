/* The gas in closed surfaces, each piece for itself, whose state changes as
 *     p_in V^n = (p_out + p) V_0^n,
 * n the polytropic exponent: 0, the pressure is given (a pump holds it); 1, the gas keeps its temperature (Boyle and
 * Mariotte); 7/5, air that exchanges no heat (Poisson's adiabat). V_0 is the volume at the start, p the overpressure
 * there, p_out the ambient pressure. The force is the gradient of the work that a change of volume takes,
 *     E = p_out (V - V_0) - int_{V_0}^V p_in dV,     F = (p_in - p_out) grad V,
 * with the exact gradient of the volume (plugins/common/solids/cells.c): a closed surface is not pushed or turned as a
 * whole, to rounding.
 *
 * Of a given pressure the stiffness couples the corners of each triangle alone, and is symmetric since the surface is
 * closed: implicit methods take surfaces of any size. That of a gas couples every particle with every other one (n
 * p_in/V grad V grad V^T): implicit methods take HK_CELL_MEMBERS particles a surface, and refuse larger ones. A surface
 * that loses a particle is open, and its gas is gone. */
#include "plugins/common/solids/cell_blocks.h"

#include <string.h>

typedef struct pressure {
  hk_tuples triangles;
  double p, exponent, ambient;
  hk_cells cells;
  double (*gradient)[3]; /* of the members of a cell, and as many more */
} pressure;

static const hk_param params[] = {
    {"triangles", "", "closed surfaces, counter-clockwise seen from outside; each piece has its own gas",
     .triangles = HK_AT(pressure, triangles), .flags = HK_NOT_EMPTY},
    {"p", "Pa", "pressure of the gas above the ambient one, at the volume of the start", .number = HK_AT(pressure, p),
     .limits = HK_WITHIN(-1e12, 1e12), .flags = HK_REQUIRED | HK_TIMED},
    {"exponent", "", "n of p V^n = const.: 0 for a given pressure, 1 isothermal, 1.4 for air without exchange of heat",
     .number = HK_AT(pressure, exponent), .limits = HK_WITHIN(0, 10)},
    {"ambient", "Pa", "absolute pressure outside; without a part where n = 0; the default is the standard atmosphere",
     .number = HK_AT(pressure, ambient), .initial = {101325}, .limits = HK_WITHIN(0, 1e12)},
    {0},
};

/* ---- setting up -------------------------------------------------------------------------------------------------- */

static hk_status check_outwards(const pressure *s, const hk_view *view) {
  for (size_t c = 0; c < s->cells.count; c++) {
    if (s->cells.rest[c] > 0) continue;
    size_t k = 0;
    while (s->cells.cell_of[k] != c) k++;
    const uint32_t *id = s->cells.triangles.id + 3 * k;
    return view->host->fail(view->host, HK_BAD_PARAM,
                            "triangles: the surface with the edge {%u, %u} is inside out, its volume is %.6g m^3: turn "
                            "its triangles round, {%u, %u, %u} for {%u, %u, %u} and so on",
                            id[0], id[1], s->cells.rest[c], id[0], id[2], id[1], id[0], id[1], id[2]);
  }
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  pressure *s = self;
  hk_status status = hk_cells_of_surfaces(&s->cells, view, &s->triangles);
  if (status == HK_OK) status = check_outwards(s, view);
  if (status != HK_OK) return status;
  s->gradient = host->allocate(host, 2 * (3 * s->triangles.count + 1) * sizeof *s->gradient);
  return s->gradient ? HK_OK
                     : host->fail(host, HK_NO_MEMORY, "no memory for the gas in %zu triangles", s->triangles.count);
}

static hk_status topology(void *self, const hk_view *view) {
  return hk_cells_topology(&((pressure *)self)->cells, view);
}

/* ---- forces ------------------------------------------------------------------------------------------------------ */

/* Below this part of V_0 p_in follows its tangent, so that force and energy are finite where a surface is crushed, or
 * turned inside out, and push it back. Air of the atmosphere would be as dense there as when it is liquid (of 1.2
 * kg/m^3 and 870), and no ideal gas. */
static const double DENSEST = 1e-3;

/* The absolute pressure, and -dp_in/dV. */
static double inside_of(const pressure *s, const hk_cell *cell, double *stiffness) {
  double rest = s->cells.rest[cell->number], least = DENSEST * rest, V = fmax(cell->volume, least);
  double p = (s->ambient + s->p) * pow(rest / V, s->exponent);
  *stiffness = s->exponent * p / V;
  return p + *stiffness * (V - cell->volume);
}

/* F = -z grad V, and dz/dV. */
static hk_cell_pressure pressure_of(const pressure *s, const hk_cell *cell) {
  hk_cell_pressure p = {.z = -s->p};
  if (s->exponent > 0) p.z = s->ambient - inside_of(s, cell, &p.stiffness);
  return p;
}

static hk_status add(void *self, const hk_view *view, double *F) {
  pressure *s = self;
  size_t triangles = s->cells.triangles.acting.count, at = 0;
  double(*load)[3] = s->cells.triangles.load;
  hk_cells_measure(&s->cells, view, false);
  for (size_t c = 0; c < s->cells.acting; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    double z = pressure_of(s, cell).z;
    memset(load + 3 * at, 0, 3 * (cell->first - at) * sizeof *load); /* of surfaces that are open now */
    for (at = cell->first; at < cell->first + cell->triangles; at++)
      for (size_t e = 0; e < 9; e++) load[3 * at + e / 3][e % 3] *= -z;
  }
  memset(load + 3 * at, 0, 3 * (triangles - at) * sizeof *load);
  hk_living_tuples_gather(&s->cells.triangles, view, F);
  return HK_OK;
}

/* int_{V_0}^V p_in dV: of the ideal gas (p_out + p) V_0 times ln q or (q^(1 - n) - 1)/(1 - n), q = V/V_0, which expm1
 * has without cancellation near n = 1 and q = 1. */
static double work_of(const pressure *s, const hk_cell *cell) {
  double rest = s->cells.rest[cell->number], q = fmax(cell->volume / rest, DENSEST), n = s->exponent, stiffness;
  double beyond = fmin(0, cell->volume - DENSEST * rest), p = inside_of(s, cell, &stiffness);
  double gas = n == 1 ? log(q) : expm1((1 - n) * log(q)) / (1 - n);
  return (s->ambient + s->p) * rest * gas + beyond * (p + stiffness * beyond / 2);
}

static double energy(void *self, const hk_view *view) {
  pressure *s = self;
  double sum = 0;
  hk_cells_measure(&s->cells, view, false);
  for (size_t c = 0; c < s->cells.acting; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    double change = cell->volume - s->cells.rest[cell->number];
    sum += s->exponent == 0 ? -s->p * change : s->ambient * change - work_of(s, cell);
  }
  return sum;
}

static void pattern(void *self, const hk_view *view, hk_pattern *p) {
  pressure *s = self;
  (void)view;
  if (s->exponent == 0)
    hk_cells_corner_pattern(&s->cells, p);
  else
    hk_cells_pattern(&s->cells, p);
}

static hk_status jacobian(void *self, const hk_view *view, const hk_blocks *into) {
  pressure *s = self;
  size_t next = 0;
  hk_cells_measure(&s->cells, view, true);
  hk_status status = HK_OK;
  for (size_t c = 0; c < s->cells.acting && status == HK_OK; c++) {
    const hk_cell *cell = &s->cells.cell[c];
    hk_cell_pressure p = pressure_of(s, cell);
    if (s->exponent == 0)
      hk_cells_corner_jacobian(&s->cells, view, c, p.z, into, &next);
    else if (cell->members <= HK_CELL_MEMBERS)
      hk_cells_jacobian(&s->cells, view, c, p, into, &next, s->gradient);
    else
      status = view->host->fail(view->host, HK_BAD_PARAM,
                                "the gas in a surface of %zu particles couples all of them: implicit steps take %d at "
                                "most. Take an explicit integrator, or a given pressure, exponent = 0",
                                cell->members, HK_CELL_MEMBERS);
  }
  return status;
}

static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  pressure *s = self;
  if (part == HK_DAMPING_WHOLE) return;
  hk_cells_measure(&s->cells, view, true);
  for (size_t c = 0; c < s->cells.acting; c++)
    hk_cells_bound(&s->cells, view, c, pressure_of(s, &s->cells.cell[c]), true, s->gradient, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_SYMMETRIC_JACOBIAN |
             HK_OFFERS_DEFINITE,
    .add = add,
    .energy = energy,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = pattern, .jacobian = jacobian),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "pressure",
    .summary = "the gas in closed surfaces, of a given pressure or with p V^n = const.: balloons, cushions, tyres",
    .reference = "Green and Adkins 1960, Large elastic deformations, 4.14 (inflated membranes); gradient of the "
                 "volume: Baraff and "
                 "Witkin 1992, Dynamic simulation of non-penetrating flexible bodies, SIGGRAPH",
    .instance_size = sizeof(pressure),
    .params = params,
    .create = create,
    .topology = topology,
    .force = &force,
};
