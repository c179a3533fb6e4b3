/* From a whole motion to the camera, the floor and the range of colours that suit all of its pictures. */
#ifndef HK_FRAMING_H
#define HK_FRAMING_H

#include "plugins/common/film/frame_spool.h"
#include "plugins/common/picture/view_setup.h"

typedef struct hk_framing {
  double eye[3], target[3]; /* in the scene's coordinates; NAN: chosen */
  double fov, aspect;
  bool floor;
  double height;    /* in the scene's coordinates; NAN: chosen */
  double radius;    /* of particles, m; NAN: chosen */
  double low, high; /* range of the numbers; NAN: chosen */
  bool centred;     /* the range is even about zero */
  bool counted;     /* the shots' ink is numbers that need a range */
} hk_framing;

/* Chooses for all shots of the spool, at least one; fills the plan's range. `shot` is used for reading. `wild` > 1:
 * frames that reach that many times farther than the median frame do not count (the run has diverged). */
hk_status hk_framing_motion(hk_framing *, const hk_frame_spool *spool, hk_snapshot3d *shot, double wild,
                            hk_view_setup *stage);
/* For pictures that are drawn at once, with a camera that is set: the first call, on a zeroed stage, chooses from the
 * first shot; later ones follow its box. */
void hk_framing_snapshot(hk_framing *, const hk_snapshot3d *shot, hk_view_setup *stage);

#endif
