#include "plugins/common/mac_grid/cell_viscosity.h"
#include "plugins/common/channels/find_published.h"

enum { GRAIN = 1024 };

hk_status hk_cell_viscosity_open(const hk_host *host, const hk_model *model, const char *label, double constant,
                                 size_t size, const double *const **values, double **cell) {
  if (constant > 0)
    return host->fail(host, HK_BAD_PARAM,
                      "viscosity: there are two, %g Pa s and those of '%s': leave out `viscosity` or `viscosity_of`",
                      constant, label);
  *cell = host->allocate(host, size * sizeof **cell);
  if (!*cell) return host->fail(host, HK_NO_MEMORY, "no memory for the viscosity of %zu cells", size);
  return hk_find_published(host, model, label, "local_viscosity", "viscosity_of", false, values);
}

typedef struct task {
  const hk_liquid_grid *grid;
  const hk_cell_particles *p;
  const double *viscosity;
  double *cell;
} task;

static void own_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  (void)piece;
  for (size_t c = begin; c < end; c++) {
    double sum = 0, count = 0;
    for (size_t k = t->p->start[c]; k < t->p->start[c + 1]; k++) {
      double mu = t->viscosity[t->p->index[t->p->particle[k]]];
      if (mu > 0) sum += log(mu), count++;
    }
    t->cell[c] = count > 0 ? exp(sum / count) : 0;
  }
}

static void fill_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_liquid_grid *g = t->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + g->cells[hk_liquid_inner(g)]; i++) {
      double sum = 0, count = 0;
      if (t->p->start[i] < t->p->start[i + 1]) continue;
      for (int c = 0; c < 3; c++)
        for (int side = 0; side < 2 && !g->flat[c]; side++) {
          size_t j = side ? i + g->stride[c] : i - g->stride[c];
          if (t->p->start[j] < t->p->start[j + 1] && t->cell[j] > 0) sum += log(t->cell[j]), count++;
        }
      if (count > 0) t->cell[i] = exp(sum / count);
    }
  }
}

void hk_cell_viscosity(const hk_liquid_grid *g, const hk_host *host, const hk_cell_particles *p,
                       const double *viscosity, double *cell) {
  task t = {g, p, viscosity, cell};
  host->parallel_for(host, g->size, GRAIN, own_piece, &t);
  host->parallel_for(host, hk_liquid_rows(g, 0), 8, fill_piece, &t);
}
