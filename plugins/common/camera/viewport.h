/* The views of a picture: each has a camera of its own, and its name in a corner. */
#ifndef HK_VIEWPORT_H
#define HK_VIEWPORT_H

#include "core/plugin.h"
#include "plugins/common/camera/camera.h"

enum { HK_VIEWPORTS = 16, HK_VIEWPORT_NAME = 16 };

typedef struct hk_viewport {
  char name[HK_VIEWPORT_NAME]; /* "": the only view of its picture */
  bool own;                    /* of the scene's own camera, whose place may be another one in each picture */
  double direction[3];         /* of the others, from what is seen to the camera, z up; NAN: it stands at `given` */
  hk_camera_place given;       /* in the scene's coordinates, z up; NAN: chosen */
  hk_camera camera;            /* chosen for the motion */
} hk_viewport;

/* Reads names, with commas or blanks between them: camera, front, back, left, right, top, bottom, and camera2, camera3
 * ..., of which `more` has six numbers each: x, y, z of where it stands and of what it looks at. NULL or "": the
 * scene's own camera alone. HK_BAD_PARAM. */
hk_status hk_viewports_read(const hk_host *, const char *names, const hk_numbers *more, bool y_up,
                            hk_viewport port[HK_VIEWPORTS], size_t *count);

#endif
