/* The content of one picture, copied from the scene: positions, a number or colour per particle, and the edges and
 * triangles. */
#ifndef HK_SNAPSHOT3D_H
#define HK_SNAPSHOT3D_H

#include "plugins/common/snapshot/appearance.h"
#include "plugins/common/frame_data/solid.h"

typedef union hk_particle_colour { /* hk_snapshot3d.colour: by hk_appearance.paint */
  float number;
  uint8_t colour[4];
} hk_particle_colour;

enum { HK_MARK_POINT = 1, HK_MARK_PIN = 2, HK_MARK_BODY = 4 }; /* hk_snapshot3d.mark */

enum { HK_EXTRA_SIZE, HK_EXTRA_FADE, HK_EXTRA_VELOCITY, HK_EXTRA_TUBE, HK_EXTRAS };

/* z is up. Positions are relative to `origin`, m, and single precision; a particle without a finite position has NAN.
 */
typedef struct hk_snapshot3d {
  const hk_host *host;
  const hk_appearance *appearance;
  double origin[3];
  size_t n;
  float (*x)[3];              /* n */
  hk_particle_colour *colour; /* n */
  uint8_t *mark;              /* n */
  uint8_t *role;              /* n, scratch: what a particle belongs to, while the topology is taken */
  double *strain;             /* n, scratch, where colours show it, tension or stress; otherwise NULL */
  /* What the appearance asks for, otherwise NULL: by hk_appearance.sizes the cube root of the mass or the radius, n;
   * opacity, n; velocity, n x 3; radius of the strand, m, 0: it has none of its own, n. */
  float *extra[HK_EXTRAS];
  size_t solids;
  hk_frame_solid *solid; /* in the scene's coordinates, z up; the caller's, who may move them */
  size_t obstacles;      /* the first of them, which are drawn transparent where they hide the others */
  bool liquid;           /* the last of them is a mesh that is another one at each picture */
  const double
      *normal;  /* of its vertices, x 3, outwards, of length 1, in its own axes, the caller's; NULL: not known */
  double *mesh; /* memory for those that are read: places, then normals */
  uint32_t (*mesh_face)[3];
  size_t mesh_room, face_room;
  size_t triangles, lines;
  /* The first triangles are of cloth, the next, up to `rigid`, of surfaces that ride on bodies, the others of surfaces
   * that are pinned as a whole. */
  size_t cloth, rigid;
  uint32_t (*triangle)[3];
  uint32_t (*line)[2];
  uint64_t topology; /* number of the topology: when it changes, mark, triangle or line may change; 0: not copied yet */
  uint64_t fingerprint;
  bool painted; /* some particle's colour is seen: of a point, a line, cloth or a surface that rides */
  bool stale;   /* mark, triangle or line must be copied again */
  size_t room, triangle_room, line_room;
  double eye[3], target[3]; /* of the camera at this time, in the scene's coordinates with z up; NAN: not given */
  float low[3], high[3];    /* box of the finite positions; low > high when there are none */
  float reach;              /* largest distance from the origin, m */
} hk_snapshot3d;

/* An empty one; `appearance` must stay valid. */
void hk_snapshot3d_open(hk_snapshot3d *, const hk_host *host, const hk_appearance *appearance);
void hk_snapshot3d_free(hk_snapshot3d *);                           /* a zeroed one is allowed */
size_t hk_snapshot3d_extra_width(const hk_snapshot3d *, int extra); /* numbers per particle; 0: there are none */
/* Reserves memory for these numbers; arrays that must grow lose their content. */
hk_status hk_snapshot3d_reserve(hk_snapshot3d *, size_t n, size_t triangles, size_t lines);
/* Copies the scene but for colour and extra (plugins/common/snapshot/particle_colour.h). `changed`: the topology may
 * differ from the last call's. Sets the origin at the first call. */
hk_status hk_snapshot3d_take(hk_snapshot3d *, const hk_view *view, bool changed);

#endif
