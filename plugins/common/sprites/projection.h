/* Perspective of particles: points in the scene to sprites on the picture. */
#ifndef HK_PROJECTION_H
#define HK_PROJECTION_H

#include "core/plugin.h"
#include "plugins/common/camera/camera.h"
#include "plugins/common/sprites/sprite.h"

/* Half the side of the square, in pixels, that a sprite of this radius can change: a disc thinner than a pixel's
 * diagonal would miss the middles of all pixels at times. */
float hk_sprite_half(float radius);
/* sprite[k] becomes what the eye sees of point[k]. */
void hk_project_points(const hk_host *, const hk_lens *, const hk_sprite_shading *, int width, int height,
                       const hk_point_sprite *point, size_t count, hk_sprite *sprite);

#endif
