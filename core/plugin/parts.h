/* Parts of a sum of forces. The host cuts the particles into blocks by index, and the blocks into domains, by their
 * number alone. An evaluation goes through a domain block by block, so that the data of a block stay in the cache while
 * all forces and the method's own operations use them; domains are worked on at the same time, by as many threads as
 * there are, with the same result.
 *
 * A force that is a sum over elements, or over particles, offers its parts (hk_force.add_part). An element belongs to
 * one: that of its highest block, where its particles lie in one domain, that of the two domains in which they lie, or
 * the last part of all, where there are more. */
#ifndef HK_PLUGIN_PARTS_H
#define HK_PLUGIN_PARTS_H

enum { HK_DOMAINS = 16 }; /* at most */

/* Of the model; constant until particles are born or die. */
typedef struct hk_partition {
  size_t n;       /* particles */
  unsigned bits;  /* block b has the particles from b << bits to below (b + 1) << bits, or n */
  size_t blocks;  /* at least 1 */
  size_t width;   /* blocks of a domain; the last one may have fewer */
  size_t domains; /* 1 to HK_DOMAINS */
  size_t parts;   /* part b < blocks: the elements of block b; then those of the domains p < q, at blocks + q (q - 1)/2
                     + p; last the other elements */
} hk_partition;

/* The part of an element of `arity` particles. */
static inline size_t hk_part_of(const hk_partition *p, const uint32_t *index, size_t arity) {
  size_t low = index[0], high = index[0];
  for (size_t c = 1; c < arity; c++) {
    low = index[c] < low ? index[c] : low;
    high = index[c] > high ? index[c] : high;
  }
  low >>= p->bits, high >>= p->bits;
  size_t first = low / p->width, last = high / p->width;
  if (first == last) return high;
  for (size_t c = 0; c < arity; c++) {
    size_t domain = (index[c] >> p->bits) / p->width;
    if (domain != first && domain != last) return p->parts - 1;
  }
  return p->blocks + last * (last - 1) / 2 + first;
}

static inline size_t hk_part_rank(const hk_view *view, size_t i) {
  size_t low = 0, high = view->acting;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (view->active[middle] < i)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* For a force on each particle alone: part `part` has the particles begin to end - 1 of those that the force acts on
 * (view->active, or all); none: begin = end. */
static inline void hk_part_acting(const hk_view *view, size_t part, size_t *begin, size_t *end) {
  unsigned bits = view->model->partition->bits;
  size_t last = (part + 1) << bits;
  *begin = part << bits;
  *end = last < view->n ? last : view->n;
  if (*begin > *end) *begin = *end;
  if (!view->active) return;
  *begin = hk_part_rank(view, *begin);
  *end = hk_part_rank(view, *end);
}

#endif
