/* The strain that particles and cells show, in pictures, recordings and on pages alike: of a particle the largest by
 * magnitude of all elements that it belongs to, with its sign. A mean would hide what is near its limit: stretch beside
 * compression would cancel. */
#ifndef HK_FRAME_DATA_STRAIN_H
#define HK_FRAME_DATA_STRAIN_H

#include "plugins/common/frame_data/frame_data.h"

/* The strains of `count` particles shown; 0: of no element. place: of each particle of the view its index among them,
 * UINT32_MAX: it is not shown; NULL: all are, in their order. */
void hk_particle_strains(const hk_view *, const uint32_t *place, size_t count, double *strain);
/* Takes the strains of cells and particles, once the cells are known. */
void hk_gatherer_strain(hk_gatherer *, const hk_view *view);

#endif
