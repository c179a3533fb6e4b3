/* Choice of the camera, the floor and the range of colours for all pictures of a motion. */
#ifndef HK_FRAMING_H
#define HK_FRAMING_H

#include "plugins/common/colour/scale.h"
#include "plugins/common/snapshot/frame_spool.h"
#include "plugins/common/camera/view_setup.h"
#include "plugins/common/camera/viewport.h"

typedef struct hk_framing {
  hk_viewport viewport[HK_VIEWPORTS]; /* their cameras are chosen */
  size_t viewports;                   /* at least 1 */
  double fov, aspect;
  bool floor;
  double height;   /* in the scene's coordinates; NAN: chosen */
  double radius;   /* of particles, m; NAN: chosen */
  double tube;     /* radius of springs, m; NAN: chosen */
  double outliers; /* share of the particles that the picture may leave out on each side */
  hk_scale scale;  /* of the numbers; low NAN: chosen */
  bool centred;    /* the range is symmetric about zero */
  bool counted;    /* the snapshots' colours are numbers that need a scale */
} hk_framing;

/* Chooses cameras and settings for all snapshots of the spool, at least one; fills the framing's scale. `snapshot` is
 * scratch memory for reading. `wild` > 1: frames that reach more than this many times farther than the median frame are
 * ignored (the run has diverged). */
hk_status hk_framing_motion(hk_framing *, hk_frame_spool *spool, hk_snapshot3d *snapshot, double wild,
                            hk_view_setup *setup);
/* For pictures of one view that are drawn immediately with a given camera: the first call, on a zeroed setup, chooses
 * the settings by the first snapshot; later calls follow its box. */
void hk_framing_snapshot(hk_framing *, const hk_snapshot3d *snapshot, hk_view_setup *setup);
/* Makes it the setup's camera, at the place, in the scene's coordinates with z up; what is NAN there stays the
 * camera's.
 */
void hk_framing_move(const hk_camera *, const hk_camera_place *, const double origin[3], hk_view_setup *setup);

#endif
