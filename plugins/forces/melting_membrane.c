/* Sheets that soften as they warm, and tear: the force `membrane`, whose elasticity and damping are those of a cold
 * sheet times
 *     s = 1 below `softens`, 0 from there on by `range`, linear between,
 * of the mean of a channel over a triangle's corners, a temperature or an enthalpy (Terzopoulos, Platt, Fleischer 1989,
 * Heating and melting deformable models, section 4, of membranes what melting_springs is of springs). A triangle that
 * has molten, or whose largest principal strain is above `breaking` after a step, stays without force; what has only
 * softened is stiff again when it cools. Its corners are then held by what else acts on them alone, so those of which
 * all triangles are gone are free particles.
 *
 * s is that of the last accepted step: it is constant within a step, and what a triangle stored and no longer does is
 * dissipated then. So the energy balance closes to the order of the method, and the softening itself is of order 1. */
#include "plugins/common/channels/find_channel.h"
#include "plugins/common/channels/softening.h"
#include "plugins/common/elements/breakage.h"
#include "plugins/common/membranes/membrane.h"

enum { LOST, GONE, VARIABLES };                                   /* per triangle: 1 - s; 0 or 1 */
enum { FIRST = HK_C11, ELASTICITIES = HK_MEMBRANE_ROWS - FIRST }; /* rows of the membrane that soften */

typedef struct melting_membrane {
  hk_membrane sheet; /* first member */
  hk_membrane_params given;
  hk_per_tuple breaking;
  const char *name;
  const hk_channel *channel;
  double softens, range;
  double *variable;           /* triangles x VARIABLES */
  uint32_t *listed;           /* triangles that act: their places in `triangles` */
  double *cold[ELASTICITIES]; /* of those, N m: the cold triangle's; 0 of what is gone */
} melting_membrane;

static const hk_param params[] = {
    {"triangles", "", "of the sheet", .triangles = HK_AT(melting_membrane, given.triangles),
     .flags = HK_REQUIRED | HK_NOT_EMPTY},
    HK_MEMBRANE_SHEET(melting_membrane, given),
    {"breaking", "", "largest principal strain, above which a triangle tears; left out: never",
     .per_tuple = HK_AT(melting_membrane, breaking), .limits = HK_ABOVE(0), .flags = HK_OPTIONAL, .list = "triangles"},
    {"rest", "", "scale of the shape at rest, which is that of the start",
     .number = HK_AT(melting_membrane, given.rest), .initial = {1}, .limits = HK_ABOVE(0)},
    {"channel", "", "that the sheet follows, a temperature or an enthalpy", .string = HK_AT(melting_membrane, name),
     .flags = HK_REQUIRED},
    {"softens", "", "the channel's value up to which the sheet is as stiff as when cold",
     .number = HK_AT(melting_membrane, softens), .flags = HK_REQUIRED},
    {"range", "", "by how much more a triangle is gone", .number = HK_AT(melting_membrane, range),
     .limits = HK_ABOVE(0), .flags = HK_REQUIRED},
    {0},
};

static const hk_field fields[] = {
    {"variable", .per_tuple = HK_AT(melting_membrane, variable), .list = "triangles", .width = VARIABLES},
    {0},
};

static double *variables(const melting_membrane *m, size_t k) { return m->variable + VARIABLES * m->listed[k]; }

/* ---- softening --------------------------------------------------------------------------------------------------- */

/* 1 - s of the present state. */
static double softened(const melting_membrane *m, const hk_view *view, const uint32_t *corner) {
  const double *y = view->y + m->channel->offset * view->n;
  return hk_softened((y[corner[0]] + y[corner[1]] + y[corner[2]]) / 3, m->softens, m->range);
}

static hk_elasticity cold(const melting_membrane *m, size_t k) {
  return (hk_elasticity){m->cold[0][k], m->cold[1][k], m->cold[2][k], m->cold[3][k]};
}

static void soften(melting_membrane *m, size_t k) {
  const double *q = variables(m, k);
  for (int r = 0; r < ELASTICITIES; r++) {
    if (q[GONE] > 0) m->cold[r][k] = 0;
    m->sheet.row[FIRST + r][k] = (1 - q[LOST]) * m->cold[r][k];
  }
}

static bool tears(const melting_membrane *m, size_t k, hk_metric g) {
  if (!m->breaking.count) return false;
  double d = (g.a - g.b) / 2, largest = sqrt((g.a + g.b) / 2 + sqrt(d * d + g.c * g.c));
  return largest - 1 > hk_tuple_value(&m->breaking, m->listed[k]);
}

static hk_status evolve(void *self, const hk_view *view, double h, hk_evolution *report) {
  melting_membrane *m = self;
  (void)h;
  for (size_t k = 0; k < m->sheet.node.count; k++) {
    double f[2][3], *q = variables(m, k);
    if (q[GONE] > 0) continue;
    hk_membrane_deformation(&m->sheet, k, view->x, f);
    hk_metric g = hk_membrane_metric((const double(*)[3])f);
    double lost = tears(m, k, g) ? 1 : softened(m, view, hk_tuple(&m->sheet.node, k));
    if (lost == q[LOST]) continue;
    report->dissipated += (lost - q[LOST]) * hk_membrane_energy(m->sheet.model, cold(m, k), g, m->sheet.exponent);
    report->changed = true;
    q[LOST] = lost, q[GONE] = lost >= 1;
    soften(m, k);
  }
  return HK_OK;
}

static void lost(const void *self, hk_lost_elements *out) {
  const melting_membrane *m = self;
  *out = (hk_lost_elements){m->given.triangles, m->variable + GONE, VARIABLES};
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

/* Those that act are in the order of the list, in the sheet as here. */
static void list(melting_membrane *m, const hk_view *view) {
  size_t count = 0;
  for (size_t t = 0; t < m->given.triangles.count; t++) {
    const uint32_t *corner = hk_tuple(&m->given.triangles, t);
    const bool *on = view->is_active;
    if (on && !(on[corner[0]] && on[corner[1]] && on[corner[2]])) continue;
    for (int r = 0; r < ELASTICITIES; r++) m->cold[r][count] = m->sheet.row[FIRST + r][count];
    m->listed[count++] = (uint32_t)t;
  }
}

static hk_status topology(void *self, const hk_view *view) {
  melting_membrane *m = self;
  hk_status status = hk_membrane_topology(&m->sheet, view);
  if (status != HK_OK) return status;
  list(m, view);
  for (size_t k = 0; k < m->sheet.node.count; k++) soften(m, k);
  return HK_OK;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  melting_membrane *m = self;
  size_t n = m->given.triangles.count + 1;
  hk_status status = hk_find_channel(host, view->model, m->name, "channel", 1, &m->channel);
  if (status == HK_OK) status = hk_membrane_create(&m->sheet, view, &m->given);
  if (status != HK_OK) return status;
  m->listed = host->allocate(host, n * sizeof *m->listed);
  double *rows = host->allocate(host, ELASTICITIES * n * sizeof *rows);
  for (size_t r = 0; rows && r < ELASTICITIES; r++) m->cold[r] = rows + r * n;
  if (!m->listed || !rows) return host->fail(host, HK_NO_MEMORY, "no memory for %zu triangles", n - 1);
  list(m, view);
  for (size_t k = 0; k < m->sheet.node.count; k++) { /* as it starts, it is as warm as it is */
    double *q = variables(m, k);
    q[LOST] = softened(m, view, hk_tuple(&m->sheet.node, k));
    q[GONE] = q[LOST] >= 1;
    soften(m, k);
  }
  return hk_breakage_enter(host, &(hk_breakable){lost, self});
}

/* Of the cold sheet, which any may be again; it has no elements, so nothing of it counts as damped by them. */
static void stiffness_bound(void *self, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  const melting_membrane *m = self;
  hk_membrane stiffest = m->sheet;
  for (int r = 0; r < ELASTICITIES; r++) stiffest.row[FIRST + r] = m->cold[r];
  hk_membrane_bound(&stiffest, view, part == HK_STIFFNESS_UNDAMPED ? HK_STIFFNESS_WHOLE : part, block);
}

static const hk_force force = {
    .size = sizeof(hk_force),
    .flags = HK_DEPENDS_ON_X | HK_DEPENDS_ON_V | HK_CONSERVES_MOMENTUM | HK_CONSERVES_ANGULAR_MOMENTUM | HK_POWER |
             HK_OFFERS_SYMMETRIC | HK_OFFERS_DEFINITE,
    .add = hk_membrane_add,
    .add_part = hk_membrane_add_part,
    .energy = hk_membrane_potential,
    .facets = HK_FACETS(HK_IMPLICIT_FACET(.pattern = hk_membrane_name_blocks, .jacobian = hk_membrane_add_blocks),
                        HK_BOUNDS_FACET(.stiffness_bound = stiffness_bound), HK_PARTS_FACET(.touch = hk_membrane_touch),
                        HK_INTERNAL_FACET(.evolve = evolve, .lost = lost)),
};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_FORCE,
    .name = "melting_membrane",
    .summary = "sheets that soften with a channel, melt and tear: the force membrane times s(T)",
    .reference = "Terzopoulos, Platt, Fleischer 1989, Heating and melting deformable models (from goop to glop); "
                 "energies as of membrane",
    .instance_size = sizeof(melting_membrane),
    .params = params,
    .fields = fields,
    .create = create,
    .topology = topology,
    .force = &force,
};
