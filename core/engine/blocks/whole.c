/* F of one force over all particles: its `add`, or all of its parts. Domains are taken at the same time, each with its
 * blocks in order, and then the parts across domains in theirs; each has a place of its own for its power, and these
 * are added in order, so that the result does not depend on the number of threads. */
#include "core/engine/blocks/blocks.h"
#include "core/engine/contract/contract.h"

typedef struct sum {
  const hk_instance *force;
  const hk_view *view;
  const hk_partition *partition;
  double *F, power[HK_DOMAINS];
  size_t first, last; /* the blocks to be asked: `first` to `last` - 1 */
} sum;

static void add_part(const sum *s, size_t part, double *power) {
  hk_view view = *s->view;
  view.power = s->view->power ? power : NULL;
  s->force->plugin->force->add_part(s->force->self, &view, part, s->F);
}

static void add_domains(void *context, size_t begin, size_t end, size_t chunk) {
  sum *s = context;
  size_t width = s->partition->width, first = begin * width, last = end * width;
  (void)chunk;
  if (first < s->first) first = s->first;
  if (last > s->last) last = s->last;
  for (size_t b = first; b < last; b++) add_part(s, b, &s->power[b / width]);
}

hk_status hk_force_add(const hk_instance *force, const hk_view *view, double *F) {
  const hk_force_tables *f = hk_force_of(force->plugin);
  if (f->own.add) return f->own.add(force->self, view, F);
  const hk_partition *p = view->model->partition;
  sum s = {.force = force, .view = view, .partition = p, .F = F, .last = p->blocks};
  if (!f->parts.touch && view->active) { /* on each particle alone: a view of a few is asked for their blocks only */
    s.first = view->acting ? view->active[0] >> p->bits : 0;
    s.last = view->acting ? (view->active[view->acting - 1] >> p->bits) + 1 : 0;
  }
  hk_threads_for(force->shared->threads, p->domains, 1, add_domains, &s);
  double power = 0;
  for (size_t d = 0; d < p->domains; d++) power += s.power[d];
  for (size_t part = p->blocks; f->parts.touch && part < p->parts; part++) add_part(&s, part, &power);
  if (view->power) *view->power += power;
  return HK_OK;
}
