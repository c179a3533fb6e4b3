#include "plugins/common/camera/camera.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static double normalize(double v[3]) {
  double length = sqrt(dot(v, v));
  if (length > 0)
    for (int c = 0; c < 3; c++) v[c] /= length;
  return length;
}

void hk_camera_axes(const hk_camera *camera, double right[3], double up[3], double back[3]) {
  static const double z[3] = {0, 0, 1}, y[3] = {0, 1, 0};
  for (int c = 0; c < 3; c++) back[c] = camera->eye[c] - camera->target[c];
  if (normalize(back) == 0) back[1] = -1;
  cross(fabs(back[2]) < 0.9999 ? z : y, back, right);
  normalize(right);
  cross(back, right, up);
}

static void multiply(const float a[16], const float b[16], float out[16]) {
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 4; i++) {
      float sum = 0;
      for (int k = 0; k < 4; k++) sum += a[4 * k + i] * b[4 * j + k];
      out[4 * j + i] = sum;
    }
}

void hk_camera_lens(const hk_camera *camera, hk_lens *lens) {
  double axis[3][3], depth = camera->far - camera->near, f = 1 / tan(camera->fov / 2);
  hk_camera_axes(camera, axis[0], axis[1], axis[2]);
  memset(lens, 0, sizeof *lens);
  for (int i = 0; i < 3; i++) {
    for (int c = 0; c < 3; c++) lens->view[4 * c + i] = (float)axis[i][c];
    lens->view[12 + i] = (float)-dot(axis[i], camera->eye);
  }
  lens->view[15] = 1;
  lens->projection[0] = (float)(f / camera->aspect);
  lens->projection[5] = (float)f;
  lens->projection[10] = (float)(-(camera->far + camera->near) / depth);
  lens->projection[11] = -1;
  lens->projection[14] = (float)(-2 * camera->far * camera->near / depth);
  multiply(lens->projection, lens->view, lens->both);
}

void hk_camera_aim(hk_camera *camera, const double low[3], const double high[3]) {
  const double degree = acos(-1) / 180;
  double side[3], wide, thin, height, flat, azimuth;
  for (int c = 0; c < 3; c++) side[c] = high[c] - low[c];
  wide = fmax(side[0], side[1]), thin = fmin(side[0], side[1]);
  height = side[2];
  flat = wide > 0 ? fmin(fmax(1 - height / (0.6 * wide), 0), 1) : 0; /* 1: the motion is in a horizontal plane */
  azimuth = degree * (12 + 22 * (wide > 0 ? thin / wide : 0));
  if (side[1] > 1.3 * side[0]) azimuth = degree * 90 - azimuth;
  double elevation = degree * (16 + 34 * flat * (wide > 0 ? thin / wide : 0));
  double back[3] = {cos(elevation) * sin(azimuth), -cos(elevation) * cos(azimuth), sin(elevation)};
  for (int c = 0; c < 3; c++) {
    camera->target[c] = (low[c] + high[c]) / 2;
    camera->eye[c] = camera->target[c] + back[c];
  }
}

void hk_fit_begin(hk_fit *fit, const hk_camera *camera, double wide) {
  static const double high = 2. / 3;
  double slope[2] = {wide * camera->aspect * tan(camera->fov / 2), high * tan(camera->fov / 2)};
  hk_camera_axes(camera, fit->axis[0], fit->axis[1], fit->axis[2]);
  for (int k = 0; k < 4; k++) {
    double angle = atan(slope[k / 2]), turn = k % 2 ? -1 : 1;
    fit->sine[k / 2] = sin(angle), fit->cosine[k / 2] = cos(angle);
    for (int c = 0; c < 3; c++)
      fit->normal[k][c] = turn * cos(angle) * fit->axis[k / 2][c] - sin(angle) * fit->axis[2][c];
    fit->least[k] = INFINITY;
  }
  fit->front = -INFINITY, fit->rear = INFINITY;
}

void hk_fit_add(hk_fit *fit, const float point[3], double radius) {
  double p[3] = {(double)point[0], (double)point[1], (double)point[2]};
  for (int k = 0; k < 4; k++) fit->least[k] = fmin(fit->least[k], dot(fit->normal[k], p) - radius);
  double along = dot(fit->axis[2], p);
  fit->front = fmax(fit->front, along + radius);
  fit->rear = fmin(fit->rear, along - radius);
}

/* With e = (right, up, back) of the eye, the planes of the left and right sides require
 *     cos e_r - sin e_b <= least[0]   and   -cos e_r - sin e_b <= least[1]. */
void hk_fit_end(const hk_fit *fit, hk_camera *camera) {
  double place[3];
  if (fit->front < fit->rear) return;
  place[2] = fit->front;
  for (int k = 0; k < 2; k++) {
    double sum = fit->least[2 * k] + fit->least[2 * k + 1], difference = fit->least[2 * k] - fit->least[2 * k + 1];
    place[k] = difference / (2 * fit->cosine[k]);
    place[2] = fmax(place[2], -sum / (2 * fit->sine[k]));
  }
  double middle = (fit->front + fit->rear) / 2;
  for (int c = 0; c < 3; c++) {
    double across = place[0] * fit->axis[0][c] + place[1] * fit->axis[1][c];
    camera->eye[c] = across + place[2] * fit->axis[2][c];
    camera->target[c] = across + middle * fit->axis[2][c];
  }
}

void hk_camera_distances(const hk_camera *camera, size_t count, float *depth) {
  float sum = (float)(camera->far + camera->near), difference = (float)(camera->far - camera->near);
  float product = (float)(2 * camera->far * camera->near);
  for (size_t k = 0; k < count; k++)
    depth[k] = depth[k] <= 0 ? -INFINITY : depth[k] >= 1 ? INFINITY : product / (sum - (2 * depth[k] - 1) * difference);
}
