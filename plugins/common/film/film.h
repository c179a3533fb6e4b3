/* Pictures of a motion, one per frame. They are drawn immediately when nothing in them depends on later frames. When
 * the camera, the range of colours or the floor is chosen for the whole motion, frames are stored in an unlinked file
 * and drawn at the end. */
#ifndef HK_FILM_H
#define HK_FILM_H

#include "plugins/common/colour/colormap.h"
#include "plugins/common/film/view_grid.h"
#include "plugins/common/film/film_files.h"
#include "plugins/common/film/contact_sheet.h"
#include "plugins/common/gl/gl_context.h"
#include "plugins/common/obstacles/obstacle.h"
#include "plugins/common/camera/framing.h"
#include "plugins/common/picture/painter.h"

typedef struct hk_film {
  /* To be set before hk_film_open. */
  int width, height;   /* pixels */
  hk_film_files files; /* its plan */
  size_t stills;       /* of the sheet; 0: there is none */
  bool legend;
  double plain[3]; /* colour of everything where nothing else is shown, 0..1; NAN: blue */
  hk_colormap map;
  bool reverse;
  const char *label, *unit; /* of the legend; unit NULL: as the label has it */
  size_t solids;
  const hk_frame_solid *solid;      /* valid until hk_film_open returns; in coordinates with z up */
  hk_frame_solid *liquid;           /* its surface, a mesh that may be another one at each picture; NULL: none */
  const double *liquid_normal;      /* as hk_snapshot3d.normal; may be others at each picture */
  double liquid_radius;             /* m, of its particles */
  const hk_obstacle_set *obstacles; /* drawn where they are at each frame; NULL: none */
  const hk_volumes *volumes;        /* smoke and flames, as they are when a picture is added; NULL: none */
  hk_volume_optics volume_optics;
  size_t skins; /* surfaces of rigid bodies, drawn likewise */
  hk_appearance appearance;
  hk_framing framing;  /* with the viewports of the pictures */
  hk_camera_place own; /* of the scene's own camera, in the scene's coordinates, z up; may change before each picture */
  bool follow;         /* the cameras go along with the particles */
  hk_view_setup setup; /* what is not chosen by the framing: background, sprites, streak */

  const hk_host *host;
  bool waiting;           /* frames are drawn at the end */
  hk_snapshot3d snapshot; /* its solids: those of the script, then the obstacles, then the bodies' */
  hk_frame_spool spool;
  hk_contact_sheet sheet;
  hk_gl_context *gl;
  hk_painter painter; /* of a view */
  hk_view_grid grid;
  size_t view;          /* the one that is drawn */
  hk_camera_place *way; /* where cameras follow: views x frames */
  bool bare;            /* the picture that is drawn has no legend */
  double least, most;   /* numbers of the frames so far that have a colour; least > most: none */
  bool painted;         /* some picture so far shows what the bar of colours stands for */
  uint8_t (*colour)[4]; /* one per particle */
  size_t colours;
  unsigned char *picture, *cell; /* width x height x 4; of a view, where there are several */
  uint8_t table[HK_MAP_SIZE][4];
  char text[96]; /* label and unit */
} hk_film;

hk_status hk_film_open(hk_film *, const hk_host *host);
/* `birth`: as in hk_particle_colours_take. `changed`: the topology may differ from the last call's. */
hk_status hk_film_add(hk_film *, const hk_view *view, const hk_frame *frame, const double *birth, bool changed);
/* Draws the frames that wait, and ends the video. */
hk_status hk_film_finish(hk_film *, hk_verdict verdict);
void hk_film_free(hk_film *); /* a zeroed or freed one is allowed */

#endif
