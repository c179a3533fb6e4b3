/* The forces of many joints, in blocks of vectors and on several threads. */
#ifndef HK_JOINT_KERNEL_H
#define HK_JOINT_KERNEL_H

#include "plugins/kit/parts/part_sums.h"

/* Copies of the acting joints, part after part. To be zeroed before the first use; the memory belongs to the instance.
 */
typedef struct hk_joint_layout {
  size_t count;
  hk_part_sums sums;   /* of the copies, by their places here */
  uint32_t (*node)[3]; /* particles */
  uint32_t *element;   /* numbers in the list of elements */
  double *k, *c, *rest;
  bool damped;
} hk_joint_layout;

/* Copies the elements, whose values are one angle each. HK_NO_MEMORY. */
hk_status hk_joint_layout_build(hk_joint_layout *, const hk_view *view, const hk_elements *from);
/* F += the forces of the joints of one part or of HK_ALL_PARTS. plane: as in hk_joint_measure. */
void hk_joint_forces(const hk_joint_layout *, const hk_view *view, const double plane[3], size_t part, double *F);
static inline hk_tuples hk_joint_nodes(const hk_joint_layout *s) {
  return (hk_tuples){s->count, 3, s->node ? s->node[0] : NULL};
}

#endif
