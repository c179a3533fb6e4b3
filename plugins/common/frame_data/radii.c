#include "plugins/common/frame_data/radii.h"

#include <math.h>
#include <string.h>

const hk_drawn_radii hk_drawn = {.tube = {0.01, 0.006, 0.0022, 0.0012},
                                 .most = {60, 300, 5000},
                                 .on_tubes = 1.9,
                                 .loose = 0.34,
                                 .least = 0.004,
                                 .largest = 0.03,
                                 .pin = 0.0065,
                                 .pin_on_tubes = 1.25};

double hk_drawn_tube(double size, double lines) {
  int k = 0;
  while (k < HK_TUBE_CLASSES - 1 && lines > hk_drawn.most[k]) k++;
  return size * hk_drawn.tube[k];
}

double hk_drawn_loose(double size, double n) {
  return fmin(fmax(hk_drawn.loose / sqrt(n + 1), hk_drawn.least), hk_drawn.largest) * size;
}

hk_strand_radii hk_strand_radii_find(const hk_host *host, const hk_model *m) {
  hk_strand_radii r = {.strands = host->query(host, "strands/1")};
  for (size_t k = 0; k < m->publications && !r.contact; k++)
    if (strcmp(m->published[k].name, "strand_radius") == 0 && m->published[k].width == 1)
      r.contact = m->published[k].values;
  return r;
}

/* Of the strand that the particle with this id is of; 0: of none. */
static double of_strand(const hk_strands *all, uint32_t id) {
  size_t low = 0, high = all ? all->count : 0;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (all->item[middle].first <= id)
      low = middle + 1;
    else
      high = middle;
  }
  const hk_strand *last = low > 0 ? all->item + low - 1 : NULL; /* the last that begins at or before it */
  return last && id - last->first < last->count ? last->radius : 0;
}

double hk_strand_radius(const hk_strand_radii *r, const hk_model *m, size_t particle) {
  const double *contact = r->contact ? *r->contact : NULL;
  return contact && contact[particle] > 0 ? contact[particle] : of_strand(r->strands, m->id[particle]);
}
