/* What the contacts on all sides of a sphere add up to. */
#ifndef HK_CROWD_H
#define HK_CROWD_H

typedef struct hk_crowd {
  double number; /* of contacts, at most */
  double along;  /* the largest eigenvalue of the sum of n n^T over their normals n, at most */
} hk_crowd;

/* Around a sphere of radius R, of spheres of radius r at least that do not overlap each other. */
hk_crowd hk_crowd_of(double R, double r);

#endif
