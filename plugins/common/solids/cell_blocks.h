/* Blocks of forces -z grad V of cells, z a pressure, and bounds of their stiffness. */
#ifndef HK_CELL_BLOCKS_H
#define HK_CELL_BLOCKS_H

#include "plugins/common/solids/cells.h"

/* Most particles of a cell whose blocks are given: the volume couples each with each, some 20 MB for so many. */
enum { HK_CELL_MEMBERS = 512 };

/* Of one cell: z = stiffness (V - V_0) + damping dV/dt. */
typedef struct hk_cell_pressure {
  double stiffness, damping, z; /* Pa/m^3, Pa s/m^3, Pa */
} hk_cell_pressure;

/* The blocks between all members of the cells with at most HK_CELL_MEMBERS of them. */
void hk_cells_pattern(const hk_cells *, hk_pattern *pattern);
/* Adds the blocks of the acting cell c, after hk_cells_measure at the same view; *next is the number of blocks already
 * added. `gradient`: room for 6 numbers per member. */
void hk_cells_jacobian(const hk_cells *, const hk_view *view, size_t c, hk_cell_pressure, const hk_blocks *into,
                       size_t *next, double (*gradient)[3]);
/* Of cells whose pressure z is given, -dF/dx = z H: the blocks between the corners of each triangle, for any number of
 * members. They are symmetric since the surface is closed; HK_WANT_DEFINITE projects those of each side of a triangle.
 */
void hk_cells_corner_pattern(const hk_cells *, hk_pattern *pattern);
void hk_cells_corner_jacobian(const hk_cells *, const hk_view *view, size_t c, double z, const hk_blocks *into,
                              size_t *next);
/* Adds a bound of stiffness (g.u)^2 and, with `curved`, of z u.H u. */
void hk_cells_bound(const hk_cells *, const hk_view *view, size_t c, hk_cell_pressure, bool curved,
                    double (*gradient)[3], double (*block)[6]);

#endif
