/* Networks of springs that stand in for a scene: an hk_system without the engine, for tests of core/numerics/stability.
 */
#ifndef HK_TEST_NETWORK_H
#define HK_TEST_NETWORK_H

#include "core/engine/base/base.h"

typedef struct spring_network {
  hk_system system; /* first member */
  hk_split_table split;
  hk_system_queries queries;
  hk_model model;
  hk_partition partition; /* one block */
  hk_element_list list;
  hk_force_info force;
  size_t n, edges, capacity;
  double *mass, *inverse_mass, *X;
  uint8_t *pin;
  uint32_t (*pair)[2];
  double *stiffness, *damping, *rest;
  double drag;                  /* 1/s, acceleration -drag v */
  double gyration;              /* 1/s, acceleration gyration v x e_z */
  double decay;                 /* 1/s, of the one channel */
  double extra;                 /* 1/s^2, acceleration -extra x, which no element knows */
  bool covered;                 /* the bound of the springs is said to account for all that depends on x */
  size_t evaluations, fails_at; /* fails_at: the evaluation that is not finite; 0: none */
  hk_channel channel;
} spring_network;

spring_network *network_create(size_t n, size_t edges, bool channel); /* masses 1, all at the origin, no edges yet */
void network_destroy(spring_network *);
void network_place(spring_network *, size_t i, double x, double y, double z);
void network_mass(spring_network *, size_t i, double mass);
void network_fix(spring_network *, size_t i);
void network_join(spring_network *, size_t i, size_t j, double k, double c); /* at rest where the ends are */

/* Largest eigenvalues of M^-1/2 K M^-1/2 and M^-1/2 D M^-1/2 from their entries, by Jacobi's rotations. */
double network_largest_stiffness(const spring_network *);
double network_largest_damping(const spring_network *);

#endif
