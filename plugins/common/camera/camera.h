/* A perspective camera, z up, and its automatic placement. Lengths in m, angles in radians. */
#ifndef HK_CAMERA_H
#define HK_CAMERA_H

#include <stddef.h>

typedef struct hk_camera {
  double eye[3], target[3];
  double fov;       /* from the bottom to the top of the picture */
  double aspect;    /* width / height */
  double near, far; /* distances between which objects are visible */
} hk_camera;

typedef struct hk_camera_place { /* where it stands and what it looks at */
  double eye[3], target[3];
} hk_camera_place;

/* Matrices in column-major order, as in OpenGL. */
typedef struct hk_lens {
  float view[16], projection[16], both[16]; /* both = projection view */
} hk_lens;

/* Unit vectors to the right, up and from target to eye. */
void hk_camera_axes(const hk_camera *, double right[3], double up[3], double back[3]);
void hk_camera_lens(const hk_camera *, hk_lens *);

/* From depths between the planes, 0 to 1, to distances along the line of sight, m. Strokes, at depth 0, are nearer than
 * anything, and where nothing was drawn, at depth 1, there is no end. */
void hk_camera_distances(const hk_camera *, size_t count, float *depth);

/* Sets the eye's direction for a motion inside the box: from the front, more from above the flatter the motion, and
 * across the thinner of its horizontal sides. `target` becomes the middle of the box, the eye one metre from it. */
void hk_camera_aim(hk_camera *, const double low[3], const double high[3]);

/* The nearest eye, along the direction of a camera, that sees all points: each of the picture's four sides gives one
 * plane through the eye, which depends on the points only through min n.p. */
typedef struct hk_fit {
  double axis[3][3];   /* right, up, back */
  double normal[4][3]; /* inward: left, right, bottom, top */
  double sine[2], cosine[2];
  double least[4];
  double front, rear; /* extent along the line of sight */
} hk_fit;

/* The points will fill two thirds of the picture's height or, where they are wide, `wide` (0..1) of its width. */
void hk_fit_begin(hk_fit *, const hk_camera *, double wide);
void hk_fit_add(hk_fit *, const float point[3], double radius);
/* Moves eye and target; nothing happens when no point was added. */
void hk_fit_end(const hk_fit *, hk_camera *);

#endif
