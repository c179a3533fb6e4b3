/* Draws snapshots: with OpenGL 3.3 cloth lit from both sides, springs as tubes, and a floor with a grid; these objects
 * and the particles cast shadows on each other and the floor; then the particles (plugins/common/sprites), which
 * receive none. Needs a current context; one painter per context. */
#ifndef HK_PAINTER_H
#define HK_PAINTER_H

#include "plugins/common/gl/canvas.h"
#include "plugins/common/picture/height_map.h"
#include "plugins/common/normals/corner_normals.h"
#include "plugins/common/camera/view_setup.h"
#include "plugins/common/picture/patch.h"
#include "plugins/common/picture/water.h"
#include "plugins/common/snapshot/border.h"
#include "plugins/common/sprites/sprites.h"
#include "plugins/common/volume/volume.h"

typedef struct hk_tube { /* one spring, or one stroke of text */
  float a[3], b[3], radius;
  uint8_t colour_a[4], colour_b[4];
} hk_tube;

typedef struct hk_vertex {
  float x[3], normal[3];
  uint8_t colour[4];
} hk_vertex;

enum { HK_MESH, HK_TUBE, HK_FLOOR, HK_SHADE, HK_BACKDROP, HK_PROGRAMS };
enum { HK_THINGS, HK_SHADOWS, HK_SPRITES, HK_VOLUMES_PATCH, HK_PATCHES };
enum { HK_TUBE_CORNERS = 8 };
enum { HK_SHADOW_SIZE = 384 }; /* texels along a side */

typedef struct hk_painter {
  const hk_host *host;
  hk_canvas canvas;
  unsigned program[HK_PROGRAMS];
  unsigned mesh_array, mesh_buffer, index_buffer, tube_array, tube_buffer, corner_buffer, nothing;
  unsigned shadow, heights; /* textures of the two below */
  unsigned char *shade;     /* shadow on the floor: HK_SHADOW_SIZE squared, and as many for the blur */
  hk_height_map map;        /* shadows on all else */
  int uploaded[2];          /* rows of it outside of which the texture has nothing */
  /* Backdrop, floor and overlay: stored in the canvas for this camera, and as bytes. */
  bool kept;
  hk_camera kept_for;
  unsigned char *still;                                /* width x height x 4 */
  hk_patch patch[HK_PATCHES], old[HK_PATCHES];         /* what is drawn on it in this picture; in the last one read */
  bool fresh;                                          /* no picture was read since it was drawn */
  void (*overlay)(struct hk_painter *, void *context); /* draws strokes over all pictures; NULL: none */
  void *overlay_context;
  size_t room, triangle_room, tube_room, point_room;
  hk_vertex *vertex;
  hk_tube *tube;
  hk_point_sprite *point;
  uint32_t (*triangle)[3]; /* those whose corners have finite positions, and the solids' */
  size_t vertices, triangles, tubes, points;
  /* The triangles are those of cloth, of bodies, of closed solids, of those that are seen through, of planes, which
   * have no end and cast no shadow, and of a clear liquid: where each but the last end. */
  size_t cloth, bodies, opaque, faded, planes;
  float *share; /* a solid: of the motion that it hides */
  size_t share_room;
  hk_water water;
  const hk_volumes *volumes; /* smoke and flames; NULL: none are drawn */
  hk_volume_optics volume_optics;
  double volume_origin[3]; /* of positions, in the scene's coordinates, m */
  hk_border border;
  hk_corner_normals normals;
  float (*corner)[3]; /* 3 a face: normals */
  size_t corner_room;
  hk_sprites sprites;
} hk_painter;

hk_status hk_painter_open(hk_painter *, const hk_host *host, int width, int height);
void hk_painter_close(hk_painter *); /* a zeroed painter is allowed */

/* Draws everything but the particles; `colour` has one per particle. Floor and background must be the same for all
 * pictures of a painter; the box may differ. While the camera is the same only what moves is drawn anew. */
hk_status hk_painter_draw(hk_painter *, const hk_view_setup *setup, const hk_snapshot3d *snapshot,
                          uint8_t (*colour)[4]);
/* Sets the opacity of lights so that most of their pixels in this picture are neither dark nor white. HK_NO_MEMORY. */
hk_status hk_painter_expose(hk_painter *, hk_view_setup *setup, const hk_snapshot3d *snapshot, uint8_t (*colour)[4]);
/* Draws strokes over the picture: coordinates in pixels from the lower left corner, half width in pixels. */
void hk_painter_strokes(hk_painter *, const hk_tube *stroke, size_t count, double half_width);
/* Brings `rgba`, width x height pixels of 4 bytes with the bottom row first, from the last picture that was read into
 * it to the one that was drawn, with its particles, which strokes hide. HK_NO_MEMORY. */
hk_status hk_painter_read(hk_painter *, const hk_view_setup *setup, unsigned char *rgba);

#endif
