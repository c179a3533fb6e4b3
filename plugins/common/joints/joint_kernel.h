/* The forces of many joints, in blocks of vectors and on several threads. */
#ifndef HK_JOINT_KERNEL_H
#define HK_JOINT_KERNEL_H

#include "core/plugin.h"

/* Copies of the acting joints: those of a chunk whose particles no other chunk touches, chunk after chunk, then the
 * rest, which are added after all chunks. To be zeroed before the first use; the memory belongs to the instance. */
typedef struct hk_joint_layout {
  size_t count, chunks;
  size_t *first;       /* chunks + 2: the first joint of each chunk, of the rest, and the end */
  uint32_t (*node)[3]; /* particles */
  uint32_t *element;   /* numbers in the list of elements */
  double *k, *c, *rest;
  double *power; /* W, of each chunk */
  bool damped;
} hk_joint_layout;

/* Copies the elements, whose values are one angle each. HK_NO_MEMORY. */
hk_status hk_joint_layout_build(hk_joint_layout *, const hk_host *host, size_t n, const hk_elements *from);
/* F += the forces of all joints. plane: as in hk_joint_measure. */
void hk_joint_forces(const hk_joint_layout *, const hk_view *view, const double plane[3], double *F);

#endif
