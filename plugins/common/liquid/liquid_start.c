/* See liquid_start.h. */
#include "plugins/common/liquid/liquid_start.h"
#include "plugins/common/mac_grid/narrow_gaps.h"
#include "plugins/common/mac_grid/thin_solids.h"
#include "plugins/common/obstacles/obstacles_service.h"

static const double most_off = 0.014; /* of the density, of all the liquid together: a round wall's cells make 0.012 */
static const double most_differs = 0.005; /* of it, from place to place: parts of which one has 1 % more */
static const double least_slope = 0.3;    /* of density by mass: 1 where equal particles fill equal volumes */

static const double deviations = 3; /* by which what is found is more than chance */

enum { APART = 3 /* cells, that no particle's kernel shares */, PAIRS = 16, SHARED = 6 /* pairs that a cell is in */ };

double hk_liquid_default_cell(const hk_view *view, const uint32_t *index, size_t count, double density,
                              const double low[3], const double high[3]) {
  double mass = 0;
  for (size_t k = 0; k < count; k++) mass += view->model->mass[index[k]];
  double volume = mass / ((double)count * density);
  bool plane = low[0] == high[0] || low[1] == high[1] || low[2] == high[2];
  /* in a plane a cell is as deep as it is wide, and has four particles: volume = cell^3/4 */
  return plane ? pow(4 * volume, 1.0 / 3) : 2 * pow(volume, 1.0 / 3);
}

hk_status hk_liquid_check_start(const hk_liquid *l, const hk_view *view, const uint32_t *index, size_t count) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < count; k++) {
    const double *x = view->x + 3 * (size_t)index[k];
    for (int c = 0; c < 3; c++)
      if (x[c] < g->low[c] || x[c] > g->high[c])
        return l->host->fail(
            l->host, HK_BAD_PARAM,
            "particle %u is outside the box, at %c = %g m where it goes from %g to %g: move it, take a "
            "larger box, or name those that are the liquid by `particles`",
            view->model->id[index[k]], "xyz"[c], x[c], g -> low[c], g -> high[c]);
  }
  return HK_OK;
}

/* kg, the mean of the particles that are in the cell; 0: there are none. */
static double mean_mass(const hk_liquid *l, const hk_liquid_particles *p, size_t i) {
  double sum = 0;
  for (size_t k = l->start[i]; k < l->start[i + 1]; k++) sum += p->mass[p->index[l->sorted[k]]];
  return sum > 0 ? sum / (double)(l->start[i + 1] - l->start[i]) : 0;
}

/* Cells within the liquid that no wall is near, whose volume it would have to guess. */
typedef struct look {
  double cells, particles, mean; /* of the density */
  /* 1: particles lie at random, so that cells differ by (2/3)^d of what their numbers do, which is what the trilinear
   * kernel leaves; near 0 in a lattice, whose means have no such chance */
  double randomness;
} look;

static look look_within(const hk_liquid *l) {
  const hk_liquid_grid *g = &l->grid;
  double sum = 0, squares = 0, kernel = 1;
  look at = {.mean = 1};
  for (int c = 0; c < 3; c++) kernel *= g->flat[c] ? 1 : 2.0 / 3;
  for (size_t k = 0; k < l->pressure.rows; k++) {
    size_t i = l->pressure.cell[k];
    if (!hk_liquid_is_within(l, i) || g->room[i] < 1) continue;
    at.cells++;
    at.particles += l->start[i + 1] - l->start[i];
    sum += g->filled[i];
    squares += g->filled[i] * g->filled[i];
  }
  if (!(at.particles > 0)) return at;
  at.mean = sum / at.cells;
  double variance = fmax(0, squares / at.cells - at.mean * at.mean);
  at.randomness = fmin(1, variance / (kernel * at.cells / at.particles));
  return at;
}

/* By how much the density differs with the mass of the particles: the deviation of what heavier ones make it, over
 * cells apart, where places at random, and columns whose masses make up for their distances, cancel out. */
static double differs_by_mass(const hk_liquid *l, const hk_liquid_particles *p, double randomness) {
  const hk_liquid_grid *g = &l->grid;
  double count = 0, m = 0, d = 0, mm = 0, md = 0, dd = 0;
  for (size_t k = 0; k < l->pressure.rows; k++)
    for (int c = 0; c < 3; c++) {
      size_t i = l->pressure.cell[k], j = i + APART * g->stride[c];
      if (i / g->stride[c] % (g->cells[c] + 2) + APART > g->cells[c]) continue;
      if (!hk_liquid_is_within(l, i) || !hk_liquid_is_within(l, j)) continue;
      double a = mean_mass(l, p, i), b = mean_mass(l, p, j);
      if (!(a > 0) || !(b > 0)) continue;
      count += 2;
      m += a + b;
      d += g->filled[i] + g->filled[j];
      dd += g->filled[i] * g->filled[i] + g->filled[j] * g->filled[j];
      mm += a * a + b * b;
      md += a * g->filled[j] + b * g->filled[i];
    }
  if (count < PAIRS) return 0;
  double deviation = sqrt(fmax(0, mm / count - m / count * (m / count)));
  if (!(deviation > 1e-6 * m / count)) return 0;
  double differs = (md / count - m / count * (d / count)) / deviation;
  double rest = fmax(0, dd / count - d / count * (d / count) - differs * differs);
  double chance = randomness * sqrt(rest / (count / SHARED));
  if (differs < deviations * chance) return 0;
  return differs * m / count > least_slope * deviation ? differs : 0;
}

double hk_liquid_off_at_start(const hk_liquid *l, const hk_liquid_particles *p) {
  if (l->inside <= HK_LIQUID_ENOUGH) return 0;
  const look at = look_within(l);
  double off = at.mean - 1, differs = differs_by_mass(l, p, at.randomness);
  if (differs > most_differs) {
    l->host->warn(
        l->host,
        "the particles' masses are those of several densities, which differ by %.2g %% from their mean, and the "
        "liquid has one of %g kg/m^3: heavy parts will swell to it, light ones shrink, and none rises or sinks; "
        "give all of them masses density x volume",
        100 * differs, l->density);
    return differs;
  }
  if (at.cells <= HK_LIQUID_ENOUGH) return 0;
  if (!(fabs(off) > most_off + deviations * at.randomness / sqrt(at.particles))) return 0;
  l->host->warn(l->host,
                "the particles have %.4g kg/m^3 where they fill cells at the start, and `density` is %g: the liquid "
                "will %s by %.2g %%; give them masses density x volume",
                at.mean * l->density, l->density, off > 0 ? "swell" : "shrink", 100 * fabs(off));
  return fabs(off);
}

hk_status hk_liquid_check_isolated(const hk_liquid *l, const bool *const *own, const hk_view *view, const double *x) {
  const hk_obstacle_set *set = l->obstacles;
  for (size_t k = 0; k < set->carriers; k++)
    for (size_t i = 0; set->carried[k] != own && i < view->n; i++)
      if ((*set->carried[k])[i] && hk_liquid_in_box(&l->grid, x + 3 * i))
        return l->host->fail(l->host, HK_BAD_PARAM,
                             "particle %u is of another liquid and in the box of this one at t = %g s: liquids do not "
                             "meet, and would flow through each other; make them one, which has one density, or give "
                             "them boxes apart",
                             view->model->id[i], view->t);
  return HK_OK;
}

void hk_liquid_warn_of_births(const hk_liquid *l, const hk_view *view, const uint32_t *index, size_t count) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      double x = view->x[3 * (size_t)index[k] + (size_t)c];
      if (x >= g->low[c] && x <= g->high[c]) continue;
      l->host->warn(l->host,
                    "particles of the liquid are born outside its box, and the next step puts them on its faces: "
                    "emit them inside, or take a larger box");
      return;
    }
}

void hk_liquid_warn_of_walls(hk_liquid *l) {
  static const bool open[3][2];
  hk_warn_of_thin(l->host, &l->grid, l->obstacles, "the liquid");
  l->gap = hk_warn_of_gaps(l->host, &l->grid, l->obstacles, open, "liquid");
}

hk_status hk_liquid_find_walls(hk_liquid *l, const bool *const *carried) {
  const hk_obstacles *all = l->host->query(l->host, HK_OBSTACLES_INTERFACE);
  const hk_inflows *inflows = l->host->query(l->host, HK_INFLOWS_INTERFACE);
  if (!all || !inflows) return HK_FAILED;
  l->obstacles = all->set;
  l->inflows = inflows;
  inflows->take(inflows->self);
  return all->carry(all->self, carried);
}
