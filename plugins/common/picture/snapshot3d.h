/* The content of one picture, copied from the scene: positions, a number or colour per particle, and the edges and
 * triangles. */
#ifndef HK_SNAPSHOT3D_H
#define HK_SNAPSHOT3D_H

#include "core/plugin.h"

typedef enum hk_paint {
  HK_PAINT_NONE,    /* one colour for all */
  HK_PAINT_STRAIN,  /* mean strain of the springs at a particle, weighted by their stiffness */
  HK_PAINT_SPEED,   /* |v|, m/s */
  HK_PAINT_GROUP,   /* a colour per group */
  HK_PAINT_CHANNEL, /* a channel's number, or the length of its vector */
  HK_PAINT_RGB      /* a channel of three numbers in 0..1: red, green, blue */
} hk_paint;

typedef struct hk_look {
  hk_paint paint;
  size_t channel;         /* position in model->channel */
  int springs, particles; /* 0 auto: those not shown by other objects; 1 all; 2 none */
} hk_look;

/* Sets the colouring that `colour` names: auto, none, strain, speed, group or a channel; HK_BAD_PARAM: unknown name.
 * `label`: name and unit of the numbers (the host owns a channel's name). */
hk_status hk_look_choose(hk_look *, const hk_host *host, const hk_model *model, const char *colour, const char **label);

typedef union hk_ink { /* hk_snapshot3d.ink: by hk_look.paint */
  float number;
  uint8_t colour[4];
} hk_ink;

enum { HK_MARK_BEAD = 1, HK_MARK_PIN = 2 }; /* hk_snapshot3d.mark */

/* Positions are relative to `origin`, m, and single precision; a particle without a finite position has NAN. */
typedef struct hk_snapshot3d {
  const hk_host *host;
  double origin[3];
  size_t n;
  float (*x)[3]; /* n */
  hk_ink *ink;   /* n */
  uint8_t *mark; /* n */
  float *weight; /* n, scratch */
  size_t triangles, lines;
  uint32_t (*triangle)[3];
  uint32_t (*line)[2];
  uint64_t topology; /* number of the topology: when it changes, mark, triangle or line may change; 0: not copied yet */
  uint64_t fingerprint;
  bool stale; /* mark, triangle or line must be copied again */
  size_t room, triangle_room, line_room;
  float low[3], high[3]; /* box of the finite positions; low > high when there are none */
  float reach;           /* largest distance from the origin, m */
} hk_snapshot3d;

/* Reserves memory for these numbers; arrays that must grow lose their content. */
hk_status hk_snapshot3d_reserve(hk_snapshot3d *, size_t n, size_t triangles, size_t lines);
/* Copies the scene. `changed`: the topology may differ from the last call's. Sets the origin at the first call. */
hk_status hk_snapshot3d_take(hk_snapshot3d *, const hk_view *view, const hk_look *look, bool changed);
void hk_snapshot3d_free(hk_snapshot3d *);

#endif
