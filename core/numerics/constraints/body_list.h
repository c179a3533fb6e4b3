/* Particles that equations join: the graph, with room for how its bodies respond to impulses. */
#ifndef HK_BODY_LIST_H
#define HK_BODY_LIST_H

#include "core/numerics/constraints/constraints.h"

struct hk_body_list {
  hk_body_service table;
  hk_dynamics *dynamics;
  bool known;        /* the lists are those of `revision`, of the constraints */
  uint64_t revision; /* of the constraints */
  size_t particles, equations;
  size_t count;                 /* bodies */
  uint32_t *of;                 /* particles: the body; UINT32_MAX: none */
  size_t *member_start;         /* count + 1 */
  uint32_t *member;             /* particles of bodies, rising within one */
  size_t *row_start, *block_at; /* count + 1: in `row` and in `block` */
  uint32_t *row, *block;        /* the equations and the blocks (constraints.h) of bodies, rising within one */
  uint32_t *local;              /* equations: the position in its body */
  size_t edges;
  uint32_t (*edge)[2];
  size_t *factor_start; /* count + 1: in `factor`; of no length: the body is too large for a dense one */
  double *factor;       /* lower triangles, row by row */
  bool *factored;       /* count */
  bool whole_factored;  /* the scene's solver has the present matrix of all equations */
  size_t one_sided;     /* of the present place */
  hk_one_sided *pair;   /* equations */
  double *room;         /* equations */
  double *response;     /* particles x 3 */
};

enum { HK_DENSE_BODY = 96 /* equations */ };

/* Finds the graph where the constraints have changed. HK_NO_MEMORY. */
hk_status hk_body_list_update(hk_body_list *);
void hk_body_list_free(hk_body_list *); /* its lists; it is empty then */

#endif
