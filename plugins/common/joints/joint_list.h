/* Lists of joints: made of edges, with the numbers of each joint. */
#ifndef HK_JOINT_LIST_H
#define HK_JOINT_LIST_H

#include "core/plugin.h"

/* The parameters of a force on joints; lists given for `joints` come in that order. */
typedef struct hk_joint_numbers {
  hk_per_tuple *k;        /* N m/rad, of joints; becomes one number per joint, k + EI/l */
  const hk_per_tuple *EI; /* N m^2, of edges, or one number */
  hk_per_tuple *damping;  /* N m s/rad, of joints; becomes one number per joint */
  hk_per_tuple *rest;     /* rad, of joints; count 0: left to the caller unless there is a curvature */
  double curvature;       /* 1/m; NAN: none */
  double retardation;     /* s */
} hk_joint_numbers;

/* Sets *joints to those given followed by those of `edges`: consecutive edges that share one end, and the last with the
 * first where they close a ring. Then fills the numbers with one per joint. The memory is the instance's; the host
 * keeps the lists up to date when particles die. HK_BAD_PARAM: edges have no joint, or nothing has a stiffness. */
hk_status hk_joint_list_make(const hk_view *view, const hk_tuples *edges, hk_tuples *joints, const hk_joint_numbers *);

#endif
